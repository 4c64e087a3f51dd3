"""Models with some of the candidate terms."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from jaxtyping import Bool, Float

from flexsid.sysid.estimation.parameters import Parameters


def select_candidates(
    candidates: Parameters,
    selected: Bool[np.ndarray, " n_theta"],
    theta: Float[np.ndarray, " n_theta"],
) -> Parameters:
    """Select the parameters of a model with some of the candidates, started at theta."""
    n = candidates.rows.size
    table = candidates.table(np.where(selected, theta, 0.0))
    inside = np.flatnonzero(selected)
    return replace(
        candidates,
        names=tuple(candidates.names[i] for i in inside),
        start=theta[inside],
        base=table,
        rows=candidates.rows[selected[:n]],
        columns=candidates.columns[selected[:n]],
        extras=tuple(e for e, k in zip(candidates.extras, selected[n:], strict=True) if k),
    )


def expand_values(
    candidates: Parameters, values: Mapping[str, float]
) -> Float[np.ndarray, " n_theta"]:
    """Return the values of all candidates, zero for those that are not in a model."""
    return np.array([values.get(name, 0.0) for name in candidates.names])
