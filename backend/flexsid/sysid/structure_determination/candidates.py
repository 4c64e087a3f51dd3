"""Search of model structures by output error or frequency response error."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float

from flexsid.errors import BadInput, NotIdentifiable
from flexsid.sysid.estimation.estimate import Estimate, Outcome
from flexsid.sysid.estimation.experiment import Experiment
from flexsid.sysid.estimation.leakage import fit_with_leakage_correction
from flexsid.sysid.estimation.likelihood import FitSettings
from flexsid.sysid.estimation.parameters import Parameters
from flexsid.sysid.structure_determination.evidence import Evidence, estimate_subset
from flexsid.sysid.structure_determination.likelihood import (
    compute_likelihood_evidence,
    expand_values,
    select_candidates,
)
from flexsid.sysid.structure_determination.selection import (
    DEFAULT_THRESHOLDS,
    Selection,
    SelectionState,
    SelectionStep,
    Thresholds,
    select_terms,
    summarise_selection,
)

Report = Callable[[int, str], None]
"""Called with the number of fitted models, and a message."""

_DEFAULT_SETTINGS = FitSettings()
_ROUNDS = 8  # fitted models, at most
_QUADRATIC_RATIO = 3.0  # likelihood ratio over its prediction: not valid above


@dataclass(frozen=True, slots=True, eq=False)
class CandidateModel:
    """A model that was fitted during the search.

    ``cost`` is the negative log likelihood of all maneuvers, ``bic`` Schwarz's criterion,
    ``likelihood_ratio`` twice the rise of the cost (negative: fall) from the model before, and
    ``predicted_ratio`` the same predicted by the quadratic expansion around that one.
    ``estimates`` are by maneuver.
    """

    why: str
    selected: tuple[str, ...]
    changed: tuple[SelectionStep, ...]
    cost: float
    bic: float
    likelihood_ratio: float
    predicted_ratio: float
    estimates: tuple[Estimate, ...]

    @property
    def converged(self) -> bool:
        """Whether every maneuver's fit ended at an optimum."""
        return all(one.outcome is Outcome.CONVERGED for one in self.estimates)


@dataclass(frozen=True, slots=True, eq=False)
class CandidateSearchResult:
    """All fitted models, the one to propose, and the evidence on every term."""

    candidates: tuple[CandidateModel, ...]
    best: CandidateModel
    selection: Selection
    evidences: tuple[Evidence, ...]


def search_candidates(
    maneuvers: Sequence[Experiment],
    candidates: Parameters,
    start: Sequence[str] | None = None,
    thresholds: Thresholds = DEFAULT_THRESHOLDS,
    settings: FitSettings = _DEFAULT_SETTINGS,
    report: Report | None = None,
    values: Sequence[Float[np.ndarray, " n_theta"]] | None = None,
) -> CandidateSearchResult:
    """Select terms by Wald's test, the score test and the likelihood ratio.

    Parameters
    ----------
    maneuvers
        One experiment each; they share the structure, and each has its own values.
    candidates
        Derivatives that could be in the model, with starting values; extras such as
        delays stay free throughout. Derivatives that are not candidates are held.
    start
        Names of the derivatives to begin with, e.g. what equation error chose; all by
        default.
    report
        Called before every fit and at its iterations; an exception ends the search.
    values
        Starting values of all candidates by maneuver, where they are not those of
        ``candidates``.

    Returns
    -------
    CandidateSearchResult
        The best is the last one, for which Wald and score tests select no change; where
        the search returned to an earlier model, the one of least BIC.

    Raises
    ------
    BadInput
        If a name to start with is no candidate.
    NotIdentifiable
        If the first model cannot be fitted.

    Notes
    -----
    One round fits a model, expands its likelihood over all candidates, and selects
    terms by that quadratic: out by Wald's test, in by the score test. Where the likelihood
    ratio of the next model is much larger than predicted, half of the dropped terms are
    restored.
    """
    report_progress = report or (lambda fitted, message: None)
    forced = np.arange(len(candidates.names)) >= candidates.rows.size
    selected = _mask(candidates, start) | forced
    theta = list(values or [candidates.start] * len(maneuvers))
    fitted: list[CandidateModel] = []
    visited: set[bytes] = set()
    evidences: tuple[Evidence, ...] = ()
    path: tuple[SelectionStep, ...] = ()
    why, predicted_ratio = "start", 0.0
    while len(fitted) < _ROUNDS and selected.tobytes() not in visited:
        visited.add(selected.tobytes())
        n_fitted, message = len(fitted), f"Fitting {int(selected.sum())} parameters"
        report_progress(n_fitted, message)

        def report_iteration(
            iteration: int, cost: float, n_fitted: int = n_fitted, message: str = message
        ) -> None:
            report_progress(n_fitted, f"{message}, iteration {iteration}")

        corrected, estimates = _fit(
            maneuvers, candidates, selected, theta, settings, report_iteration
        )
        cost = float(sum(one.steps[-1].cost for one in estimates))
        n_data = [2.0 * sum(data.measured.size for data in one.lines) for one in estimates]
        now = CandidateModel(
            why=why,
            selected=tuple(candidates.names[k] for k in np.flatnonzero(selected)),
            changed=path,
            cost=cost,
            bic=2.0 * cost + int(selected.sum()) * float(np.log(n_data).sum()),
            likelihood_ratio=2.0 * (cost - fitted[-1].cost) if fitted else 0.0,
            predicted_ratio=predicted_ratio,
            estimates=tuple(estimates),
        )
        fitted.append(now)
        if not _is_usable(now):
            break
        gone = [step for step in path if step.action == "drop"]
        if (
            now.likelihood_ratio > _QUADRATIC_RATIO * max(predicted_ratio, 0.0) + thresholds.f_out
            and gone[1:]
        ):
            back = sorted(gone, key=lambda step: -step.f)[: len(gone) // 2]
            selected = selected.copy()
            selected[[candidates.names.index(step.term) for step in back]] = True
            path = tuple(step for step in path if step not in back)
            terms = ", ".join(step.term for step in back)
            why = f"{terms} restored: likelihood ratio larger than predicted"
            continue
        theta = [expand_values(selected, estimate.values) for estimate in estimates]
        evidences = tuple(
            compute_likelihood_evidence(
                experiment, candidates, values, int(selected.sum()), kind=settings.noise, parts=True
            )
            for experiment, values in zip(corrected, theta, strict=True)
        )
        end = select_terms(evidences, SelectionState(selected), thresholds, forced=forced)
        rise = [
            estimate_subset(one, end.selected).rest - estimate_subset(one, selected).rest
            for one in evidences
        ]
        predicted_ratio = float(sum(rise))
        path, selected, why = end.path, end.selected, _describe_path(end.path)
    usable = [one for one in fitted if _is_usable(one)]
    if not usable or not evidences:
        raise NotIdentifiable(
            f"the {len(fitted[0].selected)} terms to start with cannot be fitted to these data: "
            f"{fitted[0].estimates[0].message}",
            code="bad-start",
        )
    best = fitted[-1]
    if path or usable[-1] is not best:
        best = min(usable, key=lambda one: (not one.converged, one.bic))
    in_best = np.array([name in set(best.selected) for name in candidates.names])
    selection = summarise_selection(evidences, SelectionState(in_best), thresholds)
    return CandidateSearchResult(tuple(fitted), best, selection, evidences)


def _is_usable(candidate: CandidateModel) -> bool:
    return bool(
        np.isfinite(candidate.cost)
        and all(np.isfinite(one.corrected_covariance).all() for one in candidate.estimates)
    )


def _mask(candidates: Parameters, start: Sequence[str] | None) -> Bool[np.ndarray, " n_theta"]:
    derivatives = candidates.names[: candidates.rows.size]
    unknown = sorted(set(start or ()) - set(derivatives))
    if unknown:
        raise BadInput(
            f"{', '.join(unknown)} cannot be in the model to start from: not among the candidates",
            code="no-candidate",
        )
    inside = np.zeros(len(candidates.names), dtype=bool)
    inside[: len(derivatives)] = [start is None or name in start for name in derivatives]
    return inside


def _fit(
    maneuvers: Sequence[Experiment],
    candidates: Parameters,
    selected: Bool[np.ndarray, " n_theta"],
    theta: Sequence[Float[np.ndarray, " n_theta"]],
    settings: FitSettings,
    report: Callable[[int, float], None],
) -> tuple[list[Experiment], list[Estimate]]:
    """Estimates, and the experiments corrected for leakage."""
    if not selected.any():
        raise NotIdentifiable(
            "no term is left: none of the candidates is significant", code="empty"
        )
    priors = settings.priors or {}
    corrected, found = [], []
    for experiment, values in zip(maneuvers, theta, strict=True):
        parameters = select_candidates(candidates, selected, values)
        held = {name: prior for name, prior in priors.items() if name in parameters.names}
        own = replace(settings, priors=held)
        settled, estimate = fit_with_leakage_correction([experiment], parameters, own, report)
        corrected += settled
        found.append(estimate)
    return corrected, found


def _describe_path(path: Sequence[SelectionStep]) -> str:
    words = []
    for action, test in (("drop", "dropped by Wald's test"), ("enter", "entered by the score")):
        terms = [step.term for step in path if step.action == action]
        if terms:
            words.append(f"{', '.join(terms)} {test}")
    return "; ".join(words)
