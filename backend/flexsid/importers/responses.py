"""Frequency responses of a ground vibration test from universal files."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from flexsid import units
from flexsid.errors import BadInput
from flexsid.importers.modal_data.inspection import list_unused_content
from flexsid.importers.modal_data.nodes import join_frames
from flexsid.importers.modal_data.options import parse_axes
from flexsid.importers.modal_data.units import resolve_length_unit
from flexsid.importers.source import SourceFile, Sources

QUANTITIES = {"length": "displacement", "speed": "velocity", "acceleration": "acceleration"}
_QUANTITY_CODES = {"length": (8,), "speed": (11,), "acceleration": (12,)}
_FORCE_CODES = (9, 13)
_GENERAL = 1  # 0 is unknown, 1 general
_CODES = {
    2: "stress", 3: "strain", 8: "displacement", 9: "reaction force", 11: "velocity",
    12: "acceleration", 13: "excitation force", 15: "pressure",
}  # fmt: skip
"""Data set 58, records 8 to 11, field 1."""
_ENDS = ("response_node", "response_direction", "reference_node", "reference_direction")
_AXES = {1: "x", 2: "y", 3: "z"}


@dataclass(frozen=True, slots=True, kw_only=True)
class ResponseOptions:
    """Options of measured frequency responses: units, axes of the geometry, fuel fraction."""

    name: str
    response_unit: str
    force_unit: str
    fuel: float = 0.0
    length_unit: str | None = None
    axes: str = "aft right up"
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RawResponses:
    """Frequency responses per unit force in SI, (M, n_outputs, n_references).

    ``nodes`` and ``directions`` are in structural axes.
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


def extract_responses(sources: Sources, options: ResponseOptions) -> RawResponses:
    """Assemble the measured functions of files into a matrix of frequency responses.

    Raises
    ------
    BadInput
        If the files hold no frequency responses, or too few for a full matrix, or a unit is not
        one of displacement, velocity or acceleration per force.
    """
    files = sources.list_holders("frf/frequency")
    if not files:
        raise BadInput("the files hold no frequency responses", code="no-responses")
    frequency = files[0].arrays["frf/frequency"]
    for other in files[1:]:
        own = other.arrays["frf/frequency"]
        if own.shape != frequency.shape or not np.allclose(own, frequency, rtol=1e-6):
            raise BadInput(
                f"the frequencies of {other.name} differ from those of {files[0].name}; import "
                "them as two tests, or export them at the same frequencies",
                code="unequal-lengths",
            )
    dimension = units.lookup(options.response_unit).dimension
    if dimension not in QUANTITIES:
        raise BadInput(
            f"'{options.response_unit}' is a unit of {dimension}; expected a unit of displacement, "
            "velocity or acceleration",
            code="bad-unit",
        )
    factor = units.factor(options.response_unit, dimension)
    factor /= units.factor(options.force_unit, "force")
    for source in files:
        _check_quantities(source, dimension, options)
    outputs, references, values, notes = _matrix(files)
    bad = np.flatnonzero(~(np.abs(values) < 1e50).all(axis=(0, 2)))
    if bad.size:
        raise BadInput(
            f"responses at {_format_point(outputs[bad[0]])} are not finite; the file is damaged",
            code="not-finite",
        )
    nodes = directions = None
    if sources.has("grid/id"):
        nodes, directions = _geometry(sources, options, outputs)
    return RawResponses(
        name=options.name,
        fuel=options.fuel,
        quantity=QUANTITIES[dimension],
        outputs=tuple(_format_point(one) for one in outputs),
        references=tuple(_format_point(one) for one in references),
        frequency_hz=frequency,
        values=factor * values,
        nodes=nodes,
        directions=directions,
        notes=(
            *notes,
            *list_unused_content(sources),
            f"Responses are in {options.response_unit}/{options.force_unit}.",
        ),
        origin=", ".join(source.name for source in files),
    )


def _format_point(point: tuple[int, int]) -> str:
    return f"{point[0]}+{_AXES[point[1]]}"


def _check_quantities(source: SourceFile, dimension: str, options: ResponseOptions) -> None:
    """Reject responses that the file states to be of another quantity, or not per force."""
    expected = _QUANTITY_CODES[dimension]
    for name, allowed, what in (
        ("quantity", expected, f"{QUANTITIES[dimension]}s ({options.response_unit})"),
        ("reference_quantity", _FORCE_CODES, f"forces ({options.force_unit})"),
    ):
        codes = source.arrays[f"frf/{name}"]
        wrong = np.flatnonzero((codes > _GENERAL) & ~np.isin(codes, allowed))
        if wrong.size:
            code = int(codes[wrong[0]])
            raise BadInput(
                f"{source.name}: {wrong.size} of {codes.size} responses are of "
                f"{_CODES.get(code, f'data of type {code}')} by the file, expected {what}; "
                "correct the unit, or export the functions to a separate file",
                code="other-quantity",
            )
    for label in sorted(set(source.arrays["frf/unit"].tolist())):
        try:
            known = units.lookup(label)
        except BadInput:
            continue  # free text
        if known.dimension == dimension and not np.isclose(
            units.factor(label, dimension), units.factor(options.response_unit, dimension)
        ):
            raise BadInput(
                f"{source.name}: the file gives its responses in {label}, {options.response_unit} "
                "was given; correct the unit",
                code="other-unit",
                field="response_unit",
            )


def _matrix(
    files: Sequence[SourceFile],
) -> tuple[list[tuple[int, int]], list[tuple[int, int]], np.ndarray, list[str]]:
    known: dict[tuple[tuple[int, int], tuple[int, int]], np.ndarray] = {}
    n_excluded = 0
    for source in files:
        found = source.arrays
        data = found["frf/real"] + 1j * found["frf/imaginary"]
        ends = [found[f"frf/{name}"].tolist() for name in _ENDS]
        for row, (node, direction, at, towards) in enumerate(zip(*ends, strict=True)):
            if abs(direction) not in _AXES or abs(towards) not in _AXES:
                n_excluded += 1
                continue
            sign = (1 if direction > 0 else -1) * (1 if towards > 0 else -1)
            pair = (node, abs(direction)), (at, abs(towards))
            if not np.array_equal(known.setdefault(pair, sign * data[row]), sign * data[row]):
                raise BadInput(
                    f"{source.name}: the response of {_format_point(pair[0])} to "
                    f"{_format_point(pair[1])} is repeated with other values; "
                    "retain one measurement of each",
                    code="duplicate-response",
                )
    references = sorted({reference for _, reference in known})
    outputs = sorted({output for output, _ in known})
    complete = [o for o in outputs if all((o, r) in known for r in references)]
    notes = []
    if n_excluded:
        notes.append(f"{n_excluded} functions are not translations at a point and are excluded.")
    if len(complete) < len(outputs):
        notes.append(
            f"{len(outputs) - len(complete)} points were not measured for every reference and are "
            "excluded."
        )
    if not complete:
        raise BadInput(
            "the responses have no points and directions, or no point was measured for every "
            "reference; export the functions with their nodes",
            code="no-responses",
        )
    values = np.stack(
        [np.stack([known[o, r] for r in references], axis=-1) for o in complete], axis=1
    )
    return complete, references, values, notes


def _geometry(
    sources: Sources, options: ResponseOptions, outputs: list[tuple[int, int]]
) -> tuple[np.ndarray | None, np.ndarray | None]:
    """Return location and direction of outputs in structural axes; None if a node is missing."""
    frames, ids, places = join_frames(sources.items)
    row_of = {int(node): row for row, node in enumerate(ids)}
    if any(node not in row_of for node, _ in outputs):
        return None, None
    turn = parse_axes(options.axes)
    length = resolve_length_unit(sources, options.length_unit)
    rows = [row_of[node] for node, _ in outputs]
    local = np.zeros((len(outputs), 1, 6))
    for index, (_, axis) in enumerate(outputs):
        local[index, 0, axis - 1] = 1.0
    directions = np.array(
        [
            frames.turn(np.array([node]), one[None])[0, 0, :3]
            for (node, _), one in zip(outputs, local, strict=True)
        ]
    )
    nodes = length * ((places[rows] + np.asarray(options.origin)) @ turn.T)
    return nodes, directions @ turn.T
