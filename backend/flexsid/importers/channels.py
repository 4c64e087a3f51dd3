"""The ``[[channels]]`` part of a mapping: names, units, roles and signs."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from flexsid import units
from flexsid.errors import BadInput
from flexsid.importers.clock import Clock, Timing
from flexsid.importers.mapping import ChannelMapping
from flexsid.importers.source import SourceFile, Sources, refuse_field
from flexsid.records.maneuver import Role
from flexsid.text import check_line, one_line


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
            channel = _make_channel(rule, label, samples, source, timing)
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
    rule: ChannelMapping, label: str, samples: np.ndarray, source: SourceFile, timing: Timing
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
    samples = clock.interpolate(samples)
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
        rule=rule.path(""),
        sensor=rule.sensor,
        confirmed=rule.confirmed,
    )
