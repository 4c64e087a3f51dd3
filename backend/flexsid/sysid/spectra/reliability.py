"""Reliability of the points of a frequency response."""

from __future__ import annotations

import numpy as np
from jaxtyping import Bool, Float

from flexsid.sysid.signals import FrequencyResponse

WORST_RELATIVE_STD = 0.3  # of the magnitude: a larger standard error hides the response
WORST_CONDITION = 1e3  # of the surfaces' responses to the commands: nearly dependent above

UNCERTAIN = f"standard error above {WORST_RELATIVE_STD:.0%} of the magnitude"
ILL_CONDITIONED = "the surfaces' responses to the commands are nearly alike"


def relative_std(response: FrequencyResponse) -> Float[np.ndarray, "n_omega n_y n_u"] | None:
    """Standard deviation of the complex error over the magnitude, infinite at zero. [1]"""
    if response.std is None:
        return None
    size = np.abs(response.values)
    return np.divide(response.std, size, out=np.full(size.shape, np.inf), where=size > 0)


def find_unreliable_points(
    response: FrequencyResponse,
) -> dict[str, Bool[np.ndarray, "n_omega n_y n_u"]]:
    """Find points to be blanked, by the reason; every reason is a key."""
    relative = relative_std(response)
    nowhere = np.zeros(response.values.shape, dtype=bool)
    uncertain = nowhere if relative is None else ~(relative <= WORST_RELATIVE_STD)
    poor = nowhere
    if response.condition is not None:
        worse = response.condition > WORST_CONDITION
        poor = np.broadcast_to(worse[:, None, None], nowhere.shape)
    return {UNCERTAIN: uncertain, ILL_CONDITIONED: poor}
