"""Spectral density of the residuals, and the weights that follow from it (Eq. 19)."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from jaxtyping import Complex, Float

_SEGMENT = 5  # lines
_NEIGHBOURS = 2  # segments on either side
_LEAST_SHRINKAGE = 1e-6  # keeps the density of noise-free data from being singular
_RELATIVE_FLOOR = 1e-20  # of the measured power: keeps weights finite on noise-free data


@dataclass(frozen=True, slots=True)
class LineMatrix:
    """A Hermitian matrix over the outputs at every line; the lines of a block share it.

    ``blocks`` is (n_blocks, n_y) real where the matrix is diagonal, else
    (n_blocks, n_y, n_y); ``block`` numbers the block of every line, in order.
    """

    blocks: np.ndarray
    block: np.ndarray

    @property
    def is_diagonal(self) -> bool:
        """Whether nothing couples the outputs."""
        return self.blocks.ndim == 2

    def inverse(self) -> LineMatrix:
        """The weights that belong to a density."""
        if self.is_diagonal:
            return LineMatrix(1.0 / self.blocks, self.block)
        size = np.sqrt(np.real(np.einsum("bii->bi", self.blocks)))
        outer = size[:, :, None] * size[:, None, :]
        identity = np.broadcast_to(np.eye(size.shape[1]), outer.shape)
        inverse = np.linalg.solve(self.blocks / outer, identity) / outer
        return LineMatrix(0.5 * (inverse + inverse.conj().transpose(0, 2, 1)), self.block)

    def scaled(self, factor: float) -> LineMatrix:
        """Every matrix multiplied."""
        return LineMatrix(factor * self.blocks, self.block)

    def of_lines(self) -> np.ndarray:
        """The matrix, or its diagonal, of every line; a single one where all share it."""
        return self.blocks if self.blocks.shape[0] == 1 else self.blocks[self.block]

    def between(self, weights: LineMatrix) -> LineMatrix:
        """W S W, for weights whose blocks are unions of blocks of this density S."""
        first = np.searchsorted(self.block, np.arange(self.blocks.shape[0]))
        W, S = weights.blocks[weights.block[first]], self.blocks
        both = W[:, :, None] * S * W[:, None, :] if weights.is_diagonal else W @ S @ W
        return LineMatrix(both, self.block)

    def times(
        self,
        values: Complex[np.ndarray, "n_omega n_y n_k"],
        out: Complex[np.ndarray, "n_omega n_y n_k"] | None = None,
    ) -> Complex[np.ndarray, "n_omega n_y n_k"]:
        """Matrix product at every line, into ``out`` where it is given."""
        result = np.empty(values.shape, dtype=complex) if out is None else out
        if self.is_diagonal:
            # Real and imaginary parts times a real number: half the work of complex products.
            parts = np.ascontiguousarray(values).reshape(len(values), -1).view(float)
            weighted = result.reshape(parts.shape[0], -1).view(float)
            for diagonal, lines in zip(self.blocks, self.block_lines(), strict=True):
                factors = np.repeat(diagonal, 2 * values.shape[2])
                np.multiply(parts[lines], factors, out=weighted[lines])
            return result
        if self.blocks.shape[0] == self.block.size:
            return np.matmul(self.blocks, values, out=result)
        for matrix, lines in zip(self.blocks, self.block_lines(), strict=True):
            np.matmul(matrix, values[lines], out=result[lines])
        return result

    def block_lines(self) -> list[slice]:
        """The lines of every block."""
        if self.blocks.shape[0] == 1:
            return [slice(None)]
        ends = np.searchsorted(self.block, np.arange(self.blocks.shape[0] + 1)).tolist()
        return [slice(a, b) for a, b in pairwise(ends)]


def group_powers(
    values: Complex[np.ndarray, "n_omega n_y"], group: np.ndarray, n_groups: int
) -> Float[np.ndarray, "n_groups n_y"]:
    """Mean square of every output over the lines of each group."""
    if n_groups == 1:
        parts = np.ascontiguousarray(values).view(float)
        sums = np.einsum("kc,kc->c", parts, parts)
        return sums.reshape(1, -1, 2).sum(axis=2) / len(parts)
    member = (group == np.arange(n_groups)[:, None]) / np.bincount(group, minlength=n_groups)[
        :, None
    ]
    return member @ (np.real(values) ** 2 + np.imag(values) ** 2)


def residual_density(
    residuals: Complex[np.ndarray, "n_omega n_y"],
    measured_power: Float[np.ndarray, "n_groups n_y"],
    group: np.ndarray,
    kind: str,
) -> tuple[LineMatrix, float]:
    """Covariance of one line's residual by group of lines, and the cost with it.

    Parameters
    ----------
    residuals
        Of all lines. [output unit * s]
    measured_power
        Of the outputs in each group, which bounds the density from below.
    group
        Group of each line, in order.
    kind
        ``diagonal``, or ``full`` with shrinkage towards the diagonal where the
        lines are too few to fill a matrix.

    Returns
    -------
    tuple
        The density S, and the negative log likelihood, constants dropped: the sum
        over lines of nu^H S^-1 nu + ln |S| (Eq. 19), with the covariance shrunk as S is.
    """
    n_groups, n_y = measured_power.shape
    power = group_powers(residuals, group, n_groups)
    diagonal = np.maximum(power, _RELATIVE_FLOOR * measured_power)
    counts = np.bincount(group, minlength=n_groups)
    if kind != "full":
        cost = counts @ (power / diagonal + np.log(diagonal)).sum(axis=1)
        return LineMatrix(diagonal, group), float(cost)
    blocks = np.empty((n_groups, n_y, n_y), dtype=complex)
    for g in range(n_groups):
        nu = residuals[group == g]
        kept = 1.0 - max(shrinkage(nu.shape[0], n_y), _LEAST_SHRINKAGE)
        blocks[g] = kept * (nu.T @ nu.conj()) / nu.shape[0]
        blocks[g][np.diag_indices(n_y)] = diagonal[g]
    cost = counts @ (n_y + np.linalg.slogdet(blocks)[1])
    return LineMatrix(blocks, group), float(cost)


def likelihood_weights(density: LineMatrix) -> LineMatrix:
    """Weights under which the sum of squares falls as the likelihood with this density does.

    Notes
    -----
    Of a density that was shrunk, S = (1 - l) C + l diag C of the residuals' covariance C,
    ln |S| falls as nu^H [(1 - l) S^-1 + l diag S^-1] nu does: with S^-1 alone a fit would
    follow another slope than that of its cost, and never come to rest.
    """
    inverse = density.inverse()
    if density.is_diagonal:
        return inverse
    n_y = density.blocks.shape[1]
    share = np.array([shrinkage(int(n), n_y) for n in np.bincount(density.block)])
    own = np.arange(n_y)
    weights = (1.0 - share)[:, None, None] * inverse.blocks
    weights[:, own, own] = inverse.blocks[:, own, own]
    return LineMatrix(weights, density.block)


def shrinkage(n_lines: int, n_y: int) -> float:
    """Share of the off-diagonal terms given up so that a full matrix stays invertible.

    Zero with at least ten lines per output; one third of the way at three, and
    never so little that the matrix could be singular.
    """
    return float(np.clip(n_y / n_lines, 0.0, 0.9)) if n_lines < 10 * n_y else 0.0


def smoothed_density(
    residuals: Complex[np.ndarray, "n_omega n_y"], group: np.ndarray, n_groups: int
) -> LineMatrix:
    """Full density that may change with frequency, from neighbouring lines.

    The estimator weights with one density per group; what the residuals really
    are (coloured, correlated between outputs by noise on the measured inputs)
    is read from about twelve lines on either side, in segments of five.
    """
    densities, block = [], np.empty(group.size, dtype=int)
    for g in range(n_groups):
        lines = np.flatnonzero(group == g)
        segment = np.arange(lines.size) // _SEGMENT
        sizes = np.bincount(segment)
        nu = np.zeros((sizes.size * _SEGMENT, residuals.shape[1]), dtype=complex)
        nu[: lines.size] = residuals[lines]
        nu = nu.reshape(sizes.size, _SEGMENT, -1)
        sums = nu.transpose(0, 2, 1) @ nu.conj()
        at = np.arange(sizes.size)
        near = np.abs(at[:, None] - at) <= _NEIGHBOURS
        share = near / (near @ sizes)[:, None]
        block[lines] = sum(len(d) for d in densities) + segment
        smooth = share @ sums.reshape(sizes.size, -1).view(float)
        densities.append(smooth.view(complex).reshape(sums.shape))
    return LineMatrix(np.concatenate(densities), block)
