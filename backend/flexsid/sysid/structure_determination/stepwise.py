"""Stepwise regression: the strongest term enters, weak ones leave."""

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


def stepwise_regression(evidences: Sequence[Evidence], thresholds: Thresholds = USUAL) -> Selection:
    """Choose the terms of one coefficient over one maneuver or many.

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
    and when nothing more enters, all candidates come back in and the weak ones leave
    again. The end with the lower predicted squared error is taken: a term that stands in
    for another one early on can keep it out for good.
    """
    nothing = Walk(np.zeros(len(evidences[0].names), dtype=bool))
    forward = walk(evidences, nothing, thresholds)
    backward = walk(evidences, _with_all(evidences, forward, thresholds), thresholds)
    ends = [selection_at("stepwise", evidences, end, thresholds) for end in (forward, backward)]
    return min(ends, key=lambda end: end.criteria.pse)


def _with_all(evidences: Sequence[Evidence], at: Walk, thresholds: Thresholds) -> Walk:
    """Go on with every candidate that the data tell apart."""
    chosen, path = at.chosen.copy(), list(at.path)
    now = support(evidences, chosen)
    while not chosen.all():
        gain = np.where(chosen, -1.0, now.gain)
        entering = int(np.argmax(gain))
        if gain[entering] <= 0.0:
            break
        f = float(now.f[entering])
        chosen[entering] = True
        now = support(evidences, chosen)
        criteria = criteria_of(evidences, chosen, now.rest, thresholds)
        path.append(SelectionStep("enter", evidences[0].names[entering], f, criteria))
    return Walk(chosen, tuple(path))
