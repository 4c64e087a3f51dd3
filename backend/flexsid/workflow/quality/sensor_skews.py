"""Skews, scale factors and biases of sensors, and surfaces as flown against their commands."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from flexsid.errors import NotIdentifiable
from flexsid.records.aircraft import Aircraft
from flexsid.records.maneuver import COMBINED, Channel, Maneuver, Role
from flexsid.records.quality import SurfaceQuality
from flexsid.storage.store import Store
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.sensor_models import ACCELEROMETER, ATTITUDE, GYRO, VANE
from flexsid.sysid.preparation.fault_detection import FaultDetection, detect_sensor_faults
from flexsid.sysid.preparation.redundancy import (
    Bias,
    InputSkews,
    SensorFaults,
    compute_sensor_coherence,
    estimate_climb_angle,
    estimate_gyro_bias,
    estimate_input_skews,
    estimate_sensor_faults,
    estimate_vane_bias,
    widen_standard_errors,
)
from flexsid.sysid.preparation.resampling import resample
from flexsid.sysid.preparation.surface_checks import SurfaceCheck, check_surface
from flexsid.sysid.regression.reconstruction import ReconstructedMotion, reconstruct_motion
from flexsid.sysid.spectra.fourier import compute_harmonic_frequencies
from flexsid.workflow.aircraft.aircraft_models import compute_input_correction
from flexsid.workflow.aircraft.axes import list_harmonics
from flexsid.workflow.measurements.maneuver_spectra import load_channels, read_spectra
from flexsid.workflow.measurements.recording import SpectrumFrequencies, list_command_names
from flexsid.workflow.measurements.sensor_responses import SensorData, reconstruct_resolved_modes

# --- Skews, scale factors and biases of channels from redundancy and kinematics -------------------

_MAX_DYNAMIC_MODE_RATIO = 2.6  # of the highest frequency: modes above respond quasi-statically
_MIN_SENSORS_FOR_ALL_DELAYS = 20  # independent sensors: all delays are estimated together
_MORE_MODES = 2  # additional modes whose effect widens the standard errors
_SIGN_TEST_RATIO = 20.0  # times its known noise: tested with the opposite sign
_SIGN_RESIDUAL_FRACTION = 0.1  # of that remains with the correct sign
_MAX_DELAY_STD_S = 0.05  # a delay of larger standard error is not identifiable
_TRIM_S = 0.5  # duration of trim without a known excitation
_SIGNAL_OVER_NOISE = 2.0  # times its known noise: signal present
_MAX_MODE_FREQUENCY_RATIO = 8.0  # of the highest frequency: modes above are not excited
_MAX_WORSE_MODELS = 2  # successive models of larger criterion that end the search
_EQUIVALENT_CRITERION = 25.0  # difference of the criterion up to which two models are equivalent
_MISFIT = 3.0  # times its noise: neither delay nor scale factor explains this sensor
_MAX_MISFIT_FRACTION = 1.0 / 3.0  # of the sensors: above, the model does not fit
RESOLVED_DELAY_STD_S = 5e-3  # a larger standard error resolves no delay worth a correction
_RESOLVED_SCALE_STD = 0.1  # a larger standard error resolves neither scale factor nor sign


@dataclass(frozen=True, slots=True)
class RedundancyCheck:
    """Faults, coherence and excess noise by sensor; skews of inputs.

    ``noise_excess`` is the residual of a sensor over its noise and the accuracy of calibration
    and shapes. ``not_checked`` has the reason by sensor that could not be checked.
    """

    faults: SensorFaults
    coherence: np.ndarray
    noise_excess: np.ndarray
    inputs: InputSkews | None
    not_checked: dict[str, str]


def check_redundancy(sensing: SensorData) -> RedundancyCheck:
    """Estimate delays, scale factors and wrong signs of sensors.

    With more than twenty independent sensors the delays of all are estimated together; with
    fewer, those of the faulty sensors.

    Raises
    ------
    NotIdentifiable
        If the sensors are not redundant, or no model fits them.
    """
    if sensing.independent > _MIN_SENSORS_FOR_ALL_DELAYS:
        return _estimate_all_delays(sensing)
    return _detect_few_faults(sensing)


def _detect_few_faults(sensing: SensorData) -> RedundancyCheck:
    """Detect the fewest faults that explain the sensors.

    The number of modes is that of the best model by Akaike's criterion, faults included: a
    delay adds one parameter, a further mode two at each frequency. Equivalent models widen the
    standard errors.

    Raises
    ------
    NotIdentifiable
        If the sensors are not redundant, or no model fits them.
    """
    tried = _detect_by_number_of_modes(sensing)
    count, best = min(tried.items(), key=lambda item: item[1].criterion)
    model = sensing.with_modes(sensing.modes[:count])
    poor = best.misfit > _MISFIT
    if np.mean(poor) > _MAX_MISFIT_FRACTION:
        raise NotIdentifiable(
            f"{int(poor.sum())} of {poor.size} sensors disagree by more than {_MISFIT:g} times "
            f"their noise with the motion of {count} modes for any fault; the model does not "
            "fit this record",
            code="model-misfit",
        )
    equivalent = [
        other.faults
        for other in tried.values()
        if other is not best and other.criterion < best.criterion + _EQUIVALENT_CRITERION
    ]
    faults = widen_standard_errors(best.faults, equivalent)
    wrong = np.isin(faults.names, best.found)
    delay = np.where(wrong & np.isfinite(faults.delay_s), faults.delay_s, 0.0)
    scale = np.where(wrong & np.isfinite(faults.scale_std), faults.scale, best.signs)
    corrected = _correct_outputs(sensing, delay, scale)
    spectra = corrected.measured
    motion = reconstruct_motion(model, spectra.outputs, spectra.instruments, faults.noise)
    unknown = ~(faults.scale_std < _RESOLVED_SCALE_STD)
    faults = replace(
        faults,
        scale=np.where(unknown, 1.0, faults.scale),
        scale_std=np.where(unknown, 0.0, faults.scale_std),
    )
    not_checked = _explain_not_checked(faults, best, _find_quiet(sensing), count)
    kinds = {o.name: o.kind for o in sensing.outputs}
    is_vane_misfit = np.array([kinds[name] == VANE.kind for name in faults.names]) & poor
    for name in np.array(faults.names)[is_vane_misfit]:
        not_checked[str(name)] += " (a vane also reads turbulence)"
    return RedundancyCheck(
        faults=faults,
        coherence=_compute_coherence(sensing, corrected, model, faults.noise),
        noise_excess=np.where(is_vane_misfit, np.nan, best.misfit),
        inputs=_estimate_input_skews(corrected, motion, faults),
        not_checked=not_checked,
    )


def _correct_outputs(sensing: SensorData, delay_s: np.ndarray, scale: np.ndarray) -> SensorData:
    """Remove delays and scale factors from the spectra of the outputs."""
    outputs = sensing.measured.outputs
    straight = np.exp(1j * np.outer(outputs.omega, delay_s)) / scale
    return sensing.with_outputs(outputs.values * straight)


def _find_quiet(sensing: SensorData) -> np.ndarray:
    """Find sensors that contain little but noise."""
    level = np.sqrt(np.mean(np.abs(sensing.measured.outputs.values) ** 2, axis=0))
    return level < _SIGNAL_OVER_NOISE * np.nan_to_num(sensing.noise)


def _compute_coherence(
    sensing: SensorData, corrected: SensorData, model: AeroelasticModel, noise: np.ndarray
) -> np.ndarray:
    """Compute the coherence of each sensor with the others; NaN with little but noise."""
    spectra = corrected.measured
    coherence = compute_sensor_coherence(model, spectra.outputs, spectra.instruments, noise)
    return np.where(_find_quiet(sensing), np.nan, coherence)


def _detect_by_number_of_modes(sensing: SensorData) -> dict[int, FaultDetection]:
    """Detect faults with a decreasing number of modes while the criterion improves; by number."""
    spectra = sensing.measured
    scaled = tuple(o.name for o in sensing.outputs if o.model.calibration != "uncertain")
    tried: dict[int, FaultDetection] = {}
    reason: NotIdentifiable | None = None
    best, worse = np.inf, 0
    omega = sensing.with_modes(sensing.modes).modes.omega
    for count in range(int(np.sum(omega <= _MAX_MODE_FREQUENCY_RATIO * spectra.omega[-1])), -1, -1):
        model = sensing.with_modes(sensing.modes[:count])
        try:
            found = detect_sensor_faults(
                model, spectra.outputs, spectra.instruments, scaled, sensing.noise
            )
        except NotIdentifiable as error:
            reason = error
            continue
        tried[count] = found
        worse = 0 if found.criterion < best else worse + 1
        best = min(best, found.criterion)
        if worse == _MAX_WORSE_MODELS:
            break
    if not tried:
        assert reason is not None
        raise reason
    return tried


def _explain_not_checked(
    faults: SensorFaults, best: FaultDetection, quiet: np.ndarray, count: int
) -> dict[str, str]:
    """Explain why sensors could not be checked."""
    reasons = {}
    for k, name in enumerate(faults.names):
        if best.rival is not None and best.signs[k] < 0:
            reasons[name] = (
                f"it or {best.rival} has the opposite sign, and the data do not resolve which"
            )
        elif quiet[k]:
            reasons[name] = "it contains little but noise"
        elif best.misfit[k] > _MISFIT:
            reasons[name] = (
                f"it departs from the other sensors by {best.misfit[k]:.0f} times its noise, "
                "which neither a delay nor a scale factor explains"
            )
        elif not faults.delay_std[k] < RESOLVED_DELAY_STD_S:
            reasons[name] = (
                f"the other sensors do not resolve its part in the motion of {count} modes"
            )
    return reasons


def _estimate_all_delays(sensing: SensorData) -> RedundancyCheck:
    """Estimate delays of all sensors, and scale factors of gyros and vanes.

    A sensor that departs from the others and agrees with opposite sign has a scale factor
    below zero. Modes are selected after removal of the delays, because a delay resembles an
    omitted mode; the effect of further modes widens the standard errors.

    Raises
    ------
    NotIdentifiable
        If the sensors are not redundant.
    """
    found = _estimate_faults(sensing)
    excess = np.nan_to_num(found.noise_excess)
    worst = int(np.argmax(excess))
    if excess[worst] < _SIGN_TEST_RATIO:
        return found
    sign = np.where(np.arange(excess.size) == worst, -1.0, 1.0)
    other = _estimate_faults(sensing.with_outputs(sensing.measured.outputs.values * sign))
    if not other.noise_excess[worst] < _SIGN_RESIDUAL_FRACTION * found.noise_excess[worst]:
        return found
    return replace(other, faults=replace(other.faults, scale=other.faults.scale * sign))


def _estimate_faults(sensing: SensorData) -> RedundancyCheck:
    spectra = sensing.measured
    scaled = tuple(o.name for o in sensing.outputs if o.model.calibration == "estimated")
    if len(scaled) == len(sensing.outputs):
        scaled = ()
    reference = _select_reference(sensing)
    least = np.nan_to_num(sensing.noise)

    def estimate(model: AeroelasticModel, near: SensorFaults | None = None) -> SensorFaults:
        return estimate_sensor_faults(
            model, spectra.outputs, spectra.instruments, reference, scaled, least, near
        )

    first = estimate(sensing.model)
    delay = np.where(first.delay_std < _MAX_DELAY_STD_S, first.delay_s, 0.0)
    corrected = _correct_outputs(sensing, delay, first.scale)
    model, motion = reconstruct_resolved_modes(corrected)
    count = len(model.modes.numbers)
    same = model.modes.numbers == sensing.model.modes.numbers
    best = first if same else estimate(model, first)
    others = []
    for more in range(count + 1, min(count + _MORE_MODES, len(sensing.modes)) + 1):
        try:
            others.append(estimate(sensing.with_modes(sensing.modes[:more]), best))
        except NotIdentifiable:
            break
    faults = widen_standard_errors(best, others)
    return RedundancyCheck(
        faults=faults,
        coherence=_compute_coherence(sensing, corrected, model, motion.noise),
        noise_excess=motion.noise / sensing.noise,
        inputs=_estimate_input_skews(corrected, motion, faults),
        not_checked={
            name: "the other sensors do not resolve its delay"
            for name, std in zip(faults.names, faults.delay_std, strict=True)
            if not std < _MAX_DELAY_STD_S
        },
    )


def _estimate_input_skews(
    sensing: SensorData, motion: ReconstructedMotion, faults: SensorFaults
) -> InputSkews | None:
    """Estimate skews of the surfaces; one mode fewer or more widens their errors.

    The timing error of the motion is that of the sensors. None without a known
    excitation: regressors are then mostly noise and bias the delays; and where both axes are
    excited: few sensors measure one of them only, so that modes are missing from the motion.
    """
    if sensing.maneuver.excitation is None or sensing.maneuver.axis == COMBINED:
        return None
    spectra = sensing.measured
    numbers = sensing.modes[: motion.values.shape[1] - sensing.model.n_rigid]
    near = sensing.with_modes(numbers).modes.omega < _MAX_DYNAMIC_MODE_RATIO * spectra.omega[-1]
    count = int(np.sum(near))
    found: list[InputSkews] = []
    for number in (count, count - 1, count + 1):
        if not 0 <= number <= len(numbers):
            continue
        try:
            model = sensing.with_modes(numbers[:number])
            found.append(
                estimate_input_skews(
                    model,
                    motion.select_motions(model.n_rigid + number),
                    spectra.inputs,
                    spectra.input_noise,
                    found[0] if found else None,
                )
            )
        except (NotIdentifiable, np.linalg.LinAlgError):
            if number == count:
                return None
    timing_std_s = float(np.median(faults.delay_std[np.isfinite(faults.delay_std)]))
    spread = [(one.delay_s - found[0].delay_s) ** 2 for one in found]
    return replace(
        found[0],
        delay_std=np.sqrt(found[0].delay_std ** 2 + np.max(spread, axis=0) + timing_std_s**2),
    )


def estimate_biases(
    store: Store, maneuver: Maneuver, faults: SensorFaults | None
) -> dict[str, Bias]:
    """Estimate biases of gyros and vanes against attitude, or against trim without attitude."""
    recorded = {c.name for c in store.channels.find(maneuver_id=maneuver.id)}
    aircraft = store.aircraft.get(maneuver.aircraft_id)
    pitch = [s for s in aircraft.sensors if s.axis == "y" and s.name in recorded]
    attitude = next((s for s in pitch if s.kind == ATTITUDE.kind), None)
    climb = _estimate_climb_angle(store, maneuver)
    found: dict[str, Bias] = {}
    for sensor in pitch:
        if sensor.kind not in (GYRO.kind, VANE.kind):
            continue
        channel, values = _load_sensor(store, maneuver, sensor.name)
        trim = _slice_trim(maneuver, channel)
        if trim.stop - trim.start < 4:
            continue
        scale, std = 1.0, 0.0
        if faults is not None and sensor.name in faults.names:
            index = faults.names.index(sensor.name)
            scale, std = float(faults.scale[index]), float(faults.scale_std[index])
        level = None
        if attitude is not None:
            clock, level = _load_sensor(store, maneuver, attitude.name)
            if clock.clock != channel.clock:
                level = resample(level, clock.rate_hz, clock.start_s, *channel.clock)
        if sensor.kind == GYRO.kind:
            bias = estimate_gyro_bias(values, level, channel.rate_hz, trim, scale, std)
        elif level is not None:
            bias = estimate_vane_bias(values, level, climb, trim, scale, std)
        else:
            continue
        if np.isfinite(bias.std):
            found[sensor.name] = bias
    return found


def _select_reference(sensing: SensorData) -> str:
    """Select the time reference: the vertical accelerometer nearest the c.g."""
    x = sensing.maneuver.condition.x_cg_m
    heave = [
        o.terms[0][0]
        for o in sensing.outputs
        if o.kind == ACCELEROMETER.kind and o.terms[0][0].axis == "z"
    ]
    if not heave:
        return sensing.outputs[0].name
    return min(heave, key=lambda s: np.hypot(s.location_m[0] - x, s.location_m[1])).name


def _slice_trim(maneuver: Maneuver, channel: Channel) -> slice:
    """Return the samples before the excitation."""
    excitation = maneuver.excitation
    stop_s = channel.start_s + _TRIM_S if excitation is None else excitation.start_s
    count = min(channel.n_samples, max(0, int((stop_s - channel.start_s) * channel.rate_hz)))
    return slice(0, count)


def _estimate_climb_angle(store: Store, maneuver: Maneuver) -> Bias:
    """Estimate the flight path angle from altitude, else return that of the condition."""
    if not store.channels.find(maneuver_id=maneuver.id, role=Role.CONDITION, name="altitude"):
        gamma = maneuver.condition.gamma_rad
        return Bias(value=gamma, std=0.0, basis=f"gamma taken as {np.degrees(gamma):.2f} deg")
    channel, values = _load_sensor(store, maneuver, "altitude")
    return estimate_climb_angle(values, channel.rate_hz, maneuver.condition.airspeed_m_s)


def _load_sensor(store: Store, maneuver: Maneuver, name: str) -> tuple[Channel, np.ndarray]:
    ((channel, values),) = load_channels(store, maneuver.id, [name])
    return channel, np.asarray(values, dtype=float)


# --- Surfaces of a maneuver as flown, against their recorded commands -----------------------------

_MULTIPLE = 3  # of the highest harmonic: a rate limit has its effect at three times a frequency
_MAX_FREQUENCY_RATIO = 0.4  # of the lowest sampling rate, clear of the anti-alias filters
_MIN_HARMONICS = 8  # of a surface: fewer do not separate a servo from its delay


def check_surfaces(
    store: Store, maneuver: Maneuver, aircraft: Aircraft
) -> tuple[SurfaceQuality, ...]:
    """Compare every recorded surface with its command; with a reason where that is not possible."""
    channels = {c.name: c for c in store.channels.find(maneuver_id=maneuver.id)}
    surfaces = [
        s.name
        for s in aircraft.surfaces
        if s.name in channels and channels[s.name].role is Role.INPUT
    ]
    reasons = {name: _find_reason(name, maneuver, aircraft, set(channels)) for name in surfaces}
    checked = tuple(name for name in surfaces if reasons[name] is None)
    outputs = tuple(
        s.name
        for s in aircraft.sensors
        if s.model.senses != "strain"  # gauges are not fed back
        and s.name in channels
        and channels[s.name].role is Role.OUTPUT
    )
    found = {one.name: _convert(one) for one in _check(store, maneuver, aircraft, checked, outputs)}
    return tuple(
        found.get(name) or SurfaceQuality(name=name, not_checked=reasons[name]) for name in surfaces
    )


def _find_reason(
    name: str, maneuver: Maneuver, aircraft: Aircraft, recorded: set[str]
) -> str | None:
    """Find why a surface cannot be compared with its command."""
    if maneuver.excitation is None:
        return "no multisine is known"
    if any(s.name == name and s.actuator is not None for s in aircraft.surfaces):
        return "its command was recorded in place of its deflection"
    if list_command_names((name,))[0] not in recorded:
        return "its command was not recorded"
    if len(list_harmonics(aircraft, maneuver.excitation, name)) < _MIN_HARMONICS:
        return f"it was excited at fewer than {_MIN_HARMONICS} harmonics"
    return None


def _check(
    store: Store,
    maneuver: Maneuver,
    aircraft: Aircraft,
    surfaces: tuple[str, ...],
    outputs: tuple[str, ...],
) -> Iterator[SurfaceCheck]:
    excitation = maneuver.excitation
    if not surfaces or excitation is None:
        return
    commands = list_command_names(surfaces)
    names = (*surfaces, *commands, *outputs)
    rates = [c.rate_hz for c in store.channels.find(maneuver_id=maneuver.id) if c.name in names]
    period = excitation.period_s
    highest = max(max(own) for own in excitation.harmonics.values())
    count = int(min(_MULTIPLE * highest, _MAX_FREQUENCY_RATIO * min(rates) * period))
    omega = compute_harmonic_frequencies(np.arange(1, count + 1), period)
    frequencies = SpectrumFrequencies(omega, np.full(count, -1), ())
    # Amplitudes: the transform of a harmonic over its periods is half of it times their time.
    scale = 2.0 / (period * excitation.n_periods)
    spectra = read_spectra(store, maneuver, aircraft, names, frequencies).values * scale
    n = len(surfaces)
    for k, name in enumerate(surfaces):
        harmonics = [one for one in list_harmonics(aircraft, excitation, name) if one <= count]
        if len(harmonics) < _MIN_HARMONICS:
            continue
        deflection = spectra[:, k] * compute_input_correction(aircraft, name, omega)
        yield check_surface(
            name,
            harmonics,
            min(highest, count),
            period,
            spectra[:, n + k],
            deflection,
            spectra[:, 2 * n :],
            outputs,
        )


def _convert(check: SurfaceCheck) -> SurfaceQuality:
    servo, motion, limit = check.servo, check.uncommanded, check.rate_limit
    found = SurfaceQuality(
        name=check.name, response=check.response, fed_back=check.fed_back, lost=check.lost
    )
    if servo is not None:
        found = replace(
            found,
            gain=servo.gain,
            delay_s=servo.delay_s,
            natural_frequency_hz=servo.natural_frequency / (2.0 * np.pi),
            damping=servo.damping,
        )
    if motion is not None:
        found = replace(found, motion=motion.amplitude, motion_hz=motion.frequency_hz)
    if limit is not None:
        found = replace(found, rate_limit=limit.rate, rate_limited=limit.share)
    return found
