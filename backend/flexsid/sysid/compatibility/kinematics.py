"""Exact kinematics of all sensors of a record, as equations linear in the unknown motion.

At every frequency the windowed spectra of the sensors satisfy z = P(s) r + n. The rows P are those
of the linear model, r is the unknown motion, and n the exact kinematics of the measured
signals less P times their own motion. One Newton step for the motion is thereby exact for any
amplitude and variation of airspeed that the sensors follow, and for records that end in motion.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from jaxtyping import Complex, Int

from flexsid.sysid.compatibility.flight_record import ALTITUDE, CompatibilitySensor, FlightRecord
from flexsid.sysid.model.airspeed import AIRSPEED
from flexsid.sysid.model.condition import GRAVITY
from flexsid.sysid.model.lateral import LATERAL
from flexsid.sysid.model.sensor_models import (
    ACCELEROMETER,
    AIRSPEED_PROBE,
    ATTITUDE,
    GYRO,
    VANE,
    find_sensor_model,
)
from flexsid.sysid.model.sensors import INTEGRAL, POSITION, Mounting

_BODIES = (AIRSPEED, LATERAL)
_NO_MODES = np.zeros((3, 0))
SIGNALS = {
    "alpha": (VANE.kind, "y"), "beta": (VANE.kind, "z"),
    "p": (GYRO.kind, "x"), "q": (GYRO.kind, "y"), "r": (GYRO.kind, "z"),
    "phi": (ATTITUDE.kind, "x"), "theta": (ATTITUDE.kind, "y"),
}  # fmt: skip
"""Signals of the kinematics by kind and axis of their sensor."""


@dataclass(frozen=True, slots=True)
class MeasurementErrors:
    """Errors of the sensors, zero or one where nothing is wrong.

    Recorded samples are the true ones, ``delays`` [s] later, times ``scales``. ``arms`` are what
    the true position in body axes is ahead of the declared one [m]. ``airspeed`` is recorded over
    true airspeed.
    """

    delays: Mapping[str, float] = field(default_factory=dict[str, float])
    scales: Mapping[str, float] = field(default_factory=dict[str, float])
    arms: Mapping[tuple[str, str], float] = field(default_factory=dict[tuple[str, str], float])
    airspeed: float = 1.0


@dataclass(frozen=True, slots=True)
class KinematicEquations:
    """Spectra less their known part, and the rows of the unknown motion."""

    spectra: Complex[np.ndarray, "n_omega n_y"]
    rows: Complex[np.ndarray, "n_omega n_y n_r"]


def form_equations(
    record: FlightRecord, errors: MeasurementErrors, some: Int[np.ndarray, " n_omega"]
) -> KinematicEquations:
    """Form the equations of a record at some of its frequencies, with the errors of its sensors.

    Notes
    -----
    Body-axis velocities u, v, w of true airspeed, angle of attack and sideslip at the c.g.;
    specific force f = V-dot + omega x V - g, and at a sensor + omega-dot x r + omega x (omega x r).
    The derivative of a signal x under the window w is s F(w x) - F(w-dot x).

    Sources: Klein and Morelli, Aircraft System Identification, 2nd ed., 2016, ch. 10 (data
    compatibility, ``compat`` of SIDPAC); Jategaonkar, Flight Vehicle System Identification,
    2nd ed., 2015, ch. 10, doi:10.2514/4.102790 (flight path reconstruction).
    """
    scales = dict(errors.scales)
    if record.airspeed is not None:
        scales[record.airspeed.name] = errors.airspeed
    measured = {
        one.name: record.sample(one, errors.delays.get(one.name, 0.0)) / scales.get(one.name, 1.0)
        for one in record.sensors
    }
    places = {one.name: _locate(one, errors) for one in record.sensors}
    signals = _read_signals(record, measured, places, errors.airspeed)
    w, w_rate = record.window, record.window_rate
    known = [_form_known(one, places[one.name], signals) for one in record.sensors]
    own = [measured[one.name] for one in record.sensors]
    motion = [signals[name] for name in ("alpha", "q", "V", "beta", "p", "r")]
    motion = [x - x.mean() for x in motion]
    moved = np.stack([x for x, _ in known], axis=1)
    columns = np.concatenate(
        [
            w[:, None] * np.stack(own, axis=1),
            w_rate[:, None] * np.stack(own, axis=1),
            w[:, None] * moved,
            w_rate[:, None] * moved,
            w[:, None] * np.stack([c for _, c in known], axis=1),
            w[:, None] * np.stack(motion, axis=1),
        ],
        axis=1,
    )
    n_y = len(record.sensors)
    spectra = record.transform(columns)[some]
    z, z_end, x, x_end, c = (spectra[:, k * n_y : (k + 1) * n_y] for k in range(5))
    own_motion = spectra[:, 5 * n_y :]
    omega = record.omega[some]
    s = 1j * omega[:, None]
    rows = _form_rows(record, places, errors.airspeed, omega)
    exact = s * x - x_end + c
    is_attitude = np.array([one.kind == ATTITUDE.kind for one in record.sensors])
    is_altitude = np.array([one.kind == ALTITUDE for one in record.sensors])
    # An attitude is the integral of its rate: s F(w x) = F(w-dot x) + F(w x-dot).
    exact = np.where(is_attitude, (z_end + c) / s, exact)
    z = np.where(is_altitude, s * z - z_end, z)
    remainder = exact - np.matmul(rows, own_motion[:, :, None])[:, :, 0]
    # Noise is that of the recorded samples, whatever their scale.
    scale = np.array([scales.get(one.name, 1.0) for one in record.sensors])
    rows = rows[:, :, _find_determined(record)] * scale[:, None]
    return KinematicEquations((z - remainder) * scale, rows)


def _locate(sensor: CompatibilitySensor, errors: MeasurementErrors) -> tuple[float, float, float]:
    x, y, z = (
        place + errors.arms.get((sensor.name, axis), 0.0)
        for place, axis in zip(sensor.position, "xyz", strict=True)
    )
    return x, y, z


def _read_signals(
    record: FlightRecord,
    measured: Mapping[str, np.ndarray],
    places: Mapping[str, tuple[float, float, float]],
    airspeed_scale: float,
) -> dict[str, np.ndarray]:
    """Read the signals at the c.g.; what is not recorded is that of trim."""
    trim, n = record.condition, record.time.size
    probe = record.airspeed
    recorded = {one.name: one for one in record.sensors}
    if probe is None:
        speed = np.full(n, trim.airspeed / airspeed_scale)
    elif probe.name in recorded:
        speed = measured[probe.name]
    else:
        speed = record.sample(probe, 0.0) / airspeed_scale
    found = {"V": np.maximum(speed, 1e-3 * trim.airspeed)}
    sources = {
        signal: next((one for one in record.sensors if (one.kind, one.axis) == which), None)
        for signal, which in SIGNALS.items()
    }
    levels = {"alpha": trim.alpha, "theta": trim.alpha + trim.gamma, "beta": 0.0}
    for signal, source in sources.items():
        if source is None:
            found[signal] = np.full(n, levels.get(signal, 0.0))
        elif signal in levels:
            x = measured[source.name]
            found[signal] = x - x.mean() + levels[signal]
        else:
            found[signal] = measured[source.name]
    for signal, rates in (("alpha", "qp"), ("beta", "rp")):
        source = sources[signal]
        if source is not None:
            x, y, z = places[source.name]
            along, across = found[rates[0]], found[rates[1]]
            turn = x * along - (y if signal == "alpha" else z) * across
            found[signal] = found[signal] + (turn if signal == "alpha" else -turn) / found["V"]
    return found


def _form_known(
    sensor: CompatibilitySensor, place: tuple[float, float, float], s: Mapping[str, np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    """Form the signal that a sensor measures the derivative of, and what it measures itself."""
    x, y, z = place
    p, q, r, speed = s["p"], s["q"], s["r"], s["V"]
    alpha, beta, phi, theta = s["alpha"], s["beta"], s["phi"], s["theta"]
    nothing = np.zeros_like(speed)
    u, v, w = (
        speed * np.cos(alpha) * np.cos(beta),
        speed * np.sin(beta),
        speed * np.sin(alpha) * np.cos(beta),
    )
    which = sensor.kind, sensor.axis
    if which == (ACCELEROMETER.kind, "x"):
        turn = -(q * q + r * r) * x + p * q * y + p * r * z
        return u + q * z - r * y, q * w - r * v + GRAVITY * np.sin(theta) + turn
    if which == (ACCELEROMETER.kind, "y"):
        turn = p * q * x - (p * p + r * r) * y + q * r * z
        gravity = -GRAVITY * np.cos(theta) * np.sin(phi)
        return v + r * x - p * z, r * u - p * w + gravity + turn
    if which == (ACCELEROMETER.kind, "z"):
        turn = p * r * x + q * r * y - (p * p + q * q) * z
        gravity = -GRAVITY * np.cos(theta) * np.cos(phi)
        return w + p * y - q * x, p * v - q * u + gravity + turn
    if which == (GYRO.kind, "x"):
        return nothing, p
    if which == (GYRO.kind, "y"):
        return nothing, q
    if which == (GYRO.kind, "z"):
        return nothing, r
    if which == (ATTITUDE.kind, "x"):
        return nothing, p + np.tan(theta) * (q * np.sin(phi) + r * np.cos(phi))
    if which == (ATTITUDE.kind, "y"):
        return nothing, q * np.cos(phi) - r * np.sin(phi)
    if which == (VANE.kind, "y"):
        return nothing, alpha - (x * q - y * p) / speed
    if which == (VANE.kind, "z"):
        return nothing, beta + (x * r - z * p) / speed
    if sensor.kind == AIRSPEED_PROBE.kind:
        return nothing, speed
    climb = u * np.sin(theta) - np.cos(theta) * (v * np.sin(phi) + w * np.cos(phi))
    return nothing, climb


def _form_rows(
    record: FlightRecord,
    places: Mapping[str, tuple[float, float, float]],
    airspeed_scale: float,
    omega: np.ndarray,
) -> Complex[np.ndarray, "n_omega n_y n_r"]:
    """Rows of all sensors: alpha, q, V, beta, p, r."""
    key = tuple(places.values()), airspeed_scale
    polynomials = record.polynomials.get(key)
    if polynomials is None:
        polynomials = record.polynomials[key] = _form_polynomials(record, *key)
    powers = np.stack([-1j / omega, np.ones_like(omega), 1j * omega, -(omega**2)], axis=1)
    return np.einsum("kp,ypr->kyr", powers, polynomials)


def _form_polynomials(
    record: FlightRecord, places: tuple[tuple[float, float, float], ...], airspeed_scale: float
) -> np.ndarray:
    condition = record.condition
    condition = replace(condition, airspeed=condition.airspeed / airspeed_scale)
    polynomials = []
    for sensor, place in zip(record.sensors, places, strict=True):
        parts = []
        for body in _BODIES:
            row = np.zeros((4, body.size))
            if sensor.kind == ALTITUDE:
                if body is AIRSPEED:  # climb rate
                    row[INTEGRAL, 1], row[POSITION, 0] = condition.airspeed, -condition.airspeed
                    row[POSITION, 2] = np.sin(condition.gamma)
            else:
                model = find_sensor_model(sensor.kind)
                if model.measures(sensor.axis, body):
                    at = Mounting(place, _NO_MODES, _NO_MODES, _NO_MODES[0])
                    row = model.build_row(sensor.axis, body, at, condition)
            parts.append(row)
        polynomials.append(np.concatenate(parts, axis=1))
    return np.stack(polynomials)


def _find_determined(record: FlightRecord) -> np.ndarray:
    """Rigid-body motions that sensors determine; one without a sensor of its own is known."""
    which = {(one.kind, one.axis) for one in record.sensors}
    kinds = {one.kind for one in record.sensors}
    lateral = bool(which & {SIGNALS["p"], SIGNALS["r"], SIGNALS["beta"], SIGNALS["phi"]})
    lateral = lateral or (ACCELEROMETER.kind, "y") in which
    symmetric = bool(which & {SIGNALS["q"], SIGNALS["alpha"], SIGNALS["theta"]})
    symmetric = symmetric or (ACCELEROMETER.kind, "z") in which
    airspeed = AIRSPEED_PROBE.kind in kinds
    return np.array([symmetric, symmetric, airspeed, lateral, lateral, lateral])
