"""Frequency response error: measured against modelled responses (Eq. 21)."""

from __future__ import annotations

import numpy as np

from flexsid.sysid.estimation.experiment import Experiment
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.signals import FrequencyResponse, check_signal


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
    Source: Eqs 21-22. A column is the outputs per unit deflection of one input, so each
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
