"""Sensing: every sensor of a maneuver by itself, with a model of what it should see."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from flexsid.errors import BadInput, NotIdentifiable
from flexsid.records.aircraft import Aircraft, SensorKind
from flexsid.records.axes import symmetry_of
from flexsid.records.maneuver import Channel, Maneuver, Role
from flexsid.storage.store import Store
from flexsid.sysid.estimation.reconstruction import ReconstructedMotion, reconstruct_motion
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.sensors import SensorRows
from flexsid.sysid.preparation.redundancy import strong_lines
from flexsid.sysid.signals import FrequencyData
from flexsid.workflow.aircraft.aircraft_models import OutputDefinition, build_model, define_outputs
from flexsid.workflow.aircraft.longitudinal import (
    is_pitch_sensor,
    lateral_surfaces,
    reads_symmetric_motion_only,
    require_longitudinal,
)
from flexsid.workflow.measurements.maneuver_data import MeasuredLines, spectral_noise
from flexsid.workflow.measurements.maneuver_spectra import measure
from flexsid.workflow.measurements.recording import maneuver_lines
from flexsid.workflow.measurements.symmetric_motion import require_symmetric_motion
from flexsid.workflow.measurements.transforms import load_channels
from flexsid.workflow.modal_data.aligned_modes import (
    AircraftModes,
    companion_modes,
    find_modal_tables,
    load_modes,
)

_CLEAR_OF_NYQUIST = 0.4  # of the sampling rate
_FIRST_LINE = 4.0  # cycles per record, where no lines are known
_LOWEST_HZ = 0.25  # below lies the phugoid, which the model has not
_SMOOTHED = 9  # lines over which power is averaged
_QUIET = 1e-2  # of the largest power of the surfaces: they did not move there
_ABOVE_NOISE = 4.0  # times the power of the noise: 6 dB
_MOST_HEARD = 0.5  # of the outputs
_FEWEST_LINES = 10  # fewer do not resolve a delay from an amplitude
_TOO_NOISY = 1.3  # times the noise of a sensor: more modes are moving than the model has
_NO_BETTER = 1.15  # times the least disagreement that more modes leave
_SAME = 1.0 - 1e-6  # cosine between two sensor rows from which on they are one
_CHECKING = 1  # independent sensors at least that no motion takes up


@dataclass(frozen=True, slots=True)
class Sensing:
    """A maneuver as single sensors see it; ``left_out`` says why others are not used.

    ``modes`` are all that the sensors could tell, lowest first; the model has the first of
    them. ``noise`` is what the aircraft's description says of each sensor's lines if it holds
    at the rate of the slowest sensor, NaN where it says nothing. [output unit * s]
    ``independent`` is the number of sensors that read different things.
    """

    maneuver: Maneuver
    aircraft: Aircraft
    table: AircraftModes
    modes: tuple[int, ...]
    model: AeroelasticModel
    outputs: tuple[OutputDefinition, ...]
    measured: MeasuredLines
    noise: np.ndarray
    left_out: dict[str, str]
    independent: int

    @property
    def duration_s(self) -> float:
        """Length of what the lines were transformed from. [s]"""
        return _transformed(self.maneuver)

    def at(self, some: np.ndarray) -> Sensing:
        """The same sensors at some of the lines."""
        lines = self.measured
        omega, names = lines.omega[some], lines.outputs.names
        measured = replace(
            lines,
            outputs=FrequencyData(omega, lines.outputs.values[some], names),
            instruments=lines.instruments[some],
        )
        return replace(self, measured=measured)

    def with_modes(self, numbers: tuple[int, ...]) -> AeroelasticModel:
        """A model of other modes for the same sensors."""
        fuel = self.maneuver.condition.fuel_fraction
        shapes = self.table.table.at(fuel).select(numbers)
        return build_model(
            self.aircraft, self.maneuver.condition, shapes, self.model.inputs, self.outputs
        )


def sense(store: Store, maneuver: Maneuver, band_hz: tuple[float, float] | None = None) -> Sensing:
    """Gather all sensors of a maneuver whose place in the structure is known.

    Raises
    ------
    BadInput
        If the aircraft has no modal table, or no sensor is left.
    """
    aircraft = store.aircraft.get(maneuver.aircraft_id)
    modal, damping = find_modal_tables(store, maneuver.aircraft_id, None, None)
    table = load_modes(store, modal, damping)
    channels = {c.name: c for c in store.channels.find(maneuver_id=maneuver.id)}
    require_longitudinal(maneuver)
    known = {surface.name for surface in aircraft.surfaces}
    inputs = tuple(c.name for c in channels.values() if c.role is Role.INPUT and c.name in known)
    lateral = lateral_surfaces(maneuver, aircraft, inputs)
    names, left_out = _usable(aircraft, channels, table, lateral)
    for name in lateral:
        if symmetry_of(aircraft, name) == "antisymmetric":
            left_out[name] = "it is antisymmetric and drives no symmetric motion"
    for name in _still(store, maneuver, (*names, *inputs)):
        left_out[name] = "it holds one value all the time"
    names = tuple(name for name in names if name not in left_out)
    inputs = tuple(name for name in inputs if name not in left_out)
    if not names:
        raise BadInput(
            "no channel of this maneuver belongs to a sensor whose place in the structure is known",
            code="no-sensors",
        )
    outputs = define_outputs(aircraft, names)
    require_symmetric_motion(store, maneuver, aircraft, inputs, outputs)
    band = band_hz or _band(maneuver, [channels[name] for name in (*names, *inputs)])
    measured = measure(store, maneuver, aircraft, inputs, outputs, band)
    rate_hz = min(channels[name].rate_hz for name in names)
    noise = spectral_noise(outputs, rate_hz, _transformed(maneuver))
    if maneuver.excitation is None and band_hz is None:
        measured = measure(store, maneuver, aircraft, inputs, outputs, _heard(measured, noise))
    top = float(measured.omega[-1])
    fuel = maneuver.condition.fuel_fraction
    flying = tuple(n for n in table.table.numbers if table.symmetric[n])
    model = build_model(
        aircraft, maneuver.condition, table.table.at(fuel).select(flying), inputs, outputs
    )
    independent = count_independent(model.sensors)
    near = companion_modes(table, fuel, (), top, independent)
    every = _by_frequency(table, fuel)[: max(0, independent - 2 - _CHECKING)]
    model = build_model(
        aircraft, maneuver.condition, table.table.at(fuel).select(near), inputs, outputs
    )
    return Sensing(
        maneuver, aircraft, table, every, model, outputs, measured, noise, left_out, independent
    )


def count_independent(sensors: SensorRows) -> int:
    """Number of sensors that read something else of the motion than all others.

    In symmetric motion a left and a right sensor read the same: they check each other, but
    resolve no further mode.

    Parameters
    ----------
    sensors
        Rows of as many modes as are known.
    """
    rows = sensors.polynomial.transpose(1, 0, 2).reshape(len(sensors.names), -1)
    size = np.linalg.norm(rows, axis=1)
    rows = rows[size > 0] / size[size > 0, None]
    same = np.abs(rows @ rows.T) > _SAME
    return int(np.sum(~np.any(np.tril(same, -1), axis=1)))


def _by_frequency(table: AircraftModes, fuel: float) -> tuple[int, ...]:
    """Symmetric modes, lowest first."""
    omega = table.table.at(fuel).omega
    ordered = sorted(zip(omega, table.table.numbers, strict=True))
    return tuple(number for _, number in ordered if table.symmetric[number])


def moved_band(store: Store, maneuver: Maneuver, aircraft: Aircraft) -> tuple[float, float]:
    """Band in which the surfaces of a maneuver without known excitation moved. [Hz]

    Raises
    ------
    BadInput
        If no surface was recorded.
    """
    known = {surface.name for surface in aircraft.surfaces}
    channels = store.channels.find(maneuver_id=maneuver.id)
    names = tuple(c.name for c in channels if c.role is Role.INPUT and c.name in known)
    if not names:
        raise BadInput("the maneuver has no recorded input", code="no-input")
    moving = [c for c in channels if c.role in (Role.INPUT, Role.COMMAND)]
    lines = measure(store, maneuver, aircraft, names, (), _band(maneuver, moving))
    power = np.abs(lines.inputs.values) ** 2
    power = np.sum(power / np.maximum(power.max(axis=0), 1e-300), axis=1)
    smooth = np.convolve(power, np.ones(_SMOOTHED) / _SMOOTHED, mode="same")
    # Taking out their filters brings up noise far above: the first pause counts.
    quiet = np.flatnonzero(smooth[np.argmax(smooth) :] < _QUIET * smooth.max())
    top = smooth.size - 1 if quiet.size == 0 else int(np.argmax(smooth)) + int(quiet[0])
    hz = lines.omega / (2.0 * np.pi)
    return float(min(max(hz[0], _LOWEST_HZ), 0.5 * hz[top])), float(hz[top])


def motion_of(
    sensing: Sensing, modes: Sequence[int] = ()
) -> tuple[AeroelasticModel, ReconstructedMotion]:
    """Reconstruct the motion line by line with as many modes as move.

    Parameters
    ----------
    sensing
        The sensors.
    modes
        Numbers of the modes; none to begin with those near the band and to add higher ones
        while a sensor disagrees with the others by more than its noise and they explain it.

    Returns
    -------
    model, motion
        The model with its modes.

    Raises
    ------
    NotIdentifiable
        If the sensors cannot tell the modes apart.
    """
    if modes:
        model = sensing.with_modes(tuple(modes))
        return model, _reconstruct(sensing, model)
    model, motion = _as_many_as_move(sensing.at(strong_lines(sensing.measured.outputs.values)))
    return model, _reconstruct(sensing, model, motion.noise)


def _as_many_as_move(sensing: Sensing) -> tuple[AeroelasticModel, ReconstructedMotion]:
    numbers = sensing.model.modes.numbers
    model = sensing.model
    while True:
        try:
            motion = _reconstruct(sensing, model)
            break
        except NotIdentifiable:
            if not numbers:
                raise
            numbers = numbers[:-1]
            model = sensing.with_modes(numbers)
    known = np.isfinite(sensing.noise)
    if not known.any():
        return model, motion
    tried = [(model, motion)]
    while _disagreement(sensing, motion).max() > _TOO_NOISY and len(numbers) < len(sensing.modes):
        numbers = sensing.modes[: len(numbers) + 1]
        try:
            model = sensing.with_modes(numbers)
            motion = _reconstruct(sensing, model, motion.noise)
        except NotIdentifiable:
            break
        tried.append((model, motion))
    return _fewest(sensing, tried)


def _disagreement(sensing: Sensing, motion: ReconstructedMotion) -> np.ndarray:
    """Disagreement over noise, of the sensors whose noise is known."""
    known = np.isfinite(sensing.noise)
    return motion.noise[known] / sensing.noise[known]


def _fewest(
    sensing: Sensing, tried: Sequence[tuple[AeroelasticModel, ReconstructedMotion]]
) -> tuple[AeroelasticModel, ReconstructedMotion]:
    """The fewest modes from which on more explain nothing.

    A sensor that is at fault disagrees however many modes there are, and those that only
    chase its fault take away what tells all others apart.
    """
    excess = np.array([_disagreement(sensing, motion) for _, motion in tried])
    least = np.minimum.accumulate(excess[::-1], axis=0)[::-1]
    enough = np.all(excess <= np.maximum(_TOO_NOISY, _NO_BETTER * least), axis=1)
    return tried[int(np.argmax(enough))]


def _transformed(maneuver: Maneuver) -> float:
    """The whole record of one period, or the periods after the first of several. [s]"""
    excitation = maneuver.excitation
    if excitation is None or excitation.n_periods < 2:
        return maneuver.duration_s
    return (excitation.n_periods - 1) * excitation.period_s


def _reconstruct(
    sensing: Sensing, model: AeroelasticModel, guess: np.ndarray | None = None
) -> ReconstructedMotion:
    """Weight sensors by their noise, or by their disagreement where that is larger.

    Disagreement alone may find that one sensor is fitted exactly; a sensor has noise.
    """
    lines = sensing.measured
    found = reconstruct_motion(model, lines.outputs, lines.instruments, guess=guess)
    least = np.where(np.isfinite(sensing.noise), sensing.noise, 0.0)
    if np.all(found.noise >= least):
        return found
    noise = np.maximum(found.noise, least)
    return reconstruct_motion(model, lines.outputs, lines.instruments, noise)


def _heard(lines: MeasuredLines, noise: np.ndarray) -> tuple[float, float]:
    """Band in which outputs carry signal above their noise, where nobody says what was excited.

    The noise of an output is what is known of it, or what is left at the top of the spectrum.

    Raises
    ------
    BadInput
        If there is no such band.
    """
    kernel = np.ones(_SMOOTHED) / _SMOOTHED
    power = np.stack(
        [np.convolve(p, kernel, mode="same") for p in np.abs(lines.outputs.values.T) ** 2], axis=1
    )
    top = power[-max(_SMOOTHED, len(power) // 4) :]
    floor = np.maximum(np.median(top, axis=0), np.nan_to_num(noise) ** 2)
    hz = lines.omega / (2.0 * np.pi)
    above = np.mean(power > _ABOVE_NOISE * floor, axis=1) >= _MOST_HEARD
    edges = np.flatnonzero(np.diff(np.r_[False, above & (hz >= _LOWEST_HZ), False]))
    first, stop = edges[::2], edges[1::2]
    if not first.size or np.max(stop - first) < _FEWEST_LINES:
        raise BadInput(
            "the outputs of this record carry no signal above their noise over a band of "
            f"{_FEWEST_LINES} lines",
            code="no-signal",
        )
    widest = int(np.argmax(stop - first))
    return float(hz[first[widest]]), float(hz[stop[widest] - 1])


def _usable(
    aircraft: Aircraft,
    channels: dict[str, Channel],
    table: AircraftModes,
    lateral: tuple[str, ...],
) -> tuple[tuple[str, ...], dict[str, str]]:
    """Recorded sensors of the symmetric motion that have a shape, and why others are not used."""
    names, left_out = [], {}
    for sensor in aircraft.sensors:
        if sensor.name not in channels:
            continue
        strain = sensor.kind is SensorKind.STRAIN
        if sensor.point not in (table.table.gauges if strain else table.table.points):
            left_out[sensor.name] = f"the modal table has no shape at '{sensor.point}'"
        elif not is_pitch_sensor(sensor):
            left_out[sensor.name] = "it measures lateral motion, or its name contradicts its record"
        elif lateral and not reads_symmetric_motion_only(((sensor, 1.0),)):
            left_out[sensor.name] = f"it reads the lateral motion that {', '.join(lateral)} excite"
        else:
            names.append(sensor.name)
    return tuple(names), left_out


def _still(store: Store, maneuver: Maneuver, names: Sequence[str]) -> list[str]:
    """Channels that never move: nothing can be told from them, nor of their noise."""
    assert maneuver.id is not None
    recorded = load_channels(store, maneuver.id, names)
    return [channel.name for channel, samples in recorded if not np.ptp(samples) > 0.0]


def _band(maneuver: Maneuver, channels: Sequence[Channel]) -> tuple[float, float] | None:
    """The excited lines that all channels can hold; without known lines those of the record."""
    top_hz = _CLEAR_OF_NYQUIST * min(channel.rate_hz for channel in channels)
    if maneuver.excitation is None:
        return (_FIRST_LINE / maneuver.duration_s, top_hz)
    omega = maneuver_lines(maneuver).omega
    if omega[-1] <= 2.0 * np.pi * top_hz:
        return None
    return (0.0, top_hz)
