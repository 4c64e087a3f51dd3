"""Target modes of a design: the band about each of them that its harmonics have to resolve."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Int

HARMONICS_PER_SURFACE = 3
"""Harmonics of every surface about a target: amplitude and phase of its response on both sides of
the peak and at it."""

PHUGOID = "PH"
"""Group of the phugoid in Table 1."""

_PHUGOID_AMPLITUDE = 0.1  # of its harmonics, relative to that of others: see weight_harmonics
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


def interleave_harmonics(
    n_surfaces: int,
    count: int,
    first: int,
    last: int | None = None,
    width: float = np.inf,
) -> list[Int[np.ndarray, " n_tones"]]:
    """Interleave harmonics of equal spacing, one set per surface.

    Parameters
    ----------
    n_surfaces, count
        Number of sets and of harmonics in each; more where ``width`` requires it.
    first, last
        Lowest harmonic, and that which every set has to reach; by default sets are as dense as
        possible.
    width
        Number of harmonics in the narrowest target band, in which every set has
        ``HARMONICS_PER_SURFACE``. A band too narrow for the sets is disregarded.

    Notes
    -----
    Multisines of a low peak factor have a constant envelope, for which the products of any two
    harmonics of equal difference cancel: that requires equal spacing. With spacings that differ by
    one harmonic the relative peak factor is 1.2 to 1.3 instead of 1.03 to 1.1. Multiples of a
    common base, which are harmonics of remainder zero or half of the spacing, have about 1.0: with
    an even spacing two sets are such.
    """
    spacing = n_surfaces
    if last is not None:
        largest = int(width // HARMONICS_PER_SURFACE) if np.isfinite(width) else last
        spacing = max(n_surfaces, -(-(last - first + 1) // count))
        if largest >= n_surfaces:
            spacing = min(spacing, largest)
        if spacing % 2 and (spacing < largest or spacing > n_surfaces):
            spacing += 1 if spacing < largest else -1
        count = max(count, -(-(last - first + 1) // spacing))
    slots = n_surfaces + n_surfaces % 2
    remainders = np.arange(n_surfaces) * spacing // (slots if spacing >= slots else n_surfaces)
    starts = np.sort(first + (remainders - first) % spacing)
    return [start + spacing * np.arange(count) for start in starts]


def interleave_target_harmonics(
    n_surfaces: int,
    count: int,
    first: int,
    targets: Sequence[Target],
    duration_s: float,
    free: int = 1,
) -> list[Int[np.ndarray, " n_tones"]]:
    """Interleave harmonics over the bands of targets, one set per surface.

    Parameters
    ----------
    n_surfaces, count
        Number of sets and of harmonics in each, at least.
    first
        Lowest harmonic; lower where a target requires it.
    targets, duration_s
        At least one target, and the period. [s]
    free
        Lowest harmonic that no other input has.

    Notes
    -----
    Equal spacing from a phugoid to a structural mode needs a thousand harmonics. A phugoid below
    all other targets has ``HARMONICS_PER_SURFACE`` of its own instead, in addition to ``count``.
    """
    phugoid = find_separate_phugoid(targets)
    low: list[Int[np.ndarray, " n_tones"]] = [np.zeros(0, dtype=int)] * n_surfaces
    others = [one for one in targets if one is not phugoid]
    least = int(np.floor(min(one.low_hz for one in others) * duration_s))
    begin = max(free, min(first, least))
    if phugoid is not None:
        lowest = max(int(np.ceil(phugoid.low_hz * duration_s)), free)
        width = phugoid.high_hz * duration_s - lowest + 1.0
        spacing = max(n_surfaces, int(width // HARMONICS_PER_SURFACE))
        places = lowest + np.arange(n_surfaces) * (spacing // n_surfaces)
        low = [place + spacing * np.arange(HARMONICS_PER_SURFACE) for place in places]
        begin = int(low[-1][-1]) + 1
    last = int(np.ceil(max(one.high_hz for one in others) * duration_s))
    width = min(one.high_hz - one.low_hz for one in others) * duration_s
    high = interleave_harmonics(n_surfaces, count, begin, last, width)
    return [np.concatenate(pair) for pair in zip(low, high, strict=True)]


def find_separate_phugoid(targets: Sequence[Target]) -> Target | None:
    """Find the phugoid among targets, where its band lies below those of all others."""
    others = [one.low_hz for one in targets if one.group != PHUGOID]
    return next(
        (one for one in targets if one.group == PHUGOID and others and one.high_hz < min(others)),
        None,
    )


def weight_harmonics(
    harmonics: Sequence[int], targets: Sequence[Target], duration_s: float
) -> tuple[float, ...] | None:
    """Return the relative power of the harmonics of a surface; None for a flat spectrum.

    Notes
    -----
    A phugoid with the damping ratio of Lanchester, 1 / (sqrt(2) L/D) = 0.05 of L/D = 14, responds
    with 1 / (2 zeta) = 10 times its static response: its harmonics have a tenth of the amplitude
    of the others. With the same amplitude they would raise the relative peak factor by 0.2.
    """
    phugoid = find_separate_phugoid(targets)
    if phugoid is None:
        return None
    highest = phugoid.high_hz * duration_s
    return tuple(_PHUGOID_AMPLITUDE**2 if one <= highest else 1.0 for one in harmonics)


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
