"""Models of a search, fitted as runs: with all candidate terms, and with some of them."""

from __future__ import annotations

from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass, replace

from flexsid.records.model_structure import Structure
from flexsid.records.run import AdequacyState, Method, ModelAdequacy, Progress, ReportProgress
from flexsid.records.search import SearchSettings
from flexsid.sysid.estimation.estimate import Estimate, Outcome
from flexsid.sysid.structure_determination.selection import Thresholds
from flexsid.workflow.fits.computation import ComputedRun, compute_run
from flexsid.workflow.fits.estimation_task import (
    EstimationTask,
    get_first_start,
    select_free_parameters,
)


@dataclass(frozen=True, slots=True)
class HoldingRun:
    """A stored run of a maneuver that holds a term, and its value over its standard error."""

    run_id: int
    sigmas: float


@dataclass(frozen=True, slots=True)
class SearchTask:
    """Input of a worker: the run of each fitted and each validation maneuver with all candidates.

    ``held`` are the terms that a stored run of a maneuver holds.
    """

    method: Method
    settings: SearchSettings
    thresholds: Thresholds
    structure: Structure
    maneuvers: tuple[EstimationTask, ...]
    unseen: tuple[EstimationTask, ...]
    held: Mapping[str, HoldingRun]
    warnings: tuple[str, ...]


@dataclass(frozen=True, slots=True, eq=False)
class FittedModel:
    """A candidate model structure: its terms, and its run of every maneuver."""

    name: str
    why: str
    selected: tuple[str, ...]
    runs: tuple[ComputedRun, ...]

    @property
    def estimates(self) -> tuple[Estimate, ...]:
        """Estimates of all parameters of the runs, the nuisance parameters included."""
        return tuple(get_whole_estimate(one) for one in self.runs)

    @property
    def converged(self) -> bool:
        """Whether every run ended at an optimum."""
        return all(one.estimate.outcome is Outcome.CONVERGED for one in self.runs)

    @property
    def cost(self) -> float | None:
        """Negative log likelihood of all maneuvers; None of a method without one."""
        steps = [one.estimate.steps for one in self.runs]
        return float(sum(one[-1].cost for one in steps)) if all(steps) else None

    @property
    def adequacy(self) -> ModelAdequacy:
        """The tests for remaining model error of the run that they reject, else of the first."""
        every = [one.adequacy for one in self.runs]
        return next((a for a in every if a.state is AdequacyState.SUSPECT), every[0])

    @property
    def rejection(self) -> str:
        """The failed tests for remaining model error; empty where no run is suspect."""
        found = self.adequacy
        return found.reason if found.state is AdequacyState.SUSPECT else ""


def get_whole_estimate(run: ComputedRun) -> Estimate:
    """Return the estimate of all parameters, the nuisance parameters included."""
    return run.estimate if run.retained is None else run.retained.estimate


def list_candidates(task: EstimationTask) -> tuple[str, ...]:
    """List the candidate terms: free derivatives of the model structure."""
    names = select_free_parameters(task, get_first_start(task), ()).names
    return tuple(name for name in names if name not in task.nuisance_names)


def fit_all_terms(
    task: SearchTask, report: ReportProgress, share: tuple[float, float]
) -> FittedModel:
    """Compute the run of every maneuver with all candidates."""
    name = "all terms"
    runs = _compute_runs(task.maneuvers, name, share, report)
    return FittedModel(name, "all candidates", list_candidates(task.maneuvers[0]), runs)


def fit_terms(
    task: SearchTask,
    full: FittedModel,
    selected: tuple[str, ...],
    share: tuple[float, float],
    report: ReportProgress,
) -> FittedModel:
    """Compute the runs of a model with some terms, started at the estimates of all of them."""
    pairs = zip(task.maneuvers, full.runs, strict=True)
    tasks = [restrict_terms(one, run, selected) for one, run in pairs]
    name = f"{len(selected)} terms"
    return FittedModel(name, "", selected, _compute_runs(tasks, name, share, report))


def _compute_runs(
    tasks: Sequence[EstimationTask],
    name: str,
    share: tuple[float, float],
    report: ReportProgress,
) -> tuple[ComputedRun, ...]:
    runs = []
    for number, one in enumerate(tasks):
        fraction = interpolate_progress(share, number, len(tasks))
        at = Progress(fraction=fraction, message=f"{one.maneuver_tasks[0].label} with {name}")
        report(at)
        runs.append(compute_run(one, report_at(at, report)))
    return tuple(runs)


def interpolate_progress(share: tuple[float, float], number: int, count: int) -> float:
    """Return the progress before one of several parts."""
    return share[0] + (share[1] - share[0]) * number / count


def restrict_terms(
    task: EstimationTask, full: ComputedRun, selected: Container[str]
) -> EstimationTask:
    """Return the run of a model with some of the candidates."""
    absent = [name for name in list_candidates(task) if name not in selected]
    kept = tuple(name for name in list_candidates(task) if name in selected)
    structure = replace(
        task.structure, free=kept, fixed=task.structure.fixed | dict.fromkeys(absent, 0.0)
    )
    estimate = get_whole_estimate(full)
    found = dict(zip(estimate.names, estimate.values.tolist(), strict=True))
    start = task.model.fill_table(get_first_start(task).named() | full.held | found)
    return replace(
        task,
        structure=structure,
        starts={"the estimate of all terms": start},
        spread=task.spread if full.retained is None else full.retained.spread,
        try_equation_error=False,
        priors={name: prior for name, prior in task.priors.items() if name not in absent},
    )


def report_at(at: Progress, report: ReportProgress) -> ReportProgress:
    """Report the iterations of a fit at a fixed fraction of the search."""
    return lambda own: report(replace(at, iteration=own.iteration, cost=own.cost))
