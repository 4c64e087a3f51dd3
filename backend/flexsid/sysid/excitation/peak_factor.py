"""Phases of a multisine: few peaks for its power, and zero at its start."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float, Int
from scipy import optimize

from flexsid.sysid.excitation.norms import HarmonicSpectrum

_CLIP_LEVELS = np.linspace(0.80, 0.99, 300)  # of the largest magnitude, one per iteration
_ZERO = 1e-9  # of the sum of all amplitudes: rounding where a sum of sines is zero
_TIE = 0.005  # of the largest running integral: what the grid of crossings resolves


def relative_peak_factor(samples: Float[np.ndarray, " n_samples"]) -> float:
    """Peak-to-peak over that of a single sine of the same rms; 1 for one sine. [1]"""
    peak_to_peak = samples.max() - samples.min()
    return float(peak_to_peak / (2.0 * np.sqrt(2.0) * np.sqrt(np.mean(samples**2))))


def schroeder_phases(amplitudes: Float[np.ndarray, " n_tones"]) -> Float[np.ndarray, " n_tones"]:
    """Phases that spread the energy of the tones over the period. [rad]

    Notes
    -----
    Source: Schroeder, IEEE Trans. Inf. Theory 16 (1970), doi:10.1109/TIT.1970.1054411; for equal
    amplitudes it is phi_k = -pi k^2 / n.
    """
    power = amplitudes**2 / np.sum(amplitudes**2)
    before = np.concatenate([[0.0], np.cumsum(np.cumsum(power))[:-1]])
    return -2.0 * np.pi * before


def lower_peak(
    harmonics: Int[np.ndarray, " n_tones"],
    amplitudes: Float[np.ndarray, " n_tones"],
    phases: Float[np.ndarray, " n_tones"],
) -> Float[np.ndarray, " n_tones"]:
    """Improve phases by clipping: clip the peaks, retain the phases of the clipped signal.

    Returns the best phases met, so the result is never worse than the start. [rad]

    Notes
    -----
    Source: van der Ouderaa, Schoukens, Renneboog, IEEE Trans. Instrum. Meas. 37
    (1988): swap between the clipped signal and the prescribed spectrum.
    """
    n_samples = 1 << int(np.ceil(np.log2(16 * harmonics.max())))
    spectrum = np.zeros(n_samples // 2 + 1, dtype=complex)
    best, lowest = phases, np.inf
    for level in _CLIP_LEVELS:
        spectrum[harmonics] = amplitudes * np.exp(1j * (phases - np.pi / 2.0)) * n_samples / 2.0
        samples = np.fft.irfft(spectrum, n_samples)
        factor = relative_peak_factor(samples)
        if factor < lowest:
            best, lowest = phases, factor
        limit = level * np.abs(samples).max()
        clipped = np.fft.rfft(np.clip(samples, -limit, limit))[harmonics]
        phases = np.angle(clipped) + np.pi / 2.0
    return best


def starts_at_zero(
    amplitudes: Float[np.ndarray, " n_tones"], phases: Float[np.ndarray, " n_tones"]
) -> bool:
    """Return whether the first sample of a multisine is zero but for rounding."""
    first = float(np.sum(amplitudes * np.sin(phases)))
    return abs(first) <= _ZERO * float(np.abs(amplitudes).sum())


def start_at_zero(
    harmonics: Int[np.ndarray, " n_tones"],
    amplitudes: Float[np.ndarray, " n_tones"],
    phases: Float[np.ndarray, " n_tones"],
) -> Float[np.ndarray, " n_tones"]:
    """Shift in time to a zero crossing where the running integral is zero, too.

    No step where the excitation starts, and an attitude that follows the integral
    of the surfaces ends where it started. Peak factor and orthogonality do not
    change. [rad]
    """
    turn = 2.0 * np.pi * harmonics

    def value(cycle: float) -> float:
        return float(np.sum(amplitudes * np.sin(turn * cycle + phases)))

    # By transforms, since a design may have thousands of tones.
    n_grid = 32 * int(harmonics.max())
    wave = HarmonicSpectrum(harmonics, amplitudes).on_grid(phases[None], n_grid)[0]
    running = HarmonicSpectrum(harmonics, amplitudes / turn)
    size = np.abs(running.on_grid(phases[None] + np.pi / 2.0, n_grid)[0])
    crossings = np.flatnonzero(wave * np.roll(wave, -1) <= 0.0)
    crossing = int(crossings[np.argmin(size[crossings])])
    # Crossings may tie but for rounding: phases that begin at one of the best stay as they are.
    is_best = size[0] <= size[crossing] + _TIE * size.max()
    if is_best and starts_at_zero(amplitudes, phases):
        return phases
    before, after = value(crossing / n_grid), value((crossing + 1) / n_grid)
    shift = crossing / n_grid
    if before * after < 0.0:  # else the wave is zero at one of the two samples
        shift = optimize.brentq(value, shift, (crossing + 1) / n_grid, xtol=1e-15)
    elif abs(after) < abs(before):
        shift = (crossing + 1) / n_grid
    return np.mod(phases + turn * shift + np.pi, 2.0 * np.pi) - np.pi
