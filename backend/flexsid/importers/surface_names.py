"""Recorded surfaces and commands by the surfaces of a stored aircraft.

A recorder has names of its own, and often a left and a right column of what the aircraft has as
one surface. Columns that move together are one surface: one of their names identifies all.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from flexsid import units
from flexsid.importers.column_names import Meaning
from flexsid.records.maneuver import Role

COMMAND = "_command"
"""Suffix of the channel with the command of a surface."""

_FAMILIES = (
    "elevator elev ele elv el de stab stabilator",
    "aileron ail da",
    "rudder rud rdr dr",
    "bodyflap bf",
    "flap flaps wingflap wf dwf df tef",
    "elevon",
    "flaperon",
    "canard",
    "spoiler spl",
    "lef slat",
)
_FAMILY = {word: words.split()[0] for words in _FAMILIES for word in words.split()}
_PARTS = {
    "l": "l", "lh": "l", "left": "l", "r": "r", "rh": "r", "right": "r",
    "s": "s", "sym": "s", "a": "a", "anti": "a", "asym": "a",
}  # fmt: skip
_TOKEN = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+")
_STRIP = re.compile(r"(bf|wf)([alrs])")
_UNIT = re.compile(r"\s*[\[(][^\])]*[\])]\s*$")


@dataclass(frozen=True, slots=True, kw_only=True)
class SurfaceColumn:
    """One column of a deflection or its command."""

    field: str
    samples: np.ndarray
    meaning: Meaning


@dataclass(frozen=True, slots=True, kw_only=True)
class OtherSide:
    """The other side of a surface; ``sign`` is -1 if it was recorded with the opposite sign."""

    column: str
    unit: str
    sign: int


@dataclass(frozen=True, slots=True)
class AssignedSurfaces:
    """Meanings by field, and the other sides by the field of the first."""

    meanings: Mapping[str, Meaning] = field(default_factory=dict)
    other_sides: Mapping[str, OtherSide] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class _SurfaceWords:
    families: frozenset[str]
    number: str
    part: str


def assign_surfaces(columns: Sequence[SurfaceColumn], surfaces: Sequence[str]) -> AssignedSurfaces:
    """Assign columns to the surfaces of an aircraft, by their words and by what moves together.

    Parameters
    ----------
    columns
        Deflections and commands, as recognised.
    surfaces
        Names of the surfaces of the aircraft.

    Returns
    -------
    AssignedSurfaces
        Meanings of columns that one surface fits. Where one column, or several that move together,
        and one surface are left over, they are taken as each other. Two columns that move together
        are sides of one surface, unless the aircraft has left and right ones.
    """
    meanings: dict[str, Meaning] = {}
    groups: dict[str, list[SurfaceColumn]] = {}
    for column in columns:
        fitted = find_surfaces(column.field, surfaces)
        side = [name for name in fitted if _read_words(name).part in ("l", "r")]
        if len(side) == 1:
            meanings[column.field] = _name(column.meaning, side[0])
        else:
            groups.setdefault(column.meaning.surface or column.field, []).append(column)
    fitting = {key: _find_common(group, surfaces) for key, group in groups.items()}
    claimed = [next(iter(names)) for names in fitting.values() if len(names) == 1]
    named = {
        key: next(iter(names))
        for key, names in fitting.items()
        if len(names) == 1 and claimed.count(next(iter(names))) == 1
    }
    taken = {*named.values(), *(meaning.name for meaning in meanings.values())}
    free = [name for name in surfaces if name not in taken]
    open_groups = [
        key
        for key, group in groups.items()
        if key not in named and any(_may_be_deflection(own.meaning) for own in group)
    ]
    if len(free) == len(open_groups) == 1:
        named[open_groups[0]] = free[0]
    other_sides: dict[str, OtherSide] = {}
    for key, group in groups.items():
        name = named.get(key)
        for role in (Role.INPUT, Role.COMMAND):
            own = [column for column in group if column.meaning.role is role]
            own.sort(key=lambda column: _read_words(column.field).part == "r")
            if not own or name is None:
                continue
            first, *others = own
            meanings[first.field] = _name(first.meaning, name)
            if len(others) == 1 and _may_be_sides(first, others[0]):
                other_sides[first.field] = _describe_other_side(first, others[0])
    return AssignedSurfaces(meanings, other_sides)


def _may_be_deflection(meaning: Meaning) -> bool:
    """Whether an input may be an angle: engines are inputs in % or rpm. No unit reads as 1."""
    if meaning.role is not Role.INPUT or meaning.unit == "%":
        return False
    return not units.is_known(meaning.unit) or units.dimension(meaning.unit) in ("angle", "number")


def _may_be_sides(first: SurfaceColumn, other: SurfaceColumn) -> bool:
    """Whether neither words nor units nor lengths of columns contradict that they are sides."""
    one, two = _read_words(first.field), _read_words(other.field)
    if one.families and two.families:
        if not one.families & two.families or one.number != two.number:
            return False
    elif first.meaning.known or other.meaning.known:  # by its name something else
        return False
    given = [column.meaning.unit for column in (first, other)]
    is_one_quantity = (
        not all(map(units.is_known, given)) or len(set(map(units.dimension, given))) == 1
    )
    return is_one_quantity and first.samples.size == other.samples.size


def _find_common(group: Iterable[SurfaceColumn], surfaces: Sequence[str]) -> set[str]:
    """Return the surfaces that the names of columns fit that move together."""
    found: set[str] = set()
    for column in group:
        own = column.meaning.name.removesuffix(COMMAND)
        found |= {own} if own in surfaces else find_surfaces(column.field, surfaces)
    return found


def find_surfaces(column: str, surfaces: Sequence[str]) -> set[str]:
    """Return the surfaces that the words of a column fit; those of its side only, if there are."""
    words = _read_words(column)
    fitting = {
        name: own.part
        for name in surfaces
        if (own := _read_words(name)).families & words.families and own.number == words.number
    }
    exact = {name for name, part in fitting.items() if part == words.part}
    whole = {name for name, part in fitting.items() if part not in ("l", "r")}
    return exact or whole


def _read_words(name: str) -> _SurfaceWords:
    bare = _UNIT.sub("", name).rpartition(".")[2]
    words: list[str] = []
    for token in _TOKEN.findall(bare):
        strip = _STRIP.fullmatch(token.lower())
        words += list(strip.groups()) if strip else [token.lower()]
    if "body" in words and "flap" in words:
        words = ["bodyflap" if word == "flap" else word for word in words]
    numbers = [word.lstrip("0") for word in words if word.isdigit()]
    return _SurfaceWords(
        frozenset(_FAMILY[word] for word in words if word in _FAMILY),
        numbers[0] if numbers else "",
        next((_PARTS[word] for word in reversed(words) if word in _PARTS), ""),
    )


def _name(meaning: Meaning, surface: str) -> Meaning:
    name = surface + COMMAND if meaning.role is Role.COMMAND else surface
    return replace(meaning, name=name)


def _describe_other_side(first: SurfaceColumn, other: SurfaceColumn) -> OtherSide:
    one, two = (column.samples - np.mean(column.samples) for column in (first, other))
    sign = -1 if float(np.nansum(one * two)) < 0.0 else 1
    return OtherSide(column=other.field, unit=other.meaning.unit, sign=sign)
