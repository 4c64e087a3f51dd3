"""Observability of modes by sensors, and ranked locations of a further accelerometer."""

from __future__ import annotations

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.aircraft import Aircraft, Sensor
from flexsid.records.modal_data import Observability, SensorCandidate, SensorRow
from flexsid.storage.store import Store
from flexsid.sysid.model.sensor_models import ACCELEROMETER
from flexsid.sysid.modes.node_selection import select_spread_nodes
from flexsid.sysid.modes.observability import (
    ModalInformation,
    compute_modal_information,
    rank_candidate_sensors,
)
from flexsid.sysid.modes.symmetry import may_be
from flexsid.sysid.modes.table import compute_fuel_weights, sum_weighted_rows
from flexsid.workflow.modal_data.modal_tables import (
    Modes,
    interpolate_shape,
    list_mode_names,
    open_modes,
    read_nodes,
)

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
