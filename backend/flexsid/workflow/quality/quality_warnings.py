"""Findings: what the numbers of a maneuver mean, in words, and the verdict on it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from flexsid.records.maneuver import Maneuver, Role
from flexsid.records.quality import ChannelQuality, QualityReport, QualityVerdict, QualityWarning
from flexsid.workflow.measurements.condition_spread import MOST_DRIFT, MOST_FUEL

_QUIET_DB = (12.0, 3.0)  # median of all outputs: doubtful below, bad below
_HEARD_DB = 6.0  # a channel that can be judged by its signal
_AGREES = (0.8, 0.2)  # coherence with the other sensors
_EXCESS = 4.0  # times its known noise
_SKEW_S = 1e-3
_INPUT_SKEW_S = 3e-3  # modes that the model has not look like one of up to a millisecond
_SURE_S = 5e-3  # a larger standard error tells nothing that should be undone
_SCALE = 0.02
_SIGMAS = 3.0
_SKEW_SIGMAS = 4.0  # of some fifty channels one stands out of three by chance
_SATURATED = 0.005  # share of samples
_CORRELATED = (0.7, 0.9)
_LEAST_TRIM_S = 1.0
_UNDECAYED = 0.1  # of the motion while excited

_LEAST_CHECKED = 0.5  # of the outputs: with fewer nothing is concluded of the record

_GOOD, _DOUBTFUL, _BAD = QualityVerdict.GOOD, QualityVerdict.DOUBTFUL, QualityVerdict.BAD


def findings_of(
    maneuver: Maneuver, report: QualityReport, decay: tuple[str, float] | None
) -> tuple[QualityWarning, ...]:
    """Sentences for an analyst, the gravest first.

    Parameters
    ----------
    maneuver
        Its excitation tells what its record should hold.
    report
        The numbers, without findings.
    decay
        Sensor that still moves at the end, and its share of the motion while excited.
    """
    found = [
        *_of_samples(report.channels),
        *_of_signal(report.channels),
        *_of_redundancy(report.channels, report.skew_reference),
        *_of_inputs(report),
        *_of_condition(report),
        *_of_record(maneuver, decay),
    ]
    order = {_BAD: 0, _DOUBTFUL: 1, _GOOD: 2}
    return tuple(sorted(found, key=lambda finding: order[finding.severity]))


def verdict_of(report: QualityReport) -> tuple[QualityVerdict, str]:
    """The verdict, and one sentence that says why."""
    bad = [f for f in report.findings if f.severity is _BAD]
    doubtful = [f for f in report.findings if f.severity is _DOUBTFUL]
    if bad:
        return _BAD, _joined("Not to be estimated from as it is", bad)
    if doubtful:
        return _DOUBTFUL, _joined("To be looked at first", doubtful)
    outputs = [c for c in report.channels if c.role == Role.OUTPUT]
    open_ = [c for c in outputs if c.not_checked is not None]
    checked = len(outputs) - len(open_)
    if checked == 0 or checked < _LEAST_CHECKED * len(outputs):
        return QualityVerdict.UNCHECKED, _unchecked(outputs, open_)
    heard = [c.signal_to_noise_db for c in report.channels if c.signal_to_noise_db is not None]
    words = [f"signals stand {sorted(heard)[len(heard) // 2]:.0f} dB above noise"] if heard else []
    words.append(f"{checked} of {len(outputs)} sensors agree with the others")
    if report.condition.time_invariant:
        words.append("the condition held")
    text = f"Fit for estimation: {', '.join(words)}."
    if open_:
        text += f" Cannot be checked: {_some([c.name for c in open_])}."
    return _GOOD, text


def _unchecked(outputs: Sequence[ChannelQuality], left: Sequence[ChannelQuality]) -> str:
    """Why nothing can be concluded of a record."""
    if not outputs:
        return "Cannot be checked: no output was recorded."
    reasons = [c.not_checked or "" for c in left]
    reason = max(dict.fromkeys(reasons), key=reasons.count)
    some = "no sensor" if len(left) == len(outputs) else f"{len(outputs) - len(left)} sensors"
    return (
        f"Cannot be checked: {some} of {len(outputs)} could be checked against the others; "
        f"{reason}."
    )


def _joined(begin: str, findings: Sequence[QualityWarning]) -> str:
    shown = " ".join(finding.text for finding in findings[:2])
    more = len(findings) - 2
    return f"{begin}. {shown}" + (f" And {more} more." if more > 0 else "")


def _finding(
    severity: QualityVerdict, about: str, text: str, channel: str | None = None
) -> QualityWarning:
    return QualityWarning(severity=severity, about=about, channel=channel, text=text)


def _of_samples(channels: Sequence[ChannelQuality]) -> Iterator[QualityWarning]:
    for channel in channels:
        kinds = [stretch.kind for stretch in channel.stretches]
        if channel.saturated > 0.0:
            severity = _BAD if channel.saturated > _SATURATED else _DOUBTFUL
            text = f"{channel.name} is saturated for {channel.saturated:.2%} of its samples."
            yield _finding(severity, "saturation", text, channel.name)
        if spikes := kinds.count("spike"):
            text = f"{channel.name} has {_count(spikes, 'spike')}; a repair takes them out."
            yield _finding(_DOUBTFUL, "spikes", text, channel.name)
        if dropouts := kinds.count("dropout"):
            text = f"{channel.name} has {_count(dropouts, 'dropout')}, where one value is held."
            yield _finding(_BAD, "dropouts", text, channel.name)


def _of_signal(channels: Sequence[ChannelQuality]) -> Iterator[QualityWarning]:
    outputs = [c for c in channels if c.role == Role.OUTPUT and c.signal_to_noise_db is not None]
    if outputs:
        ratios = sorted(c.signal_to_noise_db or 0.0 for c in outputs)
        middle = ratios[len(ratios) // 2]
        if middle < _QUIET_DB[0]:
            severity = _BAD if middle < _QUIET_DB[1] else _DOUBTFUL
            text = f"Outputs stand only {middle:.0f} dB above their noise."
            yield _finding(severity, "signal", text)
        quiet = [c.name for c in outputs if (c.signal_to_noise_db or 0.0) < _HEARD_DB]
        if quiet and middle >= _QUIET_DB[1]:
            text = f"Little signal in {_some(quiet)}."
            yield _finding(_GOOD, "signal", text)
    for channel in channels:
        ratio = channel.signal_to_noise_db
        if channel.role == Role.INPUT and ratio is not None and ratio < _QUIET_DB[0]:
            severity = _BAD if ratio < _QUIET_DB[1] else _DOUBTFUL
            text = f"{channel.name} stands only {ratio:.0f} dB above its noise at its own lines."
            yield _finding(severity, "signal", text, channel.name)


def _of_redundancy(
    channels: Sequence[ChannelQuality], reference: str | None
) -> Iterator[QualityWarning]:
    for c in channels:
        if c.role == Role.OUTPUT and c.not_checked is not None:
            yield from _of_departure(c)
            continue
        heard = c.signal_to_noise_db is None or c.signal_to_noise_db > _HEARD_DB
        if c.coherence is not None and heard and c.coherence < _AGREES[0]:
            severity = _BAD if c.coherence < _AGREES[1] else _DOUBTFUL
            text = f"{c.name} agrees with the other sensors with a coherence of {c.coherence:.2f}."
            yield _finding(severity, "coherence", text, c.name)
        elif c.noise_excess is not None and c.noise_excess > _EXCESS:
            text = (
                f"{c.name} departs from the other sensors by {c.noise_excess:.0f} times its noise."
            )
            yield _finding(_DOUBTFUL, "coherence", text, c.name)
        least = _INPUT_SKEW_S if c.role == Role.INPUT else _SKEW_S
        if (
            _stands_out(c.delay_s, c.delay_std, least, _SKEW_SIGMAS)
            and (c.delay_std or 0.0) < _SURE_S
        ):
            text = (
                f"{c.name} is {1e3 * (c.delay_s or 0.0):+.1f} ± {1e3 * (c.delay_std or 0.0):.1f} ms"
                f" late on {reference}; a delay takes that out."
            )
            yield _finding(_DOUBTFUL, "skew", text, c.name)
        if c.scale is not None and c.scale < 0.0:
            text = (
                f"{c.name} has the opposite sign: turned, it agrees with the others. Turn it "
                "in the mapping, or by a calibration with scale factor -1."
            )
            yield _finding(_BAD, "sign", text, c.name)
        elif c.scale is not None and _stands_out(c.scale - 1.0, c.scale_std, _SCALE, _SKEW_SIGMAS):
            text = f"{c.name} reads {c.scale:.3f} ± {c.scale_std or 0.0:.3f} of what it should."
            yield _finding(_DOUBTFUL, "scale", text, c.name)
        if _stands_out(c.bias, c.bias_std, 0.0):
            text = f"{c.name} has a bias of {c.bias:.3g} ± {c.bias_std:.2g} {c.unit}."
            yield _finding(_GOOD, "bias", text, c.name)


def _of_departure(c: ChannelQuality) -> Iterator[QualityWarning]:
    """An output that disagrees with the others in a way that is no delay and no scale factor."""
    text = f"{c.name} cannot be checked: {c.not_checked}."
    if c.scale is not None and c.scale < 0.0:
        yield _finding(_BAD, "sign", text, c.name)
    elif c.noise_excess is not None and c.noise_excess > _EXCESS:
        yield _finding(_DOUBTFUL, "coherence", text, c.name)


def _of_inputs(report: QualityReport) -> Iterator[QualityWarning]:
    for pair in report.inputs:
        size = abs(pair.correlation)
        if size > _CORRELATED[0]:
            severity = _BAD if size > _CORRELATED[1] else _DOUBTFUL
            text = f"{pair.first} and {pair.second} correlate at {pair.correlation:.2f}."
            yield _finding(severity, "inputs", text)


def _of_condition(report: QualityReport) -> Iterator[QualityWarning]:
    condition = report.condition
    if condition.fuel_change is not None and condition.fuel_change > MOST_FUEL:
        text = f"{condition.fuel_change:.1%} of the fuel burnt: the structure changed meanwhile."
        yield _finding(_DOUBTFUL, "condition", text)
    drift = condition.airspeed_drift
    if drift is not None and drift > MOST_DRIFT:
        severity = _BAD if drift > 3.0 * MOST_DRIFT else _DOUBTFUL
        text = f"Airspeed drifted by {drift:.1%}: one linear model does not hold."
        yield _finding(severity, "condition", text)


def _of_record(maneuver: Maneuver, decay: tuple[str, float] | None) -> Iterator[QualityWarning]:
    excitation = maneuver.excitation
    if excitation is None:
        text = "Which harmonics the inputs were given is not known: FRE needs that."
        yield _finding(_GOOD, "record", text)
        return
    trim_s = excitation.start_s - maneuver.start_s
    if trim_s < _LEAST_TRIM_S:
        text = f"Only {max(trim_s, 0.0):.2g} s of trim lie before the excitation."
        yield _finding(_DOUBTFUL, "record", text)
    if decay is not None and decay[1] > _UNDECAYED:
        text = (
            f"{decay[0]} still moves with {decay[1]:.0%} of its motion when the record ends: "
            "the transform of one period needs the decay."
        )
        yield _finding(_DOUBTFUL, "record", text)


def _stands_out(
    value: float | None, std: float | None, least: float, sigmas: float = _SIGMAS
) -> bool:
    return value is not None and std is not None and abs(value) > max(least, sigmas * std)


def _count(number: int, what: str) -> str:
    return f"{number} {what}" if number == 1 else f"{number} {what}s"


def _some(names: Sequence[str], most: int = 6) -> str:
    listed = ", ".join(names[:most])
    return listed if len(names) <= most else f"{listed} and {len(names) - most} more"
