"""Evidence of output error and frequency response error around a maximum of likelihood."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from jaxtyping import Bool, Complex, Float

from flexsid.sysid.estimation import noise
from flexsid.sysid.estimation.covariance import FinalLines, score_covariance
from flexsid.sysid.estimation.experiment import Experiment
from flexsid.sysid.estimation.kronecker import NormalForm
from flexsid.sysid.estimation.line_model import LineModel, Sensitivity
from flexsid.sysid.estimation.parameters import Parameters
from flexsid.sysid.estimation.record_edges import edges_of
from flexsid.sysid.structure_determination.equation import comb_of_lines
from flexsid.sysid.structure_determination.evidence import Evidence, Parts


def likelihood_evidence(
    experiment: Experiment,
    candidates: Parameters,
    theta: Float[np.ndarray, " n_theta"],
    n_fitted: int,
    *,
    kind: str = "diagonal",
    parts: bool = False,
) -> Evidence:
    """What one maneuver says about all candidates, expanded around an estimate.

    Parameters
    ----------
    experiment
        The lines of the maneuver.
    candidates
        All terms and extras that could be free.
    theta
        The estimate; what the model does not have stands at zero.
    n_fitted
        How many of them were fitted.
    kind
        Of the noise, as in the fit.
    parts
        Whether the sums over combs of lines are wanted, too, to draw lines anew.

    Notes
    -----
    Around the estimate the residuals are linear in the terms. For those in the model
    the quadratic gives Wald's test, for those that are not it gives Rao's score test,
    for the gradient of a derivative at zero costs no more than that of one in the model
    (Kronecker form): all single changes of a model come from one expansion. Both are
    judged against what a step of all candidates would leave, so that what is not in the
    model yet does not count as noise.
    """
    model = LineModel(experiment, candidates)
    form = NormalForm(model)
    response = model.respond(theta)
    residuals = experiment.measured - response.outputs
    n_groups = len(experiment.group_names)
    powers = noise.group_powers(experiment.measured, experiment.group, n_groups)
    sensitivity = model.sensitivity(theta, response)
    J = model.jacobian(sensitivity)
    n_data = 2 * residuals.size
    inflation = n_data / (n_data - n_fitted)

    def weights_for(left: np.ndarray) -> noise.LineMatrix:
        density, _ = noise.residual_density(left, powers, experiment.group, kind)
        return density.scaled(inflation).inverse()

    alone = residuals
    weights = weights_for(residuals)
    if n_fitted < len(candidates.names):
        alone = residuals - J @ _step(*form.equations(sensitivity, residuals, weights))
        weights = weights_for(alone)
    weighted = weights.times(residuals[:, :, None])[:, :, 0]
    left = 2.0 * np.real(np.sum(residuals.conj() * weighted, axis=1))
    comb = comb_of_lines(experiment.omega.size)
    lines: _FrequencySums
    if experiment.edges_s:
        J = _freed(J, edges_of(model, response, theta), weights)
        lines = _WrittenOut(J, residuals)
        density = noise.smoothed_density(alone, experiment.group, n_groups)
        middle, _ = lines.equations(density.between(weights))
    else:
        lines = _Factored(form, sensitivity, residuals)
        middle = score_covariance(FinalLines(form, sensitivity, alone, weights))
    pulled = weights.times(alone[:, :, None])[:, :, 0]
    scores = np.real(np.matmul(pulled.conj()[:, None, :], J)[:, 0])
    N, g = lines.equations(weights)
    found = None
    if parts:
        sums = [
            lines.equations(_only(weights, comb == number)) for number in range(int(comb.max()) + 1)
        ]
        information = 2.0 * np.stack([n for n, _ in sums])
        gradient = 2.0 * np.stack([one for _, one in sums])
        rest = np.bincount(comb, weights=left)
        found = Parts(
            information,
            gradient + information @ theta,
            rest + 2.0 * gradient @ theta + np.einsum("bij,i,j->b", information, theta, theta),
        )
    return Evidence(
        names=candidates.names,
        information=2.0 * N,
        moment=2.0 * (g + N @ theta),
        scatter=2.0 * inflation * np.stack([middle, 2.0 * scores.T @ scores]),
        total=float(left.sum() + 4.0 * (g @ theta) + 2.0 * (theta @ N @ theta)),
        n_data=float(n_data),
        parts=found,
    )


def _step(
    N: Float[np.ndarray, "n_theta n_theta"], g: Float[np.ndarray, " n_theta"]
) -> Float[np.ndarray, " n_theta"]:
    """One step of all candidates, those that say the same sharing it."""
    size = np.sqrt(np.maximum(np.diag(N), np.finfo(float).tiny))
    scaled = N / np.outer(size, size) + 1e-9 * np.eye(g.size)
    return np.linalg.solve(scaled, g / size) / size


class _FrequencySums(Protocol):
    """Sums over lines that the evidence is made of."""

    def equations(self, weights: noise.LineMatrix) -> tuple[np.ndarray, np.ndarray]:
        """Re sum J^H W J and Re sum J^H W nu."""
        ...


@dataclass(frozen=True, slots=True)
class _Factored:
    """In the Kronecker form."""

    form: NormalForm
    sensitivity: Sensitivity
    residuals: np.ndarray

    def equations(self, weights: noise.LineMatrix) -> tuple[np.ndarray, np.ndarray]:
        return self.form.equations(self.sensitivity, self.residuals, weights)


@dataclass(frozen=True, slots=True)
class _WrittenOut:
    """With the sensitivities of every output and line, for what the Kronecker form cannot do."""

    jacobian: np.ndarray
    residuals: np.ndarray

    def equations(self, weights: noise.LineMatrix) -> tuple[np.ndarray, np.ndarray]:
        p = self.jacobian.shape[2]
        weighted = weights.times(self.jacobian).reshape(-1, p).conj().T
        N = np.real(weighted @ self.jacobian.reshape(-1, p))
        return 0.5 * (N + N.T), np.real(weighted @ self.residuals.ravel())


def _freed(
    J: Complex[np.ndarray, "n_omega n_y n_theta"],
    E: Complex[np.ndarray, "n_omega n_y n_edge_states"],
    weights: noise.LineMatrix,
) -> Complex[np.ndarray, "n_omega n_y n_theta"]:
    """Sensitivities without what unknown states at the edges of the record could do instead."""
    k = E.shape[2]
    if k == 0:
        return J
    weighted = weights.times(E).reshape(-1, k).conj().T
    normal = np.real(weighted @ E.reshape(-1, k))
    size = np.sqrt(np.maximum(np.diag(normal), np.finfo(float).tiny))
    cross = np.real(weighted @ J.reshape(-1, J.shape[2])) / size[:, None]
    share = np.linalg.solve(normal / np.outer(size, size) + 1e-12 * np.eye(k), cross)
    return J - E @ (share / size[:, None])


def reduced(
    candidates: Parameters,
    kept: Bool[np.ndarray, " n_theta"],
    theta: Float[np.ndarray, " n_theta"],
) -> Parameters:
    """The parameters of a model that has only some of the candidates, started at theta."""
    n = candidates.rows.size
    table = candidates.table(np.where(kept, theta, 0.0))
    inside = np.flatnonzero(kept)
    return replace(
        candidates,
        names=tuple(candidates.names[i] for i in inside),
        start=theta[inside],
        base=table,
        rows=candidates.rows[kept[:n]],
        columns=candidates.columns[kept[:n]],
        extras=tuple(e for e, k in zip(candidates.extras, kept[n:], strict=True) if k),
    )


def _only(weights: noise.LineMatrix, lines: Bool[np.ndarray, " n_omega"]) -> noise.LineMatrix:
    """Weights that leave out the other lines."""
    blocks = weights.blocks[weights.block]
    blocks[~lines] = 0.0
    return noise.LineMatrix(blocks, np.arange(lines.size))
