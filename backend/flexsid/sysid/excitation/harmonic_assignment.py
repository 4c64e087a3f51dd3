"""Harmonic assignment: harmonics of each input, interleaved over a band, and their checks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from flexsid.errors import BadInput

_GRID = 2001  # frequencies over which the density of harmonics is evaluated
_NEAR = 0.05  # standard deviation of the harmonics about a target, of its frequency


@dataclass(frozen=True, slots=True, kw_only=True)
class Band:
    """Band of one input: ``count`` harmonics from ``low_hz`` to ``high_hz``.

    With ``targets_hz``, half of the harmonics lie about them, within a tenth of each
    frequency.
    """

    low_hz: float
    high_hz: float
    count: int
    targets_hz: tuple[float, ...] = ()


def assign_harmonics_to_bands(
    bands: Mapping[str, Band], duration_s: float
) -> dict[str, Int[np.ndarray, " n_tones"]]:
    """Assign harmonics to every input in a band of its own, none of them shared.

    Bands may overlap; the duration is the period. [s]

    Raises
    ------
    BadInput
        If a band ends before it begins, or holds too few harmonics that are free.

    Notes
    -----
    Each input requests frequencies evenly over its band, or denser about its targets.
    From the lowest up, each requested frequency gets the nearest free harmonic, so that
    inputs with the same band interleave.
    """
    places = sorted(
        (place, index, name)
        for index, (name, band) in enumerate(bands.items())
        for place in (_places(name, band) * duration_s).tolist()
    )
    highest = max((band.high_hz for band in bands.values()), default=0.0)
    free = np.ones(int(np.floor(highest * duration_s + 1e-9)) + 1, dtype=bool)
    dealt: dict[str, list[int]] = {name: [] for name in bands}
    for place, _, name in places:
        band = bands[name]
        first = max(1, int(np.ceil(band.low_hz * duration_s - 1e-9)))
        last = int(np.floor(band.high_hz * duration_s + 1e-9))
        left = first + np.flatnonzero(free[first : last + 1])
        if not left.size:
            raise BadInput(
                f"{name} asks for {band.count} harmonics from {band.low_hz:g} to"
                f" {band.high_hz:g} Hz; the band holds {max(0, last - first + 1)} of"
                f" 1/{duration_s:g} s and the inputs together need more; ask for fewer, widen the"
                " band, or fly longer",
                code="too-many-harmonics",
            )
        nearest = int(left[np.argmin(np.abs(left - place))])
        free[nearest] = False
        dealt[name].append(nearest)
    return {name: np.sort(np.array(own, dtype=int)) for name, own in dealt.items()}


def _places(name: str, band: Band) -> Float[np.ndarray, " count"]:
    """Frequencies at equal shares of the requested density of harmonics. [Hz]"""
    if not (0.0 < band.low_hz <= band.high_hz and band.count >= 1):
        raise BadInput(
            f"{name} cannot have {band.count} harmonics from {band.low_hz:g} to"
            f" {band.high_hz:g} Hz; give at least one, from a positive frequency up",
            code="bad-band",
        )
    for target in band.targets_hz:
        if not band.low_hz <= target <= band.high_hz:
            raise BadInput(
                f"the target of {name} at {target:g} Hz lies outside its band of"
                f" {band.low_hz:g} to {band.high_hz:g} Hz",
                code="target-outside-band",
            )
    hz = np.linspace(band.low_hz, band.high_hz, _GRID)
    density = np.ones(_GRID)
    for target in band.targets_hz:
        width = _NEAR * target
        bump = np.exp(-0.5 * ((hz - target) / width) ** 2)
        density += bump / max(float(bump.mean()), 1e-12) / len(band.targets_hz)
    share = np.concatenate([[0.0], np.cumsum(0.5 * (density[1:] + density[:-1]))])
    return np.interp((np.arange(band.count) + 0.5) / band.count, share / share[-1], hz)


def check_harmonics(
    harmonics: Mapping[str, Sequence[int]], duration_s: float, rate_hz: float
) -> None:
    """Raise BadInput for harmonics that are not orthogonal at the sample rate.

    Raises
    ------
    BadInput
        If an input has no harmonics, two share one, a harmonic reaches the Nyquist
        frequency, or the period is no whole number of samples.
    """
    if not harmonics:
        raise BadInput("the design has no input; give at least one", code="no-inputs")
    assigned: dict[int, str] = {}
    for name, own in harmonics.items():
        if not own:
            raise BadInput(
                f"input {name} has no harmonics; give it at least one or remove the input",
                code="input-without-harmonics",
            )
        for harmonic in own:
            if harmonic < 1:
                raise BadInput(
                    f"harmonic {harmonic} of {name} is not an oscillation; the lowest is 1",
                    code="bad-harmonic",
                )
            if harmonic in assigned:
                raise BadInput(
                    f"harmonic {harmonic} belongs to {assigned[harmonic]} and {name}; the two would"
                    " not be orthogonal; give it to one",
                    code="shared-harmonic",
                )
            assigned[harmonic] = name
    n_samples = duration_s * rate_hz
    if abs(n_samples - round(n_samples)) > 1e-6:
        raise BadInput(
            f"{duration_s:g} s at {rate_hz:g} Hz are {n_samples:.3f} samples; take"
            f" {round(n_samples) / rate_hz:.9g} s so that the period is whole",
            code="period-not-whole",
        )
    highest = max(assigned)
    if 2 * highest >= round(n_samples):
        raise BadInput(
            f"harmonic {highest} is {highest / duration_s:.4g} Hz, not below the Nyquist"
            f" frequency {rate_hz / 2:g} Hz; sample faster or end the band lower",
            code="above-nyquist",
        )
