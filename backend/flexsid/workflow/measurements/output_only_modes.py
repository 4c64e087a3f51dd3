"""Modes of a record or a part of it from its outputs alone, named by the modal table."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from scipy.optimize import linear_sum_assignment

from flexsid.allowed import Allowed, Id, Moment, Names
from flexsid.errors import BadInput
from flexsid.records.aircraft import Sensor
from flexsid.records.maneuver import Channel, Maneuver, Role
from flexsid.records.views import OutputOnlyMode, OutputOnlyResult
from flexsid.storage.store import Store
from flexsid.sysid.model.sensor_models import ACCELEROMETER, GYRO
from flexsid.sysid.modes import StructuralModes
from flexsid.sysid.modes.assurance import compute_mac
from flexsid.sysid.modes.output_only import LEAST_CYCLES, OutputOnlyModes, identify_output_only
from flexsid.workflow.measurements.maneuver_spectra import load_channels
from flexsid.workflow.modal_data.modal_tables import ALIKE, load_modes_of_model

_LOWEST_HZ = 1.0  # by default: below, the motion of the rigid body
_HIGHEST = 0.4  # of the sample rate, by default
_SAME_FREQUENCY = 0.3  # largest relative difference of a mode in flight and without air
_DERIVATIVES = {ACCELEROMETER.kind: 2, GYRO.kind: 1}  # of the motion, that a sensor measures

_FrequencyHz = Annotated[float | None, Allowed(gt=0.0, le=1e4)]


@dataclass(frozen=True, slots=True, kw_only=True)
class OutputOnlyQuery:
    """Maneuver, band, and part of the record; the whole record and all outputs by default.

    The band begins by default at 1 Hz, or at 20 cycles per record, and ends at 0.4 of the sample
    rate.
    """

    maneuver_id: Id
    low_hz: Annotated[_FrequencyHz, Allowed(text="Begin of the band.")] = None
    high_hz: Annotated[_FrequencyHz, Allowed(text="End of the band.")] = None
    start_s: Annotated[Moment | None, Allowed(text="Begin of the used part.")] = None
    stop_s: Annotated[Moment | None, Allowed(text="End of the used part.")] = None
    outputs: Annotated[Names, Allowed(text="Channels; by default all outputs of one clock.")] = ()

    def __post_init__(self) -> None:
        """Refuse limits that do not rise.

        Raises
        ------
        BadInput
            If the limits of band or part do not rise.
        """
        for low, high in ((self.low_hz, self.high_hz), (self.start_s, self.stop_s)):
            if low is not None and high is not None and not low < high:
                raise BadInput(f"limits must rise, not {low:g} to {high:g}", code="bad-band")


def check_output_only(store: Store, query: OutputOnlyQuery) -> None:
    """Refuse channels that the maneuver does not have, and too few outputs.

    Raises
    ------
    BadInput
        If there are such channels.
    """
    _select_outputs(store, store.maneuvers.get(query.maneuver_id), query.outputs)


def identify_modes_of_outputs(store: Store, query: OutputOnlyQuery) -> OutputOnlyResult:
    """Identify modes from the outputs of a record, and name them by their shapes.

    Raises
    ------
    BadInput
        If the part is too short, or has no mode.
    """
    maneuver = store.maneuvers.get(query.maneuver_id)
    channels, excluded = _select_outputs(store, maneuver, query.outputs)
    loaded = load_channels(store, maneuver.id, [one.name for one in channels])
    values = np.stack([samples for _, samples in loaded], axis=1)
    first = channels[0]
    begin, end = _find_part(first, query)
    values = values[begin:end]
    duration_s = values.shape[0] / first.rate_hz
    lowest = max(_LOWEST_HZ, LEAST_CYCLES / max(duration_s, 1e-9))
    band_hz = query.low_hz or lowest, query.high_hz or _HIGHEST * first.rate_hz
    if not band_hz[0] < band_hz[1]:
        raise BadInput(
            f"the band from {band_hz[0]:.3g} to {band_hz[1]:.3g} Hz is empty; use a longer part of "
            "the record, or give both limits",
            code="bad-band",
        )
    found = identify_output_only(
        values, 1.0 / first.rate_hz, (2.0 * np.pi * band_hz[0], 2.0 * np.pi * band_hz[1])
    )
    names = [one.name for one in channels]
    return OutputOnlyResult(
        maneuver_id=query.maneuver_id,
        band_hz=band_hz,
        start_s=first.get_time(begin),
        duration_s=duration_s,
        outputs=tuple(names),
        excluded=excluded,
        modes=_describe_modes(store, maneuver, names, found, np.std(values, axis=0)),
        tones_hz=tuple((found.tones / (2.0 * np.pi)).tolist()),
        frequency_hz=tuple((found.frequencies / (2.0 * np.pi)).tolist()),
        measured=tuple(found.measured.tolist()),
        fitted=tuple(found.fitted.tolist()),
        warnings=_warn(maneuver),
    )


def _select_outputs(
    store: Store, maneuver: Maneuver, names: Sequence[str]
) -> tuple[list[Channel], dict[str, str]]:
    """Channels of the clock that most outputs have; the reason by channel that is left out."""
    recorded = store.channels.find(maneuver_id=maneuver.id)
    known = {one.name: one for one in recorded}
    for name in names:
        if name not in known:
            raise BadInput(
                f"maneuver {maneuver.id} has no channel '{name}'", code="unknown-channel"
            )
    offered = [known[name] for name in names] or [c for c in recorded if c.role is Role.OUTPUT]
    if not offered:
        raise BadInput("the maneuver has no output; import one", code="no-outputs")
    clocks = [one.clock for one in offered]
    usual = max(clocks, key=clocks.count)
    excluded = {
        one.name: f"it was sampled at {one.rate_hz:g} Hz or at other times than most outputs"
        for one in offered
        if one.clock != usual
    }
    return [one for one in offered if one.clock == usual], excluded


def _find_part(channel: Channel, query: OutputOnlyQuery) -> tuple[int, int]:
    limits = []
    for moment, usual in ((query.start_s, 0), (query.stop_s, channel.n_samples)):
        place = usual if moment is None else round((moment - channel.start_s) * channel.rate_hz)
        limits.append(min(max(place, 0), channel.n_samples))
    if limits[0] >= limits[1]:
        raise BadInput("the record has no samples between these times", code="bad-window")
    return limits[0], limits[1]


def _describe_modes(
    store: Store,
    maneuver: Maneuver,
    names: Sequence[str],
    found: OutputOnlyModes,
    size: np.ndarray,
) -> tuple[OutputOnlyMode, ...]:
    aircraft = store.aircraft.get(maneuver.aircraft_id)
    table, _ = load_modes_of_model(store, maneuver.aircraft_id, None, None, ())
    known = table.table.at(maneuver.condition.fuel_fraction)
    sensors = {one.name: one for one in aircraft.sensors}
    matched = _match_modes(found, known, [sensors.get(name) for name in names], size)
    return tuple(
        OutputOnlyMode(
            frequency_hz=float(found.omega[k] / (2.0 * np.pi)),
            frequency_std_hz=float(found.std_omega[k] / (2.0 * np.pi)),
            damping=float(found.damping[k]),
            damping_std=float(found.std_damping[k]),
            shape_real=tuple(np.real(found.shapes[k]).tolist()),
            shape_imag=tuple(np.imag(found.shapes[k]).tolist()),
            number=number,
            name="" if number is None else table.names[number] or f"mode {number}",
            mac=mac,
        )
        for k, (number, mac) in enumerate(matched)
    )


def _match_modes(
    found: OutputOnlyModes,
    known: StructuralModes,
    sensors: Sequence[Sensor | None],
    size: np.ndarray,
) -> list[tuple[int | None, float | None]]:
    """Number and MAC of the mode of the table that is most like each, over sensors with a shape."""
    nothing: list[tuple[int | None, float | None]] = [(None, None)] * found.omega.size
    rows = [(k, s, _read_motion(known, s)) for k, s in enumerate(sensors) if s is not None]
    rows = [(k, s, motion) for k, s, motion in rows if motion is not None and size[k] > 0]
    if len(rows) < 2 or not known.numbers:
        return nothing
    used = [k for k, _, _ in rows]
    mac = np.zeros((found.omega.size, len(known.numbers)))
    for place, omega in enumerate(found.omega):
        expected = np.array(
            [motion * (1j * omega) ** _DERIVATIVES.get(s.kind, 0) for _, s, motion in rows]
        )
        own = found.shapes[place : place + 1, used] / size[used]
        mac[place] = compute_mac(own, (expected / size[used][:, None]).T)[0]
        mac[place, np.abs(known.omega / omega - 1.0) > _SAME_FREQUENCY] = 0.0
    result = nothing
    for one, other in zip(*linear_sum_assignment(-mac), strict=True):
        if mac[one, other] >= ALIKE:
            result[one] = known.numbers[other], float(mac[one, other])
    return result


def _read_motion(known: StructuralModes, sensor: Sensor) -> np.ndarray | None:
    """Motion of each mode at a sensor per unit eta; None without a shape there."""
    if sensor.model.senses == "strain":
        if sensor.point not in known.gauges:
            return None
        return known.strain[known.gauges.index(sensor.point)]
    if sensor.point not in known.points or sensor.axis not in "xyz":
        return None
    shapes = known.translation if sensor.model.senses == "translation" else known.rotation
    return shapes[known.points.index(sensor.point), "xyz".index(sensor.axis)]


def _warn(maneuver: Maneuver) -> tuple[str, ...]:
    if maneuver.excitation is None:
        return ()
    return (
        "This maneuver has a known excitation, whose harmonics are no broadband forces: use a "
        "part of the record without it.",
    )
