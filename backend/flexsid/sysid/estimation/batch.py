"""Equation error for many maneuvers at once: one stacked factorisation per coefficient."""

from __future__ import annotations

import numpy as np
from jaxtyping import Complex, Float


def regress_batch(
    X: Complex[np.ndarray, "n_maneuvers n_omega p"],
    z: Complex[np.ndarray, "n_maneuvers n_omega n_coefficients"],
) -> tuple[
    Float[np.ndarray, "n_maneuvers n_coefficients p"],
    Float[np.ndarray, "n_maneuvers n_coefficients p"],
]:
    """Fit z = X theta with real theta for all maneuvers and coefficients.

    Parameters
    ----------
    X
        Regressors, common to the coefficients of a maneuver.
    z
        Coefficients.

    Returns
    -------
    values, std_errors
        By maneuver and coefficient; for white residuals (methods as in
        ``regression.regress`` without known errors).

    Notes
    -----
    Columns are scaled before the normal equations are formed, which keeps their
    condition at the square of that of the correlation between regressors.
    """
    scale = np.sqrt(
        np.einsum("bmp,bmp->bp", np.real(X), np.real(X))
        + np.einsum("bmp,bmp->bp", np.imag(X), np.imag(X))
    )
    stacked = np.concatenate([np.real(X), np.imag(X)], axis=1) / scale[:, None, :]
    target = np.concatenate([np.real(z), np.imag(z)], axis=1)
    transposed = stacked.transpose(0, 2, 1)
    normal = transposed @ stacked
    p = X.shape[2]
    right = np.concatenate([transposed @ target, np.broadcast_to(np.eye(p), normal.shape)], axis=2)
    solved = np.linalg.solve(normal, right)
    n_c = z.shape[2]
    theta, inverse = solved[:, :, :n_c], solved[:, :, n_c:]
    explained = np.einsum("bpc,bpc->bc", theta, right[:, :, :n_c])
    freedom = X.shape[1] - 0.5 * p
    rest = np.maximum(np.einsum("bnc,bnc->bc", target, target) - explained, 0.0) / freedom
    spread = np.diagonal(inverse, axis1=1, axis2=2)
    errors = np.sqrt(0.5 * rest[:, :, None] * spread[:, None, :]) / scale[:, None, :]
    return theta.transpose(0, 2, 1) / scale[:, None, :], errors
