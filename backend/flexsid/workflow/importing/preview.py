"""Preview of an upload: contents of files, proposed mapping, and channels of a mapping."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from flexsid import units
from flexsid.errors import BadInput, UnknownRecord
from flexsid.importers.column_names import Meaning
from flexsid.importers.column_names import recognise_column as recognise_name
from flexsid.importers.mapping import find_known_mapping, parse_mapping
from flexsid.importers.proposal import (
    REMEMBERED,
    SECONDS,
    find_clock_unit,
    find_further_clocks,
    find_time,
    list_columns,
    mark_guessed,
    write_proposal,
)
from flexsid.importers.quantity import UnitWarning
from flexsid.importers.source import Sources
from flexsid.importers.surface_names import find_surfaces
from flexsid.records import finite_or_none
from flexsid.records.aircraft import Aircraft
from flexsid.records.maneuver import Role
from flexsid.records.views import ChannelHistories, ChannelTrace
from flexsid.storage.store import Store
from flexsid.workflow.importing.flight_import import find_unit_warnings
from flexsid.workflow.importing.parsed_files import (
    Guess,
    describe_start,
    find_guesses,
    parse_upload,
    read_remembered_columns,
)

MOST_FIELDS = 500
MOST_DRAWN = 12
_LONGEST_OFFSET_S = 1e4  # of a record, whose times are drawn from its start beyond


@dataclass(frozen=True, slots=True, kw_only=True)
class FoundField:
    """One column of a file: its rate, if the file has a time, and its first values."""

    file: str
    field: str
    unit: str
    n_samples: int
    rate_hz: float | None
    first: tuple[float | None, ...]
    smallest: float | None
    largest: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class UploadedFile:
    """One file of an upload; ``not_read`` names contents that are not read, and why."""

    name: str
    sha256: str
    n_fields: int
    not_read: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Proposal:
    """A proposed mapping; ``origin`` is its source."""

    text: str
    origin: str
    fitting: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class MappedChannel:
    """A channel of a mapping."""

    name: str
    unit: str
    role: Role
    file: str
    field: str
    rate_hz: float
    start_s: float
    n_samples: int
    smallest: float
    largest: float


@dataclass(frozen=True, slots=True, kw_only=True)
class MappingProblem:
    """An error in a mapping; ``key`` is its key or the channel."""

    code: str
    message: str
    key: str | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Checked:
    """Channels of an upload by a mapping, with warnings on implausible units.

    ``guesses`` are unconfirmed values; they prevent the import. ``repairs`` name what is changed in
    the record, as the mapping allows.
    ``rules`` are the ``[[channels]]`` of the mapping as written, for the table in the page.
    """

    rules: list[dict[str, Any]]
    channels: tuple[MappedChannel, ...]
    queries: tuple[UnitWarning, ...]
    guesses: tuple[Guess, ...]
    problem: MappingProblem | None
    repairs: tuple[str, ...] = ()


def describe_files(sources: Sources) -> list[UploadedFile]:
    """List the files with hash and number of fields."""
    return [
        UploadedFile(
            name=source.name,
            sha256=source.sha256,
            n_fields=len(source.arrays),
            not_read=source.not_read,
        )
        for source in sources.items
    ]


def describe_fields(sources: Sources) -> list[FoundField]:
    """Describe every column that may be a channel."""
    columns = list_columns(sources)
    time = find_time(sources, columns)
    further = find_further_clocks(columns, time)
    stamps = {(c.file, c.field): c for c in columns}
    found: list[FoundField] = []
    for column in columns[:MOST_FIELDS]:
        source = next(s for s in sources.items if s.name == column.file)
        usual = further.get((column.file, column.field), time.get(column.file, ""))
        clock = stamps.get((column.file, source.clocks.get(column.field, usual)))
        rate = None
        if clock is not None and (at := clock.samples).size == column.samples.size:
            duration = float(at[-1] - at[0]) * SECONDS[find_clock_unit(clock)[0]]
            rate = (at.size - 1) / duration if duration > 0.0 else None
        found.append(
            FoundField(
                file=column.file,
                field=column.field,
                unit=column.unit,
                n_samples=column.samples.size,
                rate_hz=rate,
                first=tuple(finite_or_none(value) for value in column.samples[:4]),
                smallest=finite_or_none(column.samples.min()),
                largest=finite_or_none(column.samples.max()),
            )
        )
    return found


def propose_mapping(store: Store, sources: Sources, aircraft: str | None = None) -> Proposal:
    """Propose a mapping: of a known form, a saved one, or from the column names.

    With the name of a stored aircraft it is from the column names, for that aircraft.

    Raises
    ------
    UnknownRecord
        If no aircraft has this name.
    """
    fitting = [saved for saved in store.mappings.find() if _fits(saved.text, sources)]
    names = tuple(saved.name for saved in fitting)
    known = find_known_mapping(sources)
    if known is not None and aircraft is None:
        return Proposal(text=known, origin="a known form of file", fitting=names)
    text = mark_guessed(fitting[-1].text) if fitting and aircraft is None else None
    if text is not None:
        origin = f"the saved mapping '{fitting[-1].name}'"
        return Proposal(text=text, origin=origin, fitting=names)
    name, number, roles = "?", 1, {}
    fields = {column.field for column in list_columns(sources)}
    remembered = read_remembered_columns(store, fields)
    if aircraft is None:
        selected = _find_likely_aircraft(store, sources, remembered)
    else:
        selected = next(iter(store.aircraft.find(name=aircraft)), None)
        if selected is None:
            known_names = ", ".join(one.name for one in store.aircraft.find()) or "none"
            raise UnknownRecord(f"there is no aircraft '{aircraft}'; there are: {known_names}")
    if selected is not None:
        flights = store.flights.find(aircraft_id=selected.id)
        name, roles = selected.name, _list_names(selected)
        number = max((flight.number for flight in flights), default=0) + 1
    text = write_proposal(sources, name, number, roles, remembered.get(name))
    origin = "the names of the columns"
    if REMEMBERED in text:
        origin += " and earlier imports"
    return Proposal(text=text, origin=origin, fitting=names)


def check_mapping(store: Store, sources: Sources, text: str) -> Checked:
    """Apply a mapping to files; return channels, warnings and the first error."""
    rules = _read_rules(text)
    try:
        upload = parse_upload(sources, parse_mapping(text))
    except BadInput as error:
        key = error.context.get("key") or error.context.get("column")
        problem = MappingProblem(
            code=error.code, message=error.message, key=None if key is None else str(key)
        )
        return Checked(rules=rules, channels=(), queries=(), guesses=(), problem=problem)
    return Checked(
        rules=rules,
        channels=tuple(
            MappedChannel(
                name=c.name,
                unit=c.unit,
                role=c.role,
                file=c.source.name,
                field=c.field,
                rate_hz=c.clock.rate_hz,
                start_s=c.clock.start_s,
                n_samples=c.samples.size,
                smallest=float(c.samples.min()),
                largest=float(c.samples.max()),
            )
            for c in upload.channels
        ),
        queries=find_unit_warnings(upload.channels),
        guesses=find_guesses(store, upload),
        problem=None,
        repairs=upload.repairs,
    )


def preview_channels(
    sources: Sources, text: str, names: Sequence[str], points: int
) -> ChannelHistories:
    """Read time histories of mapped channels; the first few by default.

    Raises
    ------
    BadInput
        If the mapping does not fit the files.
    """
    upload = parse_upload(sources, parse_mapping(text))
    selected = [c for c in upload.channels if not names or c.name in names][:MOST_DRAWN]
    start_s = min((c.clock.start_s for c in selected), default=0.0)
    zero_s = start_s if abs(start_s) > _LONGEST_OFFSET_S else 0.0
    return ChannelHistories(
        maneuver_id=0,  # none yet
        traces=tuple(
            ChannelTrace(
                name=c.name,
                unit=units.si_unit(c.unit),
                role=c.role,
                time_s=c.clock.start_s - zero_s + np.arange(c.samples.size) / c.clock.rate_hz,
                values=units.to_si(c.samples, c.unit),
            )
            for c in selected
        ),
        excitation_s=None,
        points=points,
        origin=describe_start(zero_s) if zero_s else "",
    )


def _read_rules(text: str) -> list[dict[str, Any]]:
    try:
        rows = tomllib.loads(text).get("channels", [])
    except (tomllib.TOMLDecodeError, RecursionError):
        return []
    return [row for row in rows if isinstance(row, dict)] if isinstance(rows, list) else []


def _fits(text: str, sources: Sources) -> bool:
    """Return whether the files have everything that a mapping names."""
    try:
        parse_upload(sources, parse_mapping(text))
    except BadInput:
        return False
    return True


def _find_likely_aircraft(
    store: Store, sources: Sources, remembered: Mapping[str, Mapping[str, Meaning]]
) -> Aircraft | None:
    """Find the aircraft with most surfaces, sensors and known columns; None without any.

    A surface counts as well if the words of a column fit it.
    """
    columns = list_columns(sources)
    fields = {column.field for column in columns}
    named = {column.field.rpartition(".")[2] for column in columns}
    named |= {recognise_name(column.field, column.unit).name for column in columns}
    best, most = None, 0
    for aircraft in store.aircraft.find():
        surfaces = [surface.name for surface in aircraft.surfaces]
        fitted = {one for name in named for one in find_surfaces(name, surfaces)}
        shared = len(named & _list_names(aircraft).keys()) + len(fitted - named)
        shared += len(fields & remembered.get(aircraft.name, {}).keys())
        if shared >= max(most, 1):
            best, most = aircraft, shared
    return best


def _list_names(aircraft: Aircraft) -> dict[str, Role]:
    surfaces = {surface.name: Role.INPUT for surface in aircraft.surfaces}
    return {**surfaces, **{sensor.name: Role.OUTPUT for sensor in aircraft.sensors}}
