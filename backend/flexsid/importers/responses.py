"""Frequency responses of a ground vibration test out of universal files."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexsid import units
from flexsid.errors import BadInput
from flexsid.importers.source import Source, Sources
from flexsid.importers.structure.axes import axes_of
from flexsid.importers.structure.nodes import frames_of
from flexsid.importers.structure.units import length_of

QUANTITIES = {"length": "displacement", "speed": "velocity", "acceleration": "acceleration"}
_AXES = {1: "x", 2: "y", 3: "z"}


@dataclass(frozen=True, slots=True, kw_only=True)
class ResponseAnswers:
    """What an analyst says of measured responses: units, axes of the geometry, loading."""

    name: str
    response_unit: str
    force_unit: str
    fuel: float = 0.0
    length_unit: str | None = None
    axes: str = "aft right up"
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RawResponses:
    """Responses per force in SI, (M, n_outputs, n_references); places in structural axes.

    ``driving`` pairs outputs with references at the same point in the same direction.
    """

    name: str
    fuel: float
    quantity: str
    outputs: tuple[str, ...]
    references: tuple[str, ...]
    frequency_hz: np.ndarray
    values: np.ndarray
    nodes: np.ndarray | None
    directions: np.ndarray | None
    notes: tuple[str, ...]
    origin: str


def extract_responses(sources: Sources, answers: ResponseAnswers) -> RawResponses:
    """Sort the measured functions of files into a matrix of responses.

    Raises
    ------
    BadInput
        If the files hold no responses, or too few to fill a matrix, or a unit is not that of
        a displacement, velocity or acceleration and of a force.
    """
    source = next((s for s in sources.items if "frf/frequency" in s.arrays), None)
    if source is None:
        raise BadInput("the files hold no frequency responses", code="no-responses")
    dimension = units.lookup(answers.response_unit).dimension
    if dimension not in QUANTITIES:
        raise BadInput(
            f"'{answers.response_unit}' is a unit of {dimension}; responses are displacements, "
            "velocities or accelerations",
            code="bad-unit",
        )
    factor = units.factor(answers.response_unit, dimension)
    factor /= units.factor(answers.force_unit, "force")
    outputs, references, values, notes = _matrix(source)
    bad = np.flatnonzero(~(np.abs(values) < 1e50).all(axis=(0, 2)))
    if bad.size:
        raise BadInput(
            f"the responses at {_label(outputs[bad[0]])} are not finite; the file is damaged",
            code="not-finite",
        )
    nodes = directions = None
    if any("grid/id" in s.arrays for s in sources.items):
        nodes, directions = _geometry(sources, answers, outputs)
    return RawResponses(
        name=answers.name,
        fuel=answers.fuel,
        quantity=QUANTITIES[dimension],
        outputs=tuple(_label(one) for one in outputs),
        references=tuple(_label(one) for one in references),
        frequency_hz=np.asarray(source.arrays["frf/frequency"], dtype=float),
        values=factor * values,
        nodes=nodes,
        directions=directions,
        notes=(
            *notes,
            f"Responses are in {answers.response_unit}/{answers.force_unit}.",
        ),
        origin=source.name,
    )


def _label(point: tuple[int, int]) -> str:
    return f"{point[0]}+{_AXES[point[1]]}"


def _matrix(
    source: Source,
) -> tuple[list[tuple[int, int]], list[tuple[int, int]], np.ndarray, list[str]]:
    found = source.arrays
    data = np.asarray(found["frf/real"]) + 1j * np.asarray(found["frf/imaginary"])
    ends = [
        np.asarray(found[f"frf/{name}"]).tolist()
        for name in (
            "response_node",
            "response_direction",
            "reference_node",
            "reference_direction",
        )
    ]
    known: dict[tuple[tuple[int, int], tuple[int, int]], np.ndarray] = {}
    left_out = 0
    for row, (node, direction, at, towards) in enumerate(zip(*ends, strict=True)):
        if abs(direction) not in _AXES or abs(towards) not in _AXES:
            left_out += 1
            continue
        sign = (1 if direction > 0 else -1) * (1 if towards > 0 else -1)
        known[(node, abs(direction)), (at, abs(towards))] = sign * data[row]
    references = sorted({reference for _, reference in known})
    outputs = sorted({output for output, _ in known})
    complete = [o for o in outputs if all((o, r) in known for r in references)]
    notes = []
    if left_out:
        notes.append(f"{left_out} functions are not of translations at a point: left out.")
    if len(complete) < len(outputs):
        notes.append(
            f"{len(outputs) - len(complete)} points were not measured for every reference: "
            "left out."
        )
    if not complete:
        raise BadInput(
            "the responses do not say at which points and in which directions they were measured, "
            "or no point was measured for every reference",
            code="no-responses",
        )
    values = np.stack(
        [np.stack([known[o, r] for r in references], axis=-1) for o in complete], axis=1
    )
    return complete, references, values, notes


def _geometry(
    sources: Sources, answers: ResponseAnswers, outputs: list[tuple[int, int]]
) -> tuple[np.ndarray | None, np.ndarray | None]:
    """Place and direction of every output in structural axes; None where one is missing."""
    frames, ids, places = frames_of(sources.items)
    row_of = {int(node): row for row, node in enumerate(ids)}
    if any(node not in row_of for node, _ in outputs):
        return None, None
    turn = axes_of(answers.axes)
    length = length_of(sources, answers.length_unit)
    rows = [row_of[node] for node, _ in outputs]
    local = np.zeros((len(outputs), 1, 6))
    for place, (_, axis) in enumerate(outputs):
        local[place, 0, axis - 1] = 1.0
    directions = np.array(
        [
            frames.turn(np.array([node]), one[None])[0, 0, :3]
            for (node, _), one in zip(outputs, local, strict=True)
        ]
    )
    nodes = length * ((places[rows] + np.asarray(answers.origin)) @ turn.T)
    return nodes, directions @ turn.T
