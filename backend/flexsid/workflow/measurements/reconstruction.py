"""Reconstruction of a maneuver's motion by a smoother and in the frequency domain (Fig. 16a)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.maneuver import Maneuver
from flexsid.records.reconstruction import ReconstructedTrace, Reconstruction
from flexsid.storage.store import Store
from flexsid.sysid.estimation.reconstruction import ReconstructedMotion, compute_observability
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.derivatives import coefficients
from flexsid.sysid.preparation.motion_filter import Deflections, FilteredMotion, filter_motion
from flexsid.sysid.preparation.resampling import Response, resample
from flexsid.workflow.aircraft.aircraft_models import (
    compute_input_correction,
    get_output_instrument,
)
from flexsid.workflow.measurements.maneuver_data import MeasuredSpectra
from flexsid.workflow.measurements.maneuver_spectra import load_channels
from flexsid.workflow.measurements.recording import remove_trim
from flexsid.workflow.measurements.sensor_responses import (
    SensorData,
    gather_sensors,
    reconstruct_resolved_modes,
)

_OVERSAMPLED = 10.0  # samples per cycle of the highest frequency
_SENSOR_BAND = 5.0  # times the highest frequency: above, sensors have noise alone
_INPUT_BAND = 2.0  # times the highest frequency: above, deflections have noise alone
_INPUT_NOISE = 0.01  # of the deflections, where the noise is not known
_SHORTEST_TRIM_S = 0.25
_DEFAULT_QUANTITIES = ("CZ", "etaddot")


def reconstruct(
    store: Store,
    maneuver_id: int,
    names: Sequence[str] = (),
    modes: Sequence[int] = (),
) -> Reconstruction:
    """Reconstruct quantities of a maneuver; C_Z and etaddot of the first mode by default.

    Raises
    ------
    BadInput
        If a quantity is unknown, or there is no modal table or no sensor with mode shape.
    NotIdentifiable
        If the sensors do not resolve the modes.
    """
    maneuver = store.maneuvers.get(maneuver_id)
    sensing = gather_sensors(store, maneuver)
    model, motion = reconstruct_resolved_modes(sensing, modes)
    offered = _list_quantities(model)
    first = next(iter(model.modes.numbers), None)
    selected = tuple(names) or (
        *_DEFAULT_QUANTITIES[:1],
        *(() if first is None else (f"{_DEFAULT_QUANTITIES[1]}{first}",)),
    )
    for name in selected:
        if name not in offered:
            raise BadInput(
                f"'{name}' is not reconstructed; available are {', '.join(offered)}",
                code="unknown-quantity",
                quantity=name,
            )
    time_s, smoothed = smooth(store, sensing, model, motion)
    rank, condition = compute_observability(
        model, motion.omega, sensing.measured.instruments, motion.noise
    )
    excess = motion.noise / sensing.noise
    return Reconstruction(
        maneuver_id=maneuver_id,
        modes=model.modes.numbers,
        mode_names=tuple(sensing.table.names[number] for number in model.modes.numbers),
        time_s=time_s,
        frequency_hz=motion.omega / (2.0 * np.pi),
        traces=tuple(_build_trace(name, model, motion, smoothed) for name in selected),
        offered=offered,
        n_motions=2 + len(model.modes.numbers),
        rank=rank,
        condition=condition,
        sensors=model.outputs,
        noise_excess=tuple(float(e) if np.isfinite(e) else None for e in excess),
        excluded=sensing.excluded,
    )


def smooth(
    store: Store, sensing: SensorData, model: AeroelasticModel, motion: ReconstructedMotion
) -> tuple[np.ndarray, FilteredMotion]:
    """Filter and smooth all sensors of a maneuver on one clock; return times [s] and motion."""
    maneuver = sensing.maneuver
    top_hz = float(motion.omega[-1]) / (2.0 * np.pi)
    band = (0.0, _SENSOR_BAND * top_hz)
    rate_hz = _OVERSAMPLED * top_hz
    start_s, stop_s = _find_common_interval(store, maneuver, (*model.outputs, *model.inputs))
    clock = _Clock(start_s, rate_hz, int((stop_s - start_s) * rate_hz))
    spectra = sensing.measured
    inputs = Deflections(
        _resample_surfaces(clock, store, sensing, (band[0], _INPUT_BAND * top_hz)),
        spectra.inputs.pick(model.inputs).values,
        _estimate_input_noise(spectra),
    )
    samples = _resample_sensors(clock, store, sensing, band)
    smoothed = filter_motion(
        model, samples, rate_hz, motion, sensing.duration_s, inputs, _get_trim_duration(maneuver)
    )
    return start_s + np.arange(clock.count) / rate_hz, smoothed


def _find_common_interval(
    store: Store, maneuver: Maneuver, names: Sequence[str]
) -> tuple[float, float]:
    """Find the first and last time at which all channels were recorded. [s]"""
    channels = [c for c in store.channels.find(maneuver_id=maneuver.id) if c.name in names]
    start_s = max(c.start_s for c in channels)
    return start_s, min(c.start_s + c.n_samples / c.rate_hz for c in channels)


@dataclass(frozen=True, slots=True)
class _Clock:
    start_s: float
    rate_hz: float
    count: int


def _resample_sensors(
    clock: _Clock, store: Store, sensing: SensorData, band_hz: tuple[float, float]
) -> np.ndarray:
    """Resample all sensors with the instrument responses removed."""
    instruments = {o.name: get_output_instrument(sensing.aircraft, o) for o in sensing.outputs}
    responses = {name: instrument.response for name, instrument in instruments.items()}
    return _resample_channels(clock, store, sensing.maneuver, responses, band_hz)


def _resample_surfaces(
    clock: _Clock, store: Store, sensing: SensorData, band_hz: tuple[float, float]
) -> np.ndarray:
    """Resample deflections with the potentiometer responses removed."""

    def get_response(name: str) -> Response:
        return lambda omega: 1.0 / compute_input_correction(sensing.aircraft, name, omega)

    responses = {name: get_response(name) for name in sensing.model.inputs}
    return _resample_channels(clock, store, sensing.maneuver, responses, band_hz)


def _get_trim_duration(maneuver: Maneuver) -> float:
    """Return the duration of trim, whose mean was removed. [s]"""
    if maneuver.excitation is None:
        return maneuver.duration_s
    trim_s = maneuver.excitation.start_s - maneuver.start_s
    return trim_s if trim_s > _SHORTEST_TRIM_S else maneuver.duration_s


def _estimate_input_noise(spectra: MeasuredSpectra) -> np.ndarray:
    """Estimate the standard deviation of the noise of each surface's spectrum. [rad s]"""
    size = np.sqrt(np.mean(np.abs(spectra.inputs.values) ** 2, axis=0))
    if spectra.input_noise is None:
        return _INPUT_NOISE * size
    return np.maximum(np.sqrt(np.mean(spectra.input_noise, axis=0)), 1e-6 * size)


def _resample_channels(
    clock: _Clock,
    store: Store,
    maneuver: Maneuver,
    responses: dict[str, Response],
    band_hz: tuple[float, float],
) -> np.ndarray:
    """Resample channels on one clock with their responses removed."""
    assert maneuver.id is not None
    columns = [
        resample(
            remove_trim(values, channel.rate_hz, channel.start_s, maneuver),
            channel.rate_hz,
            channel.start_s,
            clock.rate_hz,
            clock.start_s,
            clock.count,
            responses[channel.name],
            (band_hz[0], min(band_hz[1], 0.5 * channel.rate_hz)),
        )
        for channel, values in load_channels(store, maneuver.id, list(responses))
    ]
    return np.reshape(np.array(columns), (len(columns), clock.count)).T


def _list_quantities(model: AeroelasticModel) -> tuple[str, ...]:
    numbers = model.modes.numbers
    modal = [f"{kind}{n}" for kind in ("eta", "etadot", "etaddot") for n in numbers]
    return (*coefficients(numbers), "alpha", "q", "normal_acceleration", "qdot", *modal)


def _build_trace(
    name: str, model: AeroelasticModel, motion: ReconstructedMotion, smoothed: FilteredMotion
) -> ReconstructedTrace:
    column = smoothed.names.index({"normal_acceleration": "normal"}.get(name, name))
    row = _build_row(name, model, motion)
    values = np.einsum("ki,ki->k", row, motion.values)
    variance = np.real(np.einsum("ki,kij,kj->k", row, motion.covariance, row.conj()))
    return ReconstructedTrace(
        name=name,
        unit=_get_unit(name),
        values=smoothed.values[:, column],
        std=smoothed.std[:, column],
        line_magnitude=np.abs(values),
        # half the variance of a complex number is along it
        line_std=np.sqrt(np.maximum(0.5 * variance, 0.0)),
    )


def _build_row(name: str, model: AeroelasticModel, motion: ReconstructedMotion) -> np.ndarray:
    """Build the factors from motion to a quantity at every frequency, (n_omega, n_r)."""
    s = 1j * motion.omega
    n_r = motion.values.shape[1]
    rows = np.zeros((s.size, n_r), dtype=complex)
    numbers = model.modes.numbers
    if name in coefficients(numbers):
        column = coefficients(numbers).index(name)
        return (model.known_dynamics(motion.omega) / model.row_factors()[:, None])[:, column]
    if name == "normal_acceleration":
        return model.known_dynamics(motion.omega)[:, 0] * model.condition.airspeed
    if name in ("alpha", "q", "qdot"):
        rows[:, 0 if name == "alpha" else 1] = s if name == "qdot" else 1.0
        return rows
    kind = name.rstrip("0123456789")
    power = ("eta", "etadot", "etaddot").index(kind)
    rows[:, 2 + numbers.index(int(name[len(kind) :]))] = s**power
    return rows


def _get_unit(name: str) -> str:
    if name == "normal_acceleration":
        return "m/s2"
    units = {"alpha": "rad", "q": "rad/s", "qdot": "rad/s2", "etadot": "1/s", "etaddot": "1/s2"}
    return units.get(name.rstrip("0123456789"), "1")
