"""Frequency response error: measured against modelled responses to one input (Eq. 21)."""

from __future__ import annotations

import numpy as np

from flexsid.sysid.estimation.experiment import Experiment
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.signals import FrequencyResponse, check_signal
from flexsid.sysid.spectra.residual_spectrum import estimate_noise_level

# --- Frequency response error: measured against modelled responses (Eq. 21) -----------------------


def frequency_response_error(
    model: AeroelasticModel,
    responses: dict[str, FrequencyResponse],
    name: str = "FRE",
    source: Experiment | None = None,
) -> Experiment:
    """Set up frequency response error for one maneuver.

    Parameters
    ----------
    model
        Condition, modes, inputs and sensors.
    responses
        For each input its column of frequency responses at its own harmonics, (M_j, n_y, 1),
        instrument dynamics removed. Only these inputs are fitted.
    name
        Name of the maneuver.
    source
        Output error at the frequencies from which the responses were computed; with it,
        standard errors include the correlation of neighbouring responses.

    Notes
    -----
    Source: Eqs 21-22; Grauer and Boucher, Aircraft System Identification from Multisine Inputs
    and Frequency Responses, 2020, https://ntrs.nasa.gov/citations/20205003364.

    A column is the outputs per unit deflection of one input, so each
    of its harmonics is a data point of output error with a unit input; every column has
    its own noise covariance.
    """
    omega, inputs, measured, group = [], [], [], []
    for number, (column, response) in enumerate(responses.items()):
        unit = np.zeros((response.omega.size, len(model.inputs)), dtype=complex)
        unit[:, model.inputs.index(column)] = 1.0
        rows = [response.outputs.index(output) for output in model.outputs]
        values = response.values[:, rows, 0]
        check_signal(values, model.outputs)
        omega.append(response.omega)
        inputs.append(unit)
        measured.append(values)
        group.append(np.full(response.omega.size, number))
    omega_all = np.concatenate(omega)
    gains = [r.noise_gain for r in responses.values() if r.noise_gain is not None]
    shared = source is not None and len(gains) == len(responses)
    return Experiment(
        name=name,
        model=model,
        instruments=np.ones((omega_all.size, len(model.outputs)), dtype=complex),
        omega=omega_all,
        inputs=np.concatenate(inputs),
        measured=np.concatenate(measured),
        group=np.concatenate(group),
        group_names=tuple(responses),
        source=source if shared else None,
        gain=np.concatenate(gains) if shared else None,
    )


# --- Frequency responses to one input, with those to the other inputs removed by a model ----------


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
