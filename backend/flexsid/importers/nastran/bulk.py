"""Nastran bulk data (.bdf, .nas, .fem, .dat, .pch): nodes, systems, edges, matrices.

Fields may be in small, large and free format.

INCLUDE is not followed, as a deck may name any file of the server; the included files are
imported with it. A field that defaults to GRDSET stays open if this file has no GRDSET, as that
entry may be in another file of the deck.
"""

from __future__ import annotations

import codecs
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from typing import TypeVar

import numpy as np
from jaxtyping import Float, Int

from flexsid.errors import BadInput, UnreadableFile
from flexsid.importers.matrices import MatrixTerms
from flexsid.importers.nastran.modal_cases import find_solution
from flexsid.importers.source import Field, read_integer, read_real

# --- Coordinate systems of a deck: transformation of nodes and shapes to the basic system ---------

Point = tuple[float, ...]
Grids = Mapping[int, tuple[int, Point, int]]
"""Coordinate system, coordinates and displacement system of each node."""

DefinedFrames = Mapping[int, tuple[int, int, Point]]
"""Kind, reference system and three points of each coordinate system."""

RECTANGULAR, CYLINDRICAL, SPHERICAL = 1, 2, 3


@dataclass(frozen=True, slots=True, eq=False)
class CoordinateSystem:
    """One coordinate system: rows of ``axes`` are its unit vectors in the basic one."""

    kind: int
    origin: Float[np.ndarray, "3"]
    axes: Float[np.ndarray, "3 3"]

    def to_basic(self, place: Float[np.ndarray, "3"]) -> Float[np.ndarray, "3"]:
        """Return the basic coordinates of a point given in this frame (angles in degrees)."""
        a, b, c = place
        if self.kind == CYLINDRICAL:
            angle = np.radians(b)
            place = np.array([a * np.cos(angle), a * np.sin(angle), c])
        elif self.kind == SPHERICAL:
            theta, phi = np.radians(b), np.radians(c)
            place = a * np.array(
                [np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)]
            )
        return self.origin + place @ self.axes

    def directions(self, place: Float[np.ndarray, "3"]) -> Float[np.ndarray, "3 3"]:
        """Return the displacement unit vectors at a basic location, as rows."""
        if self.kind == RECTANGULAR:
            return self.axes
        x, y, z = self.axes @ (place - self.origin)
        around = np.arctan2(y, x)
        out, along = np.hypot(x, y), z
        c, s = np.cos(around), np.sin(around)
        if self.kind == CYLINDRICAL:
            local = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
        else:
            down = np.arctan2(out, along)
            ct, st = np.cos(down), np.sin(down)
            local = np.array([[st * c, st * s, ct], [ct * c, ct * s, -st], [-s, c, 0.0]])
        return local @ self.axes


def list_geometry(grids: Grids, frames: DefinedFrames) -> Iterator[Field]:
    """Yield the fields of nodes and coordinate systems, in the order of their numbers."""
    for group, known, names in (
        ("grid", grids, ("cp", "xyz", "cd")),
        ("frame", frames, ("kind", "reference", "points")),
    ):
        if known:
            numbers = sorted(known)
            yield Field(f"{group}/id", np.array(numbers))
            for column, name in enumerate(names):
                yield Field(f"{group}/{name}", np.array([known[n][column] for n in numbers]))


BASIC = CoordinateSystem(RECTANGULAR, np.zeros(3), np.eye(3))


class Frames:
    """All coordinate systems of a deck, and its nodes."""

    def __init__(self, grids: Mapping[str, np.ndarray], frames: Mapping[str, np.ndarray]) -> None:
        self._row = {int(node): row for row, node in enumerate(grids["id"])}
        self._grids = grids
        self._defined: dict[int, tuple[int, int, np.ndarray]] = {}
        self._by_grid: dict[int, tuple[int, tuple[int, ...]]] = {}
        for row, number in enumerate(frames.get("id", ())):
            self._defined[int(number)] = (
                int(frames["kind"][row]),
                int(frames["reference"][row]),
                np.asarray(frames["points"][row], dtype=float).reshape(3, 3),
            )
        for number, kind, *nodes in frames.get("by_grid", ()):
            self._by_grid[int(number)] = (int(kind), tuple(int(node) for node in nodes))
        self._known: dict[int, CoordinateSystem] = {0: BASIC}
        self._open: set[object] = set()

    def places(self) -> Float[np.ndarray, "n_nodes 3"]:
        """Return the basic coordinates of all nodes, in the unit of length of the deck."""
        return np.array([self._place(int(node)) for node in self._grids["id"]]).reshape(-1, 3)

    def place_of(self, system: int, place: Float[np.ndarray, "3"]) -> Float[np.ndarray, "3"]:
        """Return the basic coordinates of a point given in a coordinate system of the deck."""
        return self._frame(system).to_basic(np.asarray(place, dtype=float))

    def turn(
        self,
        nodes: Int[np.ndarray, " n_nodes"],
        values: Float[np.ndarray, "n_modes n_nodes 6"],
        *,
        to_basic: bool = True,
    ) -> Float[np.ndarray, "n_modes n_nodes 6"]:
        """Transform shapes from the displacement systems of nodes to the basic one, or back."""
        turned = values.copy()
        for column, node in enumerate(nodes):
            row = self._row.get(int(node))
            number = 0 if row is None else int(self._grids["cd"][row])
            if number <= 0:  # -1 denotes fluid points
                continue
            axes = self._frame(number).directions(self._place(int(node)))
            axes = axes if to_basic else axes.T
            turned[:, column, :3] = values[:, column, :3] @ axes
            turned[:, column, 3:] = values[:, column, 3:] @ axes
        return turned

    def _place(self, node: int) -> Float[np.ndarray, "3"]:
        if node not in self._row:
            raise BadInput(
                f"a coordinate system is defined by node {node}, which is in none of the files",
                code="missing-node",
                node=node,
            )
        row = self._row[node]
        return self.place_of(int(self._grids["cp"][row]), self._grids["xyz"][row])

    def _frame(self, number: int) -> CoordinateSystem:
        if number in self._known:
            return self._known[number]
        if number in self._open:
            raise BadInput(f"coordinate system {number} refers to itself", code="circular-frame")
        self._open.add(number)
        if number in self._defined:
            kind, reference, points = self._defined[number]
            base = self._frame(reference)
            a, b, c = (base.to_basic(point) for point in points)
        elif number in self._by_grid:
            kind, nodes = self._by_grid[number]
            a, b, c = (self._place(node) for node in nodes)
        else:
            raise BadInput(
                f"coordinate system {number} is used but not defined in the files; import the "
                "deck with all files that it includes",
                code="missing-frame",
                frame=number,
            )
        z = b - a
        y = np.cross(z, c - a)
        if np.linalg.norm(z) == 0 or np.linalg.norm(y) == 0:
            raise BadInput(
                f"the three points of coordinate system {number} lie on one line",
                code="degenerate-frame",
                frame=number,
            )
        z, y = z / np.linalg.norm(z), y / np.linalg.norm(y)
        self._known[number] = CoordinateSystem(kind, a, np.array([np.cross(y, z), y, z]))
        self._open.discard(number)
        return self._known[number]


# --- Edges of elements for drawing, from the entries of a deck or of an output file ---------------

_SHELL4, _SHELL3, _BEAM = slice(2, 6), slice(2, 5), slice(2, 4)
CORNERS = {
    "CQUAD4": _SHELL4, "CQUADR": _SHELL4, "CQUAD8": _SHELL4, "CSHEAR": _SHELL4,
    "CTRIA3": _SHELL3, "CTRIAR": _SHELL3, "CTRIA6": _SHELL3,
    "CBAR": _BEAM, "CBEAM": _BEAM, "CROD": _BEAM, "CTUBE": _BEAM,
    "CONROD": slice(1, 3), "PLOTEL": slice(0, 7), "RBE2": slice(1, None),
}  # fmt: skip
"""Fields of an entry, after its name, with the nodes at its corners; midside nodes are omitted."""


def list_edges(name: str, fields: Sequence[str]) -> Iterator[tuple[int, int]]:
    """Yield the edges of an entry as pairs of nodes, the lower number first.

    Raises
    ------
    ValueError
        If a node is not a number.
    """
    nodes = fields[CORNERS[name]]
    if name == "RBE2":  # independent node, components, dependent nodes, thermal expansion
        pairs = [(int(nodes[0]), int(node)) for node in nodes[2:] if node and "." not in node]
    elif name == "PLOTEL":  # one or two
        pairs = [(int(fields[k]), int(fields[k + 1])) for k in (1, 5) if fields[k - 1]]
    else:
        corners = [int(node) for node in nodes]
        pairs = list(pairwise(corners if len(corners) == 2 else [*corners, corners[0]]))
    yield from ((min(pair), max(pair)) for pair in pairs if pair[0] != pair[1])


# --- DMIG entries of decks and punch files: matrices by node and component ------------------------

_SQUARE, _SYMMETRIC = 1, 6
_FORMS = {2: "rectangular", 9: "rectangular"}
_COMPLEX = (3, 4)

Dof = tuple[int, int]


@dataclass(slots=True)
class MatrixEntries:
    """A matrix of DMIG entries while it is read."""

    name: str
    form: int | None = None
    is_complex: bool = False
    is_polar: bool = False
    terms: dict[tuple[Dof, Dof], complex] = field(default_factory=dict)


def take_entry(known: dict[str, MatrixEntries], fields: Sequence[str]) -> None:
    """Add a DMIG entry: the header of a matrix, or terms of one of its columns.

    Raises
    ------
    ValueError
        If a field is no number, or a term has two values.
    """
    name = fields[0].upper()
    matrix = known.setdefault(name, MatrixEntries(name))
    if fields[1] == "0":  # a column begins with a node, which is not zero
        matrix.form = int(fields[2] or 0)
        matrix.is_complex = int(fields[3] or 1) in _COMPLEX
        matrix.is_polar = fields[5] not in ("", "0")
        return
    column = (int(fields[1]), int(fields[2] or 0))
    for begin in range(4, len(fields) - 3, 4):
        node, component, first, second = fields[begin : begin + 4]
        if not node:
            continue
        row = (int(node), int(component or 0))
        value: complex = read_real(first)
        if matrix.is_complex:
            other = read_real(second)
            value = (
                value * np.exp(1j * np.radians(other)) if matrix.is_polar else complex(value, other)
            )
        if matrix.terms.setdefault((row, column), value) != value:
            raise ValueError(f"the term {row}, {column} of matrix {name} has two values")


def build_matrix(matrix: MatrixEntries) -> tuple[MatrixTerms | None, str]:
    """Return the terms of a matrix, or None and the reason why it is not used.

    Of a symmetric matrix one half is given, and completed.
    """
    if matrix.form is None:
        return None, f"matrix {matrix.name} has no header (DMIG,{matrix.name},0,...)"
    if matrix.form not in (_SQUARE, _SYMMETRIC):
        kind = _FORMS.get(matrix.form, f"of form {matrix.form}")
        return None, f"matrix {matrix.name} is {kind}; square and symmetric ones are read"
    if not matrix.terms:
        return None, f"matrix {matrix.name} has no terms"
    terms = dict(matrix.terms)
    if matrix.form == _SYMMETRIC:
        for (row, column), value in matrix.terms.items():
            if terms.setdefault((column, row), value) != value:
                return None, (
                    f"matrix {matrix.name} is symmetric by its header, and the terms {row}, "
                    f"{column} and their transposes differ"
                )
    dofs = sorted({dof for pair in terms for dof in pair})
    place = {dof: index for index, dof in enumerate(dofs)}
    return MatrixTerms(
        size=(len(dofs), len(dofs)),
        rows=np.array([place[row] for row, _ in terms]),
        columns=np.array([place[column] for _, column in terms]),
        values=np.array(list(terms.values())),
        dofs=np.array(dofs),
    ), ""


# --- Nastran bulk data (.bdf, .nas, .fem, .dat, .pch): nodes, systems, edges, matrices (DMIG) -----

_CARD = re.compile(
    rb"^(INIT |SOL |CEND|BEGIN |GRID|DMIG|CORD[12]|GRDSET|INCLUDE |[A-Z][A-Z0-9]+\*? {1,12}\d+ |\$"
    rb"|(C(QUAD|TRIA|BAR|BEAM|ROD|TUBE|ELAS|BUSH|ON[MR]|SHEAR)|PLOTEL|RB|P(SHELL|COMP|BAR|BEAM)"
    rb"|MAT[1-9]|SPC|MPC|PARAM|CAERO|SPLINE)\w*\*? *,"
    rb"|(MKAERO[12]|FLFACT|AEROS?)\*?( *,| +[-+.\d]*\.\d*([-+]\d+)? ))",
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


def read_latin(path: Path) -> str:
    """Return the text of a file without the mark of UTF-8 that some editors write first."""
    return path.read_bytes().removeprefix(codecs.BOM_UTF8).decode("latin-1")


def read(path: Path) -> Iterator[Field]:
    """Read nodes, coordinate systems and edges of a deck, or of one of its parts."""
    return read_text(read_latin(path))


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
    if "," in line[:10]:  # further right it is that of a decimal
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
