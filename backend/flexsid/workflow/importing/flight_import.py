"""Import of files into the database; each import is one transaction."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass, replace
from functools import partial
from itertools import combinations
from pathlib import Path
from types import MappingProxyType
from typing import Any, TypeVar

import numpy as np

from flexsid.errors import BadInput, Conflict, FlexsidError, UnknownRecord
from flexsid.importers import sandbox
from flexsid.importers.aircraft import AircraftPart
from flexsid.importers.maneuver import RawChannel, RawManeuver
from flexsid.importers.mapping import (
    ModalTableMapping,
    PredictionMapping,
    find_known_mapping,
    parse_mapping,
)
from flexsid.importers.modal_table import extract_derivatives, extract_modes
from flexsid.importers.quantity import (
    OTHER_AXIS,
    UnitWarning,
    find_small_outputs,
    find_unit_warning,
)
from flexsid.importers.source import Sources
from flexsid.records.aircraft import Aircraft, DerivativePrediction, list_surface_parts
from flexsid.records.maneuver import (
    GROUND,
    Channel,
    Excitation,
    Flight,
    FlightChannel,
    Maneuver,
    Role,
)
from flexsid.records.modal_data import ModalTable
from flexsid.storage.arrays import describe_array
from flexsid.storage.recordings import Chunks, Recordings
from flexsid.storage.repository import Repository
from flexsid.storage.store import Store
from flexsid.sysid.model.derivatives import parse_derivative
from flexsid.sysid.preparation.cutting import ExcitedInterval, find_excitations
from flexsid.workflow.aircraft.axes import list_moved_surfaces
from flexsid.workflow.aircraft.flight_condition import (
    complete_condition,
    complete_parked_condition,
    compute_airspeed_ratio,
    set_thrust_table,
)
from flexsid.workflow.importing.parsed_files import (
    ParsedUpload,
    add_repairs,
    check_builtin,
    parse_upload,
    refuse_guesses,
)
from flexsid.workflow.measurements.maneuver_spectra import add_shared_corrections
from flexsid.workflow.measurements.measured_axis import determine_axis

BYTES_AT_ONCE = 16 * 1024**2
"""Samples written by one statement."""

AddBuiltinAircraft = Callable[[Store, str], None]
"""Adds an aircraft that comes with the software, by its name, unless it is there."""

_COMMAND = "_command"  # suffix of the channel with the excitation of an input
_Named = TypeVar("_Named", ModalTable, DerivativePrediction)
_Recorded = TypeVar("_Recorded", Channel, FlightChannel)


def find_recorded_excitation(channels: Sequence[RawChannel]) -> Excitation | None:
    """Find the multisine in the commands of a maneuver; None unless there is exactly one."""
    commands = [channel for channel in channels if channel.role is Role.COMMAND]
    if not commands:
        return None
    clock = commands[0].clock
    same = [channel for channel in commands if channel.clock == clock]
    samples = np.stack([np.asarray(channel.samples, dtype=float) for channel in same], axis=1)
    found = find_excitations(samples, clock.rate_hz)
    if len(found) != 1:
        return None
    names = [channel.name for channel in same]
    return build_excitation(found[0], names, clock.rate_hz, clock.start_s)


def build_excitation(
    one: ExcitedInterval, channels: Sequence[str], rate_hz: float, start_s: float
) -> Excitation | None:
    """Build the excitation of an interval; None without multisine."""
    names = [name.removesuffix(_COMMAND) for name in channels]
    harmonics = {n: own for n, own in zip(names, one.harmonics, strict=False) if own}
    if not harmonics:
        return None
    return Excitation(
        period_s=one.period / rate_hz,
        harmonics=harmonics,
        start_s=start_s + one.first / rate_hz,
        n_periods=one.n_periods,
    )


def compute_largest_correlation(inputs: Sequence[np.ndarray]) -> float | None:
    """Return the largest pairwise correlation of input time histories.

    None for fewer than two inputs, or if they have different numbers of samples.

    Parameters
    ----------
    inputs
        Samples of each input over the same interval; one that never moves counts as uncorrelated.
    """
    if len({len(samples) for samples in inputs}) > 1:
        return None
    largest = None
    for first, second in combinations([np.asarray(u, dtype=np.float64) for u in inputs], 2):
        a, b = first - first.mean(), second - second.mean()
        scale = float(np.sqrt((a @ a) * (b @ b)))
        value = abs(float(a @ b)) / scale if scale > 0 else 0.0
        largest = value if largest is None else max(largest, value)
    return largest


def correlate_inputs(
    aircraft: Aircraft, axis: str, excitation: Excitation | None, inputs: Mapping[str, np.ndarray]
) -> float | None:
    """Return the largest correlation of what a maneuver moves, by samples of what was recorded.

    Left and right surfaces that only move together, or against each other, are one input.
    """
    if len({len(samples) for samples in inputs.values()}) > 1:
        return None
    parts = list_surface_parts(aircraft)
    moved = list_moved_surfaces(aircraft, axis, excitation, inputs)
    return compute_largest_correlation(
        [
            np.sum([weight * inputs[term] for term, weight in parts[name]], axis=0)
            if name not in inputs
            else inputs[name]
            for name in moved
        ]
    )


def store_aircraft(store: Store, part: AircraftPart | None, aircraft_id: int | None) -> Aircraft:
    """Find the selected or named aircraft, or add the one defined in the mapping."""
    if aircraft_id is not None:
        aircraft = store.aircraft.get(aircraft_id)
        if part is not None and part.name != aircraft.name:
            raise BadInput(
                f"The mapping is for '{part.name}', but '{aircraft.name}' was selected.",
                code="bad-mapping",
                key="aircraft.name",
            )
        return aircraft
    if part is None:
        raise BadInput(
            "Mapping: 'aircraft' is missing; name the aircraft or select one.",
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
    if part.definition is not None and part.definition.thrust is None:
        part = replace(part, definition=replace(part.definition, thrust=known[0].thrust))
    elif part.definition is not None and known[0].thrust is None:
        known = [set_thrust_table(store, known[0].id or 0, part.definition.thrust)]
    if part.definition is not None and replace(known[0], id=None) != part.definition:
        raise Conflict(
            f"Aircraft '{part.name}' is there already with another definition; take the definition "
            "out of the mapping, or give this one another name.",
            code="already-exists",
        )
    return known[0]


def find_or_add_flight(store: Store, flight: Flight) -> Flight:
    """Find the flight of this aircraft and number, or add it."""
    known = store.flights.find(aircraft_id=flight.aircraft_id, number=flight.number)
    return known[0] if known else store.flights.add(flight)


def store_maneuver(store: Store, aircraft: Aircraft, flight: Flight, raw: RawManeuver) -> Maneuver:
    """Add a maneuver without channels; the same file gives the same maneuver only once."""
    assert aircraft.id is not None
    assert flight.id is not None
    for known in store.maneuvers.find(aircraft_id=aircraft.id, source_hash=raw.source_hash):
        if known.label == raw.cut.label:
            now = "" if known.deleted_at is None else ", and deleted since; restore it"
            raise Conflict(
                f"Maneuver '{raw.cut.label}' was imported from this file before "
                f"(maneuver {known.id}{now}).",
                code="already-imported",
                maneuver_id=known.id,
            )
    axis = determine_axis(raw.cut.axis, aircraft, [(c, c.samples) for c in raw.channels])
    complete = complete_parked_condition if axis == GROUND else complete_condition
    condition = complete(aircraft, raw.condition)
    inputs = {c.name: c.samples for c in raw.channels if c.role is Role.INPUT}
    excitation = raw.excitation or find_recorded_excitation(raw.channels)
    return store.maneuvers.add(
        Maneuver(
            aircraft_id=aircraft.id,
            flight_id=flight.id,
            label=raw.cut.label,
            start_s=raw.cut.start_s,
            duration_s=raw.cut.stop_s - raw.cut.start_s,
            condition=condition,
            fta=raw.cut.fta,
            axis=axis,
            excitation=excitation,
            airspeed_ratio=None if axis == GROUND else compute_airspeed_ratio(condition),
            max_input_correlation=correlate_inputs(aircraft, axis, excitation, inputs),
            source_file=raw.source_file,
            source_hash=raw.source_hash,
            note=raw.cut.note,
        )
    )


def _refuse_recorded(store: Store, flight: Flight, channels: Sequence[RawChannel]) -> None:
    """Refuse channels that the recording of a flight has already."""
    known = {channel.name: channel for channel in store.flight_channels.find(flight_id=flight.id)}
    for channel in channels:
        if channel.name in known:
            raise Conflict(
                f"Flight {flight.number} has a channel '{channel.name}' already, from "
                f"{known[channel.name].source_file}; give this one another name.",
                code="already-imported",
                column=channel.name,
                flight_id=flight.id,
            )


def _build_flight_channel(
    flight_id: int, chunks: Mapping[str, Chunks], **fields: Any
) -> FlightChannel:
    of_channel = chunks.get(fields["name"])
    length = None if of_channel is None else of_channel.length
    return FlightChannel(flight_id=flight_id, samples_per_chunk=length, **fields)


def _store_channels(
    store: Store,
    upload: ParsedUpload,
    repository: Repository[_Recorded],
    build: Callable[..., _Recorded],
) -> None:
    """Store the channels of an upload, some megabytes at once."""
    first = size = 0
    for last, channel in enumerate(upload.channels, start=1):
        size += channel.samples.nbytes
        if size < BYTES_AT_ONCE and last < len(upload.channels):
            continue
        some = upload.channels[first:last]
        arrays = store.arrays.put_many([upload.rows[one.name] for one in some])
        repository.add_many(
            [
                build(
                    name=one.name,
                    unit=one.unit,
                    role=one.role,
                    rate_hz=one.clock.rate_hz,
                    start_s=one.clock.start_s,
                    n_samples=one.samples.size,
                    array=array,
                    sensor=one.sensor,
                    source_file=one.source.name,
                    source_hash=one.source.sha256,
                    source_field=one.field,
                    between_samples=one.between_samples,
                )
                for one, array in zip(some, arrays, strict=True)
            ]
        )
        first, size = last, 0


def check_sensors(aircraft: Aircraft, channels: Sequence[RawChannel]) -> None:
    """Check that the aircraft has the sensor of every channel."""
    known = {sensor.name for sensor in aircraft.sensors}
    for channel in channels:
        if channel.sensor is not None and channel.sensor not in known:
            raise BadInput(
                f"Channel '{channel.name}': aircraft '{aircraft.name}' has no sensor "
                f"'{channel.sensor}'; it has {', '.join(sorted(known)) or 'none'}.",
                code="unknown-sensor",
                column=channel.name,
            )


def check_axes(aircraft: Aircraft, channels: Sequence[RawChannel]) -> None:
    """Check the axis in the name of every column against the axis of its sensor.

    Raises
    ------
    BadInput
        Naming column, channel and both axes, unless the mapping confirms it.
    """
    sensors = {sensor.name: sensor for sensor in aircraft.sensors}
    for channel in channels:
        sensor = sensors.get(channel.name)
        if sensor is None or OTHER_AXIS in channel.confirmed:
            continue
        recorded = sensor.model.find_axis(channel.field.rpartition(".")[2])
        if recorded not in (None, sensor.axis):
            raise BadInput(
                f"Column '{channel.field}' has the name of a {sensor.kind} of axis"
                f" {recorded}, but is mapped to '{channel.name}' of axis {sensor.axis}. "
                f'Correct the name; if it is right, write confirmed = ["{OTHER_AXIS}"].',
                code="unconfirmed-axis",
                column=channel.field,
                channel=channel.name,
            )


def _store_modal_table(
    store: Store, aircraft: Aircraft, part: ModalTableMapping, sources: Sources
) -> ModalTable:
    """Add a modal table, or find the same."""
    assert aircraft.id is not None
    table = ModalTable(
        aircraft_id=aircraft.id,
        name=part.name,
        kind=part.kind,
        fuel=part.fuel,
        numbers=part.numbers,
        names=part.names,
        symmetric=part.symmetric,
        points=() if part.shape is None else tuple(part.shape.points),
        gauges=() if part.strain is None else part.strain.gauges,
        arrays={n: store.arrays.put(array) for n, array in extract_modes(part, sources).items()},
        origin=part.origin,
    )
    known = store.modal_tables.find(aircraft_id=aircraft.id, name=part.name)
    return _add_once(store.modal_tables, table, known, f"Modal table '{part.name}'")


def _store_prediction(
    store: Store, aircraft: Aircraft, part: PredictionMapping, sources: Sources
) -> DerivativePrediction:
    """Add predicted derivatives, or find the same."""
    assert aircraft.id is not None
    found = extract_derivatives(part, sources, aircraft.geometry.chord_m)
    for name in found:
        parse_derivative(name)
    prediction = DerivativePrediction(
        aircraft_id=aircraft.id,
        source=part.source,
        kind=part.kind,
        fuel=part.fuel,
        names=tuple(found),
        values=store.arrays.put(np.stack(list(found.values()), axis=1)),
        note=part.note,
    )
    known = store.predictions.find(aircraft_id=aircraft.id, source=part.source)
    return _add_once(store.predictions, prediction, known, f"Prediction '{part.source}'")


def _add_once(
    repository: Repository[_Named], record: _Named, known: Sequence[_Named], what: str
) -> _Named:
    """Add a record, or return the existing one with the same content; never change one."""
    for same in known:
        if replace(same, id=None) == record:
            return same
    if known:
        raise Conflict(
            f"{what} is there already with other content; give this one another name.",
            code="already-exists",
        )
    return repository.add(record)


@dataclass(frozen=True, slots=True, kw_only=True)
class Imported:
    """Records of an import: added, or existing aircraft, tables and predictions.

    ``not_read`` names contents of the files that are not read or assumed, and why; ``repairs``
    what of the record was changed, as the mapping allows.
    """

    aircraft: Aircraft
    flight: Flight | None = None
    flight_channels: tuple[FlightChannel, ...] = ()
    maneuver: Maneuver | None = None
    modal_tables: tuple[ModalTable, ...] = ()
    predictions: tuple[DerivativePrediction, ...] = ()
    not_read: tuple[str, ...] = ()
    repairs: tuple[str, ...] = ()


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
    text = _read_text(mapping)
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


def hash_upload(
    upload: ParsedUpload, chunks: Mapping[str, Chunks] = MappingProxyType({})
) -> ParsedUpload:
    """Hash the samples of an upload, if not yet hashed, or the names of a channel's chunks."""
    rows = dict(upload.rows)
    for channel in upload.channels:
        if channel.name in chunks:
            rows[channel.name] = describe_array(chunks[channel.name].names)
        elif channel.name not in rows:
            rows[channel.name] = describe_array(channel.samples, channel.unit)
    return replace(upload, rows=rows)


def _write_chunks(recordings: Recordings | None, upload: ParsedUpload) -> dict[str, Chunks]:
    """Write the long channels of a whole flight in chunks.

    Before the transaction, which others wait for: an import that is refused leaves its chunks,
    which the corrected import finds.
    """
    if recordings is None or upload.maneuver is not None:
        return {}
    return {
        channel.name: recordings.write(channel.name, channel.samples, channel.unit)
        for channel in upload.channels
        if channel.samples.size > recordings.samples_per_chunk
    }


def store_upload(
    store: Store,
    upload: ParsedUpload,
    aircraft_id: int | None = None,
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
    chunks = _write_chunks(store.recordings, upload)
    upload = hash_upload(upload, chunks)
    mapping, sources = upload.mapping, upload.sources
    with store.transaction():
        if upload.builtin is not None and add_builtin_aircraft is not None:
            add_builtin_aircraft(store, upload.builtin)
        aircraft = store_aircraft(store, mapping.aircraft, aircraft_id)
        check_sensors(aircraft, upload.channels)
        check_axes(aircraft, upload.channels)
        check_builtin(aircraft, upload)
        flight = maneuver = None
        recorded: tuple[FlightChannel, ...] = ()
        if mapping.flight is not None and mapping.channels:
            flight = find_or_add_flight(
                store, replace(mapping.flight, aircraft_id=aircraft.id or 0)
            )
            if upload.maneuver is None:
                _refuse_recorded(store, flight, upload.channels)
                if upload.repairs:
                    noted = add_repairs(flight.description, upload.repairs)
                    flight = store.flights.replace(replace(flight, description=noted))
                build = partial(_build_flight_channel, flight.id or 0, chunks)
                _store_channels(store, upload, store.flight_channels, build)
                recorded = tuple(store.flight_channels.find(flight_id=flight.id))
            else:
                maneuver = store_maneuver(store, aircraft, flight, upload.maneuver)
                build = partial(Channel, maneuver_id=maneuver.id)
                _store_channels(store, upload, store.channels, build)
                add_shared_corrections(store, maneuver)
        tables = tuple(
            _store_modal_table(store, aircraft, part, sources) for part in mapping.modal_tables
        )
        predictions = tuple(
            _store_prediction(store, aircraft, part, sources) for part in mapping.predictions
        )
    return Imported(
        aircraft=aircraft,
        flight=flight,
        flight_channels=recorded,
        maneuver=maneuver,
        modal_tables=tables,
        predictions=predictions,
        not_read=tuple(text for file in sources.items for text in file.not_read),
        repairs=upload.repairs,
    )


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
    text = _read_text(mapping)

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
            try:
                if isinstance(upload, FlexsidError):
                    raise upload
                imported = store_upload(
                    store,
                    upload,
                    aircraft_id,
                    add_builtin_aircraft=add_builtin_aircraft,
                    confirmed=confirmed,
                )
            except FlexsidError as error:
                yield file, error
            else:
                yield file, imported


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


def _read_text(mapping: Path | str | None) -> str | None:
    if not isinstance(mapping, Path):
        return mapping
    try:
        return mapping.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise BadInput(
            f"The mapping {mapping.name} cannot be read ({error}).", code="bad-mapping"
        ) from error
