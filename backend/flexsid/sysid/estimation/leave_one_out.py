"""Leave-one-out residuals: residuals of each frequency against the fit to all others.

A fit moves the model towards the noise at each frequency, most where few frequencies have
high leverage, at the peak of a resonance near flutter. Residuals are too small there, where
the effect of noise on the inputs is largest.
"""

from __future__ import annotations

import numpy as np
from jaxtyping import Complex, Float

from flexsid.sysid.estimation.frequency_domain_model import FrequencyDomainModel, Sensitivity
from flexsid.sysid.estimation.noise import SpectralMatrix

_LARGEST_LEVERAGE = 0.95  # of one frequency in a direction; residuals stay finite


def compute_leave_one_out_residuals(
    model: FrequencyDomainModel,
    sensitivity: Sensitivity,
    residuals: Complex[np.ndarray, "n_omega n_y"],
    weights: SpectralMatrix,
    inverse: Float[np.ndarray, "n_theta n_theta"],
) -> Complex[np.ndarray, "n_omega n_y"]:
    """Compute leave-one-out residuals, to first order.

    Parameters
    ----------
    model, sensitivity, residuals, weights
        At the estimate.
    inverse
        Inverse of the normal matrix of all frequencies.

    Notes
    -----
    Source: the jackknife of Bell and McCaffrey's cluster-robust covariances, a cluster being
    one frequency. All outputs of a frequency depend on the few forces f = Theta w, so that
    with B = G^H W G and Q the covariance of f the change of f due to the frequency itself is
    Q (I - B Q)^-1 G^H W nu. Parameters of single outputs, as delays, and end
    states are taken as known.
    """
    if sensitivity.ends is not None:
        inverse = _hold_last(inverse, sensitivity.ends.shape[2])
    G = sensitivity.forces
    weighted = weights.times(G).conj().transpose(0, 2, 1)
    B = _as_real(weighted @ G)
    pull = np.matmul(weighted, residuals[:, :, None])[:, :, 0]
    b = np.concatenate([np.real(pull), np.imag(pull)], axis=1)
    Q = _force_covariance(model, sensitivity.variables, inverse)
    n = b.shape[1]
    f = Q @ np.linalg.solve(np.eye(n) - _LARGEST_LEVERAGE * (B @ Q), b[:, :, None])
    moved = f[:, : n // 2, 0] + 1j * f[:, n // 2 :, 0]
    return residuals + np.matmul(G, moved[:, :, None])[:, :, 0]


def compute_leverage(
    model: FrequencyDomainModel,
    sensitivity: Sensitivity,
    inverse: Float[np.ndarray, "n_theta n_theta"],
) -> Float[np.ndarray, "n_omega n_y"]:
    """Compute the diagonal of J N^-1 J^H, without end states: the variance of modelled outputs.

    Parameters
    ----------
    model, sensitivity
        At the estimate.
    inverse
        Inverse of the normal matrix.
    """
    G, w = sensitivity.forces, sensitivity.variables
    n_r = G.shape[2]
    Q = _force_covariance(model, w, inverse)
    P = Q[:, :n_r, :n_r] + Q[:, n_r:, n_r:] + 1j * (Q[:, n_r:, :n_r] - Q[:, :n_r, n_r:])
    variance = np.real(np.sum((G @ P) * G.conj(), axis=2))
    n_pairs = model.pair_rows.size
    pairs, places = model.order[:n_pairs], model.order[n_pairs:]
    for output, row, place in zip(model.own_outputs, sensitivity.own, places, strict=False):
        table = np.zeros((n_r, len(w)))
        np.add.at(table, (model.pair_rows, model.pair_columns), model.scale * inverse[pairs, place])
        by_forces = np.sum(G[:, output] * (table @ w).T, axis=1)
        same = model.own_outputs == output
        by_own = inverse[place, places[: same.size][same]] @ sensitivity.own[same]
        variance[:, output] += np.real(row.conj() * (2.0 * by_forces + by_own))
    return variance


def _hold_last(
    inverse: Float[np.ndarray, "n_theta n_theta"], count: int
) -> Float[np.ndarray, "n n"]:
    """Return the inverse for known last parameters; the leverage of the others is below one."""
    cross, own = inverse[:-count, -count:], inverse[-count:, -count:]
    held = inverse[:-count, :-count] - cross @ np.linalg.lstsq(own, cross.T, rcond=1e-13)[0]
    return 0.5 * (held + held.T)


def _force_covariance(
    model: FrequencyDomainModel,
    variables: Complex[np.ndarray, "n_w n_omega"],
    inverse: Float[np.ndarray, "n_theta n_theta"],
) -> Float[np.ndarray, "n_omega n n"]:
    """Transform the inverse normal matrix to real and imaginary parts of the forces."""
    n_r, n_omega = model.rows.size, variables.shape[1]
    if model.factors is not None:
        return _sum_force_covariance(model, variables, inverse)
    n_w = len(variables)
    place = model.pair_rows * n_w + model.pair_columns
    C = inverse[: place.size, : place.size]
    if place.size < n_r * n_w or np.any(place[1:] < place[:-1]):  # else in order already
        pairs = model.order[: place.size]
        C = np.zeros((n_r * n_w, n_r * n_w))
        C[np.ix_(place, place)] = inverse[np.ix_(pairs, pairs)]
    scale = np.zeros(n_r * n_w)
    scale[place] = model.scale
    C = C * np.outer(scale, scale)
    w = np.stack([np.real(variables), np.imag(variables)]).transpose(2, 0, 1)  # frequency, part, w
    by_first = C.reshape(n_r, n_w, n_r, n_w).transpose(1, 0, 2, 3).reshape(n_w, -1)
    once = (w.reshape(-1, n_w) @ by_first).reshape(n_omega, -1, n_w)
    both = (once @ w.transpose(0, 2, 1)).reshape(n_omega, 2, n_r, n_r, 2)
    return both.transpose(0, 1, 2, 4, 3).reshape(n_omega, 2 * n_r, 2 * n_r)


def _sum_force_covariance(
    model: FrequencyDomainModel,
    variables: Complex[np.ndarray, "n_w n_omega"],
    inverse: Float[np.ndarray, "n_theta n_theta"],
) -> Float[np.ndarray, "n_omega n n"]:
    """Do the same for rows with variables of their own, row by row."""
    n_r, n_omega = model.rows.size, variables.shape[1]
    pairs = model.order[: model.pair_rows.size]
    C = inverse[np.ix_(pairs, pairs)] * np.outer(model.scale, model.scale)
    of_row = [np.flatnonzero(model.pair_rows == row) for row in range(n_r)]
    own = [variables[model.pair_columns[index]] for index in of_row]
    parts = [np.stack([np.real(w), np.imag(w)]).transpose(2, 0, 1) for w in own]
    Q = np.empty((n_omega, 2, n_r, 2, n_r))
    for i, index in enumerate(of_row):
        for j, other in enumerate(of_row):
            Q[:, :, i, :, j] = (parts[i] @ C[np.ix_(index, other)]) @ parts[j].transpose(0, 2, 1)
    return Q.reshape(n_omega, 2 * n_r, 2 * n_r)


def _as_real(A: Complex[np.ndarray, "n_omega n_r n_r"]) -> Float[np.ndarray, "n_omega n n"]:
    """Return Hermitian matrices acting on stacked real and imaginary parts."""
    real, imag = np.real(A), np.imag(A)
    return np.concatenate(
        [np.concatenate([real, -imag], axis=2), np.concatenate([imag, real], axis=2)], axis=1
    )
