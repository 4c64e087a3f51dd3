"""Readers of the data sets of a universal file, by number."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from flexsid.importers.modal_files import EXACT
from flexsid.importers.nastran.frames import Point
from flexsid.importers.universal.blocks import (
    Block,
    Function,
    UnusableDataSet,
    integers_in,
    numbers_in,
    read_function,
)

_BEAMS = {11, 21, 22, 23, 24}
_MODES = {2: "normal", 3: "complex", 7: "complex"}
_COMPLEX = {5, 6}
_ORTHOGONAL = 1e-4


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


def _nodes_15(found: FoundKind, block: Block) -> None:
    for line in block.lines:
        if line.strip():
            label, cp, cd = (int(line[10 * i : 10 * i + 10]) for i in range(3))
            _add_node(found, label, cp, line[40:], cd)


def _nodes_2411_781(found: FoundKind, block: Block) -> None:
    for head, place in zip(block.lines[::2], block.lines[1::2], strict=True):
        label, system, cd = integers_in(head)[:3]
        if block.kind == 2411:
            found.exported[label], system = system, 0
        _add_node(found, label, system, place, cd)


def _add_node(found: FoundKind, label: int, cp: int, place: str, cd: int) -> None:
    node = (cp, _three(numbers_in(place)), cd)
    if found.grids.setdefault(label, node) != node:
        raise Contradiction(f"node {label} has two different definitions")


def _three(numbers: list[float]) -> Point:
    if len(numbers) < 3:
        raise UnusableDataSet(f"it has {len(numbers)} coordinates at a node, 3 are expected")
    return tuple(numbers[:3])


def _frames_18(found: FoundKind, block: Block) -> None:
    found.has_systems = True
    lines = block.lines
    for row in range(0, len(lines) - 3, 4):
        number, kind, reference = integers_in(lines[row])[:3]
        numbers = numbers_in(lines[row + 2]) + numbers_in(lines[row + 3])
        o, x, p = np.array(numbers[:9]).reshape(3, 3)
        along, in_plane = x - o, p - o
        normal = np.cross(np.cross(along, in_plane), along)  # z, in the plane of x and p
        _add_frame(found, number, kind + 1, reference, [o, o + normal, x])


def _frames_2420(found: FoundKind, block: Block) -> None:
    """Read data set 2420: matrix rows are unit vectors in the part system, then the origin."""
    found.has_systems = True
    lines = block.lines[2:]  # of the part: number and name
    if len(lines) % 6:
        raise UnusableDataSet("its coordinate systems do not have six records each")
    for row in range(0, len(lines), 6):
        number, kind = integers_in(lines[row])[:2]
        if kind not in (0, 1, 2):
            raise UnusableDataSet(
                f"coordinate system {number} is of type {kind}; 0, 1 or 2 is expected"
            )
        matrix = np.array([_three(numbers_in(line)) for line in lines[row + 2 : row + 6]])
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
    count = integers_in(block.lines[0])[1]
    nodes = [node for line in block.lines[2:] for node in integers_in(line)]
    found.lines += [0, *nodes[:count]]


def _elements_2412(found: FoundKind, block: Block) -> None:
    lines = block.lines
    row = 0
    while row < len(lines):
        head = integers_in(lines[row])
        row += 2 if head[1] in _BEAMS else 1
        nodes: list[int] = []
        while len(nodes) < head[5]:
            nodes += integers_in(lines[row])
            row += 1
        found.elements.append(nodes)


def _shape_55(found: FoundKind, block: Block) -> None:
    lines = block.lines
    mode = (integers_in(lines[6]) + [0] * 4)[3]
    _append_shape(found, integers_in(lines[5]), mode, numbers_in(lines[7]), lines[8:])


def _shape_2414(found: FoundKind, block: Block) -> None:
    lines = block.lines
    location = integers_in(lines[2])[0]
    if location != 1:
        raise UnusableDataSet("it holds data on elements, data at nodes are expected")
    kinds = integers_in(lines[8])
    mode = (integers_in(lines[9]) + [0] * 6)[5]
    times = (numbers_in(lines[11]) + [0.0] * 6)[:6]
    eigen = (numbers_in(lines[12]) + [0.0] * 6)[:6]
    _, frequency, _, mass, viscous, hysteretic = times
    numbers = [frequency, mass, viscous, hysteretic]
    if _MODES.get(kinds[1]) == "complex" and any(eigen[:2]):
        numbers = eigen
    for line in lines[3:8]:
        if line.startswith(EXACT):
            exact = [float(part) for part in line.removeprefix(EXACT).split()]
            if len(exact) == 3 and np.isclose(exact[0], frequency, rtol=1e-4):
                numbers = [exact[0], exact[2], exact[1], 0.0]
    _append_shape(found, kinds, mode, numbers, lines[13:])


def _append_shape(
    found: FoundKind, kinds: list[int], mode: int, numbers: list[float], lines: list[str]
) -> None:
    _, analysis, _, _, data_type, count = kinds[:6]
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
    is_complex = data_type in _COMPLEX
    values: dict[int, list[complex]] = {}
    n_values = count * (2 if is_complex else 1)
    rows = (line for line in lines if line.strip())
    for head in rows:
        node = integers_in(head)[0]
        read: list[float] = []
        while len(read) < n_values and (line := next(rows, None)) is not None:
            read += numbers_in(line)
        if len(read) < n_values:
            raise UnusableDataSet(f"it has {len(read)} values at node {node}, not {n_values}")
        parts = np.array(read[:n_values])
        shape = parts[::2] + 1j * parts[1::2] if is_complex else parts.astype(complex)
        values[node] = [*map(complex, shape), *[0j] * (6 - count)]
    if not values:
        raise UnusableDataSet("it holds no node")
    found.shapes.append(Shape(mode, float(frequency), float(damping), float(mass), values))


def _header_151(found: FoundKind, block: Block) -> None:
    found.header += [line.strip() for line in block.lines[:2] if line.strip() not in ("", "NONE")]


def _units_164(found: FoundKind, block: Block) -> None:
    factors = [number for line in block.lines[1:] for number in numbers_in(line)]
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
