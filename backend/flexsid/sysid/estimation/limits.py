"""Physical limits of the parameters of instruments and structure."""

from __future__ import annotations

import numpy as np
from jaxtyping import Bool, Float

from flexsid.sysid.estimation.parameters import Parameters

LONGEST_DELAY_S = 0.2  # no recorder delays a channel longer
_LIMITS = {
    "delay": (-LONGEST_DELAY_S, LONGEST_DELAY_S),
    "scale": (0.0, np.inf),  # a sensor of the wrong sign is corrected, not estimated
    "omega": (0.0, np.inf),
    "zeta": (0.0, np.inf),  # a structure in vacuo is damped
}


def find_parameters_at_limits(
    parameters: Parameters, theta: Float[np.ndarray, " n_theta"]
) -> Bool[np.ndarray, " n_theta"]:
    """Find the parameters at or beyond a limit; derivatives and shapes have none.

    Parameters
    ----------
    parameters, theta
        Free parameters and their estimated values.
    """
    found = np.zeros(theta.size, dtype=bool)
    for k, extra in enumerate(parameters.extras, start=parameters.rows.size):
        low, high = _LIMITS.get(extra.kind, (-np.inf, np.inf))
        found[k] = not low < theta[k] < high
    return found
