"""Evidence of output error and frequency response error around a maximum of likelihood."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
from jaxtyping import Bool, Complex, Float

from flexsid.sysid.estimation import noise
from flexsid.sysid.estimation.covariance import FinalSpectra, score_covariance
from flexsid.sysid.estimation.experiment import Experiment
from flexsid.sysid.estimation.frequency_domain_model import FrequencyDomainModel
from flexsid.sysid.estimation.kronecker import NormalForm
from flexsid.sysid.estimation.leakage import build_leakage_columns
from flexsid.sysid.estimation.parameters import Parameters
from flexsid.sysid.structure_determination.equation import assign_combs
from flexsid.sysid.structure_determination.evidence import Evidence, Parts

_STEP_RIDGE = 1e-9  # of a term's information: a step of collinear candidates stays finite
_LEAKAGE_RIDGE = 1e-12  # of a column's power: nearly dependent leakage columns stay solvable


def compute_likelihood_evidence(
    experiment: Experiment,
    candidates: Parameters,
    theta: Float[np.ndarray, " n_theta"],
    n_fitted: int,
    *,
    kind: str = "diagonal",
    parts: bool = False,
) -> Evidence:
    """Compute the evidence of one maneuver on all candidates, expanded around an estimate.

    Parameters
    ----------
    candidates
        All terms and extras that could be free.
    theta, n_fitted
        The estimate, zero for terms that are not in the model, and how many were fitted.
    kind
        Of the noise, as in the fit.
    parts
        Whether to compute the sums over combs of frequencies for the bootstrap.

    Notes
    -----
    Around the estimate the residuals are linear in the terms. For those in the model
    the quadratic gives Wald's test, for those that are not it gives Rao's score test,
    for the gradient of a derivative at zero costs no more than that of one in the model
    (Kronecker form): all single changes of a model come from one expansion. Both are
    tested against the residuals after a step of all candidates, so that terms that are not
    in the model yet do not count as noise.
    """
    model = FrequencyDomainModel(experiment, candidates)
    form = NormalForm(model)
    response = model.respond(theta)
    residuals = experiment.measured - response.outputs
    n_groups = len(experiment.group_names)
    powers = noise.compute_group_powers(experiment.measured, experiment.group, n_groups)
    sensitivity = model.sensitivity(theta, response)
    J = model.jacobian(sensitivity)
    n_data = 2 * residuals.size
    inflation = n_data / (n_data - n_fitted)

    def weights_for(left: np.ndarray) -> noise.SpectralMatrix:
        density, _ = noise.compute_residual_density(left, powers, experiment.group, kind)
        return density.scaled(inflation).inverse()

    alone = residuals
    weights = weights_for(residuals)
    if n_fitted < len(candidates.names):
        N, g = form.equations(sensitivity, residuals, weights)
        alone = residuals - J @ _solve_scaled(N, g, _STEP_RIDGE)
        weights = weights_for(alone)
    weighted = weights.times(residuals[:, :, None])[:, :, 0]
    left = 2.0 * np.real(np.sum(residuals.conj() * weighted, axis=1))
    comb = assign_combs(experiment.omega.size)
    if experiment.edges_s:
        J = _project_leakage(J, build_leakage_columns(model, response, theta), weights)
        sum_equations = partial(_sum_equations, J, residuals)
        density = noise.smooth_density(alone, experiment.group, n_groups)
        middle, _ = sum_equations(density.between(weights))
    else:
        sum_equations = partial(form.equations, sensitivity, residuals)
        middle = score_covariance(FinalSpectra(form, sensitivity, alone, weights))
    pulled = weights.times(alone[:, :, None])[:, :, 0]
    scores = np.real(np.matmul(pulled.conj()[:, None, :], J)[:, 0])
    N, g = sum_equations(weights)
    found = None
    if parts:
        sums = [
            sum_equations(_restrict_weights(weights, comb == number))
            for number in range(int(comb.max()) + 1)
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


def _solve_scaled(
    N: Float[np.ndarray, "n n"], right: Float[np.ndarray, "n *m"], ridge: float
) -> Float[np.ndarray, "n *m"]:
    """Solve normal equations scaled to a unit diagonal, with a ridge for collinear terms."""
    size = np.sqrt(np.maximum(np.diag(N), np.finfo(float).tiny))
    scaled = N / np.outer(size, size) + ridge * np.eye(size.size)
    return (np.linalg.solve(scaled, (right.T / size).T).T / size).T


def _sum_equations(
    J: Complex[np.ndarray, "n_omega n_y n_theta"],
    residuals: Complex[np.ndarray, "n_omega n_y"],
    weights: noise.SpectralMatrix,
) -> tuple[np.ndarray, np.ndarray]:
    """Re sum J^H W J and Re sum J^H W nu, where corrected leakage forbids the Kronecker form."""
    p = J.shape[2]
    weighted = weights.times(J).reshape(-1, p).conj().T
    N = np.real(weighted @ J.reshape(-1, p))
    return 0.5 * (N + N.T), np.real(weighted @ residuals.ravel())


def _project_leakage(
    J: Complex[np.ndarray, "n_omega n_y n_theta"],
    E: Complex[np.ndarray, "n_omega n_y n_edge_states"],
    weights: noise.SpectralMatrix,
) -> Complex[np.ndarray, "n_omega n_y n_theta"]:
    """Sensitivities projected onto the complement of the leakage columns."""
    k = E.shape[2]
    if k == 0:
        return J
    weighted = weights.times(E).reshape(-1, k).conj().T
    cross = np.real(weighted @ J.reshape(-1, J.shape[2]))
    return J - E @ _solve_scaled(np.real(weighted @ E.reshape(-1, k)), cross, _LEAKAGE_RIDGE)


def select_candidates(
    candidates: Parameters,
    selected: Bool[np.ndarray, " n_theta"],
    theta: Float[np.ndarray, " n_theta"],
) -> Parameters:
    """Select the parameters of a model with some of the candidates, started at theta."""
    n = candidates.rows.size
    table = candidates.table(np.where(selected, theta, 0.0))
    inside = np.flatnonzero(selected)
    return replace(
        candidates,
        names=tuple(candidates.names[i] for i in inside),
        start=theta[inside],
        base=table,
        rows=candidates.rows[selected[:n]],
        columns=candidates.columns[selected[:n]],
        extras=tuple(e for e, k in zip(candidates.extras, selected[n:], strict=True) if k),
    )


def expand_values(
    selected: Bool[np.ndarray, " n_theta"], values: Float[np.ndarray, " n_selected"]
) -> Float[np.ndarray, " n_theta"]:
    """Values of the selected terms at their place among all candidates, zero elsewhere."""
    theta = np.zeros(selected.size)
    theta[selected] = values
    return theta


def _restrict_weights(
    weights: noise.SpectralMatrix, selected: Bool[np.ndarray, " n_omega"]
) -> noise.SpectralMatrix:
    """Weights with the other frequencies set to zero."""
    blocks = weights.blocks[weights.block]
    blocks[~selected] = 0.0
    return noise.SpectralMatrix(blocks, np.arange(selected.size))
