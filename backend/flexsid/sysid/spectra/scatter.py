"""Scatter of a smooth response about itself: the noise that neighbouring lines betray."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float

_WINDOW = 7  # lines in a local fit
_DEGREE = 5
_NEIGHBOURS = 24  # residuals on either side that share one noise level
_STRIDE = 4  # lines from one level to the next


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
    count = min(2 * _NEIGHBOURS, omega.size)
    last = omega.size - count
    starts = np.append(np.arange(0, last, _STRIDE), last)
    windows = np.lib.stride_tricks.sliding_window_view(power, count, axis=0)[starts]
    levels = np.median(windows, axis=2) / np.log(2.0)
    result = []
    for at in wanted:
        first = np.clip(np.searchsorted(omega, at) - count // 2, 0, last)
        result.append(levels[np.minimum((first + _STRIDE // 2) // _STRIDE, starts.size - 1)])
    return result


def noise_about_responses(
    omega: Float[np.ndarray, " n_omega"],
    owner: np.ndarray,
    values: Complex[np.ndarray, "n_omega n_channels"],
    command: Complex[np.ndarray, " n_omega"],
) -> Float[np.ndarray, "n_omega n_channels"] | None:
    """Noise level of spectra at every line; None where no input owns enough lines.

    Parameters
    ----------
    omega
        Lines. [rad/s]
    owner
        Index of the input that owns each line.
    values
        Spectra; NaN where a channel has no number.
    command
        Excitation of each line's owner.
    """
    places, powers = [], []
    for index in np.unique(owner):
        own = np.flatnonzero(owner == index)
        scatter = local_scatter(values[own] / command[own][:, None])
        if scatter is not None:
            residual = scatter.values * command[own][scatter.lines][:, None]
            places.append(omega[own][scatter.lines])
            powers.append(np.abs(residual) ** 2)
    if not places:
        return None
    return np.sqrt(line_noise(places, powers, [omega])[0])
