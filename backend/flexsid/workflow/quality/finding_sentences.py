"""Sentences of sensor faults: which fault, by how much, and what settles it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import floor, log10, sqrt

from flexsid.records.compatibility import FindingKind, SensorFinding
from flexsid.records.maneuver import Correction, StepKind
from flexsid.sysid.compatibility.fault_search import UNIT_FACTORS, Fault, is_unit_factor
from flexsid.sysid.compatibility.likelihood import SensorFaultKind
from flexsid.sysid.model.sensor_models import ACCELEROMETER
from flexsid.text import join_names
from flexsid.workflow.measurements.flight_records import FrozenInterval, HeldChannel

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
    """Describe a channel that repeats each of its samples."""
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
        remedy=f"Import {held.name} at its own rate, with only its new samples.",
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
