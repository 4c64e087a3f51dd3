"""Measured: the spectra of one maneuver that every analysis starts from."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.aircraft import Aircraft
from flexsid.records.maneuver import Maneuver, Role
from flexsid.storage.store import Store
from flexsid.workflow.aircraft.aircraft_models import OutputDefinition
from flexsid.workflow.measurements.maneuver_data import (
    ManeuverMeasurement,
    MeasuredLines,
    command_names,
)
from flexsid.workflow.measurements.recording import SpectrumFrequencies, maneuver_lines
from flexsid.workflow.measurements.transforms import read_recording


def read_measurement(
    store: Store,
    maneuver: Maneuver,
    aircraft: Aircraft,
    inputs: tuple[str, ...],
    outputs: tuple[OutputDefinition, ...],
    band_hz: tuple[float, float] | None = None,
) -> ManeuverMeasurement:
    """Read the inputs, outputs and recorded excitation of a maneuver.

    Inputs that were excited besides those named are read, too.

    Raises
    ------
    BadInput
        If a channel is not recorded in its role, or the band holds no line.
    """
    roles = {c.name: c.role for c in store.channels.find(maneuver_id=maneuver.id)}
    _check_inputs(inputs, roles)
    lines = maneuver_lines(maneuver, band_hz)
    surfaces = {surface.name for surface in aircraft.surfaces}
    excited = [lines.inputs[k] for k in np.unique(lines.owner) if k >= 0]
    others = [n for n in excited if roles.get(n) is Role.INPUT and n in surfaces]
    every = tuple(dict.fromkeys((*inputs, *others)))
    commands = command_names(every)
    has_commands = all(roles.get(name) is Role.COMMAND for name in commands)
    names = (*every, *(output.name for output in outputs), *(commands if has_commands else ()))
    recording = read_recording(store, maneuver, aircraft, names)
    own = _owned_by(lines, inputs)
    recording.check(own)
    return ManeuverMeasurement(
        recording, aircraft, inputs, outputs, own, _owned_by(lines, every), has_commands
    )


def measure(
    store: Store,
    maneuver: Maneuver,
    aircraft: Aircraft,
    inputs: tuple[str, ...],
    outputs: tuple[OutputDefinition, ...],
    band_hz: tuple[float, float] | None = None,
) -> MeasuredLines:
    """Read and transform inputs, outputs and recorded excitation of a maneuver.

    Raises
    ------
    BadInput
        As ``read_measurement``.
    """
    return read_measurement(store, maneuver, aircraft, inputs, outputs, band_hz).measured()


def _check_inputs(names: tuple[str, ...], roles: Mapping[str, Role]) -> None:
    usable = [name for name, role in roles.items() if role is Role.INPUT]
    for name in names:
        if name not in usable:
            raise BadInput(
                f"'{name}' is not a recorded input of this maneuver; it has "
                f"{', '.join(usable) or 'none'}",
                code="unknown-channel",
                channel=name,
            )
    if not names:
        raise BadInput("the maneuver has no recorded input", code="no-input")


def _owned_by(lines: SpectrumFrequencies, inputs: tuple[str, ...]) -> SpectrumFrequencies:
    """Owners counted in the chosen inputs; -1 for the lines of inputs left out."""
    index = [inputs.index(name) if name in inputs else -1 for name in lines.inputs]
    owner = np.array([index[k] if k >= 0 else -1 for k in lines.owner], dtype=int)
    return SpectrumFrequencies(lines.omega, owner, inputs)
