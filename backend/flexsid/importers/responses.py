"""Frequency responses of a ground vibration test, from files or estimated from time data."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np

from flexsid import units
from flexsid.allowed import Allowed, Axes, LengthUnit, Metre, Name, Share
from flexsid.errors import BadInput
from flexsid.importers.matrices import convert_node_table
from flexsid.importers.modal_data.fuel_states import resolve_length_unit
from flexsid.importers.modal_data.inspection import list_unused_content
from flexsid.importers.modal_data.nodes import join_frames
from flexsid.importers.modal_data.options import parse_axes
from flexsid.importers.response_functions import convert_functions
from flexsid.importers.source import SourceFile, Sources
from flexsid.importers.vibration_records import VibrationRecord, compute_rate, find_records
from flexsid.records.modal_data import SpectralAveraging
from flexsid.sysid.spectra.response_estimators import (
    Estimator,
    Window,
    average_spectra,
    estimate_responses,
    find_block_length,
)

QUANTITIES = {"length": "displacement", "speed": "velocity", "acceleration": "acceleration"}
_QUANTITY_CODES = {"length": (8,), "speed": (11,), "acceleration": (12,)}
_FORCE_CODES = (9, 13)
_GENERAL = 1  # 0 is unknown, 1 general
_CODES = {
    2: "stress", 3: "strain", 8: "displacement", 9: "reaction force", 11: "velocity",
    12: "acceleration", 13: "excitation force", 15: "pressure",
}  # fmt: skip
"""Data set 58, records 8 to 11, field 1."""
_FORCE_LABELS = {
    **dict.fromkeys(("newton", "newtons", "n"), "N"),
    **dict.fromkeys(("lb", "lbs", "pound", "pounds"), "lbf"),
}
"""Labels of units of force; a force in lb is in lbf."""
_SAME_RATE = 1e-5  # relative; times of 1,000 samples printed to a thousandth of their interval
_ENDS = ("response_node", "response_direction", "reference_node", "reference_direction")
_AXES = {1: "x", 2: "y", 3: "z"}


@dataclass(frozen=True, slots=True, kw_only=True)
class ResponseOptions:
    """Options of measured frequency responses: units, axes of the geometry, fuel fraction.

    Units are required where the files state none: ``frequency_unit`` and ``phase_unit`` of
    frequency responses in columns or arrays, ``time_unit`` of time data.
    """

    name: Name
    response_unit: Annotated[
        str | None,
        Allowed(choices=("m/s2", "g", "in/s2", "ft/s2", "m/s", "in/s", "m", "mm", "in", "ft")),
    ] = None
    force_unit: Annotated[str | None, Allowed(choices=("N", "lbf"))] = None
    frequency_unit: Annotated[str | None, Allowed(choices=("Hz", "rad/s"))] = None
    phase_unit: Annotated[str | None, Allowed(choices=("deg", "rad"))] = None
    time_unit: Annotated[str | None, Allowed(choices=("s", "ms"))] = None
    fuel: Share = 0.0
    length_unit: LengthUnit | None = None
    axes: Axes = "aft right up"
    origin: tuple[Metre, Metre, Metre] = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class AveragingOptions:
    """Estimator of frequency responses, and averages, overlap and window of the spectra."""

    averages: Annotated[int, Allowed(ge=2, le=100_000)]
    estimator: Estimator = "H1"
    overlap: Annotated[float, Allowed(ge=0.0, le=0.95)] = 0.5
    window: Window = "hann"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RawResponses:
    """Frequency responses per unit force in SI, (M, n_outputs, n_references).

    ``nodes`` and ``directions`` are in structural axes. ``errors`` are the arrays of
    ``MeasuredResponses`` that responses estimated from time data have.
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
    averaging: SpectralAveraging | None = None
    errors: Mapping[str, np.ndarray]


@dataclass(frozen=True, slots=True)
class _Known:
    """A function of a file with the sign of its degrees of freedom."""

    source: SourceFile
    row: int
    sign: int

    def read(self, field: str) -> np.ndarray:
        return self.source.arrays[f"frf/{field}"][self.row]

    @property
    def values(self) -> np.ndarray:
        return self.sign * (self.read("real") + 1j * self.read("imaginary"))


def extract_responses(
    sources: Sources, options: ResponseOptions, averaging: AveragingOptions | None = None
) -> RawResponses:
    """Assemble the functions of files, or of their time data, into frequency responses.

    Parameters
    ----------
    sources, options
        Files, and units that they do not state.
    averaging
        Estimation from time data; None for files of frequency responses.

    Raises
    ------
    BadInput
        If the files hold no frequency responses, or too few for a full matrix, or a unit is not
        one of displacement, velocity or acceleration per force; as ``find_functions`` and
        ``find_records``, and as ``estimate_responses`` for time data.
    """
    frequency_unit, phase_unit = options.frequency_unit or "", options.phase_unit or ""
    sources = Sources(
        tuple(
            convert_node_table(convert_functions(source, frequency_unit, phase_unit))
            for source in sources.items
        )
    )
    records = find_records(sources)
    used: SpectralAveraging | None = None
    notes: list[str] = []
    if averaging is None and records:
        raise BadInput(
            f"{records[0][0].name} holds forces and responses over time; select estimator and "
            "averages, to estimate frequency responses from them",
            code="time-data",
        )
    if averaging is not None:
        estimated, used, notes = _estimate(records, options, averaging)
        sources = Sources((*(s for s in sources.items if "grid/id" in s.arrays), *estimated))
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
    response_unit = _resolve_unit(files, options, "response_unit")
    force_unit = _resolve_unit(files, options, "force_unit")
    dimension = units.lookup(response_unit).dimension
    if dimension not in QUANTITIES:
        raise BadInput(
            f"'{response_unit}' is a unit of {dimension}; expected a unit of displacement, "
            "velocity or acceleration",
            code="bad-unit",
        )
    factor = units.factor(response_unit, dimension)
    factor /= units.factor(force_unit, "force")
    for source in files:
        _check_quantities(source, dimension, response_unit, force_unit)
    outputs, references, known, excluded = _matrix(files)
    values = factor * _stack([[known[o, r].values for r in references] for o in outputs])
    bad = np.flatnonzero(~(np.abs(values) < 1e50).all(axis=(0, 2)))
    if bad.size:
        raise BadInput(
            f"responses at {_format_point(outputs[bad[0]])} are not finite; the file is damaged",
            code="not-finite",
        )
    errors = {}
    if used is not None:
        for name, size in (("std", factor), ("ordinary_coherence", 1.0)):
            errors[name] = size * _stack(
                [[known[o, r].read(name) for r in references] for o in outputs]
            )
        first = [known[o, references[0]].read("multiple_coherence") for o in outputs]
        errors["multiple_coherence"] = np.stack(first, axis=1)
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
        values=values,
        nodes=nodes,
        directions=directions,
        notes=(
            *excluded,
            *list_unused_content(sources),
            *notes,
            f"Responses are in {response_unit}/{force_unit}.",
        ),
        origin=", ".join(source.name for source in files),
        averaging=used,
        errors=errors,
    )


def _stack(functions: list[list[np.ndarray]]) -> np.ndarray:
    """Stack functions (M,) by output and reference as (M, n_outputs, n_references)."""
    return np.ascontiguousarray(np.moveaxis(np.array(functions), 2, 0))


def _estimate(
    records: Sequence[tuple[SourceFile, VibrationRecord]],
    options: ResponseOptions,
    averaging: AveragingOptions,
) -> tuple[list[SourceFile], SpectralAveraging, list[str]]:
    """Estimate frequency responses; records of the same channels are averaged together.

    Blocks have one length, so that tests of other channels, as of a roving sensor or force, have
    the same frequencies whatever the length of their records.
    """
    if not records:
        raise BadInput(
            "the files hold no forces and responses over time; import frequency responses without "
            "estimator and averages",
            code="no-records",
        )
    rate = _find_common_rate(records, options)
    groups: dict[object, list[tuple[SourceFile, VibrationRecord]]] = {}
    for source, record in records:
        key = record.force_dofs, record.response_dofs, record.force_unit, record.response_unit
        groups.setdefault(key, []).append((source, record))
    length = find_block_length(
        [[one.forces.shape[0] for _, one in group] for group in groups.values()],
        averaging.averages,
        averaging.overlap,
    )
    files, used = [], []
    for group in groups.values():
        source, record = group[0]
        spectra = average_spectra(
            *([(one.forces, one.responses) for _, one in group], rate, averaging.window),
            *(length, averaging.averages, averaging.overlap),
        )
        found = estimate_responses(spectra, averaging.estimator)
        used.append(
            SpectralAveraging(
                estimator=averaging.estimator,
                window=averaging.window,
                averages=spectra.n_blocks,
                overlap=averaging.overlap,
                block_s=length / rate,
                n_independent=spectra.n_independent,
                line_correlation=spectra.line_correlation,
            )
        )
        ends = [(x, f) for x in record.response_dofs for f in record.force_dofs]
        shape = (len(ends), found.omega.size)
        zero = np.zeros(len(ends), dtype=np.int64)
        multiple = np.repeat(found.multiple_coherence.T, len(record.force_dofs), axis=0)
        fields: dict[str, np.ndarray] = {
            "frequency": found.omega / (2.0 * np.pi),
            "real": np.moveaxis(np.real(found.values), 0, 2).reshape(shape),
            "imaginary": np.moveaxis(np.imag(found.values), 0, 2).reshape(shape),
            "std": np.moveaxis(found.std, 0, 2).reshape(shape),
            "ordinary_coherence": np.moveaxis(found.ordinary_coherence, 0, 2).reshape(shape),
            "multiple_coherence": multiple,
            "response_node": np.array([x.node for x, _ in ends]),
            "response_direction": np.array([x.direction for x, _ in ends]),
            "reference_node": np.array([f.node for _, f in ends]),
            "reference_direction": np.array([f.direction for _, f in ends]),
            "quantity": zero,
            "reference_quantity": zero,
            "unit": np.array([record.response_unit]),
        }
        for name in ("response_unit", "force_unit"):
            if stated := getattr(record, name):
                fields[name] = np.array([stated])
        named = ", ".join(one.name for one, _ in group)
        arrays = {f"frf/{name}": values for name, values in fields.items()}
        files.append(replace(source, name=named, arrays=arrays))
    notes = [_describe_averaging(one) for one in dict.fromkeys(used)]
    return files, min(used, key=lambda one: one.n_independent), notes


def _find_common_rate(
    records: Sequence[tuple[SourceFile, VibrationRecord]], options: ResponseOptions
) -> float:
    """Return the samples per second of all records; printed times differ by their digits."""
    rates = [compute_rate(source, one, options.time_unit or "") for source, one in records]
    for (source, _), rate in zip(records, rates, strict=True):
        if abs(rate - rates[0]) > _SAME_RATE * rates[0]:
            raise BadInput(
                f"{source.name} has {rate:.6g} samples per second, {records[0][0].name} "
                f"{rates[0]:.6g}; import them as two tests",
                code="other-rate",
            )
    return rates[0]


def _describe_averaging(used: SpectralAveraging) -> str:
    return (
        f"{used.estimator} from {used.averages} blocks of {used.block_s:.4g} s ({used.window} "
        f"window, {100.0 * used.overlap:.3g} % overlap), statistically {used.n_independent:.3g} "
        "independent ones."
    )


def _resolve_unit(files: Sequence[SourceFile], options: ResponseOptions, name: str) -> str:
    """Return the unit of responses or forces: that of the option, which no file contradicts."""
    given: str | None = getattr(options, name)
    stated = {
        source.name: str(source.arrays[f"frf/{name}"][0])
        for source in files
        if f"frf/{name}" in source.arrays
    }
    for source in files:
        unit = given or stated.get(source.name)
        if unit is None:
            raise BadInput(
                f"{source.name} does not state the {name.replace('_', ' ')}; expected it in the "
                f"file or as {name}",
                code="unit-needed",
                field=name,
            )
        own = stated.get(source.name, unit)
        first = given or stated[files[0].name]
        dimension = units.lookup(first).dimension
        if not np.isclose(units.factor(own, dimension), units.factor(first, dimension)):
            raise BadInput(
                f"{source.name} states the {name.replace('_', ' ')} {own}, {first} "
                f"{'was given' if given else f'is that of {files[0].name}'}; correct the unit",
                code="other-unit",
                field=name,
            )
    return given or stated[files[0].name]


def _format_point(point: tuple[int, int]) -> str:
    return f"{point[0]}+{_AXES[point[1]]}"


def _check_quantities(
    source: SourceFile, dimension: str, response_unit: str, force_unit: str
) -> None:
    """Reject responses that the file states to be of another quantity, or not per force."""
    expected = _QUANTITY_CODES[dimension]
    for name, allowed, what in (
        ("quantity", expected, f"{QUANTITIES[dimension]}s ({response_unit})"),
        ("reference_quantity", _FORCE_CODES, f"forces ({force_unit})"),
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
    for name, kind, unit, option in (
        ("unit", dimension, response_unit, "response_unit"),
        ("reference_unit", "force", force_unit, "force_unit"),
    ):
        labels = source.arrays.get(f"frf/{name}", np.array([""]))
        for label in sorted({str(label) for label in labels}):
            stated: str = _FORCE_LABELS.get(label.lower(), label) if kind == "force" else label
            if not units.is_known(stated) or units.dimension(stated) != kind:
                continue  # free text
            if not np.isclose(units.factor(stated, kind), units.factor(unit, kind)):
                what = "responses" if name == "unit" else "forces"
                raise BadInput(
                    f"{source.name}: the file gives its {what} in {label}, {unit} was given; "
                    "correct the unit",
                    code="other-unit",
                    field=option,
                )


def _matrix(
    files: Sequence[SourceFile],
) -> tuple[
    list[tuple[int, int]],
    list[tuple[int, int]],
    dict[tuple[tuple[int, int], tuple[int, int]], _Known],
    list[str],
]:
    """Return outputs measured for every reference, references, their functions, and notes."""
    known: dict[tuple[tuple[int, int], tuple[int, int]], _Known] = {}
    n_excluded = 0
    repeated: set[tuple[tuple[int, int], tuple[int, int]]] = set()
    for source in files:
        ends = [source.arrays[f"frf/{name}"].tolist() for name in _ENDS]
        for row, (node, direction, at, towards) in enumerate(zip(*ends, strict=True)):
            if abs(direction) not in _AXES or abs(towards) not in _AXES:
                n_excluded += 1
                continue
            sign = (1 if direction > 0 else -1) * (1 if towards > 0 else -1)
            pair = (node, abs(direction)), (at, abs(towards))
            one = _Known(source, row, sign)
            before = known.setdefault(pair, one)
            if before is not one and "frf/std" in source.arrays:  # estimated here
                repeated.add(pair)
                known[pair] = min(before, one, key=lambda each: float(each.read("std").mean()))
            elif before is not one and not np.array_equal(before.values, one.values):
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
    if repeated:
        notes.append(
            f"{len(repeated)} responses were measured in several tests (the first: "
            f"{' to '.join(map(_format_point, min(repeated)))}); of each, that with the smallest "
            "standard error is used."
        )
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
    return complete, references, known, notes


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
