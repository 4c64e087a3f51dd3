"""Evidence of equation error: one linear regression per coefficient."""

from __future__ import annotations

import numpy as np
from jaxtyping import Complex, Float
from scipy import linalg

from flexsid.errors import NotIdentifiable
from flexsid.sysid.estimation import noise
from flexsid.sysid.estimation.equation_error import (
    MotionNoise,
    build_regressors,
    compute_aerodynamic_coefficients,
)
from flexsid.sysid.estimation.parameters import Parameters
from flexsid.sysid.estimation.reconstruction import ReconstructedMotion
from flexsid.sysid.estimation.regression import ErrorsInVariables, WeightedFit, compensate_bias
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.signals import FrequencyData
from flexsid.sysid.structure_determination.evidence import Evidence, Parts

N_PARTS = 20  # combs of frequencies for the bootstrap
_RUN_LENGTH = 5  # neighbouring frequencies that stay together in a bootstrap
_LEAST_DIRECTION = 1e-3  # of the strongest direction, in the reference fit


def compute_equation_evidence(
    model: AeroelasticModel,
    motion: ReconstructedMotion,
    inputs: FrequencyData,
    candidates: Parameters,
) -> dict[str, Evidence]:
    """Compute the evidence of one maneuver on the candidate terms of every coefficient.

    Parameters
    ----------
    model, motion
        Condition and modes, and the reconstructed motion with its uncertainty.
    inputs
        Surface deflections, instrument dynamics removed. [rad s]
    candidates
        Its free derivatives are the candidates; others contribute with their held value.

    Notes
    -----
    Frequencies are weighted, and the bias of noisy regressors is removed, as in
    ``equation_error`` with all candidates that the data resolve. A term is tested
    against the residuals of that fit, not against those of the terms already selected,
    so that terms that have not entered yet do not count as noise.
    """
    X = build_regressors(model, motion, inputs)
    z = compute_aerodynamic_coefficients(model, motion)
    errors = MotionNoise(model, motion)
    held = candidates.base.values.copy()
    held[candidates.rows, candidates.columns] = 0.0
    found = {}
    for row, name in enumerate(model.coefficients):
        place = np.flatnonzero(candidates.rows == row)
        if place.size:
            columns = candidates.columns[place]
            found[name] = compute_regression_evidence(
                X[:, columns],
                z[:, row] - X @ held[row],
                tuple(candidates.names[i] for i in place),
                errors.compute_row_errors(row, held[row], columns),
            )
    return found


def compute_regression_evidence(
    X: Complex[np.ndarray, "n_omega p"],
    z: Complex[np.ndarray, " n_omega"],
    names: tuple[str, ...],
    errors: ErrorsInVariables,
) -> Evidence:
    """Compute the evidence of one complex regression with real terms.

    Raises
    ------
    NotIdentifiable
        If there are fewer than three frequencies, or all regressors are zero.
    """
    weighing = _fit_reference(X, z, names, errors)
    n_frequencies = z.size
    nu = (z - X @ weighing.values) / np.sqrt(weighing.variance)
    freedom = n_frequencies - 0.5 * np.count_nonzero(weighing.values)
    level = max(float(np.sum(np.abs(nu) ** 2)) / freedom, np.finfo(float).tiny)
    weight = 2.0 / (weighing.variance * level)
    parts = _sum_parts(X, z, weight, weighing.fraction_removed, errors)
    one_group = np.zeros(n_frequencies, dtype=int)
    density = np.real(noise.smooth_density(nu[:, None], one_group, 1).expand_blocks()[:, 0, 0])
    density *= n_frequencies / freedom / level
    noisy = np.real((X.conj() * (density * weight)[:, None]).T @ X)
    scores = np.real(X.conj() * (weight * (z - X @ weighing.values))[:, None])
    alone = n_frequencies / freedom * scores.T @ scores
    return Evidence(
        names=names,
        information=parts.information.sum(axis=0),
        moment=parts.moment.sum(axis=0),
        scatter=np.stack([0.5 * (noisy + noisy.T), alone]),
        total=float(parts.total.sum()),
        n_data=2.0 * n_frequencies,
        parts=parts,
    )


def _fit_reference(
    X: Complex[np.ndarray, "n_omega p"],
    z: Complex[np.ndarray, " n_omega"],
    names: tuple[str, ...],
    errors: ErrorsInVariables,
) -> WeightedFit:
    """Fit all terms that the data resolve; the others are zero."""
    n_frequencies, p = X.shape
    size = np.linalg.norm(X, axis=0)
    if n_frequencies < 3 or not size.any():
        raise NotIdentifiable(
            f"{n_frequencies} frequencies without motion cannot resolve the terms of "
            f"{names[0].split('_')[0]}; use more frequencies",
            frequencies=n_frequencies,
        )
    unit = np.divide(X, size, out=np.zeros_like(X), where=size > 0.0)
    stacked = np.concatenate([np.real(unit), np.imag(unit)])
    _, r, order = linalg.qr(stacked, mode="economic", pivoting=True)
    rank = int(np.count_nonzero(np.abs(np.diag(r)) > _LEAST_DIRECTION))
    target = np.concatenate([np.real(z), np.imag(z)])
    resolved = np.sort(order[:rank])
    if rank > n_frequencies // 2:
        resolved = _select_leading(stacked, target, n_frequencies // 2)
    first = np.linalg.lstsq(stacked[:, resolved], target, rcond=None)[0] / size[resolved]
    among = ErrorsInVariables(
        errors.regressors[:, resolved[:, None], resolved],
        errors.cross[:, resolved],
        errors.dependent,
    )
    found, _ = compensate_bias(X[:, resolved], z, first, among)
    values = np.zeros(p)
    values[resolved] = found.values
    return WeightedFit(values, found.variance, found.fraction_removed)


def _select_leading(
    stacked: Float[np.ndarray, "n_rows p"], target: Float[np.ndarray, " n_rows"], count: int
) -> np.ndarray:
    """Select the columns that explain most, one after the other, where there are too many."""
    resolved: list[int] = []
    left = target
    for _ in range(count):
        pull = np.abs(stacked.T @ left)
        pull[resolved] = -1.0
        resolved.append(int(np.argmax(pull)))
        fitted = np.linalg.lstsq(stacked[:, resolved], target, rcond=None)[0]
        left = target - stacked[:, resolved] @ fitted
    return np.sort(np.array(resolved))


def _sum_parts(
    X: Complex[np.ndarray, "n_omega p"],
    z: Complex[np.ndarray, " n_omega"],
    weight: Float[np.ndarray, " n_omega"],
    fraction: float,
    errors: ErrorsInVariables,
) -> Parts:
    """Weighted sums over combs of frequencies, corrected for the errors in variables."""
    n_frequencies, p = X.shape
    stacked = np.concatenate([np.real(X), np.imag(X)])
    target = np.concatenate([np.real(z), np.imag(z)])
    comb = assign_combs(n_frequencies)
    information, moment, total = [], [], []
    for number in range(int(comb.max()) + 1):
        w = np.where(comb == number, weight, 0.0)
        twice = np.concatenate([w, w])
        weighted = stacked.T * twice
        spread = (w @ errors.regressors.reshape(n_frequencies, -1)).reshape(p, p)
        information.append(weighted @ stacked - fraction * spread)
        moment.append(weighted @ target - fraction * (w @ errors.cross))
        total.append(float(twice @ target**2))
    return Parts(np.stack(information), np.stack(moment), np.array(total))


def assign_combs(n_frequencies: int) -> np.ndarray:
    """Assign each frequency to a comb; runs of neighbours stay together."""
    run = np.arange(n_frequencies) // max(1, min(_RUN_LENGTH, n_frequencies // N_PARTS))
    return run % N_PARTS
