"""Channels of a maneuver: recorded, combined, over time, as spectra, and repeated."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Unpack

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.aircraft import (
    Aircraft,
    Combination,
    Sensor,
    get_symmetry,
    list_surface_parts,
)
from flexsid.records.maneuver import Channel, Excitation, Maneuver, Role
from flexsid.records.quality import SignalToNoise
from flexsid.records.views import (
    ChannelHistories,
    ChannelTrace,
    DefaultChannels,
    Envelope,
    EnvelopeMark,
    Spectra,
)
from flexsid.storage.lists.maneuver_list import ManeuverFilters
from flexsid.storage.store import Store
from flexsid.sysid.model.sensor_models import ATTITUDE, GYRO, VANE, load_sensor_models
from flexsid.sysid.signals import FrequencyResponse
from flexsid.sysid.spectra.fourier import finite_fourier_transform
from flexsid.sysid.spectra.residual_spectrum import estimate_noise_about_responses
from flexsid.sysid.spectra.response import compute_coherence, compute_windowed_responses
from flexsid.units import si_unit, to_si
from flexsid.workflow.aircraft.aircraft_models import (
    OutputDefinition,
    compute_input_correction,
    get_output_instrument,
)
from flexsid.workflow.aircraft.axes import classify_part, list_bodies, list_moved_surfaces
from flexsid.workflow.measurements.maneuver_spectra import read_conditioning, read_spectra
from flexsid.workflow.measurements.recording import (
    Conditioning,
    SpectrumFrequencies,
    list_excitation_names,
    select_frequencies,
)

# --- Recorded channels and their symmetric combinations by name, in SI ----------------------------

Interval = tuple[float, float]
_Parts = list[tuple[Channel, float]]


_KINDS_FIRST = (VANE.kind, GYRO.kind, ATTITUDE.kind)


def select_default_channels(
    aircraft: Aircraft, axis: str, excitation: Excitation | None, recorded: Mapping[str, Role]
) -> DefaultChannels:
    """Select the channels of a maneuver that views show first, of those that were recorded.

    Of several sensors of one quantity it is the one nearest to the plane of symmetry.
    """
    sensors = _list_rigid_body_sensors(aircraft, axis, recorded)
    rates = {
        one.model.mirror_sign(one.axis): one.name for one in sensors[::-1] if one.kind == GYRO.kind
    }
    outputs = [name for name, role in recorded.items() if role is Role.OUTPUT]
    own = {body.symmetry for body in list_bodies(axis)}
    combined = (
        one
        for one in aircraft.combinations
        if one.name not in recorded and all(term in recorded for term, _ in one.terms)
    )
    return DefaultChannels(
        inputs=list_moved_surfaces(
            aircraft, axis, excitation, (n for n, role in recorded.items() if role is Role.INPUT)
        ),
        outputs=tuple(sensor.name for sensor in sensors) or tuple(outputs),
        rates=tuple(rates[sign] for sign in sorted(rates, reverse=True)) or tuple(outputs[:1]),
        combinations=tuple(
            one.name
            for one in sorted(combined, key=lambda one: _find_part(aircraft, one) not in own)
        ),
    )


def _find_part(aircraft: Aircraft, combination: Combination) -> str | None:
    """Find the part of the motion that a combination of surfaces or sensors has."""
    if combination.name in list_surface_parts(aircraft):
        return get_symmetry(aircraft, combination.name)
    models = load_sensor_models()
    sensors = {sensor.name: sensor for sensor in aircraft.sensors if sensor.kind in models}
    known = [(sensors[name], weight) for name, weight in combination.terms if name in sensors]
    return classify_part(known) if len(known) == len(combination.terms) > 0 else None


def _list_rigid_body_sensors(
    aircraft: Aircraft, axis: str, recorded: Mapping[str, Role]
) -> list[Sensor]:
    """List one sensor of each rigid-body quantity of an axis, angles and rates first."""
    bodies, models = list_bodies(axis), load_sensor_models()
    found: dict[tuple[str, str], Sensor] = {}
    for sensor in sorted(aircraft.sensors, key=lambda one: abs(one.location_m[1])):
        model = models.get(sensor.kind)  # None: of a package that is not installed
        if model is None or recorded.get(sensor.name) is not Role.OUTPUT:
            continue
        if any(model.measures_rigid_body(sensor.axis, body) for body in bodies):
            found.setdefault((sensor.kind, sensor.axis), sensor)
    return sorted(found.values(), key=_rank)


def _rank(sensor: Sensor) -> tuple[int, bool]:
    known = sensor.kind in _KINDS_FIRST
    rank = _KINDS_FIRST.index(sensor.kind) if known else len(_KINDS_FIRST)
    return rank, sensor.axis != sensor.model.usual_axis and not known


def list_input_names(store: Store, maneuver: Maneuver) -> tuple[str, ...]:
    """List the measured surfaces of a maneuver, in the order of the recorder."""
    measured = store.channels.find(maneuver_id=maneuver.id, role=Role.INPUT)
    return tuple(channel.name for channel in measured)


def read_traces(
    store: Store, maneuver: Maneuver, names: Sequence[str], interval_s: Interval | None = None
) -> tuple[ChannelTrace, ...]:
    """Read channels, or combinations of channels, over an interval of the record.

    Raises
    ------
    BadInput
        If there is neither a channel nor a combination of this name, or the channels of a
        combination have different sampling.
    """
    parts = _find(store, maneuver, names)
    needed = {channel.array for terms in parts.values() for channel, _ in terms}
    samples = store.arrays.get_many(needed)
    steps = read_conditioning(store, maneuver.id)
    return tuple(
        _build_trace(name, terms, samples, steps, interval_s) for name, terms in parts.items()
    )


_MOST_SAMPLES = 5_000_000


def read_samples(
    store: Store, maneuver_id: int, names: Sequence[str], interval_s: Interval | None = None
) -> tuple[ChannelTrace, ...]:
    """Read samples of channels as they are estimated with: in SI units, with corrections.

    Raises
    ------
    BadInput
        As ``read_traces``, or if no channel or more than five million samples were requested.
    """
    if not names:
        raise BadInput("name the channels whose samples are requested", code="no-channel")
    maneuver = store.maneuvers.get(maneuver_id)
    parts = _find(store, maneuver, names)
    count = 0
    for (channel, _), *_ in parts.values():
        window = channel.slice_samples(interval_s or (channel.start_s, channel.stop_s))
        count += window.stop - window.start
    if count > _MOST_SAMPLES:
        raise BadInput(
            f"{count} samples were requested, more than {_MOST_SAMPLES} at once; name channels, or "
            "an interval by start_s and stop_s",
            code="too-many-samples",
        )
    return read_traces(store, maneuver, tuple(parts), interval_s)


def find_sampling(
    store: Store, maneuver: Maneuver, names: Sequence[str]
) -> dict[str, tuple[float, str]]:
    """Return sampling rate [Hz] and SI unit of channels and combinations, by name."""
    parts = _find(store, maneuver, names)
    return {
        name: (channel.rate_hz, si_unit(channel.unit)) for name, ((channel, _), *_) in parts.items()
    }


def _find(store: Store, maneuver: Maneuver, names: Sequence[str]) -> dict[str, _Parts]:
    recorded = {channel.name: channel for channel in store.channels.find(maneuver_id=maneuver.id)}
    aircraft = store.aircraft.get(maneuver.aircraft_id)
    combined = {combination.name: combination for combination in aircraft.combinations}
    return {name: _list_terms(name, recorded, combined) for name in dict.fromkeys(names)}


def _list_terms(
    name: str, recorded: dict[str, Channel], combined: dict[str, Combination]
) -> _Parts:
    if name in recorded:
        return [(recorded[name], 1.0)]
    terms = combined[name].terms if name in combined else ()
    if not terms or any(term not in recorded for term, _ in terms):
        known = [
            *recorded,
            *(n for n, c in combined.items() if all(t in recorded for t, _ in c.terms)),
        ]
        raise BadInput(
            f"the maneuver has no channel '{name}'; it has {', '.join(known)}",
            code="unknown-channel",
            channel=name,
        )
    channels = [recorded[term] for term, _ in terms]
    if len({(c.rate_hz, c.start_s, c.n_samples, si_unit(c.unit)) for c in channels}) > 1:
        raise BadInput(
            f"'{name}' combines channels of different rates or units; select its parts instead: "
            f"{', '.join(channel.name for channel in channels)}",
            code="unequal-channels",
            channel=name,
        )
    return [(recorded[term], weight) for term, weight in terms]


def _build_trace(
    name: str,
    parts: _Parts,
    samples: dict[str, np.ndarray],
    steps: dict[str, Conditioning],
    interval_s: Interval | None,
) -> ChannelTrace:
    first, _ = parts[0]
    window = slice(0, first.n_samples)
    if interval_s is not None:
        window = first.slice_samples(interval_s)
    values = sum(
        weight * _apply_conditioning(channel, samples[channel.array], steps, window)
        for channel, weight in parts
    )
    index = np.arange(window.start, window.stop)
    return ChannelTrace(
        name=name,
        unit=si_unit(first.unit),
        role=first.role,
        time_s=first.start_s + index / first.rate_hz,
        values=np.asarray(values),
    )


def _apply_conditioning(
    channel: Channel, samples: np.ndarray, steps: dict[str, Conditioning], window: slice
) -> np.ndarray:
    """Return samples of a window in SI with the conditioning of the channel applied."""
    if channel.name not in steps:
        return to_si(samples[window], channel.unit)
    values = np.asarray(to_si(samples, channel.unit), dtype=float)
    return steps[channel.name].align(values, channel.rate_hz)[window]


def resample_to_slowest(traces: Sequence[ChannelTrace]) -> tuple[ChannelTrace, ...]:
    """Resample traces to the time axis of the one with the fewest samples."""
    clock = min(traces, key=lambda trace: trace.time_s.size).time_s
    return tuple(
        trace
        if trace.time_s is clock
        else replace(trace, time_s=clock, values=np.interp(clock, trace.time_s, trace.values))
        for trace in traces
    )


# --- Time histories and spectra of the channels of a maneuver -------------------------------------

POINTS = 1000  # about as many as a screen has columns
_MOST_POINTS = 20_000
_BACKGROUND = 2000  # points of a whole spectrum
_FIRST_CYCLES = 2.0  # cycles per record, below which drift dominates
CLEAR_OF_NYQUIST = 0.4  # of the sampling rate, clear of the anti-alias filter's skirt


def read_time_history(
    store: Store,
    maneuver_id: int,
    channels: Sequence[str] = (),
    start_s: float | None = None,
    stop_s: float | None = None,
    points: int = POINTS,
) -> ChannelHistories:
    """Read channels over a window; the inputs over the whole record by default."""
    if not 10 <= points <= _MOST_POINTS:
        raise BadInput(
            f"{points} points per channel are out of range; select 10 to {_MOST_POINTS}",
            code="bad-points",
        )
    maneuver = store.maneuvers.get(maneuver_id)
    window = (
        -np.inf if start_s is None else start_s,
        np.inf if stop_s is None else stop_s,
    )
    if not window[0] < window[1]:
        raise BadInput(
            f"the window from {start_s} to {stop_s} s is empty; the start must come first",
            code="bad-window",
        )
    selected = channels or list_input_names(store, maneuver)
    excitation = maneuver.excitation
    return ChannelHistories(
        maneuver_id=maneuver_id,
        traces=read_traces(store, maneuver, selected, window),
        excitation_s=None if excitation is None else excitation.interval_s,
        points=points,
    )


def compute_spectrum(
    store: Store, maneuver_id: int, channels: Sequence[str] = (), *, full: bool = False
) -> Spectra:
    """Transform channels at the maneuver's harmonics; the inputs by default.

    A channel is NaN above its Nyquist frequency. With ``full`` the spectrum of the whole record is
    added as background.
    """
    maneuver = store.maneuvers.get(maneuver_id)
    aircraft = store.aircraft.get(maneuver.aircraft_id)
    inputs = list_input_names(store, maneuver)
    rates = find_sampling(store, maneuver, channels or inputs)
    frequencies = _select_frequencies(
        maneuver, min((rate_hz for rate_hz, _ in rates.values()), default=0.0)
    )
    values = np.full((frequencies.omega.size, len(rates)), np.nan, dtype=complex)
    for rate_hz in {rate_hz for rate_hz, _ in rates.values()}:
        seen = frequencies.omega <= np.pi * rate_hz
        below = SpectrumFrequencies(
            frequencies.omega[seen], frequencies.assigned_input[seen], frequencies.inputs
        )
        alike = tuple(name for name, (rate, _) in rates.items() if rate == rate_hz)
        columns = [index for index, name in enumerate(rates) if name in alike]
        found = read_spectra(store, maneuver, aircraft, alike, below).values
        values[np.ix_(seen, np.array(columns))] = found
    background_hz, background = (
        _compute_background(store, maneuver, tuple(rates)) if full else (None, None)
    )
    frequency_hz = frequencies.omega / (2.0 * np.pi)
    return Spectra(
        maneuver_id=maneuver_id,
        inputs=inputs,
        frequency_hz=frequency_hz,
        assigned_inputs=tuple(
            frequencies.inputs[own_input] if own_input >= 0 else ""
            for own_input in frequencies.assigned_input
        ),
        names=tuple(rates),
        units=tuple(unit for _, unit in rates.values()),
        magnitude=np.abs(values),
        noise=_estimate_noise(store, maneuver, frequencies, values),
        background_hz=background_hz,
        background=background,
        band_hz=(float(frequency_hz[0]), float(frequency_hz[-1])) if frequency_hz.size else None,
    )


def estimate_signal_to_noise(
    store: Store, maneuver_id: int, channels: Sequence[str] = ()
) -> SignalToNoise:
    """Estimate signal-to-noise ratios at every harmonic; all inputs and outputs by default.

    Raises
    ------
    BadInput
        If the noise at harmonics cannot be estimated.
    """
    if not channels:
        recorded = store.channels.find(maneuver_id=maneuver_id)
        channels = [c.name for c in recorded if c.role in (Role.INPUT, Role.OUTPUT)]
    found = compute_spectrum(store, maneuver_id, channels)
    if found.noise is None:
        raise BadInput(
            "noise at harmonics can be estimated only with known excitation; import the maneuver "
            "with [excitation]",
            code="no-noise",
        )
    floor = np.where(found.noise > 0, found.noise, np.nan)
    with np.errstate(divide="ignore"):
        decibel = 20.0 * np.log10(found.magnitude / floor)
    return SignalToNoise(
        maneuver_id=maneuver_id,
        names=found.names,
        frequency_hz=found.frequency_hz,
        assigned_inputs=found.assigned_inputs,
        decibel=np.where(np.isfinite(decibel), decibel, np.nan),
    )


def _estimate_noise(
    store: Store, maneuver: Maneuver, frequencies: SpectrumFrequencies, values: np.ndarray
) -> np.ndarray | None:
    """Estimate noise at every harmonic from adjacent responses; None if unknown."""
    aircraft = store.aircraft.get(maneuver.aircraft_id)
    recorded = {c.name: c.rate_hz for c in store.channels.find(maneuver_id=maneuver.id)}
    for name, terms in list_surface_parts(aircraft).items():
        if name not in recorded and all(term in recorded for term, _ in terms):
            recorded[name] = min(recorded[term] for term, _ in terms)
    names = list_excitation_names(frequencies.inputs, recorded)
    if not names or (frequencies.assigned_input < 0).any() or not recorded.keys() >= set(names):
        return None
    if frequencies.omega[-1] > np.pi * min(recorded[name] for name in names):
        return None
    commands = read_spectra(store, maneuver, aircraft, tuple(names), frequencies).values
    own = commands[np.arange(frequencies.omega.size), frequencies.assigned_input]
    return estimate_noise_about_responses(
        frequencies.omega, frequencies.assigned_input, values, own
    )


def _compute_background(
    store: Store, maneuver: Maneuver, names: tuple[str, ...]
) -> tuple[np.ndarray, np.ndarray]:
    """Compute spectra of whole records, with the maximum of the bins of each point."""
    traces = read_traces(store, maneuver, names)
    top_hz = max(0.5 / (trace.time_s[1] - trace.time_s[0]) for trace in traces)
    edges = np.linspace(0.0, top_hz, _BACKGROUND + 1)
    found = np.full((_BACKGROUND, len(traces)), np.nan)
    for column, trace in enumerate(traces):
        step_s = trace.time_s[1] - trace.time_s[0]
        size = np.abs(np.fft.rfft(trace.values - trace.values.mean())) * step_s
        place = np.arange(1, size.size) / (trace.values.size * step_s)
        bins = np.clip(np.searchsorted(edges, place, side="right") - 1, 0, _BACKGROUND - 1)
        largest = np.zeros(_BACKGROUND)
        np.maximum.at(largest, bins, size[1:])
        found[:, column] = np.where(largest > 0, largest, np.nan)
    return 0.5 * (edges[1:] + edges[:-1]), found


def _select_frequencies(maneuver: Maneuver, rate_hz: float) -> SpectrumFrequencies:
    """Return excited harmonics; without known excitation, multiples of one over the record."""
    if maneuver.excitation is not None:
        return select_frequencies(maneuver)
    return select_frequencies(
        maneuver, (_FIRST_CYCLES / maneuver.duration_s, CLEAR_OF_NYQUIST * rate_hz)
    )


# --- Flight envelope of a campaign ----------------------------------------------------------------


def read_envelope(store: Store, **filters: Unpack[ManeuverFilters]) -> Envelope:
    """Read the flight conditions of the listed maneuvers."""
    return Envelope(
        marks=tuple(
            EnvelopeMark(
                maneuver_id=item.id,
                label=item.label,
                fta=item.fta,
                fuel_fraction=item.fuel_fraction,
                airspeed_m_s=item.airspeed_m_s,
                airspeed_ratio=item.airspeed_ratio,
                dynamic_pressure_pa=item.dynamic_pressure_pa,
            )
            for item in store.maneuver_page(limit=None, **filters).items
        )
    )


# --- Windowed frequency responses, and coherence of repeated periods ------------------------------

_STILL = 1e-3  # of the largest rms deflection: a surface below it was not excited
_QUIET = 1e-3  # of the largest input power: frequencies below are not excited
_SPARE_WINDOWS = 6  # beyond two for every input


@dataclass(frozen=True, slots=True)
class MeasuredColumn:
    """Responses of outputs to one input, and their coherence (n_omega, n_y) where known."""

    response: FrequencyResponse
    coherence: np.ndarray | None = None


def measure_windows(
    store: Store, maneuver: Maneuver, aircraft: Aircraft, outputs: tuple[OutputDefinition, ...]
) -> dict[str, MeasuredColumn]:
    """Estimate responses by input to a sweep, doublet or the like from averaged windows.

    Raises
    ------
    BadInput
        If no surface moved, or the record is too short for its inputs.
    """
    surfaces = read_traces(store, maneuver, list_input_names(store, maneuver))
    travel = {s.name: float(np.std(s.values)) for s in surfaces}
    inputs = tuple(n for n, rms in travel.items() if rms > _STILL * max(travel.values()))
    if not inputs:
        raise BadInput("no surface moved in this maneuver", code="no-input")
    names = tuple(output.name for output in outputs)
    traces = resample_to_slowest(read_traces(store, maneuver, (*inputs, *names)))
    samples = np.stack([trace.values for trace in traces], axis=1)
    rate_hz = _get_rate(traces[0])
    window_s = 2.0 * len(samples) / rate_hz / (2 * len(inputs) + _SPARE_WINDOWS + 1)
    found = compute_windowed_responses(
        samples[:, : len(inputs)], samples[:, len(inputs) :], rate_hz, window_s, inputs, names
    )
    power = found.input_power.sum(axis=1)
    excited = power > _QUIET * power.max()
    omega = found.response.omega[excited]
    sensed = np.stack([get_output_instrument(aircraft, o).response(omega) for o in outputs], axis=1)
    assert found.response.std is not None
    columns = {}
    for j, name in enumerate(inputs):
        factor = (1.0 / compute_input_correction(aircraft, name, omega))[:, None] / sensed
        response = FrequencyResponse(
            omega,
            (found.response.values[excited, :, j] * factor)[:, :, None],
            names,
            (name,),
            (found.response.std[excited, :, j] * np.abs(factor))[:, :, None],
        )
        columns[name] = MeasuredColumn(response, found.coherence[excited])
    return columns


def compute_period_coherence(
    store: Store, maneuver: Maneuver, outputs: tuple[str, ...], frequencies: SpectrumFrequencies
) -> np.ndarray | None:
    """Estimate the coherence of outputs over periods; None without repetitions.

    The first of several periods has the transient and is excluded.
    """
    excitation = maneuver.excitation
    if excitation is None or excitation.n_periods < 3:
        return None
    recorded = {c.name for c in store.channels.find(maneuver_id=maneuver.id)}
    commands = [f"{name}_command" for name in frequencies.inputs]
    if not recorded.issuperset(commands):
        commands = list(frequencies.inputs)
    spectra = []
    for number in range(1, excitation.n_periods):
        start_s = excitation.start_s + number * excitation.period_s
        traces = read_traces(
            store, maneuver, (*commands, *outputs), (start_s, start_s + excitation.period_s)
        )
        columns = [
            finite_fourier_transform(
                (t.values - t.values.mean())[:, None],
                _get_rate(t),
                frequencies.omega,
                t.time_s[0] - start_s,
            )[:, 0]
            for t in traces
        ]
        spectra.append(np.stack(columns, axis=1))
    every = np.stack(spectra)
    own = every[:, np.arange(frequencies.omega.size), frequencies.assigned_input]
    return compute_coherence(own, every[:, :, len(commands) :])


def _get_rate(trace: ChannelTrace) -> float:
    return (trace.time_s.size - 1) / float(trace.time_s[-1] - trace.time_s[0])
