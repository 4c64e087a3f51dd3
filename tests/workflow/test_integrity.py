"""Damage and later changes of stored data are detected when a result is read."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import pytest
import sqlalchemy as sa

from flexsid.records.maneuver import ConditioningStep, Correction, StepKind
from flexsid.records.run import EstimationRun
from flexsid.storage.arrays import DamagedData, describe_array
from flexsid.storage.content import find_changes
from flexsid.storage.jobs import queue
from flexsid.storage.recordings import read_channels
from flexsid.storage.store import Store
from flexsid.storage.tables import aircraft, arrays, channels, maneuvers, predictions, runs
from flexsid.workflow.maintenance.database import check_database
from flexsid.workflow.runs import estimation


@pytest.fixture
def flown(flown_url: str) -> Iterator[Store]:
    store = Store.open(flown_url)
    yield store
    store.close()


def _damage(store: Store, name: str) -> None:
    """Change one byte of an array."""
    with store.database.transaction() as connection:
        data = bytearray(
            connection.execute(sa.select(arrays.c.data).where(arrays.c.hash == name)).scalar_one()
        )
        data[5] ^= 1
        this = sa.update(arrays).where(arrays.c.hash == name)
        connection.execute(this.values(data=bytes(data)))


def test_damaged_samples_are_refused(flown: Store) -> None:
    (channel,) = flown.channels.find(maneuver_id=1, name="q")
    _damage(flown, channel.array)
    with pytest.raises(DamagedData, match="channel 'q' of maneuver 1") as refused:
        estimation.prepare(flown, flown.runs.get(1))
    assert refused.value.code == "damaged-data"


def test_samples_without_a_checksum_are_compared_with_their_hash(flown: Store) -> None:
    (channel,) = flown.channels.find(maneuver_id=1, name="q")
    with flown.database.transaction() as connection:
        connection.execute(sa.update(arrays).values(checksum=None))  # of earlier versions
    assert "q" in read_channels(flown.database, 1)
    _damage(flown, channel.array)
    with pytest.raises(DamagedData):
        read_channels(flown.database, 1)


def test_damaged_checksums_of_intact_samples_are_noted(flown: Store) -> None:
    (channel,) = flown.channels.find(maneuver_id=1, name="q")
    this = sa.update(arrays).where(arrays.c.hash == channel.array)
    with flown.database.transaction() as connection:
        connection.execute(this.values(checksum=bytes(8)))
    assert "q" in read_channels(flown.database, 1)
    (note,) = check_database(flown)
    assert (note.code, note.is_damage) == ("damaged-checksum", False)
    assert note.record == "channel 'q' of maneuver 1"


def test_altered_samples_with_their_checksum_are_found_by_the_check(flown: Store) -> None:
    (channel,) = flown.channels.find(maneuver_id=1, name="q")
    altered = describe_array(2.0 * flown.arrays.get(channel.array), channel.unit)
    this = sa.update(arrays).where(arrays.c.hash == channel.array)
    with flown.database.transaction() as connection:
        values = {"data": bytes(altered["data"]), "checksum": altered["checksum"]}
        connection.execute(this.values(values))
    (damage,) = check_database(flown)
    assert (damage.code, damage.record) == ("damaged-data", "channel 'q' of maneuver 1")


def test_error_of_a_damaged_covariance_has_its_run(flown: Store) -> None:
    result = flown.runs.get(1).result
    assert result is not None
    _damage(flown, result.covariance)
    with pytest.raises(DamagedData, match="run 1"):
        flown.arrays.get(result.covariance)


def _alter(store: Store, run: EstimationRun) -> None:
    """Multiply the first parameter of a result by three in the database."""
    result = store.runs.encode_field("result", run.result)
    result["parameters"][0]["value"] *= 3.0
    with store.database.transaction() as connection:
        connection.execute(sa.update(runs).where(runs.c.id == run.id).values(result=result))


def test_altered_result_is_detected_on_read(flown: Store) -> None:
    run = flown.runs.get(1)
    assert run.result_hash is not None
    assert not run.altered
    _alter(flown, run)
    assert flown.runs.get(1).altered


def test_altered_request_is_detected_on_read(flown: Store) -> None:
    run = flown.runs.get(1)
    flown.runs.replace(replace(run, structure=replace(run.structure, modes=(7,))))
    assert flown.runs.get(1).altered


def test_run_lists_data_corrected_since(flown: Store) -> None:
    run = flown.runs.get(1)
    assert run.rests_on is not None
    assert {"maneuver 1", "aircraft 1"} <= set(run.rests_on)
    assert find_changes(flown.database, [run.rests_on, None]) == [(), ()]
    taken = Correction(channel="q", kind=StepKind.CALIBRATION, scale=1.1)
    step = flown.conditioning.add(ConditioningStep(maneuver_id=1, channel="q", correction=taken))
    assert find_changes(flown.database, [run.rests_on]) == [("maneuver 1",)]
    assert step.id is not None
    flown.conditioning.delete(step.id)
    assert find_changes(flown.database, [run.rests_on]) == [()]


_NEXT_UP = {"rate_hz": math.nextafter(50.0, 60.0), "start_s": 5e-324}


@pytest.mark.parametrize(
    ("table", "values"),
    [
        *((channels, {name: value}) for name, value in _NEXT_UP.items()),
        (channels, {"unit": "it's\\n"}),
        (channels, {"sensor": "other"}),
        (maneuvers, {"condition": {"airspeed_m_s": 0.1 + 0.2}}),
        (predictions, {"source": "other"}),
        (aircraft, {"name": "other"}),
    ],
    ids=lambda value: "" if isinstance(value, dict) else value.name,
)
def test_every_change_of_an_input_is_found_and_its_reversal(
    flown: Store, table: sa.Table, values: dict[str, Any]
) -> None:
    run = flown.runs.get(1)
    first = sa.select(sa.func.min(table.c.id)).scalar_subquery()
    columns = [table.c[name] for name in values]
    with flown.database.reading() as connection:
        before = connection.execute(sa.select(*columns).where(table.c.id == first)).one()
    for after, is_changed in ((values, True), (dict(before._mapping), False), (values, True)):
        with flown.database.transaction() as connection:
            identity = connection.scalar(sa.select(first))
            connection.execute(sa.update(table).where(table.c.id == identity).values(after))
        (changed,) = find_changes(flown.database, [run.rests_on])
        assert bool(changed) == is_changed


def test_run_uses_data_corrected_before_computation(flown: Store) -> None:
    before = flown.runs.get(1)
    asked = EstimationRun(
        maneuver_id=1,
        method=before.method,
        structure=before.structure,
        settings=before.settings,
        data_hash="of what was asked for",
        input_hash="of it with other data",
    )
    claimed = queue.claim(flown, queue.add(flown, asked).id)
    assert claimed is not None
    run = flown.runs.get(claimed.id or 0)
    assert run.id is not None
    computed = estimation.compute_run(estimation.prepare(flown, run), lambda progress: None)
    done = estimation.store_result(flown, run.id, run.attempt, computed)
    assert done.rests_on == before.rests_on
    assert done.data_hash == before.data_hash
    assert done.input_hash not in (None, asked.input_hash)
