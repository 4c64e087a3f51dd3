"""What does not come from single lines: windowed responses, and coherence of repetitions."""

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
from flexsid.sysid.spectra.repeated import coherence
from flexsid.sysid.spectra.windowed import windowed_responses
from flexsid.workflow.aircraft.aircraft_models import (
    OutputDefinition,
    input_correction,
    output_instrument,
)
from flexsid.workflow.measurements.recording import SpectrumFrequencies
from flexsid.workflow.views.channels import input_names, on_one_clock, read_channels

_STILL = 1e-3  # of the busiest surface: one that moves less was not flown
_QUIET = 1e-3  # of the largest input power: lines below have no excitation worth a response
_SPARE_WINDOWS = 6  # beyond two for every input


@dataclass(frozen=True, slots=True)
class WindowedMeasurement:
    """Columns of responses by input, and ``coherence`` (n_omega, n_y) with all inputs."""

    columns: dict[str, FrequencyResponse]
    coherence: np.ndarray


def measure_windows(
    store: Store, maneuver: Maneuver, aircraft: Aircraft, outputs: tuple[OutputDefinition, ...]
) -> WindowedMeasurement:
    """Responses of a sweep, a doublet or anything else from averaged windows.

    Raises
    ------
    BadInput
        If no surface moved, or the record is too short for its inputs.
    """
    surfaces = read_channels(store, maneuver, input_names(store, maneuver))
    travel = {s.name: float(np.std(s.values)) for s in surfaces}
    inputs = tuple(n for n, rms in travel.items() if rms > _STILL * max(travel.values()))
    if not inputs:
        raise BadInput("no surface moved in this maneuver", code="no-input")
    names = tuple(output.name for output in outputs)
    traces = on_one_clock(read_channels(store, maneuver, (*inputs, *names)))
    samples = np.stack([trace.values for trace in traces], axis=1)
    rate_hz = _rate(traces[0])
    window_s = 2.0 * len(samples) / rate_hz / (2 * len(inputs) + _SPARE_WINDOWS + 1)
    found = windowed_responses(
        samples[:, : len(inputs)], samples[:, len(inputs) :], rate_hz, window_s, inputs, names
    )
    power = found.input_power.sum(axis=1)
    keep = power > _QUIET * power.max()
    omega = found.response.omega[keep]
    sensed = np.stack([output_instrument(aircraft, o).response(omega) for o in outputs], axis=1)
    assert found.response.std is not None
    columns = {}
    for j, name in enumerate(inputs):
        factor = (1.0 / input_correction(aircraft, name, omega))[:, None] / sensed
        columns[name] = FrequencyResponse(
            omega,
            (found.response.values[keep, :, j] * factor)[:, :, None],
            names,
            (name,),
            (found.response.std[keep, :, j] * np.abs(factor))[:, :, None],
        )
    return WindowedMeasurement(columns, found.coherence[keep])


def period_coherence(
    store: Store, maneuver: Maneuver, outputs: tuple[str, ...], lines: SpectrumFrequencies
) -> np.ndarray | None:
    """Share of each output that repeats from period to period; None without repetitions.

    The first of several periods is the transient's and is left out.
    """
    excitation = maneuver.excitation
    if excitation is None or excitation.n_periods < 3:
        return None
    recorded = {c.name for c in store.channels.find(maneuver_id=maneuver.id)}
    commands = [f"{name}_command" for name in lines.inputs]
    if not recorded.issuperset(commands):
        commands = list(lines.inputs)
    spectra = []
    for number in range(1, excitation.n_periods):
        start_s = excitation.start_s + number * excitation.period_s
        traces = read_channels(
            store, maneuver, (*commands, *outputs), (start_s, start_s + excitation.period_s)
        )
        columns = [
            finite_fourier_transform(
                (t.values - t.values.mean())[:, None], _rate(t), lines.omega, t.time_s[0] - start_s
            )[:, 0]
            for t in traces
        ]
        spectra.append(np.stack(columns, axis=1))
    every = np.stack(spectra)
    own = every[:, np.arange(lines.omega.size), lines.owner]
    return coherence(own, every[:, :, len(commands) :])


def _rate(trace: ChannelTrace) -> float:
    return (trace.time_s.size - 1) / float(trace.time_s[-1] - trace.time_s[0])
