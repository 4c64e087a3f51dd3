"""Frequency responses of a maneuver: bare airframe, instruments removed, as measured."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.maneuver import Maneuver
from flexsid.records.views import Bode, Response
from flexsid.storage.store import Store
from flexsid.sysid.signals import FrequencyResponse
from flexsid.workflow.identified import identified_responses
from flexsid.workflow.measured import measure
from flexsid.workflow.models import define_outputs
from flexsid.workflow.views.channels import input_names, sampling
from flexsid.workflow.views.modes import mode_markers

_GRID = 400  # points of a model's curve
_MARGIN = 1.1  # modes a little outside the lines still explain what is seen


def bode(
    store: Store,
    maneuver_id: int,
    outputs: Sequence[str],
    inputs: Sequence[str] = (),
    run_ids: Sequence[int] = (),
) -> Bode:
    """Read responses of outputs to inputs; to all that were excited by default.

    Models of runs come beside them where the run has the output and the input.

    Raises
    ------
    BadInput
        If an input was not excited, or the excitation is not known.
    """
    maneuver = store.maneuvers.get(maneuver_id)
    columns = measured_responses(store, maneuver, tuple(dict.fromkeys(outputs)))
    known = input_names(store, maneuver)
    chosen = tuple(dict.fromkeys(inputs)) or tuple(name for name in known if name in columns)
    unknown = [name for name in chosen if name not in columns]
    if unknown:
        raise BadInput(
            f"'{unknown[0]}' was not excited in this maneuver; excited were {', '.join(columns)}",
            code="not-excited",
            input=unknown[0],
        )
    units = {
        name: unit for name, (_, unit) in sampling(store, maneuver, [*outputs, *chosen]).items()
    }
    pairs = [(output, input_) for output in dict.fromkeys(outputs) for input_ in chosen]
    measured = tuple(_response(columns[input_], output, units) for output, input_ in pairs)
    low = min(response.frequency_hz[0] for response in measured)
    high = max(response.frequency_hz[-1] for response in measured)
    return Bode(
        maneuver_id=maneuver_id,
        inputs=known,
        measured=measured,
        models=tuple(
            model
            for run_id in dict.fromkeys(run_ids)
            for model in _models(store, run_id, pairs, measured, units)
        ),
        modes=mode_markers(store, maneuver, (low / _MARGIN, high * _MARGIN)),
    )


def measured_responses(
    store: Store, maneuver: Maneuver, outputs: tuple[str, ...]
) -> dict[str, FrequencyResponse]:
    """Responses to every excited input at its own lines.

    Raises
    ------
    BadInput
        If the excitation is not known.
    """
    if maneuver.excitation is None:
        raise BadInput(
            f"the excitation of maneuver {maneuver.id} is not known; frequency responses need "
            "to know which input owns which line",
            code="no-excitation",
        )
    aircraft = store.aircraft.get(maneuver.aircraft_id)
    inputs = tuple(maneuver.excitation.harmonics)
    return measure(store, maneuver, aircraft, inputs, define_outputs(aircraft, outputs)).responses()


def _models(
    store: Store,
    run_id: int,
    pairs: Sequence[tuple[str, str]],
    measured: Sequence[Response],
    units: dict[str, str],
) -> list[Response]:
    """Responses of an identified model on a fine grid over the measured lines."""
    run = store.runs.get(run_id)
    low = min(response.frequency_hz[0] for response in measured)
    high = max(response.frequency_hz[-1] for response in measured)
    omega = 2.0 * np.pi * np.geomspace(low, high, _GRID)
    identified = identified_responses(store, run, omega)
    label = f"{run.method.value} {run_id}"
    return [
        _beside(_response(identified, output, units, input_), data, run_id, label)
        for (output, input_), data in zip(pairs, measured, strict=True)
        if output in identified.outputs and input_ in identified.inputs
    ]


def _beside(model: Response, data: Response, run_id: int, label: str) -> Response:
    """Move a phase by whole turns to where the measured one is."""
    at_lines = np.interp(data.frequency_hz, model.frequency_hz, model.phase_rad)
    turns = np.round(np.median(data.phase_rad - at_lines) / (2.0 * np.pi))
    phase = model.phase_rad + 2.0 * np.pi * turns
    return replace(model, phase_rad=phase, run_id=run_id, label=label)


def _response(
    column: FrequencyResponse, output: str, units: dict[str, str], input_: str | None = None
) -> Response:
    name = column.inputs[0] if input_ is None else input_
    values = column.values[:, column.outputs.index(output), column.inputs.index(name)]
    return Response(
        output=output,
        input=name,
        output_unit=units[output],
        input_unit=units[name],
        frequency_hz=column.omega / (2.0 * np.pi),
        magnitude=np.abs(values),
        phase_rad=np.unwrap(np.angle(values)),
    )
