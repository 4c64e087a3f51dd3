"""Covariance of the residuals at one frequency and the weights of the likelihood (Eq. 19).

S is the covariance of the residual of one data point, (1/M) sum nu nu^H at its maximum of
likelihood: the cost sum nu^H S^-1 nu + M ln |S| is Eq. 19 with M S for its S, constants dropped.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from jaxtyping import Complex, Float

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
