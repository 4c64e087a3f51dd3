"""Output error: measured outputs against those of the model driven by measured inputs (Eq. 18)."""

from __future__ import annotations

import numpy as np

from flexsid.sysid.estimation.experiment import Experiment
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.signals import FrequencyData, check_signal


def output_error(
    model: AeroelasticModel,
    inputs: FrequencyData,
    outputs: FrequencyData,
    instruments: np.ndarray,
    name: str = "OE",
    edges_s: tuple[float, ...] = (),
    window_s: tuple[float, float] | None = None,
    *,
    free_ends: bool = False,
) -> Experiment:
    """Set up output error for one maneuver.

    Parameters
    ----------
    model
        Condition, modes, inputs and sensors.
    inputs
        Surface deflections, instrument dynamics removed. [rad s]
    outputs
        Sensor spectra as recorded, whole maneuver. [output unit * s]
    instruments
        Recorded over true response of every output, (n_omega, n_y). [1]
    name
        Name of the maneuver.
    edges_s
        Times at which the record begins or ends and the aircraft may move. [s]
    window_s
        Begin and end of the transformed record; None for independent frequencies. [s]
    free_ends
        Whether nothing was assumed of the motion at the ends.

    Raises
    ------
    BadInput
        If an output has no signal, or a spectrum is not finite.

    Notes
    -----
    Source: Eqs 18-20; Grauer and Boucher, Aerospace 6 (2019) 24, doi:10.3390/aerospace6020024;
    Klein and Morelli, Aircraft System Identification, doi:10.2514/4.861505, ch. 7.
    """
    u = inputs.pick(model.inputs).values
    z = outputs.pick(model.outputs).values
    check_signal(u, model.inputs)
    check_signal(z, model.outputs)
    check_signal(np.asarray(instruments), model.outputs)
    return Experiment(
        name=name,
        model=model,
        instruments=np.asarray(instruments, dtype=complex),
        omega=outputs.omega,
        inputs=u,
        measured=z,
        group=np.zeros(outputs.omega.size, dtype=int),
        group_names=(name,),
        edges_s=edges_s,
        window_s=window_s,
        free_ends=free_ends,
    )
