"""Standard errors due to noise on the measured inputs."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from jaxtyping import Float

from flexsid.sysid.estimation import noise
from flexsid.sysid.estimation.estimate import Estimate
from flexsid.sysid.estimation.experiment import Experiment
from flexsid.sysid.estimation.frequency_domain_model import FrequencyDomainModel
from flexsid.sysid.estimation.kronecker import NormalForm
from flexsid.sysid.estimation.parameters import Parameters


def compute_input_noise_errors(
    experiment: Experiment,
    parameters: Parameters,
    estimate: Estimate,
    input_noise: Float[np.ndarray, "n_omega n_u"],
    priors: Mapping[str, tuple[float, float]] | None = None,
) -> Float[np.ndarray, " n_theta"]:
    """Compute the standard errors due to input noise alone in an output-error estimate.

    Parameters
    ----------
    experiment, parameters, estimate
        A finished fit.
    input_noise
        Variance of the spectrum of each deflection at each frequency. [(rad s)^2]
    priors
        Mean and standard deviation of the parameters with prior knowledge in the fit.

    Notes
    -----
    Noise n on the inputs causes residuals -H n, fully correlated between the outputs. The
    corrected covariance includes it, as part of the residuals; this is its share.
    """
    model = FrequencyDomainModel(experiment, parameters)
    response = model.respond(estimate.values)
    sensitivity = model.sensitivity(estimate.values, response)
    residuals = experiment.measured - response.outputs
    powers = noise.compute_group_powers(
        experiment.measured, experiment.group, len(experiment.group_names)
    )
    density, _ = noise.compute_residual_density(residuals, powers, experiment.group, "diagonal")
    W = density.inverse()
    form = NormalForm(model)
    information, _ = form.equations(sensitivity, residuals, W)
    known = priors or {}
    information += 0.5 * np.diag(
        [known[n][1] ** -2.0 if n in known else 0.0 for n in estimate.names]
    )
    H = model.respond_to_inputs(estimate.values, response)
    spread = (H * input_noise[:, None, :]) @ H.conj().transpose(0, 2, 1)
    per_frequency = noise.SpectralMatrix(spread, np.arange(len(spread)))
    middle, _ = form.equations(sensitivity, residuals, per_frequency.between(W))
    scale = np.sqrt(np.maximum(np.diag(information), np.finfo(float).tiny))
    scaled = information / np.outer(scale, scale)
    half = np.linalg.lstsq(scaled, middle / np.outer(scale, scale), rcond=1e-13)[0]
    covariance = np.linalg.lstsq(scaled, half.T, rcond=1e-13)[0] / np.outer(scale, scale)
    return np.sqrt(np.maximum(0.5 * np.diag(covariance), 0.0))
