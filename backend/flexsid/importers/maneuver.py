"""The ``[flight]`` and ``[maneuver]`` parts of a mapping."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from flexsid import units
from flexsid.errors import BadInput
from flexsid.importers.channels import RawChannel, extract_channels
from flexsid.importers.clock import Timing
from flexsid.importers.excitation import extract_excitation
from flexsid.importers.mapping import ChannelMapping, FtaMapping, ManeuverMapping, MappingFile
from flexsid.importers.quantity import Quantity, scalar
from flexsid.importers.source import Sources
from flexsid.importers.table import refuse
from flexsid.records.maneuver import Excitation, Role
from flexsid.text import check_line

_KEPT = ("airspeed", "fuel_fraction")  # of the condition: their change over a maneuver is checked


@dataclass(frozen=True, slots=True, kw_only=True)
class RawManeuver:
    """A maneuver extracted from its files, before anything is completed or computed.

    ``axis`` is None where the mapping does not give it.
    """

    label: str
    fta: int | None
    axis: str | None
    note: str
    start_s: float
    duration_s: float
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
    timing = Timing(mapping.time, mapping.clocks, sources, (part.start_s, part.stop_s))
    channels = extract_channels(mapping.channels, sources, timing)
    inputs = [channel.name for channel in channels if channel.role is Role.INPUT]
    if not inputs:
        raise BadInput(
            "The mapping gives no channel the role 'input'; a maneuver has at least one measured "
            "surface.",
            code="bad-mapping",
        )
    cut = tuple(channel.cut(part.start_s, part.stop_s) for channel in channels)
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
        label=_label(part.label, Path(channels[0].source.name).stem),
        fta=_fta(part, sources),
        axis=part.axis,
        note=part.note,
        start_s=start_s,
        duration_s=stop_s - start_s,
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
        channel = channel.cut(part.start_s, part.stop_s)
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
    samples = clock.interpolate(values)[clock.window(part.start_s, part.stop_s)]
    if samples.size == 0:
        raise refuse(quantity.given, f"has no sample of '{quantity.field}' inside the maneuver.")
    source.check_finite(samples, quantity.field)
    mean = float(units.to_si(samples.mean(dtype=np.float64), quantity.unit))
    return units.check_size(mean, units.dimension(quantity.unit))


def _fta(part: ManeuverMapping, sources: Sources) -> int | None:
    if isinstance(part.fta, FtaMapping):
        return part.fta.values.get(sources.scalar(part.fta.field))
    return part.fta
