"""The ``[[channels]]``, ``[excitation]``, ``[flight]`` and ``[maneuver]`` parts of a mapping."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from flexsid import units
from flexsid.errors import BadInput
from flexsid.importers.clock import Clock, Timing
from flexsid.importers.mapping import (
    ChannelMapping,
    ExcitationMapping,
    FtaMapping,
    ManeuverMapping,
    MappingFile,
    OrderMapping,
    OtherSideMapping,
)
from flexsid.importers.quantity import Quantity, may_be_pulse_widths, scalar
from flexsid.importers.source import SourceFile, Sources, refuse_field
from flexsid.importers.table import refuse
from flexsid.records.maneuver import Cut, Excitation, Role
from flexsid.sysid.preparation.resampling import BetweenSamples
from flexsid.text import check_line, one_line

# --- The ``[[channels]]`` part of a mapping: names, units, roles and signs ------------------------


@dataclass(frozen=True, slots=True, kw_only=True)
class RawChannel:
    """One channel as recorded, with its name, role and time base."""

    name: str
    unit: str
    role: Role
    samples: np.ndarray
    clock: Clock
    field: str
    source: SourceFile
    rule: str = ""
    """The table of the mapping that defines it, such as ``channels[2]``."""

    sensor: str | None = None
    between_samples: BetweenSamples | None = None
    confirmed: tuple[str, ...] = ()

    def cut(self, start_s: float | None, stop_s: float | None) -> RawChannel:
        """Return the samples from start to stop."""
        window = self.clock.window(start_s, stop_s)
        n_samples = max(0, window.stop - window.start)
        clock = replace(
            self.clock,
            start_s=self.clock.start_s + window.start / self.clock.rate_hz,
            n_samples=n_samples,
        )
        return replace(self, samples=self.samples[window], clock=clock)


_SURFACE_ROLES = (Role.INPUT, Role.COMMAND)
_OF_SURFACES = ("angle", "time")
"""Dimensions of deflections, and of the pulse widths that stand for them in logs."""


def extract_channels(
    rules: tuple[ChannelMapping, ...], sources: Sources, timing: Timing
) -> tuple[RawChannel, ...]:
    """Extract the recorded columns, with their names, time bases and checked samples.

    Returns
    -------
    channels
        In the order of the mapping, in native unit, rate and precision.

    Raises
    ------
    BadInput
        If a column is missing, a name is repeated, a channel is longer than its
        time or a sample is not finite; the message names the location.
    """
    channels: dict[str, RawChannel] = {}
    for rule in rules:
        for label, samples, source in _extract_columns(rule, sources):
            channel = _make_channel(rule, label, samples, source, sources, timing)
            if channel.name in channels:
                raise BadInput(
                    f"The mapping names two channels '{channel.name}'; names must be unique.",
                    code="duplicate-channel",
                    column=channel.name,
                )
            channels[channel.name] = channel
    return tuple(channels.values())


def _extract_columns(
    rule: ChannelMapping, sources: Sources
) -> Iterator[tuple[str, np.ndarray, SourceFile]]:
    """Yield the columns of a rule with their names in the file."""
    if rule.labels is None:
        field = str(rule.column) if rule.array is None else f"{rule.array}({rule.column})"
        source, _ = sources.find(field)
        samples = np.atleast_1d(sources.numbers(field))
        if samples.ndim != 1:
            problem = f"has shape {samples.shape}; select one column with array and column."
            raise refuse_field(field, problem, "bad-mapping")
        yield field, samples, source
        return
    array = str(rule.array)
    source, _ = sources.find(array)
    matrix = sources.numbers(array)
    matrix = matrix[:, None] if matrix.ndim == 1 else matrix
    if matrix.ndim != 2:
        problem = f"has shape {matrix.shape}; rows of samples and columns of channels are expected."
        raise refuse_field(array, problem, "bad-mapping")
    labels = sources.texts(rule.labels) if isinstance(rule.labels, str) else rule.labels
    if len(labels) != matrix.shape[1]:
        problem = f"has {matrix.shape[1]} columns but {len(labels)} labels."
        raise refuse_field(array, problem, "unequal-lengths")
    for label, samples in zip(labels, matrix.T, strict=True):
        yield label, samples, source


def _make_channel(
    rule: ChannelMapping,
    label: str,
    samples: np.ndarray,
    source: SourceFile,
    sources: Sources,
    timing: Timing,
) -> RawChannel:
    clock = timing.clock(source, str(rule.array or label), label, samples.size, rule.clock)
    unit = rule.find_unit(label)
    known = units.lookup(unit)
    samples, part = clock.select(samples), source.skip_rows(clock.first_row)
    part.check_finite(samples, label, units.LARGEST[known.dimension] / known.factor)
    name = rule.template.replace("{label}", label) if rule.labels is not None else rule.template
    try:
        name = check_line(name)
    except ValueError as error:
        raise BadInput(
            f"{source.name}: the name of channel '{one_line(name)[:40]}' {error}.",
            code="bad-text",
            column=one_line(name)[:40],
        ) from error
    samples = _calibrate(rule, unit, clock.interpolate(samples), name, part)
    if samples.dtype.kind != "f":
        samples = samples.astype(np.float64)
    samples = samples if rule.sign > 0 else -samples
    if rule.other_side is not None:
        samples = _average_sides(rule, rule.other_side, unit, samples, sources, timing)
    return RawChannel(
        name=name,
        unit=unit,
        role=rule.role,
        samples=np.ascontiguousarray(samples),
        clock=clock,
        field=label,
        source=source,
        rule=rule.path(""),
        sensor=rule.sensor,
        between_samples=rule.between_samples,
        confirmed=rule.confirmed,
    )


def _average_sides(
    rule: ChannelMapping,
    side: OtherSideMapping,
    unit: str,
    samples: np.ndarray,
    sources: Sources,
    timing: Timing,
) -> np.ndarray:
    """Return the mean of a deflection and that of the other side, in the unit of the first."""
    own_rule = rule.model_copy(
        update={"column": side.column, "unit": side.unit, "sign": side.sign, "other_side": None}
    )
    (other,) = extract_channels((own_rule,), sources, timing)
    if other.samples.size != samples.size:
        raise refuse(
            rule.path("other_side"),
            f"has {other.samples.size} samples and '{rule.column}' {samples.size}; both sides "
            "need one clock.",
        )
    known, own = units.lookup(unit), units.lookup(side.unit)
    if own.dimension != known.dimension:
        raise refuse(
            rule.path("other_side.unit"),
            f"is '{side.unit}', which cannot be converted to '{unit}'.",
        )
    converted = (units.to_si(other.samples, side.unit) - known.offset) / known.factor
    return 0.5 * (samples + converted)


def _calibrate(
    rule: ChannelMapping, unit: str, samples: np.ndarray, name: str, source: SourceFile
) -> np.ndarray:
    """Convert recorded numbers by the calibration of a channel, between its points only."""
    if rule.calibration is None:
        is_deflection = units.dimension(unit) in _OF_SURFACES and rule.role in _SURFACE_ROLES
        if is_deflection and may_be_pulse_widths(samples):
            raise BadInput(
                f"Channel '{name}' has pulse widths ({samples.min():.0f} to {samples.max():.0f} us)"
                f" and no deflections; write in {rule.path('')} the unit of its deflection, and "
                "calibration = [[1000, -25], [1500, 0], [2000, 25]], each a pulse width and the "
                "deflection there.",
                code="needs-calibration",
                key=rule.path("calibration"),
                column=name,
            )
        return samples
    recorded, values = np.array(rule.calibration).T
    outside = np.flatnonzero((samples < recorded[0]) | (samples > recorded[-1]))
    if outside.size:
        row = source.first_row + int(outside[0])
        raise BadInput(
            f"{source.name}: row {row} of channel '{name}' holds {samples[outside[0]]:g}; its "
            f"calibration has {recorded[0]:g} to {recorded[-1]:g}.",
            code="outside-calibration",
            row=row,
            column=name,
        )
    return np.interp(samples, recorded, values)


# --- The ``[excitation]`` part of a mapping: the harmonics of each input --------------------------

_MAX_HARMONICS = 10_000


def extract_excitation(
    part: ExcitationMapping, sources: Sources, inputs: Sequence[str]
) -> Excitation:
    """Return the harmonics of every input.

    Raises
    ------
    BadInput
        If a harmonic is assigned to a channel that is no input, or to two inputs.
    """
    harmonics = _interleave(part, sources) if part.harmonics is None else part.harmonics
    assigned: dict[int, str] = {}
    for name, numbers in harmonics.items():
        if name not in inputs:
            raise refuse(
                "excitation",
                f"excites '{name}', which is not an input; inputs: {', '.join(inputs)}.",
            )
        for number in numbers:
            if number < 1:
                raise refuse(
                    "excitation", f"assigns harmonic {number} to {name}; expected 1 or more."
                )
            if number in assigned:
                both = f"{assigned[number]} and {name}"
                raise refuse(
                    "excitation", f"assigns harmonic {number} to {both}; expected one input."
                )
            assigned[number] = name
    period_s = scalar(part.period, sources)
    if period_s <= 0 or part.n_periods < 1:
        raise refuse("excitation.period", "and n_periods must be positive.")
    return Excitation(
        period_s=period_s, harmonics=harmonics, start_s=part.start_s, n_periods=part.n_periods
    )


def _interleave(part: ExcitationMapping, sources: Sources) -> dict[str, tuple[int, ...]]:
    assert part.order is not None
    assert part.first is not None
    assert part.per_input is not None
    if isinstance(part.order, OrderMapping):
        labels = sources.texts(part.order.field)
        names = tuple(part.order.name.replace("{label}", label) for label in labels)
    else:
        names = part.order
    first = round(scalar(part.first, sources))
    count = round(scalar(part.per_input, sources))
    stride = 1 if part.stride is None else round(scalar(part.stride, sources))
    if not names or min(first, stride) < 1 or not 1 <= count * len(names) <= _MAX_HARMONICS:
        problem = "per_input and stride must be at least 1, with order not empty."
        raise refuse("excitation.first", problem)
    step = stride * len(names)
    return {
        name: tuple(range(first + stride * index, first + stride * index + step * count, step))
        for index, name in enumerate(names)
    }


# --- The ``[flight]`` and ``[maneuver]`` parts of a mapping ---------------------------------------

_KEPT = ("airspeed", "fuel_fraction")  # of the condition: their change over a maneuver is checked


@dataclass(frozen=True, slots=True, kw_only=True)
class RawManeuver:
    """A maneuver extracted from its files, before anything is completed or computed.

    ``cut`` is the common time of its channels; its ``axis`` is None where the mapping does not give
    it.
    """

    cut: Cut
    channels: tuple[RawChannel, ...]
    condition: Mapping[str, float]
    excitation: Excitation | None
    source_file: str
    source_hash: str


def extract_recording(mapping: MappingFile, sources: Sources) -> tuple[RawChannel, ...]:
    """Extract the channels of the files, at full length.

    Raises
    ------
    BadInput
        If anything is missing or invalid; the message names the key of the
        mapping, or row and column of the file.
    """
    return extract_channels(
        mapping.channels, sources, Timing(mapping.time, mapping.clocks, sources)
    )


def extract_maneuver(part: ManeuverMapping, mapping: MappingFile, sources: Sources) -> RawManeuver:
    """Extract one maneuver from its files.

    Raises
    ------
    BadInput
        If anything is missing or invalid; the message names the key of the
        mapping, or row and column of the file.
    """
    timing = Timing(mapping.time, mapping.clocks, sources, part.window_s)
    channels = extract_channels(mapping.channels, sources, timing)
    inputs = [channel.name for channel in channels if channel.role is Role.INPUT]
    if not inputs:
        raise BadInput(
            "The mapping gives no channel the role 'input'; a maneuver has at least one measured "
            "surface.",
            code="bad-mapping",
        )
    cut = tuple(channel.cut(*part.window_s) for channel in channels)
    for before, channel in zip(channels, cut, strict=True):
        if channel.samples.size < 2:
            raise BadInput(
                f"Mapping: 'maneuver.start' and 'maneuver.stop' leave {channel.samples.size} "
                f"samples of '{channel.name}', recorded from {before.clock.start_s:g} to "
                f"{before.clock.stop_s:g} s.",
                code="bad-mapping",
                key="maneuver.start",
            )
    start_s = max(channel.clock.start_s for channel in cut)
    stop_s = min(channel.clock.stop_s for channel in cut)
    if stop_s <= start_s:
        raise BadInput(
            "The channels have no common time; set an offset between clocks in [time] or "
            "[[clocks]].",
            code="no-common-time",
        )
    source_file, source_hash = origin(channels)
    return RawManeuver(
        cut=part.build_cut(
            start_s,
            stop_s,
            _label(part.label, Path(channels[0].source.name).stem),
            _fta(part, sources),
        ),
        channels=(*cut, *_keep_condition(part, channels, sources, timing)),
        condition={
            key: _average(item, sources, timing, part) for key, item in part.condition.items()
        },
        excitation=None
        if mapping.excitation is None
        else extract_excitation(mapping.excitation, sources, inputs),
        source_file=source_file,
        source_hash=source_hash,
    )


def _keep_condition(
    part: ManeuverMapping, channels: tuple[RawChannel, ...], sources: Sources, timing: Timing
) -> list[RawChannel]:
    """Extract recorded airspeed and fuel of the condition, which is their average, as channels.

    None of a name or column that the mapping gives a channel already.
    """
    known = {channel.name for channel in channels} | {channel.field for channel in channels}
    kept = []
    for name in _KEPT:
        quantity = part.condition.get(name)
        if quantity is None or quantity.field is None or known & {name, quantity.field}:
            continue
        if (values := sources.numbers(quantity.field)).size == 1 or values.ndim != 1:
            continue
        rule = ChannelMapping(
            column=quantity.field,
            name=name,
            unit=quantity.unit,
            role=Role.CONDITION,
            confirmed=("too-large", "too-small"),  # the average is checked
        )
        (channel,) = extract_channels((rule,), sources, timing)
        channel = channel.cut(*part.window_s)
        if channel.samples.size > 1:
            kept.append(channel)
    return kept


def _label(template: str, file: str) -> str:
    try:
        return check_line(template.replace("{file}", file))
    except ValueError as error:
        raise BadInput(
            f"Mapping: 'maneuver.label' {error}.", code="bad-text", key="maneuver.label"
        ) from error


def origin(channels: tuple[RawChannel, ...]) -> tuple[str, str]:
    """Return the names of the files of the channels, and one hash of all files."""
    used: dict[str, str] = {}
    for channel in channels:
        used.setdefault(channel.source.sha256, channel.source.name)
    digests = list(used)
    joined = hashlib.sha256("".join(digests).encode()).hexdigest()
    return ", ".join(used.values()), digests[0] if len(digests) == 1 else joined


def _average(quantity: Quantity, sources: Sources, timing: Timing, part: ManeuverMapping) -> float:
    """Return one number in SI; a recorded channel is averaged over the maneuver."""
    if quantity.field is None or (values := sources.numbers(quantity.field)).size == 1:
        return scalar(quantity, sources)
    source, _ = sources.find(quantity.field)
    values = values.reshape(-1)
    clock = timing.clock(source, quantity.field, quantity.field, values.size, None)
    values, source = clock.select(values), source.skip_rows(clock.first_row)
    if clock.stamps is not None:
        source.check_finite(values, quantity.field)
    samples = clock.interpolate(values)[clock.window(*part.window_s)]
    if samples.size == 0:
        raise refuse(quantity.given, f"has no sample of '{quantity.field}' inside the maneuver.")
    source.check_finite(samples, quantity.field)
    mean = float(units.to_si(samples.mean(dtype=np.float64), quantity.unit))
    return units.check_size(mean, units.dimension(quantity.unit))


def _fta(part: ManeuverMapping, sources: Sources) -> int | None:
    if isinstance(part.fta, FtaMapping):
        return part.fta.values.get(sources.scalar(part.fta.field))
    return part.fta
