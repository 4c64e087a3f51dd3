"""Correlation of the modes of two sources (MAC, COMAC), and observability of modes by sensors."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import linear_sum_assignment
from scipy.spatial import cKDTree

from flexsid.errors import BadInput
from flexsid.records import finite_or_none
from flexsid.records.aircraft import Aircraft, Sensor
from flexsid.records.modal_data import (
    AssuranceMatrix,
    Correlation,
    Observability,
    PairedMode,
    PointAgreement,
    SensorCandidate,
    SensorRow,
)
from flexsid.storage.store import Store
from flexsid.sysid.model.sensor_models import ACCELEROMETER
from flexsid.sysid.modes.assurance import (
    ModalInformation,
    compute_comac,
    compute_mac,
    compute_modal_information,
    compute_modal_scale_factors,
    compute_reduced_cross_orthogonality,
    rank_candidate_sensors,
)
from flexsid.sysid.modes.shapes import may_be, select_spread_nodes
from flexsid.sysid.modes.table import LOW_MAC, compute_fuel_weights, sum_weighted_rows
from flexsid.sysid.signals import interpolate
from flexsid.workflow.modal_data.modal_tables import (
    Modes,
    format_title,
    interpolate_damping,
    interpolate_shape,
    list_mode_names,
    open_modes,
    read_nodes,
)

# --- Correlation of the modes of two sources: MAC, cross-orthogonality, mode pairs, COMAC ---------

_SAME_PLACE = 0.02  # of the extent of a structure
_LEAST_MAC = 0.1  # of a listed pair; less is no resemblance


def compute_assurance(
    store: Store,
    modal_table_id: int,
    fuel: float,
    other_id: int | None = None,
    other_fuel: float | None = None,
) -> AssuranceMatrix:
    """Compute the MAC of a table with itself, at another fuel, or with another table."""
    other_fuel = fuel if other_fuel is None else other_fuel
    one = _read_shapes(store, modal_table_id, fuel)
    other = _read_shapes(store, modal_table_id if other_id is None else other_id, other_fuel)
    a, b, _ = _select_common(one, other)
    return AssuranceMatrix(
        rows=one.names,
        columns=other.names,
        row_title=f"{one.title}, fuel {fuel:g}",
        column_title=f"{other.title}, fuel {other_fuel:g}",
        values=compute_mac(_flatten(a), _flatten(b)),
    )


def correlate(
    store: Store, modal_table_id: int, fuel: float, other_id: int, other_fuel: float
) -> Correlation:
    """Pair the modes of two sources by MAC, with COMAC by point."""
    one, other = (
        _read_shapes(store, modal_table_id, fuel),
        _read_shapes(store, other_id, other_fuel),
    )
    a, b, points = _select_common(one, other)
    moved = np.abs(b).max(axis=(0, 1)) > 1e-9 * np.abs(b).max()  # directions that were measured
    measured = (np.abs(b).max(axis=0) > 1e-9 * np.abs(b).max()) & (
        np.abs(a).max(axis=0) > 1e-9 * np.abs(a).max()
    )
    flat_a, flat_b = a[:, measured], b[:, measured]
    values = compute_mac(flat_a, flat_b)
    cross, cross_note = _compute_cross_orthogonality(one, flat_a, flat_b)
    assignment = linear_sum_assignment(-values)
    pairs, matched = [], []
    for i, j in zip(*assignment, strict=True):
        if values[i, j] < _LEAST_MAC:
            continue
        pairs.append(
            PairedMode(
                number=one.numbers[i],
                name=one.names[i],
                other_number=other.numbers[j],
                other_name=other.names[j],
                mac=float(values[i, j]),
                frequency_hz=float(one.hertz[i]),
                other_hz=float(other.hertz[j]),
                frequency_change=float(other.hertz[j] / one.hertz[i] - 1.0),
                damping=finite_or_none(one.zeta[i]),
                other_damping=finite_or_none(other.zeta[j]),
                cross_orthogonality=None if cross is None else float(abs(cross[i, j])),
            )
        )
        if values[i, j] >= LOW_MAC:
            matched.append((int(i), int(j)))
    agreement: tuple[PointAgreement, ...] = ()
    notes = [f"Compared at {len(points)} points in {int(measured.sum())} directions."]
    if cross_note:
        notes.append(cross_note)
    n_alone = max(values.shape) - len(pairs)
    if n_alone:
        notes.append(f"{n_alone} modes have no counterpart with a MAC of {_LEAST_MAC:g} or more.")
    if not moved.all():
        missing = [name for name, there in zip("xyz", moved, strict=True) if not there]
        notes.append(f"The second source does not move in {', '.join(missing)}.")
    if matched:
        first = flat_a[[i for i, _ in matched]]
        second = flat_b[[j for _, j in matched]]
        second = second * compute_modal_scale_factors(first, second)[:, None]
        comac = compute_comac(first, second)
        agreement = tuple(
            PointAgreement(point=points[p], direction="xyz"[d], comac=float(c))
            for (p, d), c in zip(np.argwhere(measured), comac, strict=True)
        )
        notes.append(f"COMAC over the {len(matched)} pairs with a MAC of {LOW_MAC:g} or more.")
    else:
        notes.append("No pair has a MAC high enough for a COMAC.")
    return Correlation(
        modal_table_id=modal_table_id,
        other_id=other_id,
        fuel=fuel,
        other_fuel=other_fuel,
        n_points=len(points),
        pairs=tuple(sorted(pairs, key=lambda pair: pair.frequency_hz)),
        points=tuple(sorted(agreement, key=lambda point: point.comac)),
        notes=tuple(notes),
    )


def _compute_cross_orthogonality(
    one: _Shapes, model: np.ndarray, measured: np.ndarray
) -> tuple[np.ndarray | None, str]:
    """Compute the cross-orthogonality over the mass of the first source; return it and a note."""
    if one.mass is None:
        return None, ""
    try:
        cross, share = compute_reduced_cross_orthogonality(model, one.mass, measured)
    except BadInput as error:
        return None, f"No cross-orthogonality: {error.message}."
    return cross, (
        f"Cross-orthogonality over the mass of {one.title}, reduced by SEREP with "
        f"{model.shape[0]} modes, which make up at least {100.0 * share.min():.3g} % of each shape."
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Shapes:
    """Translations of all modes at named or located points."""

    title: str
    names: tuple[str, ...]
    numbers: tuple[int, ...]
    places: np.ndarray | None
    points: tuple[str, ...]
    values: np.ndarray  # (n_modes, n_points, 3)
    hertz: np.ndarray
    zeta: np.ndarray
    mass: np.ndarray | None


def _read_shapes(store: Store, modal_table_id: int, fuel: float) -> _Shapes:
    modes = open_modes(store, store.modal_tables.get(modal_table_id))
    table = modes.table
    weights = compute_fuel_weights(modes.fuel, fuel)
    omega = sum_weighted_rows(weights, modes.omega)
    hertz = omega / (2.0 * np.pi)
    zeta = interpolate_damping(store, modes, fuel)
    mass = None if modes.mass is None else interpolate(modes.fuel, modes.mass, fuel)
    names = list_mode_names(table)
    if "nodes" in table.arrays:
        nodes = np.asarray(store.arrays.get(table.arrays["nodes"]), dtype=float)
        values = np.stack(
            [
                interpolate_shape(store, modes, mode, fuel)[:, :3]
                for mode in range(len(table.numbers))
            ]
        )
        ids = table.arrays.get("node_ids")
        labels = range(1, len(nodes) + 1) if ids is None else store.arrays.get(ids).tolist()
        points = tuple(f"node {label}" for label in labels)
        return _Shapes(
            format_title(table), names, table.numbers, nodes, points, values, hertz, zeta, mass
        )
    if "shape" in table.arrays:
        whole = modes.tracking.align(np.asarray(store.arrays.get(table.arrays["shape"]), float))
        values = sum_weighted_rows(weights, whole)[..., :3]
        return _Shapes(
            format_title(table), names, table.numbers, None, table.points, values, hertz, zeta, mass
        )
    raise BadInput(f"table '{table.name}' has no shapes", code="no-shapes")


def _select_common(one: _Shapes, other: _Shapes) -> tuple[np.ndarray, np.ndarray, tuple[str, ...]]:
    """Select shapes at common points: by location where both have it, else by name."""
    if one.places is not None and other.places is not None:
        if one.places.shape == other.places.shape and np.allclose(one.places, other.places):
            return one.values, other.values, one.points
        extent = float(np.linalg.norm(np.ptp(one.places, axis=0)))
        found = cKDTree(one.places).query(other.places)
        distance, near = np.asarray(found[0]), np.asarray(found[1])
        close = distance <= _SAME_PLACE * extent
        if not close.any():
            raise BadInput(
                "the sources have no common node; check units and axes of the nodes",
                code="nothing-common",
            )
        points = tuple(p for p, there in zip(other.points, close, strict=True) if there)
        return one.values[:, near[close]], other.values[:, close], points
    names = [name for name in one.points if name in other.points]
    if not names:
        raise BadInput(
            "the sources have no common point; check the names of the points", code="nothing-common"
        )
    first = [one.points.index(name) for name in names]
    second = [other.points.index(name) for name in names]
    return one.values[:, first], other.values[:, second], tuple(names)


def _flatten(values: np.ndarray) -> np.ndarray:
    return values.reshape(values.shape[0], -1)


# --- Observability of modes by sensors, and ranked locations of a further accelerometer -----------

_CANDIDATES = 250
_MOST_CANDIDATES = 12
_LEAST_DISTANCE = 0.15  # of the extent: least distance between candidates of one axis


def compute_observability(
    store: Store,
    modal_table_id: int,
    fuel: float,
    symmetric: bool | None = True,
    up_to_hz: float = 20.0,
) -> Observability:
    """Rank sensors by mode, and locations by the information of a further accelerometer.

    Parameters
    ----------
    store, modal_table_id, fuel
        Modal table and fuel fraction.
    symmetric
        Symmetric modes, antisymmetric ones, or all (None).
    up_to_hz
        Highest frequency of modes.

    Raises
    ------
    BadInput
        If the table has no shapes at sensors, or no such mode.
    """
    modes = open_modes(store, store.modal_tables.get(modal_table_id))
    table = modes.table
    if "shape" not in table.arrays:
        raise BadInput(f"table '{table.name}' has no shapes at sensors", code="no-shapes")
    aircraft = store.aircraft.get(table.aircraft_id)
    weights = compute_fuel_weights(modes.fuel, fuel)
    omega = sum_weighted_rows(weights, modes.omega)
    columns = [
        place
        for place in np.argsort(omega)
        if omega[place] <= 2.0 * np.pi * up_to_hz
        and (symmetric is None or may_be(table.symmetric[place], symmetric))
    ]
    if not columns:
        raise BadInput(f"the table has no such mode below {up_to_hz:g} Hz", code="no-modes")
    at_points = sum_weighted_rows(
        weights, modes.tracking.align(np.asarray(store.arrays.get(table.arrays["shape"]), float))
    )[columns]
    strain = np.zeros((len(columns), 0))
    if "strain" in table.arrays:
        gauges = np.asarray(store.arrays.get(table.arrays["strain"]), float)
        strain = sum_weighted_rows(weights, modes.tracking.align(gauges))[columns]
    sensors = [s for s in aircraft.sensors if s.point in table.points or s.point in table.gauges]
    motion = np.array([_get_motion(s, modes, at_points, strain) for s in sensors])
    at = omega[columns]
    signals = np.array(
        [
            row * (at**2 if _is_accelerometer(s) else 1.0)
            for s, row in zip(sensors, motion, strict=True)
        ]
    )
    rigid = np.array([_get_rigid(s.kind, s.axis, s.location_m) for s in sensors])
    noise = np.array([s.noise_std or s.model.noise_std for s in sensors])
    information = compute_modal_information(signals, rigid, noise)
    errors = np.sqrt(np.abs(np.diag(information.covariance))) * at**2  # as accelerations
    least = float(np.min(errors)) if np.isfinite(errors).any() else 1.0
    places, shapes = _spread_candidates(store, modes, columns, fuel)
    every_name = list_mode_names(table)
    names = tuple(every_name[place] for place in columns)
    largest = _find_largest(sensors, motion, shapes)
    rows = tuple(
        SensorRow(
            sensor=sensor.name,
            kind=sensor.kind,
            axis=sensor.axis,
            share=tuple(
                float(abs(value) / top) if top > 0 else None
                for value, top in zip(row, largest[k], strict=True)
            ),
        )
        for k, (sensor, row) in enumerate(zip(sensors, motion, strict=True))
    )
    return Observability(
        modal_table_id=modal_table_id,
        fuel=fuel,
        numbers=tuple(table.numbers[place] for place in columns),
        names=names,
        rows=rows,
        std_error=tuple(float(e / least) if np.isfinite(e) else None for e in errors),
        candidates=_rank(aircraft, information, places, shapes, at, names),
    )


def _is_accelerometer(sensor: Sensor) -> bool:
    return sensor.kind == ACCELEROMETER.kind


def _get_motion(
    sensor: Sensor, modes: Modes, at_points: np.ndarray, strain: np.ndarray
) -> np.ndarray:
    """Return the motion of each mode at a sensor per unit eta: phi, nu or strain."""
    table = modes.table
    if sensor.model.senses == "strain":
        if sensor.point not in table.gauges:
            return np.zeros(at_points.shape[0])
        return strain[:, table.gauges.index(sensor.point)]
    if sensor.point not in table.points:
        return np.zeros(at_points.shape[0])
    shape = at_points[:, table.points.index(sensor.point)]
    if sensor.model.senses == "translation":
        return shape[:, "xyz".index(sensor.axis)]
    return shape[:, 3 + "xyz".index(sensor.axis if sensor.axis in "xyz" else "y")]


def _get_rigid(kind: str, axis: str, place: tuple[float, float, float]) -> np.ndarray:
    """Return sensitivities to heave, pitch and roll accelerations, estimated jointly."""
    if kind == ACCELEROMETER.kind and axis == "z":
        return np.array([1.0, place[0], place[1]])
    return np.zeros(3)


def _spread_candidates(
    store: Store, modes: Modes, columns: list[np.intp], fuel: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return locations (P, 3) and translations (n, P, 3) of nodes spread over the structure."""
    table = modes.table
    if "nodes" not in table.arrays:
        return np.zeros((0, 3)), np.zeros((len(columns), 0, 3))
    nodes = read_nodes(store, table)
    rows = select_spread_nodes(nodes, _CANDIDATES)
    shapes = [interpolate_shape(store, modes, int(mode), fuel)[rows, :3] for mode in columns]
    return nodes[rows], np.array(shapes)


def _find_largest(sensors: list[Sensor], motion: np.ndarray, shapes: np.ndarray) -> np.ndarray:
    """Find the largest motion of each mode measurable by each kind of sensor."""
    top = np.zeros(motion.shape)
    for k, sensor in enumerate(sensors):
        alike = [i for i, other in enumerate(sensors) if other.kind == sensor.kind]
        top[k] = np.abs(motion[alike]).max(axis=0)
        if _is_accelerometer(sensor) and shapes.shape[1]:
            everywhere = np.abs(shapes).max(axis=(1, 2))
            top[k] = np.maximum(top[k], everywhere)
    return top


def _rank(
    aircraft: Aircraft,
    information: ModalInformation,
    places: np.ndarray,
    shapes: np.ndarray,
    omega: np.ndarray,
    names: tuple[str, ...],
) -> tuple[SensorCandidate, ...]:
    if places.shape[0] == 0:
        return ()
    known = [s.noise_std for s in aircraft.sensors if _is_accelerometer(s) and s.noise_std]
    noise = float(np.median(known)) if known else ACCELEROMETER.noise_std
    found: list[tuple[float, int, str, np.ndarray]] = []
    for column, axis in enumerate("xyz"):
        rows = (shapes[:, :, column] * (omega**2)[:, None]).T
        rigid = np.array([_get_rigid(ACCELEROMETER.kind, axis, tuple(place)) for place in places])
        gains, shrink = rank_candidate_sensors(information, rows, rigid, noise)
        found += [(float(gains[p]), p, axis, shrink[p]) for p in range(places.shape[0])]
    found.sort(key=lambda one: -one[0])
    extent = float(np.linalg.norm(np.ptp(places, axis=0)))
    ranked: list[SensorCandidate] = []
    for gain, place, axis, shrink in found:
        at = places[place]
        near = (
            np.linalg.norm(at - np.array(other.location_m)) < _LEAST_DISTANCE * extent
            for other in ranked
            if other.axis == axis
        )
        if any(near):
            continue
        mode = int(np.argmin(shrink))
        ranked.append(
            SensorCandidate(
                node=place + 1,
                axis=axis,
                location_m=(float(at[0]), float(at[1]), float(at[2])),
                gain=gain,
                helps=names[mode],
                shrinks_to=float(shrink[mode]),
            )
        )
        if len(ranked) == _MOST_CANDIDATES:
            break
    return tuple(ranked)
