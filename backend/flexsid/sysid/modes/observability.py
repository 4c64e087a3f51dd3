"""Observability of modes by sensors, and the information of further sensors."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

_RANK_TOLERANCE = 1e-10  # of the scaled information: smaller eigenvalues are unresolved
_UNRESOLVED_SHARE = 1e-6  # of a motion in unresolved directions: more is not identifiable
_LEAST_INFORMATION = 1e-6  # of the largest, of every motion: unobserved ones have a finite variance


@dataclass(frozen=True, slots=True, eq=False)
class ModalInformation:
    """Information of sensors on modal amplitudes, rigid-body motions estimated with them.

    ``covariance`` is that of eta for white noise [1]; infinite where a mode is not observed.
    """

    covariance: Float[np.ndarray, "n_modes n_modes"]
    matrix: Float[np.ndarray, "n_all n_all"]


def compute_modal_information(
    rows: Float[np.ndarray, "n_sensors n_modes"],
    rigid: Float[np.ndarray, "n_sensors n_rigid"],
    noise: Float[np.ndarray, " n_sensors"],
) -> ModalInformation:
    """Compute the information of all sensors, weighted by their noise.

    Parameters
    ----------
    rows
        Signal of each sensor per unit eta, for each mode at its own frequency.
    rigid
        Signal per unit of each rigid-body motion that is estimated as well.
    noise
        Standard deviation of each sensor, in the unit of its signal.

    Notes
    -----
    Source: the effective-independence method of Kammer (1991), doi:10.2514/3.20635, works on the
    same matrix.
    """
    whole = np.concatenate([rows, rigid], axis=1) / noise[:, None]
    matrix = whole.T @ whole
    n = rows.shape[1]
    scale = np.sqrt(np.diag(matrix))
    seen = scale > 0
    unit = matrix[np.ix_(seen, seen)] / np.outer(scale[seen], scale[seen])
    values, vectors = np.linalg.eigh(unit)
    held = values > _RANK_TOLERANCE
    inverse = (vectors[:, held] / values[held]) @ vectors[:, held].T
    # A motion with a share in an unresolved direction is not identifiable.
    loose = np.sum(vectors[:, ~held] ** 2, axis=1) > _UNRESOLVED_SHARE
    full = np.full(matrix.shape, np.inf)
    identifiable = np.flatnonzero(seen)[~loose]
    part = inverse[np.ix_(~loose, ~loose)] / np.outer(scale[identifiable], scale[identifiable])
    full[np.ix_(identifiable, identifiable)] = part
    return ModalInformation(full[:n, :n], matrix)


def rank_candidate_sensors(
    information: ModalInformation,
    rows: Float[np.ndarray, "n_candidates n_modes"],
    rigid: Float[np.ndarray, "n_candidates n_rigid"],
    noise: float,
) -> tuple[Float[np.ndarray, " n_candidates"], Float[np.ndarray, "n_candidates n_modes"]]:
    """Rank candidate sensors by the information that each would add.

    ``information`` is that of the present sensors; the candidates are given as to
    ``compute_modal_information``, of one standard deviation.

    Returns
    -------
    array
        Growth of the logarithm of the determinant of the information, by which candidates are
        ranked.
    array
        By which factor each mode's standard error would shrink, 1 for not at all.

    Notes
    -----
    A rank-one update: det(F + h h') = det(F) (1 + h' F^-1 h). A small part of the largest
    information is added to every motion, so that modes that are not observed count as
    poorly known, with a finite variance.
    """
    n = rows.shape[1]
    scale = np.sqrt(np.diag(information.matrix))
    scale[scale == 0] = max(float(scale.max(initial=0.0)), 1.0)
    unit = information.matrix / np.outer(scale, scale) + _LEAST_INFORMATION * np.eye(scale.size)
    before = np.linalg.inv(unit)
    h = np.concatenate([rows, rigid], axis=1) / noise / scale
    projected = h @ before
    gain = np.einsum("ij,ij->i", projected, h)
    after = np.diag(before)[:n] - projected[:, :n] ** 2 / (1.0 + gain)[:, None]
    shrink = np.sqrt(np.maximum(after, 0.0) / np.diag(before)[:n])
    return np.log1p(gain), shrink
