"""Storage of the records of an import, within its transaction."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Any, TypeVar

import numpy as np

from flexsid.errors import BadInput, Conflict, UnknownRecord
from flexsid.importers.aircraft import AircraftPart
from flexsid.importers.channels import RawChannel
from flexsid.importers.maneuver import FlightPart, RawManeuver
from flexsid.importers.modal_table import RawModalTable
from flexsid.importers.plausibility import OTHER_AXIS
from flexsid.importers.predictions import RawPrediction
from flexsid.records.aircraft import Aircraft
from flexsid.records.axes import find_axis_in_name
from flexsid.records.flight import Flight, FlightChannel
from flexsid.records.maneuver import GROUND, Channel, Maneuver, Role
from flexsid.records.modal_table import ModalTable
from flexsid.records.prediction import DerivativePrediction
from flexsid.storage.arrays import ArrayRow
from flexsid.storage.repository import Repository
from flexsid.storage.store import Store
from flexsid.sysid.model.derivatives import Derivative
from flexsid.workflow.aircraft.flight_condition import (
    complete_condition,
    complete_parked_condition,
    compute_airspeed_ratio,
)
from flexsid.workflow.aircraft.thrust import set_thrust_table
from flexsid.workflow.importing.recorded_excitation import find_recorded_excitation
from flexsid.workflow.measurements.symmetric_motion import determine_axis

BYTES_AT_ONCE = 16 * 1024**2
"""Samples written by one statement."""

_Named = TypeVar("_Named", ModalTable, DerivativePrediction)


def compute_largest_correlation(inputs: Sequence[np.ndarray]) -> float | None:
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


def store_flight(store: Store, aircraft: Aircraft, part: FlightPart) -> Flight:
    """Find a flight by its number, or add it."""
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


def store_maneuver(
    store: Store, aircraft: Aircraft, flight: Flight, raw: RawManeuver, writing: Writing
) -> Maneuver:
    """Add a maneuver with its channels; the same file gives the same maneuver only once."""
    assert aircraft.id is not None
    assert flight.id is not None
    for known in store.maneuvers.find(aircraft_id=aircraft.id, source_hash=raw.source_hash):
        if known.label == raw.label:
            now = "" if known.deleted_at is None else ", and deleted since; restore it"
            raise Conflict(
                f"Maneuver '{raw.label}' was imported from this file before "
                f"(maneuver {known.id}{now}).",
                code="already-imported",
                maneuver_id=known.id,
            )
    axis = determine_axis(raw.axis, aircraft, [(c, c.samples) for c in raw.channels])
    complete = complete_parked_condition if axis == GROUND else complete_condition
    condition = complete(aircraft, raw.condition)
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
            axis=axis,
            excitation=raw.excitation or find_recorded_excitation(raw.channels),
            airspeed_ratio=None if axis == GROUND else compute_airspeed_ratio(condition),
            max_input_correlation=compute_largest_correlation(inputs),
            source_file=raw.source_file,
            source_hash=raw.source_hash,
            note=raw.note,
        )
    )
    assert maneuver.id is not None
    for some in writing.over(raw.channels):
        rows = [
            Channel(**row, maneuver_id=maneuver.id) for row in _store_samples(store, some, writing)
        ]
        store.channels.add_many(rows)
    return maneuver


def store_recording(
    store: Store, flight: Flight, channels: Sequence[RawChannel], writing: Writing
) -> tuple[FlightChannel, ...]:
    """Add channels to the recording of a flight."""
    assert flight.id is not None
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
    for some in writing.over(channels):
        rows = [
            FlightChannel(**row, flight_id=flight.id)
            for row in _store_samples(store, some, writing)
        ]
        store.flight_channels.add_many(rows)
    return tuple(store.flight_channels.find(flight_id=flight.id))


def _store_samples(
    store: Store, channels: Sequence[RawChannel], writing: Writing
) -> list[dict[str, Any]]:
    """Store samples; return the fields common to channels of maneuvers and flights."""
    arrays = store.arrays.put_many([writing.rows[channel.name] for channel in channels])
    return [
        {
            "name": channel.name,
            "unit": channel.unit,
            "role": channel.role,
            "rate_hz": channel.clock.rate_hz,
            "start_s": channel.clock.start_s,
            "n_samples": channel.samples.size,
            "array": array,
            "sensor": channel.sensor,
            "source_file": channel.source.name,
            "source_hash": channel.source.sha256,
            "source_field": channel.field,
        }
        for channel, array in zip(channels, arrays, strict=True)
    ]


@dataclass(frozen=True, slots=True)
class Writing:
    """Divides channels into parts of some megabytes and reports the fraction written.

    ``rows`` are the samples of every channel, by its name.
    """

    rows: Mapping[str, ArrayRow]
    report: Callable[[float], None]

    def over(self, channels: Sequence[RawChannel]) -> Iterator[Sequence[RawChannel]]:
        """Yield the channels in parts."""
        first = size = 0
        for last, channel in enumerate(channels, start=1):
            size += channel.samples.nbytes
            if size >= BYTES_AT_ONCE or last == len(channels):
                yield channels[first:last]
                self.report(last / len(channels))
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
        recorded = find_axis_in_name(sensor.kind, channel.field.rpartition(".")[2])
        if recorded not in (None, sensor.axis):
            raise BadInput(
                f"Column '{channel.field}' has the name of a {sensor.kind.value} of axis"
                f" {recorded}, but is mapped to '{channel.name}' of axis {sensor.axis}. "
                f'Correct the name; if it is right, write confirmed = ["{OTHER_AXIS}"].',
                code="unconfirmed-axis",
                column=channel.field,
                channel=channel.name,
            )


def store_modal_table(store: Store, aircraft: Aircraft, raw: RawModalTable) -> ModalTable:
    """Add a modal table, or find the same."""
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
    return _add_once(store.modal_tables, table, known, f"Modal table '{raw.name}'")


def store_prediction(store: Store, aircraft: Aircraft, raw: RawPrediction) -> DerivativePrediction:
    """Add predicted derivatives, or find the same."""
    assert aircraft.id is not None
    for name in raw.names:
        Derivative.parse(name)
    prediction = DerivativePrediction(
        aircraft_id=aircraft.id,
        source=raw.source,
        kind=raw.kind,
        fuel=raw.fuel,
        names=raw.names,
        values=store.arrays.put(raw.values),
        note=raw.note,
    )
    known = store.predictions.find(aircraft_id=aircraft.id, source=raw.source)
    return _add_once(store.predictions, prediction, known, f"Prediction '{raw.source}'")


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
