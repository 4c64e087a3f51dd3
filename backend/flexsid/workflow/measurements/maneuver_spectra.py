"""Channels and spectra of one maneuver, with stored corrections, and the spread of its condition.

Recorded samples are never changed: steps are stored separately, and an undone step has no
effect but stays in the record.
"""

from __future__ import annotations

import math
from collections.abc import Container, Iterator, Mapping, Sequence
from dataclasses import replace
from datetime import UTC, datetime

import numpy as np
from jaxtyping import Float

from flexsid.errors import BadInput, Conflict, UnknownRecord
from flexsid.records.aircraft import Aircraft, get_symmetry, list_surface_parts
from flexsid.records.maneuver import (
    GROUND,
    Channel,
    Condition,
    ConditioningStep,
    Correction,
    Maneuver,
    Role,
    StepKind,
)
from flexsid.storage.recordings import read_channels
from flexsid.storage.store import Store
from flexsid.sysid.model.airspeed import AIRSPEED
from flexsid.sysid.model.lateral import LATERAL
from flexsid.sysid.model.longitudinal import LONGITUDINAL
from flexsid.sysid.model.rigid_body import RigidBody
from flexsid.sysid.model.sensor_models import AIRSPEED_PROBE, ATTITUDE
from flexsid.sysid.preparation.air_data import find_contradictions
from flexsid.sysid.preparation.spikes_and_dropouts import repair_samples
from flexsid.sysid.signals import FrequencyData
from flexsid.units import to_si
from flexsid.workflow.aircraft.aircraft_models import (
    OutputDefinition,
    compute_input_corrections,
    get_output_instrument,
)
from flexsid.workflow.measurements.recording import (
    Conditioning,
    ManeuverMeasurement,
    Recording,
    SpectrumFrequencies,
    list_command_names,
    select_frequencies,
)

# --- Conditioning: stored corrections of channels, applied wherever samples are read --------------

_LONGEST_DELAY_S = 1.0
_SCALES = (0.01, 100.0)


def read_conditioning(store: Store, maneuver_id: int | None) -> dict[str, Conditioning]:
    """Read active corrections and what is between samples, of channels that have any."""
    found = {
        one.name: Conditioning(between=one.between_samples)
        for one in store.channels.find(maneuver_id=maneuver_id)
        if one.between_samples is not None
    }
    for step in store.conditioning.find(maneuver_id=maneuver_id, undone_at=None):
        found[step.channel] = found.get(step.channel, Conditioning()).add(step.correction)
    return found


def add_conditioning_steps(
    store: Store, maneuver_id: int, corrections: Sequence[Correction], author: str = ""
) -> list[ConditioningStep]:
    """Store corrections, all or none; return those of the maneuver.

    A shared correction is stored with every maneuver of the aircraft that has the channel.

    Raises
    ------
    BadInput
        If a channel is not recorded, or a correction is impossible.
    Conflict
        If a channel has a delay or calibration already: undo that first.
    """
    if not corrections:
        raise BadInput("no correction was given", code="no-correction")
    shared = [one for one in corrections if one.is_shared]
    if any(one.kind is StepKind.REPAIR for one in shared):
        raise BadInput("a repair is of the samples of one maneuver; it cannot be shared",
                       code="repair-not-shared")  # fmt: skip
    with store.transaction():
        maneuver = store.maneuvers.get(maneuver_id)
        steps = _add_to_maneuver(store, maneuver, corrections, author)
        if shared:
            for other in store.maneuvers.find(aircraft_id=maneuver.aircraft_id):
                recorded = {c.name for c in store.channels.find(maneuver_id=other.id)}
                own = [one for one in shared if one.channel in recorded]
                if other.id != maneuver_id and own:
                    _add_to_maneuver(store, other, own, author)
    return steps


def _add_to_maneuver(
    store: Store, maneuver: Maneuver, corrections: Sequence[Correction], author: str
) -> list[ConditioningStep]:
    assert maneuver.id is not None
    channels = read_channels(store.database, maneuver.id, [c.channel for c in corrections])
    existing = {
        (step.channel, step.correction.kind)
        for step in store.conditioning.find(maneuver_id=maneuver.id, undone_at=None)
        if step.correction.kind is not StepKind.REPAIR
    }
    steps = []
    for one in corrections:
        if one.channel not in channels:
            raise BadInput(
                f"the maneuver has no channel '{one.channel}'",
                code="unknown-channel",
                channel=one.channel,
            )
        if (one.channel, one.kind) in existing:
            raise Conflict(
                f"'{one.channel}' of {maneuver.label} has a {one.kind.value} already; undo that "
                "first",
                code="already-conditioned",
                channel=one.channel,
                maneuver_id=maneuver.id,
            )
        channel, samples = channels[one.channel]
        _check(one, np.asarray(samples, dtype=float), channel.rate_hz)
        if one.kind is not StepKind.REPAIR:
            existing.add((one.channel, one.kind))
        step = ConditioningStep(
            maneuver_id=maneuver.id, correction=one, channel=one.channel, author=author
        )
        steps.append(store.conditioning.add(step))
    return steps


def take_named_corrections(store: Store, run_id: int, author: str = "") -> list[ConditioningStep]:
    """Store the corrections of the causes that a run names; return those of its maneuver.

    Those of a recorder hold for all maneuvers of the aircraft with the channel.

    Raises
    ------
    BadInput
        If the run names no cause that a correction removes.
    Conflict
        If a channel has a delay or calibration already: undo that first.
    """
    run = store.runs.get(run_id)
    causes = () if run.result is None else run.result.adequacy.causes
    found = [one.finding.correction for one in causes if one.finding.correction is not None]
    if not found:
        raise BadInput(
            f"run {run_id} names no cause that a correction removes", code="no-correction"
        )
    shared = [replace(one, is_shared=one.kind is not StepKind.REPAIR) for one in found]
    return add_conditioning_steps(store, run.maneuver_id, shared, author)


def add_shared_corrections(store: Store, maneuver: Maneuver) -> None:
    """Store the shared corrections of the aircraft with a new maneuver, by their authors."""
    recorded = {c.name for c in store.channels.find(maneuver_id=maneuver.id)}
    known: dict[tuple[str, StepKind], ConditioningStep] = {}
    for other in store.maneuvers.find(aircraft_id=maneuver.aircraft_id):
        if other.id == maneuver.id:
            continue
        for step in store.conditioning.find(maneuver_id=other.id, undone_at=None):
            if step.correction.is_shared and step.channel in recorded:
                known[step.channel, step.correction.kind] = step
    for step in known.values():
        _add_to_maneuver(store, maneuver, [step.correction], step.author)


def undo_step(store: Store, maneuver_id: int, step_id: int, author: str = "") -> ConditioningStep:
    """Undo a step; it stays in the record with the author of the undo.

    A shared correction is undone in all maneuvers of the aircraft.

    Raises
    ------
    UnknownRecord
        If the maneuver has no such step.
    Conflict
        If it is undone already.
    """
    with store.transaction():
        step = store.conditioning.get(step_id)
        if step.maneuver_id != maneuver_id:
            raise UnknownRecord(f"maneuver {maneuver_id} has no conditioning step {step_id}")
        if step.undone_at is not None:
            raise Conflict("this step is undone already", code="already-undone")
        now = datetime.now(UTC)
        if step.correction.is_shared:
            aircraft_id = store.maneuvers.get(maneuver_id).aircraft_id
            for other in store.maneuvers.find(aircraft_id=aircraft_id):
                for same in store.conditioning.find(maneuver_id=other.id, undone_at=None):
                    if same.correction == step.correction and same.id != step.id:
                        store.conditioning.replace(replace(same, undone_at=now, undone_by=author))
        return store.conditioning.replace(replace(step, undone_at=now, undone_by=author))


def _check(one: Correction, samples: np.ndarray, rate_hz: float) -> None:
    name = one.channel
    if one.kind is StepKind.DELAY:
        if not abs(one.delay_s) <= _LONGEST_DELAY_S or one.delay_s == 0.0:
            raise BadInput(
                f"'{name}': a delay of {one.delay_s:g} s is not plausible; up to "
                f"{_LONGEST_DELAY_S:g} s are expected, and not zero",
                code="bad-delay",
                channel=name,
            )
    elif one.kind is StepKind.CALIBRATION:
        if not (_SCALES[0] <= abs(one.scale) <= _SCALES[1] and math.isfinite(one.bias)):
            raise BadInput(
                f"'{name}': scale factor {one.scale:g} with bias {one.bias:g} is not plausible; "
                f"scale factors from {_SCALES[0]:g} to {_SCALES[1]:g} are expected, negative for a "
                "wrong sign",
                code="bad-calibration",
                channel=name,
            )
    elif one.kind is StepKind.REPAIR:
        if not one.stretches:
            raise BadInput(
                f"'{name}': a repair needs the samples to replace", code="no-stretch", channel=name
            )
        repair_samples(samples, one.stretches, rate_hz)


# --- Channels and spectra of one maneuver, read from the database ---------------------------------

LOW_OMEGA = 0.1
"""Far below the corner of any instrument: the phase of its response is that of a lag. [rad/s]"""


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
    low = np.array([LOW_OMEGA])
    lags = {}
    for output in outputs:
        phase = np.angle(get_output_instrument(aircraft, output).response(low)[0])
        lags |= {part: -phase / LOW_OMEGA for part, _ in recording.parts[output.name]}
    for name, factor in zip(
        inputs, compute_input_corrections(aircraft, inputs, low)[0], strict=True
    ):
        lags |= {part: np.angle(factor) / LOW_OMEGA for part, _ in recording.parts[name]}
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


# --- Spread of the condition over a maneuver, which models of one flight condition do not have ----

MAX_AIRSPEED_DRIFT = 0.03
"""Relative drift of airspeed; dynamic pressure drifts twice as much."""

MAX_DENSITY_DRIFT = 2.0 * MAX_AIRSPEED_DRIFT
"""Relative drift of density with the same drift of dynamic pressure."""

UNUSABLE_DRIFT = 3.0 * MAX_AIRSPEED_DRIFT
"""Relative drift with which no derivative is that of one condition."""


def compute_drift(values: Float[np.ndarray, " n"]) -> float:
    """Compute the change over a record of the straight line through its samples."""
    sample = np.arange(values.size) - 0.5 * (values.size - 1)
    power = float(sample @ sample)
    slope = float(sample @ values) / power if power > 0 else 0.0
    return slope * (values.size - 1)


_PARTS = 8  # of a record, whose means have little noise of the sensor


def widen_by_spread(
    store: Store, aircraft: Aircraft, maneuver: Maneuver
) -> tuple[Aircraft, Condition]:
    """Widen the errors of mass, airspeed and density by their spread over the record.

    A model has one condition: a derivative is that of any condition within the spread, which
    is the standard deviation of the means of eight parts of the record.
    """
    known = {one.name for one in store.channels.find(maneuver_id=maneuver.id, role=Role.CONDITION)}
    names = sorted(known.intersection(("density", "fuel_fraction")))
    recorded = [(c.name, x) for c, x in load_channels(store, maneuver.id, names)] if names else []
    speed = _find_airspeed(store, maneuver)
    recorded += [] if speed is None else [("airspeed", speed[1])]
    spread = dict.fromkeys(("airspeed", "density", "fuel_fraction"), 0.0)
    for name, values in recorded:
        parts = np.array_split(values, _PARTS) if values.size >= _PARTS else []
        spread[name] = float(np.std([np.mean(part) for part in parts])) if parts else 0.0
    condition, table = maneuver.condition, aircraft.mass
    fuel = condition.fuel_fraction + np.array([-1.0, 1.0]) * spread["fuel_fraction"]
    of_mass = np.ptp(np.interp(fuel, table.fuel, table.mass_kg)) / (2.0 * condition.mass_kg)
    own = spread["airspeed"] / condition.airspeed_m_s, spread["density"] / condition.density_kg_m3
    return (
        replace(aircraft, mass=replace(table, mass_std=float(np.hypot(table.mass_std, of_mass)))),
        replace(
            condition,
            airspeed_std=float(np.hypot(condition.airspeed_std, own[0])),
            density_std=float(np.hypot(condition.density_std, own[1])),
        ),
    )


def warn_of_airspeed_drift(store: Store, maneuver: Maneuver) -> tuple[str, ...]:
    """Warn of an airspeed or a density that is not that of one condition."""
    return tuple(_warn_of_drift(store, maneuver))


def compute_airspeed_drift(store: Store, maneuver: Maneuver) -> tuple[float, float] | None:
    """Compute the drift of the recorded airspeed, and its mean; None without a record. [m/s]"""
    found = _find_airspeed(store, maneuver)
    if found is None:
        return None
    name, values = found
    # A probe may record the change of airspeed alone.
    mean = float(np.mean(values)) if name == "airspeed" else maneuver.condition.airspeed_m_s
    return compute_drift(values), mean


def _warn_of_drift(store: Store, maneuver: Maneuver) -> Iterator[str]:
    drift, mean = compute_airspeed_drift(store, maneuver) or (0.0, 0.0)
    if abs(drift) > MAX_AIRSPEED_DRIFT * abs(mean):
        what = "may be biased, and their standard errors include this drift"
        if abs(drift) > UNUSABLE_DRIFT * abs(mean):
            what = "are those of no condition: use a shorter part of the record"
        elif maneuver.axis == LONGITUDINAL.axis and _find_probe(store, maneuver):
            what += f". Compare with the model with airspeed ({AIRSPEED.axis})"
        yield (
            f"{maneuver.label}: the airspeed {'rises' if drift > 0.0 else 'falls'} by "
            f"{abs(drift):.1f} m/s over the record. The model has one airspeed, of {mean:.1f} "
            f"m/s; derivatives {what}."
        )
    known = store.channels.find(maneuver_id=maneuver.id, role=Role.CONDITION)
    if "density" in {channel.name for channel in known}:
        ((_, values),) = load_channels(store, maneuver.id, ["density"])
        mean, drift = float(np.mean(values)), compute_drift(values)
        if abs(drift) > MAX_DENSITY_DRIFT * abs(mean):
            yield (
                f"{maneuver.label}: the density {'rises' if drift > 0.0 else 'falls'} by "
                f"{abs(drift / mean):.0%} over the record, and dynamic pressure with it; the "
                "standard errors of derivatives include it."
            )


def _find_probe(store: Store, maneuver: Maneuver) -> str | None:
    """Find the output of an airspeed probe."""
    aircraft = store.aircraft.get(maneuver.aircraft_id)
    probes = {one.name for one in aircraft.sensors if one.kind == AIRSPEED_PROBE.kind}
    outputs = store.channels.find(maneuver_id=maneuver.id, role=Role.OUTPUT)
    return next((channel.name for channel in outputs if channel.name in probes), None)


def _find_airspeed(store: Store, maneuver: Maneuver) -> tuple[str, Float[np.ndarray, " n"]] | None:
    """Find the recorded airspeed, of the condition or else of a probe, with its samples. [m/s]"""
    known = store.channels.find(maneuver_id=maneuver.id, role=Role.CONDITION)
    name = "airspeed" if "airspeed" in {channel.name for channel in known} else None
    name = name or _find_probe(store, maneuver)
    if name is None:
        return None
    ((_, values),) = load_channels(store, maneuver.id, [name])
    return name, values


_AIR_DATA = ("indicated_airspeed", "altitude", "temperature", "total_temperature")


def warn_of_air_data(store: Store, maneuver: Maneuver) -> tuple[str, ...]:
    """Warn of recorded air data that contradict each other or the condition."""
    known = {one.name for one in store.channels.find(maneuver_id=maneuver.id, role=Role.CONDITION)}
    names = [name for name in _AIR_DATA if name in known]
    if not names or maneuver.axis == GROUND:
        return ()
    measured = {c.name: float(np.mean(x)) for c, x in load_channels(store, maneuver.id, names)}
    condition = maneuver.condition
    measured |= {"airspeed": condition.airspeed_m_s, "density": condition.density_kg_m3}
    try:
        found = find_contradictions(measured)
    except BadInput as outside:
        found = (f"Air data cannot be compared: {outside.message}",)
    return tuple(f"{maneuver.label}: {text}" for text in found)
