"""The ``[[channels]]`` part of a mapping: names, units, roles and signs."""

from __future__ import annotations

from dataclasses import dataclass, replace
from fnmatch import fnmatchcase

import numpy as np

from flexsid import units
from flexsid.errors import BadInput
from flexsid.importers.clock import Clock, Timing
from flexsid.importers.plausibility import UNIT_WARNINGS
from flexsid.importers.quantity import refuse
from flexsid.importers.source import SourceFile, Sources
from flexsid.importers.table import MappingTable
from flexsid.records.maneuver import Role
from flexsid.text import check_line, one_line


@dataclass(frozen=True, slots=True, kw_only=True)
class ChannelRule:
    """One channel, or the columns of one array.

    ``column`` alone is a field of the file; with ``array`` it is a column
    number from 1. ``labels`` names all columns of ``array`` (a field of the
    file, or a list); then ``unit`` may hold one unit per label or pattern and
    ``name`` is a template with ``{label}``. ``sensor`` is the sensor that measured it, ``clock``
    one of ``[[clocks]]``; ``confirmed`` holds the codes of the unit warnings that an analyst
    has confirmed.
    """

    path: str
    table: str
    role: Role
    name: str
    units: tuple[tuple[str, str], ...]
    column: str | int | None = None
    array: str | None = None
    labels: str | tuple[str, ...] | None = None
    sign: float = 1.0
    sensor: str | None = None
    clock: str | None = None
    confirmed: tuple[str, ...] = ()


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


def read_channel(table: MappingTable) -> ChannelRule:
    """Read one ``[[channels]]`` entry."""
    array = table.optional_text("array")
    labels: str | tuple[str, ...] | None = None
    column: str | int | None = None
    if "labels" in table:
        labels = (
            table.optional_text("labels") if _is_text(table, "labels") else table.texts("labels")
        )
    elif array is not None:
        column = table.integer("column")
        if column < 1:
            raise refuse(table.path("column"), "counts from 1.")
    else:
        column = table.text("column")
    if labels is not None and array is None:
        raise refuse(table.path("array"), "is missing; labels name the columns of an array.")
    fallback = "{label}" if labels is not None else str(column)
    sign = table.number("sign", 1.0)
    if abs(sign) != 1.0:
        raise refuse(table.path("sign"), "must be 1 or -1; a scale factor belongs in the unit.")
    rule = ChannelRule(
        path=table.path("unit"),
        table=table.path("unit").removesuffix(".unit"),
        role=Role(table.choice("role", tuple(role.value for role in Role))),
        name=table.label("name", fallback),
        units=_units(table),
        column=column,
        array=array,
        labels=labels,
        sign=sign,
        sensor=table.optional_text("sensor"),
        clock=table.optional_text("clock"),
        confirmed=table.texts("confirmed") if "confirmed" in table else (),
    )
    for code in rule.confirmed:
        if code not in UNIT_WARNINGS:
            allowed = ", ".join(UNIT_WARNINGS)
            raise refuse(table.path("confirmed"), f"may hold {allowed}; found '{code}'.")
    table.close()
    return rule


def _is_text(table: MappingTable, key: str) -> bool:
    try:
        table.text(key)
    except BadInput:
        return False
    return True


def _units(table: MappingTable) -> tuple[tuple[str, str], ...]:
    if table.is_table("unit"):
        rows = table.table("unit")
        pairs = tuple((pattern, rows.text(pattern)) for pattern in rows.names())
    else:
        pairs = (("*", table.text("unit")),)
    for _, unit in pairs:
        try:
            units.lookup(unit)
        except BadInput as error:
            raise BadInput(
                f"Mapping: '{table.path('unit')}': {error.message}",
                code=error.code,
                key=table.path("unit"),
                **error.context,
            ) from error
    return pairs


def extract_channels(
    rules: tuple[ChannelRule, ...], sources: Sources, timing: Timing
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
    channels: list[RawChannel] = []
    seen: set[str] = set()
    for channel in (found for rule in rules for found in _extract(rule, sources, timing)):
        if channel.name in seen:
            raise BadInput(
                f"The mapping names two channels '{channel.name}'; names must be unique.",
                code="duplicate-channel",
                column=channel.name,
            )
        seen.add(channel.name)
        channels.append(channel)
    return tuple(channels)


def _extract(rule: ChannelRule, sources: Sources, timing: Timing) -> list[RawChannel]:
    if rule.array is None:
        field = str(rule.column)
        source, _ = sources.find(field)
        samples = np.atleast_1d(sources.numbers(field))
        if samples.ndim != 1:
            raise BadInput(
                f"Field '{field}' has shape {samples.shape}; select one with array and column.",
                code="bad-mapping",
                column=field,
            )
        return [_channel(rule, rule.name, field, samples, source, timing)]
    source, _ = sources.find(rule.array)
    matrix = sources.numbers(rule.array)
    matrix = matrix[:, None] if matrix.ndim == 1 else matrix
    if matrix.ndim != 2:
        raise BadInput(
            f"Array '{rule.array}' has shape {matrix.shape}; rows of samples and columns of "
            "channels are expected.",
            code="bad-mapping",
            column=rule.array,
        )
    if isinstance(rule.column, int):
        if rule.column > matrix.shape[1]:
            raise BadInput(
                f"Array '{rule.array}' has {matrix.shape[1]} columns, the mapping selects column "
                f"{rule.column}.",
                code="missing-column",
                column=f"{rule.array}({rule.column})",
            )
        label = f"{rule.array}({rule.column})"
        return [_channel(rule, rule.name, label, matrix[:, rule.column - 1], source, timing)]
    labels = sources.texts(rule.labels) if isinstance(rule.labels, str) else rule.labels or ()
    if len(labels) != matrix.shape[1]:
        raise BadInput(
            f"Array '{rule.array}' has {matrix.shape[1]} columns but {len(labels)} labels.",
            code="unequal-lengths",
            column=rule.array,
        )
    return [
        _channel(rule, rule.name.replace("{label}", label), label, matrix[:, index], source, timing)
        for index, label in enumerate(labels)
    ]


def largest_sample(unit: str) -> float:
    """Return the largest physically possible sample in its own unit."""
    known = units.lookup(unit)
    return units.LARGEST[known.dimension] / known.factor


def _channel(
    rule: ChannelRule,
    name: str,
    label: str,
    samples: np.ndarray,
    source: SourceFile,
    timing: Timing,
) -> RawChannel:
    clock = timing.clock(source, str(rule.array or label), label, samples.size, rule.clock)
    unit = next((unit for pattern, unit in rule.units if fnmatchcase(label, pattern)), None)
    if unit is None:
        raise refuse(rule.path, f"gives no unit for '{label[:80]}'.")
    source.check_finite(samples, label, largest_sample(unit))
    try:
        name = check_line(name)
    except ValueError as error:
        raise BadInput(
            f"{source.name}: the name of channel '{one_line(name)[:40]}' {error}.",
            code="bad-text",
            column=one_line(name)[:40],
        ) from error
    if samples.dtype.kind != "f":
        samples = samples.astype(np.float64)
    return RawChannel(
        name=name,
        unit=unit,
        role=rule.role,
        samples=np.ascontiguousarray(samples if rule.sign > 0 else -samples),
        clock=clock,
        field=label,
        source=source,
        rule=rule.table,
        sensor=rule.sensor,
        confirmed=rule.confirmed,
    )
