"""Universal files (.uff, .unv): nodes, coordinate systems, mode shapes, lines, functions.

Data sets 15, 18, 55, 58 (text and binary), 82, 151, 164, 2411, 2412 and 2414 are read.
Numbers are taken by their shape rather than by column, as writers keep to columns loosely
and let negative numbers touch.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path

import numpy as np

from flexsid.errors import UnreadableFile
from flexsid.importers.modal_files import EXACT
from flexsid.importers.source import Content, Field
from flexsid.importers.universal_blocks import (
    Block,
    Function,
    Refused,
    data_sets,
    integers_in,
    numbers_in,
    read_function,
)

_BEAMS = {11, 21, 22, 23, 24}
_MODES = {2: "normal", 3: "complex", 7: "complex"}
_COMPLEX = {5, 6}


def recognises(head: bytes) -> bool:
    """Tell whether the first line that is not empty opens a data set."""
    first = next((line.strip() for line in head.splitlines() if line.strip()), b"")
    return first == b"-1"


def read(path: Path) -> Content:
    """Read the data sets of a universal file.

    Raises
    ------
    UnreadableFile
        If no data set can be used; the message says what each of them is.
    """
    return Content(_fields(path))


@dataclass(slots=True)
class _Shape:
    number: int
    frequency_hz: float
    damping: float
    mass: float
    values: dict[int, list[complex]]


@dataclass(slots=True)
class _Found:
    grids: dict[int, tuple[int, int, tuple[float, ...]]] = field(default_factory=dict)
    frames: dict[int, tuple[int, int, tuple[float, ...]]] = field(default_factory=dict)
    shapes: list[_Shape] = field(default_factory=list)
    lines: list[int] = field(default_factory=list)
    elements: list[list[int]] = field(default_factory=list)
    functions: list[Function] = field(default_factory=list)
    units: dict[str, float] = field(default_factory=dict)
    header: list[str] = field(default_factory=list)
    refused: list[str] = field(default_factory=list)


def _fields(path: Path) -> Iterator[Field]:
    found = _Found()
    for place, block in enumerate(data_sets(path), start=1):
        reader = _READERS.get(block.kind)
        if reader is None:
            found.refused.append(f"data set {place} is of kind {block.kind}, which is not read")
            continue
        try:
            reader(found, block)
        except (Refused, ValueError, IndexError) as error:
            found.refused.append(f"data set {place} (kind {block.kind}): {error}")
    content = list(_content(found))
    if not any(f.path.split("/")[0] in ("grid", "shape", "function", "frf") for f in content):
        raise UnreadableFile(
            "no data set of this file can be used: "
            + ("; ".join(found.refused) or "it holds none")
            + ".",
            code="nothing-usable",
        )
    yield from content


def _nodes_15(found: _Found, block: Block) -> None:
    lines = block.lines
    for line in lines:
        if line.strip():
            label, cp, cd = (int(line[10 * i : 10 * i + 10]) for i in range(3))
            found.grids[label] = (cp, cd, _three(numbers_in(line[40:])))


def _nodes_2411(found: _Found, block: Block) -> None:
    lines = block.lines
    for head, place in zip(lines[::2], lines[1::2], strict=True):
        label, cp, cd = integers_in(head)[:3]
        found.grids[label] = (cp, cd, _three(numbers_in(place)))


def _three(numbers: list[float]) -> tuple[float, ...]:
    if len(numbers) < 3:
        raise Refused(f"three coordinates are expected, {len(numbers)} are there")
    return tuple(numbers[:3])


def _frames_18(found: _Found, block: Block) -> None:
    lines = block.lines
    for row in range(0, len(lines) - 3, 4):
        number, kind, reference = integers_in(lines[row])[:3]
        o, x, p = np.array(numbers_in(lines[row + 2]) + numbers_in(lines[row + 3]))[:9].reshape(
            3, 3
        )
        along, in_plane = x - o, p - o
        normal = np.cross(np.cross(along, in_plane), along)  # z, in the plane of x and p
        points = np.concatenate([o, o + normal, x])
        found.frames[number] = (kind + 1, reference, tuple(map(float, points)))


def _lines_82(found: _Found, block: Block) -> None:
    lines = block.lines
    count = integers_in(lines[0])[1]
    nodes = [node for line in lines[2:] for node in integers_in(line)]
    found.lines += [0, *nodes[:count]]


def _elements_2412(found: _Found, block: Block) -> None:
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


def _shape_55(found: _Found, block: Block) -> None:
    lines = block.lines
    kinds = integers_in(lines[5])
    _, analysis, _, _, data_type, count = kinds[:6]
    integers = integers_in(lines[6])
    numbers = numbers_in(lines[7])
    mode = integers[3] if len(integers) > 3 else 0
    _append_shape(found, analysis, data_type, count, mode, numbers, lines[8:])


def _shape_2414(found: _Found, block: Block) -> None:
    lines = block.lines
    location = integers_in(lines[2])[0]
    if location != 1:
        raise Refused("it holds data on elements, data at nodes are expected")
    _, analysis, _, _, data_type, count = integers_in(lines[8])[:6]
    mode = (integers_in(lines[9]) + [0] * 6)[5]
    times = (numbers_in(lines[11]) + [0.0] * 6)[:6]
    eigen = (numbers_in(lines[12]) + [0.0] * 6)[:6]
    _, frequency, _, mass, viscous, hysteretic = times
    numbers = [frequency, mass, viscous, hysteretic]
    if _MODES.get(analysis) == "complex" and any(eigen[:2]):
        numbers = eigen
    for line in lines[3:8]:
        if line.startswith(EXACT):
            exact = [float(part) for part in line.removeprefix(EXACT).split()]
            if len(exact) == 3 and np.isclose(exact[0], frequency, rtol=1e-4):
                numbers = [exact[0], exact[2], exact[1], 0.0]
    _append_shape(found, analysis, data_type, count, mode, numbers, lines[13:])


def _append_shape(
    found: _Found,
    analysis: int,
    data_type: int,
    count: int,
    mode: int,
    numbers: list[float],
    lines: list[str],
) -> None:
    if analysis not in _MODES:
        raise Refused(f"its analysis is of type {analysis}; mode shapes (2, 3, 7) are expected")
    if count not in (3, 6):
        raise Refused(f"it has {count} values at each node, 3 or 6 are expected")
    if _MODES[analysis] == "complex" and len(numbers) >= 6:
        eigenvalue = complex(numbers[0], numbers[1])
        size = abs(eigenvalue)
        frequency, damping, mass = (
            size / (2.0 * np.pi),
            (-eigenvalue.real / size if size > 0 else 0.0),
            0.0,
        )
    else:
        frequency, mass, viscous, hysteretic = (numbers + [0.0] * 4)[:4]
        damping = viscous or 0.5 * hysteretic
    is_complex = data_type in _COMPLEX
    values: dict[int, list[complex]] = {}
    wanted = count * (2 if is_complex else 1)
    row = 0
    while row < len(lines):
        if not lines[row].strip():
            row += 1
            continue
        node = integers_in(lines[row])[0]
        row += 1
        read: list[float] = []
        while len(read) < wanted:
            read += numbers_in(lines[row])
            row += 1
        parts = np.array(read[:wanted])
        shape = parts[::2] + 1j * parts[1::2] if is_complex else parts.astype(complex)
        values[node] = [*map(complex, shape), *[0j] * (6 - count)]
    if not values:
        raise Refused("it holds no node")
    found.shapes.append(_Shape(mode, float(frequency), float(damping), float(mass), values))


def _header_151(found: _Found, block: Block) -> None:
    lines = block.lines
    found.header += [line.strip() for line in lines[:2] if line.strip() not in ("", "NONE")]


def _units_164(found: _Found, block: Block) -> None:
    lines = block.lines
    factors = [number for line in lines[1:] for number in numbers_in(line)]
    length, force = factors[:2]
    if length > 0 and force > 0:  # in file units per SI unit
        found.units = {"length": 1.0 / length, "force": 1.0 / force}


def _skip(found: _Found, block: Block) -> None:
    """Data sets that tell nothing of modes."""


def _function_58(found: _Found, block: Block) -> None:
    found.functions.append(read_function(block))


_READERS = {
    15: _nodes_15,
    18: _frames_18,
    55: _shape_55,
    58: _function_58,
    82: _lines_82,
    151: _header_151,
    164: _units_164,
    2411: _nodes_2411,
    2412: _elements_2412,
    2414: _shape_2414,
}


def _content(found: _Found) -> Iterator[Field]:
    if found.grids:
        labels = sorted(found.grids)
        # A coordinate system that no data set defines is the global one, whatever its number.
        known = {0, *found.frames}
        rows = [found.grids[label] for label in labels]
        yield Field("grid/id", np.array(labels, dtype=np.int64))
        for column, name in enumerate(("cp", "cd")):
            systems = [row[column] if row[column] in known else 0 for row in rows]
            yield Field(f"grid/{name}", np.array(systems, dtype=np.int64))
        yield Field("grid/xyz", np.array([row[2] for row in rows]))
    if found.frames:
        numbers = sorted(found.frames)
        kinds, references, points = zip(*(found.frames[n] for n in numbers), strict=True)
        references = [r if r in found.frames else 0 for r in references]
        yield Field("frame/id", np.array(numbers, dtype=np.int64))
        yield Field("frame/kind", np.array(kinds, dtype=np.int64))
        yield Field("frame/reference", np.array(references, dtype=np.int64))
        yield Field("frame/points", np.array(points))
    yield from _shape_fields(found.shapes)
    yield from _line_fields(found)
    for name, factor in found.units.items():
        yield Field(f"unit/{name}", np.array([factor]))
    if found.header:
        yield Field("header", np.array(found.header, dtype=np.str_))
    yield from _function_fields(found)
    if found.refused:
        yield Field("refused", np.array(found.refused, dtype=np.str_))


def _shape_fields(shapes: list[_Shape]) -> Iterator[Field]:
    if not shapes:
        return
    nodes = sorted({node for shape in shapes for node in shape.values})
    zero = [0j] * 6
    values = np.array([[shape.values.get(node, zero) for node in nodes] for shape in shapes])
    numbers = [shape.number for shape in shapes]
    if len(set(numbers)) != len(numbers) or min(numbers) < 1:
        numbers = list(range(1, len(shapes) + 1))
    frequency = np.array([shape.frequency_hz for shape in shapes])
    yield Field("shape/number", np.array(numbers, dtype=np.int64))
    yield Field("shape/radians", 2.0 * np.pi * frequency)
    yield Field("shape/node", np.array(nodes, dtype=np.int64))
    yield Field("shape/values", np.ascontiguousarray(np.real(values)))
    if np.any(np.imag(values) != 0):
        yield Field("shape/imaginary", np.ascontiguousarray(np.imag(values)))
    for name in ("damping", "mass"):
        known = np.array([getattr(shape, name) for shape in shapes])
        if (known > 0).any():
            yield Field(f"shape/{name}", known)


def _line_fields(found: _Found) -> Iterator[Field]:
    """Lines between nodes, as pairs: trace lines, and the edges of elements."""
    pairs: set[tuple[int, int]] = set()
    for first, second in pairwise(found.lines):
        if first and second:
            pairs.add((min(first, second), max(first, second)))
    for nodes in found.elements:
        closed = [*nodes, nodes[0]] if len(nodes) > 2 else nodes
        for first, second in pairwise(closed):
            pairs.add((min(first, second), max(first, second)))
    if pairs:
        yield Field("line/nodes", np.array(sorted(pairs), dtype=np.int64))


def _function_fields(found: _Found) -> Iterator[Field]:
    responses: dict[bytes, list[Function]] = {}
    taken: set[str] = set()
    for number, function in enumerate(found.functions, start=1):
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
    if responses:  # the set of lines that most responses have
        best = max(responses.values(), key=len)
        yield Field("frf/frequency", best[0].abscissa)
        values = np.stack([function.values for function in best])
        yield Field("frf/real", np.ascontiguousarray(np.real(values)))
        yield Field("frf/imaginary", np.ascontiguousarray(np.imag(values)))
        for name in (
            "response_node",
            "response_direction",
            "reference_node",
            "reference_direction",
            "quantity",
        ):
            numbers = [getattr(function, name) for function in best]
            yield Field(f"frf/{name}", np.array(numbers, dtype=np.int64))
