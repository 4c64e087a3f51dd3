"""Spectral density of the residuals, and the weights that follow from it (Eq. 19)."""

from __future__ import annotations

import numpy as np
from jaxtyping import Complex

_SEGMENT = 5  # lines
_RELATIVE_FLOOR = 1e-20  # of the measured power: keeps weights finite on noise-free data


def residual_density(
    residuals: Complex[np.ndarray, "n_omega n_y"],
    measured: Complex[np.ndarray, "n_omega n_y"],
    group: np.ndarray,
    n_groups: int,
    kind: str,
) -> np.ndarray:
    """Covariance of one line's residual, by group of lines.

    Parameters
    ----------
    residuals, measured
        Of all lines. [output unit * s]
    group
        Group of each line.
    n_groups
        Number of groups.
    kind
        ``diagonal``, or ``full`` with shrinkage towards the diagonal where the
        lines are too few to fill a matrix.

    Returns
    -------
    array
        (n_groups, n_y) real, or (n_groups, n_y, n_y) Hermitian.
    """
    n_y = residuals.shape[1]
    full = kind == "full"
    density = np.zeros((n_groups, n_y, n_y), dtype=complex) if full else np.zeros((n_groups, n_y))
    for g in range(n_groups):
        lines = group == g
        nu, z = residuals[lines], measured[lines]
        power = np.mean(np.abs(nu) ** 2, axis=0)
        diagonal = np.maximum(power, _RELATIVE_FLOOR * np.mean(np.abs(z) ** 2, axis=0))
        if not full:
            density[g] = diagonal
            continue
        sample = nu.T @ nu.conj() / nu.shape[0]
        keep = 1.0 - shrinkage(nu.shape[0], n_y)
        density[g] = keep * sample
        density[g][np.diag_indices(n_y)] = diagonal
    return density


def shrinkage(n_lines: int, n_y: int) -> float:
    """Share of the off-diagonal terms given up so that a full matrix stays invertible.

    Zero with at least ten lines per output; one third of the way at three, and
    never so little that the matrix could be singular.
    """
    return float(np.clip(n_y / n_lines, 0.0, 0.9)) if n_lines < 10 * n_y else 0.0


def line_weights(density: np.ndarray, group: np.ndarray) -> np.ndarray:
    """Inverse density of every line: (n_omega, n_y), or (n_omega, n_y, n_y)."""
    if density.ndim == 2:
        return (1.0 / density)[group]
    return np.linalg.solve(density, np.broadcast_to(np.eye(density.shape[1]), density.shape))[group]


def negative_log_likelihood(
    residuals: Complex[np.ndarray, "n_omega n_y"], density: np.ndarray, group: np.ndarray
) -> float:
    """Sum over lines of nu^H S^-1 nu + ln |S|, constants dropped (Eq. 19)."""
    counts = np.bincount(group, minlength=density.shape[0])
    if density.ndim == 2:
        power = np.real(residuals) ** 2 + np.imag(residuals) ** 2
        misfit = float(np.sum(power / density[group]))
        return misfit + float(counts @ np.log(density).sum(axis=1))
    weighted = line_weights(density, group) @ residuals[:, :, None]
    misfit = float(np.vdot(residuals, weighted[:, :, 0]).real)
    return misfit + float(counts @ np.linalg.slogdet(density)[1])


def smoothed_density(
    residuals: Complex[np.ndarray, "n_omega n_y"], group: np.ndarray, n_groups: int
) -> Complex[np.ndarray, "n_omega n_y n_y"]:
    """Full density that may change with frequency, from neighbouring lines.

    The estimator weights with one density per group; what the residuals really
    are (coloured, correlated between outputs by noise on the measured inputs)
    is read from about twelve lines on either side, in segments of five.
    """
    result = np.empty((*residuals.shape, residuals.shape[1]), dtype=complex)
    for g in range(n_groups):
        lines = np.flatnonzero(group == g)
        first = np.arange(0, lines.size, _SEGMENT)
        ends = np.append(first[1:], lines.size)
        nu = residuals[lines]
        sums = np.stack([nu[a:b].T @ nu[a:b].conj() for a, b in zip(first, ends, strict=True)])
        total = np.concatenate([np.zeros_like(sums[:1]), np.cumsum(sums, axis=0)])
        at = np.arange(first.size)
        low, high = np.maximum(at - 2, 0), np.minimum(at + 3, first.size)
        count = ends[high - 1] - first[low]
        density = (total[high] - total[low]) / count[:, None, None]
        result[lines] = density[np.arange(lines.size) // _SEGMENT]
    return result
