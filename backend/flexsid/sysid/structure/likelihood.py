"""Evidence of output error and frequency response error around a maximum of likelihood."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from jaxtyping import Bool, Float

from flexsid.sysid.estimation import noise
from flexsid.sysid.estimation.covariance import FinalLines, score_covariance
from flexsid.sysid.estimation.experiment import Experiment
from flexsid.sysid.estimation.kronecker import NormalForm
from flexsid.sysid.estimation.line_model import LineModel
from flexsid.sysid.estimation.parameters import Parameters
from flexsid.sysid.structure.equation import comb_of_lines
from flexsid.sysid.structure.evidence import Evidence, Parts


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
    (Kronecker form): all single changes of a model come from one expansion.
    """
    model = LineModel(experiment, candidates)
    form = NormalForm(model)
    response = model.respond(theta)
    residuals = experiment.measured - response.outputs
    n_groups = len(experiment.group_names)
    powers = noise.group_powers(experiment.measured, experiment.group, n_groups)
    density, _ = noise.residual_density(residuals, powers, experiment.group, kind)
    n_data = 2 * residuals.size
    inflation = n_data / (n_data - n_fitted)
    weights = density.scaled(inflation).inverse()
    sensitivity = model.sensitivity(theta, response)
    N, g = form.equations(sensitivity, residuals, weights)
    scatter = inflation * score_covariance(FinalLines(form, sensitivity, residuals, weights, theta))
    weighted = weights.times(residuals[:, :, None])[:, :, 0]
    left = 2.0 * np.real(np.sum(residuals.conj() * weighted, axis=1))

    found = None
    if parts:
        comb = comb_of_lines(experiment.omega.size)
        sums = [
            form.equations(sensitivity, residuals, _only(weights, comb == number))
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
        scatter=2.0 * scatter,
        total=float(left.sum() + 4.0 * (g @ theta) + 2.0 * (theta @ N @ theta)),
        n_data=float(n_data),
        parts=found,
    )


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
