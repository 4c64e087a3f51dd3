"""Ground vibration tests: measured responses, identified modes, and their modal table."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import linear_sum_assignment
from scipy.spatial import cKDTree

from flexsid.errors import BadInput
from flexsid.importers.modal_data import RawModalData
from flexsid.importers.responses import RawResponses
from flexsid.importers.source import Sources
from flexsid.records.aircraft import Aircraft
from flexsid.records.modal_table import MeasuredResponses, ModalKind, ModalTable
from flexsid.records.modal_views import FoundMode, FoundModes, Orthogonality, Stabilisation
from flexsid.storage.store import Store
from flexsid.sysid.modes.assurance import (
    compute_mac,
    compute_mass_orthogonality,
    compute_real_shapes,
)
from flexsid.sysid.modes.naming import ModeName
from flexsid.sysid.modes.polyreference import (
    MeasuredModes,
    PoleColumn,
    StabilizationPole,
    compute_stabilisation,
    find_columns,
    fit_shapes,
)
from flexsid.workflow.modal_data.modal_import import store_modal_data
from flexsid.workflow.modal_data.tracked_modes import Modes, interpolate_shape, open_modes

_SAME_MODE = 0.7
_UNPAIRED = 1000
_TO_BODY = np.array([-1.0, 1.0, -1.0])
_SAME_PLACE = 0.03


@dataclass(frozen=True, slots=True, kw_only=True)
class ModeSearch:
    """Frequency band of the mode search, and the highest model order."""

    low_hz: float | None = None
    high_hz: float | None = None
    order: int = 30


@dataclass(frozen=True, slots=True, eq=False)
class _Search:
    record: MeasuredResponses
    omega: np.ndarray
    responses: np.ndarray
    poles: tuple[StabilizationPole, ...]
    columns: tuple[PoleColumn, ...]


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
    search = _search(store, responses_id, settings)
    size = np.sqrt(np.mean(np.abs(search.responses) ** 2, axis=(1, 2)))
    fitted = np.full(size.shape, np.nan)
    if search.columns:
        modes = _fit_shapes(search)
        fitted = np.sqrt(np.mean(np.abs(modes.fitted) ** 2, axis=(1, 2)))
    return Stabilisation(
        title=search.record.name,
        quantity=search.record.quantity,
        frequency_hz=search.omega / (2.0 * np.pi),
        magnitude=size,
        fitted=fitted,
        pole_hz=np.array([pole.omega for pole in search.poles]) / (2.0 * np.pi),
        pole_order=np.array([pole.order for pole in search.poles]),
        pole_damping=np.array([pole.damping for pole in search.poles]),
        stable=np.array([pole.stable for pole in search.poles], dtype=bool),
        stable_frequency=np.array([pole.stable_frequency for pole in search.poles], dtype=bool),
        mode_hz=np.array([abs(column.value) for column in search.columns]) / (2.0 * np.pi),
    )


def find_modes(store: Store, responses_id: int, settings: ModeSearch) -> FoundModes:
    """Find modes that are stable over model order, with their standard deviations."""
    search = _search(store, responses_id, settings)
    modes = _fit_shapes(search)
    error = np.linalg.norm(modes.fitted - search.responses) / np.linalg.norm(search.responses)
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
                n_orders=column.n_stable,
                collinearity=float(straight[k]),
            )
            for k, column in enumerate(search.columns)
        ),
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
    search = _search(store, responses_id, settings)
    record = search.record
    modes = _fit_shapes(search)
    selected = list(range(modes.omega.size)) if indices is None else list(indices)
    if not selected or any(place >= modes.omega.size for place in selected):
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
        shape[0, :, rows[node], :3] += real[:, [output]] * directions[output] * _TO_BODY
    numbers: tuple[int, ...] = tuple(range(1, len(selected) + 1))
    named = None
    if template_id is not None:
        numbers, named = _match_modes(store, template_id, record.fuel, nodes, shape[0, :, :, :3])
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
    shapes = np.stack(
        [interpolate_shape(store, modes, k, fuel) for k in range(len(modes.table.numbers))]
    )
    shapes = shapes * np.tile(_TO_BODY, 2)
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


def _search(store: Store, responses_id: int, settings: ModeSearch) -> _Search:
    record = store.measured_responses.get(responses_id)
    hertz = np.asarray(store.arrays.get(record.arrays["frequency"]), dtype=float)
    values = np.asarray(store.arrays.get(record.arrays["values"]))
    low = hertz[0] if settings.low_hz is None else settings.low_hz
    high = hertz[-1] if settings.high_hz is None else settings.high_hz
    inside = (hertz >= low) & (hertz <= high) & (hertz > 0)
    if inside.sum() < 10:
        raise BadInput(
            f"{int(inside.sum())} frequencies lie between {low:g} and {high:g} Hz; at least 10 are"
            f" needed, and responses span {hertz[0]:g} to {hertz[-1]:g} Hz",
            code="too-few-lines",
        )
    omega = 2.0 * np.pi * hertz[inside]
    responses = values[inside]
    poles = compute_stabilisation(omega, responses, settings.order)
    return _Search(record, omega, responses, poles, find_columns(poles))


def _fit_shapes(search: _Search) -> MeasuredModes:
    record = search.record
    driving = tuple(
        (record.outputs.index(reference), place)
        for place, reference in enumerate(record.references)
        if reference in record.outputs
    )
    return fit_shapes(search.omega, search.responses, search.columns, record.quantity, driving)


def _match_modes(
    store: Store, template_id: int, fuel: float, nodes: np.ndarray, translation: np.ndarray
) -> tuple[tuple[int, ...], tuple[ModeName, ...]]:
    """Assign numbers and names of the modes of another table by MAC."""
    like: Modes = open_modes(store, store.modal_tables.get(template_id))
    table = like.table
    if "nodes" not in table.arrays:
        raise BadInput(f"table '{table.name}' has no shapes at nodes", code="no-nodes")
    places = np.asarray(store.arrays.get(table.arrays["nodes"]), dtype=float)
    found = cKDTree(places).query(nodes)
    distance, near = np.asarray(found[0]), np.asarray(found[1])
    close = distance <= _SAME_PLACE * float(np.linalg.norm(np.ptp(places, axis=0)))
    if not close.any():
        raise BadInput(
            "the sources have no common node; check units and axes of the nodes",
            code="nothing-common",
        )
    measured = (np.abs(translation).max(axis=0) > 0)[close]
    other = np.stack(
        [
            interpolate_shape(store, like, k, fuel)[near[close], :3]
            for k in range(len(table.numbers))
        ]
    )
    alike = compute_mac(translation[:, close][:, measured], other[:, measured])
    pairs = linear_sum_assignment(-alike)
    selected = {int(i): int(j) for i, j in zip(*pairs, strict=True)}
    numbers: list[int] = []
    named: list[ModeName] = []
    for mode in range(translation.shape[0]):
        place = selected.get(mode)
        mac = 0.0 if place is None else float(alike[mode, place])
        if place is None or mac < _SAME_MODE:
            numbers.append(_UNPAIRED + mode + 1)
            named.append(ModeName("", None, f"no match in {table.name}"))
            continue
        numbers.append(table.numbers[place])
        reason = f"matched to {table.names[place]} of {table.name}, MAC {mac:.3f}"
        named.append(ModeName(table.names[place], table.symmetric[place], reason))
    return tuple(numbers), tuple(named)
