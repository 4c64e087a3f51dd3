"""Ground vibration tests: measured responses, identified modes, and their modal table."""

from __future__ import annotations

import threading
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

from flexsid.errors import BadInput
from flexsid.importers.modal_data import RawModalData
from flexsid.importers.modal_data.options import TO_BODY
from flexsid.importers.responses import RawResponses
from flexsid.importers.source import Sources
from flexsid.records.aircraft import Aircraft
from flexsid.records.modal_data import (
    FoundMode,
    FoundModes,
    MeasuredResponses,
    ModalKind,
    ModalTable,
    Orthogonality,
    Stabilisation,
)
from flexsid.storage.arrays import Arrays
from flexsid.storage.store import Store
from flexsid.sysid.modes.assurance import compute_mass_orthogonality, compute_real_shapes
from flexsid.sysid.modes.measured_modes import MeasuredModes, identify_modes
from flexsid.sysid.modes.polyreference import (
    StabilizationPole,
    compute_mode_indicator,
    compute_stabilisation,
    find_columns,
)
from flexsid.workflow.modal_data.modal_import import store_modal_data
from flexsid.workflow.modal_data.modal_tables import TO_STRUCTURE, interpolate_shapes, open_modes
from flexsid.workflow.modal_data.mode_matching import match_modes

_SAME_POLE = 0.01  # relative difference in frequency of a pole and a mode


@dataclass(frozen=True, slots=True, kw_only=True)
class ModeSearch:
    """Frequency band of the mode search, and the highest model order."""

    low_hz: float | None = None
    high_hz: float | None = None
    order: int = 40


@dataclass(frozen=True, slots=True)
class _Search:
    """What a mode search depends on; measured samples by the hash of their content."""

    samples: Arrays = field(compare=False)
    frequency: str
    values: str
    quantity: str
    driving: tuple[tuple[int, int], ...]
    settings: ModeSearch


@dataclass(frozen=True, slots=True, eq=False)
class _Identification:
    omega: np.ndarray
    responses: np.ndarray
    poles: tuple[StabilizationPole, ...]
    modes: MeasuredModes


_identifying = threading.Lock()


def store_responses(store: Store, aircraft: Aircraft, raw: RawResponses) -> MeasuredResponses:
    """Store measured responses."""
    assert aircraft.id is not None
    arrays = {"frequency": raw.frequency_hz, "values": raw.values}
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
            )
        )


def compute_stabilisation_diagram(
    store: Store, responses_id: int, settings: ModeSearch
) -> Stabilisation:
    """Compute poles by model order over the band, with the mean response."""
    record = store.measured_responses.get(responses_id)
    found = _identify(store, record, settings)
    modes, poles = found.modes, found.poles
    size = np.sqrt(np.mean(np.abs(found.responses) ** 2, axis=(1, 2)))
    fitted = np.sqrt(np.mean(np.abs(modes.fitted) ** 2, axis=(1, 2)))
    return Stabilisation(
        title=record.name,
        quantity=record.quantity,
        frequency_hz=found.omega / (2.0 * np.pi),
        magnitude=size,
        fitted=fitted,
        indicator=compute_mode_indicator(found.responses),
        pole_hz=np.array([pole.omega for pole in poles]) / (2.0 * np.pi),
        pole_order=np.array([pole.order for pole in poles]),
        pole_damping=np.array([pole.damping for pole in poles]),
        stable=np.array([pole.stable for pole in poles], dtype=bool),
        stable_frequency=np.array([pole.stable_frequency for pole in poles], dtype=bool),
        mode_hz=modes.omega / (2.0 * np.pi),
        unmodelled_hz=modes.unmodelled / (2.0 * np.pi),
    )


def find_modes(store: Store, responses_id: int, settings: ModeSearch) -> FoundModes:
    """Identify modes by maximum likelihood, with standard deviations of their parameters."""
    found = _identify(store, store.measured_responses.get(responses_id), settings)
    modes = found.modes
    error = np.linalg.norm(modes.fitted - found.responses) / np.linalg.norm(found.responses)
    _, straight = compute_real_shapes(modes.shapes)
    return FoundModes(
        responses_id=responses_id,
        fit_error=float(error),
        scaled=modes.scaled,
        items=tuple(
            FoundMode(
                frequency_hz=float(modes.omega[k]) / (2.0 * np.pi),
                std_hz=float(modes.std_omega[k]) / (2.0 * np.pi),
                damping=float(modes.damping[k]),
                std_damping=float(modes.std_damping[k]),
                n_orders=_count_orders(found.poles, float(modes.omega[k])),
                collinearity=float(straight[k]),
            )
            for k in range(modes.omega.size)
        ),
        unmodelled_hz=tuple(float(one) / (2.0 * np.pi) for one in modes.unmodelled),
    )


def store_found_modes(
    store: Store,
    responses_id: int,
    settings: ModeSearch,
    name: str,
    indices: tuple[int, ...] | None = None,
    template_id: int | None = None,
) -> ModalTable:
    """Store modes identified from responses as a modal table of a GVT.

    Parameters
    ----------
    store, responses_id, settings
        Responses and settings of the mode search.
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
    record = store.measured_responses.get(responses_id)
    modes = _identify(store, record, settings).modes
    selected = list(range(modes.omega.size)) if indices is None else list(indices)
    if not selected or any(not 0 <= place < modes.omega.size for place in selected):
        raise BadInput(
            f"{modes.omega.size} modes were found; select at least one, by index from 0",
            code="unknown-mode",
        )
    if "nodes" not in record.arrays:
        raise BadInput(
            "the locations of the points are unknown; import the responses with their geometry",
            code="no-nodes",
        )
    places = np.asarray(store.arrays.get(record.arrays["nodes"]), dtype=float)
    directions = np.asarray(store.arrays.get(record.arrays["directions"]), dtype=float)
    real, _ = compute_real_shapes(modes.shapes[selected])
    labels = [int(output.split("+")[0]) for output in record.outputs]
    ids = np.unique(labels)
    rows = {int(node): row for row, node in enumerate(ids)}
    nodes = np.zeros((ids.size, 3))
    shape = np.zeros((1, len(selected), ids.size, 6))
    for output, node in enumerate(labels):
        nodes[rows[node]] = places[output]
        shape[0, :, rows[node], :3] += real[:, [output]] * directions[output] * TO_BODY
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
        omega=modes.omega[None, selected],
        zeta=modes.damping[None, selected],
        mass=np.ones((1, len(selected))) if modes.scaled else None,
        node_ids=ids,
        nodes=nodes,
        shape=shape,
        lines=np.empty((0, 2), dtype=np.int32),
        points={},
        origin=f"identified from {record.name}",
        notes=(
            *record.notes,
            "Shapes are scaled by the driving points to one kg m2."
            if modes.scaled
            else "Shapes are scaled to one, as no driving point was measured.",
        ),
    )
    return store_modal_data(store, aircraft, raw, named)


def compute_orthogonality(
    store: Store, modal_table_id: int, fuel: float, sources: Sources, field: str
) -> Orthogonality:
    """Compute the orthogonality of shapes over a mass matrix of a file.

    Parameters
    ----------
    store, modal_table_id, fuel
        Table and fuel fraction of the shapes.
    sources, field
        File and field of the matrix: square, with three (translations) or six degrees of freedom of
        every node of the table, node by node, in structural axes.

    Raises
    ------
    BadInput
        If the matrix is not of this size, or not symmetric.
    """
    modes = open_modes(store, store.modal_tables.get(modal_table_id))
    shapes = interpolate_shapes(store, modes, fuel) * TO_STRUCTURE
    matrix = np.asarray(sources.numbers(field), dtype=float)
    n_nodes = shapes.shape[1]
    if matrix.shape not in ((3 * n_nodes,) * 2, (6 * n_nodes,) * 2):
        raise BadInput(
            f"the mass matrix is {' x '.join(map(str, matrix.shape))}; the table has {n_nodes} "
            f"nodes, {3 * n_nodes} or {6 * n_nodes} rows and columns are expected",
            code="unequal-lengths",
        )
    if not np.allclose(matrix, matrix.T, rtol=1e-6, atol=1e-9 * float(np.abs(matrix).max())):
        raise BadInput("the mass matrix is not symmetric", code="not-symmetric")
    flat = shapes[:, :, : matrix.shape[0] // n_nodes].reshape(shapes.shape[0], -1)
    values = compute_mass_orthogonality(flat, matrix)
    off = np.abs(values - np.eye(values.shape[0]))
    return Orthogonality(
        modal_table_id=modal_table_id,
        fuel=fuel,
        names=modes.table.names,
        values=[list(map(float, row)) for row in values],
        worst=float(off.max()),
    )


def _identify(store: Store, record: MeasuredResponses, settings: ModeSearch) -> _Identification:
    """Identify the modes once for the figure, the list and the table that show them."""
    driving = tuple(
        (record.outputs.index(reference), index)
        for index, reference in enumerate(record.references)
        if reference in record.outputs
    )
    search = _Search(
        samples=store.arrays,
        frequency=record.arrays["frequency"],
        values=record.arrays["values"],
        quantity=record.quantity,
        driving=driving,
        settings=settings,
    )
    with _identifying:  # the page requests the figure and the list at the same time
        return _identify_modes(search)


@lru_cache(maxsize=4)  # the fit takes seconds; each is of the size of its responses
def _identify_modes(search: _Search) -> _Identification:
    hertz = np.asarray(search.samples.get(search.frequency), dtype=float)
    settings = search.settings
    low = hertz[0] if settings.low_hz is None else settings.low_hz
    high = hertz[-1] if settings.high_hz is None else settings.high_hz
    inside = (hertz >= low) & (hertz <= high) & (hertz > 0)
    if inside.sum() < 10:
        raise BadInput(
            f"{int(inside.sum())} frequencies lie between {low:g} and {high:g} Hz; at least 10 are"
            f" needed, and responses span {hertz[0]:g} to {hertz[-1]:g} Hz",
            code="too-few-frequencies",
        )
    omega = 2.0 * np.pi * hertz[inside]
    responses = np.asarray(search.samples.get(search.values))[inside]
    poles = compute_stabilisation(omega, responses, min(settings.order, omega.size // 2 - 1))
    columns = find_columns(poles)
    modes = identify_modes(omega, responses, columns, search.quantity, search.driving)
    return _Identification(omega, responses, poles, modes)


def _count_orders(poles: tuple[StabilizationPole, ...], omega: float) -> int:
    """Count the model orders with a stable pole at a frequency."""
    near = (pole for pole in poles if abs(pole.omega / omega - 1.0) < _SAME_POLE)
    return len({pole.order for pole in near if pole.stable})
