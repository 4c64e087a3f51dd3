"""Maximisation of the likelihood from several starts."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from flexsid.errors import Cancelled
from flexsid.sysid.estimation.estimate import Estimate, Outcome
from flexsid.sysid.estimation.experiment import Experiment, Parameters
from flexsid.sysid.estimation.likelihood import FitSettings, maximize

_PERTURBATION = 0.3  # of a start value, relative to it
PERTURBED_STARTS = 3
"""Perturbed starts at most, where no other start converged."""

SAME_COST = 1e-3
"""Optima whose costs differ by less are the same."""


@dataclass(frozen=True, slots=True)
class Optimum:
    """End of a maximisation: the parameters with their start, its name, and the estimate."""

    parameters: Parameters
    start: str
    estimate: Estimate


def maximize_from_starts(
    experiments: Sequence[Experiment],
    candidates: Mapping[str, Parameters],
    settings: FitSettings,
    count_moved_poles: Callable[[Optimum], int],
    report: Callable[[str, int, int, float], None],
    n_perturbed: int = PERTURBED_STARTS,
    known: Optimum | None = None,
) -> Optimum:
    """Maximise the likelihood from every start and return the best optimum.

    Parameters
    ----------
    experiments
        Data of the fit.
    candidates
        Start parameters by name.
    settings
        Of every maximisation.
    count_moved_poles
        Number of poles of out-of-band modes that a fit moved into the band.
    report
        Called with the name and number of the start, iteration and cost; may raise to stop.
    n_perturbed
        Perturbed starts at most, which follow where no start converged; their number is that of
        the candidates.
    known
        Where the maximisation from the candidate of this name ended, if that is known.

    Raises
    ------
    Cancelled
        If ``report`` cancels a maximisation.

    Notes
    -----
    Of the optima with fewest poles moved into the band the one of largest likelihood is best; of
    those with equal likelihood, the first that converged.
    """

    def attempt(name: str, parameters: Parameters, number: int) -> Optimum:
        if known is not None and known.start == name:
            return known

        def report_iteration(iteration: int, cost: float) -> None:
            report(name, number, iteration, cost)

        estimate = maximize(list(experiments), parameters, settings, report_iteration)
        if estimate.outcome is Outcome.CANCELLED:
            raise Cancelled(estimate.message)
        return Optimum(parameters, name, estimate)

    ends = [attempt(name, one, number) for number, (name, one) in enumerate(candidates.items())]
    best = _select_best(ends, count_moved_poles)
    for seed in range(n_perturbed):
        if best.estimate.outcome in (Outcome.CONVERGED, Outcome.SINGULAR_INFORMATION):
            break
        parameters = best.parameters
        factors = 1.0 + _PERTURBATION * np.random.default_rng(seed).uniform(
            -1, 1, parameters.start.size
        )
        perturbed = replace(parameters, start=parameters.start * factors)
        name = f"{best.start.split(', perturbed')[0]}, perturbed"
        again = attempt(name, perturbed, len(candidates))
        best = _select_best([best, again], count_moved_poles)
    return best


def _select_best(ends: Sequence[Optimum], count_moved_poles: Callable[[Optimum], int]) -> Optimum:
    moved = [count_moved_poles(end) for end in ends]
    ends = [end for end, n in zip(ends, moved, strict=True) if n == min(moved)]
    lowest = min(end.estimate.steps[-1].cost for end in ends)
    same = [end for end in ends if end.estimate.steps[-1].cost < lowest + SAME_COST]
    return min(same, key=lambda end: end.estimate.outcome is not Outcome.CONVERGED)
