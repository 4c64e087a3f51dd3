"""Skews, scale factors and biases of a maneuver's channels from redundancy and kinematics."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from flexsid.errors import NotIdentifiable
from flexsid.records.aircraft import Sensor, SensorKind
from flexsid.records.maneuver import Channel, Maneuver, Role
from flexsid.storage.store import Store
from flexsid.sysid.estimation.reconstruction import ReconstructedMotion, reconstruct_motion
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.preparation.biases import Bias, climb_angle, gyro_bias, vane_bias
from flexsid.sysid.preparation.fault_detection import Detection, detect_faults
from flexsid.sysid.preparation.input_skews import InputSkews, find_input_skews
from flexsid.sysid.preparation.redundancy import Faults, agreement, find_faults, widened
from flexsid.sysid.preparation.resampling import resample
from flexsid.sysid.signals import FrequencyData
from flexsid.workflow.measurements.sensor_responses import Sensing, motion_of
from flexsid.workflow.measurements.transforms import load_channels

_CALIBRATED = (SensorKind.GYRO, SensorKind.VANE)
_UNSCALED = (SensorKind.STRAIN,)  # their shapes are no better known than their calibration
_NEAR_BAND = 2.6  # of the highest line: modes further above follow the others at once
_MANY = 20  # independent sensors: all delays can be estimated together
_MORE_MODES = 2  # beyond the choice: what they would change widens the errors
_DEPARTS = 20.0  # times its known noise: worth a try with the sign turned
_AGREES = 0.1  # of that is left where the sign was wrong
_KNOWN_S = 0.05  # a larger standard error says that nothing is known
_SETTLED_S = 0.5  # without a known excitation, so much of the record is trim
_HEARD = 2.0  # times its known noise
_FAR = 8.0  # of the highest line: modes further above hardly move
_WORSE = 2  # models in a row that explain less end the search for the number of modes
_AS_GOOD = 25.0  # difference of the criterion up to which two models explain the data alike
_MISFIT = 3.0  # times what is expected: delay and scale factor do not explain this sensor
_MOST_MISFIT = 1.0 / 3.0  # of the sensors: beyond, the model is at fault, not the sensors
_SURE_S = 5e-3  # a larger standard error resolves nothing that should be corrected
_SURE_SCALE = 0.1  # a larger standard error says nothing of a scale factor or sign


@dataclass(frozen=True, slots=True)
class SensorFaults:
    """Faults, coherence and excess noise by sensor; skews of inputs.

    ``noise_excess`` is what a sensor disagrees with the others by, over its noise and the
    accuracy of calibration and shapes. ``not_checked`` has the reason why nothing is concluded
    of a sensor.
    """

    faults: Faults
    coherence: np.ndarray
    noise_excess: np.ndarray
    inputs: InputSkews | None = None
    not_checked: dict[str, str] = field(default_factory=dict[str, str])
    found: tuple[str, ...] = ()

    def told(self, name: str) -> bool:
        """Whether the delay of a sensor is known."""
        return name not in self.not_checked


def sensor_faults(sensing: Sensing) -> SensorFaults:
    """Find delays, scale factors and turned signs of sensors.

    Of more than twenty independent sensors the delays of all are estimated together; of fewer,
    those of the sensors that are at fault.

    Raises
    ------
    NotIdentifiable
        If the sensors are not redundant, or no model explains them.
    """
    if sensing.independent > _MANY:
        return _all_estimated(sensing)
    return _few_detected(sensing)


def _few_detected(sensing: Sensing) -> SensorFaults:
    """Find the fewest faults that explain the sensors.

    The number of modes is that of the best model by Akaike's criterion, faults included: a
    delay costs it one parameter, a further mode two at each line. Models that explain the data
    as well widen the standard errors.

    Raises
    ------
    NotIdentifiable
        If the sensors are not redundant, or no model explains them.
    """
    tried = _detections(sensing)
    count, best = min(tried.items(), key=lambda item: item[1].criterion)
    model = sensing.with_modes(sensing.modes[:count])
    poor = best.misfit > _MISFIT
    if np.mean(poor) > _MOST_MISFIT:
        raise NotIdentifiable(
            f"{int(poor.sum())} of {poor.size} sensors disagree by more than {_MISFIT:g} times "
            f"their noise with the motion of {count} modes, whatever the fault; the model does "
            "not hold for this record",
            code="model-misfit",
        )
    lines = sensing.measured
    faults = best.faults
    as_good = [
        other.faults
        for other in tried.values()
        if other is not best and other.criterion < best.criterion + _AS_GOOD
    ]
    faults = widened(faults, as_good)
    wrong = np.isin(faults.names, best.found)
    delay = np.where(wrong & np.isfinite(faults.delay_s), faults.delay_s, 0.0)
    scale = np.where(wrong & np.isfinite(faults.scale_std), faults.scale, best.signs)
    straight = np.exp(1j * np.outer(lines.omega, delay)) / scale
    values = lines.outputs.pick(faults.names).values * straight
    outputs = FrequencyData(lines.omega, values, faults.names)
    undone = replace(sensing, measured=replace(lines, outputs=outputs))
    motion = reconstruct_motion(model, outputs, lines.instruments, faults.noise)
    coherence = agreement(model, outputs, lines.instruments, faults.noise)
    level = np.sqrt(np.mean(np.abs(lines.outputs.pick(faults.names).values) ** 2, axis=0))
    quiet = level < _HEARD * np.nan_to_num(sensing.noise)
    coherence = np.where(quiet, np.nan, coherence)
    unknown = ~(faults.scale_std < _SURE_SCALE)
    faults = replace(
        faults,
        scale=np.where(unknown, 1.0, faults.scale),
        scale_std=np.where(unknown, 0.0, faults.scale_std),
    )
    not_checked = _reasons(faults, best, quiet, count)
    kinds = {o.name: o.kind for o in sensing.outputs}
    is_gusty = np.array([kinds[name] is SensorKind.VANE for name in faults.names]) & poor
    for name in np.array(faults.names)[is_gusty]:
        not_checked[str(name)] += " (a vane also reads turbulence)"
    excess = np.where(is_gusty, np.nan, best.misfit)
    # The motion is timed by the sensors, and no better than they are.
    timed_s = float(np.median(faults.delay_std[np.isfinite(faults.delay_std)]))
    return SensorFaults(
        faults,
        coherence,
        excess,
        _input_skews(undone, motion, timed_s),
        not_checked,
        best.found,
    )


def _detections(sensing: Sensing) -> dict[int, Detection]:
    """Faults with fewer and fewer modes, until fewer explain less; keyed by their number."""
    lines = sensing.measured
    scaled = tuple(o.name for o in sensing.outputs if o.kind not in _UNSCALED)
    tried: dict[int, Detection] = {}
    reason: NotIdentifiable | None = None
    best, worse = np.inf, 0
    omega = sensing.with_modes(sensing.modes).modes.omega
    for count in range(int(np.sum(omega <= _FAR * lines.omega[-1])), -1, -1):
        model = sensing.with_modes(sensing.modes[:count])
        try:
            found = detect_faults(model, lines.outputs, lines.instruments, scaled, sensing.noise)
        except NotIdentifiable as error:
            reason = error
            continue
        tried[count] = found
        worse = 0 if found.criterion < best else worse + 1
        best = min(best, found.criterion)
        if worse == _WORSE:
            break
    if not tried:
        assert reason is not None
        raise reason
    return tried


def _reasons(faults: Faults, best: Detection, quiet: np.ndarray, count: int) -> dict[str, str]:
    """Why nothing is concluded of some sensors."""
    reasons = {}
    for k, name in enumerate(faults.names):
        if best.rival is not None and best.signs[k] < 0:
            reasons[name] = (
                f"it or {best.rival} has the opposite sign, and the data do not resolve which"
            )
        elif quiet[k]:
            reasons[name] = "it carries little but noise"
        elif best.misfit[k] > _MISFIT:
            reasons[name] = (
                f"it departs from the other sensors by {best.misfit[k]:.0f} times its noise, "
                "which neither a delay nor a scale factor explains"
            )
        elif not faults.delay_std[k] < _SURE_S:
            reasons[name] = (
                f"the other sensors do not resolve its part in the motion of {count} modes"
            )
    return reasons


def _all_estimated(sensing: Sensing) -> SensorFaults:
    """Estimate delays of all sensors, and scale factors of gyros and vanes.

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
    seen = np.where(first.delay_std < _KNOWN_S, first.delay_s, 0.0)
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
    not_checked = {
        name: "the other sensors do not resolve its delay"
        for name, std in zip(names, faults.delay_std, strict=True)
        if not std < _KNOWN_S
    }
    return SensorFaults(
        faults, coherence, excess, _input_skews(undone, motion, timed_s), not_checked
    )


def _input_skews(
    sensing: Sensing, motion: ReconstructedMotion, timed_s: float
) -> InputSkews | None:
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
