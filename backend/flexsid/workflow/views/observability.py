"""Which sensor sees which mode, and where a further accelerometer would help most."""

from __future__ import annotations

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.aircraft import Aircraft, Sensor, SensorKind
from flexsid.records.modal_views import Observability, SensorCandidate, SensorRow
from flexsid.storage.store import Store
from flexsid.sysid.modes.observability import (
    Information,
    gather_information,
    rank_candidates,
)
from flexsid.sysid.modes.table import fuel_weights, weighted
from flexsid.sysid.modes.thinning import spread_nodes
from flexsid.workflow.modal_data.tracked_modes import Modes, open_modes, shape_at

_CANDIDATES = 250
_TOLD = 12
_NOISE = {  # SI, where an aircraft does not say
    SensorKind.ACCELEROMETER: 0.05,
    SensorKind.GYRO: 1e-3,
    SensorKind.ATTITUDE: 1e-3,
    SensorKind.VANE: 1e-3,
    SensorKind.STRAIN: 1e-6,
}
_APART = 0.15  # of the extent: a second candidate nearer by tells nothing new


def observability(
    store: Store,
    modal_table_id: int,
    fuel: float,
    symmetric: bool | None = True,
    up_to_hz: float = 20.0,
) -> Observability:
    """Rate sensors by mode and places by what a further accelerometer would add.

    Parameters
    ----------
    store, modal_table_id, fuel
        Modes and where to read them.
    symmetric
        Symmetric modes, antisymmetric ones, or all (None).
    up_to_hz
        Modes above are left out.

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
    weights = fuel_weights(modes.fuel, fuel)
    omega = weighted(weights, modes.omega)
    chosen = [
        place
        for place in np.argsort(omega)
        if omega[place] <= 2.0 * np.pi * up_to_hz
        and (symmetric is None or table.symmetric[place] == symmetric)
    ]
    if not chosen:
        raise BadInput(f"no such mode lies below {up_to_hz:g} Hz", code="no-modes")
    at_points = weighted(
        weights, modes.tracking.align(np.asarray(store.arrays.get(table.arrays["shape"]), float))
    )[chosen]
    strain = np.zeros((len(chosen), 0))
    if "strain" in table.arrays:
        gauges = np.asarray(store.arrays.get(table.arrays["strain"]), float)
        strain = weighted(weights, modes.tracking.align(gauges))[chosen]
    sensors = [s for s in aircraft.sensors if s.point in table.points or s.point in table.gauges]
    motion = np.array([_motion(s, modes, at_points, strain) for s in sensors])
    at = omega[chosen]
    signals = np.array(
        [
            row * (at**2 if _is_accelerometer(s) else 1.0)
            for s, row in zip(sensors, motion, strict=True)
        ]
    )
    rigid = np.array([_rigid(s.kind, s.axis, s.location_m) for s in sensors])
    noise = np.array([s.noise_std or _NOISE[s.kind] for s in sensors])
    information = gather_information(signals, rigid, noise)
    errors = np.sqrt(np.abs(np.diag(information.covariance))) * at**2  # as accelerations
    least = float(np.min(errors)) if np.isfinite(errors).any() else 1.0
    places, shapes = _candidates(store, modes, chosen, fuel)
    names = tuple(table.names[place] or f"mode {table.numbers[place]}" for place in chosen)
    largest = _largest(sensors, motion, shapes)
    rows = tuple(
        SensorRow(
            sensor=sensor.name,
            kind=sensor.kind.value,
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
        numbers=tuple(table.numbers[place] for place in chosen),
        names=names,
        rows=rows,
        std_error=tuple(float(e / least) if np.isfinite(e) else None for e in errors),
        candidates=_best(aircraft, information, places, shapes, at, names),
    )


def _is_accelerometer(sensor: Sensor) -> bool:
    return sensor.kind is SensorKind.ACCELEROMETER


def _motion(sensor: Sensor, modes: Modes, at_points: np.ndarray, strain: np.ndarray) -> np.ndarray:
    """What a sensor sees of each mode per unit eta: phi, nu or strain."""
    table = modes.table
    if sensor.kind is SensorKind.STRAIN:
        if sensor.point not in table.gauges:
            return np.zeros(at_points.shape[0])
        return strain[:, table.gauges.index(sensor.point)]
    if sensor.point not in table.points:
        return np.zeros(at_points.shape[0])
    shape = at_points[:, table.points.index(sensor.point)]
    if sensor.kind is SensorKind.ACCELEROMETER:
        return shape[:, "xyz".index(sensor.axis)]
    return shape[:, 3 + "xyz".index(sensor.axis if sensor.axis in "xyz" else "y")]


def _rigid(kind: SensorKind, axis: str, place: tuple[float, float, float]) -> np.ndarray:
    """What a sensor sees of heave, pitch and roll accelerations, which are estimated beside."""
    if kind is SensorKind.ACCELEROMETER and axis == "z":
        return np.array([1.0, place[0], place[1]])
    return np.zeros(3)


def _candidates(
    store: Store, modes: Modes, chosen: list[np.intp], fuel: float
) -> tuple[np.ndarray, np.ndarray]:
    """Places (P, 3) and translations (n, P, 3) of nodes spread over the structure."""
    table = modes.table
    if "nodes" not in table.arrays:
        return np.zeros((0, 3)), np.zeros((len(chosen), 0, 3))
    nodes = np.asarray(store.arrays.get(table.arrays["nodes"]), dtype=float)
    rows = spread_nodes(nodes, _CANDIDATES)
    shapes = [shape_at(store, modes, int(mode), fuel)[rows, :3] for mode in chosen]
    return nodes[rows], np.array(shapes)


def _largest(sensors: list[Sensor], motion: np.ndarray, shapes: np.ndarray) -> np.ndarray:
    """Largest motion of each mode that a sensor of this kind could see anywhere."""
    top = np.zeros(motion.shape)
    for k, sensor in enumerate(sensors):
        alike = [i for i, other in enumerate(sensors) if other.kind is sensor.kind]
        top[k] = np.abs(motion[alike]).max(axis=0)
        if sensor.kind is SensorKind.ACCELEROMETER and shapes.shape[1]:
            everywhere = np.abs(shapes).max(axis=(1, 2))
            top[k] = np.maximum(top[k], everywhere)
    return top


def _best(
    aircraft: Aircraft,
    information: Information,
    places: np.ndarray,
    shapes: np.ndarray,
    omega: np.ndarray,
    names: tuple[str, ...],
) -> tuple[SensorCandidate, ...]:
    if places.shape[0] == 0:
        return ()
    known = [s.noise_std for s in aircraft.sensors if _is_accelerometer(s) and s.noise_std]
    noise = float(np.median(known)) if known else _NOISE[SensorKind.ACCELEROMETER]
    found: list[tuple[float, int, str, np.ndarray]] = []
    for column, axis in enumerate("xyz"):
        rows = (shapes[:, :, column] * (omega**2)[:, None]).T
        kind = SensorKind.ACCELEROMETER
        rigid = np.array([_rigid(kind, axis, tuple(place)) for place in places])
        gains, shrink = rank_candidates(information, rows, rigid, noise)
        found += [(float(gains[p]), p, axis, shrink[p]) for p in range(places.shape[0])]
    found.sort(key=lambda one: -one[0])
    extent = float(np.linalg.norm(np.ptp(places, axis=0)))
    told: list[SensorCandidate] = []
    for gain, place, axis, shrink in found:
        at = places[place]
        near = (
            np.linalg.norm(at - np.array(other.place_m)) < _APART * extent
            for other in told
            if other.axis == axis
        )
        if any(near):
            continue
        mode = int(np.argmin(shrink))
        told.append(
            SensorCandidate(
                node=place + 1,
                axis=axis,
                place_m=(float(at[0]), float(at[1]), float(at[2])),
                gain=gain,
                helps=names[mode],
                shrinks_to=float(shrink[mode]),
            )
        )
        if len(told) == _TOLD:
            break
    return tuple(told)
