"""Files with their mapping: channels, confirmed and remembered columns."""

from __future__ import annotations

import tomllib
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from datetime import UTC, datetime
from enum import StrEnum
from typing import Any

import numpy as np
import sqlalchemy as sa

from flexsid import units
from flexsid.errors import BadInput
from flexsid.importers import mapping as mappings
from flexsid.importers.clock import UNUSUAL_RATE, USUAL_RATES_HZ, Clock
from flexsid.importers.column_names import Meaning
from flexsid.importers.maneuver import RawChannel, RawManeuver, extract_maneuver, extract_recording
from flexsid.importers.repairs import repair_sources
from flexsid.importers.source import Sources
from flexsid.importers.table import Guessed
from flexsid.records.aircraft import Aircraft
from flexsid.records.maneuver import Role
from flexsid.records.run import RunState
from flexsid.storage.arrays import ArrayRow
from flexsid.storage.store import Store
from flexsid.storage.tables import jobs
from flexsid.text import join_names

# --- Files with their mapping: channels, and values that nobody confirmed -------------------------


@dataclass(frozen=True, slots=True)
class ParsedUpload:
    """Files with their mapping, before storage.

    Channels are extracted from the files and checked; those of a whole flight belong to no
    maneuver. ``repairs`` name what was changed in the record, as the mapping allows.
    """

    sources: Sources
    mapping: mappings.MappingFile
    channels: tuple[RawChannel, ...] = ()
    maneuver: RawManeuver | None = None
    rows: Mapping[str, ArrayRow] = field(default_factory=dict)
    repairs: tuple[str, ...] = ()

    @property
    def builtin(self) -> str | None:
        """Name of the built-in aircraft that this upload needs."""
        part = self.mapping.aircraft
        return part.name if part is not None and part.builtin else None


def parse_upload(sources: Sources, mapping: mappings.MappingFile) -> ParsedUpload:
    """Extract the channels of files with a mapping.

    Raises
    ------
    BadInput
        If the files do not match the mapping.
    """
    if not mapping.channels:
        return ParsedUpload(sources, mapping)
    raw = None
    sources, repairs = repair_sources(mapping, sources)
    if mapping.maneuver is None:
        channels = extract_recording(mapping, sources)
    else:
        raw = extract_maneuver(mapping.maneuver, mapping, sources)
        raw = replace(raw, cut=replace(raw.cut, note=add_repairs(raw.cut.note, repairs)))
        channels = raw.channels
    _check_rates(channels)
    return ParsedUpload(sources, mapping, channels, raw, repairs=repairs)


def add_repairs(note: str, repairs: Sequence[str]) -> str:
    """Return the note of a record with what its import changed in it."""
    lines = [f"{_REPAIRED}{text}" for text in repairs[:_MOST_REPAIRS]]
    if len(repairs) > _MOST_REPAIRS:
        lines.append(f"{_REPAIRED}{len(repairs) - _MOST_REPAIRS} further places.")
    return "\n".join([*([note] if note else []), *lines])


def list_repairs(note: str) -> tuple[str, ...]:
    """Return what ``add_repairs`` has written to the note of a record."""
    lines = [line for line in note.splitlines() if line.startswith(_REPAIRED)]
    return tuple(line.removeprefix(_REPAIRED) for line in lines)


def _check_rates(channels: Sequence[RawChannel]) -> None:
    """Check that sampling rates are usual; otherwise time may be in another unit."""
    low, high = USUAL_RATES_HZ
    for channel in channels:
        clock = channel.clock
        moving = channel.role in (Role.INPUT, Role.OUTPUT)
        if moving and not low <= clock.rate_hz <= high and UNUSUAL_RATE not in clock.confirmed:
            raise BadInput(
                f"Channel '{channel.name}' has {clock.rate_hz:.4g} samples per second; {low:g} to "
                f"{high:g} are usual. Check the unit of time; if it is right, write "
                f'confirmed = ["{UNUSUAL_RATE}"] in [time].',
                code="unusual-rate",
                column=channel.name,
            )


_EARLIEST_DATE_S, _LATEST_DATE_S = 3.1e8, 4.1e9  # 1979 to 2099, in seconds since 1970
_REPAIRED = "Repaired: "
_MOST_REPAIRS = 50  # named in the note of a record
_SHOWN: dict[str, tuple[str, ...]] = {
    "angle": ("deg", "rad"),
    "angular rate": ("deg/s", "rad/s"),
    "acceleration": ("g", "m/s2", "ft/s2"),
    "speed": ("m/s", "kt", "ft/s"),
    "length": ("m", "ft"),
    "density": ("kg/m3", "slug/ft3"),
    "strain": ("ustrain", "strain"),
}
"""Units that recorders use for a dimension; sizes are shown in the first."""


class GuessKind(StrEnum):
    """Kind of an unconfirmed value."""

    AIRCRAFT = "aircraft"
    FLIGHT = "flight"
    CLOCK = "clock"
    UNIT = "unit"
    ROLE = "role"
    NAME = "name"
    CONDITION = "condition"


@dataclass(frozen=True, slots=True, kw_only=True)
class Guess:
    """An unconfirmed value with its key and consequence."""

    kind: GuessKind
    key: str
    value: str
    consequence: str


def find_guesses(store: Store, upload: ParsedUpload) -> tuple[Guess, ...]:
    """List the unconfirmed values of the mapping of an upload, with their consequences."""
    return tuple(_guess(store, upload, own) for own in upload.mapping.guessed)


def refuse_guesses(store: Store, upload: ParsedUpload) -> None:
    """Check that the mapping has no unconfirmed values.

    Raises
    ------
    BadInput
        With every guess and its consequence in ``guesses``.
    """
    found = find_guesses(store, upload)
    if found:
        named = " ".join(f"{own.key} = {own.value}: {own.consequence}." for own in found[:5])
        more = f" And {len(found) - 5} more." if len(found) > 5 else ""
        raise BadInput(
            f"{len(found)} values of the mapping are guessed and not confirmed. "
            f"{named}{more} Correct wrong values, then take the key out of 'guessed' of its table "
            "(or confirm all of them: --confirm on the command line, confirmed=true over HTTP).",
            code="unconfirmed",
            key=upload.mapping.guessed[0].path,
            guesses=[asdict(own) for own in found],
        )


def check_builtin(aircraft: Aircraft, upload: ParsedUpload) -> None:
    """Check that files of a known form have channels of the built-in aircraft only.

    Raises
    ------
    BadInput
        Naming the channels that the aircraft does not have.
    """
    if upload.builtin is None:
        return
    foreign = [c.name for c in upload.channels if c.name not in _list_own_names(aircraft)]
    if foreign:
        raise BadInput(
            f"The files have the form of records of {aircraft.name}, but {join_names(foreign)} "
            f"{'is' if len(foreign) == 1 else 'are'} no surface or sensor of it; give a mapping "
            "that names the aircraft.",
            code="other-aircraft",
            column=foreign[0],
        )


def _guess(store: Store, upload: ParsedUpload, guessed: Guessed) -> Guess:
    table, _, key = guessed.path.rpartition(".")
    channels = [channel for channel in upload.channels if channel.rule == table]
    if table == "aircraft":
        kind, consequence = GuessKind.AIRCRAFT, _describe_aircraft(store, upload)
    elif table == "flight":
        kind, consequence = GuessKind.FLIGHT, _describe_flight(store, upload)
    elif table.startswith("maneuver"):
        kind, consequence = GuessKind.CONDITION, _describe_condition(upload, key)
    elif not table.startswith("channels"):
        kind, consequence = GuessKind.CLOCK, _describe_clocks(upload.channels)
    elif key == "role":
        names = join_names([channel.name for channel in channels])
        kind, consequence = GuessKind.ROLE, f"{names} used as {guessed.value}"
    elif key == "name":
        kind, consequence = GuessKind.NAME, _describe_name(store, upload, channels)
    elif key == "other_side":
        names = join_names([channel.name for channel in channels])
        side = guessed.value["column"] if isinstance(guessed.value, Mapping) else ""
        fields = join_names([*(one.field for one in channels), str(side)])
        kind, consequence = GuessKind.NAME, f"{names} is the mean of {fields}"
    else:
        kind, consequence = GuessKind.UNIT, _describe_unit(channels)
    value = guessed.value
    if isinstance(value, dict):
        value = " ".join(str(part) for part in value.values())
    return Guess(kind=kind, key=guessed.path, value=str(value)[:80], consequence=consequence)


def _describe_aircraft(store: Store, upload: ParsedUpload) -> str:
    part = upload.mapping.aircraft
    known = store.aircraft.find(name=part.name) if part is not None else []
    if not known:
        return "not in the database yet" if upload.builtin else "unknown aircraft"
    own = _list_own_names(known[0])
    fitting = [channel.name for channel in upload.channels if channel.name in own]
    return (
        f"{len(fitting)} of {len(upload.channels)} channels are surfaces or sensors of it"
        f"{': ' + join_names(fitting) if fitting else ''}"
    )


def _describe_name(store: Store, upload: ParsedUpload, channels: Sequence[RawChannel]) -> str:
    part = upload.mapping.aircraft
    known = store.aircraft.find(name=part.name) if part is not None else []
    surfaces = [surface.name for surface in known[0].surfaces] if known else []
    names = {channel.name for channel in channels if channel.role is Role.INPUT}
    if surfaces and names.difference(surfaces):
        recorded = {channel.name for channel in upload.channels}
        free = [name for name in surfaces if name not in recorded]
        left = f"of which no column is {join_names(free)}" if free else "all of which are named"
        return f"no surface of {known[0].name}, {left}: choose the surface, or another role"
    return f"the name of column {join_names([channel.field for channel in channels])}"


def _describe_flight(store: Store, upload: ParsedUpload) -> str:
    aircraft, flight = upload.mapping.aircraft, upload.mapping.flight
    known = store.aircraft.find(name=aircraft.name) if aircraft is not None else []
    flights = (
        store.flights.find(aircraft_id=known[0].id, number=flight.number)
        if known and flight is not None
        else []
    )
    return "added to the existing flight" if flights else "a new flight"


def _describe_condition(upload: ParsedUpload, key: str) -> str:
    value = None if upload.maneuver is None else upload.maneuver.condition.get(key)
    quantity = None if upload.mapping.maneuver is None else upload.mapping.maneuver.condition[key]
    if value is None or quantity is None:
        return "a condition of the maneuver"
    return f"{key} is {value:.4g} {units.si_unit(quantity.unit)}".removesuffix(" 1")


def _describe_clocks(channels: Sequence[RawChannel]) -> str:
    clocks = list(dict.fromkeys(channel.clock for channel in channels))
    clocks.sort(key=lambda clock: clock.unevenness_s, reverse=True)
    return " and ".join(_describe_clock(clock) for clock in clocks[:3]) or "no channel has a time"


def _describe_clock(clock: Clock) -> str:
    rounded = "" if clock.rounded_s is None else f", time stamps rounded to {clock.rounded_s:.3g} s"
    uneven = (
        ""
        if clock.stamps is None
        else f", interpolated: time steps differ by up to {1e3 * clock.unevenness_s:.3g} ms"
    )
    span = f"{clock.stop_s - clock.start_s:.5g} s from {describe_start(clock.start_s)}"
    return f"{clock.rate_hz:.6g} Hz, {clock.n_samples} samples in {span}{rounded}{uneven}"


def describe_start(start_s: float) -> str:
    """Return a time of a record: a date where it can only be one since 1970. [s]"""
    if not _EARLIEST_DATE_S < start_s < _LATEST_DATE_S:
        return f"{start_s:.9g} s"
    date = datetime.fromtimestamp(start_s, UTC)
    return f"{date:%Y-%m-%d %H:%M:%S}.{date.microsecond // 1000:03d} UTC"


def _describe_unit(channels: Sequence[RawChannel]) -> str:
    if not channels:
        return "of no channel"
    if len(channels) > 1:
        sizes = [f"{own.name} {_format_size(own, own.unit)}" for own in channels]
        return f"largest values: {join_names(sizes)}"
    channel = channels[0]
    dimension = units.dimension(channel.unit)
    plain = units.lookup(channel.unit)
    others = [
        f"{_format_size(channel, other)} if it is {other}"
        for other in _SHOWN.get(dimension, ())
        if units.lookup(other) != plain
    ]
    return f"largest value {', '.join([_format_size(channel, channel.unit), *others])}"


def _format_size(channel: RawChannel, unit: str) -> str:
    """Largest value of a channel, read in a unit, in the unit that is shown for its dimension."""
    dimension = units.dimension(unit)
    shown = _SHOWN.get(dimension, (unit,))[0]
    target = units.lookup(shown)
    values = units.to_si([channel.samples.min(), channel.samples.max()], unit)
    largest = float(np.abs((values - target.offset) / target.factor).max())
    return f"{largest:.3g} {shown}".removesuffix(" 1")


def _list_own_names(aircraft: Aircraft) -> set[str]:
    surfaces = [surface.name for surface in aircraft.surfaces]
    commands = [f"{name}_command" for name in surfaces]
    return {*surfaces, *commands, *(sensor.name for sensor in aircraft.sensors)}


# --- Columns that earlier imports assigned to channels, to be proposed for the next file ----------

IMPORT_KIND = "import"
"""Kind of the jobs that import uploads."""

_SAME_RECORDER = 0.8  # share of the columns of an import that a file of its recorder has
_LATEST_IMPORTS = 30  # whose mappings are read: recorders differ between campaigns, not flights


def read_remembered_columns(store: Store, fields: Collection[str]) -> dict[str, dict[str, Meaning]]:
    """Read name, unit and role of columns from the latest imports, by aircraft and column.

    The newest import of the same recorder decides: one of which the file has most columns. Columns
    of matrices are known by their numbers and not remembered.
    """
    query = (
        sa.select(jobs.c.request)
        .where(jobs.c.kind == IMPORT_KIND, jobs.c.state == RunState.SUCCEEDED.value)
        .order_by(jobs.c.id.desc())
        .limit(_LATEST_IMPORTS)
    )
    with store.database.reading() as connection:
        requests = [request for (request,) in connection.execute(query) if request]
    found: dict[str, dict[str, Meaning]] = {}
    for request in requests:
        content = tomllib.loads(request["mapping"])
        aircraft = content.get("aircraft", {}).get("name")
        if isinstance(aircraft, str):
            columns = dict(_read_columns(content))
            if len(columns.keys() & set(fields)) < _SAME_RECORDER * len(columns):
                continue
            known = found.setdefault(aircraft, {})
            for field, meaning in columns.items():
                known.setdefault(field, meaning)
    return found


def _read_columns(content: dict[str, Any]) -> Iterator[tuple[str, Meaning]]:
    for channel in content.get("channels", ()):
        field, name = channel.get("column"), channel.get("name")
        unit, role = channel.get("unit"), channel.get("role")
        texts = isinstance(field, str) and isinstance(name, str) and isinstance(unit, str)
        if texts and role in list(Role) and "array" not in channel:
            yield field, Meaning(name=name, unit=unit, role=Role(role), sure=False, known=False)
