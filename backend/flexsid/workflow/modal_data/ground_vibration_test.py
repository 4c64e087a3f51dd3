"""Ground vibration tests: responses kept, modes found in them, and modes kept as a table."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import linear_sum_assignment
from scipy.spatial import cKDTree

from flexsid.errors import BadInput
from flexsid.importers.modal_data import RawStructure
from flexsid.importers.responses import RawResponses
from flexsid.importers.source import Sources
from flexsid.records.aircraft import Aircraft
from flexsid.records.modal_table import MeasuredResponses, ModalKind, ModalTable
from flexsid.records.modal_views import FoundMode, FoundModes, Orthogonality, Stabilisation
from flexsid.storage.store import Store
from flexsid.sysid.modes.assurance import mass_orthogonality, modal_assurance, real_shapes
from flexsid.sysid.modes.naming import ModeName
from flexsid.sysid.modes.polyreference import (
    Cluster,
    MeasuredModes,
    StabilizationPole,
    find_columns,
    fit_shapes,
    stabilisation,
)
from flexsid.workflow.modal_data.modal_import import keep_structure
from flexsid.workflow.modal_data.tracked_modes import Modes, open_modes, shape_at

_ALIKE = 0.7
_UNPAIRED = 1000
_TO_BODY = np.array([-1.0, 1.0, -1.0])
_SAME_PLACE = 0.03


@dataclass(frozen=True, slots=True, kw_only=True)
class ModeSearch:
    """The band in which modes are looked for, and the highest order of the models."""

    low_hz: float | None = None
    high_hz: float | None = None
    order: int = 30


@dataclass(frozen=True, slots=True, eq=False)
class _Search:
    record: MeasuredResponses
    omega: np.ndarray
    responses: np.ndarray
    poles: tuple[StabilizationPole, ...]
    columns: tuple[Cluster, ...]


def keep_responses(store: Store, aircraft: Aircraft, raw: RawResponses) -> MeasuredResponses:
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


def draw_stabilisation(store: Store, responses_id: int, wanted: ModeSearch) -> Stabilisation:
    """Poles of every order over the band, with the mean response behind them."""
    search = _search(store, responses_id, wanted)
    size = np.sqrt(np.mean(np.abs(search.responses) ** 2, axis=(1, 2)))
    fitted = np.full(size.shape, np.nan)
    if search.columns:
        modes = _fit(search)
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


def find_modes(store: Store, responses_id: int, wanted: ModeSearch) -> FoundModes:
    """Modes that are stable over the orders, with their scatter."""
    search = _search(store, responses_id, wanted)
    modes = _fit(search)
    error = np.linalg.norm(modes.fitted - search.responses) / np.linalg.norm(search.responses)
    _, straight = real_shapes(modes.shapes)
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


def keep_found_modes(
    store: Store,
    responses_id: int,
    wanted: ModeSearch,
    name: str,
    keep: tuple[int, ...] | None = None,
    like_id: int | None = None,
) -> ModalTable:
    """Keep modes found in responses as a table of a GVT.

    Parameters
    ----------
    store, responses_id, wanted
        Where modes are looked for.
    name
        Of the table.
    keep
        Places of the modes to keep, from 0; all by default.
    like_id
        Table whose numbers and names the modes are given where shapes agree (MAC of 0.7 or
        more), so that its damping is found by name.

    Raises
    ------
    BadInput
        If it is not known where the points are, or a place is not one of the modes found.
    """
    search = _search(store, responses_id, wanted)
    record = search.record
    modes = _fit(search)
    chosen = list(range(modes.omega.size)) if keep is None else list(keep)
    if not chosen or any(place >= modes.omega.size for place in chosen):
        raise BadInput(f"{modes.omega.size} modes were found", code="unknown-mode")
    if "nodes" not in record.arrays:
        raise BadInput(
            "it is not known where the points are; import the responses with their geometry",
            code="no-nodes",
        )
    places = np.asarray(store.arrays.get(record.arrays["nodes"]), dtype=float)
    directions = np.asarray(store.arrays.get(record.arrays["directions"]), dtype=float)
    real, _ = real_shapes(modes.shapes[chosen])
    labels = [int(output.split("+")[0]) for output in record.outputs]
    ids = np.unique(labels)
    rows = {int(node): row for row, node in enumerate(ids)}
    nodes = np.zeros((ids.size, 3))
    shape = np.zeros((1, len(chosen), ids.size, 6))
    for output, node in enumerate(labels):
        nodes[rows[node]] = places[output]
        shape[0, :, rows[node], :3] += real[:, [output]] * directions[output] * _TO_BODY
    numbers: tuple[int, ...] = tuple(range(1, len(chosen) + 1))
    named = None
    if like_id is not None:
        numbers, named = _called(store, like_id, record.fuel, nodes, shape[0, :, :, :3])
    aircraft = store.aircraft.get(record.aircraft_id)
    raw = RawStructure(
        name=name,
        kind=ModalKind.GVT,
        fuel=np.array([record.fuel]),
        numbers=numbers,
        omega=modes.omega[None, chosen],
        zeta=modes.damping[None, chosen],
        mass=np.ones((1, len(chosen))) if modes.scaled else None,
        node_ids=ids,
        nodes=nodes,
        shape=shape,
        lines=np.empty((0, 2), dtype=np.int32),
        points={},
        origin=f"found in {record.name}",
        notes=(
            *record.notes,
            "Shapes are scaled by the driving points to one kg m2."
            if modes.scaled
            else "Shapes are scaled to one, as no driving point was measured.",
        ),
    )
    return keep_structure(store, aircraft, raw, named)


def orthogonality(
    store: Store, modal_table_id: int, fuel: float, sources: Sources, field: str
) -> Orthogonality:
    """Orthogonality of a table's shapes over a mass matrix out of a file.

    Parameters
    ----------
    store, modal_table_id, fuel
        Shapes.
    sources, field
        Where the matrix is: square, with three (translations) or six degrees of freedom of
        every node of the table, node by node, in structural axes.

    Raises
    ------
    BadInput
        If the matrix is not of this size, or not symmetric.
    """
    modes = open_modes(store, store.modal_tables.get(modal_table_id))
    shapes = np.stack([shape_at(store, modes, k, fuel) for k in range(len(modes.table.numbers))])
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
    values = mass_orthogonality(flat, matrix)
    off = np.abs(values - np.eye(values.shape[0]))
    return Orthogonality(
        modal_table_id=modal_table_id,
        fuel=fuel,
        names=modes.table.names,
        values=[list(map(float, row)) for row in values],
        worst=float(off.max()),
    )


def _search(store: Store, responses_id: int, wanted: ModeSearch) -> _Search:
    record = store.measured_responses.get(responses_id)
    hertz = np.asarray(store.arrays.get(record.arrays["frequency"]), dtype=float)
    values = np.asarray(store.arrays.get(record.arrays["values"]))
    low = hertz[0] if wanted.low_hz is None else wanted.low_hz
    high = hertz[-1] if wanted.high_hz is None else wanted.high_hz
    inside = (hertz >= low) & (hertz <= high) & (hertz > 0)
    if inside.sum() < 10:
        raise BadInput(
            f"{int(inside.sum())} lines lie between {low:g} and {high:g} Hz; responses reach from "
            f"{hertz[0]:g} to {hertz[-1]:g} Hz",
            code="too-few-lines",
        )
    omega = 2.0 * np.pi * hertz[inside]
    responses = values[inside]
    poles = stabilisation(omega, responses, wanted.order)
    return _Search(record, omega, responses, poles, find_columns(poles))


def _fit(search: _Search) -> MeasuredModes:
    record = search.record
    driving = tuple(
        (record.outputs.index(reference), place)
        for place, reference in enumerate(record.references)
        if reference in record.outputs
    )
    return fit_shapes(search.omega, search.responses, search.columns, record.quantity, driving)


def _called(
    store: Store, like_id: int, fuel: float, nodes: np.ndarray, translation: np.ndarray
) -> tuple[tuple[int, ...], tuple[ModeName, ...]]:
    """Numbers and names of the most alike modes of another table."""
    like: Modes = open_modes(store, store.modal_tables.get(like_id))
    table = like.table
    if "nodes" not in table.arrays:
        raise BadInput(f"table '{table.name}' has no shapes at nodes", code="no-nodes")
    places = np.asarray(store.arrays.get(table.arrays["nodes"]), dtype=float)
    found = cKDTree(places).query(nodes)
    distance, near = np.asarray(found[0]), np.asarray(found[1])
    close = distance <= _SAME_PLACE * float(np.linalg.norm(np.ptp(places, axis=0)))
    if not close.any():
        raise BadInput("the sources have no node in the same place", code="nothing-common")
    measured = (np.abs(translation).max(axis=0) > 0)[close]
    other = np.stack(
        [shape_at(store, like, k, fuel)[near[close], :3] for k in range(len(table.numbers))]
    )
    alike = modal_assurance(translation[:, close][:, measured], other[:, measured])
    pairs = linear_sum_assignment(-alike)
    chosen = {int(i): int(j) for i, j in zip(*pairs, strict=True)}
    numbers: list[int] = []
    named: list[ModeName] = []
    for mode in range(translation.shape[0]):
        place = chosen.get(mode)
        mac = 0.0 if place is None else float(alike[mode, place])
        if place is None or mac < _ALIKE:
            numbers.append(_UNPAIRED + mode + 1)
            named.append(ModeName("", None, f"like no mode of {table.name}"))
            continue
        numbers.append(table.numbers[place])
        reason = f"like {table.names[place]} of {table.name}, MAC {mac:.3f}"
        named.append(ModeName(table.names[place], table.symmetric[place], reason))
    return tuple(numbers), tuple(named)
