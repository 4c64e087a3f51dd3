"""Variance budget of a run: what the standard error of each result consists of.

Another flight of the same aircraft has other noise, but the same prediction, modal table, mass
and errors of instruments: noise is what estimates scatter by, all causes are what they may differ
from the truth by.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from jaxtyping import Float

from flexsid.records.run import Method, VarianceShares
from flexsid.sysid.adequacy.assumed_values import compute_changes_by_assumptions
from flexsid.sysid.estimation.estimate import Estimate
from flexsid.sysid.estimation.experiment import Parameters
from flexsid.sysid.estimation.nuisance import compute_prior_shares
from flexsid.workflow.fits.estimation_task import EstimationTask, build_experiments
from flexsid.workflow.fits.model_adequacy import build_record_experiments, fits_some_inputs

_CONDITION = ("airspeed", "density")


def compute_variance_budget(
    task: EstimationTask,
    parameters: Parameters,
    estimate: Estimate,
    overlap: float,
) -> tuple[dict[str, float], dict[str, VarianceShares]]:
    """Compute the errors due to mass and condition, and the shares of all causes.

    Parameters
    ----------
    task, parameters, estimate
        The fit of all parameters; its variances are multiplied by ``overlap`` already.

    Returns
    -------
    condition_std, shares
        By result: the standard deviation due to mass, inertia, airspeed and density, which the
        covariance does not include, and the shares of the whole variance. Nothing without an
        optimum.
    """
    if not estimate.outcome.is_optimum:
        return {}, {}
    own = [name for name in estimate.names if name not in estimate.nuisance]
    changes = _compute_changes(task, parameters, estimate)
    place = [estimate.names.index(name) for name in own]
    of_condition = _sum_squares([c[place] for n, c in changes.items() if n in _CONDITION], own)
    of_mass = _sum_squares([c[place] for n, c in changes.items() if n not in _CONDITION], own)
    known = [name for name in estimate.names if name in task.marginalised]
    selected = estimate.select([*own, *known])  # end states have no prior
    priors = task.list_priors()
    of_priors = compute_prior_shares(selected, priors, overlap)
    held = [name for name in selected.names if name in priors]
    is_shape = np.array([name in task.shape_errors for name in held], dtype=bool)
    variances = np.diag(estimate.corrected_covariance)[place]
    of_table = np.array([task.modal_std.get(name, 0.0) ** 2 for name in own])
    whole = variances + of_table + of_mass + of_condition
    shares = {}
    for k, name in enumerate(own):
        shapes, prediction = of_priors[k, is_shape].sum(), of_priors[k, ~is_shape].sum()
        parts = variances[k] * np.array([max(1.0 - shapes - prediction, 0.0), prediction, shapes])
        parts = np.array([*parts, of_table[k], of_mass[k], of_condition[k]]) / whole[k]
        if np.isfinite(parts).all():
            shares[name] = VarianceShares(**dict(zip(_CAUSES, parts.tolist(), strict=True)))
    std = np.sqrt(of_mass + of_condition)
    return {name: float(s) for name, s in zip(own, std, strict=True) if s > 0.0}, shares


_CAUSES = ("noise", "prediction", "mode_shapes", "modal_table", "mass", "condition")


def _compute_changes(
    task: EstimationTask, parameters: Parameters, estimate: Estimate
) -> Mapping[str, Float[np.ndarray, " n_theta"]]:
    """Compute the changes with mass and condition by output error, whatever the estimator."""
    wrong_models = [data.wrong_models for data in task.maneuvers]
    if not any(wrong_models):
        return {}
    if fits_some_inputs(task):
        experiments = build_experiments(task, Method.FRE)
    else:
        experiments = build_record_experiments(task, parameters, estimate)
    try:
        return compute_changes_by_assumptions(
            experiments, parameters, estimate.values, task.list_priors(), wrong_models
        )
    except np.linalg.LinAlgError:  # no information: neither are there standard errors
        return {}


def _sum_squares(changes: list[np.ndarray], own: list[str]) -> Float[np.ndarray, " n_own"]:
    return np.sum([change**2 for change in changes], axis=0) if changes else np.zeros(len(own))
