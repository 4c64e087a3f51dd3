"""Stability of a selection: frequency of each term in bootstrap samples."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from jaxtyping import Float

from flexsid.sysid.structure_determination.evidence import Evidence
from flexsid.sysid.structure_determination.selection import Selection

Search = Callable[[Sequence[Evidence]], Selection]


def compute_selection_frequency(
    evidences: Sequence[Evidence], search: Search, n_draws: int = 50, seed: int = 0
) -> Float[np.ndarray, " p"]:
    """Compute the share of bootstrap samples in which every candidate is selected.

    Parameters
    ----------
    evidences
        Of the same candidates, one per maneuver.
    search
        The search to repeat.
    n_draws
        Number of bootstrap samples; NaN is returned for zero.
    seed
        Of the random numbers.

    Notes
    -----
    Combs of neighbouring frequencies are drawn with replacement (bootstrap), separately
    in every maneuver, which preserves the correlation between neighbours.
    """
    rng = np.random.default_rng(seed)
    sizes = [0 if one.parts is None else one.parts.total.size for one in evidences]
    hits = np.zeros(len(evidences[0].names))
    for _ in range(n_draws):
        drawn = []
        for one, n_parts in zip(evidences, sizes, strict=True):
            counts = np.bincount(rng.integers(n_parts, size=n_parts), minlength=n_parts)
            drawn.append(one.resample(counts.astype(float)))
        hits += [term.selected for term in search(drawn).terms]
    return hits / n_draws if n_draws else np.full(hits.size, np.nan)
