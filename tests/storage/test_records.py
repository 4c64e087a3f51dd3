"""Records and arrays are read as stored, or rejected with a message."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import fields, replace
from datetime import date

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from waiting import PATIENCE_S

from flexsid.errors import BadInput, Conflict, UnknownRecord
from flexsid.records.aircraft import Aircraft, DerivativePrediction
from flexsid.records.maneuver import Flight, Maneuver
from flexsid.records.modal_data import ModalKind, ModalTable
from flexsid.records.run import EstimationRun, Progress, RunState
from flexsid.storage.database import Database
from flexsid.storage.files import DatabaseUnavailable
from flexsid.storage.recordings import read_channels
from flexsid.storage.repository import reading_once
from flexsid.storage.store import Store


def test_every_field_has_its_column(store: Store) -> None:
    pairs = (
        (store.aircraft, Aircraft),
        (store.flights, Flight),
        (store.maneuvers, Maneuver),
        (store.modal_tables, ModalTable),
        (store.predictions, DerivativePrediction),
        (store.runs, EstimationRun),
    )
    for repository, record in pairs:
        derived = {"altered"}  # found when a run is read
        assert {f.name for f in fields(record)} - derived <= set(repository.table.c.keys())


def test_nested_records_come_back_as_they_were(store: Store, aircraft: Aircraft) -> None:
    assert aircraft.id is not None
    assert store.aircraft.get(aircraft.id) == aircraft


def test_moments_have_a_zone_and_dates_stay_dates(
    store: Store, maneuver: Maneuver, flight: Flight
) -> None:
    assert maneuver.id is not None
    created = store.maneuvers.get(maneuver.id).created_at
    assert created is not None
    assert created.utcoffset() is not None
    assert created == maneuver.created_at
    changed = store.flights.replace(replace(flight, flown_on=date(2026, 3, 1)))
    assert store.flights.find(number=1) == [changed]


def test_tables_and_predictions_name_arrays(store: Store, aircraft: Aircraft) -> None:
    assert aircraft.id is not None
    omega = store.arrays.put(np.array([[20.0, 50.0]]), "rad/s")
    table = store.modal_tables.add(
        ModalTable(
            aircraft_id=aircraft.id,
            name="FEM",
            kind=ModalKind.FEM,
            fuel=(0.5,),
            numbers=(7, 9),
            names=("SW1B", "SW1T"),
            symmetric=(True, True),
            arrays={"omega": omega},
        )
    )
    prediction = store.predictions.add(
        DerivativePrediction(
            aircraft_id=aircraft.id,
            source="panel",
            kind="panel code",
            fuel=(0.5,),
            names=("Cm_q", "Cm_bfs"),
            values=store.arrays.put(np.array([[-3.0, 0.2]])),
        )
    )
    assert store.modal_tables.find(kind=ModalKind.FEM) == [table]
    assert store.predictions.find(aircraft_id=aircraft.id) == [prediction]


def test_unknown_number_is_none_and_not_nan(
    store: Store, flight: Flight, add_maneuver: Callable[..., Maneuver]
) -> None:
    with pytest.raises(BadInput, match="None"):
        add_maneuver(airspeed_ratio=float("nan"))
    with pytest.raises(BadInput, match="None"):
        add_maneuver(fuel=float("inf"))
    assert store.maneuvers.find() == []


@pytest.mark.parametrize("identity", [0, -1, 99, 2**63, 2**200])
def test_unknown_id_is_reported(store: Store, identity: int) -> None:
    with pytest.raises(UnknownRecord, match=str(identity)):
        store.runs.get(identity)
    with pytest.raises(UnknownRecord):
        store.runs.delete(identity)


def test_a_record_is_read_once_within_one_reading(store: Store, aircraft: Aircraft) -> None:
    assert aircraft.id is not None
    with reading_once():
        first = store.aircraft.get(aircraft.id)
        with reading_once():
            assert store.aircraft.get(aircraft.id) is first
    with store.transaction():
        changed = store.aircraft.replace(replace(first, name="FLEX-29"))
    with reading_once():
        assert store.aircraft.get(aircraft.id) == changed
    assert store.aircraft.get(aircraft.id) == changed


def test_used_records_are_not_deleted_and_duplicates_are_rejected(
    store: Store, aircraft: Aircraft, flight: Flight
) -> None:
    assert aircraft.id is not None
    with pytest.raises(Conflict, match="used"):
        store.aircraft.delete(aircraft.id)
    with pytest.raises(Conflict, match="already exists"):
        store.flights.add(replace(flight, id=None))
    with pytest.raises(UnknownRecord, match="does not exist"):
        store.flights.add(Flight(aircraft_id=77, number=2))


def test_a_deleted_maneuver_takes_its_channels_and_its_id_with_it(
    store: Store, add_maneuver: Callable[..., Maneuver]
) -> None:
    first = add_maneuver()
    assert first.id is not None
    store.maneuvers.delete(first.id)
    assert store.channels.find() == []
    assert add_maneuver().id != first.id


def test_a_transaction_is_all_or_nothing(store: Store, aircraft: Aircraft) -> None:
    assert aircraft.id is not None
    names: list[str] = []

    def add_three() -> None:
        with store.transaction():
            store.flights.add(Flight(aircraft_id=1, number=1))
            names.append(store.arrays.put(np.arange(3)))
            store.flights.add(Flight(aircraft_id=77, number=1))

    with pytest.raises(UnknownRecord):
        add_three()
    assert store.flights.find() == []
    with pytest.raises(UnknownRecord):
        store.arrays.get(names[0])


def test_concurrent_writers_lose_nothing(
    store: Store, add_run: Callable[..., EstimationRun]
) -> None:
    run = add_run()
    assert run.id is not None
    failures: list[Exception] = []

    def count() -> None:
        try:
            for _ in range(20):
                with store.transaction():
                    assert run.id is not None
                    now = store.runs.get(run.id)
                    store.runs.replace(replace(now, attempt=now.attempt + 1))
        except Exception as error:
            failures.append(error)

    threads = [threading.Thread(target=count) for _ in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert failures == []
    assert store.runs.get(run.id).attempt == 120


def test_a_reader_is_not_held_up_by_a_writer(store: Store, aircraft: Aircraft) -> None:
    seen: list[int] = []
    with store.transaction():
        store.flights.add(Flight(aircraft_id=1, number=1))
        reader = threading.Thread(target=lambda: seen.append(len(store.flights.find())))
        reader.start()
        reader.join(timeout=PATIENCE_S)
    assert seen == [0]


def test_optional_values_come_back(store: Store, add_run: Callable[..., EstimationRun]) -> None:
    run = add_run(progress=Progress(iteration=3, cost=-1.5), state=RunState.RUNNING)
    assert run.id is not None
    assert store.runs.get(run.id) == run
    assert store.runs.find(state=RunState.RUNNING, structure_id=None) == [run]


@settings(max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    dtype=st.sampled_from(["?", "i2", ">i4", "u1", "f4", ">f8", "c8", "c16"]),
    shape=st.lists(st.integers(0, 4), max_size=3),
)
def test_arrays_come_back_bit_by_bit(store: Store, dtype: str, shape: list[int]) -> None:
    array = (np.arange(np.prod(shape, dtype=int)) * 1.7).reshape(shape).astype(dtype)
    name = store.arrays.put(array)
    back = store.arrays.get(name)
    assert back.dtype == array.dtype.newbyteorder("<")
    assert back.shape == array.shape
    np.testing.assert_array_equal(back, array)
    assert not back.flags.writeable


def test_equal_arrays_with_equal_units_are_stored_once(store: Store) -> None:
    samples = np.arange(6.0)
    name = store.arrays.put(samples, "deg")
    assert store.arrays.put(samples[::-1][::-1], "deg") == name
    assert store.arrays.put(samples, "rad") != name
    assert store.arrays.put(samples.reshape(2, 3), "deg") != name
    with pytest.raises(BadInput):
        store.arrays.put(np.array(["text"]))


def test_get_many_names_what_is_missing(store: Store) -> None:
    names = [store.arrays.put(np.array(i)) for i in range(700)]
    assert len(store.arrays.get_many(names)) == 700
    with pytest.raises(UnknownRecord, match="nothing"):
        store.arrays.get_many([names[0], "nothing"])


@pytest.mark.parametrize(
    "url",
    ["nonsense", "sqlite://", "sqlite:///:memory:", "klingon:///a.db", "mysql://host/flexsid"],
)
def test_invalid_address_is_rejected(url: str) -> None:
    with pytest.raises(BadInput):
        Database(url)


def test_database_that_cannot_be_opened_is_reported(tmp_path) -> None:
    (tmp_path / "file").write_text("not a folder")
    with pytest.raises(DatabaseUnavailable):
        Database(f"sqlite:///{tmp_path}/file/flexsid.db")


def test_channels_of_a_maneuver_are_read_with_their_samples(
    store: Store, maneuver: Maneuver
) -> None:
    assert maneuver.id is not None
    found = read_channels(store.database, maneuver.id)
    assert [channel for channel, _ in found.values()] == store.channels.find(maneuver_id=1)
    for name, (channel, samples) in found.items():
        assert channel.name == name
        np.testing.assert_array_equal(samples, store.arrays.get(channel.array))
        assert samples.dtype == np.float32
    assert list(read_channels(store.database, maneuver.id, ["q", "r", "q"])) == ["q"]
    assert read_channels(store.database, maneuver.id, []) == {}
    assert read_channels(store.database, 99) == {}
