"""Nastran bulk data (.bdf, .nas, .dat, .pch): GRID and coordinate systems, whatever the format.

INCLUDE is not followed, as a deck from somewhere may name any file of the server; the files
it names are imported beside it.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from flexsid.errors import UnreadableFile
from flexsid.importers.source import Content, Field

_CARD = re.compile(
    rb"^(INIT |SOL |CEND|BEGIN |GRID|CORD[12]|GRDSET|INCLUDE |[A-Z][A-Z0-9]+ {1,7}\d+ |\$ )",
    re.IGNORECASE | re.MULTILINE,
)
_KINDS = {"R": 1, "C": 2, "S": 3}
_EXPONENT = re.compile(r"(?<=[\d.])([+-]\d+)$")


def recognises(head: bytes) -> bool:
    """Tell whether the beginning of a file looks like a deck."""
    return _CARD.search(head) is not None and b"\0" not in head


def read(path: Path) -> Content:
    """Read nodes and coordinate systems of a deck, or of one of its parts."""
    return Content(read_text(path.read_text(encoding="latin-1")))


@dataclass(slots=True)
class _Deck:
    grids: dict[int, tuple[int, tuple[float, ...], int]] = field(default_factory=dict)
    frames: dict[int, tuple[int, int, tuple[float, ...]]] = field(default_factory=dict)
    by_grid: list[tuple[int, ...]] = field(default_factory=list)
    includes: list[str] = field(default_factory=list)
    default_cp: int = 0
    default_cd: int = 0


def read_text(text: str) -> Iterator[Field]:
    """Fields of a deck that is in memory."""
    deck = _Deck()
    for line, entries in _cards(text, deck):
        try:
            _take(deck, entries)
        except (ValueError, IndexError) as error:
            raise UnreadableFile(
                f"line {line}: {' '.join(entries)[:80]} is not a {entries[0]} entry ({error}).",
                row=line,
            ) from error
    yield Field("deck/n_grids", np.array([len(deck.grids)]))
    if deck.grids:
        ids = sorted(deck.grids)
        rows = [deck.grids[i] for i in ids]
        yield Field("grid/id", np.array(ids, dtype=np.int64))
        cp = [deck.default_cp if row[0] < 0 else row[0] for row in rows]
        yield Field("grid/cp", np.array(cp, dtype=np.int64))
        yield Field("grid/xyz", np.array([row[1] for row in rows], dtype=float))
        cd = [deck.default_cd if row[2] == _BLANK else row[2] for row in rows]
        yield Field("grid/cd", np.array(cd, dtype=np.int64))
    if deck.frames:
        ids = sorted(deck.frames)
        yield Field("frame/id", np.array(ids, dtype=np.int64))
        yield Field("frame/kind", np.array([deck.frames[i][0] for i in ids], dtype=np.int64))
        yield Field("frame/reference", np.array([deck.frames[i][1] for i in ids], dtype=np.int64))
        yield Field("frame/points", np.array([deck.frames[i][2] for i in ids], dtype=float))
    if deck.by_grid:
        yield Field("frame/by_grid", np.array(deck.by_grid, dtype=np.int64))
    if deck.includes:
        yield Field("deck/include", np.array(deck.includes, dtype=np.str_))


_BLANK = -(10**9)


def _cards(text: str, deck: _Deck) -> Iterator[tuple[int, list[str]]]:
    """Entries with their continuations, as lists of fields, and the line where each begins."""
    current: list[str] = []
    begun = 0
    for number, raw in enumerate(text.splitlines(), start=1):
        line = raw.split("$")[0].expandtabs(8).rstrip()
        if not line:
            continue
        if line[:7].upper() == "INCLUDE":
            deck.includes.append(line[7:].strip().strip("'\""))
            continue
        if line[:8].upper().startswith("ENDDATA"):
            break
        head, rest = _split(line)
        if head == "" or head[0] in "+*":
            if current:
                current.extend(rest)
            continue
        if current:
            yield begun, current
        name = head.rstrip("*").upper()
        wanted = name in ("GRID", "GRDSET") or re.fullmatch(r"CORD[12][RCS]", name)
        current, begun = ([name, *rest], number) if wanted else ([], number)
    if current:
        yield begun, current


def _split(line: str) -> tuple[str, list[str]]:
    """First field and the data fields of one line, in free, small or large field format."""
    if "," in line:
        parts = [part.strip() for part in line.split(",")]
        return parts[0], (parts[1:9] + [""] * 8)[:8]
    head = line[:8].strip()
    if head.endswith("*") or line.startswith("*"):
        return head, [line[8 + 16 * i : 24 + 16 * i].strip() for i in range(4)]
    return head, [line[8 + 8 * i : 16 + 8 * i].strip() for i in range(8)]


def _take(deck: _Deck, entries: list[str]) -> None:
    name, *fields = entries
    fields += [""] * 16
    if name == "GRDSET":
        deck.default_cp, deck.default_cd = _integer(fields[1], 0), _integer(fields[5], 0)
    elif name == "GRID":
        place = tuple(_real(value) for value in fields[2:5])
        cp, cd = _integer(fields[1], -1), _integer(fields[5], _BLANK)
        deck.grids[int(fields[0])] = (cp, place, cd)
    elif name.startswith("CORD2"):
        points = tuple(_real(value) for value in fields[2:11])
        kind = _KINDS[name[5]]
        deck.frames[int(fields[0])] = (kind, _integer(fields[1], 0), points)
    elif name.startswith("CORD1"):
        for first in (0, 4):
            if fields[first]:
                numbers = [int(value) for value in fields[first : first + 4]]
                deck.by_grid.append((numbers[0], _KINDS[name[5]], *numbers[1:]))


def _integer(text: str, default: int) -> int:
    return int(text) if text else default


def _real(text: str) -> float:
    """Read a number as Nastran writes it: 1.5, 1.5E3, 1.5D3, 1.5+3, -.2-4; blank is zero."""
    if not text:
        return 0.0
    plain = text.upper().replace("D", "E")
    return float(plain if "E" in plain else _EXPONENT.sub(r"E\1", plain))
