"""Frequency responses of a maneuver: bare airframe, instruments removed, as measured."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.aircraft import Aircraft
from flexsid.records.maneuver import Maneuver, Role
from flexsid.records.views import Bode, Response
from flexsid.storage.store import Store
from flexsid.sysid.signals import FrequencyData, FrequencyResponse
from flexsid.sysid.spectra.response import bare_airframe_responses
from flexsid.workflow.models import define_outputs, input_correction, output_instrument
from flexsid.workflow.transforms import Lines, maneuver_lines, spectra_of
from flexsid.workflow.views.channels import input_names, sampling
from flexsid.workflow.views.modes import mode_markers

_MARGIN = 1.1  # modes a little outside the lines still explain what is seen


def bode(
    store: Store,
    maneuver_id: int,
    outputs: Sequence[str],
    inputs: Sequence[str] = (),
) -> Bode:
    """Read responses of outputs to inputs; to all that were excited by default.

    Raises
    ------
    BadInput
        If an input was not excited, or the excitation is not known.
    """
    maneuver = store.maneuvers.get(maneuver_id)
    columns = measured_responses(store, maneuver, tuple(dict.fromkeys(outputs)))
    chosen = tuple(dict.fromkeys(inputs)) or tuple(columns)
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
    measured = tuple(_response(columns[input_], row, units) for row in outputs for input_ in chosen)
    low = min(response.frequency_hz[0] for response in measured)
    high = max(response.frequency_hz[-1] for response in measured)
    return Bode(
        maneuver_id=maneuver_id,
        inputs=input_names(store, maneuver),
        measured=measured,
        models=(),
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
    lines = maneuver_lines(maneuver)
    sensed = spectra_of(store, maneuver, aircraft, outputs, lines)
    moved = spectra_of(store, maneuver, aircraft, lines.inputs, lines)
    true_inputs = _true_inputs(aircraft, moved)
    return bare_airframe_responses(
        true_inputs,
        _true_outputs(aircraft, sensed),
        _commands(store, maneuver, aircraft, lines) or true_inputs,
        lines.owner,
    )


def _true_inputs(aircraft: Aircraft, recorded: FrequencyData) -> FrequencyData:
    factors = [input_correction(aircraft, name, recorded.omega) for name in recorded.names]
    return FrequencyData(
        recorded.omega, recorded.values * np.stack(factors, axis=1), recorded.names
    )


def _true_outputs(aircraft: Aircraft, recorded: FrequencyData) -> FrequencyData:
    instruments = [
        output_instrument(aircraft, output).response(recorded.omega)
        for output in define_outputs(aircraft, recorded.names)
    ]
    return FrequencyData(
        recorded.omega, recorded.values / np.stack(instruments, axis=1), recorded.names
    )


def _commands(
    store: Store, maneuver: Maneuver, aircraft: Aircraft, lines: Lines
) -> FrequencyData | None:
    """Recorded excitation of every input, None where it was not recorded."""
    recorded = {c.name for c in store.channels.find(maneuver_id=maneuver.id, role=Role.COMMAND)}
    names = tuple(f"{name}_command" for name in lines.inputs)
    if not recorded.issuperset(names):
        return None
    data = spectra_of(store, maneuver, aircraft, names, lines)
    return FrequencyData(data.omega, data.values, lines.inputs)


def _response(column: FrequencyResponse, output: str, units: dict[str, str]) -> Response:
    (input_,) = column.inputs
    values = column.values[:, column.outputs.index(output), 0]
    return Response(
        output=output,
        input=input_,
        output_unit=units[output],
        input_unit=units[input_],
        frequency_hz=column.omega / (2.0 * np.pi),
        magnitude=np.abs(values),
        phase_rad=np.unwrap(np.angle(values)),
    )
