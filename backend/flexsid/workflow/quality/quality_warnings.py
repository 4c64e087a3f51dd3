"""Data quality warnings of a maneuver and its verdict."""

from __future__ import annotations

from collections.abc import Container, Iterator, Sequence
from math import degrees, radians

from flexsid.records.maneuver import Maneuver, Role
from flexsid.records.quality import (
    ChannelQuality,
    FindingKind,
    QualityReport,
    QualityVerdict,
    QualityWarning,
    SensorFinding,
    SurfaceQuality,
)
from flexsid.sysid.preparation.spikes_and_dropouts import SampleDefect
from flexsid.text import join_names
from flexsid.workflow.measurements.flight_records import MAX_CLIPPED
from flexsid.workflow.measurements.maneuver_spectra import (
    MAX_AIRSPEED_DRIFT,
    MAX_DENSITY_DRIFT,
    UNUSABLE_DRIFT,
)
from flexsid.workflow.quality.sensor_skews import RESOLVED_DELAY_STD_S

# --- Data quality warnings of a maneuver and its verdict ------------------------------------------

MAX_FUEL_CHANGE = 0.03
"""Fuel burnt over a maneuver of four periods that the paper accepts. [fraction]"""

_MIN_SIGNAL_DB = (12.0, 3.0)  # median of all outputs: warning below the first, bad below the second
_SIGNAL_DB = 6.0  # of a channel with enough signal to assess
_MIN_COHERENCE = (0.8, 0.2)  # coherence with the other sensors
_MAX_NOISE_EXCESS = 4.0  # times its known noise
# Below it a channel differs from the others by noise: a low coherence is a small signal then.
_NOISE_ONLY = 2.0
_SKEW_S = 1e-3
_INPUT_SKEW_S = 3e-3  # unmodelled modes bias it by up to a millisecond
_SCALE = 0.02
_SIGMAS = 3.0
_SKEW_SIGMAS = 4.0  # one of fifty channels exceeds three by chance
_MAX_CORRELATION = (0.7, 0.9)
_UNCOMMANDED_RAD = radians(0.05)  # a quarter of a limit cycle that matters, three times clean ones
_MIN_TRIM_S = 1.0
_MAX_RESIDUAL_MOTION = 0.1  # of the motion while excited

_MIN_CHECKED = 0.5  # of the outputs: with fewer the record is unchecked

_ABOUT = {
    FindingKind.SIGN: "sign",
    FindingKind.UNIT: "scale",
    FindingKind.SCALE: "scale",
    FindingKind.DELAY: "skew",
    FindingKind.FROZEN: "dropouts",
    FindingKind.AIRSPEED: "condition",
}
_GOOD, _WARNING, _BAD = QualityVerdict.GOOD, QualityVerdict.QUESTIONABLE, QualityVerdict.BAD


def list_quality_warnings(
    maneuver: Maneuver, report: QualityReport, decay: tuple[str, float] | None
) -> tuple[QualityWarning, ...]:
    """List the warnings about a maneuver, the most severe first.

    Parameters
    ----------
    maneuver
        The maneuver with its excitation.
    report
        The quality report without warnings.
    decay
        Sensor with the largest motion at the end, over its motion during the excitation.
    """
    of_samples = list(_warn_of_samples(report.channels))
    # Frozen or clipped samples are why such a channel departs from the others.
    damaged = {warning.channel for warning in of_samples}
    findings = [
        one
        for one in report.findings
        if one.channel not in damaged or one.kind in (FindingKind.SIGN, FindingKind.UNIT)
    ]
    named = {one.channel for one in findings} | damaged
    found = [
        *of_samples,
        *_warn_of_signal(report.channels),
        *_warn_of_findings(findings),
        *_warn_of_redundancy(report.channels, report.skew_reference, named),
        *_warn_of_inputs(report),
        *warn_of_surfaces(report.surfaces),
        *_warn_of_condition(report),
        *_warn_of_record(maneuver, decay),
    ]
    order = {_BAD: 0, _WARNING: 1, _GOOD: 2}
    return tuple(sorted(found, key=lambda warning: order[warning.severity]))


def determine_verdict(report: QualityReport) -> tuple[QualityVerdict, str]:
    """Determine the verdict and its summary."""
    bad = [f for f in report.warnings if f.severity is _BAD]
    warnings = [f for f in report.warnings if f.severity is _WARNING]
    if bad:
        return _BAD, _join_warnings("Not usable for estimation", bad)
    if warnings:
        return _WARNING, _join_warnings("Check before estimation", warnings)
    outputs = [c for c in report.channels if c.role == Role.OUTPUT]
    unchecked = [c for c in outputs if c.not_checked is not None]
    checked = len(outputs) - len(unchecked)
    if checked == 0 or checked < _MIN_CHECKED * len(outputs):
        return QualityVerdict.UNCHECKED, _explain_unchecked(outputs, unchecked)
    ratios = [c.signal_to_noise_db for c in report.channels if c.signal_to_noise_db is not None]
    words = [f"signals are {sorted(ratios)[len(ratios) // 2]:.0f} dB above noise"] if ratios else []
    words.append(f"{checked} of {len(outputs)} sensors agree with the others")
    if report.condition.time_invariant:
        words.append("the condition was steady")
    text = f"Fit for estimation: {', '.join(words)}."
    if unchecked:
        text += f" Cannot be checked: {join_names([c.name for c in unchecked])}."
    return _GOOD, text


def _explain_unchecked(outputs: Sequence[ChannelQuality], left: Sequence[ChannelQuality]) -> str:
    """Explain why a record is unchecked."""
    if not outputs:
        return "Cannot be checked: no output was recorded."
    reasons = [c.not_checked or "" for c in left]
    reason = max(dict.fromkeys(reasons), key=reasons.count)
    some = "no sensor" if len(left) == len(outputs) else f"{len(outputs) - len(left)} sensors"
    return (
        f"Cannot be checked: {some} of {len(outputs)} could be checked against the others; "
        f"{reason}."
    )


def _join_warnings(begin: str, warnings: Sequence[QualityWarning]) -> str:
    shown = " ".join(warning.text for warning in warnings[:2])
    more = len(warnings) - 2
    return f"{begin}. {shown}" + (f" And {more} more." if more > 0 else "")


def _warn(
    severity: QualityVerdict, about: str, text: str, channel: str | None = None
) -> QualityWarning:
    return QualityWarning(severity=severity, about=about, channel=channel, text=text)


def _warn_of_samples(channels: Sequence[ChannelQuality]) -> Iterator[QualityWarning]:
    for channel in channels:
        kinds = [stretch.kind for stretch in channel.stretches]
        if channel.saturated > 0.0:
            severity = _BAD if channel.saturated > MAX_CLIPPED else _WARNING
            text = f"{channel.name} is saturated for {channel.saturated:.2%} of its samples."
            yield _warn(severity, "saturation", text, channel.name)
        if spikes := kinds.count(SampleDefect.SPIKE):
            text = f"{channel.name} has {_count(spikes, 'spike')}; a repair removes them."
            yield _warn(_WARNING, "spikes", text, channel.name)
        if dropouts := kinds.count(SampleDefect.DROPOUT):
            text = f"{channel.name} has {_count(dropouts, 'dropout')} with constant samples."
            yield _warn(_BAD, "dropouts", text, channel.name)


def _warn_of_signal(channels: Sequence[ChannelQuality]) -> Iterator[QualityWarning]:
    outputs = [c for c in channels if c.role == Role.OUTPUT and c.signal_to_noise_db is not None]
    if outputs:
        ratios = sorted(c.signal_to_noise_db or 0.0 for c in outputs)
        middle = ratios[len(ratios) // 2]
        if middle < _MIN_SIGNAL_DB[0]:
            severity = _BAD if middle < _MIN_SIGNAL_DB[1] else _WARNING
            text = f"Outputs are only {middle:.0f} dB above their noise."
            yield _warn(severity, "signal", text)
        quiet = [c.name for c in outputs if (c.signal_to_noise_db or 0.0) < _SIGNAL_DB]
        if quiet and middle >= _MIN_SIGNAL_DB[1]:
            text = f"Little signal in {join_names(quiet)}."
            yield _warn(_GOOD, "signal", text)
    for channel in channels:
        ratio = channel.signal_to_noise_db
        if channel.role == Role.INPUT and ratio is not None and ratio < _MIN_SIGNAL_DB[0]:
            severity = _BAD if ratio < _MIN_SIGNAL_DB[1] else _WARNING
            text = f"{channel.name} is only {ratio:.0f} dB above its noise at its own harmonics."
            yield _warn(severity, "signal", text, channel.name)


def _warn_of_findings(findings: Sequence[SensorFinding]) -> Iterator[QualityWarning]:
    """Warn of faults by kinematics; one of a sign or unit leaves nothing to estimate from."""
    for one in findings:
        severity = _BAD if one.kind in (FindingKind.SIGN, FindingKind.UNIT) else _WARNING
        about = _ABOUT.get(one.kind, "coherence")
        yield _warn(severity, about, f"{one.sentence} {one.remedy}", one.channel)


def _warn_of_redundancy(
    channels: Sequence[ChannelQuality], reference: str | None, named: Container[str]
) -> Iterator[QualityWarning]:
    """Warn of channels whose faults are not named already."""
    for c in channels:
        if c.name in named:
            continue
        if c.role == Role.OUTPUT and c.not_checked is not None:
            yield from _warn_of_departure(c)
            continue
        has_signal = c.signal_to_noise_db is None or c.signal_to_noise_db > _SIGNAL_DB
        departs = c.noise_excess is None or c.noise_excess > _NOISE_ONLY
        is_low = c.coherence is not None and c.coherence < _MIN_COHERENCE[0]
        if c.coherence is not None and is_low and has_signal and departs:
            severity = _BAD if c.coherence < _MIN_COHERENCE[1] else _WARNING
            text = f"{c.name} agrees with the other sensors with a coherence of {c.coherence:.2f}."
            yield _warn(severity, "coherence", text, c.name)
        elif c.noise_excess is not None and c.noise_excess > _MAX_NOISE_EXCESS:
            text = (
                f"{c.name} departs from the other sensors by {c.noise_excess:.0f} times its noise."
            )
            yield _warn(_WARNING, "coherence", text, c.name)
        least = _INPUT_SKEW_S if c.role == Role.INPUT else _SKEW_S
        if (
            _is_significant(c.delay_s, c.delay_std, least, _SKEW_SIGMAS)
            and (c.delay_std or 0.0) < RESOLVED_DELAY_STD_S
        ):
            text = (
                f"{c.name} is {1e3 * (c.delay_s or 0.0):+.1f} ± {1e3 * (c.delay_std or 0.0):.1f} ms"
                f" late on {reference}; a delay correction removes that."
            )
            yield _warn(_WARNING, "skew", text, c.name)
        if c.scale is not None and c.scale < 0.0:
            text = (
                f"{c.name} has the opposite sign: reversed, it agrees with the others. Reverse it "
                "in the mapping, or by a calibration with scale factor -1."
            )
            yield _warn(_BAD, "sign", text, c.name)
        elif c.scale is not None and _is_significant(
            c.scale - 1.0, c.scale_std, _SCALE, _SKEW_SIGMAS
        ):
            text = f"{c.name} has a scale factor of {c.scale:.3f} ± {c.scale_std or 0.0:.3f}."
            yield _warn(_WARNING, "scale", text, c.name)
        if _is_significant(c.bias, c.bias_std, 0.0):
            text = f"{c.name} has a bias of {c.bias:.3g} ± {c.bias_std:.2g} {c.unit}."
            yield _warn(_GOOD, "bias", text, c.name)


def _warn_of_departure(c: ChannelQuality) -> Iterator[QualityWarning]:
    """Warn of an output whose residual neither a delay nor a scale factor explains."""
    text = f"{c.name} cannot be checked: {c.not_checked}."
    if c.scale is not None and c.scale < 0.0:
        yield _warn(_BAD, "sign", text, c.name)
    elif c.noise_excess is not None and c.noise_excess > _MAX_NOISE_EXCESS:
        yield _warn(_WARNING, "coherence", text, c.name)


def _warn_of_inputs(report: QualityReport) -> Iterator[QualityWarning]:
    for pair in report.inputs:
        size = abs(pair.correlation)
        if size > _MAX_CORRELATION[0]:
            severity = _BAD if size > _MAX_CORRELATION[1] else _WARNING
            text = f"{pair.first} and {pair.second} correlate at {pair.correlation:.2f}."
            yield _warn(severity, "inputs", text)


def warn_of_surfaces(surfaces: Sequence[SurfaceQuality]) -> Iterator[QualityWarning]:
    """Warn of surfaces that did not fly what was commanded."""
    for one in surfaces:
        if one.response is None:
            continue
        if one.gain is None:
            text = f"{one.name} does not follow its command: it moved {one.response:.0%} of it."
            yield _warn(_BAD, "surface", text, one.name)
        elif one.gain < 0.0:
            text = (
                f"{one.name} moved against its command: check the sign of its deflection or of its "
                "command."
            )
            yield _warn(_BAD, "surface", text, one.name)
        if one.lost:
            text = (
                f"{_count(len(one.lost), 'harmonic')} of {one.name} did not arrive, the first "
                f"{one.lost[0]}: a mixer or a limit removed it."
            )
            yield _warn(_WARNING, "surface", text, one.name)
        if one.motion is not None and one.motion > _UNCOMMANDED_RAD:
            text = (
                f"{one.name} oscillates without command at {one.motion_hz:.2f} Hz with "
                f"{degrees(one.motion):.2f} deg."
            )
            yield _warn(_WARNING, "surface", text, one.name)
        if one.rate_limit is not None:
            text = (
                f"{one.name} is at its rate limit of about {degrees(one.rate_limit):.0f} deg/s for "
                f"{one.rate_limited:.1%} of the time: its harmonics are distorted."
            )
            yield _warn(_WARNING, "surface", text, one.name)


def _warn_of_condition(report: QualityReport) -> Iterator[QualityWarning]:
    condition = report.condition
    if condition.fuel_change is not None and condition.fuel_change > MAX_FUEL_CHANGE:
        text = f"{condition.fuel_change:.1%} of the fuel burnt: the structure changed in flight."
        yield _warn(_WARNING, "condition", text)
    drift = condition.airspeed_drift
    if drift is not None and drift > MAX_AIRSPEED_DRIFT:
        severity = _BAD if drift > UNUSABLE_DRIFT else _WARNING
        text = f"Airspeed drifted by {drift:.1%}: a time-invariant model is not valid."
        yield _warn(severity, "condition", text)
    air = next((one for one in condition.averages if one.name == "density"), None)
    if air is not None and abs(air.drift) > MAX_DENSITY_DRIFT * abs(air.mean):
        text = f"Density drifted by {abs(air.drift / air.mean):.0%}, and dynamic pressure with it."
        yield _warn(_WARNING, "condition", text)
    for text in condition.contradictions:
        yield _warn(_BAD, "condition", text)


def _warn_of_record(
    maneuver: Maneuver, decay: tuple[str, float] | None
) -> Iterator[QualityWarning]:
    excitation = maneuver.excitation
    if excitation is None:
        text = "The harmonics of the inputs are not known: FRE needs them."
        yield _warn(_GOOD, "record", text)
        return
    trim_s = excitation.start_s - maneuver.start_s
    if trim_s < _MIN_TRIM_S:
        text = f"Only {max(trim_s, 0.0):.2g} s of trim precede the excitation."
        yield _warn(_WARNING, "record", text)
    if decay is not None and decay[1] > _MAX_RESIDUAL_MOTION:
        text = (
            f"{decay[0]} has {decay[1]:.0%} of its motion at the end of the record: "
            "the transform of one period needs the decay."
        )
        yield _warn(_WARNING, "record", text)


def _is_significant(
    value: float | None, std: float | None, least: float, sigmas: float = _SIGMAS
) -> bool:
    return value is not None and std is not None and abs(value) > max(least, sigmas * std)


def _count(number: int, what: str) -> str:
    return f"{number} {what}" if number == 1 else f"{number} {what}s"
