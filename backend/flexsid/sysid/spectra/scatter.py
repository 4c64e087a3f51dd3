"""Scatter of a smooth response about itself: the noise that neighbouring lines betray."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex

_WINDOW = 7  # lines in a local fit
_DEGREE = 5
_NEIGHBOURS = 24  # residuals on either side that share one noise level


@dataclass(frozen=True, slots=True)
class Scatter:
    """Residuals of local fits at ``lines``, scaled to the variance of one line."""

    lines: np.ndarray
    values: Complex[np.ndarray, "n_lines n_channels"]


def local_scatter(values: Complex[np.ndarray, "n_own n_channels"]) -> Scatter | None:
    """What each line departs from a quintic through its neighbours; None with too few lines.

    Notes
    -----
    A quintic over seven equally spaced lines leaves the middle one with a residual of
    variance 1 - h times that of the noise, h being its own weight in the fit.
    """
    n = values.shape[0]
    if n < _WINDOW:
        return None
    half = _WINDOW // 2
    x = np.arange(-half, half + 1, dtype=float)
    basis = np.vander(x, _DEGREE + 1)
    hat = basis @ np.linalg.solve(basis.T @ basis, basis.T)
    weights = -hat[half]
    weights[half] += 1.0
    windows = np.stack([values[k : n - _WINDOW + 1 + k] for k in range(_WINDOW)], axis=0)
    residual = np.tensordot(weights, windows, axes=(0, 0)) / np.sqrt(1.0 - hat[half, half])
    return Scatter(np.arange(half, n - half), residual)


def line_noise(
    places: list[np.ndarray], powers: list[np.ndarray], wanted: list[np.ndarray]
) -> list[np.ndarray]:
    """Noise level around each wanted line.

    Parameters
    ----------
    places, powers
        Frequencies (n_lines,) and squared residuals (n_lines, n_y) of each set of lines.
    wanted
        Frequencies (n_wanted,) of each set of lines where the level is asked for.

    Returns
    -------
    list
        Of (n_wanted, n_y).

    Notes
    -----
    The level is the median of the neighbours' powers, so that the few lines on a sharp
    resonance, where a quintic is too stiff, do not pass for noise. The median of an
    exponential variable is ln 2 times its mean.
    """
    omega = np.concatenate(places)
    order = np.argsort(omega)
    omega, power = omega[order], np.concatenate(powers)[order]
    result = []
    for at in wanted:
        center = np.searchsorted(omega, at)
        low = np.clip(center - _NEIGHBOURS, 0, max(0, omega.size - 2 * _NEIGHBOURS))
        levels = [
            np.median(power[first : first + 2 * _NEIGHBOURS], axis=0) / np.log(2.0) for first in low
        ]
        result.append(np.array(levels).reshape(at.size, -1))
    return result
