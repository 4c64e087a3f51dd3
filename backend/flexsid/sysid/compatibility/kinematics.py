"""Sensors of one maneuver, and the exact kinematics that they measure, linear in the motion.

At every frequency the windowed spectra of the sensors satisfy z = P(s) r + n. The rows P are those
of the linear model, r is the unknown motion, and n the exact kinematics of the measured
signals less P times their own motion. One Newton step for the motion is thereby exact for any
amplitude and variation of airspeed that the sensors follow, and for records that end in motion.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
import scipy
from jaxtyping import Complex, Float, Int

from flexsid.sysid.model.airspeed import AIRSPEED
from flexsid.sysid.model.condition import GRAVITY, FlightCondition
from flexsid.sysid.model.lateral import LATERAL
from flexsid.sysid.model.rigid_body import INTEGRAL, POSITION, Mounting
from flexsid.sysid.model.sensor_models import (
    ACCELEROMETER,
    AIRSPEED_PROBE,
    ATTITUDE,
    GYRO,
    VANE,
    find_sensor_model,
)

# --- Sensors of one maneuver as compatibility checks compare them: samples, mounting, airspeed

ALTITUDE = "altitude"
"""Kind of a sensor of altitude, which no model of an axis has."""

_TAPER = 0.1  # of the record: rise and fall of the window
_GAP_RISE_S = 0.3  # of the window beside samples that are not used
_MOST_FREQUENCY = 0.4  # of the slowest sampling rate


@dataclass(frozen=True, slots=True, eq=False)
class CompatibilitySensor:
    """One sensor: what it is, where it is, and its samples at its own times. [s]

    ``position`` is in body axes at the c.g. [m]. ``noise_std`` is the standard deviation of its
    samples, by the samples themselves. [unit of the samples]
    """

    name: str
    kind: str
    axis: str
    position: tuple[float, float, float]
    time: Float[np.ndarray, " n_samples"]
    samples: Float[np.ndarray, " n_samples"]
    noise_std: float

    @property
    def rate_hz(self) -> float:
        """Usual number of samples per second. [Hz]"""
        return 1.0 / float(np.median(np.diff(self.time)))


@dataclass(frozen=True, eq=False)
class FlightRecord:
    """All sensors of one maneuver on their clocks, and its condition.

    ``airspeed`` is true airspeed as it was recorded, None where it is that of the condition.
    Samples within ``gaps`` [s] are not used.
    """

    sensors: tuple[CompatibilitySensor, ...]
    condition: FlightCondition
    airspeed: CompatibilitySensor | None = None
    gaps: tuple[tuple[float, float], ...] = ()

    @cached_property
    def step_s(self) -> float:
        """Time between samples. [s]"""
        return 1.0 / max(one.rate_hz for one in self.sensors)

    @cached_property
    def time(self) -> Float[np.ndarray, " n"]:
        """Times that all sensors have, at the highest rate. [s]"""
        first = max(float(one.time[0]) for one in self.sensors)
        last = min(float(one.time[-1]) for one in self.sensors)
        return first + np.arange(max(int((last - first) / self.step_s + 1e-6) + 1, 0)) * self.step_s

    @property
    def duration_s(self) -> float:
        """Duration of the samples that all sensors have. [s]"""
        return self.time.size * self.step_s

    @cached_property
    def _window(self) -> Float[np.ndarray, "2 n"]:
        """Window and its derivative."""
        rise_s = max(2.0 * self.step_s, _TAPER * self.duration_s)
        first, last = float(self.time[0]), float(self.time[-1])
        found = _fade(np.minimum(self.time - first, last - self.time), rise_s)
        sign = np.where(self.time - first <= last - self.time, 1.0, -1.0)
        window, rate = found[0], sign * found[1]
        for begin, end in self.gaps:
            distance = np.maximum(begin - self.time, self.time - end)
            level, slope = _fade(distance, min(rise_s, _GAP_RISE_S))
            slope = np.where(self.time > end, slope, -slope)
            window, rate = window * level, rate * level + window * slope
        return np.stack([window, rate])

    @property
    def window(self) -> Float[np.ndarray, " n"]:
        """Window that is zero at both ends and within gaps, so that no value there matters.

        Notes
        -----
        Modulating function: Shinbrot, NACA TN 3288, 1954. Any window satisfies the kinematics
        exactly, since the derivative is moved to it by integration by parts.
        """
        return self._window[0]

    @property
    def window_rate(self) -> Float[np.ndarray, " n"]:
        """Derivative of the window. [1/s]"""
        return self._window[1]

    @cached_property
    def omega(self) -> Float[np.ndarray, " n_omega"]:
        """Multiples of 1/duration that all sensors resolve. [rad/s]"""
        top_hz = _MOST_FREQUENCY * min(one.rate_hz for one in self.sensors)
        count = max(1, int(top_hz * self.duration_s))
        return 2.0 * np.pi * np.arange(1, count + 1) / self.duration_s

    def transform(
        self, values: Float[np.ndarray, "n n_columns"]
    ) -> Complex[np.ndarray, "n_omega n_columns"]:
        """Fourier integrals of columns of samples that vanish at both ends. [unit * s]"""
        return self.step_s * np.fft.rfft(values, axis=0)[1 : self.omega.size + 1]

    @cached_property
    def rows(self) -> dict[Any, Float[np.ndarray, "4 n_r"]]:
        """Rows of the model by sensor, place and airspeed: a search changes one of hundreds."""
        return {}

    def transform_samples(
        self, sensor: CompatibilitySensor, delay_s: float
    ) -> Complex[np.ndarray, "n_omega 2"]:
        """Transform the samples of a sensor under the window and under its derivative."""
        found = self._transformed.get(sensor.name) if delay_s == 0.0 else None
        if found is None:
            found = self.transform(self._window.T * self.sample(sensor, delay_s)[:, None])
            if delay_s == 0.0:
                self._transformed[sensor.name] = found
        return found

    @cached_property
    def _transformed(self) -> dict[str, Complex[np.ndarray, "n_omega 2"]]:
        return {}

    @cached_property
    def _curves(self) -> dict[str, scipy.interpolate.BSpline]:
        every = (*self.sensors, *(() if self.airspeed is None else (self.airspeed,)))
        return {
            one.name: scipy.interpolate.make_interp_spline(one.time, one.samples, k=3)
            for one in every
        }

    def sample(self, sensor: CompatibilitySensor, delay_s: float) -> Float[np.ndarray, " n"]:
        """Samples of a sensor at the times of the record, less its delay."""
        if delay_s == 0.0:
            return self._undelayed[sensor.name]
        at = np.clip(self.time + delay_s, sensor.time[0], sensor.time[-1])
        return self._curves[sensor.name](at)

    @cached_property
    def _undelayed(self) -> dict[str, Float[np.ndarray, " n"]]:
        return {name: curve(self.time) for name, curve in self._curves.items()}

    def select(self, names: frozenset[str]) -> FlightRecord:
        """Return the record with some of its sensors."""
        return replace(self, sensors=tuple(one for one in self.sensors if one.name in names))


def _fade(distance: np.ndarray, rise: float) -> tuple[np.ndarray, np.ndarray]:
    """Cosine from zero to one over a distance, and its derivative."""
    at = np.clip(distance / rise, 0.0, 1.0)
    return 0.5 - 0.5 * np.cos(np.pi * at), 0.5 * np.pi / rise * np.sin(np.pi * at)


# --- Exact kinematics of all sensors of a record, as equations linear in the unknown motion -------

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
    w, w_rate = record.window[:, None], record.window_rate[:, None]
    velocities = _form_velocities(signals)
    known = [_form_known(one, places[one.name], signals, velocities) for one in record.sensors]
    is_derived = np.array([derived is not None for derived, _ in known])
    derived = [x for x, _ in known if x is not None]
    moved = np.stack(derived, axis=1) if derived else np.empty((record.time.size, 0))
    motion = [signals[name] for name in ("alpha", "q", "V", "beta", "p", "r")]
    motion = [x - x.mean() for x in motion]
    direct = np.stack([*(c for _, c in known), *motion], axis=1)
    spectra = record.transform(np.concatenate([w * moved, w_rate * moved, w * direct], axis=1))
    spectra = spectra[some]
    n_y, n_moved = len(record.sensors), len(derived)
    x, x_end = np.zeros((2, some.size, n_y), dtype=complex)
    x[:, is_derived], x_end[:, is_derived] = spectra[:, :n_moved], spectra[:, n_moved : 2 * n_moved]
    c, own_motion = spectra[:, 2 * n_moved :][:, :n_y], spectra[:, 2 * n_moved + n_y :]
    own = [
        record.transform_samples(one, errors.delays.get(one.name, 0.0))[some]
        for one in record.sensors
    ]
    # Noise is that of the recorded samples, whatever their scale.
    scale = np.array([scales.get(one.name, 1.0) for one in record.sensors])
    z, z_end = np.moveaxis(np.stack(own, axis=1), 2, 0) / scale
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


def _form_velocities(s: Mapping[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Form the velocity of the c.g. in body axes. [m/s]"""
    speed, alpha, beta = s["V"], s["alpha"], s["beta"]
    forward = speed * np.cos(beta)
    return forward * np.cos(alpha), speed * np.sin(beta), forward * np.sin(alpha)


def _form_known(
    sensor: CompatibilitySensor,
    place: tuple[float, float, float],
    s: Mapping[str, np.ndarray],
    velocities: tuple[np.ndarray, np.ndarray, np.ndarray],
) -> tuple[np.ndarray | None, np.ndarray]:
    """Form the signal that a sensor measures the derivative of, and what it measures itself."""
    x, y, z = place
    u, v, w = velocities
    p, q, r, speed = s["p"], s["q"], s["r"], s["V"]
    alpha, beta, phi, theta = s["alpha"], s["beta"], s["phi"], s["theta"]
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
        return None, p
    if which == (GYRO.kind, "y"):
        return None, q
    if which == (GYRO.kind, "z"):
        return None, r
    if which == (ATTITUDE.kind, "x"):
        return None, p + np.tan(theta) * (q * np.sin(phi) + r * np.cos(phi))
    if which == (ATTITUDE.kind, "y"):
        return None, q * np.cos(phi) - r * np.sin(phi)
    if which == (VANE.kind, "y"):
        return None, alpha - (x * q - y * p) / speed
    if which == (VANE.kind, "z"):
        return None, beta + (x * r - z * p) / speed
    if sensor.kind == AIRSPEED_PROBE.kind:
        return None, speed
    climb = u * np.sin(theta) - np.cos(theta) * (v * np.sin(phi) + w * np.cos(phi))
    return None, climb


def _form_rows(
    record: FlightRecord,
    places: Mapping[str, tuple[float, float, float]],
    airspeed_scale: float,
    omega: np.ndarray,
) -> Complex[np.ndarray, "n_omega n_y n_r"]:
    """Rows of all sensors: alpha, q, V, beta, p, r."""
    polynomials = np.stack(
        [_form_row(record, one, places[one.name], airspeed_scale) for one in record.sensors]
    )
    powers = np.stack([-1j / omega, np.ones_like(omega), 1j * omega, -(omega**2)], axis=1)
    return np.einsum("kp,ypr->kyr", powers, polynomials)


def _form_row(
    record: FlightRecord,
    sensor: CompatibilitySensor,
    place: tuple[float, float, float],
    airspeed_scale: float,
) -> Float[np.ndarray, "4 n_r"]:
    """Form the row of one sensor, or read the one formed before."""
    key = sensor.name, place, airspeed_scale
    found = record.rows.get(key)
    if found is not None:
        return found
    condition = record.condition
    condition = replace(condition, airspeed=condition.airspeed / airspeed_scale)
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
    record.rows[key] = np.concatenate(parts, axis=1)
    return record.rows[key]


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
