"""Stability: how often a search would choose a term if other lines had been flown."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from jaxtyping import Float

from flexsid.sysid.structure_determination.evidence import Evidence
from flexsid.sysid.structure_determination.selection import Selection

Search = Callable[[Sequence[Evidence]], Selection]


def selection_frequency(
    evidences: Sequence[Evidence], search: Search, n_draws: int = 50, seed: int = 0
) -> Float[np.ndarray, " p"]:
    """Share of draws in which every candidate is chosen.

    Parameters
    ----------
    evidences
        Of the same candidates, one per maneuver.
    search
        The search that chose.
    n_draws
        How often to search again; without any, nothing is known (NaN).
    seed
        Decides the draws.

    Notes
    -----
    Combs of neighbouring lines are drawn with replacement (bootstrap), in every
    maneuver for itself, so that correlation between neighbours stays as it is.
    """
    rng = np.random.default_rng(seed)
    sizes = [0 if one.parts is None else one.parts.total.size for one in evidences]
    hits = np.zeros(len(evidences[0].names))
    for _ in range(n_draws):
        drawn = []
        for one, n_parts in zip(evidences, sizes, strict=True):
            counts = np.bincount(rng.integers(n_parts, size=n_parts), minlength=n_parts)
            drawn.append(one.drawn(counts.astype(float)))
        hits += [term.chosen for term in search(drawn).terms]
    return hits / n_draws if n_draws else np.full(hits.size, np.nan)
