"""Ingest: bring files into the store, all of an import or nothing."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass, replace
from pathlib import Path

from flexsid.errors import BadInput, FlexsidError
from flexsid.importers import confined
from flexsid.importers.channels import RawChannel
from flexsid.importers.mapping import parse_mapping, recognise
from flexsid.importers.modal_table import extract_modal_table
from flexsid.importers.plausibility import Doubt, find_doubt, find_small
from flexsid.importers.predictions import extract_prediction
from flexsid.records.aircraft import Aircraft
from flexsid.records.flight import Flight, FlightChannel
from flexsid.records.maneuver import Maneuver
from flexsid.records.modal_table import ModalTable
from flexsid.records.prediction import DerivativePrediction
from flexsid.storage.arrays import describe
from flexsid.storage.store import Store
from flexsid.workflow.importing.parsed_files import ParsedUpload, explain
from flexsid.workflow.importing.persistence import (
    Writing,
    check_axes,
    check_sensors,
    keep_aircraft,
    keep_flight,
    keep_maneuver,
    keep_modal_table,
    keep_prediction,
    keep_recording,
)
from flexsid.workflow.importing.unconfirmed_values import check_builtin, refuse_guesses

BringAlong = Callable[[Store, str], None]
"""Adds an aircraft that comes with the software, by its name, unless it is there."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Imported:
    """What an import added or, for aircraft, tables and predictions, found there already."""

    aircraft: Aircraft
    flight: Flight | None = None
    flight_channels: tuple[FlightChannel, ...] = ()
    maneuver: Maneuver | None = None
    modal_tables: tuple[ModalTable, ...] = ()
    predictions: tuple[DerivativePrediction, ...] = ()


def read_upload(
    files: Sequence[Path], mapping: Path | str | None = None, names: Sequence[str] | None = None
) -> ParsedUpload:
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
    return explain(sources, parsed)


def hashed(upload: ParsedUpload) -> ParsedUpload:
    """Hash the samples of an upload, unless that was done before."""
    if upload.rows or not upload.channels:
        return upload
    rows = {c.name: describe(c.samples, c.unit) for c in upload.channels}
    return replace(upload, rows=rows)


def keep_upload(
    store: Store,
    upload: ParsedUpload,
    aircraft_id: int | None = None,
    report: Callable[[float], None] = lambda fraction: None,
    bring_along: BringAlong | None = None,
    *,
    confirmed: bool = False,
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
    bring_along
        Adds the aircraft that comes with the software when the upload needs it.
    confirmed
        Whether somebody has confirmed all that the mapping marks as guessed.

    Raises
    ------
    BadInput
        If the files do not hold what the mapping says, or something is guessed or a unit
        doubtful and nobody confirmed it; nothing is stored.
    Conflict
        If this maneuver is already there, or a name stands for something else.
    """
    _ask(upload.channels)
    if not confirmed:
        refuse_guesses(store, upload)
    upload = hashed(upload)
    mapping, sources = upload.mapping, upload.sources
    writing = Writing(upload.rows, report)
    with store.transaction():
        if upload.builtin is not None and bring_along is not None:
            bring_along(store, upload.builtin)
        aircraft = keep_aircraft(store, mapping.aircraft, aircraft_id)
        check_sensors(aircraft, upload.channels)
        check_axes(aircraft, upload.channels)
        check_builtin(aircraft, upload)
        flight = maneuver = None
        recorded: tuple[FlightChannel, ...] = ()
        if mapping.flight is not None and mapping.recording is not None:
            flight = keep_flight(store, aircraft, mapping.flight)
            if upload.maneuver is None:
                recorded = keep_recording(store, flight, upload.channels, writing)
            else:
                maneuver = keep_maneuver(store, aircraft, flight, upload.maneuver, writing)
        tables = tuple(
            keep_modal_table(store, aircraft, extract_modal_table(part, sources))
            for part in mapping.modal_tables
        )
        predictions = tuple(
            keep_prediction(
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
    *,
    confirmed: bool = False,
) -> Imported:
    """Read files and store what they hold: ``read_upload``, then ``keep_upload``."""
    upload = read_upload(files, mapping)
    return keep_upload(store, upload, aircraft_id, confirmed=confirmed)


def import_each(
    store: Store,
    files: Sequence[Path],
    mapping: Path | str | None = None,
    aircraft_id: int | None = None,
    bring_along: BringAlong | None = None,
    *,
    confirmed: bool = False,
) -> Iterator[tuple[Path, Imported | FlexsidError]]:
    """Import a campaign: every file is an import of its own, read through the same mapping.

    The next file is read while one is written.

    Yields
    ------
    file, result
        In the order of the files; what one of them is refused for, others do not
        suffer.
    """
    text = _text(mapping)

    def read(file: Path) -> ParsedUpload | FlexsidError:
        try:
            return hashed(read_upload([file], text))
        except FlexsidError as error:
            return error

    with ThreadPoolExecutor(1) as ahead:
        coming = ahead.submit(read, files[0]) if files else None
        for number, file in enumerate(files, start=1):
            assert coming is not None
            upload = coming.result()
            coming = ahead.submit(read, files[number]) if number < len(files) else None
            if isinstance(upload, ParsedUpload):
                try:
                    yield (
                        file,
                        keep_upload(
                            store,
                            upload,
                            aircraft_id,
                            bring_along=bring_along,
                            confirmed=confirmed,
                        ),
                    )
                except FlexsidError as error:
                    yield file, error
            else:
                yield file, upload


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


def find_doubts(channels: Sequence[RawChannel]) -> tuple[Doubt, ...]:
    """Units that do not fit the size of their samples and that nobody confirmed."""
    sized = [find_doubt(c.name, c.unit, c.role, c.samples) for c in channels]
    doubts = [doubt for doubt in sized if doubt is not None]
    known = {doubt.channel for doubt in doubts}
    small = find_small([(c.name, c.unit, c.role, c.samples) for c in channels])
    doubts += [doubt for doubt in small if doubt.channel not in known]
    confirmed = {channel.name: channel.confirmed for channel in channels}
    return tuple(doubt for doubt in doubts if doubt.code not in confirmed[doubt.channel])


def _ask(channels: Sequence[RawChannel]) -> None:
    doubts = find_doubts(channels)
    if doubts:
        raise BadInput(
            " ".join(doubt.question for doubt in doubts[:5]),
            code="doubtful-unit",
            column=doubts[0].channel,
            questions=[asdict(doubt) for doubt in doubts],
        )


def _text(mapping: Path | str | None) -> str | None:
    if not isinstance(mapping, Path):
        return mapping
    try:
        return mapping.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise BadInput(
            f"The mapping {mapping.name} cannot be read ({error}).", code="bad-mapping"
        ) from error
