"""Readers of the data sets of a universal file by number, and their fields of numbers."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

import numpy as np

from flexsid.errors import UnreadableFile
from flexsid.importers.modal_files import EXACT
from flexsid.importers.nastran.bulk import Point, list_geometry
from flexsid.importers.source import Field, read_integer, split_reals
from flexsid.importers.universal.blocks import (
    FUNCTION_TYPES,
    Block,
    Function,
    UnusableDataSet,
    join_parts,
    read_function,
)

# --- Readers of the data sets of a universal file, by number --------------------------------------

_BEAMS = {11, 21, 22, 23, 24}
_MODES = {2: "normal", 3: "complex", 7: "complex"}
_COMPLEX = {5, 6}
_ORTHOGONAL = 1e-4
_NOT_SET = 1e30
"""Modal mass above which a writer has not set it: some write the largest number of their format."""


class Contradiction(Exception):
    """Two data sets of a file with different definitions."""


@dataclass(slots=True)
class Shape:
    """One mode: its values at nodes, three displacements and three rotations each."""

    number: int
    frequency_hz: float
    damping: float
    mass: float
    values: dict[int, list[complex]]


@dataclass(slots=True)
class FoundKind:
    """Content of all data sets of a file, with the labels and units of the file.

    ``has_systems``: the file defines coordinate systems, read or rejected. ``exported`` is the
    export system of a node of data set 2411; by the definition of that data set its
    coordinates are in the part system.
    """

    grids: dict[int, tuple[int, Point, int]] = field(default_factory=dict)
    frames: dict[int, tuple[int, int, Point]] = field(default_factory=dict)
    has_systems: bool = False
    exported: dict[int, int] = field(default_factory=dict)
    shapes: list[Shape] = field(default_factory=list)
    lines: list[int] = field(default_factory=list)
    elements: list[list[int]] = field(default_factory=list)
    functions: list[Function] = field(default_factory=list)
    units: dict[str, float] = field(default_factory=dict)
    header: list[str] = field(default_factory=list)
    refused: list[str] = field(default_factory=list)

    def count_content(self) -> tuple[int, ...]:
        """Return the sizes of the content, to which ``truncate`` returns."""
        return tuple(len(part) for part in self._list_content())

    def truncate(self, sizes: tuple[int, ...]) -> None:
        """Remove what was added since: of a data set that is refused no part is read."""
        for part, size in zip(self._list_content(), sizes, strict=True):
            while len(part) > size:
                if isinstance(part, dict):
                    part.popitem()
                else:
                    part.pop()

    def _list_content(self) -> list[dict[Any, Any] | list[Any]]:
        dicts: list[dict[Any, Any] | list[Any]] = [self.grids, self.frames, self.exported]
        return [*dicts, self.shapes, self.lines, self.elements, self.functions]


def _nodes_15(found: FoundKind, block: Block) -> None:
    for index in _filled(block):
        line = block.lines[index].partition("%")[0]
        label, cp, cd = (
            block.convert(index, read_integer, line[10 * i : 10 * i + 10].strip()) for i in range(3)
        )
        place = block.convert(index, split_reals, line[40:])
        block.check_count(index, place, 3)
        _add_node(found, label, cp, place, cd)


def _nodes_2411_781(found: FoundKind, block: Block) -> None:
    rows = _filled(block)
    if len(rows) % 2:
        raise UnusableDataSet("its nodes do not have two records each")
    for head, place in zip(rows[::2], rows[1::2], strict=True):
        label, system, cd = _first_three(block.integers(head))
        if block.kind == 2411:
            found.exported[label], system = system, 0
        _add_node(found, label, system, block.reals(place, 3), cd)


def _filled(block: Block, start: int = 0) -> list[int]:
    """Return the indices of the lines that are not blank."""
    return [index for index in range(start, len(block.lines)) if block.lines[index].strip()]


def _add_node(found: FoundKind, label: int, cp: int, place: list[float], cd: int) -> None:
    node = (cp, tuple(place), cd)
    if found.grids.setdefault(label, node) != node:
        raise Contradiction(f"node {label} has two different definitions")


def _first_three(numbers: list[int]) -> list[int]:
    if len(numbers) < 3:
        raise UnusableDataSet(f"a record has {len(numbers)} whole numbers, 3 are expected")
    return numbers[:3]


def _frames_18(found: FoundKind, block: Block) -> None:
    found.has_systems = True
    for row in range(0, len(block.lines) - 3, 4):
        number, kind, reference = _first_three(block.integers(row))
        numbers = block.reals(row + 2, 6) + block.reals(row + 3, 3)
        o, x, p = np.array(numbers).reshape(3, 3)
        along, in_plane = x - o, p - o
        normal = np.cross(np.cross(along, in_plane), along)  # z, in the plane of x and p
        _add_frame(found, number, kind + 1, reference, [o, o + normal, x])


def _frames_2420(found: FoundKind, block: Block) -> None:
    """Read data set 2420: matrix rows are unit vectors in the part system, then the origin."""
    found.has_systems = True
    n_lines = len(block.lines)
    if (n_lines - 2) % 6:  # two of the part: number and name
        raise UnusableDataSet("its coordinate systems do not have six records each")
    for row in range(2, n_lines, 6):
        number, kind, _ = _first_three(block.integers(row))
        if kind not in (0, 1, 2):
            raise UnusableDataSet(
                f"coordinate system {number} is of type {kind}; 0, 1 or 2 is expected"
            )
        matrix = np.array([block.reals(index, 3) for index in range(row + 2, row + 6)])
        axes, origin = matrix[:3], matrix[3]
        if not np.allclose(axes @ axes.T, np.eye(3), atol=_ORTHOGONAL) or np.linalg.det(axes) < 0:
            raise UnusableDataSet(
                f"the matrix of coordinate system {number} does not consist of right-handed "
                "unit vectors"
            )
        _add_frame(found, number, kind + 1, 0, [origin, origin + axes[2], origin + axes[0]])


def _add_frame(
    found: FoundKind, number: int, kind: int, reference: int, points: list[np.ndarray]
) -> None:
    frame = (kind, reference, tuple(np.concatenate(points).tolist()))
    if found.frames.setdefault(number, frame) != frame:
        raise Contradiction(f"coordinate system {number} has two different definitions")


def _lines_82(found: FoundKind, block: Block) -> None:
    count = _first_three(block.integers(0))[1]
    nodes = [node for index in _filled(block, 2) for node in block.integers(index)]
    if len(nodes) < count or any(nodes[count:]):
        raise UnusableDataSet(f"it has {len(nodes)} nodes, its header states {count}")
    found.lines += [0, *nodes[:count]]


def _elements_2412(found: FoundKind, block: Block) -> None:
    row = 0
    while row < len(block.lines):
        head = block.integers(row)
        block.check_count(row, head, 6)
        row += 2 if head[1] in _BEAMS else 1
        nodes: list[int] = []
        while len(nodes) < head[5]:
            nodes += block.integers(row)
            row += 1
        block.check_count(row - 1, nodes, head[5])
        found.elements.append(nodes)


def _shape_55(found: FoundKind, block: Block) -> None:
    counts = (block.integers(6) + [0] * 4)[:4]
    numbers = block.reals(7, 4, 6, counts[1])  # some programs state 4 of complex modes, and write 6
    _append_shape(found, block, 5, counts[3], numbers, 8)


def _shape_2414(found: FoundKind, block: Block) -> None:
    location = block.integers(2)[0]
    if location != 1:
        raise UnusableDataSet("it holds data on elements, data at nodes are expected")
    kinds = block.integers(8)
    mode = (block.integers(9) + [0] * 6)[5]
    times = (block.reals(11) + [0.0] * 6)[:6]
    eigen = (block.reals(12) + [0.0] * 6)[:6]
    _, frequency, _, mass, viscous, hysteretic = times
    numbers = [frequency, mass, viscous, hysteretic]
    if _MODES.get(kinds[1]) == "complex" and any(eigen[:2]):
        numbers = eigen
    for index, line in enumerate(block.lines[3:8], start=3):
        if line.startswith(EXACT):
            exact = block.convert(index, split_reals, line.removeprefix(EXACT))
            if len(exact) == 3 and np.isclose(exact[0], frequency, rtol=1e-4):
                numbers = [exact[0], exact[2], exact[1], 0.0]
    _append_shape(found, block, 8, mode, numbers, 13)


def _append_shape(
    found: FoundKind, block: Block, kinds_at: int, mode: int, numbers: list[float], start: int
) -> None:
    """Append a mode whose nodes begin at line ``start``, with as many values as stated."""
    kinds = block.integers(kinds_at)
    block.check_count(kinds_at, kinds, 6)
    _, analysis, _, _, data_type, count = kinds
    if analysis not in _MODES:
        raise UnusableDataSet(
            f"its analysis is of type {analysis}; mode shapes (2, 3, 7) are expected"
        )
    if count not in (3, 6):
        raise UnusableDataSet(f"it has {count} values at each node, 3 or 6 are expected")
    if _MODES[analysis] == "complex" and len(numbers) >= 6:
        eigenvalue = complex(numbers[0], numbers[1])
        size = abs(eigenvalue)
        frequency, mass = size / (2.0 * np.pi), 0.0
        damping = -eigenvalue.real / size if size > 0 else 0.0
    else:
        frequency, mass, viscous, hysteretic = (numbers + [0.0] * 4)[:4]
        damping = viscous or 0.5 * hysteretic
    if mass > _NOT_SET:
        mass = 0.0
        found.refused.append(f"the modal mass of mode {mode} is not set and taken as unknown")
    is_complex = data_type in _COMPLEX
    values: dict[int, list[complex]] = {}
    n_values = count * (2 if is_complex else 1)
    rows = iter(_filled(block, start))
    for head in rows:
        first = block.integers(head)
        block.check_count(head, first, 1)
        node = first[0]
        read: list[float] = []
        while len(read) < n_values and (index := next(rows, None)) is not None:
            try:
                read += block.reals(index)
            except UnusableDataSet as error:
                raise UnusableDataSet(f"{error}, node {node}") from error
        if len(read) != n_values:
            raise UnusableDataSet(f"it has {len(read)} values at node {node}, not {n_values}")
        if node in values:
            raise UnusableDataSet(f"node {node} is repeated")
        parts = np.array(read)
        shape = parts[::2] + 1j * parts[1::2] if is_complex else parts.astype(complex)
        values[node] = [*map(complex, shape), *[0j] * (6 - count)]
    if not values:
        raise UnusableDataSet("it holds no node")
    found.shapes.append(Shape(mode, float(frequency), float(damping), float(mass), values))


def _header_151(found: FoundKind, block: Block) -> None:
    found.header += [line.strip() for line in block.lines[:2] if line.strip() not in ("", "NONE")]


def _units_164(found: FoundKind, block: Block) -> None:
    factors = [number for index in _filled(block, 1) for number in block.reals(index)]
    if not 2 <= len(factors) <= 4:
        raise UnusableDataSet(f"it has {len(factors)} factors of units, 3 or 4 are expected")
    length, force = factors[:2]
    if not (length > 0 and force > 0):
        raise UnusableDataSet(
            f"its factors of length and force, {length:g} and {force:g}, are not positive"
        )
    units = {"length": 1.0 / length, "force": 1.0 / force}  # file units per SI unit
    if found.units not in ({}, units):
        raise Contradiction("its units are not those of an earlier data set 164")
    found.units = units


def _function_58(found: FoundKind, block: Block) -> None:
    found.functions.append(read_function(block))


READERS = {
    15: _nodes_15,
    18: _frames_18,
    55: _shape_55,
    58: _function_58,
    82: _lines_82,
    151: _header_151,
    164: _units_164,
    781: _nodes_2411_781,
    2411: _nodes_2411_781,
    2412: _elements_2412,
    2414: _shape_2414,
    2420: _frames_2420,
}


# --- Content of a universal file as fields of numbers ---------------------------------------------

_GLOBAL = 1
"""Largest number of an undefined coordinate system that denotes the global one."""
_GLOBAL_POINTS = (0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0)


def list_fields(found: FoundKind) -> Iterator[Field]:
    """Yield the fields common to all readers of modal data, and the measured functions."""
    yield from list_geometry(
        {
            label: (_known_system(found, cp), xyz, _known_system(found, cd))
            for label, (cp, xyz, cd) in found.grids.items()
        },
        {
            number: (kind, _known_system(found, reference), points)
            for number, (kind, reference, points) in found.frames.items()
        },
    )
    found.refused += _note_undefined_systems(found)
    yield from _shape_fields(found)
    yield from _line_fields(found)
    for name, factor in found.units.items():
        yield Field(f"unit/{name}", np.array([factor]))
    if found.header:
        yield Field("header", np.array(found.header))
    yield from _function_fields(found)
    if found.refused:
        yield Field("refused", np.array(found.refused))


def _known_system(found: FoundKind, number: int) -> int:
    """Return the number of a defined system, else that of the global one.

    If a file defines systems of its own, an undefined number is retained, and rejected on use.
    """
    if number in found.frames:
        return number
    return number if found.has_systems and number > _GLOBAL else 0


def _note_undefined_systems(found: FoundKind) -> list[str]:
    """Return notes on systems that nodes refer to and no data set defines."""
    named = {number for cp, _, cd in found.grids.values() for number in (cp, cd)}
    left = sorted(number for number in named if number and not _known_system(found, number))
    exported = sorted({n for n in found.exported.values() if _is_local(found, n)})
    notes = []
    if left:
        notes.append(
            f"coordinate systems {', '.join(map(str, left))} are not defined by a data set and "
            "are treated as global"
        )
    if exported:
        notes.append(
            f"nodes of data set 2411 are exported from coordinate systems "
            f"{', '.join(map(str, exported))}; their coordinates are read in the part system, "
            "as defined for the data set"
        )
    return notes


def _is_local(found: FoundKind, number: int) -> bool:
    """Return whether a system is defined and differs from the global one."""
    if number not in found.frames:
        return False
    kind, _, points = found.frames[number]
    return kind != 1 or not np.allclose(points, _GLOBAL_POINTS, atol=1e-9)


def _shape_fields(found: FoundKind) -> Iterator[Field]:
    shapes = found.shapes
    if not shapes:
        return
    nodes = sorted({node for shape in shapes for node in shape.values})
    short = [place for place, shape in enumerate(shapes, start=1) if len(shape.values) < len(nodes)]
    if short:
        found.refused.append(
            f"{len(short)} mode shapes (first: {short[0]}) lack nodes; these values are zero"
        )
    zero = [0j] * 6
    values = np.array([[shape.values.get(node, zero) for node in nodes] for shape in shapes])
    numbers = [shape.number for shape in shapes]
    if len(set(numbers)) != len(numbers) or min(numbers) < 1:
        numbers = list(range(1, len(shapes) + 1))
    frequency = np.array([shape.frequency_hz for shape in shapes])
    yield Field("shape/number", np.array(numbers))
    yield Field("shape/radians", 2.0 * np.pi * frequency)
    yield Field("shape/node", np.array(nodes))
    yield Field("shape/values", np.ascontiguousarray(np.real(values)))
    if np.any(np.imag(values) != 0):
        yield Field("shape/imaginary", np.ascontiguousarray(np.imag(values)))
    for name in ("damping", "mass"):
        known = np.array([getattr(shape, name) for shape in shapes])
        if (known > 0).any():
            yield Field(f"shape/{name}", known)


def _line_fields(found: FoundKind) -> Iterator[Field]:
    """Yield lines between nodes as pairs: trace lines, and the edges of elements."""
    ends = [pair for pair in pairwise(found.lines) if all(pair)]
    for nodes in found.elements:
        ends += pairwise([*nodes, nodes[0]] if len(nodes) > 2 else nodes)
    if ends:
        yield Field("line/nodes", np.unique(np.sort(np.array(ends), axis=1), axis=0))


def _function_fields(found: FoundKind) -> Iterator[Field]:
    responses: dict[bytes, list[Function]] = {}
    taken: set[str] = set()
    functions = join_parts(found.functions)
    for number, function in enumerate(functions, start=1):
        if function.is_response:
            key = np.round(function.abscissa, 9).tobytes()
            responses.setdefault(key, []).append(function)
            continue
        name = function.name or f"function {number}"
        name = name if name not in taken else f"{name} ({number})"
        taken.add(name)
        clock = f"function/{name} x"
        yield Field(clock, function.abscissa)
        yield Field(f"function/{name}", np.real(function.values).copy(), function.unit, clock)
        if np.iscomplexobj(function.values):
            imaginary = np.imag(function.values).copy()
            yield Field(f"function/{name} imaginary", imaginary, function.unit, clock)
    if responses:
        if len(responses) > 1:
            counts = ", ".join(str(len(one)) for one in responses.values())
            raise UnreadableFile(
                f"its frequency responses have {len(responses)} different sets of frequencies "
                f"({counts} responses); export them at one set, or in one file per set.",
                code="unequal-lengths",
            )
        (best,) = responses.values()
        yield Field("frf/frequency", best[0].abscissa)
        values = np.stack([function.values for function in best])
        yield Field("frf/real", np.ascontiguousarray(np.real(values)))
        yield Field("frf/imaginary", np.ascontiguousarray(np.imag(values)))
        for name in best[0].codes:
            yield Field(f"frf/{name}", np.array([function.codes[name] for function in best]))
        yield Field("frf/unit", np.array([function.unit for function in best]))
        references = np.array([function.reference_unit for function in best])
        yield Field("frf/reference_unit", references)
        found.refused += dict.fromkeys(function.note for function in best if function.note)
        others = Counter(f.kind for f in functions if not f.is_response)
        found.refused += [
            f"{count} {FUNCTION_TYPES.get(kind, f'functions of type {kind}')}, which are not "
            "complex frequency responses"
            for kind, count in sorted(others.items())
        ]
