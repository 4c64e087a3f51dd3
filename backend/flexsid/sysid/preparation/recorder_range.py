"""Range and resolution of a recorder: samples that are clipped, or rounded to coarse steps."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

_COARSE = 0.02  # of the range of a channel: a step of its numbers that matters
_MOST_LEVELS = 0.125  # of the samples: more different values are no steps
_EQUAL_STEPS = 1e-3  # of a step
_ABRUPT = 0.04  # of the range of a channel: its step to a limit; of an actuator it is smaller
_SHORTEST_LIMIT = 3  # samples
_SMOOTHINGS = 100  # of a rounded channel: over the about ten samples between its steps


def compute_clipped_share(samples: Float[np.ndarray, " n"]) -> float:
    """Compute the share of samples at a limit that the channel reaches abruptly. [1]

    Notes
    -----
    A limit is the largest or the smallest value; the steps to it and from it exceed 4 % of the
    range, and it lasts for three samples or more. A surface slows down before its own limit.
    """
    span = float(np.ptp(samples))
    at_limit = np.zeros(samples.size, dtype=bool)
    for limit in (samples.min(), samples.max()):
        edges = np.flatnonzero(np.diff(np.r_[False, samples == limit, False]))
        for first, stop in edges.reshape(-1, 2):
            is_inside = first > 0 and stop < samples.size and stop - first >= _SHORTEST_LIMIT
            if is_inside:
                steps = np.abs(samples[[first - 1, stop]] - limit)
                at_limit[first:stop] |= steps.min() > _ABRUPT * span
    return float(at_limit.mean())


def find_rounding_step(samples: Float[np.ndarray, " n"]) -> float | None:
    """Find the step to which samples are rounded; None where it is fine or there is none.

    Notes
    -----
    All values are multiples of the least difference of two of them, within 0.1 % of it, and it is
    2 % of their range or more.
    """
    levels = np.unique(samples)
    if not 2 < levels.size < _MOST_LEVELS * samples.size:
        return None
    step = float(np.diff(levels).min())
    away = levels / step - np.rint(levels / step)
    if step < _COARSE * np.ptp(levels) or np.ptp(away) > _EQUAL_STEPS:
        return None
    return step


def smooth_rounded(samples: Float[np.ndarray, " n"], step: float) -> Float[np.ndarray, " n"]:
    """Return the smoothest signal within half a step of rounded samples, in their unit.

    Notes
    -----
    Binomial means of three samples, and clipping to half a step about the samples, alternate.
    """
    found = samples
    for _ in range(_SMOOTHINGS):
        padded = np.pad(found, 1, mode="edge")
        mean = 0.25 * padded[:-2] + 0.5 * found + 0.25 * padded[2:]
        found = np.clip(mean, samples - 0.5 * step, samples + 0.5 * step)
    return found
