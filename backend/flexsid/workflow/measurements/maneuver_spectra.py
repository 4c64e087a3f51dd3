"""Channels and spectra of one maneuver, read from the database."""

from __future__ import annotations

from collections.abc import Container, Mapping, Sequence

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.aircraft import Aircraft, get_symmetry, list_surface_parts
from flexsid.records.maneuver import Channel, Maneuver, Role
from flexsid.storage.channels import read_channels
from flexsid.storage.store import Store
from flexsid.sysid.model.lateral import LATERAL
from flexsid.sysid.model.longitudinal import LONGITUDINAL
from flexsid.sysid.model.rigid_body import RigidBody
from flexsid.sysid.model.sensor_models import ATTITUDE
from flexsid.sysid.signals import FrequencyData
from flexsid.units import to_si
from flexsid.workflow.aircraft.aircraft_models import (
    OutputDefinition,
    compute_input_corrections,
    get_output_instrument,
)
from flexsid.workflow.measurements.conditioning import read_conditioning
from flexsid.workflow.measurements.recording import (
    ManeuverMeasurement,
    Recording,
    SpectrumFrequencies,
    list_command_names,
    select_frequencies,
)

_LOW_OMEGA = 0.1  # far below the corner of any instrument: the phase is that of a lag [rad/s]


def load_channels(
    store: Store, maneuver_id: int | None, names: Sequence[str] | None = None
) -> list[tuple[Channel, np.ndarray]]:
    """Load channels (all by default) with their samples in SI units, conditioned.

    Raises
    ------
    BadInput
        If the maneuver has no channel of a name.
    """
    assert maneuver_id is not None
    found = read_channels(store.database, maneuver_id, names)
    requested = list(found) if names is None else list(names)
    _check_recorded(store, maneuver_id, requested, found)
    steps = read_conditioning(store, maneuver_id)
    result = []
    for channel, samples in (found[name] for name in requested):
        values = to_si(samples, channel.unit)
        if channel.name in steps:
            values = steps[channel.name].align(values, channel.rate_hz)
        result.append((channel, values))
    return result


def read_spectra(
    store: Store,
    maneuver: Maneuver,
    aircraft: Aircraft,
    names: tuple[str, ...],
    frequencies: SpectrumFrequencies,
) -> FrequencyData:
    """Read and transform channels and combinations of a maneuver, conditioned."""
    return read_recording(store, maneuver, aircraft, names).spectra(names, frequencies)


def read_recording(
    store: Store,
    maneuver: Maneuver,
    aircraft: Aircraft,
    names: Sequence[str],
    body: RigidBody = LONGITUDINAL,
) -> Recording:
    """Read the recorded channels behind channels and combinations.

    Attitudes need not return to trim where they have no effect on the motion of the body.

    Raises
    ------
    BadInput
        If the maneuver has no channel of a name.
    """
    assert maneuver.id is not None
    combinations = {c.name: c.terms for c in aircraft.combinations}
    for name, terms in list_surface_parts(aircraft).items():
        commanded = zip(list_command_names([term for term, _ in terms]), terms, strict=True)
        combinations[list_command_names([name])[0]] = tuple((c, w) for c, (_, w) in commanded)
    composed = {part for terms in combinations.values() for part, _ in terms}
    found = read_channels(store.database, maneuver.id, (*names, *composed))
    parts = {
        name: ((name, 1.0),) if name in found else combinations.get(name, ((name, 1.0),))
        for name in names
    }
    needed = list(dict.fromkeys(part for terms in parts.values() for part, _ in terms))
    _check_recorded(store, maneuver.id, needed, found)
    acting = [one for one in (body, LATERAL) if one.acts_by_gravity]
    attitudes = {
        sensor.name
        for sensor in aircraft.sensors
        if sensor.kind == ATTITUDE.kind
        and not any(ATTITUDE.measures(sensor.axis, one) for one in acting)
    }
    return Recording(
        maneuver=maneuver,
        channels=tuple(found[name] for name in needed),
        parts=parts,
        attitudes=frozenset(attitudes.intersection(needed)),
        conditioning=read_conditioning(store, maneuver.id),
    )


def read_measurement(
    store: Store,
    maneuver: Maneuver,
    aircraft: Aircraft,
    inputs: tuple[str, ...],
    outputs: tuple[OutputDefinition, ...],
    band_hz: tuple[float, float] | None = None,
    body: RigidBody = LONGITUDINAL,
    *,
    free_ends: bool = False,
) -> ManeuverMeasurement:
    """Read the inputs, outputs and recorded excitation of a maneuver for the model of a body.

    Excited inputs that are not named are read, too. An input that was not recorded itself is
    computed from single surfaces; it has the harmonics of them all, and their commands. With
    ``free_ends`` a record without known harmonics is transformed over the window that all channels
    cover, at multiples of its 1/T, without an assumption about the motion at its ends.

    Raises
    ------
    BadInput
        If a channel is not recorded in its role, or the band contains no frequency.
    """
    roles = {c.name: c.role for c in store.channels.find(maneuver_id=maneuver.id)}
    recorded = [name for name, role in roles.items() if role is Role.INPUT]
    parts = {
        name: [term for term, _ in terms]
        for name, terms in list_surface_parts(aircraft).items()
        if name not in recorded and all(term in recorded for term, _ in terms)
    }
    _check_inputs(inputs, (*recorded, *parts))
    frequencies = _combine_harmonics(select_frequencies(maneuver, band_hz), aircraft, inputs, parts)
    surfaces = {surface.name for surface in aircraft.surfaces}
    excited = [frequencies.inputs[k] for k in np.unique(frequencies.assigned_input) if k >= 0]
    others = [n for n in excited if n in surfaces and (n in recorded or n in parts)]
    every = tuple(dict.fromkeys((*inputs, *others)))
    commands = list_command_names(every)
    commanded = list_command_names([t for name in every for t in parts.get(name, [name])])
    has_commands = all(roles.get(name) is Role.COMMAND for name in commanded)
    names = (*every, *(output.name for output in outputs), *(commands if has_commands else ()))
    recording = read_recording(store, maneuver, aircraft, names, body)
    if free_ends and maneuver.excitation is None:
        recording = recording.with_common_window(_find_lags(recording, aircraft, every, outputs))
        assert recording.window_s is not None
        begin_s, last_s = recording.window_s
        frequencies = select_frequencies(maneuver, band_hz, last_s - begin_s)
    own = _assign_inputs(frequencies, inputs)
    recording.check(own)
    return ManeuverMeasurement(
        recording, aircraft, inputs, outputs, own, _assign_inputs(frequencies, every), has_commands
    )


def _find_lags(
    recording: Recording,
    aircraft: Aircraft,
    inputs: Sequence[str],
    outputs: Sequence[OutputDefinition],
) -> dict[str, float]:
    """Find the times by which the instruments of channels record slow motion later. [s]"""
    low = np.array([_LOW_OMEGA])
    lags = {}
    for output in outputs:
        phase = np.angle(get_output_instrument(aircraft, output).response(low)[0])
        lags |= {part: -phase / _LOW_OMEGA for part, _ in recording.parts[output.name]}
    for name, factor in zip(
        inputs, compute_input_corrections(aircraft, inputs, low)[0], strict=True
    ):
        lags |= {part: np.angle(factor) / _LOW_OMEGA for part, _ in recording.parts[name]}
    return lags


def _check_recorded(
    store: Store, maneuver_id: int, requested: Sequence[str], found: Container[str]
) -> None:
    missing = [name for name in requested if name not in found]
    if missing:
        recorded = [channel.name for channel in store.channels.find(maneuver_id=maneuver_id)]
        raise BadInput(
            f"the maneuver has no channel '{missing[0]}'; it has {', '.join(recorded)}",
            code="unknown-channel",
            channel=missing[0],
        )


def _check_inputs(names: tuple[str, ...], usable: Sequence[str]) -> None:
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


def _combine_harmonics(
    frequencies: SpectrumFrequencies,
    aircraft: Aircraft,
    inputs: Sequence[str],
    parts: Mapping[str, Sequence[str]],
) -> SpectrumFrequencies:
    """Assign the harmonics of single surfaces to their parts of the symmetry of the inputs.

    A harmonic of either side excites both parts; the motion of the other part cancels in the
    outputs of one axis.
    """
    own = {get_symmetry(aircraft, name) for name in inputs if name in parts}
    combined = {
        term: name
        for name, terms in parts.items()
        if get_symmetry(aircraft, name) in own
        for term in terms
    }
    assigned = [combined.get(name, name) for name in frequencies.inputs]
    names = tuple(dict.fromkeys(assigned))
    index = np.array([names.index(name) for name in assigned], dtype=int)
    owned = frequencies.assigned_input >= 0
    merged = np.full(frequencies.assigned_input.size, -1)
    merged[owned] = index[frequencies.assigned_input[owned]]
    return SpectrumFrequencies(frequencies.omega, merged, names)


def _assign_inputs(
    frequencies: SpectrumFrequencies, inputs: tuple[str, ...]
) -> SpectrumFrequencies:
    """Assign frequencies to the selected inputs; -1 for frequencies of other inputs."""
    index = [inputs.index(name) if name in inputs else -1 for name in frequencies.inputs]
    assigned_input = np.array(
        [index[k] if k >= 0 else -1 for k in frequencies.assigned_input], dtype=int
    )
    return SpectrumFrequencies(frequencies.omega, assigned_input, inputs)
