"""All that was found in a file, as fields of numbers."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from flexsid.importers.source import Field
from flexsid.importers.universal.blocks import Function
from flexsid.importers.universal.kinds import Found, Shape


def fields_of(found: Found) -> Iterator[Field]:
    """Fields that every reader of structures gives, and functions that were measured."""
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


def _shape_fields(shapes: list[Shape]) -> Iterator[Field]:
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


def _line_fields(found: Found) -> Iterator[Field]:
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


def _function_fields(found: Found) -> Iterator[Field]:
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
