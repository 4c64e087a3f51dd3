"""The equations of motion of the truth: state space, roots, flutter, fewer modes."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from drawn_aircraft import Aircraft, G, Model, Sensor


@dataclass(frozen=True)
class Factors:
    """What turns coefficients into accelerations at an airspeed."""

    rows: np.ndarray
    columns: np.ndarray


def make_factors(aircraft: Aircraft, model: Model, airspeed: float) -> Factors:
    wing, n = aircraft.wing, len(model.numbers)
    force = 0.5 * aircraft.density * airspeed**2 * wing.area
    modal = force * wing.chord / aircraft.generalized_mass
    rows = [force / (wing.mass * airspeed), force * wing.chord / wing.pitch_inertia, *[modal] * n]
    reduced = wing.chord / (2 * airspeed)
    columns = [1.0, reduced, *[1.0] * n, *[reduced] * n, *[1.0] * len(model.inputs)]
    return Factors(np.array(rows), np.array(columns))


def build_state_space(
    aircraft: Aircraft, model: Model, airspeed: float | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Return A and B of the states alpha, q, theta, eta, etadot."""
    speed = airspeed or aircraft.airspeed
    n = len(model.numbers)
    factors = make_factors(aircraft, model, speed)
    forces = factors.rows[:, None] * model.table * factors.columns
    a = np.zeros((3 + 2 * n, 3 + 2 * n))
    where = np.r_[0:2, 3 : 3 + 2 * n]  # states of the columns
    to = np.r_[0:2, 3 + n : 3 + 2 * n]  # states of the rows
    a[np.ix_(to, where)] = forces[:, : 2 + 2 * n]
    a[0, 0] -= aircraft.thrust * np.cos(aircraft.alpha) / (aircraft.wing.mass * speed)
    a[0, 1] += 1
    a[2, 1] = 1
    a[3 : 3 + n, 3 + n :] = np.eye(n)
    a[3 + n :, 3 : 3 + n] -= np.diag(model.omega**2)
    a[3 + n :, 3 + n :] -= np.diag(2 * model.zeta * model.omega)
    b = np.zeros((3 + 2 * n, len(model.inputs)))
    b[to] = forces[:, 2 + 2 * n :]
    return a, b


def build_output(aircraft: Aircraft, sensor: Sensor) -> tuple[np.ndarray, np.ndarray]:
    """Return the rows of a sensor on the states and on their derivatives."""
    n, speed = len(aircraft.shapes), aircraft.airspeed
    on_state, on_rate = np.zeros(3 + 2 * n), np.zeros(3 + 2 * n)
    eta, etadot = slice(3, 3 + n), slice(3 + n, 3 + 2 * n)
    point = np.array([sensor.point])
    shape = np.array([one.at(aircraft.wing, point)[0] for one in aircraft.shapes])
    x = sensor.point[0]
    if sensor.kind == "gyro":
        on_state[1], on_state[etadot] = 1, shape[:, 4]
    elif sensor.kind == "attitude":
        on_state[2], on_state[eta] = 1, shape[:, 4]
    elif sensor.kind == "vane":
        on_state[0], on_state[1] = 1, -x / speed
        on_state[etadot], on_state[eta] = shape[:, 2] / speed, shape[:, 4]
    elif sensor.kind == "strain":
        assert sensor.gauge is not None
        on_state[eta] = [one.strain(aircraft.wing, *sensor.gauge) for one in aircraft.shapes]
    else:
        drag = aircraft.thrust * np.cos(aircraft.alpha) / aircraft.wing.mass
        on_rate[0], on_rate[1], on_rate[etadot] = speed, -x, shape[:, 2]
        on_state[0], on_state[1] = drag, -speed
        on_state[eta] = G * np.sin(aircraft.alpha) * shape[:, 4]
    return on_state, on_rate


def find_roots(aircraft: Aircraft, model: Model, airspeed: float | None = None) -> np.ndarray:
    a, _ = build_state_space(aircraft, model, airspeed)
    keep = np.r_[0:2, 3 : a.shape[0]]  # without the pitch angle, an integral
    return np.asarray(np.linalg.eigvals(a[np.ix_(keep, keep)]), dtype=complex)


def find_flutter(aircraft: Aircraft, model: Model, to: float = 3.0) -> float | None:
    """Return the lowest airspeed at which an oscillation grows, up to a multiple of that flown."""

    def grows(speed: float) -> bool:
        roots = find_roots(aircraft, model, speed)
        return bool((np.real(roots)[np.abs(np.imag(roots)) > 1e-6] > 0).any())

    speeds = aircraft.airspeed * np.geomspace(0.4, to, 160)
    found = next((k for k, speed in enumerate(speeds) if grows(speed)), None)
    if not found:
        return None
    low, high = speeds[found - 1], speeds[found]
    for _ in range(40):
        middle = (low + high) / 2
        low, high = (low, middle) if grows(middle) else (middle, high)
    return float(high)


def residualize(aircraft: Aircraft, model: Model, n: int) -> Model:
    """Return the model of the first modes with the static response of the others."""
    m = len(model.numbers)
    pressure = 0.5 * aircraft.density * aircraft.airspeed**2
    factor = aircraft.generalized_mass / (pressure * aircraft.wing.area * aircraft.wing.chord)
    eta = np.r_[2 + n : 2 + m]
    rows, columns = (
        np.r_[0 : 2 + n],
        np.r_[0 : 2 + n, 2 + m : 2 + m + n, 2 + 2 * m : model.table.shape[1]],
    )
    stiff = np.diag(factor * model.omega[n:] ** 2) - model.table[np.ix_(eta, eta)]
    static = np.linalg.solve(stiff, model.table[np.ix_(eta, columns)])
    table = model.table[np.ix_(rows, columns)] + model.table[np.ix_(rows, eta)] @ static
    return Model(table, model.omega[:n], model.zeta[:n], model.numbers[:n], model.inputs)


def set_flutter(aircraft: Aircraft, ratio: float) -> Aircraft | None:
    """Scale the frequencies until the airspeed is this ratio of the flutter speed, or None."""

    def scale(factor: float) -> Aircraft:
        truth = replace(aircraft.truth, omega=factor * aircraft.truth.omega)
        return replace(aircraft, truth=truth, flutter_ratio=ratio)

    def holds(factor: float) -> bool:
        scaled = scale(factor)
        speeds = aircraft.airspeed * np.geomspace(0.4, 1 / ratio, 40)
        return all((np.real(find_roots(scaled, scaled.truth, v)) < 1e-9).all() for v in speeds)

    low, high = 0.2, 40.0
    if not holds(high):
        return None
    for _ in range(30):
        middle = float(np.sqrt(low * high))
        low, high = (low, middle) if holds(middle) else (middle, high)
    return scale(high)
