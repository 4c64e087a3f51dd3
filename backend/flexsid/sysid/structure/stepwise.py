"""Stepwise regression: the strongest term enters, weak ones leave."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flexsid.sysid.structure.evidence import Evidence, support
from flexsid.sysid.structure.selection import (
    USUAL,
    Selection,
    Step,
    Thresholds,
    criteria_of,
    finish,
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
    Source: Klein and Morelli, stepwise regression with partial F. Departure: the scatter
    of a term is that of the residuals as they are, coloured or not, with all candidates.
    A term that had to leave does not come back, so that the search ends.
    """
    names = evidences[0].names
    chosen = np.zeros(len(names), dtype=bool)
    barred = np.zeros(len(names), dtype=bool)
    path: list[Step] = []
    while True:
        now = support(evidences, chosen)
        ready = ~chosen & ~barred & now.held_by(thresholds.f_in)
        if not ready.any():
            break
        entering = int(np.argmax(np.where(ready, now.gain, -1.0)))
        chosen[entering] = True
        path.append(_step("enter", evidences, chosen, entering, now.f[entering], thresholds))
        while True:
            now = support(evidences, chosen)
            loose = chosen & ~now.held_by(thresholds.f_out)
            loose[entering] = False
            if not loose.any():
                break
            leaving = int(np.argmin(np.where(loose, now.f, np.inf)))
            chosen[leaving], barred[leaving] = False, True
            path.append(_step("drop", evidences, chosen, leaving, now.f[leaving], thresholds))
    forward = finish("stepwise", evidences, chosen, path, thresholds)
    backward = _backward(evidences, forward, thresholds)
    return min((forward, backward), key=lambda end: end.criteria.pse)


def _backward(
    evidences: Sequence[Evidence], forward: Selection, thresholds: Thresholds
) -> Selection:
    """Go on with all candidates back in, and drop the weak ones one by one."""
    chosen = np.array([term.chosen for term in forward.terms])
    path = list(forward.path)
    while not chosen.all():
        now = support(evidences, chosen)
        entering = int(np.argmax(np.where(chosen, -1.0, now.gain)))
        if now.gain[entering] <= 0.0:
            break
        chosen[entering] = True
        path.append(_step("enter", evidences, chosen, entering, now.f[entering], thresholds))
    return finish("stepwise", evidences, chosen, path, thresholds)


def _step(
    action: str,
    evidences: Sequence[Evidence],
    chosen: np.ndarray,
    term: int,
    f: float,
    thresholds: Thresholds,
) -> Step:
    rest = support(evidences, chosen).rest
    criteria = criteria_of(evidences, chosen, rest, thresholds)
    return Step(action, evidences[0].names[term], float(f), criteria)
