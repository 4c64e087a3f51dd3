"""Share of their prior variances that data would remove from parameters, before any fit."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float
from scipy import linalg

from flexsid.sysid.estimation.experiment import Experiment
from flexsid.sysid.estimation.frequency_domain_model import FrequencyDomainModel
from flexsid.sysid.estimation.kronecker import NormalForm
from flexsid.sysid.estimation.noise import SpectralMatrix
from flexsid.sysid.estimation.parameters import Parameters


def compute_determined_shares(
    experiments: Sequence[Experiment],
    noise_std: Sequence[Float[np.ndarray, " n_y"]],
    parameters: Parameters,
    prior_std: Float[np.ndarray, " n_theta"],
) -> Float[np.ndarray, " n_theta"]:
    """Compute the share of the prior variance of every parameter that data are expected to remove.

    Parameters
    ----------
    experiments
        Output error of each maneuver, with the inputs as they were flown.
    noise_std
        Standard deviations of the outputs' spectra at each maneuver; infinite for outputs that
        are not used. [output unit * s]
    parameters
        Their starting values are those of the prediction.
    prior_std
        Standard deviations of the prior of all parameters.

    Returns
    -------
    ndarray, (n_theta,)
        One where the data determine a parameter, zero where only its prior does.

    Notes
    -----
    With the information 2 N of the data at the prediction and the prior variances D^2 the share is
    1 - diag[(I + D 2 N D)^-1]: a half where the expected standard error from data alone equals that
    of the prior. Their sum is the number of parameters that the data determine.
    Source: MacKay, Bayesian interpolation, Neural Computation 4 (1992), eq. 4.9.
    """
    information = np.zeros((prior_std.size,) * 2)
    for experiment, std in zip(experiments, noise_std, strict=True):
        model = FrequencyDomainModel(experiment, parameters)
        sensitivity = model.sensitivity(parameters.start, model.respond(parameters.start))
        weights = SpectralMatrix(1.0 / std[None] ** 2, np.zeros(experiment.omega.size, dtype=int))
        information += 2.0 * NormalForm(model).matrix(sensitivity, weights)
    whole = np.eye(prior_std.size) + information * np.outer(prior_std, prior_std)
    factor = linalg.cho_factor(whole)
    return 1.0 - np.diag(linalg.cho_solve(factor, np.eye(prior_std.size)))
