"""Noise spectrum of a record: its spectral matrix at every frequency, from the residuals.

Turbulence, noise on the measured inputs and model error reach all outputs through a few
directions that vary with frequency; sensor noise is independent between outputs. The spectral
matrix is therefore that of independent noise plus the few directions that stand out of it
(a factor model), which a short window of frequencies determines for any number of outputs.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from jaxtyping import Complex, Float

from flexsid.sysid.estimation.noise import SEGMENT, SpectralMatrix

_NEIGHBOURS = 3  # segments on either side, by default
_PER_OUTPUT = 3  # frequencies per output in a band of independent noise; fewer: no estimate
_WIDEST = 100  # frequencies in a band of independent noise, where there are as many
_SMALLEST = 1e-140  # whose square is a number
_REGULAR = 1e-10  # of the diagonal: noise-free residuals have an independent part


@dataclass(frozen=True, slots=True)
class NoiseSpectrum:
    """Spectral matrix of the noise by segment of neighbouring frequencies.

    ``n_frequencies`` is the number of complex data points in each local estimate, its degrees
    of freedom; ``n_directions`` the mean number of directions of common noise.
    """

    density: SpectralMatrix
    n_frequencies: int
    n_directions: float


def estimate_noise_spectrum(
    residuals: Complex[np.ndarray, "n_omega n_y"], neighbours: int = _NEIGHBOURS
) -> NoiseSpectrum | None:
    """Estimate the spectral matrix of residuals in order of frequency; None with too few.

    Parameters
    ----------
    residuals
        By frequency, of independent noise.
    neighbours
        Segments on either side of the one whose noise is estimated.

    Notes
    -----
    1. Independent noise: the variance of an output given all others, 1/(C^-1)_ii, from the
       covariance C of a wide band of ``_PER_OUTPUT`` frequencies per output or more.
    2. In these units the covariance of a window of L frequencies has eigenvalues of noise up
       to (1 + sqrt(g))^2, g = n_y/L (Marchenko and Pastur); larger ones are directions v of
       common noise. Their variance is l of lambda = l (1 + g/(l - 1)) (Baik and Silverstein).
    3. What is left of each output in the window is its local independent noise d.

    S = diag d + sum (l - 1) v v^H in these units. The frequencies of a segment are not in its
    own window: weights that depend on the noise that they multiply make standard errors too
    small, by a third where there are as many outputs as frequencies.
    Source: spiked covariance model, Donoho, Gavish and Johnstone, Ann. Statist. 46 (2018).
    """
    n, n_y = residuals.shape
    width = 2 * neighbours + 1
    if n < max(_PER_OUTPUT * n_y, width * SEGMENT):
        return None
    scale = np.sqrt(_estimate_independent_noise(residuals))
    x = residuals / scale
    segment = np.arange(n) // SEGMENT
    sizes = np.bincount(segment)
    n_segments = sizes.size
    at = np.arange(n_segments)
    first = np.clip(at - neighbours, 0, n_segments - width)[:, None]
    near = (at >= first) & (at < first + width) & (at != at[:, None])
    counts = near @ sizes
    parts = np.zeros((n_segments * SEGMENT, n_y), dtype=complex)
    parts[:n] = x
    parts = parts.reshape(n_segments, SEGMENT, n_y)
    sums = (parts.transpose(0, 2, 1) @ parts.conj()).reshape(n_segments, -1)
    windows = (near.astype(float) @ sums.view(float)).view(complex).reshape(-1, n_y, n_y)
    values, vectors = np.linalg.eigh(windows / counts[:, None, None])
    g = (n_y / counts)[:, None]
    common = values > (1.0 + np.sqrt(g)) ** 2
    half = 0.5 * (values + 1.0 - g)
    variance = half + np.sqrt(np.maximum(half**2 - values, 0.0))
    power = np.abs(vectors) ** 2
    left = np.sum(power * np.where(common, 0.0, values)[:, None], axis=2)
    share = np.maximum(1.0 - np.sum(power * common[:, None], axis=2), g / (1.0 + g))
    excess = np.where(common, variance - 1.0, 0.0)[:, None]
    blocks = (vectors * excess) @ vectors.conj().transpose(0, 2, 1)
    blocks[:, np.arange(n_y), np.arange(n_y)] += np.maximum(left / share, _REGULAR)
    size = scale[::SEGMENT]
    blocks *= size[:, :, None] * size[:, None, :]
    return NoiseSpectrum(
        SpectralMatrix(blocks, segment), (width - 1) * SEGMENT, float(common.sum() / n_segments)
    )


def _estimate_independent_noise(
    residuals: Complex[np.ndarray, "n_omega n_y"],
) -> Float[np.ndarray, "n_omega n_y"]:
    """Estimate the variance of each output given all others, by band."""
    n, n_y = residuals.shape
    n_bands = max(1, n // max(_PER_OUTPUT * n_y, _WIDEST))
    result = np.empty((n, n_y))
    edges = SEGMENT * np.round(np.linspace(0.0, n / SEGMENT, n_bands + 1)).astype(int)
    edges[-1] = n
    for first, last in pairwise(edges.tolist()):
        band = residuals[first:last]
        size = np.sqrt(np.mean(np.abs(band) ** 2, axis=0))
        size = np.maximum(size, _SMALLEST)
        unit = band / size
        C = unit.T @ unit.conj() / len(band) + _REGULAR * np.eye(n_y)
        given = 1.0 / np.real(np.diag(np.linalg.inv(C)))
        result[first:last] = size**2 * given * len(band) / (len(band) - n_y + 1)
    return result
