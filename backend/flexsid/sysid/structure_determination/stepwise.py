"""Stepwise regression: the strongest term enters, weak ones are dropped."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

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


def select_stepwise(
    evidences: Sequence[Evidence], thresholds: Thresholds = DEFAULT_THRESHOLDS
) -> Selection:
    """Select the terms of one coefficient over one maneuver or many by stepwise regression.

    Parameters
    ----------
    evidences
        Of the same candidates, one per maneuver.
    thresholds
        Partial F to enter and to stay.

    Notes
    -----
    Source: Klein and Morelli, stepwise regression with partial F. Departures: the scatter
    of a term is that of the residuals as they are, coloured or not, with all candidates;
    and when no further term enters, all candidates enter and the weak ones are dropped
    again. The result with the lower predicted squared error is taken: a term that replaces
    another one early can exclude it permanently.
    """
    nothing = SelectionState(np.zeros(len(evidences[0].names), dtype=bool))
    forward = select_terms(evidences, nothing, thresholds)
    backward = select_terms(evidences, _enter_all(evidences, forward, thresholds), thresholds)
    ends = [
        summarise_selection("stepwise", evidences, end, thresholds) for end in (forward, backward)
    ]
    return min(ends, key=lambda end: end.criteria.pse)


def _enter_all(
    evidences: Sequence[Evidence], at: SelectionState, thresholds: Thresholds
) -> SelectionState:
    """Enter every candidate that the data resolve."""
    selected, path = at.selected.copy(), list(at.path)
    now = pool_evidence(evidences, selected)
    while not selected.all():
        gain = np.where(selected, -1.0, now.gain)
        entering = int(np.argmax(gain))
        if gain[entering] <= 0.0:
            break
        f = float(now.f[entering])
        selected[entering] = True
        now = pool_evidence(evidences, selected)
        criteria = compute_criteria(evidences, selected, now.rest, thresholds)
        path.append(SelectionStep("enter", evidences[0].names[entering], f, criteria))
    return SelectionState(selected, tuple(path))
