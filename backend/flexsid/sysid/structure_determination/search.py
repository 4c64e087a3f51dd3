"""Search of the terms of every coefficient, over one maneuver or a campaign."""

from __future__ import annotations

from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import Bool

from flexsid.errors import BadInput
from flexsid.sysid.structure_determination.evidence import Evidence, pool_evidence
from flexsid.sysid.structure_determination.selection import (
    DEFAULT_THRESHOLDS,
    Selection,
    SelectionState,
    SelectionStep,
    Thresholds,
    compute_criteria,
    select_terms,
    summarise_selection,
)

SearchMethod = Literal["stepwise", "orthogonal functions"]


@dataclass(frozen=True, slots=True)
class StructureSelection:
    """The selection of every coefficient, in the order of the candidates."""

    coefficients: dict[str, Selection]

    @property
    def selected(self) -> tuple[str, ...]:
        """Names of all selected derivatives."""
        return tuple(name for one in self.coefficients.values() for name in one.selected)


def search_equations(
    maneuvers: Sequence[Mapping[str, Evidence]],
    method: SearchMethod = "stepwise",
    thresholds: Thresholds = DEFAULT_THRESHOLDS,
    forced: Container[str] = (),
) -> StructureSelection:
    """Select the terms of every coefficient by equation error.

    ``maneuvers`` is the evidence of each by coefficient, ``forced`` are terms that stay.

    Raises
    ------
    BadInput
        If there is no maneuver, or they have different candidates.
    """
    if not maneuvers:
        raise BadInput("a search needs at least one maneuver", code="no-maneuver")
    first = maneuvers[0]
    for other in maneuvers[1:]:
        if {k: e.names for k, e in other.items()} != {k: e.names for k, e in first.items()}:
            raise BadInput(
                "the maneuvers have different candidates; search over maneuvers with the same "
                "inputs and modes",
                code="other-candidates",
            )
    select = select_stepwise if method == "stepwise" else select_by_orthogonal_functions
    return StructureSelection(
        {name: select([one[name] for one in maneuvers], thresholds, forced) for name in first}
    )


def select_stepwise(
    evidences: Sequence[Evidence],
    thresholds: Thresholds = DEFAULT_THRESHOLDS,
    forced: Container[str] = (),
) -> Selection:
    """Select the terms of one coefficient over one maneuver or many by stepwise regression.

    Notes
    -----
    Source: Klein and Morelli, stepwise regression with partial F. Departures: the scatter
    of a term is that of the residuals as they are, coloured or not, with all candidates;
    and when no further term enters, all candidates enter and the weak ones are dropped
    again. The result with the lower predicted squared error is taken: a term that replaces
    another one early can exclude it permanently.
    """
    stays = np.array([name in forced for name in evidences[0].names])
    forward = select_terms(evidences, SelectionState(np.zeros_like(stays)), thresholds)
    forward = _enter_terms(evidences, forward, thresholds, stays)
    forward = select_terms(evidences, forward, thresholds, forced=stays)
    backward = _enter_terms(evidences, forward, thresholds)
    backward = select_terms(evidences, backward, thresholds, forced=stays)
    ends = [summarise_selection(evidences, end, thresholds) for end in (forward, backward)]
    return min(ends, key=lambda end: end.criteria.pse)


def select_by_orthogonal_functions(
    evidences: Sequence[Evidence],
    thresholds: Thresholds = DEFAULT_THRESHOLDS,
    forced: Container[str] = (),
) -> Selection:
    """Select the terms of one coefficient over one maneuver or many by orthogonal functions.

    Notes
    -----
    Source: Morelli, multivariate orthogonal functions, J. Aircraft 32 (1995), doi:10.2514/3.46712.
    The next function is the candidate that, made orthogonal to those before it, reduces the
    residuals most; their number has the least predicted squared error. In the plain terms that they
    are mapped back to, those whose partial F is below ``f_out`` are dropped.
    """
    names = evidences[0].names
    stays = np.array([name in forced for name in names])
    nothing = np.zeros(len(names), dtype=bool)
    rest = pool_evidence(evidences, nothing).rest
    path = _enter_terms(evidences, SelectionState(nothing), thresholds).path
    criteria = [compute_criteria(evidences, nothing, rest, thresholds)]
    criteria += [step.criteria for step in path]
    path = path[: int(np.argmin([one.pse for one in criteria]))]
    entered = {step.term for step in path}
    best = SelectionState(np.array([name in entered for name in names]), path)
    best = _enter_terms(evidences, best, thresholds, stays)
    end = select_terms(evidences, best, thresholds, forced=stays, enter=False)
    return summarise_selection(evidences, end, thresholds)


def _enter_terms(
    evidences: Sequence[Evidence],
    at: SelectionState,
    thresholds: Thresholds,
    which: Bool[np.ndarray, " p"] | None = None,
) -> SelectionState:
    """Enter terms, by default all that the data resolve, the one of the largest gain first."""
    selected, path = at.selected.copy(), list(at.path)
    now = pool_evidence(evidences, selected)
    while True:
        missing = ~selected if which is None else which & ~selected
        gain = np.where(missing, now.gain, -1.0)
        entering = int(np.argmax(gain))
        if gain[entering] <= 0.0:
            return SelectionState(selected, tuple(path))
        f = float(now.f[entering])
        selected[entering] = True
        now = pool_evidence(evidences, selected)
        criteria = compute_criteria(evidences, selected, now.rest, thresholds)
        path.append(SelectionStep("enter", evidences[0].names[entering], f, criteria))
