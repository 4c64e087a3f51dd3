"""Linear interpolation of the rows of a table, over fuel, airspeed or frequency."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float, Inexact


def interpolate(
    places: Float[np.ndarray, " n"],
    values: Inexact[np.ndarray, "n *shape"],
    at: float | Float[np.ndarray, " n_at"],
) -> np.ndarray:
    """Interpolate the rows of a table at a place or several; the end rows hold beyond the ends."""
    at = np.asarray(at, dtype=float)
    if places.size == 1:
        return values[np.zeros(at.shape, dtype=int)]
    upper = np.clip(np.searchsorted(places, at), 1, places.size - 1)
    low, high = places[upper - 1], places[upper]
    share = np.clip((at - low) / (high - low), 0.0, 1.0)
    share = share.reshape(*at.shape, *(1,) * (values.ndim - 1))
    return (1.0 - share) * values[upper - 1] + share * values[upper]
