"""Peaks of a multisine between samples, and the refinement of its peak factor."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int
from scipy import linalg

from flexsid.sysid.excitation.norms import HarmonicSpectrum

_EVALUATION_POINTS = 32  # samples in the shortest period on which a peak factor is evaluated
_SEARCHED_POINTS = 16  # samples in the shortest period on which extrema are located
_LEAST_EXTREMUM = 0.93  # of the largest: lower ones have no weight at any temperature
# of the soft maximum, in sequence, over the root of the summed squared amplitudes
_TEMPERATURES = (3e-2, 2e-2, 1.3e-2, 8e-3, 5e-3, 3e-3, 1.5e-3, 7e-4, 3e-4, 1e-4, 3e-5)


def evaluate_peak_factor(
    spectrum: HarmonicSpectrum, phases: Float[np.ndarray, " n_tones"]
) -> float:
    """Relative peak factor with peaks between samples found by parabolas. [1]

    Notes
    -----
    (max - min) / (2 sqrt(2) rms), Sec. V.A. A coarse grid underestimates: 1.170 at
    4 samples per shortest period is 1.208 with interpolated peaks.
    """
    return float(evaluate_peak_factors(spectrum, phases[None])[0])


def evaluate_peak_factors(
    spectrum: HarmonicSpectrum,
    phases: Float[np.ndarray, "n_starts n_tones"],
) -> Float[np.ndarray, " n_starts"]:
    """Relative peak factors of many phases. [1]"""
    waves = spectrum.on_grid(phases, spectrum.grid_size(_EVALUATION_POINTS))
    span = _parabola_peaks(waves) + _parabola_peaks(-waves)
    return span / (2.0 * np.sqrt(np.sum(spectrum.amplitudes**2)))


def evaluate_magnitude(spectrum: HarmonicSpectrum, phases: Float[np.ndarray, " n_tones"]) -> float:
    """Largest magnitude, with peaks between samples found by parabolas. [unit of the amplitudes]"""
    wave = spectrum.on_grid(phases[None], spectrum.grid_size(_SEARCHED_POINTS))
    return float(max(_parabola_peaks(wave)[0], _parabola_peaks(-wave)[0]))


def _parabola_peaks(
    waves: Float[np.ndarray, "n_starts n_samples"],
) -> Float[np.ndarray, " n_starts"]:
    rows = np.arange(waves.shape[0])
    top = np.argmax(waves, axis=1)
    n = waves.shape[1]
    left, at, right = (waves[rows, (top + shift) % n] for shift in (-1, 0, 1))
    bend = left - 2.0 * at + right
    return at - np.where(bend < 0.0, (left - right) ** 2 / (8.0 * np.minimum(bend, -1e-300)), 0.0)


@dataclass(frozen=True, slots=True)
class _Extrema:
    """High maxima and low minima with their derivatives in the phases."""

    span: float
    signs: Int[np.ndarray, " n_extrema"]
    values: Float[np.ndarray, " n_extrema"]  # of sign * u
    cosines: Float[np.ndarray, "n_extrema n_tones"]  # du/dphi
    sines: Float[np.ndarray, "n_extrema n_tones"]
    bends: Float[np.ndarray, " n_extrema"]  # d2u/dtheta2 with theta = 2 pi t / T


def refine_peaks(
    spectrum: HarmonicSpectrum, phases: Float[np.ndarray, " n_tones"], iterations: int = 5
) -> Float[np.ndarray, " n_tones"]:
    """Minimise max - min by Levenberg-Marquardt on a soft maximum of the extrema.

    From the phases where the norms ended, with so many iterations at each temperature of the
    soft maximum; the phases of the smallest max - min met are returned. [rad]
    """
    scale = float(np.sqrt(np.sum(spectrum.amplitudes**2)))
    unit = HarmonicSpectrum(spectrum.harmonics, spectrum.amplitudes / scale)
    now = _find_extrema(unit, phases)
    best, lowest = phases, now.span
    damping = 1e-2
    for temperature in _TEMPERATURES:
        level = _soft_span(now, temperature)
        for _ in range(iterations):
            gradient, hessian = _soft_derivatives(unit, now, temperature)
            spread = np.trace(hessian) / phases.size
            hessian[np.diag_indices(phases.size)] += damping * spread
            step = linalg.solve(hessian, gradient, assume_a="pos", check_finite=False)
            step /= max(1.0, float(np.abs(step).max()) / 0.3)
            tried = phases - step
            then = _find_extrema(unit, tried)
            tried_level = _soft_span(then, temperature)
            if tried_level < level:
                gained = level - tried_level
                phases, now, level = tried, then, tried_level
                damping = max(damping * 0.3, 1e-7)
                if now.span < lowest:
                    best, lowest = phases, now.span
                if gained < 1e-6:
                    break
            else:
                damping *= 6.0
                if damping > 1e3:
                    damping = 1e-2
                    break
    return best


def _find_extrema(spectrum: HarmonicSpectrum, phases: Float[np.ndarray, " n_tones"]) -> _Extrema:
    n = spectrum.grid_size(_SEARCHED_POINTS)
    wave = spectrum.on_grid(phases[None], n)[0]
    before, after = np.roll(wave, 1), np.roll(wave, -1)
    places, signs = [], []
    for sign in (1, -1):
        height = sign * wave
        peak = (height >= sign * before) & (height > sign * after)
        own = np.flatnonzero(peak & (height > _LEAST_EXTREMUM * height.max()))
        places.append(own)
        signs.append(np.full(own.size, sign))
    place, sign = np.concatenate(places), np.concatenate(signs)
    bend = before[place] - 2.0 * wave[place] + after[place]
    offset = 0.5 * (before[place] - after[place]) / np.where(bend == 0.0, 1.0, bend)
    k = spectrum.harmonics
    angles = np.outer(2.0 * np.pi * (place + offset) / n, k) + phases
    cosines, sines = spectrum.amplitudes * np.cos(angles), spectrum.amplitudes * np.sin(angles)
    values = sign * sines.sum(axis=1)
    span = float(values[sign > 0].max() + values[sign < 0].max())
    return _Extrema(span, sign, values, cosines, sines, -(sines @ k.astype(float) ** 2))


def _soft_span(extrema: _Extrema, temperature: float) -> float:
    total = 0.0
    for sign in (1, -1):
        own = extrema.values[extrema.signs == sign]
        top = own.max()
        total += float(top + temperature * np.log(np.sum(np.exp((own - top) / temperature))))
    return total


def _soft_derivatives(
    spectrum: HarmonicSpectrum, extrema: _Extrema, temperature: float
) -> tuple[Float[np.ndarray, " n_tones"], Float[np.ndarray, "n_tones n_tones"]]:
    """Gradient and a positive Hessian; the time of an extremum changes with the phases, too."""
    n = spectrum.harmonics.size
    gradient, hessian = np.zeros(n), np.zeros((n, n))
    for sign in (1, -1):
        own = extrema.signs == sign
        values = extrema.values[own]
        weights = np.exp((values - values.max()) / temperature)
        weights /= weights.sum()
        pulls = sign * extrema.cosines[own]
        mean = weights @ pulls
        gradient += mean
        away = (pulls - mean) * np.sqrt(weights / temperature)[:, None]
        hessian += away.T @ away
        slopes = extrema.sines[own] * spectrum.harmonics
        bends = np.maximum(np.abs(extrema.bends[own]), 1e-9)
        slopes *= np.sqrt(weights / bends)[:, None]
        hessian += slopes.T @ slopes
    return gradient, hessian
