"""Correlation of the noise of neighbouring frequencies of one record."""

from __future__ import annotations

import numpy as np
from jaxtyping import Complex, Float


def compute_noise_correlation(
    omega: Float[np.ndarray, " n_omega"], start_s: float, end_s: float
) -> Complex[np.ndarray, "n_omega n_omega"]:
    """Correlation of the finite Fourier transforms of white noise at some frequencies.

    Parameters
    ----------
    omega
        Frequencies, of any spacing. [rad/s]
    start_s, end_s
        Of the record that is transformed. [s]

    Notes
    -----
    For X(w) = integral of x exp(-j w t) over T = t1 - t0 and white x,
    E[X(w) X(v)*] = integral of exp(-j (w - v) t), which over T is
    sinc((w - v) T / 2 pi) exp(-j (w - v) (t0 + t1) / 2). Multiples of 1/T are
    independent; where the record is longer than the period of the excitation, neighbours
    are not: a record 1.2 periods long gives 0.16.
    Source: Brillinger, Time Series (1981), section 4.3.
    """
    apart = omega[:, None] - omega
    middle = 0.5 * (start_s + end_s)
    return np.sinc(apart * (end_s - start_s) / (2.0 * np.pi)) * np.exp(-1j * apart * middle)
