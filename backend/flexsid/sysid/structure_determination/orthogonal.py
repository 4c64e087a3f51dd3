"""Multivariate orthogonal functions: candidates made orthogonal, ordered, and cut by PSE."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flexsid.sysid.structure_determination.evidence import Evidence, support
from flexsid.sysid.structure_determination.selection import (
    USUAL,
    Selection,
    SelectionStep,
    Thresholds,
    Walk,
    criteria_of,
    selection_at,
    walk,
)


def orthogonal_functions(
    evidences: Sequence[Evidence], thresholds: Thresholds = USUAL
) -> Selection:
    """Choose the terms of one coefficient over one maneuver or many.

    Parameters
    ----------
    evidences
        Of the same candidates, one per maneuver.
    thresholds
        How much a term costs, and the partial F below which one is left out at the end.

    Notes
    -----
    Source: Morelli. The next function is the candidate that, made orthogonal to those
    before it, takes most off the residuals; as many are kept as give the least
    predicted squared error. In the plain terms that they are mapped back to, those
    whose partial F is below ``f_out`` are dropped.
    """
    names = evidences[0].names
    chosen = np.zeros(len(names), dtype=bool)
    now = support(evidences, chosen)
    best, least = chosen.copy(), criteria_of(evidences, chosen, now.rest, thresholds).pse
    path: list[SelectionStep] = []
    kept = 0
    while not chosen.all():
        gain = np.where(chosen, -1.0, now.gain)
        entering = int(np.argmax(gain))
        if gain[entering] <= 0.0:
            break
        f = float(now.f[entering])
        chosen[entering] = True
        now = support(evidences, chosen)
        criteria = criteria_of(evidences, chosen, now.rest, thresholds)
        path.append(SelectionStep("enter", names[entering], f, criteria))
        if criteria.pse < least:
            best, least, kept = chosen.copy(), criteria.pse, len(path)
    end = walk(evidences, Walk(best, tuple(path[:kept])), thresholds, enter=False)
    return selection_at("orthogonal functions", evidences, end, thresholds)
