"""Ingest: bring files into the store, all of an import or nothing."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from itertools import combinations
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from flexsid.errors import BadInput, Conflict, UnknownRecord
from flexsid.importers import confined
from flexsid.importers.aircraft import AircraftPart
from flexsid.importers.channels import RawChannel
from flexsid.importers.maneuver import (
    FlightPart,
    RawManeuver,
    extract_maneuver,
    extract_recording,
)
from flexsid.importers.mapping import Mapping, parse_mapping, recognise
from flexsid.importers.modal_table import RawModalTable, extract_modal_table
from flexsid.importers.plausibility import Doubt, find_doubt
from flexsid.importers.predictions import RawPrediction, extract_prediction
from flexsid.importers.source import Sources
from flexsid.records.aircraft import Aircraft
from flexsid.records.flight import Flight, FlightChannel
from flexsid.records.maneuver import Channel, Maneuver, Role
from flexsid.records.modal_table import ModalTable
from flexsid.records.prediction import Prediction
from flexsid.storage.repository import Repository
from flexsid.storage.store import Store
from flexsid.sysid.model.derivatives import Derivative
from flexsid.workflow.condition import airspeed_ratio, complete_condition

_Named = TypeVar("_Named", ModalTable, Prediction)


@dataclass(frozen=True, slots=True, kw_only=True)
class Imported:
    """What an import added or, for aircraft, tables and predictions, found there already."""

    aircraft: Aircraft
    flight: Flight | None = None
    flight_channels: tuple[FlightChannel, ...] = ()
    maneuver: Maneuver | None = None
    modal_tables: tuple[ModalTable, ...] = ()
    predictions: tuple[Prediction, ...] = ()


@dataclass(frozen=True, slots=True)
class Upload:
    """Files that were read with the mapping that explains them; nothing is stored yet."""

    sources: Sources
    mapping: Mapping

    @property
    def builtin(self) -> str | None:
        """Name of the aircraft that the workbench brings along and this upload needs."""
        part = self.mapping.aircraft
        return part.name if part is not None and part.builtin else None


def read_upload(
    files: Sequence[Path], mapping: Path | str | None = None, names: Sequence[str] | None = None
) -> Upload:
    """Read files and their mapping.

    Parameters
    ----------
    files
        Recorder files and tables of one import.
    mapping
        TOML file, or its text; None to recognise files of a known form.
    names
        What the files are called, where they lie under temporary names.

    Raises
    ------
    BadInput
        If a file or the mapping is not what it must be; the message names the
        row and column, or the key.
    """
    if not files:
        raise BadInput("No file was given; an import needs at least one.", code="bad-mapping")
    text = _text(mapping)
    parsed = None if text is None else parse_mapping(text)
    sources = confined.read_all(files, names)
    if parsed is None:
        known = recognise(sources)
        if known is None:
            raise BadInput(
                "The files have no known form; give a mapping that names their channels "
                "(examples/README.md describes it).",
                code="mapping-needed",
            )
        parsed = parse_mapping(known)
    return Upload(sources, parsed)


def keep_upload(
    store: Store,
    upload: Upload,
    aircraft_id: int | None = None,
    report: Callable[[float], None] = lambda fraction: None,
) -> Imported:
    """Store everything that an upload holds in one transaction.

    Parameters
    ----------
    store
        Where to keep it.
    upload
        Files with their mapping.
    aircraft_id
        Aircraft chosen by the user; needed where the mapping names none.
    report
        Is told which fraction of the samples is written; what it raises undoes all.

    Raises
    ------
    BadInput
        If the files do not hold what the mapping says, or a unit is doubtful and
        nobody confirmed it; nothing is stored.
    Conflict
        If this maneuver is already there, or a name stands for something else.
    """
    mapping, sources = upload.mapping, upload.sources
    raw: RawManeuver | None = None
    channels: tuple[RawChannel, ...] = ()
    if mapping.recording is not None:
        if mapping.maneuver is None:
            channels = extract_recording(mapping.recording, sources)
        else:
            raw = extract_maneuver(mapping.maneuver, mapping.recording, sources)
            channels = raw.channels
        _ask(channels)
    progress = _Progress(report, len(channels))
    with store.transaction():
        aircraft = _aircraft(store, mapping.aircraft, aircraft_id)
        _check_sensors(aircraft, channels)
        flight = maneuver = None
        recorded: tuple[FlightChannel, ...] = ()
        if mapping.flight is not None and mapping.recording is not None:
            flight = _flight(store, aircraft, mapping.flight)
            if raw is None:
                recorded = _recording(store, flight, channels, progress)
            else:
                maneuver = _maneuver(store, aircraft, flight, raw, progress)
        tables = tuple(
            _modal_table(store, aircraft, extract_modal_table(part, sources))
            for part in mapping.modal_tables
        )
        predictions = tuple(
            _prediction(
                store, aircraft, extract_prediction(part, sources, aircraft.geometry.chord_m)
            )
            for part in mapping.predictions
        )
    return Imported(
        aircraft=aircraft,
        flight=flight,
        flight_channels=recorded,
        maneuver=maneuver,
        modal_tables=tables,
        predictions=predictions,
    )


def import_files(
    store: Store,
    files: Sequence[Path],
    mapping: Path | str | None = None,
    aircraft_id: int | None = None,
) -> Imported:
    """Read files and store what they hold: ``read_upload``, then ``keep_upload``."""
    return keep_upload(store, read_upload(files, mapping), aircraft_id)


def import_maneuver(
    store: Store,
    files: Sequence[Path],
    mapping: Path | str | None = None,
    aircraft_id: int | None = None,
) -> Maneuver:
    """Import files that must hold a maneuver.

    Raises
    ------
    BadInput
        If the mapping describes no maneuver.
    """
    upload = read_upload(files, mapping)
    if upload.mapping.maneuver is None:
        raise BadInput("The mapping describes no maneuver.", code="bad-mapping", key="maneuver")
    maneuver = keep_upload(store, upload, aircraft_id).maneuver
    assert maneuver is not None
    return maneuver


def largest_correlation(inputs: Sequence[np.ndarray]) -> float | None:
    """Largest pairwise correlation of input time histories; None for fewer than two.

    Parameters
    ----------
    inputs
        Samples of each input over the same interval; one that never moves counts as uncorrelated.
    """
    largest = None
    for first, second in combinations([np.asarray(u, dtype=np.float64) for u in inputs], 2):
        a, b = first - first.mean(), second - second.mean()
        scale = float(np.sqrt((a @ a) * (b @ b)))
        value = abs(float(a @ b)) / scale if scale > 0 else 0.0
        largest = value if largest is None else max(largest, value)
    return largest


def _text(mapping: Path | str | None) -> str | None:
    if not isinstance(mapping, Path):
        return mapping
    try:
        return mapping.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise BadInput(
            f"The mapping {mapping.name} cannot be read ({error}).", code="bad-mapping"
        ) from error


def _aircraft(store: Store, part: AircraftPart | None, aircraft_id: int | None) -> Aircraft:
    if aircraft_id is not None:
        aircraft = store.aircraft.get(aircraft_id)
        if part is not None and part.name != aircraft.name:
            raise BadInput(
                f"The mapping is for '{part.name}', but '{aircraft.name}' was chosen.",
                code="bad-mapping",
                key="aircraft.name",
            )
        return aircraft
    if part is None:
        raise BadInput(
            "Mapping: 'aircraft' is missing; name the aircraft or choose one.",
            code="bad-mapping",
            key="aircraft",
        )
    known = store.aircraft.find(name=part.name)
    if not known:
        if part.definition is None:
            names = ", ".join(aircraft.name for aircraft in store.aircraft.find()) or "none"
            raise UnknownRecord(
                f"There is no aircraft '{part.name}'; there are: {names}. Name one of them, or "
                "define the aircraft in the mapping."
            )
        return store.aircraft.add(part.definition)
    if part.definition is not None and replace(known[0], id=None) != part.definition:
        raise Conflict(
            f"Aircraft '{part.name}' is there already with another definition; take the definition "
            "out of the mapping, or give this one another name.",
            code="already-exists",
        )
    return known[0]


def _flight(store: Store, aircraft: Aircraft, part: FlightPart) -> Flight:
    assert aircraft.id is not None
    known = store.flights.find(aircraft_id=aircraft.id, number=part.number)
    if known:
        return known[0]
    return store.flights.add(
        Flight(
            aircraft_id=aircraft.id,
            number=part.number,
            flown_on=part.flown_on,
            description=part.description,
        )
    )


def _maneuver(
    store: Store, aircraft: Aircraft, flight: Flight, raw: RawManeuver, progress: _Progress
) -> Maneuver:
    assert aircraft.id is not None
    assert flight.id is not None
    for known in store.maneuvers.find(aircraft_id=aircraft.id, source_hash=raw.source_hash):
        if known.label == raw.label:
            raise Conflict(
                f"Maneuver '{raw.label}' was imported from this file before (maneuver {known.id}).",
                code="already-imported",
                maneuver_id=known.id,
            )
    condition = complete_condition(aircraft, raw.condition)
    inputs = [channel.samples for channel in raw.channels if channel.role is Role.INPUT]
    maneuver = store.maneuvers.add(
        Maneuver(
            aircraft_id=aircraft.id,
            flight_id=flight.id,
            label=raw.label,
            start_s=raw.start_s,
            duration_s=raw.duration_s,
            condition=condition,
            fta=raw.fta,
            axis=raw.axis,
            excitation=raw.excitation,
            airspeed_ratio=airspeed_ratio(condition),
            max_input_correlation=largest_correlation(inputs),
            source_file=raw.source_file,
            source_hash=raw.source_hash,
            note=raw.note,
        )
    )
    for channel in raw.channels:
        store.channels.add(Channel(**_kept(store, channel), maneuver_id=maneuver.id))
        progress.advance()
    return maneuver


def _recording(
    store: Store, flight: Flight, channels: Sequence[RawChannel], progress: _Progress
) -> tuple[FlightChannel, ...]:
    """Keep channels of a whole flight, beside those that it has from other files."""
    assert flight.id is not None
    known = {channel.name: channel for channel in store.flight_channels.find(flight_id=flight.id)}
    kept: list[FlightChannel] = []
    for channel in channels:
        if channel.name in known:
            raise Conflict(
                f"Flight {flight.number} has a channel '{channel.name}' already, from "
                f"{known[channel.name].source_file}; give this one another name.",
                code="already-imported",
                column=channel.name,
                flight_id=flight.id,
            )
        row = FlightChannel(**_kept(store, channel), flight_id=flight.id)
        kept.append(store.flight_channels.add(row))
        progress.advance()
    return tuple(kept)


def _kept(store: Store, channel: RawChannel) -> dict[str, Any]:
    """What a channel of a maneuver and one of a flight have in common; the samples are kept."""
    return {
        "name": channel.name,
        "unit": channel.unit,
        "role": channel.role,
        "rate_hz": channel.clock.rate_hz,
        "start_s": channel.clock.start_s,
        "n_samples": channel.samples.size,
        "array": store.arrays.put(channel.samples, channel.unit),
        "sensor": channel.sensor,
        "source_file": channel.source.name,
        "source_hash": channel.source.sha256,
        "source_field": channel.field,
    }


class _Progress:
    """Counts the channels that are written."""

    def __init__(self, report: Callable[[float], None], n_channels: int) -> None:
        self._report = report
        self._n_channels = n_channels
        self._written = 0

    def advance(self) -> None:
        self._written += 1
        self._report(self._written / self._n_channels)


def find_doubts(channels: Sequence[RawChannel]) -> tuple[Doubt, ...]:
    """Units that do not fit the size of their samples and that nobody confirmed."""
    found = (find_doubt(c.name, c.unit, c.role, c.samples) for c in channels)
    return tuple(
        doubt
        for channel, doubt in zip(channels, found, strict=True)
        if doubt is not None and doubt.code not in channel.confirmed
    )


def _ask(channels: Sequence[RawChannel]) -> None:
    doubts = find_doubts(channels)
    if doubts:
        raise BadInput(
            " ".join(doubt.question for doubt in doubts[:5]),
            code="doubtful-unit",
            column=doubts[0].channel,
            questions=[asdict(doubt) for doubt in doubts],
        )


def _check_sensors(aircraft: Aircraft, channels: Sequence[RawChannel]) -> None:
    known = {sensor.name for sensor in aircraft.sensors}
    for channel in channels:
        if channel.sensor is not None and channel.sensor not in known:
            raise BadInput(
                f"Channel '{channel.name}': aircraft '{aircraft.name}' has no sensor "
                f"'{channel.sensor}'; it has {', '.join(sorted(known)) or 'none'}.",
                code="unknown-sensor",
                column=channel.name,
            )


def _modal_table(store: Store, aircraft: Aircraft, raw: RawModalTable) -> ModalTable:
    assert aircraft.id is not None
    table = ModalTable(
        aircraft_id=aircraft.id,
        name=raw.name,
        kind=raw.kind,
        fuel=raw.fuel,
        numbers=raw.numbers,
        names=raw.names,
        symmetric=raw.symmetric,
        points=raw.points,
        arrays={name: store.arrays.put(array) for name, array in raw.arrays.items()},
        origin=raw.origin,
    )
    known = store.modal_tables.find(aircraft_id=aircraft.id, name=raw.name)
    return _keep_once(store.modal_tables, table, known, f"Modal table '{raw.name}'")


def _prediction(store: Store, aircraft: Aircraft, raw: RawPrediction) -> Prediction:
    assert aircraft.id is not None
    for name in raw.names:
        Derivative.parse(name)
    prediction = Prediction(
        aircraft_id=aircraft.id,
        source=raw.source,
        kind=raw.kind,
        fuel=raw.fuel,
        names=raw.names,
        values=store.arrays.put(raw.values),
        note=raw.note,
    )
    known = store.predictions.find(aircraft_id=aircraft.id, source=raw.source)
    return _keep_once(store.predictions, prediction, known, f"Prediction '{raw.source}'")


def _keep_once(
    repository: Repository[_Named], record: _Named, known: Sequence[_Named], what: str
) -> _Named:
    """Several maneuvers may come with the same tables: keep them once, never change them."""
    for same in known:
        if replace(same, id=None) == record:
            return same
    if known:
        raise Conflict(
            f"{what} is there already with other content; give this one another name.",
            code="already-exists",
        )
    return repository.add(record)
