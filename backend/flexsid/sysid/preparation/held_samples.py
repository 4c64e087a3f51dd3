"""Channels that repeat each sample until the next one of a slower clock."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float, Int

_LEAST_CHANGES = 12  # fewer new samples may be those of a signal that rests
_LEAST_REPEATED = 1.5  # samples between new ones
_LARGEST_SPREAD = 0.6  # samples: two clocks without a common divisor alternate by one
_REGULAR = 0.9  # of the intervals


def find_new_samples(samples: Float[np.ndarray, " n"]) -> Int[np.ndarray, " n_new"] | None:
    """Find the samples with a new value in a held channel; None if it is not held.

    Notes
    -----
    New values at equal intervals of two or more samples are those of a slower clock. A signal that
    rests or is rounded repeats values at irregular intervals; intervals that are multiples of the
    usual one are of a signal that rests for a few of the slower samples.
    """
    x = np.asarray(samples, dtype=float)
    changes = np.flatnonzero(np.diff(x)) + 1
    if changes.size < _LEAST_CHANGES:
        return None
    gaps = np.diff(changes)
    usual = float(np.median(gaps))
    near = gaps[np.abs(gaps - usual) <= 1.0]
    step = float(near.mean())
    if step < _LEAST_REPEATED or near.std() > _LARGEST_SPREAD or gaps.min() < usual - 1.0:
        return None
    whole = np.maximum(np.rint(gaps / step), 1.0)
    if np.mean(np.abs(gaps / whole - step) < 0.5) < _REGULAR:
        return None
    # Where the signal rests, new samples repeat the last value.
    between = [
        int(first) + np.rint(step * np.arange(int(count))).astype(int)
        for first, count in zip(changes[:-1], whole, strict=True)
    ]
    before = changes[0] - np.rint(step * np.arange(int(changes[0] // step), 0, -1)).astype(int)
    after = np.arange(changes[-1], x.size, step).astype(int)
    return np.unique(np.concatenate([before, *between, after]))
