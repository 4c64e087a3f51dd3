"""Classic inputs for comparison: doublet, 3-2-1-1 and sweep, one surface after the other."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float


def doublet(
    n_samples: int, rate_hz: float, pulse_s: float, peak: float
) -> Float[np.ndarray, " n_samples"]:
    """One pulse up, one down. [unit of the peak]"""
    return _pulses((1, -1), n_samples, rate_hz, pulse_s, peak)


def three_two_one_one(
    n_samples: int, rate_hz: float, pulse_s: float, peak: float
) -> Float[np.ndarray, " n_samples"]:
    """Pulses of 3, 2, 1 and 1 units of time, in alternate directions. [unit of the peak]"""
    return _pulses((1, 1, 1, -1, -1, 1, -1), n_samples, rate_hz, pulse_s, peak)


def sweep(
    n_samples: int, rate_hz: float, band_hz: tuple[float, float], peak: float
) -> Float[np.ndarray, " n_samples"]:
    """Sine of a frequency that rises linearly over the whole record. [unit of the peak]"""
    time = np.arange(n_samples) / rate_hz
    slope = (band_hz[1] - band_hz[0]) * rate_hz / n_samples
    return peak * np.sin(2.0 * np.pi * (band_hz[0] + 0.5 * slope * time) * time)


def _pulses(
    signs: tuple[int, ...], n_samples: int, rate_hz: float, pulse_s: float, peak: float
) -> Float[np.ndarray, " n_samples"]:
    pulse = np.repeat(np.array(signs, dtype=float), max(1, round(pulse_s * rate_hz)))
    samples = np.zeros(n_samples)
    samples[: min(n_samples, pulse.size)] = peak * pulse[:n_samples]
    return samples
