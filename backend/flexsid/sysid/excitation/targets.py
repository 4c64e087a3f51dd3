"""Target modes of a design: the band about each of them that its harmonics have to resolve."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Int

HARMONICS_PER_SURFACE = 3
"""Harmonics of every surface about a target: amplitude and phase of its response on both sides of
the peak and at it."""

_OCTAVE = 2.0  # of rigid-body modes: well damped, with a response that varies over an octave
_HALF_WIDTHS = 5.0  # half-power half-widths: further away a mode responds with a fifth of its peak
_LEAST_WIDTH = 0.1  # of the frequency: error of a predicted frequency


@dataclass(frozen=True, slots=True, kw_only=True)
class Target:
    """A mode that a design excites, and the band about it. [Hz]

    ``number`` is that of the modal table, None for a rigid-body mode; ``group`` is that of Table 1;
    ``damping`` is the damping ratio, None where it is not predicted. [1]
    """

    name: str
    group: str
    number: int | None
    frequency_hz: float
    damping: float | None
    low_hz: float
    high_hz: float


def build_rigid_target(name: str, frequency_hz: float, damping: float | None) -> Target:
    """Build a rigid-body target: an octave to both sides of its frequency."""
    return Target(
        name=name,
        group=name,
        number=None,
        frequency_hz=frequency_hz,
        damping=damping,
        low_hz=frequency_hz / _OCTAVE,
        high_hz=frequency_hz * _OCTAVE,
    )


def build_structural_target(
    name: str, group: str, number: int, range_hz: tuple[float, float], damping: float
) -> Target:
    """Build a structural target from its range of frequencies. [Hz]

    Notes
    -----
    The band is wider than the half-power band by ``_HALF_WIDTHS``, with at least ``_LEAST_WIDTH``
    and at most an octave to both sides.
    """
    width = 1.0 + float(np.clip(_HALF_WIDTHS * damping, _LEAST_WIDTH, _OCTAVE - 1.0))
    low, high = range_hz
    return Target(
        name=name,
        group=group,
        number=number,
        frequency_hz=0.5 * (low + high),
        damping=damping,
        low_hz=low / width,
        high_hz=high * width,
    )


def spread_harmonics(
    count: int,
    first: int,
    last: int,
    bands: Sequence[tuple[float, float]] = (),
    least: int = 0,
) -> Int[np.ndarray, " count"]:
    """Spread harmonics over a band, denser within some parts of it.

    Parameters
    ----------
    count
        Number of harmonics.
    first, last
        Lowest and highest harmonic; consecutive ones end higher where they do not fit.
    bands
        Lowest and highest harmonic of each part, not necessarily whole.
    least
        Harmonics within each part, as far as it has so many.

    Notes
    -----
    The density of harmonics is the larger of that which a part requires and of a common level
    that uses up the count; the harmonic is taken where the cumulative density passes a whole
    number. Where the parts together require more than the count, all are reduced alike.
    """
    slots = np.arange(first, max(last, first + count - 1) + 1)
    density = np.zeros(slots.size)
    for low, high in bands:
        inside = (slots >= low) & (slots <= high)
        if inside.any():
            density[inside] = np.maximum(density[inside], min(1.0, (least + 1) / inside.sum()))
    # The ends are harmonics of the design, so that it spans the whole band.
    density[0] = density[-1] = 1.0
    between = slice(1, -1)
    required, left = density[between], count - 2.0
    if required.sum() >= left:
        density[between] = required * (max(left, 0.0) / max(required.sum(), 1e-300))
    else:
        density[between] = np.maximum(required, _find_level(required, left))
    total = np.round(np.cumsum(density), 9)
    taken = np.diff(np.floor(np.concatenate([[0.0], total]))) > 0.0
    return slots[taken][:count]


def _find_level(required: np.ndarray, total: float) -> float:
    """Find the level with sum(max(level, required)) = total."""
    ordered = np.sort(required)
    above = np.concatenate([np.cumsum(ordered[::-1])[::-1], [0.0]])
    for below in range(1, ordered.size + 1):
        level = (total - above[below]) / below
        if below == ordered.size or level <= ordered[below]:
            return float(level)
    return 0.0


def count_harmonics(
    harmonics: Mapping[str, Sequence[int]], duration_s: float, target: Target
) -> int:
    """Return the least number of harmonics of an input within the band of a target."""
    low, high = target.low_hz * duration_s, target.high_hz * duration_s
    return min(len([one for one in own if low <= one <= high]) for own in harmonics.values())


def find_least_duration(targets: Sequence[Target], n_surfaces: int) -> float:
    """Find the shortest period with three harmonics of every surface about each target. [s]"""
    slots = HARMONICS_PER_SURFACE * n_surfaces + 1
    return max((slots / (one.high_hz - one.low_hz) for one in targets), default=0.0)
