"""Frequency responses while the aircraft flies, with those of the latest estimate."""

from __future__ import annotations

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.live import LiveResponses
from flexsid.records.views import Bode, Response
from flexsid.sysid.estimation.partial_response import estimate_partial_responses
from flexsid.sysid.spectra.reliability import WORST_RELATIVE_STD, relative_std
from flexsid.units import si_unit
from flexsid.workflow.live.live_fit import LiveFit

_GRID = 200  # points of the curve of the model


def compute_live_responses(fit: LiveFit, time_s: float) -> LiveResponses | None:
    """Compute the responses of all outputs to all inputs; None before the first estimate.

    Parameters
    ----------
    fit
        Fit of the record so far.
    time_s
        End of the record, by the recorder. [s]
    """
    result = fit.result
    if result is None:
        return None
    experiment, derivatives, task = result.experiment, result.derivatives, result.task
    measured = estimate_partial_responses(experiment, derivatives, result.n_free)
    relative = relative_std(measured)
    assert relative is not None
    omega = np.geomspace(experiment.omega[0], experiment.omega[-1], _GRID)
    curves = experiment.model.response(derivatives, omega)
    units = {channel.name: si_unit(channel.unit) for channel in task.header.channels}
    outputs = {output.name: units[output.terms[0][0].name] for output in task.outputs}
    return LiveResponses(
        time_s=time_s,
        outputs=measured.outputs,
        inputs=measured.inputs,
        units={name: (units | outputs)[name] for name in (*measured.outputs, *measured.inputs)},
        frequency_hz=measured.omega / (2.0 * np.pi),
        measured=measured.values,
        relative_std=relative,
        model_frequency_hz=omega / (2.0 * np.pi),
        model=curves,
    )


def build_live_bode(responses: LiveResponses, output: str, input_: str) -> Bode:
    """Build the Bode plot of one output and input; unreliable points are omitted.

    Raises
    ------
    BadInput
        If there is no such output or input.
    """
    for name, known, kind in (
        (output, responses.outputs, "output"),
        (input_, responses.inputs, "input"),
    ):
        if name not in known:
            raise BadInput(
                f"the stream has no {kind} '{name}'; it has {', '.join(known)}",
                code="unknown-channel",
                channel=name,
            )
    place = (slice(None), responses.outputs.index(output), responses.inputs.index(input_))
    output_unit, input_unit = responses.units[output], responses.units[input_]
    curve = responses.model[place]
    model = Response(
        output=output,
        input=input_,
        output_unit=output_unit,
        input_unit=input_unit,
        frequency_hz=responses.model_frequency_hz,
        magnitude=np.abs(curve),
        phase_rad=np.unwrap(np.angle(curve)),
        label=f"estimate at {responses.time_s:.0f} s",
        is_model=True,
    )
    reliable = responses.relative_std[place] <= WORST_RELATIVE_STD
    frequency_hz, values = responses.frequency_hz[reliable], responses.measured[place][reliable]
    # Noise can move a phase by a turn: that nearest to the model is shown.
    expected = np.interp(frequency_hz, model.frequency_hz, model.phase_rad)
    turns = np.round((expected - np.angle(values)) / (2.0 * np.pi))
    measured = Response(
        output=output,
        input=input_,
        output_unit=output_unit,
        input_unit=input_unit,
        frequency_hz=frequency_hz,
        magnitude=np.abs(values),
        phase_rad=np.angle(values) + 2.0 * np.pi * turns,
        # Half of the complex error lies along the response, half across it.
        relative_std=responses.relative_std[place][reliable] / np.sqrt(2.0),
    )
    return Bode(
        maneuver_id=0, inputs=responses.inputs, measured=(measured,), models=(model,), modes=()
    )
