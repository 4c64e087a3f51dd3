"""Errors of an estimate due to quantities that are assumed: mass, inertia, airspeed, density.

Nondimensional derivatives are those of the assumed mass and condition: with a mass that is 2 %
too large all force derivatives are, and the data agree as well. Errors of assumed values are
therefore no parameters of the fit; their effect is added to its standard errors.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from jaxtyping import Float

from flexsid.sysid.adequacy.model_tests import evaluate_fit, invert_information
from flexsid.sysid.estimation.experiment import Experiment, Parameters
from flexsid.sysid.estimation.frequency_domain_model import FrequencyDomainModel
from flexsid.sysid.estimation.likelihood import build_prior
from flexsid.sysid.model.aeroelastic import AeroelasticModel


def compute_changes_by_assumptions(
    experiments: Sequence[Experiment],
    parameters: Parameters,
    theta: Float[np.ndarray, " n_theta"],
    priors: Mapping[str, tuple[float, float]],
    wrong_models: Sequence[Mapping[str, AeroelasticModel]],
) -> dict[str, Float[np.ndarray, " n_theta"]]:
    """Compute the change of an estimate with each assumed quantity, to first order.

    Parameters
    ----------
    experiments, parameters
        Data of output error, and the free parameters.
    theta, priors
        Estimate, and mean and standard deviation by parameter.
    wrong_models
        Of every experiment, the model with one quantity larger by its standard deviation, by cause.

    Returns
    -------
    dict
        Change of all parameters by cause; the causes are independent.

    Notes
    -----
    An estimator that takes c as exact has theta(c) with d theta/dc = -N^-1 Re sum J^H W dy/dc,
    N = Re sum J^H W J + P: the delta method. Where a change of c is one of the derivatives, it
    depends on no weights: C_Z is proportional to mass, C_m to inertia, all are to 1/density. Of
    airspeed, sensors disagree if it is wrong, and W, from the residuals, shares it out.
    """
    causes = list(dict.fromkeys(cause for models in wrong_models for cause in models))
    if not causes:
        return {}
    n_data = sum(2 * one.measured.size for one in experiments)
    inflation = n_data / max(n_data - theta.size, 1)
    _, information = build_prior(parameters, priors)
    N, pull = information, np.zeros((theta.size, len(causes)))
    for experiment, models in zip(experiments, wrong_models, strict=True):
        final, response = evaluate_fit(experiment, parameters, theta, inflation)
        N = N + final.form.matrix(final.sensitivity, final.weights)
        changes = np.zeros((*experiment.measured.shape, len(causes)), dtype=complex)
        for number, cause in enumerate(causes):
            if cause in models:
                wrong = replace(experiment, model=models[cause])
                moved = FrequencyDomainModel(wrong, parameters).respond(theta).outputs
                changes[:, :, number] = moved - response.outputs
        pull += final.form.cross(final.sensitivity, changes, final.weights)
    return dict(zip(causes, -(invert_information(N) @ pull).T, strict=True))
