"""Peaks of response spectra, fitted by one resonance, with standard errors."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float
from scipy.optimize import least_squares

_PEAK_RATIO = 3.0  # least power of a peak over the median of the band
_HALF_WIDTH = 0.2  # of the frequency, fitted on either side of a peak


@dataclass(frozen=True, slots=True)
class Peak:
    """One resonance seen by all channels together.

    ``amplitude`` is the largest response on the fitted curve, root mean square over
    channels and inputs, each in units of its own mean size.
    """

    frequency_hz: float
    frequency_std_hz: float
    damping: float
    damping_std: float
    amplitude: float
    amplitude_std: float


@dataclass(frozen=True, slots=True)
class InputRatios:
    """Ratios of outputs to the assigned excitation at its harmonics."""

    omega: Float[np.ndarray, " n_omega"]
    values: Complex[np.ndarray, "n_omega n_y"]


def smooth_power(ratios: Sequence[InputRatios]) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies [Hz] and mean power of all channels over their means, in order.

    Smoothed over as many neighbours as include every input.
    """
    omega = np.concatenate([r.omega for r in ratios])
    powers = [np.abs(r.values) ** 2 for r in ratios]
    power = np.concatenate([np.mean(one / np.mean(one, axis=0), axis=1) for one in powers])
    order = np.argsort(omega)
    frequency, power = omega[order] / (2.0 * np.pi), power[order]
    window = 2 * len(ratios) + 1
    if power.size < 2 * window:
        return frequency, power
    padded = np.pad(power, window // 2, mode="edge")
    return frequency, np.convolve(padded, np.ones(window) / window, "valid")


def find_peaks(ratios: Sequence[InputRatios]) -> list[float]:
    """Frequencies at which the power stands out, highest peak first. [Hz]"""
    frequency, smooth = smooth_power(ratios)
    inner = np.arange(1, smooth.size - 1)
    top = inner[(smooth[inner] >= smooth[inner - 1]) & (smooth[inner] > smooth[inner + 1])]
    tall = top[smooth[top] > _PEAK_RATIO * np.median(smooth)]
    return [float(frequency[i]) for i in sorted(tall, key=lambda i: -smooth[i])]


def fit_peak(ratios: Sequence[InputRatios], near_hz: float, sizes: np.ndarray) -> Peak:
    """Fit one resonance to all channels and inputs around a peak.

    ``near_hz`` is where the peak was found, ``sizes`` the unit of the amplitudes of each channel.

    Notes
    -----
    Frequency and damping are common; every channel has its own residue and a background
    that is quadratic in frequency for each input, which follow linearly (variable
    projection). Standard errors are those of the residuals' scatter.
    """
    near = [
        InputRatios(r.omega[inside], r.values[inside])
        for r in ratios
        if (inside := np.abs(r.omega / (2.0 * np.pi) - near_hz) < _HALF_WIDTH * near_hz).sum() >= 4
    ]
    omega = np.concatenate([one.omega for one in near])
    values = np.concatenate([one.values for one in near]) / sizes
    own = np.repeat(np.eye(len(near)), [one.omega.size for one in near], axis=0)

    def residual(x: np.ndarray) -> np.ndarray:
        basis = np.linalg.qr(_build_basis(omega, own, x))[0]
        found = (values - basis @ (basis.conj().T @ values)).ravel()
        return np.concatenate([np.real(found), np.imag(found)])

    start = np.array([2.0 * np.pi * near_hz, 0.02])
    fit = least_squares(residual, start, x_scale=[0.01 * start[0], 0.005], method="lm")
    n_linear = 2 * 2 * len(near) * values.shape[1]
    freedom = max(1, fit.fun.size - n_linear - 2)
    variance = float(fit.fun @ fit.fun) / freedom
    slope = np.asarray(fit.jac)
    root = np.linalg.inv(np.linalg.qr(slope)[1])
    covariance = variance * (root @ root.T)
    std = np.sqrt(np.diag(covariance))
    # The residues precede the backgrounds.
    linear = np.linalg.lstsq(_build_basis(omega, own, fit.x), values, rcond=None)[0]
    residues = linear[: len(near)]
    amplitude = float(np.sqrt(np.mean(np.abs(residues) ** 2)) / (2.0 * abs(fit.x[1])))
    damping = abs(float(fit.x[1]))
    return Peak(
        frequency_hz=float(fit.x[0]) / (2.0 * np.pi),
        frequency_std_hz=float(std[0]) / (2.0 * np.pi),
        damping=damping,
        damping_std=float(std[1]),
        amplitude=amplitude,
        # the height of a resonance is as uncertain as its width
        amplitude_std=amplitude * float(std[1]) / damping,
    )


def compute_channel_rms(ratios: Sequence[InputRatios]) -> Float[np.ndarray, " n_y"]:
    """Compute the root mean square of every channel over all inputs' harmonics."""
    every = np.concatenate([r.values for r in ratios])
    return np.sqrt(np.mean(np.abs(every) ** 2, axis=0))


def _build_basis(omega: np.ndarray, own: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Resonance, then background, of each input at frequency and damping x, (N, 2 n_inputs)."""
    s = 1j * omega
    resonance = s**2 / (s**2 + 2.0 * x[1] * x[0] * s + x[0] ** 2)
    background = (omega / x[0]) ** 2 + 0j
    return np.concatenate([own * resonance[:, None], own * background[:, None]], axis=1)
