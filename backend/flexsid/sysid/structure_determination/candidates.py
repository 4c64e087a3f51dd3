"""Search among models fitted by output error or frequency response error."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float

from flexsid.errors import BadInput, NotIdentifiable
from flexsid.sysid.estimation.estimate import Estimate, Outcome
from flexsid.sysid.estimation.experiment import Experiment
from flexsid.sysid.estimation.likelihood import FitSettings, maximize
from flexsid.sysid.estimation.parameters import Parameters
from flexsid.sysid.estimation.record_edges import settle_edges
from flexsid.sysid.structure_determination.evidence import Evidence, look
from flexsid.sysid.structure_determination.likelihood import likelihood_evidence, reduced
from flexsid.sysid.structure_determination.selection import (
    USUAL,
    Selection,
    SelectionStep,
    Thresholds,
    Walk,
    selection_at,
    walk,
)

Report = Callable[[int, str], None]
"""Told how many models were fitted, and what is done now."""

_AS_ALWAYS = FitSettings()
_ROUNDS = 8
_FAITHFUL = 3.0  # likelihood ratio over what the quadratic foretold: beyond, it is no guide


@dataclass(frozen=True, slots=True, eq=False)
class CandidateTerm:
    """A model that was fitted on the way.

    ``cost`` is the negative log likelihood of all maneuvers, ``bic`` Schwarz's criterion,
    ``likelihood_ratio`` twice what the cost rose by (negative: fell) from the model before, and
    ``foretold`` what the quadratic around that one promised. ``estimates`` are by maneuver.
    """

    why: str
    chosen: tuple[str, ...]
    changed: tuple[SelectionStep, ...]
    cost: float
    bic: float
    likelihood_ratio: float
    foretold: float
    estimates: tuple[Estimate, ...]

    @property
    def converged(self) -> bool:
        """Whether every maneuver's fit ended at an optimum."""
        return all(one.outcome is Outcome.CONVERGED for one in self.estimates)


@dataclass(frozen=True, slots=True, eq=False)
class CandidatesFound:
    """All models that were fitted, the one to propose, and what it says of every term."""

    candidates: tuple[CandidateTerm, ...]
    best: CandidateTerm
    selection: Selection
    evidences: tuple[Evidence, ...]


def search_candidates(
    maneuvers: Sequence[Experiment],
    candidates: Parameters,
    start: Sequence[str] | None = None,
    thresholds: Thresholds = USUAL,
    settings: FitSettings = _AS_ALWAYS,
    report: Report | None = None,
    values: Sequence[Float[np.ndarray, " n_theta"]] | None = None,
) -> CandidatesFound:
    """Choose terms by Wald's test, the score and the likelihood ratio.

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
    thresholds
        Partial F to enter and to stay.
    settings
        Of every fit.
    report
        Told of every fit; what it raises ends the search.
    values
        Starting values of all candidates by maneuver, where they are not those of
        ``candidates``.

    Returns
    -------
    CandidatesFound
        The best is the last one, whose Wald and score tests ask for no more change; where
        the search came back to a model it had, the one of least BIC.

    Raises
    ------
    BadInput
        If a name to start with is no candidate.
    NotIdentifiable
        If the first model cannot be fitted.

    Notes
    -----
    One round fits a model, expands its likelihood over all candidates, and walks that
    quadratic: terms out by Wald's test, in by the score. Where the likelihood ratio of the
    next model is much more than foretold, half of the terms that left come back.
    """
    tell = report or (lambda fitted, message: None)
    forced = np.arange(len(candidates.names)) >= candidates.rows.size
    chosen = _mask(candidates, start) | forced
    theta = list(values or [candidates.start] * len(maneuvers))
    fitted: list[CandidateTerm] = []
    visited: set[bytes] = set()
    evidences: tuple[Evidence, ...] = ()
    path: tuple[SelectionStep, ...] = ()
    why, foretold = "start", 0.0
    while len(fitted) < _ROUNDS and chosen.tobytes() not in visited:
        visited.add(chosen.tobytes())
        tell(len(fitted), f"Fitting {int(chosen.sum())} parameters")
        lines, estimates = _fit(maneuvers, candidates, chosen, theta, settings)
        before = fitted[-1] if fitted else None
        now = _candidate(why, candidates, chosen, path, estimates, before, foretold)
        fitted.append(now)
        if not _is_usable(now):
            break
        gone = [step for step in path if step.action == "drop"]
        if now.likelihood_ratio > _FAITHFUL * max(foretold, 0.0) + thresholds.f_out and gone[1:]:
            back = sorted(gone, key=lambda step: -step.f)[: len(gone) // 2]
            chosen = chosen.copy()
            chosen[[candidates.names.index(step.term) for step in back]] = True
            path = tuple(step for step in path if step not in back)
            why = f"{', '.join(step.term for step in back)} back: worth more than foretold"
            continue
        theta = [_spread(chosen, estimate.values) for estimate in estimates]
        evidences = tuple(
            likelihood_evidence(
                experiment, candidates, values, int(chosen.sum()), kind=settings.noise, parts=True
            )
            for experiment, values in zip(lines, theta, strict=True)
        )
        end = walk(evidences, Walk(chosen), thresholds, forced=forced)
        foretold = _foretold(evidences, chosen, end.chosen)
        path, chosen, why = end.path, end.chosen, _in_words(end.path)
    usable = [one for one in fitted if _is_usable(one)]
    if not usable or not evidences:
        raise NotIdentifiable(
            f"the {len(fitted[0].chosen)} terms to start with cannot be fitted to these lines: "
            f"{fitted[0].estimates[0].message}",
            code="bad-start",
        )
    settled = not path and usable[-1] is fitted[-1]
    best = fitted[-1]
    if not settled:
        best = min(usable, key=lambda one: (not one.converged, one.bic))
    in_best = np.array([name in set(best.chosen) for name in candidates.names])
    selection = selection_at("likelihood", evidences, Walk(in_best), thresholds)
    return CandidatesFound(tuple(fitted), best, selection, evidences)


def _is_usable(candidate: CandidateTerm) -> bool:
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
    chosen: Bool[np.ndarray, " n_theta"],
    theta: Sequence[Float[np.ndarray, " n_theta"]],
    settings: FitSettings,
) -> tuple[list[Experiment], list[Estimate]]:
    """Estimates, and the lines as they are without what the edges of the records did."""
    if not chosen.any():
        raise NotIdentifiable(
            "no term is left: nothing in the data asks for any of the candidates", code="empty"
        )
    priors = settings.priors or {}
    lines, found = [], []
    for experiment, values in zip(maneuvers, theta, strict=True):
        parameters = reduced(candidates, chosen, values)
        kept = {name: prior for name, prior in priors.items() if name in parameters.names}
        own = replace(settings, priors=kept)
        estimate = maximize([experiment], parameters, own)
        (settled,), estimate = settle_edges([experiment], parameters, estimate, own)
        lines.append(settled)
        found.append(estimate)
    return lines, found


def _spread(
    chosen: Bool[np.ndarray, " n_theta"], values: Float[np.ndarray, " n_chosen"]
) -> Float[np.ndarray, " n_theta"]:
    """Values at their place among all candidates, zero elsewhere."""
    theta = np.zeros(chosen.size)
    theta[chosen] = values
    return theta


def _candidate(
    why: str,
    candidates: Parameters,
    chosen: Bool[np.ndarray, " n_theta"],
    path: tuple[SelectionStep, ...],
    estimates: Sequence[Estimate],
    before: CandidateTerm | None,
    foretold: float,
) -> CandidateTerm:
    cost = float(sum(one.steps[-1].cost for one in estimates))
    n_data = [2.0 * sum(lines.measured.size for lines in one.lines) for one in estimates]
    return CandidateTerm(
        why=why,
        chosen=tuple(name for name, kept in zip(candidates.names, chosen, strict=True) if kept),
        changed=path,
        cost=cost,
        bic=2.0 * cost + int(chosen.sum()) * float(np.log(n_data).sum()),
        likelihood_ratio=0.0 if before is None else 2.0 * (cost - before.cost),
        foretold=foretold,
        estimates=tuple(estimates),
    )


def _foretold(
    evidences: Sequence[Evidence],
    before: Bool[np.ndarray, " n_theta"],
    after: Bool[np.ndarray, " n_theta"],
) -> float:
    """Rise of twice the cost from one set of terms to another, by the quadratic."""
    return float(sum(look(e, after).rest - look(e, before).rest for e in evidences))


def _in_words(path: Sequence[SelectionStep]) -> str:
    words = []
    for action, said in (("drop", "dropped by Wald's test"), ("enter", "entered by the score")):
        terms = [step.term for step in path if step.action == action]
        if terms:
            words.append(f"{', '.join(terms)} {said}")
    return "; ".join(words)
