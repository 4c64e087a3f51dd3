"""Evidence of equation error: one linear regression per coefficient."""

from __future__ import annotations

import numpy as np
from jaxtyping import Complex, Float
from scipy import linalg

from flexsid.errors import NotIdentifiable
from flexsid.sysid.estimation import noise
from flexsid.sysid.estimation.equation_error import (
    MotionNoise,
    aerodynamic_coefficients,
    regressors,
)
from flexsid.sysid.estimation.parameters import Parameters
from flexsid.sysid.estimation.reconstruction import ReconstructedMotion
from flexsid.sysid.estimation.regression import Disturbance, Weighing, compensate
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.derivatives import coefficients
from flexsid.sysid.signals import FrequencyData
from flexsid.sysid.structure_determination.evidence import Evidence, Parts

N_PARTS = 20
_RUN = 5  # neighbouring lines that stay together when lines are drawn anew
_TOLD_APART = 1e-3  # of the strongest direction: weaker ones are left out of the reference


def equation_evidence(
    model: AeroelasticModel,
    motion: ReconstructedMotion,
    inputs: FrequencyData,
    candidates: Parameters,
) -> dict[str, Evidence]:
    """What one maneuver says about the candidate terms of every coefficient.

    Parameters
    ----------
    model
        Condition, modes and inputs.
    motion
        Reconstructed motion with its uncertainty.
    inputs
        Surface deflections, instrument dynamics removed. [rad s]
    candidates
        Its free derivatives are the candidates; others contribute with their held value.

    Notes
    -----
    Lines are weighted, and the bias of noisy regressors is taken out, as in
    ``equation_error`` with all candidates that the data tell apart. A term is judged
    against the residuals of that fit, not against those of the terms already chosen,
    so that what has not entered yet does not count as noise.
    """
    X = regressors(model, motion, inputs)
    z = aerodynamic_coefficients(model, motion)
    errors = MotionNoise(model, motion)
    held = candidates.base.values.copy()
    held[candidates.rows, candidates.columns] = 0.0
    found = {}
    for row, name in enumerate(coefficients(model.modes.numbers)):
        place = np.flatnonzero(candidates.rows == row)
        if place.size:
            columns = candidates.columns[place]
            found[name] = regression_evidence(
                X[:, columns],
                z[:, row] - X @ held[row],
                tuple(candidates.names[i] for i in place),
                errors.of_row(row, held[row], columns),
            )
    return found


def regression_evidence(
    X: Complex[np.ndarray, "n_omega p"],
    z: Complex[np.ndarray, " n_omega"],
    names: tuple[str, ...],
    disturbance: Disturbance,
) -> Evidence:
    """Evidence of one complex regression with real terms.

    Raises
    ------
    NotIdentifiable
        If there are fewer than three lines, or no regressor moves.
    """
    weighing = _reference(X, z, names, disturbance)
    n_lines = z.size
    nu = (z - X @ weighing.values) / np.sqrt(weighing.variance)
    freedom = n_lines - 0.5 * np.count_nonzero(weighing.values)
    level = max(float(np.sum(np.abs(nu) ** 2)) / freedom, np.finfo(float).tiny)
    weight = 2.0 / (weighing.variance * level)
    parts = _parts(X, z, weight, weighing.keep, disturbance)
    one_group = np.zeros(n_lines, dtype=int)
    density = np.real(noise.smoothed_density(nu[:, None], one_group, 1).of_lines()[:, 0, 0])
    density *= n_lines / freedom / level
    noisy = np.real((X.conj() * (density * weight)[:, None]).T @ X)
    scores = np.real(X.conj() * (weight * (z - X @ weighing.values))[:, None])
    alone = n_lines / freedom * scores.T @ scores
    return Evidence(
        names=names,
        information=parts.information.sum(axis=0),
        moment=parts.moment.sum(axis=0),
        scatter=np.stack([0.5 * (noisy + noisy.T), alone]),
        total=float(parts.total.sum()),
        n_data=2.0 * n_lines,
        parts=parts,
    )


def _reference(
    X: Complex[np.ndarray, "n_omega p"],
    z: Complex[np.ndarray, " n_omega"],
    names: tuple[str, ...],
    disturbance: Disturbance,
) -> Weighing:
    """Fit with all terms that the data tell apart; the others stay zero in it."""
    n_lines, p = X.shape
    size = np.linalg.norm(X, axis=0)
    if n_lines < 3 or not size.any():
        raise NotIdentifiable(
            f"{n_lines} lines on which nothing moves cannot tell which terms of "
            f"{names[0].split('_')[0]} are there; use more lines",
            lines=n_lines,
        )
    unit = np.divide(X, size, out=np.zeros_like(X), where=size > 0.0)
    stacked = np.concatenate([np.real(unit), np.imag(unit)])
    _, r, order = linalg.qr(stacked, mode="economic", pivoting=True)
    rank = int(np.count_nonzero(np.abs(np.diag(r)) > _TOLD_APART))
    target = np.concatenate([np.real(z), np.imag(z)])
    kept = np.sort(order[:rank])
    if rank > n_lines // 2:
        kept = _leading(stacked, target, n_lines // 2)
    first = np.linalg.lstsq(stacked[:, kept], target, rcond=None)[0] / size[kept]
    among = Disturbance(
        disturbance.regressors[:, kept[:, None], kept],
        disturbance.cross[:, kept],
        disturbance.dependent,
    )
    found, _ = compensate(X[:, kept], z, first, among)
    values = np.zeros(p)
    values[kept] = found.values
    return Weighing(values, found.variance, found.keep)


def _leading(
    stacked: Float[np.ndarray, "n_rows p"], target: Float[np.ndarray, " n_rows"], count: int
) -> np.ndarray:
    """The columns that one after the other explain most, where there are too many for all."""
    kept: list[int] = []
    left = target
    for _ in range(count):
        pull = np.abs(stacked.T @ left)
        pull[kept] = -1.0
        kept.append(int(np.argmax(pull)))
        fitted = np.linalg.lstsq(stacked[:, kept], target, rcond=None)[0]
        left = target - stacked[:, kept] @ fitted
    return np.sort(np.array(kept))


def _parts(
    X: Complex[np.ndarray, "n_omega p"],
    z: Complex[np.ndarray, " n_omega"],
    weight: Float[np.ndarray, " n_omega"],
    keep: float,
    disturbance: Disturbance,
) -> Parts:
    """Weighted sums over combs of lines, the known errors taken out."""
    n_lines, p = X.shape
    stacked = np.concatenate([np.real(X), np.imag(X)])
    target = np.concatenate([np.real(z), np.imag(z)])
    comb = comb_of_lines(n_lines)
    information, moment, total = [], [], []
    for number in range(int(comb.max()) + 1):
        w = np.where(comb == number, weight, 0.0)
        twice = np.concatenate([w, w])
        weighted = stacked.T * twice
        spread = (w @ disturbance.regressors.reshape(n_lines, -1)).reshape(p, p)
        information.append(weighted @ stacked - keep * spread)
        moment.append(weighted @ target - keep * (w @ disturbance.cross))
        total.append(float(twice @ target**2))
    return Parts(np.stack(information), np.stack(moment), np.array(total))


def comb_of_lines(n_lines: int) -> np.ndarray:
    """Number of the comb that each line belongs to; runs of neighbours stay together."""
    run = np.arange(n_lines) // max(1, min(_RUN, n_lines // N_PARTS))
    return run % N_PARTS
