"""Recognise a multisine in recorded samples: harmonics, amplitudes, phases."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

from flexsid.errors import BadInput
from flexsid.sysid.excitation.multisine import Tones

_FAINTEST = 0.05  # of the largest harmonic: rounding of a text file is far below it
_EXPLAINED = 0.9999  # of the power, least share of the recognised harmonics


def recognise_multisine(samples: Float[np.ndarray, " n_samples"]) -> tuple[Tones, int]:
    """Find the sines of one period, and the period in samples.

    Parameters
    ----------
    samples
        One period of one input, with or without its first sample repeated at the end,
        as flight computers that play back a table often have it. [unit]

    Raises
    ------
    BadInput
        If few harmonics do not explain the samples: not one period, or not a multisine.
    """
    n = samples.size
    if n < 8 or not np.all(np.isfinite(samples)):
        raise BadInput(
            f"{n} samples, {int(np.sum(~np.isfinite(samples)))} of them no numbers, are not"
            " a multisine; give one whole period",
            code="no-multisine",
        )
    candidates = [(*_identify_tones(samples[:period]), period) for period in (n, n - 1)]
    share, tones, period = max(candidates, key=lambda found: found[0])
    if share < _EXPLAINED or tones.harmonics.size > n // 4:
        raise BadInput(
            f"{tones.harmonics.size} harmonics have {100 * share:.2f} % of the power of {n}"
            f" samples; a multisine of whole period has {100 * _EXPLAINED:g} % in at most {n // 4};"
            " is it exactly one period?",
            code="no-multisine",
        )
    return tones, period


def _identify_tones(samples: Float[np.ndarray, " n_samples"]) -> tuple[float, Tones]:
    spectrum = np.fft.rfft(samples) * 2.0 / samples.size
    size = np.abs(spectrum)
    size[0] = 0.0
    if size.max() == 0.0:
        nothing = np.empty(0)
        return 0.0, Tones(nothing.astype(int), nothing, nothing)
    harmonics = np.flatnonzero(size > _FAINTEST * size.max())
    phases = np.mod(np.angle(spectrum[harmonics]) + 1.5 * np.pi, 2.0 * np.pi) - np.pi
    share = float(np.sum(size[harmonics] ** 2) / np.sum(size**2))
    return share, Tones(harmonics, size[harmonics], phases)
