"""Windowed frequency responses, and coherence of repeated periods."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.aircraft import Aircraft
from flexsid.records.maneuver import Maneuver
from flexsid.records.views import ChannelTrace
from flexsid.storage.store import Store
from flexsid.sysid.signals import FrequencyResponse
from flexsid.sysid.spectra.fourier import finite_fourier_transform
from flexsid.sysid.spectra.repetition import compute_coherence
from flexsid.sysid.spectra.windowed_spectra import compute_windowed_responses
from flexsid.workflow.aircraft.aircraft_models import (
    OutputDefinition,
    compute_input_correction,
    get_output_instrument,
)
from flexsid.workflow.measurements.recording import SpectrumFrequencies
from flexsid.workflow.views.channels import list_input_names, read_traces, resample_to_slowest

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
