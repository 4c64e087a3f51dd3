"""Checks before flight, classic inputs for comparison, and recognition of multisines."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from jaxtyping import Complex, Float

from flexsid.allowed import Allowed, Positive
from flexsid.errors import BadInput
from flexsid.sysid.excitation.catalogue import is_throttle
from flexsid.sysid.excitation.designer import list_units
from flexsid.sysid.excitation.multisine import Multisine, Tones
from flexsid.sysid.excitation.peak_factor import HarmonicSpectrum, evaluate_magnitude
from flexsid.sysid.signals import TimeHistory

# --- Checks before flight: orthogonality, peaks, and the response of the actuators ----------------


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


# --- Classic inputs for comparison: doublet, 3-2-1-1 and sweep, one surface after the other -------

KINDS = ("doublet", "3-2-1-1", "sweep")
_LENGTHS = 6  # units of time to choose from
_PULSES = {"doublet": (1, -1), "3-2-1-1": (1, 1, 1, -1, -1, 1, -1)}


def design_classic_input(
    kind: str,
    peaks: Mapping[str, float],
    duration_s: float,
    rate_hz: float,
    record_s: float,
    band_hz: tuple[float, float],
    pulse_s: float | None = None,
) -> TimeHistory:
    """Move one surface after the other, each for its share of the duration.

    Parameters
    ----------
    kind
        ``doublet``, ``3-2-1-1`` or ``sweep``.
    peaks
        Largest command of each input, in the order of their turns. [rad]
    duration_s
        Of all turns together. [s]
    rate_hz
        Of the samples. [Hz]
    record_s
        Of the history; zero after the last turn. [s]
    band_hz
        Of a sweep. [Hz]
    pulse_s
        Unit of time of pulses; must fit the turn. [s]
    """
    turn = int(duration_s / len(peaks) * rate_hz)
    values = np.zeros((round(record_s * rate_hz), len(peaks)))
    for column, peak in enumerate(peaks.values()):
        if kind == "sweep":
            samples = _sweep(turn, rate_hz, band_hz)
        else:
            samples = _pulses(_PULSES[kind], turn, round((pulse_s or 0.0) * rate_hz))
        values[column * turn : (column + 1) * turn, column] = peak * samples
    return TimeHistory(0.0, rate_hz, values, tuple(peaks))


def pulse_lengths(
    kind: str, duration_s: float, n_inputs: int, rate_hz: float
) -> Float[np.ndarray, " n_lengths"]:
    """Units of time to choose from, from two samples to half a turn for all pulses. [s]"""
    longest = 0.5 * duration_s / n_inputs / len(_PULSES[kind])
    shortest = min(2.0 / rate_hz, longest)
    return np.geomspace(shortest, longest, _LENGTHS)


def _sweep(
    n_samples: int, rate_hz: float, band_hz: tuple[float, float]
) -> Float[np.ndarray, " n_samples"]:
    """Sine of unit size whose frequency rises linearly over the whole turn."""
    time = np.arange(n_samples) / rate_hz
    slope = (band_hz[1] - band_hz[0]) * rate_hz / n_samples
    return np.sin(2.0 * np.pi * (band_hz[0] + 0.5 * slope * time) * time)


def _pulses(signs: tuple[int, ...], n_samples: int, unit: int) -> Float[np.ndarray, " n_samples"]:
    pulse = np.repeat(np.array(signs, dtype=float), max(1, unit))
    samples = np.zeros(n_samples)
    samples[: min(n_samples, pulse.size)] = pulse[:n_samples]
    return samples


# --- Recognise a multisine in recorded samples: harmonics, amplitudes, phases ---------------------

_FAINTEST = 0.05  # of the largest harmonic: rounding of a text file is far below it
_EXPLAINED = 0.9999  # of the power, least share of the recognised harmonics


def recognise_multisine(samples: Float[np.ndarray, " n_samples"]) -> tuple[Tones, int]:
    """Find the sines of one period, and the period in samples.

    Parameters
    ----------
    samples
        One period of one input, with or without its first sample repeated at the end,
        as flight computers that play back a table often have it. [unit]

    Raises
    ------
    BadInput
        If few harmonics do not explain the samples: not one period, or not a multisine.
    """
    n = samples.size
    if n < 8 or not np.all(np.isfinite(samples)):
        raise BadInput(
            f"{n} samples, {int(np.sum(~np.isfinite(samples)))} of them no numbers, are not"
            " a multisine; give one whole period",
            code="no-multisine",
        )
    candidates = [(*_identify_tones(samples[:period]), period) for period in (n, n - 1)]
    share, tones, period = max(candidates, key=lambda found: found[0])
    if share < _EXPLAINED or tones.harmonics.size > n // 4:
        raise BadInput(
            f"{tones.harmonics.size} harmonics have {100 * share:.2f} % of the power of {n}"
            f" samples; a multisine of whole period has {100 * _EXPLAINED:g} % in at most {n // 4};"
            " is it exactly one period?",
            code="no-multisine",
        )
    return tones, period


def _identify_tones(samples: Float[np.ndarray, " n_samples"]) -> tuple[float, Tones]:
    spectrum = np.fft.rfft(samples) * 2.0 / samples.size
    size = np.abs(spectrum)
    size[0] = 0.0
    if size.max() == 0.0:
        nothing = np.empty(0)
        return 0.0, Tones(nothing.astype(int), nothing, nothing)
    harmonics = np.flatnonzero(size > _FAINTEST * size.max())
    phases = np.mod(np.angle(spectrum[harmonics]) + 1.5 * np.pi, 2.0 * np.pi) - np.pi
    share = float(np.sum(size[harmonics] ** 2) / np.sum(size**2))
    return share, Tones(harmonics, size[harmonics], phases)
