"""Reconstruction of a maneuver's motion by a smoother and in the frequency domain (Fig. 16a)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Annotated

import numpy as np

from flexsid.allowed import Allowed, Id
from flexsid.errors import BadInput
from flexsid.records import finite_or_none
from flexsid.records.maneuver import Maneuver
from flexsid.records.run import Progress, ReportProgress
from flexsid.records.views import ReconstructedTrace, Reconstruction
from flexsid.storage.store import Store
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.derivatives import ModelAxis
from flexsid.sysid.preparation.motion_filter import Deflections, FilteredMotion, filter_motion
from flexsid.sysid.preparation.resampling import Response, resample, respond_between
from flexsid.sysid.regression.reconstruction import ReconstructedMotion, compute_observability
from flexsid.sysid.spectra.measured_spectra import MeasuredSpectra
from flexsid.workflow.aircraft.aircraft_models import (
    compute_input_correction,
    get_output_instrument,
)
from flexsid.workflow.measurements.maneuver_spectra import load_channels, read_conditioning
from flexsid.workflow.measurements.recording import (
    SHORTEST_TRIM_S,
    Conditioning,
    remove_trim,
)
from flexsid.workflow.measurements.sensor_responses import (
    SensorData,
    gather_sensors,
    reconstruct_resolved_modes,
)

_OVERSAMPLED = 10.0  # samples per cycle of the highest frequency
_SENSOR_BAND = 5.0  # times the highest frequency: above, sensors have noise alone
_INPUT_BAND = 2.0  # times the highest frequency: above, deflections have noise alone
_INPUT_NOISE = 0.01  # of the deflections, where the noise is not known
_UNITS = {
    **dict.fromkeys(("alpha", "beta"), "rad"),
    **dict.fromkeys(("p", "q", "r"), "rad/s"),
    "V": "m/s",
    "Vdot": "m/s2",
    **dict.fromkeys(("pdot", "qdot", "rdot"), "rad/s2"),
    **dict.fromkeys(("normal_acceleration", "lateral_acceleration"), "m/s2"),
    "etadot": "1/s",
    "etaddot": "1/s2",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class ReconstructionQuery:
    """Maneuver, and numbers of the modes; by default those that its sensors resolve.

    ``axis`` selects the half of a maneuver that excites both axes, by default the longitudinal one.
    """

    maneuver_id: Id
    modes: Annotated[tuple[Id, ...], Allowed(text="Mode numbers; by default as resolved.")] = ()
    axis: Annotated[
        ModelAxis | None,
        Allowed(text="Half of a combined maneuver; by default the longitudinal one."),
    ] = None


def reconstruct(
    store: Store, query: ReconstructionQuery, report: ReportProgress = lambda progress: None
) -> Reconstruction:
    """Reconstruct all quantities of a maneuver.

    Raises
    ------
    BadInput
        If there is no modal table or no sensor with mode shape.
    NotIdentifiable
        If the sensors do not resolve the modes.
    """
    sensing = gather_sensors(store, store.maneuvers.get(query.maneuver_id), query.axis)
    model, motion = reconstruct_resolved_modes(sensing, query.modes)
    offered = _list_quantities(model)
    report(Progress(fraction=0.5, message="Smoothing the motion"))
    time_s, smoothed = smooth(store, sensing, model, motion)
    rank, condition = compute_observability(
        model, motion.omega, sensing.measured.instruments, motion.noise
    )
    return Reconstruction(
        maneuver_id=query.maneuver_id,
        modes=model.modes.numbers,
        mode_names=tuple(sensing.table.names[number] for number in model.modes.numbers),
        time_s=time_s,
        frequency_hz=motion.omega / (2.0 * np.pi),
        traces=tuple(_build_trace(name, model, motion, smoothed) for name in offered),
        offered=offered,
        n_motions=len(model.motions),
        rank=rank,
        condition=condition,
        sensors=model.outputs,
        noise_excess=tuple(finite_or_none(e) for e in motion.noise / sensing.noise),
        excluded=sensing.excluded,
    )


def select_quantities(found: Reconstruction, names: Sequence[str] = ()) -> Reconstruction:
    """Return a reconstruction with some of its quantities.

    By default the force, and etaddot of the first mode.

    Raises
    ------
    BadInput
        If a quantity is unknown.
    """
    selected = tuple(names) or (found.offered[0], *(f"etaddot{n}" for n in found.modes[:1]))
    for name in selected:
        if name not in found.offered:
            raise BadInput(
                f"'{name}' is not reconstructed; available are {', '.join(found.offered)}",
                code="unknown-quantity",
                quantity=name,
            )
    traces = {trace.name: trace for trace in found.traces}
    return replace(found, traces=tuple(traces[name] for name in selected))


def smooth(
    store: Store, sensing: SensorData, model: AeroelasticModel, motion: ReconstructedMotion
) -> tuple[np.ndarray, FilteredMotion]:
    """Filter and smooth all sensors of a maneuver on one clock; return times [s] and motion."""
    maneuver, aircraft, spectra = sensing.maneuver, sensing.aircraft, sensing.measured
    top_hz = float(motion.omega[-1]) / (2.0 * np.pi)
    rate_hz = _OVERSAMPLED * top_hz
    sensors: dict[str, Response] = {
        o.name: get_output_instrument(aircraft, o).response for o in sensing.outputs
    }
    recorded = load_channels(store, maneuver.id, [*sensors, *model.inputs])
    steps = read_conditioning(store, maneuver.id)
    rates = {channel.name: channel.rate_hz for channel, _ in recorded}

    def respond(name: str, omega: np.ndarray) -> np.ndarray:
        between = respond_between(omega / rates[name], steps.get(name, Conditioning()).between)
        return 1.0 / (compute_input_correction(aircraft, name, omega) * between)

    surfaces: dict[str, Response] = {name: partial(respond, name) for name in model.inputs}
    start_s = max(channel.start_s for channel, _ in recorded)
    stop_s = min(channel.stop_s for channel, _ in recorded)
    count = int((stop_s - start_s) * rate_hz)

    def resample_channels(responses: dict[str, Response], high_hz: float) -> np.ndarray:
        """Resample channels on one clock with the responses of their instruments removed."""
        columns = [
            resample(
                remove_trim(values, channel.rate_hz, channel.start_s, maneuver),
                channel.rate_hz,
                channel.start_s,
                rate_hz,
                start_s,
                count,
                responses[channel.name],
                (0.0, min(high_hz, 0.5 * channel.rate_hz)),
            )
            for channel, values in recorded
            if channel.name in responses
        ]
        return np.reshape(np.array(columns), (len(columns), count)).T

    inputs = Deflections(
        resample_channels(surfaces, _INPUT_BAND * top_hz),
        spectra.inputs.pick(model.inputs).values,
        _estimate_input_noise(spectra),
    )
    samples = resample_channels(sensors, _SENSOR_BAND * top_hz)
    duration_s, trim_s = maneuver.transformed_s, _get_trim_duration(maneuver)
    smoothed = filter_motion(model, samples, rate_hz, motion, duration_s, inputs, trim_s)
    return start_s + np.arange(count) / rate_hz, smoothed


def _get_trim_duration(maneuver: Maneuver) -> float:
    """Return the duration of trim, whose mean was removed. [s]"""
    if maneuver.excitation is None:
        return maneuver.duration_s
    trim_s = maneuver.excitation.start_s - maneuver.start_s
    return trim_s if trim_s >= SHORTEST_TRIM_S else maneuver.duration_s


def _estimate_input_noise(spectra: MeasuredSpectra) -> np.ndarray:
    """Estimate the standard deviation of the noise of each surface's spectrum. [rad s]"""
    size = np.sqrt(np.mean(np.abs(spectra.inputs.values) ** 2, axis=0))
    if spectra.input_noise is None:
        return _INPUT_NOISE * size
    return np.maximum(np.sqrt(np.mean(spectra.input_noise, axis=0)), 1e-6 * size)


def _list_quantities(model: AeroelasticModel) -> tuple[str, ...]:
    numbers = model.modes.numbers
    modal = [f"{kind}{n}" for kind in ("eta", "etadot", "etaddot") for n in numbers]
    body = model.body
    own = (f"{body.acceleration}_acceleration",) if body.acceleration else ()
    accelerations = (f"{m}dot" for m in body.motions[1:])
    return (*model.coefficients, *body.motions, *own, *accelerations, *modal)


def _build_trace(
    name: str, model: AeroelasticModel, motion: ReconstructedMotion, smoothed: FilteredMotion
) -> ReconstructedTrace:
    column = smoothed.names.index(name.removesuffix("_acceleration"))
    row = _build_row(name, model, motion)
    values = np.einsum("ki,ki->k", row, motion.values)
    variance = np.real(np.einsum("ki,kij,kj->k", row, motion.covariance, row.conj()))
    return ReconstructedTrace(
        name=name,
        unit=_UNITS.get(name.rstrip("0123456789"), "1"),
        values=smoothed.values[:, column],
        std=smoothed.std[:, column],
        spectrum_magnitude=np.abs(values),
        # half the variance of a complex number is along it
        spectrum_std=np.sqrt(np.maximum(0.5 * variance, 0.0)),
    )


def _build_row(name: str, model: AeroelasticModel, motion: ReconstructedMotion) -> np.ndarray:
    """Build the factors from motion to a quantity at every frequency, (n_omega, n_r)."""
    s = 1j * motion.omega
    numbers = model.modes.numbers
    motions = model.body.motions
    rows = np.zeros((s.size, len(model.motions)), dtype=complex)
    if name in model.coefficients:
        column = model.coefficients.index(name)
        return (model.known_dynamics(motion.omega) / model.row_factors()[:, None])[:, column]
    if name.endswith("_acceleration"):
        return model.known_dynamics(motion.omega)[:, 0] * model.condition.airspeed
    if name.removesuffix("dot") in motions:
        rows[:, motions.index(name.removesuffix("dot"))] = s if name.endswith("dot") else 1.0
        return rows
    kind = name.rstrip("0123456789")
    power = ("eta", "etadot", "etaddot").index(kind)
    rows[:, len(motions) + numbers.index(int(name[len(kind) :]))] = s**power
    return rows
