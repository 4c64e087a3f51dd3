"""Search for the phases of one input: starts, perturbed elites, refined peaks."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from operator import attrgetter

import numpy as np
from jaxtyping import Float

from flexsid.sysid.excitation.extrema import evaluate_peak_factors, refine_peaks
from flexsid.sysid.excitation.norms import HarmonicSpectrum, lower_norms
from flexsid.sysid.excitation.peak_factor import schroeder_phases

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
