"""Reconstruction of a maneuver's motion, in time by a smoother and line by line (Fig. 16a)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.maneuver import Maneuver
from flexsid.records.reconstruction import ReconstructedTrace, Reconstruction
from flexsid.storage.store import Store
from flexsid.sysid.estimation.reconstruction import ReconstructedMotion, observability
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.derivatives import coefficients
from flexsid.sysid.preparation.motion_filter import Deflections, FilteredMotion, filter_motion
from flexsid.sysid.preparation.resampling import Response, resample
from flexsid.workflow.aircraft.aircraft_models import input_correction, output_instrument
from flexsid.workflow.measurements.maneuver_data import MeasuredLines
from flexsid.workflow.measurements.recording import trim_removed
from flexsid.workflow.measurements.sensor_responses import Sensing, motion_of, sense
from flexsid.workflow.measurements.transforms import load_channels

_OVERSAMPLED = 10.0  # samples per cycle of the highest line
_SEEN = 5.0  # times the highest line: above, sensors have noise alone
_DRIVEN = 2.0  # times the highest line: above, deflections have
_INPUT_NOISE = 0.01  # of the deflections, at least where nobody knows it
_SHORTEST_TRIM_S = 0.25
_DRAWN = ("CZ", "etaddot")


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
        If there is no such quantity, no modal table, or no sensor with a place in it.
    NotIdentifiable
        If the sensors cannot tell the modes apart.
    """
    maneuver = store.maneuvers.get(maneuver_id)
    sensing = sense(store, maneuver)
    model, motion = motion_of(sensing, modes)
    offered = _offered(model)
    first = next(iter(model.modes.numbers), None)
    chosen = tuple(names) or (*_DRAWN[:1], *(() if first is None else (f"{_DRAWN[1]}{first}",)))
    for name in chosen:
        if name not in offered:
            raise BadInput(
                f"'{name}' is not reconstructed; there are {', '.join(offered)}",
                code="unknown-quantity",
                quantity=name,
            )
    time_s, smoothed = smooth(store, sensing, model, motion)
    rank, condition = observability(model, motion.omega, sensing.measured.instruments, motion.noise)
    excess = motion.noise / sensing.noise
    return Reconstruction(
        maneuver_id=maneuver_id,
        modes=model.modes.numbers,
        mode_names=tuple(sensing.table.names[number] for number in model.modes.numbers),
        time_s=time_s,
        frequency_hz=motion.omega / (2.0 * np.pi),
        traces=tuple(_trace(name, model, motion, smoothed) for name in chosen),
        offered=offered,
        n_motions=2 + len(model.modes.numbers),
        rank=rank,
        condition=condition,
        sensors=model.outputs,
        noise_excess=tuple(float(e) if np.isfinite(e) else None for e in excess),
        left_out=sensing.left_out,
    )


def smooth(
    store: Store, sensing: Sensing, model: AeroelasticModel, motion: ReconstructedMotion
) -> tuple[np.ndarray, FilteredMotion]:
    """Filter and smooth all sensors of a maneuver on one clock; its times come first. [s]"""
    maneuver = sensing.maneuver
    top_hz = float(motion.omega[-1]) / (2.0 * np.pi)
    band = (0.0, _SEEN * top_hz)
    rate_hz = _OVERSAMPLED * top_hz
    start_s, stop_s = _common(store, maneuver, (*model.outputs, *model.inputs))
    clock = _Clock(start_s, rate_hz, int((stop_s - start_s) * rate_hz))
    lines = sensing.measured
    inputs = Deflections(
        _surfaces_on(clock, store, sensing, (band[0], _DRIVEN * top_hz)),
        lines.inputs.pick(model.inputs).values,
        _input_noise(lines),
    )
    samples = _sensors_on(clock, store, sensing, band)
    smoothed = filter_motion(
        model, samples, rate_hz, motion, sensing.duration_s, inputs, _trim(maneuver)
    )
    return start_s + np.arange(clock.count) / rate_hz, smoothed


def _common(store: Store, maneuver: Maneuver, names: Sequence[str]) -> tuple[float, float]:
    """First and last time that all channels were recorded. [s]"""
    channels = [c for c in store.channels.find(maneuver_id=maneuver.id) if c.name in names]
    start_s = max(c.start_s for c in channels)
    return start_s, min(c.start_s + c.n_samples / c.rate_hz for c in channels)


@dataclass(frozen=True, slots=True)
class _Clock:
    start_s: float
    rate_hz: float
    count: int


def _sensors_on(
    clock: _Clock, store: Store, sensing: Sensing, band_hz: tuple[float, float]
) -> np.ndarray:
    """Samples of all sensors, instruments undone."""
    instruments = {o.name: output_instrument(sensing.aircraft, o) for o in sensing.outputs}
    undone = {name: instrument.response for name, instrument in instruments.items()}
    return _on_one_clock(clock, store, sensing.maneuver, undone, band_hz)


def _surfaces_on(
    clock: _Clock, store: Store, sensing: Sensing, band_hz: tuple[float, float]
) -> np.ndarray:
    """Deflections, potentiometers undone."""

    def undone(name: str) -> Response:
        return lambda omega: 1.0 / input_correction(sensing.aircraft, name, omega)

    undoing = {name: undone(name) for name in sensing.model.inputs}
    return _on_one_clock(clock, store, sensing.maneuver, undoing, band_hz)


def _trim(maneuver: Maneuver) -> float:
    """How long a record was flown in trim, whose mean was taken off. [s]"""
    if maneuver.excitation is None:
        return maneuver.duration_s
    trim_s = maneuver.excitation.start_s - maneuver.start_s
    return trim_s if trim_s > _SHORTEST_TRIM_S else maneuver.duration_s


def _input_noise(lines: MeasuredLines) -> np.ndarray:
    """Standard deviation of the noise of each surface's lines. [rad s]"""
    size = np.sqrt(np.mean(np.abs(lines.inputs.values) ** 2, axis=0))
    if lines.input_noise is None:
        return _INPUT_NOISE * size
    return np.maximum(np.sqrt(np.mean(lines.input_noise, axis=0)), 1e-6 * size)


def _on_one_clock(
    clock: _Clock,
    store: Store,
    maneuver: Maneuver,
    responses: dict[str, Response],
    band_hz: tuple[float, float],
) -> np.ndarray:
    """Samples of channels, what lies between them and the truth undone."""
    assert maneuver.id is not None
    columns = [
        resample(
            trim_removed(values, channel.rate_hz, channel.start_s, maneuver),
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


def _offered(model: AeroelasticModel) -> tuple[str, ...]:
    numbers = model.modes.numbers
    modal = [f"{kind}{n}" for kind in ("eta", "etadot", "etaddot") for n in numbers]
    return (*coefficients(numbers), "alpha", "q", "normal_acceleration", "qdot", *modal)


def _trace(
    name: str, model: AeroelasticModel, motion: ReconstructedMotion, smoothed: FilteredMotion
) -> ReconstructedTrace:
    column = smoothed.names.index({"normal_acceleration": "normal"}.get(name, name))
    row = _row(name, model, motion)
    values = np.einsum("ki,ki->k", row, motion.values)
    variance = np.real(np.einsum("ki,kij,kj->k", row, motion.covariance, row.conj()))
    return ReconstructedTrace(
        name=name,
        unit=_unit(name),
        values=smoothed.values[:, column],
        std=smoothed.std[:, column],
        line_magnitude=np.abs(values),
        # half the variance of a complex number is along it
        line_std=np.sqrt(np.maximum(0.5 * variance, 0.0)),
    )


def _row(name: str, model: AeroelasticModel, motion: ReconstructedMotion) -> np.ndarray:
    """What makes a quantity of the motion at every line, (n_omega, n_r)."""
    s = 1j * motion.omega
    n_r = motion.values.shape[1]
    rows = np.zeros((s.size, n_r), dtype=complex)
    numbers = model.modes.numbers
    if name in coefficients(numbers):
        place = coefficients(numbers).index(name)
        return (model.known_dynamics(motion.omega) / model.row_factors()[:, None])[:, place]
    if name == "normal_acceleration":
        return model.known_dynamics(motion.omega)[:, 0] * model.condition.airspeed
    if name in ("alpha", "q", "qdot"):
        rows[:, 0 if name == "alpha" else 1] = s if name == "qdot" else 1.0
        return rows
    kind = name.rstrip("0123456789")
    power = ("eta", "etadot", "etaddot").index(kind)
    rows[:, 2 + numbers.index(int(name[len(kind) :]))] = s**power
    return rows


def _unit(name: str) -> str:
    if name == "normal_acceleration":
        return "m/s2"
    units = {"alpha": "rad", "q": "rad/s", "qdot": "rad/s2", "etadot": "1/s", "etaddot": "1/s2"}
    return units.get(name.rstrip("0123456789"), "1")
