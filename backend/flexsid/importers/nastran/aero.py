"""Aerodynamic part of a Nastran deck: CAERO1 panels and the splines of their boxes.

CAERO1, AEFACT, AERO, SPLINE1, SPLINE4, AELIST and SET1 are read; bodies, SPLINE2 and beams of
splines are not. Panels are in the basic coordinate system.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from flexsid.errors import BadInput, UnreadableFile
from flexsid.importers.nastran.bulk import list_entries
from flexsid.importers.source import read_real
from flexsid.sysid.aerodynamics.boxes import Panel

_MOST_NUMBERS = 100_000  # boxes or nodes of a list
_SPLINES = frozenset(("SPLINE1", "SPLINE4"))
_NAMES = _SPLINES | frozenset(("AERO", "CAERO1", "AEFACT", "AELIST", "SET1"))


@dataclass(frozen=True, slots=True)
class AeroSpline:
    """Boxes of a deck, by number, and the nodes that they follow."""

    number: int
    boxes: tuple[int, ...]
    nodes: tuple[int, ...]


@dataclass(frozen=True, slots=True, eq=False)
class AeroDeck:
    """Panels by number of their first box, splines, and reference chord and density of AERO."""

    panels: Mapping[int, Panel]
    splines: tuple[AeroSpline, ...]
    chord: float | None
    density: float | None

    def number_boxes(self, panels: Sequence[int]) -> list[int]:
        """Return the numbers of all boxes of some panels, in the order of ``mesh_panels``."""
        return [
            number + index
            for number in panels
            for index in range(
                (self.panels[number].chordwise.size - 1) * (self.panels[number].spanwise.size - 1)
            )
        ]


def read_aero_deck(texts: Iterable[str]) -> AeroDeck:
    """Read panels and splines of a deck, whose files may be separate.

    Raises
    ------
    UnreadableFile
        If an entry has not its format, or refers to a list that is in none of the files.
    """
    entries: list[tuple[int, list[str]]] = []
    for text in texts:
        entries += [(line, [*fields, *[""] * 16]) for line, fields in list_entries(text, _NAMES)]
    lists: dict[str, dict[int, list]] = {"AEFACT": {}, "AELIST": {}, "SET1": {}}
    panels: dict[int, Panel] = {}
    splines: list[AeroSpline] = []
    chord = density = None
    # Lists and panels may stand after the entries that refer to them.
    for names in (frozenset(lists), frozenset(("AERO", "CAERO1")), _SPLINES):
        for line, (name, *fields) in entries:
            if name not in names:
                continue
            try:
                if name == "AEFACT":
                    lists[name][int(fields[0])] = [read_real(f) for f in fields[1:] if f]
                elif name in lists:
                    lists[name][int(fields[0])] = _read_numbers(fields[1:])
                elif name == "AERO":
                    if fields[0] not in ("", "0"):
                        raise ValueError(
                            f"coordinate system {fields[0]}: only the basic system is read"
                        )
                    chord, density = read_real(fields[2]), read_real(fields[3])
                elif name == "CAERO1":
                    panels[int(fields[0])] = _read_panel(fields, lists["AEFACT"])
                else:
                    splines.append(_read_spline(name, fields, lists, panels))
            except (BadInput, ValueError, IndexError, KeyError) as error:
                raise UnreadableFile(
                    f"line {line}: {name} {fields[0]} cannot be read ({error}).", row=line
                ) from error
    return AeroDeck(dict(sorted(panels.items())), tuple(splines), chord, density)


def _read_numbers(fields: Sequence[str]) -> list[int]:
    numbers: list[int] = []
    entries = [field.upper() for field in fields if field]
    for index, field in enumerate(entries):
        if field == "THRU":
            numbers += _count_up(numbers[-1] + 1, int(entries[index + 1]))
        else:
            numbers.append(int(field))
    return numbers


def _count_up(first: int, last: int) -> range:
    """Return the numbers before ``last``; a typing error may ask for any number of them."""
    if last - first > _MOST_NUMBERS:
        raise ValueError(f"{last - first} numbers; expected at most {_MOST_NUMBERS}")
    return range(first, last)


def _read_panel(fields: Sequence[str], factors: Mapping[int, list[float]]) -> Panel:
    if fields[2] not in ("", "0"):
        raise ValueError(f"coordinate system {fields[2]}: only the basic system is read")
    x1, y1, z1, chord1, x4, y4, z4, chord4 = map(read_real, fields[8:16])
    return Panel(
        (x1, y1, z1),
        chord1,
        (x4, y4, z4),
        chord4,
        chordwise=_read_divisions(fields[4], fields[6], factors),
        spanwise=_read_divisions(fields[3], fields[5], factors),
    )


def _read_divisions(count: str, of: str, factors: Mapping[int, list[float]]) -> np.ndarray:
    if count and int(count):
        _count_up(0, int(count))
        return np.linspace(0.0, 1.0, int(count) + 1)
    if int(of) not in factors:
        raise ValueError(f"AEFACT {of} is in none of the files")
    return np.array(factors[int(of)])


def _read_spline(
    name: str,
    fields: Sequence[str],
    lists: Mapping[str, Mapping[int, list[int]]],
    panels: Mapping[int, Panel],
) -> AeroSpline:
    if name == "SPLINE1":
        boxes = _list_rectangle(panels, *(int(field) for field in fields[1:4]))
    else:
        boxes = lists["AELIST"][int(fields[2])]
    return AeroSpline(int(fields[0]), tuple(boxes), tuple(lists["SET1"][int(fields[4])]))


def _list_rectangle(panels: Mapping[int, Panel], number: int, first: int, last: int) -> list[int]:
    """List the boxes of a panel between two opposite corners of a rectangle of boxes.

    Notes
    -----
    Boxes are numbered along the chord first, so that those between the corners are not all
    numbers from the first to the last (SPLINE1, MSC/Nastran Quick Reference Guide).
    """
    if number not in panels:
        raise ValueError(f"CAERO1 {number} is in none of the files")
    n_chord, n_span = (panels[number].chordwise.size - 1, panels[number].spanwise.size - 1)
    for box in (first, last):
        if not 0 <= box - number < n_chord * n_span:
            raise ValueError(f"box {box} is not of CAERO1 {number}")
    (strip_1, row_1), (strip_2, row_2) = (divmod(box - number, n_chord) for box in (first, last))
    if strip_2 < strip_1 or row_2 < row_1:
        raise ValueError(f"box {last} is not behind and outboard of box {first}")
    return [
        number + strip * n_chord + row
        for strip in range(strip_1, strip_2 + 1)
        for row in range(row_1, row_2 + 1)
    ]
