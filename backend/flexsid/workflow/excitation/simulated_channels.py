"""Recorded channels of a pre-flight simulation: instruments, noise and errors of recording."""

from __future__ import annotations

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.aircraft import Aircraft
from flexsid.records.maneuver import Role
from flexsid.sysid.model.instruments import Instrument
from flexsid.sysid.simulation.preflight_simulation import SimulatedFlight
from flexsid.sysid.simulation.recording import (
    SensorErrors,
    apply_instruments,
    apply_sensor_errors,
)
from flexsid.workflow.aircraft.aircraft_models import define_outputs, get_output_instrument
from flexsid.workflow.excitation.predicted_accuracy import PredictionModel

# They separate the seeds of dropouts and of the noise of surfaces from that of the outputs.
_DROPOUT_SEED, _SURFACE_SEED = 811, 821


def simulate_channels(
    at: PredictionModel,
    aircraft: Aircraft,
    moved: SimulatedFlight,
    excitation: np.ndarray,
    rate: float,
    errors: tuple[SensorErrors, ...],
) -> list[tuple[str, str, Role, np.ndarray]]:
    """Simulate the recorded channels: surfaces, noisy outputs, excitation; in SI."""
    model, surfaces = at.model, {surface.name: surface for surface in aircraft.surfaces}
    true = np.stack(
        [
            moved.commands[:, k] if surfaces[name].actuator is not None else moved.deflections[:, k]
            for k, name in enumerate(model.inputs)
        ],
        axis=1,
    )
    sensed = [
        aircraft.instruments.get(surfaces[n].instrument or "", Instrument()) for n in model.inputs
    ]
    seen = apply_instruments(true, rate, sensed)
    rng = np.random.default_rng([at.run.id or 0, _SURFACE_SEED])
    seen += rng.normal(size=seen.shape) * [surfaces[n].noise_std_rad or 0.0 for n in model.inputs]
    outputs = define_outputs(aircraft, model.outputs)
    read = apply_instruments(
        moved.outputs, rate, [get_output_instrument(aircraft, o) for o in outputs]
    )
    read += _simulate_unmodelled(at, excitation, rate) + _draw_noise(at, read.shape[0], rate)
    read = _disturb_outputs(at, read, rate, errors)
    rows = [(name, "rad", Role.INPUT, seen[:, k]) for k, name in enumerate(model.inputs)]
    rows += [(o.name, o.model.units[0], Role.OUTPUT, read[:, k]) for k, o in enumerate(outputs)]
    rows += [
        (f"{name}_command", "rad", Role.COMMAND, excitation[:, k])
        for k, name in enumerate(model.inputs)
    ]
    return rows


def _disturb_outputs(
    at: PredictionModel, read: np.ndarray, rate: float, errors: tuple[SensorErrors, ...]
) -> np.ndarray:
    """Apply errors of recording to outputs."""
    found = read.copy()
    rng = np.random.default_rng([at.run.id or 0, _DROPOUT_SEED])
    for name, one in _select_errors(at, errors).items():
        column = [at.model.outputs.index(name)]
        found[:, column] = apply_sensor_errors(read[:, column], rate, one, rng)
    return found


def compute_quantisation_density(
    at: PredictionModel, errors: tuple[SensorErrors, ...], rate: float
) -> np.ndarray:
    """Compute the spectral density of the noise by quantisation of each output: q^2/(12 rate)."""
    of_channel = _select_errors(at, errors)
    quanta = [of_channel[o].quantum if o in of_channel else 0.0 for o in at.model.outputs]
    return np.square(quanta) / (12.0 * rate)


def _select_errors(
    at: PredictionModel, errors: tuple[SensorErrors, ...]
) -> dict[str, SensorErrors]:
    """Select the errors of each channel: the last that names it.

    Raises
    ------
    BadInput
        If an error names a channel that is no output of the model.
    """
    outputs = at.model.outputs
    of_channel: dict[str, SensorErrors] = {}
    for one in errors:
        for name in one.channels or outputs:
            if name not in outputs:
                raise BadInput(
                    f"the model of run {at.run.id} has no output '{name}' for sensor errors; it has"
                    f" {', '.join(outputs)}",
                    code="unknown-channel",
                    channel=name,
                )
            of_channel[name] = one
    return of_channel


def _simulate_unmodelled(at: PredictionModel, excitation: np.ndarray, rate: float) -> np.ndarray:
    """Simulate the response that the run's model does not explain, by command."""
    n_samples = excitation.shape[0]
    omega = 2.0 * np.pi * np.fft.rfftfreq(n_samples, 1.0 / rate)
    inside = (omega >= at.band[0]) & (omega <= at.band[1])
    commands = np.fft.rfft(excitation, axis=0)[inside]
    spectrum = np.zeros((omega.size, len(at.model.outputs)), dtype=complex)
    for name, missed in at.noise_model.unmodelled_responses.items():
        own = commands[:, [at.model.inputs.index(name)]]
        spectrum[inside] += missed(omega[inside]) * own
    return np.fft.irfft(spectrum, n_samples, axis=0)


def _draw_noise(at: PredictionModel, n_samples: int, rate: float) -> np.ndarray:
    """Draw noise with the run's spectral density matrix from a fixed seed."""
    rng = np.random.default_rng([at.run.id or 0, n_samples])
    omega = 2.0 * np.pi * np.fft.rfftfreq(n_samples, 1.0 / rate)[1:-1]
    density = at.noise_model.noise(omega)
    n_y = density.shape[1]
    values, vectors = np.linalg.eigh(density)
    root = vectors * np.sqrt(np.maximum(values, 0.0))[:, None, :]
    white = rng.normal(size=(omega.size, n_y)) + 1j * rng.normal(size=(omega.size, n_y))
    spectrum = np.zeros((n_samples // 2 + 1, n_y), dtype=complex)
    # A sequence of density S has sums over T of variance S T; its rfft is rate times that.
    spectrum[1:-1] = np.sqrt(0.5 * n_samples * rate) * np.einsum("kij,kj->ki", root, white)
    return np.fft.irfft(spectrum, n_samples, axis=0)
