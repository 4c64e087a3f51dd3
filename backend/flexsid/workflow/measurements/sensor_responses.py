"""Spectra of all single sensors of a maneuver, with a model of their response."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from flexsid.errors import BadInput, NotIdentifiable
from flexsid.records.aircraft import Aircraft, get_symmetry, list_surface_parts
from flexsid.records.maneuver import Channel, Maneuver, Role
from flexsid.storage.store import Store
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.longitudinal import LONGITUDINAL
from flexsid.sysid.model.rigid_body import RigidBody, SensorRows
from flexsid.sysid.preparation.redundancy import select_strong_frequencies
from flexsid.sysid.regression.reconstruction import ReconstructedMotion, reconstruct_motion
from flexsid.sysid.signals import FrequencyData
from flexsid.sysid.spectra.measured_spectra import MeasuredSpectra
from flexsid.workflow.aircraft.aircraft_models import OutputDefinition, build_model, define_outputs
from flexsid.workflow.aircraft.axes import (
    find_body,
    find_other,
    is_axis_sensor,
    list_moved_surfaces,
    list_opposed_surfaces,
    reads_own_motion_only,
    require_axis,
)
from flexsid.workflow.measurements.maneuver_spectra import load_channels, read_measurement
from flexsid.workflow.measurements.measured_axis import require_own_motion
from flexsid.workflow.measurements.recording import (
    compute_spectral_noise,
    select_frequencies,
)
from flexsid.workflow.modal_data.modal_tables import (
    AircraftModes,
    load_modes_of_model,
    select_out_of_band_modes,
)

_MAX_FREQUENCY_RATIO = 0.4  # of the sampling rate
_MIN_CYCLES = 4.0  # cycles per record of what sensors and surfaces are assessed at
_LOWEST_HZ = 0.25  # the phugoid lies below, which models without airspeed do not have
_SMOOTHED = 9  # frequencies over which power is averaged
_MIN_INPUT_POWER = 1e-2  # of the largest power of the surfaces: not excited below
_SIGNAL_OVER_NOISE = 4.0  # times the power of the noise: 6 dB
_MIN_OUTPUTS_WITH_SIGNAL = 0.5  # of the outputs with signal above noise
_MIN_FREQUENCIES = 10  # fewer do not resolve a delay from an amplitude
_MAX_NOISE_RATIO = 1.3  # times the noise of a sensor: unmodelled modes above
_EQUIVALENT_RATIO = 1.15  # times the least residual of models with more modes
_EQUAL_ROWS = 1.0 - 1e-6  # cosine between two sensor rows above which they are equal
_MIN_REDUNDANT = 1  # fewest redundant independent sensors


@dataclass(frozen=True, slots=True)
class SensorData:
    """Spectra of the single sensors of a maneuver; ``excluded`` has reasons by channel.

    ``modes`` are all that the sensors could resolve, lowest first; the model has the first of
    them. ``noise`` is the standard deviation of each sensor's spectrum by the aircraft record
    at the rate of the slowest sensor, NaN where it is not known. [output unit * s]
    ``independent`` is the number of linearly independent sensors.
    """

    maneuver: Maneuver
    aircraft: Aircraft
    table: AircraftModes
    modes: tuple[int, ...]
    model: AeroelasticModel
    outputs: tuple[OutputDefinition, ...]
    measured: MeasuredSpectra
    noise: np.ndarray
    excluded: dict[str, str]
    independent: int

    def select(self, some: np.ndarray) -> SensorData:
        """Select some of the frequencies."""
        return replace(self, measured=self.measured.select(some))

    def with_outputs(self, values: np.ndarray) -> SensorData:
        """Replace the spectra of the outputs, (n_omega, n_y)."""
        names = self.measured.outputs.names
        outputs = FrequencyData(self.measured.omega, values, names)
        return replace(self, measured=replace(self.measured, outputs=outputs))

    def with_modes(self, numbers: tuple[int, ...]) -> AeroelasticModel:
        """Build a model of other modes for the same sensors."""
        condition = self.maneuver.condition
        shapes = self.table.table.at(condition.fuel_fraction).select(numbers)
        return build_model(
            self.aircraft, condition, shapes, self.model.inputs, self.outputs, self.model.body
        )


def gather_sensors(store: Store, maneuver: Maneuver, axis: str | None = None) -> SensorData:
    """Gather all sensors of a maneuver that have a mode shape.

    Parameters
    ----------
    store, maneuver
        Maneuver.
    axis
        Axis of the model; by default that of the maneuver, the longitudinal one if it has both.

    Raises
    ------
    BadInput
        If no sensor is usable.
    AxisNotSupported
        If the maneuver has another axis.
    """
    body = find_body(maneuver.axis if axis is None else axis)
    if axis is not None:
        require_axis(body, (maneuver,))
    aircraft = store.aircraft.get(maneuver.aircraft_id)
    table, _ = load_modes_of_model(store, maneuver.aircraft_id, None, None, ())
    channels = {c.name: c for c in store.channels.find(maneuver_id=maneuver.id)}
    recorded = _list_recorded_surfaces(aircraft, channels.values())
    inputs = list_moved_surfaces(aircraft, maneuver.axis, maneuver.excitation, recorded)
    opposed = list_opposed_surfaces(maneuver, aircraft, inputs, body)
    names, excluded = _select_usable_sensors(aircraft, channels, table, opposed, body)
    for name in opposed:
        symmetry = get_symmetry(aircraft, name)
        if symmetry != "single":
            excluded[name] = f"it is {symmetry} and excites no {body.symmetry} motion"
    for channel, samples in load_channels(store, maneuver.id, (*names, *recorded)):
        if not np.ptp(samples) > 0.0:
            excluded[channel.name] = "it is constant over the record"
    names = tuple(name for name in names if name not in excluded)
    parts = list_surface_parts(aircraft)
    inputs = tuple(
        name
        for name in inputs
        if not all(term in excluded for term, _ in parts.get(name, ((name, 1.0),)))
    )
    recorded = tuple(name for name in recorded if name not in excluded)
    if not names:
        raise BadInput(
            "no channel of this maneuver belongs to a sensor with a mode shape in the modal table",
            code="no-sensors",
        )
    outputs = define_outputs(aircraft, names)
    require_own_motion(store, maneuver, aircraft, inputs, outputs, body)
    band = _select_default_band(maneuver, [channels[name] for name in (*names, *recorded)])
    measured = read_measurement(store, maneuver, aircraft, inputs, outputs, band, body).transform()
    rate_hz = min(channels[name].rate_hz for name in names)
    noise = compute_spectral_noise(outputs, rate_hz, maneuver.transformed_s)
    if maneuver.excitation is None:
        band = _find_band_above_noise(measured, noise, body)
        measured = read_measurement(
            store, maneuver, aircraft, inputs, outputs, band, body
        ).transform()
    fuel = maneuver.condition.fuel_fraction
    shapes = table.table.at(fuel)
    lowest_first = sorted(zip(shapes.omega, shapes.numbers, strict=True))
    own = tuple(number for _, number in lowest_first if table.belongs_to(number, body))

    def build(numbers: tuple[int, ...]) -> AeroelasticModel:
        return build_model(
            aircraft, maneuver.condition, shapes.select(numbers), inputs, outputs, body
        )

    independent = _count_independent(build(own).sensors)
    near = select_out_of_band_modes(table, fuel, (), float(measured.omega[-1]), independent, body)
    return SensorData(
        maneuver=maneuver,
        aircraft=aircraft,
        table=table,
        modes=own[: max(0, independent - body.size - _MIN_REDUNDANT)],
        model=build(near),
        outputs=outputs,
        measured=measured,
        noise=noise,
        excluded=excluded,
        independent=independent,
    )


def _list_recorded_surfaces(aircraft: Aircraft, channels: Iterable[Channel]) -> tuple[str, ...]:
    known = {surface.name for surface in aircraft.surfaces}
    return tuple(c.name for c in channels if c.role is Role.INPUT and c.name in known)


def _count_independent(sensors: SensorRows) -> int:
    """Count the sensors whose output rows are independent.

    A left and a right sensor measure the same motion of one axis: they are redundant, but
    resolve no further mode. The rows are those of all known modes.
    """
    rows = sensors.polynomial.transpose(1, 0, 2).reshape(len(sensors.names), -1)
    size = np.linalg.norm(rows, axis=1)
    rows = rows[size > 0] / size[size > 0, None]
    same = np.abs(rows @ rows.T) > _EQUAL_ROWS
    return int(np.sum(~np.any(np.tril(same, -1), axis=1)))


def find_excited_band(
    store: Store, maneuver: Maneuver, aircraft: Aircraft, body: RigidBody
) -> tuple[float, float]:
    """Find the band that a model of a body describes, of an unknown excitation. [Hz]

    It begins at the resolution 1/T of the record; for models without the phugoid at the last
    multiple of it up to ``_LOWEST_HZ``. It ends where the power of the surfaces has a gap.

    Raises
    ------
    BadInput
        If no surface was recorded.
    """
    channels = store.channels.find(maneuver_id=maneuver.id)
    names = _list_recorded_surfaces(aircraft, channels)
    if not names:
        raise BadInput("the maneuver has no recorded input", code="no-input")
    moving = [c for c in channels if c.role in (Role.INPUT, Role.COMMAND)]
    band = _select_default_band(maneuver, moving)
    spectra = read_measurement(store, maneuver, aircraft, names, (), band).transform()
    power = np.abs(spectra.inputs.values) ** 2
    power = np.sum(power / np.maximum(power.max(axis=0), 1e-300), axis=1)
    smooth = np.convolve(power, np.ones(_SMOOTHED) / _SMOOTHED, mode="same")
    # Removing filters amplifies noise at high frequency: the band ends at the first gap. What is
    # slower than a few cycles per record, a drift or a held deflection, does not scale the power.
    quiet = np.flatnonzero(smooth[np.argmax(smooth) :] < _MIN_INPUT_POWER * smooth.max())
    top = smooth.size - 1 if quiet.size == 0 else int(np.argmax(smooth)) + int(quiet[0])
    first = max(1, math.floor(_get_lowest_hz(body) * maneuver.duration_s + 1e-9))
    return first / maneuver.duration_s, float(spectra.omega[top] / (2.0 * np.pi))


def _get_lowest_hz(body: RigidBody) -> float:
    return _LOWEST_HZ if body is LONGITUDINAL else 0.0


def reconstruct_resolved_modes(
    sensing: SensorData, modes: Sequence[int] = ()
) -> tuple[AeroelasticModel, ReconstructedMotion]:
    """Reconstruct the motion in the frequency domain with as many modes as are resolved.

    Parameters
    ----------
    sensing
        Spectra of the sensors.
    modes
        Numbers of the modes; by default those near the band, and higher ones while the
        residual of a sensor exceeds its noise and a further mode reduces it.

    Returns
    -------
    model, motion
        The model with its modes.

    Raises
    ------
    NotIdentifiable
        If the sensors do not resolve the modes.
    """
    if modes:
        model = sensing.with_modes(tuple(modes))
        return model, _reconstruct(sensing, model)
    model, motion = _select_number_of_modes(
        sensing.select(select_strong_frequencies(sensing.measured.outputs.values))
    )
    return model, _reconstruct(sensing, model, motion.noise)


def _select_number_of_modes(sensing: SensorData) -> tuple[AeroelasticModel, ReconstructedMotion]:
    model = sensing.model
    while True:
        try:
            motion = _reconstruct(sensing, model)
            break
        except NotIdentifiable:
            if not model.modes.numbers:
                raise
            model = sensing.with_modes(model.modes.numbers[:-1])
    tried = [(model, motion)]
    if not np.isfinite(sensing.noise).any():
        return tried[0]
    for count in range(len(model.modes.numbers) + 1, len(sensing.modes) + 1):
        if _compute_noise_ratio(sensing, motion).max() <= _MAX_NOISE_RATIO:
            break
        try:
            model = sensing.with_modes(sensing.modes[:count])
            motion = _reconstruct(sensing, model, motion.noise)
        except NotIdentifiable:
            break
        tried.append((model, motion))
    # The residual of a faulty sensor stays large with any number of modes, and modes that fit
    # its fault reduce the redundancy of the others: the fewest modes beyond which further modes
    # do not reduce the residuals.
    excess = np.array([_compute_noise_ratio(sensing, motion) for _, motion in tried])
    least = np.minimum.accumulate(excess[::-1], axis=0)[::-1]
    enough = np.all(excess <= np.maximum(_MAX_NOISE_RATIO, _EQUIVALENT_RATIO * least), axis=1)
    return tried[int(np.argmax(enough))]


def _compute_noise_ratio(sensing: SensorData, motion: ReconstructedMotion) -> np.ndarray:
    """Compute residual over noise of the sensors whose noise is known."""
    known = np.isfinite(sensing.noise)
    return motion.noise[known] / sensing.noise[known]


def _reconstruct(
    sensing: SensorData, model: AeroelasticModel, guess: np.ndarray | None = None
) -> ReconstructedMotion:
    """Reconstruct motion with sensors weighted by the larger of noise and residual.

    Residuals alone may give zero noise for a sensor that is fitted exactly.
    """
    spectra = sensing.measured
    found = reconstruct_motion(model, spectra.outputs, spectra.instruments, guess=guess)
    least = np.where(np.isfinite(sensing.noise), sensing.noise, 0.0)
    if np.all(found.noise >= least):
        return found
    noise = np.maximum(found.noise, least)
    return reconstruct_motion(model, spectra.outputs, spectra.instruments, noise)


def _find_band_above_noise(
    spectra: MeasuredSpectra, noise: np.ndarray, body: RigidBody
) -> tuple[float, float]:
    """Find the band in which outputs exceed their noise, for an unknown excitation.

    The noise of an output is its known noise, or the level at the top of the spectrum.

    Raises
    ------
    BadInput
        If there is no such band.
    """
    kernel = np.ones(_SMOOTHED) / _SMOOTHED
    power = np.stack(
        [np.convolve(p, kernel, mode="same") for p in np.abs(spectra.outputs.values.T) ** 2], axis=1
    )
    top = power[-max(_SMOOTHED, len(power) // 4) :]
    floor = np.maximum(np.median(top, axis=0), np.nan_to_num(noise) ** 2)
    hz = spectra.omega / (2.0 * np.pi)
    above = np.mean(power > _SIGNAL_OVER_NOISE * floor, axis=1) >= _MIN_OUTPUTS_WITH_SIGNAL
    edges = np.flatnonzero(np.diff(np.r_[False, above & (hz >= _get_lowest_hz(body)), False]))
    first, stop = edges[::2], edges[1::2]
    if not first.size or np.max(stop - first) < _MIN_FREQUENCIES:
        raise BadInput(
            "the outputs of this record have no signal above their noise over a band of "
            f"{_MIN_FREQUENCIES} frequencies",
            code="no-signal",
        )
    widest = int(np.argmax(stop - first))
    return float(hz[first[widest]]), float(hz[stop[widest] - 1])


def _select_usable_sensors(
    aircraft: Aircraft,
    channels: dict[str, Channel],
    table: AircraftModes,
    opposed: tuple[str, ...],
    body: RigidBody,
) -> tuple[tuple[str, ...], dict[str, str]]:
    """Select recorded sensors of the axis with mode shape; reasons for the others."""
    names, excluded = [], {}
    for sensor in aircraft.sensors:
        if sensor.name not in channels:
            continue
        strain, known = sensor.model.senses == "strain", table.table
        needs_shape = strain or bool(known.numbers)
        if needs_shape and sensor.point not in (known.gauges if strain else known.points):
            excluded[sensor.name] = f"the modal table has no shape at '{sensor.point}'"
        elif not is_axis_sensor(sensor, body):
            excluded[sensor.name] = (
                f"it measures no {body.axis} motion, or its name contradicts its record"
            )
        elif reads_own_motion_only(((sensor, 1.0),), find_other(body)):
            excluded[sensor.name] = f"in the plane of symmetry it measures no {body.axis} motion"
        elif opposed and not reads_own_motion_only(((sensor, 1.0),), body):
            excluded[sensor.name] = (
                f"it measures the motion of the other axis that {', '.join(opposed)} excite"
            )
        else:
            names.append(sensor.name)
    return tuple(names), excluded


def _select_default_band(
    maneuver: Maneuver, channels: Sequence[Channel]
) -> tuple[float, float] | None:
    """Select the excited frequencies that all channels resolve, or those of the record."""
    top_hz = _MAX_FREQUENCY_RATIO * min(channel.rate_hz for channel in channels)
    if maneuver.excitation is None:
        return (_MIN_CYCLES / maneuver.duration_s, top_hz)
    omega = select_frequencies(maneuver).omega
    if omega[-1] <= 2.0 * np.pi * top_hz:
        return None
    return (0.0, top_hz)
