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
    inverse = _hold_single_outputs(model, inverse)
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
    """Compute the diagonal of J N^-1 J^H: the variance of modelled outputs.

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
    shares = sensitivity.own.conj() * compute_own_covariances(model, sensitivity, inverse)
    np.add.at(variance.T, model.own_outputs, np.real(shares))
    if sensitivity.ends is not None:
        n_pairs, n_single = model.pair_rows.size, model.pair_rows.size + model.own_outputs.size
        pairs, places, last = np.split(model.order, [n_pairs, n_single])
        moved = sensitivity.ends @ inverse[np.ix_(last, last)]
        for k, place in enumerate(last.tolist()):
            forces = _combine_forces(model, w, inverse[pairs, place])
            moved[:, :, k] += 2.0 * np.matmul(G, forces[:, :, None])[:, :, 0]
            by_own = 2.0 * inverse[places, place, None] * sensitivity.own
            np.add.at(moved[:, :, k].T, model.own_outputs, by_own)
        variance += np.real(np.sum(sensitivity.ends.conj() * moved, axis=2))
    return variance


def compute_own_covariances(
    model: FrequencyDomainModel,
    sensitivity: Sensitivity,
    inverse: Float[np.ndarray, "n_theta n_theta"],
) -> Complex[np.ndarray, "n_own n_omega"]:
    """Compute v with which the parameters of single outputs complete J N^-1 J^H of an output.

    That of the forces and Re sum v E^H over the sensitivities E of these parameters.
    """
    G, w = sensitivity.forces, sensitivity.variables
    n_pairs, outputs = model.pair_rows.size, model.own_outputs
    pairs, places = model.order[:n_pairs], model.order[n_pairs : n_pairs + outputs.size]
    tables = np.zeros((outputs.size, G.shape[2], len(w)))
    cross = inverse[np.ix_(places, pairs)] * model.scale
    np.add.at(tables.transpose(1, 2, 0), (model.pair_rows, model.pair_columns), cross.T)
    forces = (tables.reshape(-1, len(w)) @ w).reshape(*tables.shape[:2], w.shape[1])
    found = 2.0 * np.sum(G.transpose(1, 2, 0)[outputs] * forces, axis=1)
    same = np.where(outputs[:, None] == outputs, inverse[np.ix_(places, places)], 0.0)
    return found + same @ sensitivity.own


def _hold_single_outputs(
    model: FrequencyDomainModel, inverse: Float[np.ndarray, "n_theta n_theta"]
) -> Float[np.ndarray, "n_theta n_theta"]:
    """Return the inverse for known parameters of single outputs and end states.

    The leverage of the others is then below one.
    """
    forces, known = np.split(model.order, [model.pair_rows.size])
    if not known.size:
        return inverse
    cross, own = inverse[np.ix_(forces, known)], inverse[np.ix_(known, known)]
    # Parameters differ in size by orders of magnitude.
    size = np.sqrt(np.maximum(np.diag(own), np.finfo(float).tiny))
    scaled = cross / size
    held = inverse[np.ix_(forces, forces)]
    held -= scaled @ np.linalg.lstsq(own / np.outer(size, size), scaled.T, rcond=1e-13)[0]
    result = np.zeros_like(inverse)
    result[np.ix_(forces, forces)] = 0.5 * (held + held.T)
    return result


def _combine_forces(
    model: FrequencyDomainModel,
    variables: Complex[np.ndarray, "n_w n_omega"],
    weights: Float[np.ndarray, " n_pairs"],
) -> Complex[np.ndarray, "n_omega n_r"]:
    """Compute the forces of a change of the pairs of parameters by ``weights``."""
    table = np.zeros((model.rows.size, len(variables)))
    np.add.at(table, (model.pair_rows, model.pair_columns), model.scale * weights)
    return (table @ variables).T


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
