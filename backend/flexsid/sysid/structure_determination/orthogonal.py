"""Multivariate orthogonal functions: candidates made orthogonal, ordered, and cut by PSE."""

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


def select_by_orthogonal_functions(
    evidences: Sequence[Evidence], thresholds: Thresholds = DEFAULT_THRESHOLDS
) -> Selection:
    """Select the terms of one coefficient over one maneuver or many by orthogonal functions.

    Parameters
    ----------
    evidences
        Of the same candidates, one per maneuver.
    thresholds
        Penalty of a term, and the partial F below which one is dropped at the end.

    Notes
    -----
    Source: Morelli. The next function is the candidate that, made orthogonal to those
    before it, reduces the residuals most; their number has the least predicted
    squared error. In the plain terms that they are mapped back to, those
    whose partial F is below ``f_out`` are dropped.
    """
    names = evidences[0].names
    selected = np.zeros(len(names), dtype=bool)
    now = pool_evidence(evidences, selected)
    best, least = selected.copy(), compute_criteria(evidences, selected, now.rest, thresholds).pse
    path: list[SelectionStep] = []
    n_best = 0
    while not selected.all():
        gain = np.where(selected, -1.0, now.gain)
        entering = int(np.argmax(gain))
        if gain[entering] <= 0.0:
            break
        f = float(now.f[entering])
        selected[entering] = True
        now = pool_evidence(evidences, selected)
        criteria = compute_criteria(evidences, selected, now.rest, thresholds)
        path.append(SelectionStep("enter", names[entering], f, criteria))
        if criteria.pse < least:
            best, least, n_best = selected.copy(), criteria.pse, len(path)
    end = select_terms(
        evidences, SelectionState(best, tuple(path[:n_best])), thresholds, enter=False
    )
    return summarise_selection("orthogonal functions", evidences, end, thresholds)
