"""Stability margins of loops from their frequency responses."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Complex, Float, Inexact


@dataclass(frozen=True, slots=True)
class Margins:
    """Margins of one loop, broken at its surface while the others stay closed.

    ``gain`` is the factor nearest to one, above or below it, at which the loop becomes unstable,
    ``gain_up`` the least above one; ``phase`` is in rad; infinite where nothing is crossed.
    ``modulus`` is the least distance of the loop from -1. ``disk`` is the balanced disk margin:
    gain may change by (2 + disk)/(2 - disk) and phase by 2 atan(disk/2) at once.
    """

    gain: float
    gain_up: float
    phase: float
    modulus: float
    disk: float


def compute_broken_loops(
    L: Complex[np.ndarray, "n_omega n_driven n_driven"],
) -> Complex[np.ndarray, "n_omega n_driven"]:
    """Compute the loop gain at every surface, broken there, the others closed. [1]

    Notes
    -----
    With u = L u + d the loop broken at surface i, the others closed, is
    L_i = 1 / [(I - L)^-1]_ii - 1; it encircles -1 where the closed loop is unstable.
    """
    closed = np.linalg.inv(np.eye(L.shape[1]) - L)
    return 1.0 / np.einsum("kii->ki", closed) - 1.0


def compute_margins(
    omega: Float[np.ndarray, " n_omega"], L: Complex[np.ndarray, " n_omega"]
) -> Margins:
    """Compute the margins of a loop gain, which are interpolated between its frequencies.

    Parameters
    ----------
    omega
        Frequencies, rising. [rad/s]
    L
        Loop gain, closed with negative feedback. [1]

    Notes
    -----
    Crossings are those of cubic splines through the response, found by python-control. The disk
    margin is 2 / max |S - T| [1]_.

    References
    ----------
    .. [1] Seiler, P., Packard, A., and Gahinet, P., "An Introduction to Disk Margins," IEEE
       Control Systems Magazine, vol. 40, no. 5, 2020, pp. 78-95.
       https://doi.org/10.1109/MCS.2020.3005277
    """
    import control  # also imports matplotlib, which takes seconds

    response = control.FrequencyResponseData(L, omega, smooth=True)
    found: Any = control.stability_margins(response, returnall=True)  # the stubs know one of each
    gains, phases, moduli = found[:3]
    return Margins(
        gain=float(gains[np.abs(np.log(gains)).argmin()]) if gains.size else np.inf,
        gain_up=float(gains[gains > 1.0].min(initial=np.inf)),
        phase=float(np.abs(np.deg2rad(phases)).min(initial=np.inf)),
        modulus=float(moduli.min(initial=np.abs(1.0 + L).min())),
        disk=float(2.0 / _compute_imbalance(L).max()),
    )


def estimate_margin_errors(
    L: Complex[np.ndarray, "n_samples n_omega n_loops"],
) -> Float[np.ma.MaskedArray, "3 n_loops"]:
    """Standard deviations of margins from samples of the loop gains.

    Parameters
    ----------
    L
        Samples of the loop gains at closely spaced frequencies. [1]

    Returns
    -------
    :
        Of the logarithm of ``gain_up`` [1], of the phase margin [rad] and of the disk margin [1];
        masked where no sample has that margin.

    Notes
    -----
    Crossings are interpolated linearly: the error of that is common to the samples, and splines
    of hundreds of them would take a minute.
    """
    on_axis = _interpolate_at_zeros(np.imag(L), np.real(L))
    gain = np.where((on_axis < 0.0) & (on_axis > -1.0), -np.log(np.abs(on_axis)), np.inf)
    at_one = _interpolate_at_zeros(np.log(np.abs(L)), L)
    phase = np.where(np.isnan(at_one), np.inf, np.abs(np.angle(-at_one)))
    disk = 2.0 / _compute_imbalance(L)
    least = np.stack([one.min(axis=1) for one in (gain, phase, disk)])
    return np.ma.masked_invalid(least).std(axis=1)


def _compute_imbalance(L: Complex[np.ndarray, "*shape"]) -> Float[np.ndarray, "*shape"]:
    """Distance of sensitivity and complementary sensitivity, |S - T|. [1]"""
    return np.abs(2.0 / (1.0 + L) - 1.0)


def _interpolate_at_zeros(
    of: Float[np.ndarray, "n_samples n_omega n_loops"],
    values: Inexact[np.ndarray, "n_samples n_omega n_loops"],
) -> Inexact[np.ndarray, "n_samples n_intervals n_loops"]:
    """Interpolate values linearly where another quantity is zero; NaN in other intervals."""
    before, after = of[:, :-1], of[:, 1:]
    crossed = before * after < 0.0
    share = np.full(crossed.shape, np.nan)
    np.divide(before, before - after, out=share, where=crossed)
    return values[:, :-1] + share * (values[:, 1:] - values[:, :-1])
