"""Phases of a multisine: the search for few peaks, also between samples.

A norm of growing even order leads smoothly to the largest magnitude. With w = u^(p-2)
every mean of w times two sines or cosines is a Fourier coefficient of w at the sum
or the difference of two harmonics: one transform gives gradient and Hessian.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from operator import attrgetter

import numpy as np
import scipy
from jaxtyping import Float, Int

# --- Minimise the L_p norms of many multisines at once, by Gauss-Newton in their phases -----------

# p = 4, 6, 10 ... 258; p - 2 doubles from one to the next, so that a power is one more squaring.
_SQUARINGS = (1, 2, 3, 4, 5, 6, 7, 8)

_POINTS = 8
"""Samples per shortest period; enough for powers up to 258, which weigh the top of a peak."""


Pairs = np.ndarray[tuple[int, int, int], np.dtype[np.complex128]]
"""One number per start and pair of tones."""


@dataclass(frozen=True, slots=True)
class HarmonicSpectrum:
    """Harmonics and amplitudes of one input."""

    harmonics: Int[np.ndarray, " n_tones"]
    amplitudes: Float[np.ndarray, " n_tones"]

    def on_grid(
        self, phases: Float[np.ndarray, "n_starts n_tones"], n_samples: int
    ) -> Float[np.ndarray, "n_starts n_samples"]:
        """Waveforms over one period."""
        spectrum = np.zeros((phases.shape[0], n_samples // 2 + 1), dtype=complex)
        spectrum[:, self.harmonics] = (
            -0.5j * n_samples * self.amplitudes * np.exp(1j * np.asarray(phases))
        )
        return scipy.fft.irfft(spectrum, n_samples, axis=1)

    def grid_size(self, points: int) -> int:
        """Samples per period with at least so many in the shortest period of a sine."""
        return int(scipy.fft.next_fast_len(max(64, points * int(self.harmonics.max())), real=True))


def lower_norms(
    spectrum: HarmonicSpectrum,
    phases: Float[np.ndarray, "n_starts n_tones"],
    iterations: int = 5,
    squarings: tuple[int, ...] = _SQUARINGS,
) -> Float[np.ndarray, "n_starts n_tones"]:
    """Lower the L_p norm of every start, p from low to high.

    One start per row [rad], ``iterations`` for each p = 2 + 2^squarings in turn. No phases are
    returned with a higher norm of the last order than where that order began; the scale of the
    amplitudes does not matter.

    Notes
    -----
    Source: Guillaume, Schoukens, Pintelon, Kollar, IEEE Trans. Instrum. Meas. 40 (1991),
    doi:10.1109/19.119778, for the sequence of norms; the Hessian from one transform is ours.
    """
    n_samples = spectrum.grid_size(_POINTS)
    phases = phases.copy()
    damping = np.full(phases.shape[0], 1e-3)
    waves = spectrum.on_grid(phases, n_samples)
    for squaring in squarings:
        p = 2 + 2**squaring
        level, weights = _norm(waves, squaring)
        for _ in range(iterations):
            gradient, hessian = _derivatives(spectrum, phases, weights, p)
            scale = np.trace(hessian, axis1=1, axis2=2) / phases.shape[1]
            regular = hessian + (damping * scale + 1e-12)[:, None, None] * np.eye(phases.shape[1])
            step = np.linalg.solve(regular, gradient[:, :, None])[:, :, 0]
            # A phase that turns by more than a radian has left its linearisation.
            step /= np.maximum(1.0, np.abs(step).max(axis=1))[:, None]
            tried = phases - step
            tried_waves = spectrum.on_grid(tried, n_samples)
            tried_level, tried_weights = _norm(tried_waves, squaring)
            better = tried_level < level
            damping = np.clip(np.where(better, damping * 0.3, damping * 6.0), 1e-6, 1e3)
            if not better.any():
                continue
            phases[better] = tried[better]
            waves[better] = tried_waves[better]
            level[better] = tried_level[better]
            weights[better] = tried_weights[better]
    return phases


def _norm(
    waves: Float[np.ndarray, "n_starts n_samples"], squaring: int
) -> tuple[Float[np.ndarray, " n_starts"], Float[np.ndarray, "n_starts n_samples"]]:
    """Logarithm of the L_p norm, and u^(p-2) over the mean of u^p; scaled against underflow."""
    squares = waves * waves
    top = squares.max(axis=1, keepdims=True)
    squares /= top
    weights = squares.copy()
    for _ in range(squaring - 1):
        weights *= weights
    mean = np.einsum("ij,ij->i", weights, squares) / waves.shape[1]
    p = 2 + 2**squaring
    level = 0.5 * np.log(top[:, 0]) + np.log(mean) / p
    weights /= mean[:, None] * top
    return level, weights


def _derivatives(
    spectrum: HarmonicSpectrum,
    phases: Float[np.ndarray, "n_starts n_tones"],
    weights: Float[np.ndarray, "n_starts n_samples"],
    p: int,
) -> tuple[
    Float[np.ndarray, "n_starts n_tones"],
    Float[np.ndarray, "n_starts n_tones n_tones"],
]:
    """Gradient and Gauss-Newton Hessian of the log of the L_p norm."""
    k, a = spectrum.harmonics, spectrum.amplitudes
    of_weights = np.asarray(scipy.fft.rfft(weights, axis=1), dtype=complex) / weights.shape[1]
    difference = k[:, None] - k
    turned = a * np.exp(1j * phases)
    # mean(w z_i z_j) and mean(w z_i conj z_j), with z_i = a_i exp(j (2 pi k_i t + phi_i)).
    apart: Pairs = of_weights[:, np.abs(difference)]
    np.conjugate(apart, out=apart, where=difference > 0)
    apart *= turned[:, :, None] * turned[:, None, :].conj()
    summed: Pairs = of_weights[:, k[:, None] + k].conj()
    summed *= turned[:, :, None] * turned[:, None, :]
    gradient = 0.5 * (summed.imag - apart.imag).sum(axis=2)
    hessian = 0.5 * (p - 1) * (summed.real + apart.real)
    return gradient, hessian


# --- Peaks of a multisine between samples, and the refinement of its peak factor ------------------

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
            step = scipy.linalg.solve(hessian, gradient, assume_a="pos", check_finite=False)
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


# --- Phases of a multisine: few peaks for its power, and zero at its start ------------------------

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
        shift = scipy.optimize.brentq(value, shift, (crossing + 1) / n_grid, xtol=1e-15)
    elif abs(after) < abs(before):
        shift = (crossing + 1) / n_grid
    return np.mod(phases + turn * shift + np.pi, 2.0 * np.pi) - np.pi


# --- Search for the phases of one input: starts, perturbed elites, refined peaks ------------------

_ELITES = 2  # of the best phases, perturbed in every round
_PERTURBATION_RAD = 0.5  # large enough to leave the local minimum of an elite [rad]
_FROM_ELITE = (3, 4, 5, 6, 7, 8)  # the low norms would change the elite


@dataclass(frozen=True, slots=True)
class Effort:
    """Number of iterations of the search.

    Starts, rounds of perturbed elites, how many of the best have their peaks
    refined, and with how many steps at each temperature.
    """

    starts: int
    rounds: int
    refined: int
    steps: int = 3


QUICK = Effort(starts=1, rounds=0, refined=0)
THOROUGH = Effort(starts=8, rounds=1, refined=2)
PATIENT = Effort(starts=8, rounds=0, refined=3, steps=10)


@dataclass(frozen=True, slots=True)
class FoundPhases:
    """Best phases so far and their relative peak factor."""

    phases: Float[np.ndarray, " n_tones"]
    peak_factor: float


def search_phases(
    spectrum: HarmonicSpectrum,
    effort: Effort = THOROUGH,
    seed: int = 0,
    report: Callable[[FoundPhases, float], None] | None = None,
) -> FoundPhases:
    """Find phases of a low relative peak factor; the same seed finds the same.

    ``report`` is called with the best so far and the fraction done; it may raise to stop.

    Notes
    -----
    Every candidate is evaluated on 32 points per shortest period with peaks between
    samples, never on the grid that it was optimised on.
    """
    n = spectrum.harmonics.size
    if n == 1:  # a single sine, whatever its phase
        return _evaluate(spectrum, np.zeros((1, 1)))[1]
    generator = np.random.default_rng(seed)
    # Short sums have many local minima and cost little.
    count = effort.starts * (1 if effort.starts == 1 else int(np.clip(64 // n, 1, 4)))
    steps = 1 + effort.rounds + (1 if effort.refined else 0)

    def report_progress(step: int) -> None:
        if report is not None:
            report(best, step / steps)

    pool = lower_norms(spectrum, _starts(spectrum, count, generator), iterations=4)
    factors, best = _evaluate(spectrum, pool)
    report_progress(1)
    for turn in range(effort.rounds):
        elite = pool[np.argsort(factors)[:_ELITES]]
        scattered = np.repeat(elite, max(1, count // (2 * _ELITES)), axis=0)
        scattered += _PERTURBATION_RAD * generator.standard_normal(scattered.shape)
        fresh = lower_norms(spectrum, scattered, iterations=3, squarings=_FROM_ELITE)
        pool = np.vstack([elite, fresh])
        factors, found = _evaluate(spectrum, pool)
        best = min(best, found, key=attrgetter("peak_factor"))
        report_progress(2 + turn)
    for row in np.argsort(factors)[: effort.refined]:
        refined = refine_peaks(spectrum, pool[row], effort.steps)
        best = min(best, _evaluate(spectrum, refined[None])[1], key=attrgetter("peak_factor"))
        report_progress(1 + effort.rounds)
    report_progress(steps)
    return best


def _starts(
    spectrum: HarmonicSpectrum, count: int, generator: np.random.Generator
) -> Float[np.ndarray, "n_starts n_tones"]:
    """Schroeder's phases, then half as many near them as there are anywhere."""
    schroeder = schroeder_phases(spectrum.amplitudes)
    near = generator.normal(scale=_PERTURBATION_RAD, size=(count, schroeder.size))
    starts = schroeder + near
    starts[0] = schroeder
    # Many phases need a chirp to start from.
    anywhere = slice(max(1, count // 3) if schroeder.size <= 16 else count, count)
    starts[anywhere] = generator.uniform(-np.pi, np.pi, starts[anywhere].shape)
    return starts


def _evaluate(
    spectrum: HarmonicSpectrum, pool: Float[np.ndarray, "n_starts n_tones"]
) -> tuple[Float[np.ndarray, " n_starts"], FoundPhases]:
    factors = evaluate_peak_factors(spectrum, pool)
    index = int(np.argmin(factors))
    return factors, FoundPhases(pool[index], float(factors[index]))
