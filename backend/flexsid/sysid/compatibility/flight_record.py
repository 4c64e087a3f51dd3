"""Sensors of one maneuver as compatibility checks compare them: samples, mounting, airspeed."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from jaxtyping import Complex, Float
from scipy import interpolate

from flexsid.sysid.model.condition import FlightCondition

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
    def polynomials(self) -> dict[Any, Float[np.ndarray, "n_y 4 n_r"]]:
        """Rows of the model by places and airspeed: a search uses few, hundreds of times."""
        return {}

    @cached_property
    def _curves(self) -> dict[str, interpolate.BSpline]:
        every = (*self.sensors, *(() if self.airspeed is None else (self.airspeed,)))
        return {
            one.name: interpolate.make_interp_spline(one.time, one.samples, k=3) for one in every
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
