"""Frequency response of one output to one input of a maneuver, with its errors."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float

from flexsid.errors import BadInput
from flexsid.records.aircraft import Aircraft, list_surface_parts
from flexsid.records.maneuver import Maneuver, Role
from flexsid.storage.store import Store
from flexsid.sysid.spectra.residual_spectrum import (
    estimate_noise_about_responses,
    estimate_scatter,
)
from flexsid.workflow.aircraft.aircraft_models import OutputDefinition
from flexsid.workflow.aircraft.axes import find_body
from flexsid.workflow.measurements.maneuver_spectra import (
    read_measurement,
    read_spectra,
)
from flexsid.workflow.measurements.recording import (
    COMMAND_SUFFIX,
    select_frequencies,
)
from flexsid.workflow.measurements.sensor_responses import find_excited_band

_QUIET = 0.03  # of the largest deflection: the response at a frequency is noise below
_STILL = 0.1  # of the input's rms amplitude: another surface that moves more is reported
_AT_REST = 1e-6  # of the rms amplitude of another surface: a sum of surfaces that cancel
_LEAST_FREQUENCIES = 4


@dataclass(frozen=True, slots=True)
class SingleResponse:
    """Response of an output to an input, instruments removed.

    ``std`` is the standard deviation of its complex error, None where it is not known,
    ``overlap`` the number of frequencies per resolution 1/T of the record.
    """

    omega: Float[np.ndarray, " n_omega"]
    values: Complex[np.ndarray, " n_omega"]
    std: Float[np.ndarray, " n_omega"] | None
    overlap: float
    warnings: tuple[str, ...]


def measure_single_response(
    store: Store,
    maneuver: Maneuver,
    aircraft: Aircraft,
    name: str,
    output: OutputDefinition,
    band_hz: tuple[float, float] | None,
) -> SingleResponse:
    """Measure the response of an output to a surface, or to its recorded command.

    Parameters
    ----------
    store, maneuver, aircraft
        Where it is recorded.
    name
        A surface (``wf4s``), or the command of one (``wf4s_command``). With known harmonics the
        response to a surface is that of the bare airframe, and that to a command of the
        augmented aircraft, at the harmonics of this input.
    output
        Sensor or combination.
    band_hz
        Limits of the frequencies; by default all that are excited.

    Raises
    ------
    BadInput
        If a channel is not recorded, or the input is excited at too few frequencies.
    """
    surface = name.removesuffix(COMMAND_SUFFIX)
    if maneuver.excitation is None:
        return _measure_without_harmonics(store, maneuver, aircraft, name, output, band_hz)
    measurement = read_measurement(store, maneuver, aircraft, (surface,), (output,), band_hz)
    spectra = measurement.transform()
    own = spectra.assigned_input == 0
    if np.count_nonzero(own) < _LEAST_FREQUENCIES:
        raise BadInput(
            f"'{surface}' has fewer than {_LEAST_FREQUENCIES} harmonics in this band; excited are "
            f"{', '.join(maneuver.excitation.harmonics)}",
            code="not-excited",
            input=name,
        )
    overlap = spectra.resolution_overlap
    if name == surface:
        found = spectra.responses()[surface]
        std = None if found.std is None else found.std[:, 0, 0]
        return SingleResponse(found.omega, found.values[:, 0, 0], std, overlap, ())
    if spectra.commands is None:
        raise BadInput(
            f"the command of {surface} was not recorded in this maneuver; select the surface",
            code="no-command",
            input=name,
        )
    omega, command = spectra.omega[own], spectra.commands.values[own, 0]
    outputs = spectra.true_outputs().values[own]
    noise = estimate_noise_about_responses(omega, np.zeros(omega.size, dtype=int), outputs, command)
    std = None if noise is None else noise[:, 0] / np.abs(command)
    return SingleResponse(omega, outputs[:, 0] / command, std, overlap, ())


def _measure_without_harmonics(
    store: Store,
    maneuver: Maneuver,
    aircraft: Aircraft,
    name: str,
    output: OutputDefinition,
    band_hz: tuple[float, float] | None,
) -> SingleResponse:
    """Divide the spectra of output and input where the input has power."""
    surface = name.removesuffix(COMMAND_SUFFIX)
    if band_hz is None:
        band_hz = find_excited_band(store, maneuver, aircraft, find_body(maneuver.axis))
    recorded = [c.name for c in store.channels.find(maneuver_id=maneuver.id, role=Role.INPUT)]
    own = {surface, *(part for part, _ in list_surface_parts(aircraft).get(surface, ()))}
    inputs = (surface, *(one for one in recorded if one != surface))
    measurement = read_measurement(store, maneuver, aircraft, inputs, (output,), band_hz)
    spectra = measurement.transform()
    travel = np.sqrt(np.mean(np.abs(spectra.inputs.values) ** 2, axis=0))
    u, z = spectra.inputs.values[:, :1], spectra.true_outputs().values
    if name != surface:
        frequencies = select_frequencies(maneuver, band_hz)
        u = read_spectra(store, maneuver, aircraft, (name,), frequencies).values
    has_power = np.abs(u[:, 0]) > _QUIET * np.abs(u[:, 0]).max()
    if np.count_nonzero(has_power) < _LEAST_FREQUENCIES or travel[0] < _AT_REST * travel.max():
        raise BadInput(
            f"'{name}' has power at fewer than {_LEAST_FREQUENCIES} frequencies of this band; use "
            "a wider band, or another input",
            code="not-excited",
            input=name,
        )
    moving = [
        other
        for other, rms in zip(inputs, travel, strict=True)
        if other not in own and rms > _STILL * travel[0]
    ]
    warnings = (_describe_other_motion(surface, moving),) if moving else ()
    u, z = u[has_power], z[has_power]
    scatter = estimate_scatter(u, z)
    std = None if scatter is None else scatter[0] / np.abs(u[:, 0])
    overlap = spectra.resolution_overlap
    return SingleResponse(spectra.omega[has_power], (z / u)[:, 0], std, overlap, warnings)


def _describe_other_motion(surface: str, moving: Sequence[str]) -> str:
    return (
        f"{', '.join(moving)} also {'moves' if len(moving) == 1 else 'move'} in this maneuver: "
        "what the output responds to it is attributed to "
        f"{surface}. Cut the part in which {surface} moves alone, or use known harmonics."
    )
