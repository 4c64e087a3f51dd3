"""End correction: from a sum of samples to the integral of the cubic through them."""

from __future__ import annotations

import numpy as np
from jaxtyping import Complex, Float
from numpy.polynomial import polynomial

_SERIES_BELOW = 0.2  # rad per sample; the closed form loses digits as theta^-4

# Powers of theta^2: attenuation W, then real and imaginary / theta parts of alpha_0..3.
_W = (1.0, 0.0, -11 / 720, 23 / 15120)
_REAL = (
    (-2 / 3, 1 / 45, 103 / 15120, -169 / 226800),
    (7 / 24, -7 / 180, 5 / 3456, -7 / 259200),
    (-1 / 6, 1 / 45, -5 / 6048, 1 / 64800),
    (1 / 24, -1 / 180, 5 / 24192, -1 / 259200),
)
_IMAGINARY = (
    (2 / 45, 2 / 105, -8 / 2835, 86 / 467775),
    (7 / 72, -1 / 168, 11 / 72576, -13 / 5987520),
    (-7 / 90, 1 / 210, -11 / 90720, 13 / 7484400),
    (7 / 360, -1 / 840, 11 / 362880, -13 / 29937600),
)


def correct_ends(
    transform: Complex[np.ndarray, "n_omega n_channels"],
    samples: Float[np.ndarray, "n_samples n_channels"],
    rate_hz: float,
    omega: Float[np.ndarray, " n_omega"],
) -> Complex[np.ndarray, "n_omega n_channels"]:
    """Turn the plain sum over samples into the finite Fourier integral.

    Parameters
    ----------
    transform
        Sum of x exp(-j omega t) / rate, time counted from the first sample.
    samples
        What was summed; at least eight samples.
    rate_hz
        Samples per second. [Hz]
    omega
        Frequencies of the transform. [rad/s]

    Raises
    ------
    ValueError
        If there are fewer than eight samples.

    Notes
    -----
    Source: cubic-order endpoint corrections, Press et al., Numerical Recipes,
    Sec. 13.9. The integral runs from the first sample to the last.
    """
    if samples.shape[0] < 8:
        raise ValueError(f"end correction needs at least 8 samples, got {samples.shape[0]}")
    attenuation, alpha = _weights(omega / rate_hz)
    ends = alpha.conj() @ samples[:4]
    turn = np.exp(-1j * omega * (samples.shape[0] - 1) / rate_hz)
    ends += turn[:, None] * (alpha @ samples[-1:-5:-1])
    return attenuation[:, None] * transform + ends / rate_hz


def _weights(
    theta: Float[np.ndarray, " n_omega"],
) -> tuple[Float[np.ndarray, " n_omega"], Complex[np.ndarray, "n_omega 4"]]:
    """Attenuation W and the weights alpha_0..3 of the first samples, for exp(+j omega t)."""
    square = theta**2
    low = np.abs(theta) < _SERIES_BELOW
    near = np.stack(
        [
            polynomial.polyval(square, re) + 1j * theta * polynomial.polyval(square, im)
            for re, im in zip(_REAL, _IMAGINARY, strict=True)
        ],
        axis=1,
    )
    t = np.where(low, 1.0, theta)
    six, t4 = 6.0 + t**2, 6.0 * t**4
    cos, sin, cos2, sin2 = np.cos(t), np.sin(t), np.cos(2 * t), np.sin(2 * t)
    real = (
        -42 + 5 * t**2 + six * (8 * cos - cos2),
        14 * (3 - t**2) - 7 * six * cos,
        -8 * (3 - t**2) + 4 * six * cos,
        2 * (3 - t**2) - six * cos,
    )
    imaginary = (
        -12 * t + 6 * t**3 + six * sin2,
        30 * t - 5 * six * sin,
        -24 * t + 4 * six * sin,
        6 * t - six * sin,
    )
    far = (np.stack(real, axis=1) + 1j * np.stack(imaginary, axis=1)) / t4[:, None]
    attenuation = np.where(
        low, polynomial.polyval(square, _W), six / (0.5 * t4) * (3 - 4 * cos + cos2)
    )
    return attenuation, np.where(low[:, None], near, far)
