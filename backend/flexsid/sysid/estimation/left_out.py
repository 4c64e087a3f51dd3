"""Residuals as they would be had a line not taken part in the fit.

A fit pulls the model towards the noise of each line, most where few lines decide: at the
peak of a resonance near flutter. Residuals are too small there, just where noise on the
inputs is largest.
"""

from __future__ import annotations

import numpy as np
from jaxtyping import Complex, Float

from flexsid.sysid.estimation.line_model import LineModel, Sensitivity
from flexsid.sysid.estimation.noise import LineMatrix

_DECIDING = 0.95  # largest share of a direction that a line may decide alone


def left_out(
    model: LineModel,
    sensitivity: Sensitivity,
    residuals: Complex[np.ndarray, "n_omega n_y"],
    weights: LineMatrix,
    inverse: Float[np.ndarray, "n_theta n_theta"],
) -> Complex[np.ndarray, "n_omega n_y"]:
    """Residuals of every line against the fit to all other lines, to first order.

    Parameters
    ----------
    model, sensitivity, residuals, weights
        At the estimate.
    inverse
        Of the normal matrix of all lines.

    Notes
    -----
    Source: the jackknife of Bell and McCaffrey's cluster-robust covariances, a cluster being
    a line. All outputs of a line answer to the few forces f = Theta w only, so that with
    B = G^H W G and Q the covariance of f the line's own pull is Q (I - B Q)^-1 G^H W nu.
    Quantities of single outputs, as delays, are taken as known: no line decides them.
    """
    G = sensitivity.forces
    weighted = weights.times(G).conj().transpose(0, 2, 1)
    B = _as_real(weighted @ G)
    pull = np.matmul(weighted, residuals[:, :, None])[:, :, 0]
    b = np.concatenate([np.real(pull), np.imag(pull)], axis=1)
    Q = _force_covariance(model, sensitivity.variables, inverse)
    n = b.shape[1]
    f = Q @ np.linalg.solve(np.eye(n) - _DECIDING * (B @ Q), b[:, :, None])
    moved = f[:, : n // 2, 0] + 1j * f[:, n // 2 :, 0]
    return residuals + np.matmul(G, moved[:, :, None])[:, :, 0]


def _force_covariance(
    model: LineModel,
    variables: Complex[np.ndarray, "n_w n_omega"],
    inverse: Float[np.ndarray, "n_theta n_theta"],
) -> Float[np.ndarray, "n_omega n n"]:
    """Inverse normal matrix carried over to real and imaginary parts of each line's forces."""
    n_r, n_omega = model.rows.size, variables.shape[1]
    n_w = len(variables)
    place = model.pair_rows * n_w + model.pair_columns
    C = inverse[: place.size, : place.size]
    if place.size < n_r * n_w or np.any(place[1:] < place[:-1]):  # else each stands in its place
        pairs = model.order[: place.size]
        C = np.zeros((n_r * n_w, n_r * n_w))
        C[np.ix_(place, place)] = inverse[np.ix_(pairs, pairs)]
    scale = np.zeros(n_r * n_w)
    scale[place] = model.scale
    C = C * np.outer(scale, scale)
    w = np.stack([np.real(variables), np.imag(variables)]).transpose(2, 0, 1)  # line, part, w
    by_first = C.reshape(n_r, n_w, n_r, n_w).transpose(1, 0, 2, 3).reshape(n_w, -1)
    once = (w.reshape(-1, n_w) @ by_first).reshape(n_omega, -1, n_w)
    both = (once @ w.transpose(0, 2, 1)).reshape(n_omega, 2, n_r, n_r, 2)
    return both.transpose(0, 1, 2, 4, 3).reshape(n_omega, 2 * n_r, 2 * n_r)


def _as_real(A: Complex[np.ndarray, "n_omega n_r n_r"]) -> Float[np.ndarray, "n_omega n n"]:
    """Hermitian matrices acting on stacked real and imaginary parts."""
    real, imag = np.real(A), np.imag(A)
    return np.concatenate(
        [np.concatenate([real, -imag], axis=2), np.concatenate([imag, real], axis=2)], axis=1
    )
