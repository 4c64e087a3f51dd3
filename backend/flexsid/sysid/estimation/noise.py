"""Noise of residuals: covariance, spectrum, power, and the weights of the likelihood (Eq. 19).

S is the covariance of the residual of one data point, (1/M) sum nu nu^H at its maximum of
likelihood: the cost sum nu^H S^-1 nu + M ln |S| is Eq. 19 with M S for its S, constants dropped.

Turbulence, noise on the measured inputs and model error reach all outputs through a few
directions that vary with frequency; sensor noise is independent between outputs. The spectral
matrix is therefore that of independent noise plus the few directions that stand out of it
(a factor model), which a short window of frequencies determines for any number of outputs.

The noise is the scatter of the residuals about a smooth response to the input that excites each
frequency, whatever the model: a correct model leaves residuals of this power, another one more.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import scipy
from jaxtyping import Complex, Float

from flexsid.sysid.spectra.residual_spectrum import build_local_fits

# --- Covariance of the residuals at one frequency and the weights of the likelihood (Eq. 19) ------

SEGMENT = 5  # data points
_NEIGHBOURS = 2  # segments on either side
SMOOTHED_FREQUENCIES = SEGMENT * (2 * _NEIGHBOURS + 1)
"""Frequencies from which ``smooth_density`` estimates the density of one frequency."""

_LEAST_SHRINKAGE = 1e-6  # the density of noise-free data stays regular
_ENOUGH_PER_OUTPUT = 10  # frequencies per output for a full matrix without shrinkage
_LARGEST_SHRINKAGE = 0.9  # share of the off-diagonal terms
_RELATIVE_FLOOR = 1e-20  # of the measured power: weights of noise-free data stay finite


@dataclass(frozen=True, slots=True)
class SpectralMatrix:
    """Hermitian matrix over the outputs at every frequency, shared within a block.

    ``blocks`` is (n_blocks, n_y) real where the matrix is diagonal, else
    (n_blocks, n_y, n_y); ``block`` is the number of the block of every frequency, in order.
    """

    blocks: np.ndarray
    block: np.ndarray

    @property
    def is_diagonal(self) -> bool:
        """Whether the outputs are uncorrelated."""
        return self.blocks.ndim == 2

    def inverse(self) -> SpectralMatrix:
        """Invert the matrix of every block: weights from a density."""
        if self.is_diagonal:
            return SpectralMatrix(1.0 / self.blocks, self.block)
        size = np.sqrt(np.real(np.einsum("bii->bi", self.blocks)))
        outer = size[:, :, None] * size[:, None, :]
        identity = np.broadcast_to(np.eye(size.shape[1]), outer.shape)
        inverse = np.linalg.solve(self.blocks / outer, identity) / outer
        return SpectralMatrix(0.5 * (inverse + inverse.conj().transpose(0, 2, 1)), self.block)

    def factor(self) -> SpectralMatrix:
        """Return R with S = R^H R, also of a singular S."""
        if self.is_diagonal:
            return SpectralMatrix(np.sqrt(self.blocks), self.block)
        values, vectors = np.linalg.eigh(self.blocks)
        roots = np.sqrt(np.maximum(values, 0.0))
        return SpectralMatrix(roots[:, :, None] * vectors.conj().transpose(0, 2, 1), self.block)

    def scaled(self, factor: float) -> SpectralMatrix:
        """Return every matrix times a factor."""
        return SpectralMatrix(factor * self.blocks, self.block)

    def expand_blocks(self) -> np.ndarray:
        """Return the matrix, or its diagonal, of every frequency; one where all share it."""
        return self.blocks if self.blocks.shape[0] == 1 else self.blocks[self.block]

    def between(self, weights: SpectralMatrix) -> SpectralMatrix:
        """Compute W S W, for blocks of the weights that are unions or parts of those of S."""
        if weights.blocks.shape[0] > self.blocks.shape[0]:
            each = np.arange(self.block.size)
            return SpectralMatrix(self.blocks[self.block], each).between(weights)
        first = np.searchsorted(self.block, np.arange(self.blocks.shape[0]))
        W, S = weights.blocks[weights.block[first]], self.blocks
        both = W[:, :, None] * S * W[:, None, :] if weights.is_diagonal else W @ S @ W
        return SpectralMatrix(both, self.block)

    def times(
        self,
        values: Complex[np.ndarray, "n_omega n_y n_k"],
        out: Complex[np.ndarray, "n_omega n_y n_k"] | None = None,
    ) -> Complex[np.ndarray, "n_omega n_y n_k"]:
        """Compute the matrix product at every frequency, into ``out`` where it is given."""
        result = np.empty(values.shape, dtype=complex) if out is None else out
        if self.is_diagonal:
            # Real and imaginary parts times a real number: half the work of complex products.
            parts = np.ascontiguousarray(values).reshape(len(values), -1).view(float)
            weighted = result.reshape(parts.shape[0], -1).view(float)
            for diagonal, lines in zip(self.blocks, self.block_slices(), strict=True):
                factors = np.repeat(diagonal, 2 * values.shape[2])
                np.multiply(parts[lines], factors, out=weighted[lines])
            return result
        if self.blocks.shape[0] == self.block.size:
            return np.matmul(self.blocks, values, out=result)
        for matrix, lines in zip(self.blocks, self.block_slices(), strict=True):
            np.matmul(matrix, values[lines], out=result[lines])
        return result

    def block_slices(self) -> list[slice]:
        """Return the frequencies of every block."""
        if self.blocks.shape[0] == 1:
            return [slice(None)]
        ends = np.searchsorted(self.block, np.arange(self.blocks.shape[0] + 1)).tolist()
        return [slice(a, b) for a, b in pairwise(ends)]


def compute_group_powers(
    values: Complex[np.ndarray, "n_omega n_y"], group: np.ndarray, n_groups: int
) -> Float[np.ndarray, "n_groups n_y"]:
    """Compute the mean square of every output over the frequencies of each group."""
    if n_groups == 1:
        parts = np.ascontiguousarray(values).view(float)
        sums = np.einsum("kc,kc->c", parts, parts)
        return sums.reshape(1, -1, 2).sum(axis=2) / len(parts)
    member = (group == np.arange(n_groups)[:, None]) / np.bincount(group, minlength=n_groups)[
        :, None
    ]
    return member @ (np.real(values) ** 2 + np.imag(values) ** 2)


def compute_residual_density(
    residuals: Complex[np.ndarray, "n_omega n_y"],
    measured_power: Float[np.ndarray, "n_groups n_y"],
    group: np.ndarray,
    kind: str,
) -> tuple[SpectralMatrix, float]:
    """Compute the residual covariance of each group of frequencies, and the cost.

    Parameters
    ----------
    residuals
        At all frequencies. [output unit * s]
    measured_power
        Of the outputs in each group; a multiple of it is the floor of the density.
    group
        Group of each frequency, in order.
    kind
        ``diagonal``, or ``full`` with shrinkage towards the diagonal where there are
        too few frequencies for a full matrix.

    Returns
    -------
    tuple
        The covariance S, and the cost, the negative log likelihood without constants: the
        sum over frequencies of nu^H S^-1 nu + ln |S|, with nu nu^H shrunk as S is. Its
        gradient with S held is -2 Re sum J^H S^-1 nu.
    """
    n_groups, n_y = measured_power.shape
    power = compute_group_powers(residuals, group, n_groups)
    diagonal = np.maximum(power, _RELATIVE_FLOOR * measured_power)
    counts = np.bincount(group, minlength=n_groups)
    if kind != "full":
        cost = counts @ (power / diagonal + np.log(diagonal)).sum(axis=1)
        return SpectralMatrix(diagonal, group), float(cost)
    blocks = np.empty((n_groups, n_y, n_y), dtype=complex)
    for g in range(n_groups):
        nu = residuals[group == g]
        share = 1.0 - max(shrinkage(nu.shape[0], n_y), _LEAST_SHRINKAGE)
        blocks[g] = share * (nu.T @ nu.conj()) / nu.shape[0]
        blocks[g][np.diag_indices(n_y)] = diagonal[g]
    cost = counts @ (n_y + np.linalg.slogdet(blocks)[1])
    return SpectralMatrix(blocks, group), float(cost)


def compute_likelihood_weights(density: SpectralMatrix) -> SpectralMatrix:
    """Compute the weights for which least squares and the cost have the same gradient.

    Notes
    -----
    For a shrunk density S = (1 - l) C + l diag C of the residual covariance C the gradient of
    M ln |S| is that of sum nu^H [(1 - l) S^-1 + l diag S^-1] nu with the weights held. With
    S^-1 alone the gradient of the fit would differ from that of its cost, and the iteration
    would not converge.
    """
    inverse = density.inverse()
    if density.is_diagonal:
        return inverse
    n_y = density.blocks.shape[1]
    share = np.array([shrinkage(int(n), n_y) for n in np.bincount(density.block)])
    own = np.arange(n_y)
    weights = (1.0 - share)[:, None, None] * inverse.blocks
    weights[:, own, own] = inverse.blocks[:, own, own]
    return SpectralMatrix(weights, density.block)


def shrinkage(n_frequencies: int, n_y: int) -> float:
    """Compute the share by which off-diagonal terms are reduced so that a full matrix is regular.

    Zero with at least ten frequencies per output, one third at three per output.
    """
    few = n_frequencies < _ENOUGH_PER_OUTPUT * n_y
    return float(np.clip(n_y / n_frequencies, 0.0, _LARGEST_SHRINKAGE)) if few else 0.0


def smooth_density(
    residuals: Complex[np.ndarray, "n_omega n_y"],
    group: np.ndarray,
    n_groups: int,
    neighbours: int = _NEIGHBOURS,
) -> SpectralMatrix:
    """Estimate a full density that varies with frequency, from neighbouring frequencies.

    The estimator weights with one density per group. The true density (coloured, correlated
    between outputs by noise on the measured inputs) is estimated from about twelve
    frequencies on either side, in segments of five and so many ``neighbours``.
    """
    densities, block = [], np.empty(group.size, dtype=int)
    for g in range(n_groups):
        lines = np.flatnonzero(group == g)
        segment = np.arange(lines.size) // SEGMENT
        sizes = np.bincount(segment)
        nu = np.zeros((sizes.size * SEGMENT, residuals.shape[1]), dtype=complex)
        nu[: lines.size] = residuals[lines]
        nu = nu.reshape(sizes.size, SEGMENT, -1)
        sums = nu.transpose(0, 2, 1) @ nu.conj()
        at = np.arange(sizes.size)
        near = np.abs(at[:, None] - at) <= neighbours
        share = near / (near @ sizes)[:, None]
        block[lines] = sum(len(d) for d in densities) + segment
        smooth = share @ sums.reshape(sizes.size, -1).view(float)
        densities.append(smooth.view(complex).reshape(sums.shape))
    return SpectralMatrix(np.concatenate(densities), block)


# --- Noise spectrum of a record: its spectral matrix at every frequency, from the residuals -------

_SPECTRUM_NEIGHBOURS = 3  # segments on either side, by default
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
    residuals: Complex[np.ndarray, "n_omega n_y"], neighbours: int = _SPECTRUM_NEIGHBOURS
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


# --- Power of the residuals in a band of an output against the noise measured there ---------------

_BANDS = 4  # with equal numbers of frequencies, so that each has the degrees of freedom of a test
_LEAST_WINDOWS = 8  # local fits in a band; fewer do not measure its noise
_TAIL = 0.3  # probability below which two moments are not accurate
_ROUNDING = 1e-12  # of the largest eigenvalue


@dataclass(frozen=True, slots=True)
class BandPower:
    """Residual power of one output in one band.

    ``statistic`` is chi-square with ``degrees_of_freedom`` for a correct model and known noise,
    ``p`` the probability of a larger one in view of the degrees of freedom of the noise, and
    ``ratio`` the power over that of the noise.
    """

    output: int
    band_hz: tuple[float, float]
    statistic: float
    degrees_of_freedom: int
    ratio: float
    p: float


def compute_band_powers(
    omega: Float[np.ndarray, " n_omega"],
    inputs: Complex[np.ndarray, "n_omega n_u"],
    residuals: Complex[np.ndarray, "n_omega n_y"],
    leverage: Float[np.ndarray, "n_omega n_y"],
) -> Iterator[BandPower]:
    """Compare the power of residuals with that of their scatter about smooth responses.

    Parameters
    ----------
    omega
        Frequencies in order. [rad/s]
    inputs
        Of the model. [rad s]
    residuals
        Of equal variance at all frequencies of an output.
    leverage
        Share of the noise that the fit removes, by residual.

    Yields
    ------
    BandPower
        By band and output; none where the inputs share their frequencies, or have too few.

    Notes
    -----
    With local residuals D nu, of unit variance for white noise, the ratio is
    rho = (|nu|^2 / n) / (|D nu|^2 / m) over the n frequencies and m windows of a band. A correct
    model exceeds it with the probability of nu^H Q nu > 0, Q = (1 - h) I/n - rho D^H D/m with the
    mean leverage h. For complex normal nu this is a sum of exponential variables times the
    eigenvalues of Q: by the first two moments where it is large, else by a saddlepoint
    approximation. Numerator and denominator are of the same noise, which an F distribution
    would take as independent.
    Source: Lugannani and Rice (1980), Saddle point approximation for the distribution of the sum
    of independent random variables.
    """
    D, centre = build_local_fits(inputs)
    edges = np.round(np.linspace(0, omega.size, _BANDS + 1)).astype(int)
    for first, last in pairwise(edges.tolist()):
        own = D[(centre >= first) & (centre < last)]
        m, n = len(own), last - first
        if m < _LEAST_WINDOWS:
            continue
        R = own.conj().T @ own / m
        moments = 1.0 / n, -2.0 * np.trace(R[first:last, first:last]).real / n, _norm(R)
        unit = np.zeros(omega.size)
        unit[first:last] = 1.0 / n
        near = np.flatnonzero(unit + np.diag(R).real)
        unit, R = unit[near], R[np.ix_(near, near)]
        power = np.sum(np.abs(residuals[first:last]) ** 2, axis=0)
        noise = np.sum(np.abs(own @ residuals) ** 2, axis=0) / m
        free = n - leverage[first:last].sum(axis=0)
        for output in range(residuals.shape[1]):
            rho = float(power[output] / n / noise[output])
            share = float(free[output]) / n
            variance = moments[0] * share**2 + moments[1] * share * rho + moments[2] * rho**2
            p = float(scipy.special.ndtr((share - rho) / np.sqrt(variance)))
            if p < _TAIL:
                p = _compute_tail(np.linalg.eigvalsh(share * np.diag(unit) - rho * R))
            yield BandPower(
                output,
                (float(omega[first]) / (2.0 * np.pi), float(omega[last - 1]) / (2.0 * np.pi)),
                float(2.0 * power[output] / noise[output]),
                round(2.0 * float(free[output])),
                rho / share,
                p,
            )


def _norm(matrix: np.ndarray) -> float:
    return float(np.sum(np.abs(matrix) ** 2))


def _compute_tail(eigenvalues: Float[np.ndarray, " n"]) -> float:
    """Compute the probability of a positive sum of exponential variables times these."""
    small = _ROUNDING * np.abs(eigenvalues).max()
    values = eigenvalues[np.abs(eigenvalues) > small]
    if values.max() <= 0.0 or values.min() >= 0.0 or values.sum() >= 0.0:
        return float(values.max() > 0.0)

    s = scipy.optimize.brentq(
        _differentiate_cumulant, 0.0, (1.0 - _ROUNDING) / values.max(), args=(values,)
    )
    cumulant = -float(np.sum(np.log1p(-s * values)))
    w = np.sqrt(-2.0 * cumulant)
    v = s * np.sqrt(np.sum((values / (1.0 - s * values)) ** 2))
    density = np.exp(-0.5 * w**2) / np.sqrt(2.0 * np.pi)
    return float(np.clip(scipy.special.ndtr(-w) + density * (1.0 / v - 1.0 / w), 0.0, 1.0))


def _differentiate_cumulant(s: float, eigenvalues: np.ndarray) -> float:
    return float(np.sum(eigenvalues / (1.0 - s * eigenvalues)))
