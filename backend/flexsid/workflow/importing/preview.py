"""Describing: what files hold, a mapping proposed for them, and what a mapping makes of them."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from flexsid import units
from flexsid.errors import BadInput
from flexsid.importers.channels import RawChannel
from flexsid.importers.mapping import parse_mapping, recognise
from flexsid.importers.plausibility import Doubt
from flexsid.importers.proposal import ask_again, find_time, list_columns, propose
from flexsid.importers.recognised import recognise as recognise_name
from flexsid.importers.source import Sources
from flexsid.records.aircraft import Aircraft
from flexsid.records.maneuver import Role
from flexsid.records.views import ChannelHistories, ChannelTrace
from flexsid.storage.store import Store
from flexsid.workflow.importing.flight_import import find_doubts
from flexsid.workflow.importing.parsed_files import ParsedUpload, explain
from flexsid.workflow.importing.unconfirmed_values import Guess, find_guesses

MOST_FIELDS = 500
MOST_DRAWN = 12


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
    """One file of an upload."""

    name: str
    sha256: str
    n_fields: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Proposal:
    """A mapping to begin with; ``origin`` says where it comes from."""

    text: str
    origin: str
    fitting: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class MappedChannel:
    """A channel as a mapping makes it."""

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
    """Why a mapping does not do yet; ``key`` is its key or the channel meant."""

    code: str
    message: str
    key: str | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Checked:
    """What a mapping makes of an upload, with questions where a unit is doubtful.

    ``guesses`` are values that nobody has confirmed; nothing is imported before.
    ``rules`` are its ``[[channels]]`` as they are written, for the table of the page.
    """

    rules: list[dict[str, Any]]
    channels: tuple[MappedChannel, ...]
    questions: tuple[Doubt, ...]
    guesses: tuple[Guess, ...]
    problem: MappingProblem | None


def describe_files(sources: Sources) -> list[UploadedFile]:
    """Name the files."""
    return [
        UploadedFile(name=source.name, sha256=source.sha256, n_fields=len(source.arrays))
        for source in sources.items
    ]


def describe_fields(sources: Sources) -> list[FoundField]:
    """Describe every column that may be a channel."""
    columns = list_columns(sources)
    time = find_time(sources, columns)
    stamps = {(c.file, c.field): c.samples for c in columns}
    found: list[FoundField] = []
    for column in columns[:MOST_FIELDS]:
        source = next(s for s in sources.items if s.name == column.file)
        clock = source.clocks.get(column.field, time.get(column.file, ""))
        at = stamps.get((column.file, clock))
        rate = None
        if at is not None and at.size == column.samples.size and at[-1] > at[0]:
            rate = float((at.size - 1) / (at[-1] - at[0]))
        found.append(
            FoundField(
                file=column.file,
                field=column.field,
                unit=column.unit,
                n_samples=column.samples.size,
                rate_hz=rate,
                first=tuple(_plain(value) for value in column.samples[:4]),
                smallest=_plain(column.samples.min()),
                largest=_plain(column.samples.max()),
            )
        )
    return found


def propose_mapping(store: Store, sources: Sources) -> Proposal:
    """Find the mapping to begin with: of a known form, kept before, or made of the names."""
    fitting = [kept for kept in store.mappings.find() if _fits(kept.text, sources)]
    names = tuple(kept.name for kept in fitting)
    known = recognise(sources)
    if known is not None:
        return Proposal(text=known, origin="a known form of file", fitting=names)
    if fitting:
        text = ask_again(fitting[-1].text)
        if text is not None:
            origin = f"the kept mapping '{fitting[-1].name}'"
            return Proposal(text=text, origin=origin, fitting=names)
    chosen = _likely_aircraft(store, sources)
    flights = store.flights.find(aircraft_id=chosen.id) if chosen is not None else []
    number = max((flight.number for flight in flights), default=0) + 1
    text = propose(
        sources,
        "?" if chosen is None else chosen.name,
        number,
        {} if chosen is None else _own_names(chosen),
    )
    return Proposal(text=text, origin="the names of the columns", fitting=names)


def check_mapping(store: Store, sources: Sources, text: str) -> Checked:
    """Say what a mapping makes of files, and what is wrong with it."""
    rules = _rules(text)
    try:
        upload = explain(sources, parse_mapping(text))
    except BadInput as error:
        key = error.context.get("key") or error.context.get("column")
        problem = MappingProblem(
            code=error.code, message=error.message, key=None if key is None else str(key)
        )
        return Checked(rules=rules, channels=(), questions=(), guesses=(), problem=problem)
    return Checked(
        rules=rules,
        channels=tuple(_mapped(channel) for channel in upload.channels),
        questions=find_doubts(upload.channels),
        guesses=find_guesses(store, upload),
        problem=None,
    )


def preview_channels(
    sources: Sources, text: str, names: Sequence[str], points: int
) -> ChannelHistories:
    """Time histories of channels as a mapping makes them; the first few where none is named.

    Raises
    ------
    BadInput
        If the mapping does not fit the files.
    """
    upload: ParsedUpload = explain(sources, parse_mapping(text))
    chosen = [c for c in upload.channels if not names or c.name in names][:MOST_DRAWN]
    return ChannelHistories(
        maneuver_id=0,  # none yet
        traces=tuple(_trace(channel) for channel in chosen),
        excitation_s=None,
        points=points,
    )


def _trace(channel: RawChannel) -> ChannelTrace:
    clock = channel.clock
    return ChannelTrace(
        name=channel.name,
        unit=units.si_unit(channel.unit),
        role=channel.role,
        time_s=clock.start_s + np.arange(channel.samples.size) / clock.rate_hz,
        values=units.to_si(channel.samples, channel.unit),
    )


def _mapped(channel: RawChannel) -> MappedChannel:
    return MappedChannel(
        name=channel.name,
        unit=channel.unit,
        role=channel.role,
        file=channel.source.name,
        field=channel.field,
        rate_hz=channel.clock.rate_hz,
        start_s=channel.clock.start_s,
        n_samples=channel.samples.size,
        smallest=float(channel.samples.min()),
        largest=float(channel.samples.max()),
    )


def _rules(text: str) -> list[dict[str, Any]]:
    try:
        rows = tomllib.loads(text).get("channels", [])
    except (tomllib.TOMLDecodeError, RecursionError):
        return []
    return [row for row in rows if isinstance(row, dict)] if isinstance(rows, list) else []


def _fits(text: str, sources: Sources) -> bool:
    """Tell whether a mapping finds all that it names in these files."""
    try:
        explain(sources, parse_mapping(text))
    except BadInput:
        return False
    return True


def _likely_aircraft(store: Store, sources: Sources) -> Aircraft | None:
    """Aircraft of whose surfaces and sensors the files name most; None where they name none."""
    columns = list_columns(sources)
    named = {column.field.rpartition(".")[2] for column in columns}
    named |= {recognise_name(column.field, column.unit).name for column in columns}
    best, most = None, 0
    for aircraft in store.aircraft.find():
        shared = len(named & _own_names(aircraft).keys())
        if shared >= max(most, 1):
            best, most = aircraft, shared
    return best


def _own_names(aircraft: Aircraft) -> dict[str, Role]:
    surfaces = {surface.name: Role.INPUT for surface in aircraft.surfaces}
    return {**surfaces, **{sensor.name: Role.OUTPUT for sensor in aircraft.sensors}}


def _plain(value: Any) -> float | None:
    number = float(value)
    return number if np.isfinite(number) else None
