"""The ``[flight]`` and ``[maneuver]`` parts of a mapping."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import date
from pathlib import Path

import numpy as np

from flexsid import units
from flexsid.errors import BadInput
from flexsid.importers.channels import ChannelRule, RawChannel, extract_channels
from flexsid.importers.clock import TimeRule, Timing
from flexsid.importers.excitation import ExcitationPart, extract_excitation, read_excitation
from flexsid.importers.quantity import MappedQuantity, refuse, scalar
from flexsid.importers.source import Sources
from flexsid.importers.table import MappingTable
from flexsid.records.maneuver import Excitation, Role
from flexsid.text import check_line

_CONDITION = {
    "airspeed": "speed",
    "density": "density",
    "altitude": "length",
    "fuel_fraction": "number",
    "alpha": "angle",
    "gamma": "angle",
    "thrust": "force",
    "mass": "mass",
    "pitch_inertia": "inertia",
    "x_cg": "length",
    "z_cg": "length",
    "total_temperature": "temperature",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class FlightPart:
    """The flight of the maneuver."""

    number: int
    flown_on: date | None = None
    description: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class ManeuverPart:
    """Name, time and flight condition of a maneuver."""

    label: str
    condition: Mapping[str, MappedQuantity]
    excitation: ExcitationPart | None = None
    fta: int | None = None
    fta_field: str | None = None
    fta_by_value: tuple[tuple[float, int], ...] = ()
    axis: str | None = None
    start_s: float | None = None
    stop_s: float | None = None
    note: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordingPart:
    """Channels of the files and their time bases."""

    time: TimeRule | None
    clocks: Mapping[str, TimeRule]
    channels: tuple[ChannelRule, ...]


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


def read_flight(table: MappingTable) -> FlightPart:
    """Read ``number``, ``date`` and ``description``."""
    day = table.optional_text("date")
    try:
        flown_on = None if day is None else date.fromisoformat(day)
    except ValueError as error:
        raise refuse(
            table.path("date"), f"must have the form 2024-05-31, found '{day}'."
        ) from error
    part = FlightPart(
        number=table.integer("number"),
        flown_on=flown_on,
        description=table.note("description"),
    )
    table.close()
    return part


def read_maneuver(table: MappingTable, excitation: MappingTable | None) -> ManeuverPart:
    """Read the maneuver's own keys and its ``condition``."""
    condition = table.table("condition")
    quantities = {
        key: quantity
        for key, dimension in _CONDITION.items()
        if (quantity := condition.optional_quantity(key, dimension)) is not None
    }
    if "engines" in condition:  # rotation speeds by channel of the thrust table
        engines = condition.table("engines")
        quantities |= {name: engines.quantity(name, "angular rate") for name in engines.names()}
    condition.close()
    if "airspeed" not in quantities:
        raise refuse(condition.path("airspeed"), "is missing; expected the true airspeed.")
    if ("density" in quantities) == ("altitude" in quantities):
        raise refuse(condition.path("density"), "or altitude must be given, but not both.")
    fta: int | None = None
    fta_field: str | None = None
    by_value: tuple[tuple[float, int], ...] = ()
    if table.is_table("fta"):
        rows = table.table("fta")
        fta_field = rows.text("field")
        lookup = rows.table("values")
        by_value = tuple((_number(lookup, key), lookup.integer(key)) for key in lookup.names())
        rows.close()
    elif "fta" in table:
        fta = table.integer("fta")
    part = ManeuverPart(
        label=table.label("label", "{file}"),
        condition=quantities,
        excitation=None if excitation is None else read_excitation(excitation),
        fta=fta,
        fta_field=fta_field,
        fta_by_value=by_value,
        axis=table.choice("axis", ("longitudinal", "lateral", "ground"))
        if "axis" in table
        else None,
        start_s=table.si_scalar("start", "time") if "start" in table else None,
        stop_s=table.si_scalar("stop", "time") if "stop" in table else None,
        note=table.note("note"),
    )
    table.close()
    return part


def _number(table: MappingTable, key: str) -> float:
    try:
        return float(key)
    except ValueError as error:
        raise refuse(table.path(key), "must be a number: a value of the field.") from error


def extract_recording(part: RecordingPart, sources: Sources) -> tuple[RawChannel, ...]:
    """Extract the channels of the files, at full length.

    Raises
    ------
    BadInput
        If anything is missing or invalid; the message names the key of the
        mapping, or row and column of the file.
    """
    return extract_channels(part.channels, sources, Timing(part.time, part.clocks, sources))


def extract_maneuver(part: ManeuverPart, recording: RecordingPart, sources: Sources) -> RawManeuver:
    """Extract one maneuver from its files.

    Raises
    ------
    BadInput
        If anything is missing or invalid; the message names the key of the
        mapping, or row and column of the file.
    """
    timing = Timing(recording.time, recording.clocks, sources)
    channels = extract_channels(recording.channels, sources, timing)
    if not any(channel.role is Role.INPUT for channel in channels):
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
        channels=cut,
        condition={
            key: _average(item, sources, timing, part) for key, item in part.condition.items()
        },
        excitation=_excitation(part.excitation, sources, cut),
        source_file=source_file,
        source_hash=source_hash,
    )


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


def _average(
    quantity: MappedQuantity, sources: Sources, timing: Timing, part: ManeuverPart
) -> float:
    """Return one number in SI; a recorded channel is averaged over the maneuver."""
    if quantity.field is None or (values := sources.numbers(quantity.field)).size == 1:
        return scalar(quantity, sources)
    source, _ = sources.find(quantity.field)
    values = values.reshape(-1)
    clock = timing.clock(source, quantity.field, quantity.field, values.size, None)
    samples = values[clock.window(part.start_s, part.stop_s)]
    if samples.size == 0:
        raise refuse(quantity.path, f"has no sample of '{quantity.field}' inside the maneuver.")
    source.check_finite(samples, quantity.field)
    mean = float(units.to_si(samples.mean(dtype=np.float64), quantity.unit))
    return units.check_size(mean, units.dimension(quantity.unit))


def _fta(part: ManeuverPart, sources: Sources) -> int | None:
    if part.fta_field is None:
        return part.fta
    return dict(part.fta_by_value).get(sources.scalar(part.fta_field))


def _excitation(
    part: ExcitationPart | None, sources: Sources, channels: tuple[RawChannel, ...]
) -> Excitation | None:
    if part is None:
        return None
    inputs = [channel.name for channel in channels if channel.role is Role.INPUT]
    return extract_excitation(part, sources, inputs)
