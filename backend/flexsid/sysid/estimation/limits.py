"""Limits of what an instrument or a structure can be: a fit that ends beyond them is none."""

from __future__ import annotations

import numpy as np
from jaxtyping import Bool, Float

from flexsid.sysid.estimation.parameters import Parameters

LONGEST_DELAY_S = 0.2  # no recorder delays a channel longer, nor does a reference lag more
_LIMITS = {
    "delay": (-LONGEST_DELAY_S, LONGEST_DELAY_S),
    "scale": (0.0, np.inf),  # a sensor of the wrong sign is corrected, not estimated
    "omega": (0.0, np.inf),
    "zeta": (0.0, np.inf),  # a structure without air does not feed itself
}


def at_limits(
    parameters: Parameters, theta: Float[np.ndarray, " n_theta"]
) -> Bool[np.ndarray, " n_theta"]:
    """Which parameters are at a limit or beyond it; derivatives and shapes have none.

    Parameters
    ----------
    parameters, theta
        What was free, and the values found.
    """
    found = np.zeros(theta.size, dtype=bool)
    for place, extra in enumerate(parameters.extras, start=parameters.rows.size):
        low, high = _LIMITS.get(extra.kind, (-np.inf, np.inf))
        found[place] = not low < theta[place] < high
    return found
