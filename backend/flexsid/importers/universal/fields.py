"""Content of a universal file as fields of numbers."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from flexsid.errors import UnreadableFile
from flexsid.importers.nastran.frames import list_geometry
from flexsid.importers.source import Field
from flexsid.importers.universal.blocks import FUNCTION_TYPES, Function
from flexsid.importers.universal.kinds import FoundKind

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
        others = Counter(f.kind for f in found.functions if not f.is_response)
        found.refused += [
            f"{count} {FUNCTION_TYPES.get(kind, f'functions of type {kind}')}, which are not "
            "complex frequency responses"
            for kind, count in sorted(others.items())
        ]
