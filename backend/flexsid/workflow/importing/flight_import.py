"""Import of files into the database; each import is one transaction."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass, replace
from pathlib import Path

from flexsid.errors import BadInput, FlexsidError
from flexsid.importers import sandbox
from flexsid.importers.channels import RawChannel
from flexsid.importers.mapping import find_known_mapping, parse_mapping
from flexsid.importers.modal_table import extract_modal_table
from flexsid.importers.plausibility import UnitWarning, find_small_outputs, find_unit_warning
from flexsid.importers.predictions import extract_prediction
from flexsid.records.aircraft import Aircraft
from flexsid.records.flight import Flight, FlightChannel
from flexsid.records.maneuver import Maneuver
from flexsid.records.modal_table import ModalTable
from flexsid.records.prediction import DerivativePrediction
from flexsid.storage.arrays import describe_array
from flexsid.storage.store import Store
from flexsid.workflow.importing.parsed_files import ParsedUpload, parse_upload
from flexsid.workflow.importing.persistence import (
    Writing,
    check_axes,
    check_sensors,
    store_aircraft,
    store_flight,
    store_maneuver,
    store_modal_table,
    store_prediction,
    store_recording,
)
from flexsid.workflow.importing.unconfirmed_values import check_builtin, refuse_guesses

AddBuiltinAircraft = Callable[[Store, str], None]
"""Adds an aircraft that comes with the software, by its name, unless it is there."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Imported:
    """Records of an import: added, or existing aircraft, tables and predictions."""

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
        Original names of files stored under temporary names.

    Raises
    ------
    BadInput
        If a file or the mapping is invalid; the message has the row and column, or
        the key.
    """
    if not files:
        raise BadInput("No file was given; an import needs at least one.", code="bad-mapping")
    text = _text(mapping)
    parsed = None if text is None else parse_mapping(text)
    sources = sandbox.read_all(files, names)
    if parsed is None:
        known = find_known_mapping(sources)
        if known is None:
            raise BadInput(
                "The files have no known form; give a mapping that names their channels "
                "(examples/README.md describes it).",
                code="mapping-needed",
            )
        parsed = parse_mapping(known)
    return parse_upload(sources, parsed)


def hash_upload(upload: ParsedUpload) -> ParsedUpload:
    """Hash the samples of an upload, if not yet hashed."""
    if upload.rows or not upload.channels:
        return upload
    rows = {c.name: describe_array(c.samples, c.unit) for c in upload.channels}
    return replace(upload, rows=rows)


def store_upload(
    store: Store,
    upload: ParsedUpload,
    aircraft_id: int | None = None,
    report: Callable[[float], None] = lambda fraction: None,
    add_builtin_aircraft: AddBuiltinAircraft | None = None,
    *,
    confirmed: bool = False,
) -> Imported:
    """Store the contents of an upload in one transaction.

    Parameters
    ----------
    store
        Database.
    upload
        Files with their mapping.
    aircraft_id
        Aircraft selected by the user; needed where the mapping names none.
    report
        Called with the fraction of samples written; an exception rolls the import back.
    add_builtin_aircraft
        Adds the aircraft that comes with the software when the upload needs it.
    confirmed
        Whether the guessed values of the mapping are confirmed.

    Raises
    ------
    BadInput
        If the files do not match the mapping, or a guessed value or implausible unit is
        not confirmed; nothing is stored.
    Conflict
        If the maneuver exists already, or a name is used for other content.
    """
    _check_units(upload.channels)
    if not confirmed:
        refuse_guesses(store, upload)
    upload = hash_upload(upload)
    mapping, sources = upload.mapping, upload.sources
    writing = Writing(upload.rows, report)
    with store.transaction():
        if upload.builtin is not None and add_builtin_aircraft is not None:
            add_builtin_aircraft(store, upload.builtin)
        aircraft = store_aircraft(store, mapping.aircraft, aircraft_id)
        check_sensors(aircraft, upload.channels)
        check_axes(aircraft, upload.channels)
        check_builtin(aircraft, upload)
        flight = maneuver = None
        recorded: tuple[FlightChannel, ...] = ()
        if mapping.flight is not None and mapping.recording is not None:
            flight = store_flight(store, aircraft, mapping.flight)
            if upload.maneuver is None:
                recorded = store_recording(store, flight, upload.channels, writing)
            else:
                maneuver = store_maneuver(store, aircraft, flight, upload.maneuver, writing)
        tables = tuple(
            store_modal_table(store, aircraft, extract_modal_table(part, sources))
            for part in mapping.modal_tables
        )
        predictions = tuple(
            store_prediction(
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
    """Read files and store their contents: ``read_upload``, then ``store_upload``."""
    upload = read_upload(files, mapping)
    return store_upload(store, upload, aircraft_id, confirmed=confirmed)


def import_each(
    store: Store,
    files: Sequence[Path],
    mapping: Path | str | None = None,
    aircraft_id: int | None = None,
    add_builtin_aircraft: AddBuiltinAircraft | None = None,
    *,
    confirmed: bool = False,
) -> Iterator[tuple[Path, Imported | FlexsidError]]:
    """Import a campaign: every file separately, with the same mapping.

    The next file is read while one is written.

    Yields
    ------
    file, result
        In the order of the files; an error in one file does not affect the others.
    """
    text = _text(mapping)

    def read(file: Path) -> ParsedUpload | FlexsidError:
        try:
            return hash_upload(read_upload([file], text))
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
                        store_upload(
                            store,
                            upload,
                            aircraft_id,
                            add_builtin_aircraft=add_builtin_aircraft,
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
    maneuver = store_upload(store, upload, aircraft_id).maneuver
    assert maneuver is not None
    return maneuver


def find_unit_warnings(channels: Sequence[RawChannel]) -> tuple[UnitWarning, ...]:
    """Find implausible units that are not confirmed in the mapping."""
    sized = [find_unit_warning(c.name, c.unit, c.role, c.samples) for c in channels]
    warnings = [warning for warning in sized if warning is not None]
    known = {warning.channel for warning in warnings}
    small = find_small_outputs([(c.name, c.unit, c.role, c.samples) for c in channels])
    warnings += [warning for warning in small if warning.channel not in known]
    confirmed = {channel.name: channel.confirmed for channel in channels}
    return tuple(warning for warning in warnings if warning.code not in confirmed[warning.channel])


def _check_units(channels: Sequence[RawChannel]) -> None:
    warnings = find_unit_warnings(channels)
    if warnings:
        raise BadInput(
            " ".join(warning.message for warning in warnings[:5]),
            code="unconfirmed-unit",
            column=warnings[0].channel,
            queries=[asdict(warning) for warning in warnings],
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
