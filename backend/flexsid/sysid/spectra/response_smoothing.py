"""Smoothing of a measured frequency response whose harmonics have unequal power."""

from __future__ import annotations

import numpy as np
from jaxtyping import Complex, Float

LEAST_HARMONICS = 7
"""Harmonics below which a response remains as measured: too few determine its smoothness."""

_PENALTIES = 60  # values compared, evenly spaced in their logarithm
_EXTREME = 100.0  # the largest penalty leaves a straight line to 1 %, the smallest the data


def smooth_response(
    omega: Float[np.ndarray, " n_omega"],
    response: Complex[np.ndarray, "n_omega n_channels"],
    excitation: Float[np.ndarray, " n_omega"],
) -> Complex[np.ndarray, "n_omega n_channels"]:
    """Smooth responses over frequency, every harmonic weighted by the power that excites it.

    Parameters
    ----------
    omega
        In ascending order. [rad/s]
    response
        Output over excitation, measured at every harmonic.
    excitation
        Magnitude of the excitation; the noise of the response is inverse to it. All above zero.

    Notes
    -----
    H minimises sum |e (H - H_measured)|^2 + penalty sum |D H|^2 with D the second divided
    differences, for every channel with the penalty of least generalised cross-validation,
    n |r|^2 / (n - trace)^2. Sources: Whittaker 1923, doi:10.1017/S0013091500077853; Eilers 2003,
    Analytical Chemistry 75, doi:10.1021/ac034173t; Golub, Heath and Wahba 1979, Technometrics 21,
    doi:10.1080/00401706.1979.10489751.
    """
    n = omega.size
    if n < LEAST_HARMONICS:
        return response
    weight = excitation / np.sqrt(np.mean(excitation**2))
    roughness = _build_differences(omega) / weight
    _, size, axes = np.linalg.svd(roughness)  # the last two axes are straight lines
    power = np.concatenate([size**2, np.zeros(2)])
    white = axes @ (weight[:, None] * response)
    penalties = np.geomspace(
        1.0 / (_EXTREME * power[0]), _EXTREME / float(size[-1]) ** 2, _PENALTIES
    )
    passed = 1.0 / (1.0 + penalties[:, None] * power)
    removed = (1.0 - passed) ** 2 @ np.abs(white) ** 2
    score = removed / (np.sum(1.0 - passed, axis=1) ** 2)[:, None]
    best = np.argmin(score, axis=0)
    return (axes.T @ (passed[best].T * white)) / weight[:, None]


def _build_differences(omega: Float[np.ndarray, " n_omega"]) -> np.ndarray:
    """Second divided differences over the band, times the root of their spacing."""
    step = np.diff(omega) / (omega[-1] - omega[0])
    both = step[:-1] + step[1:]
    found = np.zeros((omega.size - 2, omega.size))
    row = np.arange(omega.size - 2)
    found[row, row] = 2.0 / (step[:-1] * both)
    found[row, row + 1] = -2.0 / (step[:-1] * step[1:])
    found[row, row + 2] = 2.0 / (step[1:] * both)
    return found * np.sqrt(0.5 * both)[:, None]
