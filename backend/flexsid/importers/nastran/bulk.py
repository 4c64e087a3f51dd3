"""Nastran bulk data (.bdf, .nas, .fem, .dat, .pch): nodes, systems, edges, matrices (DMIG).

Fields may be in small, large and free format.

INCLUDE is not followed, as a deck may name any file of the server; the included files are
imported with it. A field that defaults to GRDSET stays open if this file has no GRDSET, as that
entry may be in another file of the deck.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeVar

import numpy as np

from flexsid.errors import UnreadableFile
from flexsid.importers.nastran.edges import CORNERS, list_edges
from flexsid.importers.nastran.frames import Point, list_geometry
from flexsid.importers.nastran.matrix_entries import MatrixEntries, build_matrix, take_entry
from flexsid.importers.nastran.solutions import find_solution
from flexsid.importers.numbers import read_integer, read_real
from flexsid.importers.source import Field

_CARD = re.compile(
    rb"^(INIT |SOL |CEND|BEGIN |GRID|DMIG|CORD[12]|GRDSET|INCLUDE |[A-Z][A-Z0-9]+\*? {1,12}\d+ |\$"
    rb"|(C(QUAD|TRIA|BAR|BEAM|ROD|TUBE|ELAS|BUSH|ON[MR]|SHEAR)|PLOTEL|RB|P(SHELL|COMP|BAR|BEAM)"
    rb"|MAT[1-9]|SPC|MPC|PARAM|CAERO|SPLINE)\w*\*? *,)",
    re.IGNORECASE | re.MULTILINE,
)
"""Lines with which decks and their parts begin; free format by name, as CSV files have commas."""

_ENTRY = re.compile(rb"^[A-Z][A-Z0-9]{1,7}\*? *,", re.IGNORECASE | re.MULTILINE)
"""An entry in free format, as a table of columns has one too."""

_REPEAT = re.compile(r"=\(?(\d+)\)?")
_STEP = re.compile(r"\*\(?([-+.\dEeDd]+)\)?")
_Entry = TypeVar("_Entry")
_KINDS = {"R": 1, "C": 2, "S": 3}


def recognises(head: bytes) -> bool:
    """Return whether the beginning of a file is that of a deck."""
    return _CARD.search(head) is not None and b"\0" not in head


def may_be_part(head: bytes) -> bool:
    """Return whether the beginning of a file may be that of a part of a deck, by its suffix."""
    return b"\0" not in head and (recognises(head) or _ENTRY.search(head) is not None)


def read(path: Path) -> Iterator[Field]:
    """Read nodes, coordinate systems and edges of a deck, or of one of its parts."""
    return read_text(path.read_text(encoding="latin-1"))


@dataclass(slots=True)
class _Deck:
    grids: dict[int, tuple[int | None, Point, int | None]] = field(default_factory=dict)
    frames: dict[int, tuple[int, int, Point]] = field(default_factory=dict)
    by_grid: dict[int, tuple[int, ...]] = field(default_factory=dict)
    includes: list[str] = field(default_factory=list)
    defaults: tuple[int, int] | None = None
    weight_to_mass: tuple[float, ...] = ()
    edges: list[tuple[int, int]] = field(default_factory=list)
    matrices: dict[str, MatrixEntries] = field(default_factory=dict)
    refused: list[str] = field(default_factory=list)


def read_text(text: str) -> Iterator[Field]:
    """Yield the fields of a deck in memory."""
    deck = _Deck()
    for line, entries in _cards(text, deck):
        try:
            _take(deck, entries)
        except (ValueError, IndexError) as error:
            if entries[0] in CORNERS:  # drawn only
                deck.refused.append(
                    f"line {line}: {' '.join(entries)[:60]} is not a {entries[0]} entry"
                )
                continue
            raise UnreadableFile(
                f"line {line}: {' '.join(entries)[:80]} is not a {entries[0]} entry ({error}).",
                row=line,
            ) from error
    yield Field("deck/n_grids", np.array([len(deck.grids)]))
    default_cp, default_cd = deck.defaults or (0, 0)
    grids = {
        number: (default_cp if cp is None else cp, xyz, default_cd if cd is None else cd)
        for number, (cp, xyz, cd) in deck.grids.items()
    }
    yield from list_geometry(grids, deck.frames)
    if deck.grids and deck.defaults is None:
        rows = [deck.grids[number] for number in sorted(deck.grids)]
        yield Field("deck/left_open", np.array([[cp is None, cd is None] for cp, _, cd in rows]))
    if solution := find_solution(line.split("$")[0] for line in text.splitlines()):
        yield Field("deck/solution", np.array([solution]))
    for entries in deck.matrices.values():
        matrix, why = build_matrix(entries)
        if matrix is None:
            deck.refused.append(why)
        else:
            yield from matrix.fields(entries.name)
    for name, values in (
        ("deck/grdset", deck.defaults),
        ("deck/wtmass", deck.weight_to_mass),
        ("frame/by_grid", list(deck.by_grid.values())),
        ("deck/include", deck.includes),
        ("line/nodes", sorted(set(deck.edges))),
        ("refused", deck.refused),
    ):
        if values:
            yield Field(name, np.array(values))


def has_entries(text: str) -> bool:
    """Return whether a text has entries that are read, as a punch file may."""
    names = (line[:8].partition(",")[0].strip().rstrip("*").upper() for line in text.splitlines())
    return any(map(_is_read, names))


def list_entries(text: str, names: frozenset[str]) -> Iterator[tuple[int, list[str]]]:
    """Yield the entries of these names as lists of fields, and their first line."""
    return _cards(text, _Deck(), names.__contains__)


def _is_read(name: str) -> bool:
    return (
        name in CORNERS
        or name in ("GRID", "GRDSET", "PARAM", "DMIG")
        or re.fullmatch(r"CORD[12][RCS]", name) is not None
    )


def _cards(
    text: str, deck: _Deck, is_read: Callable[[str], bool] = _is_read
) -> Iterator[tuple[int, list[str]]]:
    """Yield entries with their continuations as lists of fields, and their first line."""
    current: list[str] = []
    begun = 0
    pattern: list[str] = []  # of a replication, which may be repeated
    included: str | None = None  # the name of a file over several lines, in quotes
    for number, raw in enumerate(text.splitlines(), start=1):
        line = raw.split("$")[0].expandtabs(8).rstrip()
        if not line:
            continue
        if included is not None or line[:7].upper() == "INCLUDE":
            included = line[7:].strip() if included is None else included + line.strip()
            if included[:1] in ("'", '"') and included.count(included[0]) < 2:
                continue
            deck.includes.append(included.strip("'\""))
            included = None
            continue
        if line[:8].upper().startswith("ENDDATA"):
            break
        head, rest = _split(line)
        if head == "" or head[0] in "+*":
            if current:
                current.extend(rest)
            continue
        if head[0] == "=":
            if current and not is_read(current[0]):
                continue  # of an entry that is not read
            try:
                for made in _replicate(head, rest, current, pattern):
                    yield begun, current
                    current, begun = made, number
            except ValueError as error:
                problem = f"line {number}: '{line[:60]}' {error}"
                if current and current[0] in CORNERS:
                    deck.refused.append(problem)
                    continue
                raise UnreadableFile(f"{problem}.", row=number) from error
            continue
        if current and is_read(current[0]):
            yield begun, current
        current, begun, pattern[:] = [head.rstrip("*").upper(), *rest], number, []
        if is_read(current[0]) and any(part.strip() for part in line.split(",")[len(rest) + 2 :]):
            raise UnreadableFile(
                f"line {number}: '{line[:60]}' has more fields than one line may have; "
                "continue it on the next line.",
                row=number,
            )
    if current and is_read(current[0]):
        yield begun, current


def _replicate(
    head: str, rest: list[str], current: list[str], pattern: list[str]
) -> Iterator[list[str]]:
    """Yield entries replicated from the one before: ``=``, ``==``, ``*(step)``, ``=(n)``."""
    repeat = _REPEAT.fullmatch(head)
    if not current or (repeat is not None and (any(rest) or not pattern)):
        raise ValueError("has no entry to repeat")
    if repeat is None:
        if head not in ("=", "=="):
            raise ValueError("is not a replication that can be read")
        pattern[:] = ["=="] if head == "==" else rest
    for _ in range(1 if repeat is None else int(repeat[1])):
        made, whole = [current[0]], False
        before = (current[1:] + [""] * len(pattern))[: max(len(pattern), len(current) - 1)]
        for index, value in enumerate(before):
            asked = pattern[index] if index < len(pattern) else ""
            whole = whole or asked == "=="
            made.append(value if whole or asked == "=" else _add_step(asked, value))
        current = made
        yield made


def _add_step(asked: str, value: str) -> str:
    if not asked.startswith(("*", "=", "%")):
        return asked
    step = _STEP.fullmatch(asked)
    try:
        if step is not None and all(re.fullmatch(r"[-+]?\d+", part) for part in (value, step[1])):
            return str(int(value) + int(step[1]))
        return repr(read_real(value) + read_real(asked if step is None else step[1]))
    except ValueError as error:
        problem = f"has '{asked}', which is not a step that can be added to '{value}'"
        raise ValueError(problem) from error


def _split(line: str) -> tuple[str, list[str]]:
    """Return the first field and the data fields of a line, in free, small or large format."""
    if "," in line:
        parts = [part.strip() for part in line.split(",")]
        width = 4 if "*" in parts[0] else 8
        return parts[0], (parts[1:] + [""] * width)[:width]
    head = line[:8].strip()
    if head.endswith("*") or line.startswith("*"):
        return head, [line[8 + 16 * i : 24 + 16 * i].strip() for i in range(4)]
    return head, [line[8 + 8 * i : 16 + 8 * i].strip() for i in range(8)]


def _take(deck: _Deck, entries: list[str]) -> None:
    name, *fields = entries
    fields += [""] * 16
    if name == "GRDSET":
        deck.defaults = read_integer(fields[1] or "0"), read_integer(fields[5] or "0")
    elif name == "PARAM":
        if fields[0].upper() == "WTMASS":
            deck.weight_to_mass = (read_real(fields[1]),)
    elif name == "GRID":
        place = tuple(read_real(value) for value in fields[2:5])
        cp, cd = (read_integer(fields[k]) if fields[k] else None for k in (1, 5))
        _define(deck.grids, read_integer(fields[0]), (cp, place, cd), "node")
    elif name in CORNERS:
        deck.edges += list_edges(name, fields)
    elif name == "DMIG":
        take_entry(deck.matrices, fields)
    elif name.startswith("CORD2"):
        points = tuple(read_real(value) for value in fields[2:11])
        frame = (_KINDS[name[5]], read_integer(fields[1] or "0"), points)
        _define(deck.frames, read_integer(fields[0]), frame, "coordinate system")
    elif name.startswith("CORD1"):
        for first in (0, 4):
            if fields[first]:
                numbers = [read_integer(value) for value in fields[first : first + 4]]
                frame = (numbers[0], _KINDS[name[5]], *numbers[1:])
                _define(deck.by_grid, numbers[0], frame, "coordinate system")


def _define(known: dict[int, _Entry], number: int, what: _Entry, kind: str) -> None:
    if known.setdefault(number, what) != what:
        raise ValueError(f"{kind} {number} has two different definitions")
