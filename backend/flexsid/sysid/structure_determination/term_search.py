"""Search of the terms of a model by the evidence of the estimates with all of them."""

from __future__ import annotations

from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from flexsid.sysid.estimation.estimate import Estimate
from flexsid.sysid.structure_determination.evidence import (
    Evidence,
    compute_evidence,
    estimate_subset,
)
from flexsid.sysid.structure_determination.search import SearchMethod, search_equations
from flexsid.sysid.structure_determination.selection import (
    Selection,
    SelectionState,
    Thresholds,
    select_terms,
    summarise_selection,
)

HELD_SIGMAS = 4.5
"""Standard errors at which an estimate holds a term: it is never proposed for removal."""


@dataclass(frozen=True, slots=True, eq=False)
class TermSearch:
    """Selection of terms by the evidence of every maneuver on groups of them.

    Attributes
    ----------
    evidences
        Evidence of every maneuver, by group.
    thresholds
        Of the partial F and of the predicted squared error.
    by_equation
        Whether a group is a coefficient that is searched by equation error; else the terms of a
        model are selected from those of ``start``.
    start, forced
        Terms that the search begins with, and those that are never dropped.
    """

    evidences: Mapping[str, tuple[Evidence, ...]]
    thresholds: Thresholds
    by_equation: bool
    start: frozenset[str]
    forced: frozenset[str]

    def select(
        self,
        group: str,
        evidences: Sequence[Evidence],
        method: SearchMethod,
        forced: Container[str] = (),
    ) -> Selection:
        """Select the terms of a group by the evidence of every maneuver."""
        if self.by_equation:
            every = [{group: one} for one in evidences]
            return search_equations(every, method, self.thresholds, forced).coefficients[group]
        names = evidences[0].names
        stays = np.array([name in forced for name in names])
        begin = SelectionState(np.array([name in self.start for name in names]))
        end = select_terms(evidences, begin, self.thresholds, forced=stays)
        return summarise_selection(evidences, end, self.thresholds)

    def select_all(self, method: SearchMethod) -> dict[str, Selection]:
        """Select the terms of every group."""
        return {
            name: self.select(name, evidences, method, self.forced)
            for name, evidences in self.evidences.items()
        }

    def predict_ratio(self, selected: Container[str]) -> float:
        """Predict twice the rise of the cost of some terms over that of all of them."""
        ratio = 0.0
        for one in (evidence for each in self.evidences.values() for evidence in each):
            inside = np.array([name in selected for name in one.names])
            ratio += estimate_subset(one, inside).rest
            ratio -= estimate_subset(one, np.ones_like(inside)).rest
        return ratio


def group_by_coefficient(names: Sequence[str]) -> dict[str, list[str]]:
    """Group derivatives by their coefficient, the part of the name before the first underscore."""
    groups: dict[str, list[str]] = {}
    for name in names:
        groups.setdefault(name.split("_", 1)[0], []).append(name)
    return groups


def collect_evidence(
    estimates: Sequence[Estimate],
    names: Sequence[str],
    overlaps: Sequence[float],
    equation: str | None = None,
) -> tuple[Evidence, ...]:
    """Collect the evidence of every maneuver on some terms.

    Parameters
    ----------
    estimates
        Of every maneuver, with all candidates.
    names
        The terms.
    overlaps
        Number of frequencies per resolution of every record, by which data count less. [1]
    equation
        The coefficient whose data count; by default all.

    Raises
    ------
    NotIdentifiable
        If a term has no standard error.
    """
    found = []
    for estimate, overlap in zip(estimates, overlaps, strict=True):
        sizes = [one.measured.size for one in estimate.lines if equation in (None, one.name)]
        found.append(compute_evidence(estimate, names, 2.0 * sum(sizes) / overlap))
    return tuple(found)


def find_held_terms(estimates: Sequence[Estimate], names: Sequence[str]) -> frozenset[str]:
    """Find the terms that any estimate holds above 4.5 standard errors."""
    held = set[str]()
    for estimate in estimates:
        own = estimate.select(names)
        sigmas = np.abs(own.values / own.std_errors)
        held |= {names[k] for k in np.flatnonzero(sigmas > HELD_SIGMAS).tolist()}
    return frozenset(held)
