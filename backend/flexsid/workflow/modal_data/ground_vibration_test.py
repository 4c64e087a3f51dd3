"""Ground vibration tests: measured responses, identified modes, and their modal table."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from flexsid.allowed import Allowed, Id
from flexsid.errors import BadInput
from flexsid.importers.modal_data import RawModalData
from flexsid.importers.modal_data.options import TO_BODY
from flexsid.importers.responses import (
    AveragingOptions,
    RawResponses,
    ResponseOptions,
    extract_responses,
)
from flexsid.importers.source import Sources
from flexsid.importers.vibration_records import find_records
from flexsid.records.aircraft import Aircraft
from flexsid.records.job import Job
from flexsid.records.modal_data import (
    DiagramPole,
    FoundMode,
    FoundModes,
    MeasuredResponses,
    ModalKind,
    ModalTable,
    ModeIdentification,
    ResponseFunction,
    Stabilisation,
)
from flexsid.records.run import Progress, ReportProgress
from flexsid.storage.store import Store
from flexsid.sysid.modes.assurance import rotate_complex_shapes
from flexsid.sysid.modes.measured_modes import (
    MeasuredModes,
    PoleColumn,
    StabilizationPole,
    compute_mode_indicator,
    compute_stabilisation,
    find_columns,
    identify_modes,
)
from flexsid.workflow.modal_data.modal_import import match_modes, store_modal_data

# --- Ground vibration tests: measured responses, identified modes, and their modal table ----------

_SAME_POLE = 0.01  # relative difference in frequency of a pole and a mode
_HANN_BANDWIDTH = 1.5  # equivalent noise bandwidth, times the length of the block
_RESOLVED = 4.0  # least half-power bandwidth of a mode in resolution bandwidths


@dataclass(frozen=True, slots=True, kw_only=True)
class ModeSearch:
    """Responses, frequency band of the mode search, and the highest model order.

    ``poles`` are numbers of poles in the stabilisation diagram, from 1, that are selected by hand:
    the modes are fitted from these alone. By default the selection is automatic.
    """

    responses_id: Id
    low_hz: Annotated[float | None, Allowed(gt=0.0, le=100_000.0)] = None
    high_hz: Annotated[float | None, Allowed(gt=0.0, le=100_000.0)] = None
    order: Annotated[int, Allowed(ge=4, le=80, text="Highest model order.")] = 40
    poles: Annotated[
        tuple[Id, ...],
        Allowed(
            max_length=500,
            text="Poles of the diagram selected by hand; default: automatic.",
        ),
    ] = ()


@dataclass(frozen=True, slots=True)
class ModeTask:
    """A mode search with the samples of its responses: (n_omega,) [Hz], and per reference.

    ``std`` is that of responses estimated from time data.
    """

    search: ModeSearch
    record: MeasuredResponses
    frequency_hz: np.ndarray
    responses: np.ndarray
    std: np.ndarray | None


def store_responses(store: Store, aircraft: Aircraft, raw: RawResponses) -> MeasuredResponses:
    """Store measured responses."""
    assert aircraft.id is not None
    arrays = {"frequency": raw.frequency_hz, "values": raw.values, **raw.errors}
    if raw.nodes is not None and raw.directions is not None:
        arrays |= {"nodes": raw.nodes, "directions": raw.directions}
    with store.transaction():
        return store.measured_responses.add(
            MeasuredResponses(
                aircraft_id=aircraft.id,
                name=raw.name,
                fuel=raw.fuel,
                quantity=raw.quantity,
                outputs=raw.outputs,
                references=raw.references,
                arrays={name: store.arrays.put(values) for name, values in arrays.items()},
                notes=raw.notes,
                origin=raw.origin,
                averaging=raw.averaging,
            )
        )


def read_function(
    store: Store, responses_id: int, response_dof: str, reference_dof: str
) -> ResponseFunction:
    """Read one frequency response, with coherence and standard deviation if it is estimated.

    Raises
    ------
    BadInput
        If there is no such degree of freedom.
    """
    record = store.measured_responses.get(responses_id)
    for name, known, what in (
        (response_dof, record.outputs, "response_dof"),
        (reference_dof, record.references, "reference_dof"),
    ):
        if name not in known:
            raise BadInput(
                f"'{record.name}' has no point '{name}'; expected one of {', '.join(known[:12])}",
                code="unknown-point",
                field=what,
            )
    column = record.outputs.index(response_dof), record.references.index(reference_dof)

    def read(name: str) -> np.ndarray | None:
        if name not in record.arrays:
            return None
        values = np.asarray(store.arrays.get(record.arrays[name]))
        one = values[:, column[0]] if values.ndim == 2 else values[:, column[0], column[1]]
        return np.ascontiguousarray(one)

    values = read("values")
    assert values is not None
    return ResponseFunction(
        title=record.name,
        quantity=record.quantity,
        output=response_dof,
        reference=reference_dof,
        frequency_hz=np.asarray(store.arrays.get(record.arrays["frequency"])),
        real=np.ascontiguousarray(np.real(values)),
        imaginary=np.ascontiguousarray(np.imag(values)),
        std=read("std"),
        multiple_coherence=read("multiple_coherence"),
        ordinary_coherence=read("ordinary_coherence"),
    )


def identify_mode_search(store: Store, search: ModeSearch) -> tuple[object, ...]:
    """Check a mode search, and return all records on which its result depends.

    Raises
    ------
    BadInput
        If the band has too few frequencies.
    UnknownRecord
        If there are no such responses.
    """
    record = store.measured_responses.get(search.responses_id)
    _select_band(store, record, search)
    return (record,)


def prepare_mode_search(store: Store, search: ModeSearch) -> ModeTask:
    """Return a mode search with its samples."""
    record = store.measured_responses.get(search.responses_id)
    hertz, inside = _select_band(store, record, search)
    responses = np.asarray(store.arrays.get(record.arrays["values"]))
    std = None
    if "std" in record.arrays:
        std = np.asarray(store.arrays.get(record.arrays["std"]))[inside]
    return ModeTask(search, record, hertz[inside], responses[inside], std)


def find_modes(
    task: ModeTask, report: ReportProgress = lambda progress: None
) -> ModeIdentification:
    """Identify modes by maximum likelihood, with standard deviations and stabilisation diagram."""
    record, responses = task.record, task.responses
    omega = 2.0 * np.pi * task.frequency_hz
    driving = tuple(
        (record.outputs.index(reference), index)
        for index, reference in enumerate(record.references)
        if reference in record.outputs
    )
    report(Progress(fraction=0.1, message="Computing the stabilisation diagram"))
    poles = compute_stabilisation(omega, responses, min(task.search.order, omega.size // 2 - 1))
    report(Progress(fraction=0.5, message="Fitting the modes"))
    selected = _select_poles(poles, task.search.poles)
    columns = tuple(PoleColumn(pole.value, pole.participation) for pole in selected)
    modes = identify_modes(
        *(omega, responses, columns or find_columns(poles), record.quantity, driving),
        1.0 if record.averaging is None else record.averaging.line_correlation,
        task.std,
        is_fixed=bool(selected),
    )
    shapes, collinearity = rotate_complex_shapes(modes.shapes)
    return ModeIdentification(
        diagram=_build_diagram(task, poles, modes),
        found=FoundModes(
            responses_id=task.search.responses_id,
            fit_error=float(np.linalg.norm(modes.fitted - responses) / np.linalg.norm(responses)),
            scaled=modes.scaled,
            items=tuple(
                FoundMode(
                    frequency_hz=float(modes.omega[k]) / (2.0 * np.pi),
                    std_hz=float(modes.std_omega[k]) / (2.0 * np.pi),
                    damping=float(modes.damping[k]),
                    std_damping=float(modes.std_damping[k]),
                    n_orders=_count_orders(poles, float(modes.omega[k])),
                    collinearity=float(collinearity[k]),
                )
                for k in range(modes.omega.size)
            ),
            unmodelled_hz=tuple(float(one) / (2.0 * np.pi) for one in modes.unmodelled),
            unresolved_hz=_find_unresolved(record, modes),
            poles=tuple(
                _describe_pole(number, pole)
                for number, pole in enumerate(poles, start=1)
                if pole.stable
            ),
            selected=tuple(map(_describe_pole, task.search.poles, selected)),
        ),
        shapes=np.ascontiguousarray(np.real(shapes)),
        quadrature=np.ascontiguousarray(np.imag(shapes)),
    )


def _select_poles(
    poles: tuple[StabilizationPole, ...], numbers: tuple[int, ...]
) -> list[StabilizationPole]:
    if len(set(numbers)) < len(numbers) or not all(0 < one <= len(poles) for one in numbers):
        raise BadInput(
            f"poles {', '.join(map(str, numbers))} are selected; expected different numbers from 1 "
            f"to {len(poles)}, those of the stabilisation diagram of this band and order",
            code="unknown-pole",
        )
    return [poles[number - 1] for number in numbers]


def _describe_pole(number: int, pole: StabilizationPole) -> DiagramPole:
    return DiagramPole(
        number=number,
        order=pole.order,
        frequency_hz=pole.omega / (2.0 * np.pi),
        damping=pole.damping,
    )


def _find_unresolved(record: MeasuredResponses, modes: MeasuredModes) -> tuple[float, ...]:
    """Return the modes whose damping is biased by the length of the blocks of the spectra [Hz].

    Notes
    -----
    The resolution bandwidth of a Hann window is 1.5 over the length of the block. It should be at
    most a quarter of the half-power bandwidth 2 zeta f of a mode (Bendat and Piersol 2010,
    Random Data, chapter 8). Blocks of one period of a periodic force have no such bias.
    """
    if record.averaging is None or record.averaging.window != "hann":
        return ()
    least = _RESOLVED * _HANN_BANDWIDTH / record.averaging.block_s
    hertz = modes.omega / (2.0 * np.pi)
    return tuple(hertz[2.0 * modes.damping * hertz < least].tolist())


def _build_diagram(
    task: ModeTask, poles: tuple[StabilizationPole, ...], modes: MeasuredModes
) -> Stabilisation:
    return Stabilisation(
        title=task.record.name,
        quantity=task.record.quantity,
        frequency_hz=task.frequency_hz,
        magnitude=np.sqrt(np.mean(np.abs(task.responses) ** 2, axis=(1, 2))),
        fitted=np.sqrt(np.mean(np.abs(modes.fitted) ** 2, axis=(1, 2))),
        indicator=compute_mode_indicator(task.responses),
        pole_hz=np.array([pole.omega for pole in poles]) / (2.0 * np.pi),
        pole_order=np.array([pole.order for pole in poles]),
        pole_damping=np.array([pole.damping for pole in poles]),
        stable=np.array([pole.stable for pole in poles], dtype=bool),
        stable_frequency=np.array([pole.stable_frequency for pole in poles], dtype=bool),
        mode_hz=modes.omega / (2.0 * np.pi),
        unmodelled_hz=modes.unmodelled / (2.0 * np.pi),
        selected=task.search.poles,
    )


def store_found_modes(
    store: Store,
    identified: ModeIdentification,
    name: str,
    indices: tuple[int, ...] | None = None,
    template_id: int | None = None,
) -> ModalTable:
    """Store modes identified from responses as a modal table of a GVT.

    Parameters
    ----------
    store, identified
        Store of the responses, and the modes identified from them.
    name
        Name of the table.
    indices
        Indices of the modes to store, from 0; all by default.
    template_id
        Table whose numbers and names are assigned where shapes agree (MAC of 0.7 or more), so
        that damping is matched by name.

    Raises
    ------
    BadInput
        If the locations of the points are unknown, or an index is out of range.
    """
    found = identified.found
    record = store.measured_responses.get(found.responses_id)
    selected = list(range(len(found.items))) if indices is None else list(indices)
    if not selected or any(not 0 <= place < len(found.items) for place in selected):
        raise BadInput(
            f"{len(found.items)} modes were found; select at least one, by index from 0",
            code="unknown-mode",
        )
    if "nodes" not in record.arrays:
        raise BadInput(
            "the locations of the points are unknown; import the responses with their geometry",
            code="no-nodes",
        )
    places = np.asarray(store.arrays.get(record.arrays["nodes"]), dtype=float)
    directions = np.asarray(store.arrays.get(record.arrays["directions"]), dtype=float)
    modes = [found.items[place] for place in selected]
    labels = [int(output.split("+")[0]) for output in record.outputs]
    ids = np.unique(labels)
    rows = {int(node): row for row, node in enumerate(ids)}
    nodes = np.zeros((ids.size, 3))
    for output, node in enumerate(labels):
        nodes[rows[node]] = places[output]

    def place_at_nodes(values: np.ndarray) -> np.ndarray:
        placed = np.zeros((1, len(selected), ids.size, 6))
        for output, node in enumerate(labels):
            moved = values[selected][:, [output]] * directions[output] * TO_BODY
            placed[0, :, rows[node], :3] += moved
        return placed

    shape = place_at_nodes(identified.shapes)
    imaginary = identified.quadrature
    numbers: tuple[int, ...] = tuple(range(1, len(selected) + 1))
    named = None
    if template_id is not None:
        numbers, named = match_modes(store, template_id, record.fuel, nodes, shape[0, :, :, :3])
    aircraft = store.aircraft.get(record.aircraft_id)
    raw = RawModalData(
        name=name,
        kind=ModalKind.GVT,
        fuel=np.array([record.fuel]),
        numbers=numbers,
        omega=2.0 * np.pi * np.array([[mode.frequency_hz for mode in modes]]),
        zeta=np.array([[mode.damping for mode in modes]]),
        omega_std=2.0 * np.pi * np.array([[mode.std_hz for mode in modes]]),
        zeta_std=np.array([[mode.std_damping for mode in modes]]),
        mass=np.ones((1, len(selected))) if found.scaled else None,
        node_ids=ids,
        nodes=nodes,
        shape=shape,
        quadrature=None if imaginary is None else place_at_nodes(imaginary),
        collinearity=np.array([[mode.collinearity for mode in modes]]),
        lines=np.empty((0, 2), dtype=np.int32),
        points={},
        origin=f"identified from {record.name}",
        notes=(
            *record.notes,
            _describe_selection(found),
            "Shapes are scaled by the driving points to one kg m2."
            if found.scaled
            else "Shapes are scaled to one, as no driving point was measured.",
        ),
    )
    return store_modal_data(store, aircraft, raw, named)


def _describe_selection(found: FoundModes) -> str:
    if not found.selected:
        return "Poles were selected automatically."
    listed = ", ".join(f"{one.frequency_hz:.2f} Hz (order {one.order})" for one in found.selected)
    return f"Poles were selected by hand in the stabilisation diagram: {listed}."


def _select_band(
    store: Store, record: MeasuredResponses, search: ModeSearch
) -> tuple[np.ndarray, np.ndarray]:
    """Return the frequencies [Hz], and which of them are in the band of the search."""
    hertz = np.asarray(store.arrays.get(record.arrays["frequency"]), dtype=float)
    low = hertz[0] if search.low_hz is None else search.low_hz
    high = hertz[-1] if search.high_hz is None else search.high_hz
    inside = (hertz >= low) & (hertz <= high) & (hertz > 0)
    if inside.sum() < 10:
        raise BadInput(
            f"{int(inside.sum())} frequencies lie between {low:g} and {high:g} Hz; at least 10 are"
            f" needed, and responses span {hertz[0]:g} to {hertz[-1]:g} Hz",
            code="too-few-frequencies",
        )
    return hertz, inside


def _count_orders(poles: tuple[StabilizationPole, ...], omega: float) -> int:
    """Count the model orders with a stable pole at a frequency."""
    near = (pole for pole in poles if abs(pole.omega / omega - 1.0) < _SAME_POLE)
    return len({pole.order for pole in near if pole.stable})


# --- Frequency responses of a ground vibration test estimated from uploaded time data -------------


@dataclass(frozen=True, slots=True, kw_only=True)
class ResponseEstimation:
    """Upload of time data, the aircraft that was tested, units and averaging."""

    upload_id: str
    aircraft_id: int
    options: ResponseOptions
    averaging: AveragingOptions


@dataclass(frozen=True, slots=True)
class ResponseTask:
    """Contents of the files, units and averaging."""

    sources: Sources
    request: ResponseEstimation


@dataclass(frozen=True, slots=True, kw_only=True)
class StoredResponses:
    """Measured responses that an estimation stored."""

    responses_id: int


def check_estimation(store: Store, sources: Sources, request: ResponseEstimation) -> None:
    """Reject a request whose aircraft does not exist, or whose files hold no time data.

    Raises
    ------
    BadInput, UnknownRecord
    """
    store.aircraft.get(request.aircraft_id)
    if not find_records(sources):
        raise BadInput("the files hold no forces and responses over time", code="no-records")


def estimate_responses(task: ResponseTask, report: ReportProgress) -> RawResponses:
    """Estimate frequency responses; raises as ``extract_responses``."""
    report(Progress(fraction=0.1, message="Averaging the spectra"))
    return extract_responses(task.sources, task.request.options, task.request.averaging)


def store_estimated_responses(
    store: Store, job: Job, request: ResponseEstimation, raw: RawResponses
) -> StoredResponses:
    """Store estimated responses with coherences and standard errors."""
    record = store_responses(store, store.aircraft.get(request.aircraft_id), raw)
    assert record.id is not None
    return StoredResponses(responses_id=record.id)
