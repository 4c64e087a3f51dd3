"""Checks before flight: orthogonality, peaks, and the response of the actuators."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from jaxtyping import Complex, Float

from flexsid.allowed import Allowed, Positive
from flexsid.sysid.excitation.catalogue import is_throttle
from flexsid.sysid.excitation.export import list_units
from flexsid.sysid.excitation.extrema import evaluate_magnitude
from flexsid.sysid.excitation.multisine import Multisine
from flexsid.sysid.excitation.norms import HarmonicSpectrum


@dataclass(frozen=True, slots=True, kw_only=True)
class SurfaceLimits:
    """Limits of a surface, its delay [s] and freeplay; no limit where it is None.

    Freeplay is the whole play of the surface about the actuator.
    """

    position: Annotated[Positive | None, Allowed(le=1.05, text="[rad]")] = None
    rate: Annotated[Positive | None, Allowed(le=50.0, text="[rad/s]")] = None
    acceleration: Annotated[Positive | None, Allowed(text="[rad/s2]")] = None
    freeplay: Annotated[float, Allowed(ge=0.0, le=0.2, text="[rad]")] = 0.0
    delay_s: Annotated[float, Allowed(ge=0.0, le=1.0)] = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class ActuatorLimits(SurfaceLimits):
    """Second-order actuator with limits and the delay before it. [rad/s, 1]"""

    natural_frequency: float
    damping: float

    def response(self, omega: Float[np.ndarray, " n_omega"]) -> Complex[np.ndarray, " n_omega"]:
        """Deflection over command. [1]"""
        s = 1j * omega / self.natural_frequency
        return np.exp(-1j * omega * self.delay_s) / (1.0 + 2.0 * self.damping * s + s**2)


@dataclass(frozen=True, slots=True, kw_only=True)
class InputCheck:
    """One input: command and true deflection at their largest. [unit], [unit/s], [unit/s2]

    The unit of throttles is their full range, and the deflection is the command.
    """

    name: str
    unit: str
    peak_factor: float
    command_peak: float
    start: float
    deflection_peak: float
    rate_peak: float
    acceleration_peak: float
    within_limits: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class DesignChecks:
    """``correlation`` is the largest between two inputs over one period."""

    correlation: float
    inputs: tuple[InputCheck, ...]


def check_design(
    multisine: Multisine,
    rate_hz: float,
    actuator: ActuatorLimits,
    peak_factors: Mapping[str, float],
) -> DesignChecks:
    """Evaluate a design as sampled at a rate [Hz], and the deflections behind the actuators.

    ``peak_factors`` are those of ``compute_peak_factors``. The multisine is at the amplitude to
    be flown. The periodic response of the actuator of every surface is exact and linear, so that
    limits are compared with the unlimited deflection, without freeplay. The limit of a throttle is
    its full range.
    """
    samples = multisine.sample_period(rate_hz)
    size = np.sqrt(np.sum(samples**2, axis=0))
    correlation = np.abs(samples.T @ samples / np.outer(size, size) - np.eye(size.size)).max()
    rows = []
    units = list_units(multisine.inputs)
    for column, (name, tones) in enumerate(multisine.tones.items()):
        omega = 2.0 * np.pi * tones.harmonics / multisine.period_s
        throttle = is_throttle(name)
        response = np.ones_like(omega) if throttle else actuator.response(omega)
        peaks = []
        for order in range(3):
            moved = response * (1j * omega) ** order
            spectrum = HarmonicSpectrum(tones.harmonics, tones.amplitudes * np.abs(moved))
            peaks.append(evaluate_magnitude(spectrum, tones.phases + np.angle(moved)))
        limits = (actuator.position, actuator.rate, actuator.acceleration)
        if throttle:
            limits = (1.0, None, None)
        rows.append(
            InputCheck(
                name=name,
                unit=units[column],
                peak_factor=peak_factors[name],
                command_peak=float(np.abs(samples[:, column]).max()),
                start=float(samples[0, column]),
                deflection_peak=peaks[0],
                rate_peak=peaks[1],
                acceleration_peak=peaks[2],
                within_limits=all(
                    limit is None or peak <= limit
                    for peak, limit in zip(peaks, limits, strict=True)
                ),
            )
        )
    return DesignChecks(correlation=float(correlation), inputs=tuple(rows))
