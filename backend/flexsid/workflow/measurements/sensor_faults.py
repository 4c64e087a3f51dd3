"""Sensor faults of recorded maneuvers: what samples and kinematics show, and what settles it.

Without a database, so that a worker names the fault behind a run that its tests reject.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import floor, log10, sqrt

import numpy as np

from flexsid.errors import NotIdentifiable
from flexsid.records import finite_or_none
from flexsid.records.maneuver import Correction, StepKind
from flexsid.records.quality import (
    CompatibilityReport,
    CompatibilityState,
    FindingKind,
    SensorEstimate,
    SensorFault,
    SensorFinding,
)
from flexsid.sysid.compatibility.fault_search import (
    MOST_MISFIT,
    UNIT_FACTORS,
    Compatibility,
    Fault,
    check_compatibility,
    is_unit_factor,
)
from flexsid.sysid.compatibility.kinematics import FlightRecord
from flexsid.sysid.compatibility.likelihood import SensorFaultKind
from flexsid.sysid.model.sensor_models import ACCELEROMETER, VANE
from flexsid.sysid.preparation.resampling import BetweenSamples
from flexsid.text import count_noun, join_names

# --- What was recorded of the sensors of a maneuver -----------------------------------------------


@dataclass(frozen=True, slots=True)
class HeldChannel:
    """A channel that is new at a rate below that of its samples. [Hz]"""

    name: str
    rate_hz: float
    recorded_hz: float
    is_input: bool


@dataclass(frozen=True, slots=True)
class FrozenInterval:
    """Channels that repeat one value from a time to another. [s]"""

    channels: tuple[str, ...]
    start_s: float
    stop_s: float


@dataclass(frozen=True, slots=True)
class RecordedSensors:
    """What is compared of a maneuver, and what was found in the samples alone.

    ``excluded`` has the reason by channel that is not compared.
    """

    record: FlightRecord
    held: tuple[HeldChannel, ...]
    frozen: tuple[FrozenInterval, ...]
    excluded: dict[str, str]


# --- Faults of the sensors of maneuvers, and all that was estimated of them --------------------

_LEAST = {SensorFaultKind.DELAY: 1e-3, SensorFaultKind.SCALE: 0.02, SensorFaultKind.AIRSPEED: 0.02}
"""Smallest faults that matter: delay [s] and logarithms of ratios."""

_LEAST_ARM = 0.02  # of the chord, as locations are known
_MAX_MISFIT_FRACTION = 1.0 / 3.0  # of the sensors: above, nothing is concluded
_UNEXPLAINED = (
    "more than a third of the sensors depart from the motion of a rigid aircraft; if the "
    "structure moves, import a modal table"
)


def describe_compatibility(
    maneuver_ids: tuple[int, ...], recorded: Sequence[RecordedSensors]
) -> CompatibilityReport:
    """Compare the sensors of records, and describe what was found."""
    kinds = {one.name: one.kind for r in recorded for one in r.record.sensors}
    samples = list(_describe_samples(recorded))
    try:
        found = check_compatibility([one.record for one in recorded])
    except NotIdentifiable as error:
        reason = error.message
        sensors = tuple(
            SensorEstimate(name=name, kind=kind, not_checked=reason) for name, kind in kinds.items()
        )
        state = CompatibilityState.FAULTY if samples else CompatibilityState.UNCHECKED
        sentences = [one.finding.sentence for one in samples]
        return CompatibilityReport(
            maneuver_ids=maneuver_ids,
            state=state,
            sentence=" ".join([*sentences, f"Not compared: {reason}."]),
            faults=tuple(samples),
            sensors=(*sensors, *_list_excluded(recorded)),
        )
    poor = {
        name: float(misfit)
        for name, misfit in zip(found.sensors, found.misfit, strict=True)
        if misfit > MOST_MISFIT
    }
    is_unexplained = len(poor) > _MAX_MISFIT_FRACTION * len(found.sensors)
    faults = (
        []
        if is_unexplained
        else [
            _describe_fault(one, kinds, recorded)
            for one in found.faults
            if _matters(one, recorded) and one.candidate.channel not in poor
        ]
    )
    every = (*samples, *faults)
    unchecked = (
        dict.fromkeys(found.sensors, _UNEXPLAINED)
        if is_unexplained
        else _explain_unchecked(found, poor, kinds)
    )
    sensors = (*_list_estimates(found, kinds, unchecked), *_list_excluded(recorded))
    state, sentence = _summarise(every, sensors, len(maneuver_ids))
    return CompatibilityReport(
        maneuver_ids=maneuver_ids,
        state=state,
        sentence=sentence,
        faults=every,
        sensors=sensors,
        band_hz=found.band_hz,
        n_frequencies=found.n_frequencies,
    )


def _describe_samples(recorded: Sequence[RecordedSensors]) -> Iterator[SensorFault]:
    """Describe what the samples alone show: channels that are held or frozen."""
    held = {one.name: one for r in recorded for one in r.held}
    for one in held.values():
        yield SensorFault(finding=describe_held(one))
    for interval in (one for r in recorded for one in r.frozen):
        yield SensorFault(finding=describe_frozen(interval))


def _describe_fault(
    fault: Fault, kinds: Mapping[str, str], recorded: Sequence[RecordedSensors]
) -> SensorFault:
    density = recorded[0].record.condition.density
    finding = describe_fault(fault, kinds, density)
    others = tuple(describe_fault(one, kinds, density) for one in fault.inseparable)
    if others and finding.kind not in (FindingKind.AIRSPEED, FindingKind.UNIT, FindingKind.SIGN):
        # The data do not separate them, but the kind of airspeed has a value of its own.
        known = [one for one in others if "calibrated" in one.sentence]
        if known:
            finding, others = known[0], (finding, *(one for one in others if one != known[0]))
    return SensorFault(finding=finding, inseparable=others, question=ask_between(finding, others))


def _matters(fault: Fault, recorded: Sequence[RecordedSensors]) -> bool:
    """Whether a fault is large enough to matter."""
    one, value = fault.candidate, fault.value
    if one.kind is SensorFaultKind.ARM:
        return abs(value) > _LEAST_ARM * recorded[0].record.condition.chord
    if one.is_ratio:
        return value <= 0.0 or abs(np.log(value)) > _LEAST[one.kind]
    return abs(value) > _LEAST[one.kind]


def _explain_unchecked(
    found: Compatibility, poor: Mapping[str, float], kinds: Mapping[str, str]
) -> dict[str, str]:
    reasons = {}
    for name in found.sensors:
        if name in poor:
            turbulence = " (a vane also measures turbulence)" if kinds[name] == VANE.kind else ""
            reasons[name] = (
                f"it departs from the other sensors by {poor[name]:.2g} times its noise, which "
                f"no single fault explains{turbulence}"
            )
        elif not found.checked[name]:
            reasons[name] = "no other sensor determines what it measures"
    return reasons


def _list_estimates(
    found: Compatibility, kinds: Mapping[str, str], unchecked: Mapping[str, str]
) -> Iterator[SensorEstimate]:
    by_sensor: dict[str, dict[SensorFaultKind, Fault]] = {name: {} for name in found.sensors}
    for one in (*found.faults, *found.estimates):
        by_sensor.get(one.candidate.channel, {})[one.candidate.kind] = one
    for k, name in enumerate(found.sensors):
        delay, scale, arm = (
            by_sensor[name].get(kind)
            for kind in (SensorFaultKind.DELAY, SensorFaultKind.SCALE, SensorFaultKind.ARM)
        )
        yield SensorEstimate(
            name=name,
            kind=kinds[name],
            delay_s=_get_value(delay),
            delay_std_s=_get_std(delay),
            scale=_get_value(scale),
            scale_std=_get_std(scale),
            arm_axis="" if arm is None else arm.candidate.axis,
            arm_m=_get_value(arm),
            arm_std_m=_get_std(arm),
            misfit=float(found.misfit[k]),
            coherence=finite_or_none(found.coherence[k]),
            not_checked=unchecked.get(name),
        )


def _get_value(fault: Fault | None) -> float | None:
    return None if fault is None or not np.isfinite(fault.std) else fault.value


def _get_std(fault: Fault | None) -> float | None:
    return None if fault is None else finite_or_none(fault.std)


def _list_excluded(recorded: Sequence[RecordedSensors]) -> Iterator[SensorEstimate]:
    excluded = {name: reason for one in recorded for name, reason in one.excluded.items()}
    compared = {one.name for r in recorded for one in r.record.sensors}
    for name, reason in excluded.items():
        if name not in compared:
            yield SensorEstimate(name=name, kind="", not_checked=reason)


def _summarise(
    faults: Sequence[SensorFault], sensors: Sequence[SensorEstimate], n_maneuvers: int
) -> tuple[CompatibilityState, str]:
    if faults:
        text = " ".join(one.finding.sentence for one in faults[:2])
        more = len(faults) - 2
        return CompatibilityState.FAULTY, text + (f" And {more} more." if more > 0 else "")
    checked = [one for one in sensors if one.not_checked is None]
    left = [one for one in sensors if one.not_checked is not None and one.kind]
    if not checked or 2 * len(left) > len(checked) + len(left):
        reason = left[0].not_checked if left else "no sensor was compared"
        name = f"{left[0].name}: " if left else ""
        return CompatibilityState.UNCHECKED, f"Not checked. {name}{reason}."
    text = (
        f"{count_noun(len(checked), 'sensor')} agree on one motion over "
        f"{count_noun(n_maneuvers, 'maneuver')}."
    )
    if left:
        text += f" Not checked: {join_names([one.name for one in left])}."
    return CompatibilityState.COMPATIBLE, text


# --- Sentences of sensor faults: which fault, by how much, and what settles it --------------------

_SEA_LEVEL_DENSITY = 1.225  # of the standard atmosphere [kg/m3]
_LEAST_DENSITY_CHANGE = 0.03  # of calibrated over true airspeed
_UNITS = {1852.0 / 3600.0: "in m/s where knots are declared",
          3600.0 / 1852.0: "in knots where m/s are declared"}  # fmt: skip
_SIDES = {"x": ("ahead of", "behind"), "y": ("right of", "left of"), "z": ("below", "above")}
_BASIS = "compatibility of the sensors by kinematics"


def format_with_std(value: float, std: float | None) -> str:
    """Format a value and its standard error with the two digits that the error has."""
    if std is None or not 0.0 < std < float("inf"):
        return f"{value:.3g}"
    digits = max(0, 1 - floor(log10(std)))
    return f"{value:.{digits}f} ± {std:.{digits}f}"


def describe_fault(fault: Fault, kinds: Mapping[str, str], density: float) -> SensorFinding:
    """Describe a fault by kinematics; ``density`` is that of the air [kg/m3]."""
    one, value, std = fault.candidate, fault.value, fault.std
    name = one.channel
    if one.kind is SensorFaultKind.DELAY:
        way = "late" if value > 0.0 else "early"
        size = format_with_std(1e3 * abs(value), 1e3 * std)
        return _build(
            fault, FindingKind.DELAY, f"{name} is recorded {size} ms {way}.",
            f"Correct the delay of {name}, or declare it in its instrument.",
            Correction(channel=name, kind=StepKind.DELAY, delay_s=value, std=std, basis=_BASIS),
        )  # fmt: skip
    if one.kind is SensorFaultKind.ARM:
        side = _SIDES[one.axis][0 if value > 0.0 else 1]
        sentence = f"{name} is mounted {format_with_std(abs(value), std)} m {side} its place."
        return _build(
            fault, FindingKind.ARM, sentence,
            f"Correct the location of {name} in the aircraft record.",
        )  # fmt: skip
    if one.kind is SensorFaultKind.AIRSPEED:
        sentence = f"{name} is {format_with_std(value, std)} times true airspeed"
        meaning = _explain_airspeed(value, std, density)
        return _build(
            fault, FindingKind.AIRSPEED, f"{sentence}{meaning}.",
            "Import true airspeed, or correct its unit in the mapping.",
        )  # fmt: skip
    factor = is_unit_factor(value, std)
    if factor is not None and not _suits(factor, kinds[name]):
        factor = None
    scale = value if factor is None else factor
    correction = Correction(
        channel=name, kind=StepKind.CALIBRATION, scale=scale, std=std, basis=_BASIS
    )
    ratio = format_with_std(value, std)
    if factor == -1.0:
        return _build(
            fault, FindingKind.SIGN,
            f"The sign of {name} is reversed: it reads {ratio} times the true value.",
            f"Reverse {name} in the mapping, or by a calibration with scale factor -1.", correction,
        )  # fmt: skip
    if factor is not None:
        return _build(
            fault, FindingKind.UNIT,
            f"The unit of {name} is wrong: it reads {ratio} times the true value, as if "
            f"{UNIT_FACTORS[factor]}.",
            f"Correct the unit of {name} in the mapping, or by a calibration.", correction,
        )  # fmt: skip
    return _build(
        fault, FindingKind.SCALE, f"{name} reads {ratio} times the true value.",
        f"Calibrate {name}.", correction,
    )  # fmt: skip


def describe_held(held: HeldChannel) -> SensorFinding:
    """Describe a channel that repeats each of its samples; no sensor moves in steps."""
    correction, choice = None, "'held' if the surface itself moves in steps, else 'smooth'"
    if not held.is_input:
        choice = "'smooth'"
        correction = Correction(
            channel=held.name,
            kind=StepKind.INTERPOLATION,
            between_samples=BetweenSamples.SMOOTH,
            basis="repeated samples",
        )
    return SensorFinding(
        kind=FindingKind.HELD,
        channel=held.name,
        axis="",
        value=held.rate_hz,
        std=None,
        gain=None,
        sentence=(
            f"{held.name} is held at {held.rate_hz:.3g} Hz: of its {held.recorded_hz:.4g} samples "
            "per second the others repeat the last one."
        ),
        remedy=f"Write between_samples of {held.name} in the mapping: {choice}.",
        correction=correction,
    )


def describe_frozen(interval: FrozenInterval) -> SensorFinding:
    """Describe an interval in which channels repeat one value."""
    verb = "repeats" if len(interval.channels) == 1 else "repeat"
    return SensorFinding(
        kind=FindingKind.FROZEN,
        channel=interval.channels[0],
        axis="",
        value=interval.stop_s - interval.start_s,
        std=None,
        gain=None,
        sentence=(
            f"{join_names(interval.channels)} {verb} one value from {interval.start_s:.4g} to "
            f"{interval.stop_s:.4g} s."
        ),
        remedy="Cut the maneuver before or after this interval.",
    )


def ask_between(finding: SensorFinding, others: Sequence[SensorFinding]) -> str:
    """Ask for what separates a fault from others; empty without others."""
    if not others:
        return ""
    channels = list(dict.fromkeys(one.channel for one in (finding, *others)))
    rest = " ".join(one.sentence for one in others)
    kinds = {one.kind for one in (finding, *others)}
    if FindingKind.ARM in kinds:
        ask = f"State the locations of {join_names(channels)} in the aircraft record"
    elif FindingKind.AIRSPEED in kinds:
        ask = f"Is the airspeed true airspeed? Otherwise check {join_names(channels)}"
    else:
        ask = f"Which of {join_names(channels)} is known to be right?"
        return f"The data do not separate this from: {rest} {ask}"
    return f"The data do not separate this from: {rest} {ask}."


def _explain_airspeed(value: float, std: float, density: float) -> str:
    for factor, meaning in _UNITS.items():
        if abs(value / factor - 1.0) < max(0.03, 3.0 * std / factor):
            return f": it is {meaning}"
    calibrated = sqrt(density / _SEA_LEVEL_DENSITY)
    if abs(calibrated - 1.0) > _LEAST_DENSITY_CHANGE and abs(value - calibrated) < 3.0 * std:
        return f", as calibrated airspeed is at this density ({calibrated:.3g})"
    return ""


def _suits(factor: float, kind: str) -> bool:
    """Whether a factor of units is one of this kind of sensor."""
    is_acceleration = abs(factor) in (9.80665, 1.0 / 9.80665)
    return factor == -1.0 or is_acceleration == (kind == ACCELEROMETER.kind)


def _build(
    fault: Fault, kind: FindingKind, sentence: str, remedy: str,
    correction: Correction | None = None,
) -> SensorFinding:  # fmt: skip
    return SensorFinding(
        kind=kind,
        channel=fault.candidate.channel,
        axis=fault.candidate.axis,
        value=fault.value,
        std=fault.std,
        gain=fault.gain,
        sentence=sentence,
        remedy=remedy,
        correction=correction,
    )
