"""Skews, scale factors and biases of a maneuver's channels from redundancy and kinematics."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from flexsid.errors import NotIdentifiable
from flexsid.records.aircraft import Sensor, SensorKind
from flexsid.records.maneuver import Channel, Maneuver, Role
from flexsid.storage.store import Store
from flexsid.sysid.estimation.reconstruction import Motion
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.preparation.biases import Bias, climb_angle, gyro_bias, vane_bias
from flexsid.sysid.preparation.input_skews import InputSkews, find_input_skews
from flexsid.sysid.preparation.redundancy import Faults, agreement, find_faults, widened
from flexsid.sysid.preparation.resampling import resample
from flexsid.sysid.signals import FrequencyData
from flexsid.workflow.sensing import Sensing, motion_of
from flexsid.workflow.transforms import load_channels

_CALIBRATED = (SensorKind.GYRO, SensorKind.VANE)
_MORE_MODES = 2  # beyond the choice: what they would change widens the errors
_NEAR_BAND = 2.6  # of the highest line: modes further above follow the others at once
_SETTLED_S = 0.5  # without a known excitation, so much of the record is trim
_DEPARTS = 20.0  # times its known noise: worth a try with the sign turned
_AGREES = 0.1  # of that is left where the sign was wrong
_HEARD = 2.0  # times its known noise
_TELLING = 0.05  # [s]: a standard error above says that nothing is known


@dataclass(frozen=True, slots=True)
class SensorFaults:
    """What redundancy tells: faults, coherence and excess noise by sensor; skews of inputs."""

    faults: Faults
    coherence: np.ndarray
    noise_excess: np.ndarray
    inputs: InputSkews | None = None

    def told(self, name: str) -> bool:
        """Whether the delay of a sensor is known at all."""
        return bool(self.faults.delay_std[self.faults.names.index(name)] < _TELLING)


def sensor_faults(sensing: Sensing) -> SensorFaults:
    """Find delays of all sensors, and scale factors of gyros and vanes.

    A sensor that departs from the others and would not with its sign turned has a scale
    factor below zero. Modes are chosen when the delays are undone, for a delay looks like a
    mode left out; what more modes would give widens the standard errors.

    Raises
    ------
    NotIdentifiable
        If the sensors are not redundant.
    """
    found = _faults(sensing)
    names = found.faults.names
    if np.nanmax(np.nan_to_num(found.noise_excess)) < _DEPARTS:
        return found
    worst = int(np.argmax(np.nan_to_num(found.noise_excess)))
    sign = np.where(np.arange(len(names)) == worst, -1.0, 1.0)
    outputs = sensing.measured.outputs
    values = outputs.pick(names).values * sign
    turned = replace(sensing.measured, outputs=FrequencyData(outputs.omega, values, names))
    other = _faults(replace(sensing, measured=turned))
    if not other.noise_excess[worst] < _AGREES * found.noise_excess[worst]:
        return found
    return replace(other, faults=replace(other.faults, scale=other.faults.scale * sign))


def _faults(sensing: Sensing) -> SensorFaults:
    lines = sensing.measured
    names = sensing.model.outputs
    kinds = {o.name: o.kind for o in sensing.outputs}
    scaled = tuple(n for n in names if kinds[n] in _CALIBRATED)
    if all(kind in _CALIBRATED for kind in kinds.values()):
        scaled = ()
    reference = _reference(sensing)
    least = np.where(np.isfinite(sensing.noise), sensing.noise, 0.0)

    def find(model: AeroelasticModel, near: Faults | None = None) -> Faults:
        return find_faults(model, lines.outputs, lines.instruments, reference, scaled, least, near)

    first = find(sensing.model)
    seen = np.where(first.delay_std < _TELLING, first.delay_s, 0.0)
    straight = np.exp(1j * np.outer(lines.omega, seen)) / first.scale
    values = lines.outputs.pick(names).values * straight
    outputs = FrequencyData(lines.omega, values, names)
    undone = replace(sensing, measured=replace(lines, outputs=outputs))
    model, motion = motion_of(undone)
    count = len(model.modes.numbers)
    same = model.modes.numbers == sensing.model.modes.numbers
    best = first if same else find(model, first)
    others = []
    for more in range(1, _MORE_MODES + 1):
        if count + more > len(sensing.modes):
            break
        richer = sensing.with_modes(sensing.modes[: count + more])
        try:
            others.append(find(richer, best))
        except NotIdentifiable:
            break
    coherence = agreement(model, undone.measured.outputs, lines.instruments, motion.noise)
    # A sensor that hears little but its own noise cannot agree with others.
    level = np.sqrt(np.mean(np.abs(lines.outputs.pick(names).values) ** 2, axis=0))
    coherence = np.where(level < _HEARD * sensing.noise, np.nan, coherence)
    excess = motion.noise / sensing.noise
    faults = widened(best, others)
    # The motion is timed by the sensors, and no better than they are.
    timed_s = float(np.median(faults.delay_std))
    return SensorFaults(faults, coherence, excess, _input_skews(undone, motion, timed_s))


def _input_skews(sensing: Sensing, motion: Motion, timed_s: float) -> InputSkews | None:
    """Skews of the surfaces; a mode less or more widens their errors.

    Where nobody says what was excited, regressors are mostly noise, and their bias a delay.
    """
    if sensing.maneuver.excitation is None:
        return None
    lines = sensing.measured
    numbers = sensing.modes[: motion.values.shape[1] - 2]
    near = sensing.with_modes(numbers).modes.omega < _NEAR_BAND * lines.omega[-1]
    count = int(np.sum(near))
    found: list[InputSkews] = []
    for number in (count, count - 1, count + 1):
        if not 0 <= number <= len(numbers):
            continue
        try:
            model = sensing.with_modes(numbers[:number])
            found.append(
                find_input_skews(
                    model,
                    motion.first(number),
                    lines.inputs,
                    lines.input_noise,
                    found[0] if found else None,
                )
            )
        except (NotIdentifiable, np.linalg.LinAlgError):
            if number == count:
                return None
    spread = [(one.delay_s - found[0].delay_s) ** 2 for one in found]
    return replace(
        found[0], delay_std=np.sqrt(found[0].delay_std ** 2 + np.max(spread, axis=0) + timed_s**2)
    )


def biases(store: Store, sensing: Sensing, faults: Faults | None) -> dict[str, Bias]:
    """Biases of gyros and vanes against attitude, or against trim where none is recorded."""
    maneuver = sensing.maneuver
    channels = {c.name: c for c in store.channels.find(maneuver_id=maneuver.id)}
    of_kind = {
        kind: [s for s in sensing.aircraft.sensors if s.kind is kind and s.name in channels]
        for kind in (SensorKind.GYRO, SensorKind.VANE, SensorKind.ATTITUDE)
    }
    attitude = next((s for s in of_kind[SensorKind.ATTITUDE] if s.axis == "y"), None)
    climb = _climb(store, maneuver)
    found: dict[str, Bias] = {}
    for sensor in (*of_kind[SensorKind.GYRO], *of_kind[SensorKind.VANE]):
        if sensor.axis != "y":
            continue
        channel, values = _load(store, maneuver, sensor)
        trim = _trim(maneuver, channel)
        if trim.stop - trim.start < 4:
            continue
        scale, std = _scale(faults, sensor.name)
        level = None if attitude is None else _on_clock(store, maneuver, attitude, channel)
        if sensor.kind is SensorKind.GYRO:
            found[sensor.name] = gyro_bias(values, level, channel.rate_hz, trim, scale, std)
        elif level is not None:
            found[sensor.name] = vane_bias(values, level, climb, trim, scale, std)
    return {name: bias for name, bias in found.items() if np.isfinite(bias.std)}


def _reference(sensing: Sensing) -> str:
    """Accelerometer nearest the c.g. that sees heave: what the others are timed against."""
    x = sensing.maneuver.condition.x_cg_m
    heave = [
        o.terms[0][0]
        for o in sensing.outputs
        if o.kind is SensorKind.ACCELEROMETER and o.terms[0][0].axis == "z"
    ]
    if not heave:
        return sensing.outputs[0].name
    return min(heave, key=lambda s: np.hypot(s.location_m[0] - x, s.location_m[1])).name


def _scale(faults: Faults | None, name: str) -> tuple[float, float]:
    if faults is None or name not in faults.names:
        return 1.0, 0.0
    place = faults.names.index(name)
    return float(faults.scale[place]), float(faults.scale_std[place])


def _trim(maneuver: Maneuver, channel: Channel) -> slice:
    """Samples before the excitation."""
    excitation = maneuver.excitation
    stop_s = channel.start_s + _SETTLED_S if excitation is None else excitation.start_s
    count = min(channel.n_samples, max(0, int((stop_s - channel.start_s) * channel.rate_hz)))
    return slice(0, count)


def _climb(store: Store, maneuver: Maneuver) -> Bias:
    """Flight path angle from altitude where it was recorded, else as the condition has it."""
    assert maneuver.id is not None
    known = store.channels.find(maneuver_id=maneuver.id, role=Role.CONDITION, name="altitude")
    if not known:
        gamma = maneuver.condition.gamma_rad
        return Bias(value=gamma, std=0.0, basis=f"gamma taken as {np.degrees(gamma):.2f} deg")
    ((channel, values),) = load_channels(store, maneuver.id, ["altitude"])
    return climb_angle(
        np.asarray(values, dtype=float), channel.rate_hz, maneuver.condition.airspeed_m_s
    )


def _load(store: Store, maneuver: Maneuver, sensor: Sensor) -> tuple[Channel, np.ndarray]:
    assert maneuver.id is not None
    ((channel, values),) = load_channels(store, maneuver.id, [sensor.name])
    return channel, np.asarray(values, dtype=float)


def _on_clock(store: Store, maneuver: Maneuver, sensor: Sensor, clock: Channel) -> np.ndarray:
    """Samples of a sensor on the clock of another channel."""
    channel, values = _load(store, maneuver, sensor)
    same = (channel.rate_hz, channel.start_s, channel.n_samples)
    if same == (clock.rate_hz, clock.start_s, clock.n_samples):
        return values
    return resample(
        values, channel.rate_hz, channel.start_s, clock.rate_hz, clock.start_s, clock.n_samples
    )
