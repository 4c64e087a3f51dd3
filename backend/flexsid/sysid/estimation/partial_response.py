"""Frequency responses to one input, with those to the other inputs removed by a model."""

from __future__ import annotations

import numpy as np

from flexsid.sysid.estimation.experiment import Experiment
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.signals import FrequencyResponse
from flexsid.sysid.spectra.residual_spectrum import estimate_noise_level


def estimate_partial_responses(
    experiment: Experiment, derivatives: DerivativeTable, n_free: int
) -> FrequencyResponse:
    """Estimate the responses of the bare airframe at every frequency of a part of a maneuver.

    Parameters
    ----------
    experiment
        Spectra without free motion from the ends of the record, and the model.
    derivatives
        Of the model.
    n_free
        Real parameters that were fitted to the spectra.

    Returns
    -------
    FrequencyResponse
        Of all outputs to all inputs, instruments removed, with standard deviations.
        [output unit / rad]

    Notes
    -----
    With the model G, the spectra Z of the outputs and U of the inputs, and the residual
    E = Z - G U, the response to input j is

        G_j + E / U_j = (Z - sum_{k != j} G_k U_k) / U_j,

    the partial residuals of regression (Larsen and McCleary, Technometrics 14, 1972): a part of a
    maneuver does not resolve the harmonics of the inputs, so that their responses are not
    separated by frequency alone. What the model does not explain is in the responses of all
    inputs. The standard deviation is that of the noise: the level of the residuals at
    neighbouring frequencies over |U_j|, with the degrees of freedom of the fit.
    """
    model = experiment.model
    responses = model.response(derivatives, experiment.omega)
    outputs = experiment.measured / experiment.instruments
    residual = outputs - np.einsum("mij,mj->mi", responses, experiment.inputs)
    n_real = 2 * residual.size
    (level,) = estimate_noise_level([experiment.omega], [np.abs(residual) ** 2], [experiment.omega])
    noise = np.sqrt(level * n_real / max(1, n_real - n_free))
    with np.errstate(divide="ignore", invalid="ignore"):
        values = responses + residual[:, :, None] / experiment.inputs[:, None, :]
        std = noise[:, :, None] / np.abs(experiment.inputs)[:, None, :]
    return FrequencyResponse(experiment.omega, values, model.outputs, model.inputs, std)
