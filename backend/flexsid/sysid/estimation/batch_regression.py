"""Equation-error regression of many maneuvers at once, by stacked factorisations."""

from __future__ import annotations

import numpy as np
from jaxtyping import Complex, Float


def regress_many(
    X: Complex[np.ndarray, "n_maneuvers n_omega p"],
    z: Complex[np.ndarray, "n_maneuvers n_omega n_coefficients"],
) -> tuple[
    Float[np.ndarray, "n_maneuvers n_coefficients p"],
    Float[np.ndarray, "n_maneuvers n_coefficients p"],
]:
    """Fit z = X theta with real theta by least squares, for all maneuvers and coefficients.

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
    QR factorisation of the scaled columns: Cov = 1/2 s^2 R^-1 R^-T with s^2 = nu^H nu /
    (M - p/2). The condition number of the normal equations would be the square of that of R.
    """
    scale = np.sqrt(
        np.einsum("bmp,bmp->bp", np.real(X), np.real(X))
        + np.einsum("bmp,bmp->bp", np.imag(X), np.imag(X))
    )
    stacked = np.concatenate([np.real(X), np.imag(X)], axis=1) / scale[:, None, :]
    target = np.concatenate([np.real(z), np.imag(z)], axis=1)
    q, r = np.linalg.qr(stacked)
    projected = q.transpose(0, 2, 1) @ target
    inverse = np.linalg.solve(r, np.broadcast_to(np.eye(X.shape[2]), r.shape))
    theta = inverse @ projected
    freedom = X.shape[1] - 0.5 * X.shape[2]
    rest = np.sum((target - stacked @ theta) ** 2, axis=1) / freedom
    spread = np.sum(inverse**2, axis=2)
    errors = np.sqrt(0.5 * rest[:, :, None] * spread[:, None, :]) / scale[:, None, :]
    return theta.transpose(0, 2, 1) / scale[:, None, :], errors
