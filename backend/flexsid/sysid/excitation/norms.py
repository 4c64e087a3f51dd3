"""Minimise the L_p norms of many multisines at once, by Gauss-Newton in their phases.

A norm of growing even order leads smoothly to the largest magnitude. With w = u^(p-2)
every mean of w times two sines or cosines is a Fourier coefficient of w at the sum
or the difference of two harmonics: one transform gives gradient and Hessian.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int
from scipy import fft

# p = 4, 6, 10 ... 258; p - 2 doubles from one to the next, so that a power is one more squaring.
_SQUARINGS = (1, 2, 3, 4, 5, 6, 7, 8)

_POINTS = 8
"""Samples per shortest period; enough for powers up to 258, which weigh the top of a peak."""


Pairs = np.ndarray[tuple[int, int, int], np.dtype[np.complex128]]
"""One number per start and pair of tones."""


@dataclass(frozen=True, slots=True)
class HarmonicSpectrum:
    """Harmonics and amplitudes of one input."""

    harmonics: Int[np.ndarray, " n_tones"]
    amplitudes: Float[np.ndarray, " n_tones"]

    def on_grid(
        self, phases: Float[np.ndarray, "n_starts n_tones"], n_samples: int
    ) -> Float[np.ndarray, "n_starts n_samples"]:
        """Waveforms over one period."""
        spectrum = np.zeros((phases.shape[0], n_samples // 2 + 1), dtype=complex)
        spectrum[:, self.harmonics] = (
            -0.5j * n_samples * self.amplitudes * np.exp(1j * np.asarray(phases))
        )
        return fft.irfft(spectrum, n_samples, axis=1)

    def grid_size(self, points: int) -> int:
        """Samples per period with at least so many in the shortest period of a sine."""
        return int(fft.next_fast_len(max(64, points * int(self.harmonics.max())), real=True))


def lower_norms(
    spectrum: HarmonicSpectrum,
    phases: Float[np.ndarray, "n_starts n_tones"],
    iterations: int = 5,
    squarings: tuple[int, ...] = _SQUARINGS,
) -> Float[np.ndarray, "n_starts n_tones"]:
    """Lower the L_p norm of every start, p from low to high.

    One start per row [rad], ``iterations`` for each p = 2 + 2^squarings in turn. No phases are
    returned with a higher norm of the last order than where that order began; the scale of the
    amplitudes does not matter.

    Notes
    -----
    Source: Guillaume, Schoukens, Pintelon, Kollar, IEEE Trans. Instrum. Meas. 40 (1991),
    doi:10.1109/19.119778, for the sequence of norms; the Hessian from one transform is ours.
    """
    n_samples = spectrum.grid_size(_POINTS)
    phases = phases.copy()
    damping = np.full(phases.shape[0], 1e-3)
    waves = spectrum.on_grid(phases, n_samples)
    for squaring in squarings:
        p = 2 + 2**squaring
        level, weights = _norm(waves, squaring)
        for _ in range(iterations):
            gradient, hessian = _derivatives(spectrum, phases, weights, p)
            scale = np.trace(hessian, axis1=1, axis2=2) / phases.shape[1]
            regular = hessian + (damping * scale + 1e-12)[:, None, None] * np.eye(phases.shape[1])
            step = np.linalg.solve(regular, gradient[:, :, None])[:, :, 0]
            # A phase that turns by more than a radian has left its linearisation.
            step /= np.maximum(1.0, np.abs(step).max(axis=1))[:, None]
            tried = phases - step
            tried_waves = spectrum.on_grid(tried, n_samples)
            tried_level, tried_weights = _norm(tried_waves, squaring)
            better = tried_level < level
            damping = np.clip(np.where(better, damping * 0.3, damping * 6.0), 1e-6, 1e3)
            if not better.any():
                continue
            phases[better] = tried[better]
            waves[better] = tried_waves[better]
            level[better] = tried_level[better]
            weights[better] = tried_weights[better]
    return phases


def _norm(
    waves: Float[np.ndarray, "n_starts n_samples"], squaring: int
) -> tuple[Float[np.ndarray, " n_starts"], Float[np.ndarray, "n_starts n_samples"]]:
    """Logarithm of the L_p norm, and u^(p-2) over the mean of u^p; scaled against underflow."""
    squares = waves * waves
    top = squares.max(axis=1, keepdims=True)
    squares /= top
    weights = squares.copy()
    for _ in range(squaring - 1):
        weights *= weights
    mean = np.einsum("ij,ij->i", weights, squares) / waves.shape[1]
    p = 2 + 2**squaring
    level = 0.5 * np.log(top[:, 0]) + np.log(mean) / p
    weights /= mean[:, None] * top
    return level, weights


def _derivatives(
    spectrum: HarmonicSpectrum,
    phases: Float[np.ndarray, "n_starts n_tones"],
    weights: Float[np.ndarray, "n_starts n_samples"],
    p: int,
) -> tuple[
    Float[np.ndarray, "n_starts n_tones"],
    Float[np.ndarray, "n_starts n_tones n_tones"],
]:
    """Gradient and Gauss-Newton Hessian of the log of the L_p norm."""
    k, a = spectrum.harmonics, spectrum.amplitudes
    of_weights = np.asarray(fft.rfft(weights, axis=1), dtype=complex) / weights.shape[1]
    difference = k[:, None] - k
    turned = a * np.exp(1j * phases)
    # mean(w z_i z_j) and mean(w z_i conj z_j), with z_i = a_i exp(j (2 pi k_i t + phi_i)).
    apart: Pairs = of_weights[:, np.abs(difference)]
    np.conjugate(apart, out=apart, where=difference > 0)
    apart *= turned[:, :, None] * turned[:, None, :].conj()
    summed: Pairs = of_weights[:, k[:, None] + k].conj()
    summed *= turned[:, :, None] * turned[:, None, :]
    gradient = 0.5 * (summed.imag - apart.imag).sum(axis=2)
    hessian = 0.5 * (p - 1) * (summed.real + apart.real)
    return gradient, hessian
