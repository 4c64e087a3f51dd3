"""Who owns which harmonics: interleaved over a band, and refusals with the numbers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from jaxtyping import Int

from flexsid.errors import BadInput
from flexsid.sysid.excitation.multisine import allot_harmonics


def allot_band(
    order: Sequence[str], per_input: int, duration_s: float, band_hz: tuple[float, float]
) -> dict[str, Int[np.ndarray, " n_tones"]]:
    """Deal harmonics of 1/duration to the inputs in turn, evenly over a band.

    Parameters
    ----------
    order
        Inputs in the order in which they are served.
    per_input
        Harmonics for each input.
    duration_s
        Period. [s]
    band_hz
        Lowest and highest frequency. [Hz]

    Raises
    ------
    BadInput
        If the band holds fewer harmonics than asked for.
    """
    first = max(1, int(np.ceil(band_hz[0] * duration_s - 1e-9)))
    last = int(np.floor(band_hz[1] * duration_s + 1e-9))
    held, asked = max(0, last - first + 1), per_input * len(order)
    if asked > held:
        longer = asked / max(band_hz[1] - band_hz[0], 1e-9)
        raise BadInput(
            f"{len(order)} inputs with {per_input} harmonics each need {asked}; the band of"
            f" {band_hz[0]:g} to {band_hz[1]:g} Hz holds {held} harmonics of 1/{duration_s:g} s;"
            f" ask for fewer, widen the band, or fly {longer:.4g} s",
            code="too-many-harmonics",
        )
    # Whole spacing keeps every input's lines equally far apart, so none beats slowly.
    spacing = held // asked if asked else 1
    dealt = allot_harmonics(order, per_input, 0)
    return {name: first + spacing * own for name, own in dealt.items()}


def check_allotment(
    harmonics: Mapping[str, Sequence[int]], duration_s: float, rate_hz: float
) -> None:
    """Refuse what cannot be orthogonal at the real sample rate.

    Raises
    ------
    BadInput
        If an input has no harmonics, two share one, a line reaches the Nyquist
        frequency, or the period is no whole number of samples.
    """
    if not harmonics:
        raise BadInput("the design moves no input; name at least one", code="no-inputs")
    owner: dict[int, str] = {}
    for name, own in harmonics.items():
        if not own:
            raise BadInput(
                f"input {name} has no harmonics; give it at least one or leave it out",
                code="input-without-harmonics",
            )
        for harmonic in own:
            if harmonic < 1:
                raise BadInput(
                    f"harmonic {harmonic} of {name} is no oscillation; the lowest is 1",
                    code="bad-harmonic",
                )
            if harmonic in owner:
                raise BadInput(
                    f"harmonic {harmonic} belongs to {owner[harmonic]} and {name}; the two would"
                    " not be orthogonal; give it to one",
                    code="shared-harmonic",
                )
            owner[harmonic] = name
    n_samples = duration_s * rate_hz
    if abs(n_samples - round(n_samples)) > 1e-6:
        raise BadInput(
            f"{duration_s:g} s at {rate_hz:g} Hz are {n_samples:.3f} samples; take"
            f" {round(n_samples) / rate_hz:.9g} s so that the period is whole",
            code="period-not-whole",
        )
    highest = max(owner)
    if 2 * highest >= round(n_samples):
        raise BadInput(
            f"harmonic {highest} is {highest / duration_s:.4g} Hz, not below the Nyquist"
            f" frequency {rate_hz / 2:g} Hz; sample faster or end the band lower",
            code="above-nyquist",
        )
