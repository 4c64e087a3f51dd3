"""Probabilities of several tests together."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np


def adjust_by_holm(p: Sequence[float], counts: Sequence[float] | None = None) -> list[float]:
    """Adjust p-values of several tests, so that one below 5 % is as improbable as of one test.

    Parameters
    ----------
    p
        Probability of each test.
    counts
        Number of independent tests that each counts as, for tests that depend on each other; one
        by default.

    Notes
    -----
    The p-values in ascending order are multiplied by the number of tests not yet rejected, at
    least by one.
    Source: Holm (1979), A simple sequentially rejective multiple test procedure, Scandinavian
    Journal of Statistics 6, 65-70, https://www.jstor.org/stable/4615733.
    """
    order = np.argsort(p, kind="stable")
    each = np.ones(order.size) if counts is None else np.asarray(counts)[order]
    left = np.maximum(np.cumsum(each[::-1])[::-1], 1.0)
    adjusted = np.empty(order.size)
    adjusted[order] = np.minimum(np.maximum.accumulate(np.asarray(p)[order] * left), 1.0)
    return adjusted.tolist()
