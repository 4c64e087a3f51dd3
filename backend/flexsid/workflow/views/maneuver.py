"""Time histories and spectra of the channels of a maneuver."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.aircraft import list_surface_parts
from flexsid.records.maneuver import Maneuver, Role
from flexsid.records.quality import SignalToNoise
from flexsid.records.views import ChannelHistories, Spectra
from flexsid.storage.store import Store
from flexsid.sysid.spectra.residual_spectrum import estimate_noise_about_responses
from flexsid.workflow.measurements.maneuver_spectra import read_spectra
from flexsid.workflow.measurements.recording import (
    SpectrumFrequencies,
    list_excitation_names,
    select_frequencies,
)
from flexsid.workflow.views.channels import find_sampling, list_input_names, read_traces

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
