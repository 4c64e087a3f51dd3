"""Recordings of whole flights in chunks outside the database."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import fsspec
import numpy as np
import pyarrow.parquet as pq
import pytest
import sqlalchemy as sa
from hypothesis import given
from hypothesis import strategies as st

from flexsid.errors import BadInput
from flexsid.records.maneuver import Cut
from flexsid.settings import read_settings
from flexsid.storage.access import count_recorded_bytes
from flexsid.storage.arrays import DamagedData
from flexsid.storage.copies.backup import backup
from flexsid.storage.files import DatabaseUnavailable
from flexsid.storage.recordings import Chunks, Recordings
from flexsid.storage.store import Store
from flexsid.storage.tables import arrays
from flexsid.workflow.importing.flight_import import read_upload, store_upload
from flexsid.workflow.importing.maneuver_cutting import (
    cut_maneuver,
    find_maneuvers,
    read_flight_history,
)
from flexsid.workflow.maintenance.database import check_database

N_SAMPLES = 6000
RATE_HZ = 50.0
LENGTH = 1024

MAPPING = """
[aircraft]
name = "X-1"

[flight]
number = 7

[time]
rate = { value = 50, unit = "Hz" }

[[channels]]
column = "elevator"
name = "bfs"
role = "input"
unit = "rad"

[[channels]]
column = "q"
name = "q"
role = "output"
unit = "rad/s"

[[channels]]
column = "v"
name = "airspeed"
role = "condition"
unit = "m/s"

[[channels]]
column = "h"
name = "altitude"
role = "condition"
unit = "m"

[[channels]]
column = "f"
name = "fuel_fraction"
role = "condition"
unit = "1"
"""


@pytest.fixture(params=["file", "memory"])
def url(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[str]:
    """Address of a folder on the disk, or of an object store in memory."""
    if request.param == "file":
        yield f"file://{tmp_path}/recordings"
        return
    yield "memory://recordings"
    fsspec.filesystem("memory").rm("/recordings", recursive=True)


@pytest.fixture
def recordings(url: str) -> Recordings:
    return Recordings(url, samples_per_chunk=LENGTH)


def test_the_chunks_of_a_channel_are_parquet_files_for_other_programs(
    recordings: Recordings, url: str
):
    samples = np.linspace(0.0, 1.0, 2500, dtype=np.float32)
    chunks = recordings.write("az_egi", samples, "g")
    assert chunks.names.shape == (3, 32)
    files, root = fsspec.core.url_to_fs(url)
    first = chunks.names[0].tobytes().hex()
    with files.open(f"{root}/{first[:2]}/{first}.parquet", "rb") as file:
        table = pq.read_table(file)
    assert table.column_names == ["az_egi"]
    assert table.schema.field(0).metadata == {b"unit": b"g"}
    assert np.array_equal(table.column(0).to_numpy(), samples[:LENGTH])


@pytest.mark.parametrize("dtype", ["f4", "f8", "i2", "u1", "?"])
def test_any_type_of_samples_returns_unchanged(recordings: Recordings, dtype: str):
    samples = (np.arange(2 * LENGTH) % 7).astype(dtype)
    chunks = recordings.write("x", samples, "")
    found = recordings.read(chunks, slice(0, samples.size))
    assert found.dtype == samples.dtype
    assert np.array_equal(found, samples)


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> tuple[Recordings, np.ndarray, Chunks]:
    folder = tmp_path_factory.mktemp("recordings")
    recordings = Recordings(f"file://{folder}", samples_per_chunk=100)
    samples = np.random.default_rng(1).normal(size=1000)
    return recordings, samples, recordings.write("x", samples, "rad")


@given(st.tuples(st.integers(0, 1000), st.integers(0, 1000)))
def test_every_window_is_that_of_the_samples(
    written: tuple[Recordings, np.ndarray, Chunks], ends: tuple[int, int]
):
    recordings, samples, chunks = written
    window = slice(min(ends), max(ends))
    found = recordings.read(chunks, window)
    assert found.dtype == samples.dtype
    assert np.array_equal(found, samples[window])


def test_what_was_damaged_is_written_again(recordings: Recordings, url: str):
    samples = np.arange(2.0 * LENGTH)
    chunks = recordings.write("x", samples, "")
    _change_a_byte(url, chunks.names[1])
    with pytest.raises(DamagedData, match="does not match its name"):
        recordings.read(chunks, slice(0, samples.size))
    assert np.array_equal(recordings.read(chunks, slice(0, LENGTH)), samples[:LENGTH])
    assert np.array_equal(recordings.write("x", samples, "").names, chunks.names)
    assert np.array_equal(recordings.read(chunks, slice(0, samples.size)), samples)


@pytest.mark.parametrize("address", ["nosuchstore://x", "s3x://bucket"])
def test_an_address_of_no_known_form_is_refused(address: str):
    with pytest.raises(BadInput, match="FLEXSID_RECORDINGS is no address"):
        Recordings(address)


def test_a_file_system_without_its_package_is_refused():
    fsspec.register_implementation("absent", "no_such_package.Files", errtxt="Install no_such")
    with pytest.raises(BadInput, match=r"\(Install no_such\); install 'flexsid\[recordings\]'"):
        Recordings("absent://x")


def test_the_address_is_a_setting():
    assert read_settings({"FLEXSID_RECORDINGS": "file:///srv/x"}).recordings == "file:///srv/x"
    assert read_settings({}).recordings is None


@pytest.fixture
def flown_file(tmp_path: Path) -> Path:
    """A recording of two minutes with one sweep of the elevator."""
    time_s = np.arange(N_SAMPLES) / RATE_HZ
    inside = (time_s > 60.0) & (time_s < 84.0)
    elevator = np.where(inside, 0.02 * np.sin(2.0 * (time_s - 60.0)), 0.0)
    file = tmp_path / "flight.npz"
    columns = {"elevator": elevator, "q": np.cumsum(elevator) / RATE_HZ}
    levels = {"v": 20.0, "h": 500.0, "f": 0.5}
    columns |= {name: np.full(N_SAMPLES, level) for name, level in levels.items()}
    np.savez(file, **columns)  # pyrefly: ignore[bad-argument-type]
    return file


def _import(store: Store, recordings: Recordings | None, file: Path) -> int:
    store.recordings = recordings
    imported = store_upload(store, read_upload([file], MAPPING), 1, confirmed=True)
    assert imported.flight is not None
    assert imported.flight.id is not None
    return imported.flight.id


def _change_a_byte(url: str, name: np.ndarray) -> None:
    files, root = fsspec.core.url_to_fs(url)
    path = f"{root}/{name.tobytes().hex()[:2]}/{name.tobytes().hex()}.parquet"
    content = bytearray(files.cat_file(path))
    content[len(content) // 2] ^= 1
    files.pipe_file(path, bytes(content))


@pytest.mark.usefixtures("aircraft")
def test_a_flight_in_chunks_is_cut_like_one_in_the_database(
    store: Store, recordings: Recordings, flown_file: Path, tmp_path: Path, url: str
):
    flight_id = _import(store, recordings, flown_file)
    channels = store.flight_channels.find(flight_id=flight_id)
    assert {channel.samples_per_chunk for channel in channels} == {LENGTH}
    (found,) = find_maneuvers(store, flight_id)
    cut = Cut(label="in chunks", start_s=found.start_s, stop_s=found.stop_s)
    stored = cut_maneuver(store, flight_id, cut)
    history = read_flight_history(store, flight_id, ("q",), 70.0, 71.0)
    assert history.traces[0].values.size == 50

    # The same flight in the database: the same maneuver, to the last bit.
    for channel in channels:
        assert channel.id is not None
        store.flight_channels.delete(channel.id)
    assert _import(store, None, flown_file) == flight_id
    again = cut_maneuver(store, flight_id, replace(cut, label="in the database"))
    for one, other in zip(
        store.channels.find(maneuver_id=stored.id),
        store.channels.find(maneuver_id=again.id),
        strict=True,
    ):
        assert (one.name, one.array, one.start_s) == (other.name, other.array, other.start_s)
    assert again.excitation == stored.excitation
    assert again.condition == stored.condition


@pytest.mark.usefixtures("aircraft")
def test_damage_and_absence_of_chunks_are_named(
    store: Store, recordings: Recordings, flown_file: Path, url: str
):
    flight_id = _import(store, recordings, flown_file)
    assert not [one for one in check_database(store) if one.is_damage]
    with store.database.reading() as connection:
        # Five channels of float64, and the names of their six chunks.
        assert count_recorded_bytes(connection, 1) == 5 * (8 * N_SAMPLES + 6 * 32)
    channel = next(c for c in store.flight_channels.find(flight_id=flight_id) if c.name == "q")
    names = store.arrays.get(channel.array)
    _change_a_byte(url, names[3])
    (damage,) = [one for one in check_database(store) if one.is_damage]
    assert damage.record == f"channel 'q' of flight {flight_id}"
    assert re.search(r"chunk .*\.parquet of a recording is damaged", damage.text)

    store.recordings = None
    (note,) = [one for one in check_database(store) if one.code == "unchecked-recordings"]
    assert not note.is_damage
    with pytest.raises(DatabaseUnavailable, match="set FLEXSID_RECORDINGS"):
        find_maneuvers(store, flight_id)


@pytest.mark.usefixtures("aircraft")
def test_damaged_names_of_chunks_are_found_by_the_check(
    store: Store, recordings: Recordings, flown_file: Path
):
    flight_id = _import(store, recordings, flown_file)
    channel = next(c for c in store.flight_channels.find(flight_id=flight_id) if c.name == "q")
    with store.database.transaction() as connection:
        damaged = sa.update(arrays).where(arrays.c.hash == channel.array)
        connection.execute(damaged.values(data=bytes(6 * 32)))
    (damage,) = [one for one in check_database(store) if one.is_damage]
    assert damage.record == f"channel 'q' of flight {flight_id}"
    with pytest.raises(DamagedData):
        cut_maneuver(store, flight_id, Cut(label="x", start_s=55.0, stop_s=90.0))


@pytest.mark.usefixtures("aircraft")
def test_a_backup_has_the_names_of_the_chunks(
    store: Store, recordings: Recordings, flown_file: Path, tmp_path: Path
):
    flight_id = _import(store, recordings, flown_file)
    copy = tmp_path / "copy.db"
    backup(str(store.database.url), copy)
    restored = Store.open(f"sqlite:///{copy}")
    restored.recordings = recordings
    assert len(find_maneuvers(restored, flight_id)) == 1
    restored.close()
