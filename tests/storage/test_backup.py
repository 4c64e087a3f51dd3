"""A backup is a consistent copy of a database in use, and is restored completely."""

from __future__ import annotations

import os
import shutil
import sqlite3
import threading
import time
from collections.abc import Callable
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import psycopg
import pytest
import sqlalchemy as sa
from postgresql import Cluster

from flexsid.errors import BadInput, Conflict
from flexsid.records.aircraft import Aircraft
from flexsid.records.maneuver import Flight
from flexsid.records.run import EstimationRun, RunState
from flexsid.storage import rows as row_copy
from flexsid.storage.copies import backup as copies
from flexsid.storage.copies import shared_samples
from flexsid.storage.copies.shared_samples import PARTS, SAMPLES
from flexsid.storage.database import make_engine, parse_url
from flexsid.storage.files import DatabaseUnavailable
from flexsid.storage.jobs import leases, queue
from flexsid.storage.store import Store
from flexsid.storage.tables import arrays, metadata
from flexsid.workflow.maintenance.database import check_database

_LONG = pytest.mark.long
_INTO_THE_OTHER = pytest.mark.parametrize(
    ("backend", "target"),
    [
        ("sqlite", "postgresql"),
        ("postgresql", "sqlite"),
        pytest.param("sqlite", "sqlite", marks=_LONG),
        pytest.param("postgresql", "postgresql", marks=_LONG),
    ],
)
_SAMPLES_IN_A_FILE = pytest.mark.parametrize(
    "backend", ["sqlite", pytest.param("postgresql", marks=_LONG)]
)
"""Samples of incremental backups are in a file of SQLite, whatever the database."""


def test_backup_during_writes_is_consistent(
    database_url: str, store: Store, aircraft: Aircraft, tmp_path: Path
) -> None:
    assert aircraft.id is not None
    stop = threading.Event()

    def write() -> None:
        number = 0
        while not stop.is_set():
            with store.transaction():  # always in pairs
                for _ in range(2):
                    number += 1
                    store.flights.add(Flight(aircraft_id=1, number=number))

    writer = threading.Thread(target=write)
    writer.start()
    try:
        for k in range(5):
            assert copies.backup(database_url, tmp_path / f"copy-{k}") > 0
    finally:
        stop.set()
        writer.join()
    for k in range(5):
        copy = Store.open(f"sqlite:///{tmp_path}/copy-{k}")
        assert len(copy.flights.find()) % 2 == 0
        assert copy.aircraft.find() == [aircraft]
        copy.close()
    assert {file.name for file in tmp_path.glob("copy*")} == {f"copy-{k}" for k in range(5)}


@pytest.mark.parametrize("page_size", [4096, 32768])
def test_restore_returns_the_backup_and_copies_the_previous_database(
    database_url: str,
    store: Store,
    aircraft: Aircraft,
    add_run: Callable[..., EstimationRun],
    tmp_path: Path,
    page_size: int,
) -> None:
    waiting, running = add_run(), add_run()
    lease = leases.take(store, leases.read(store), "before")
    assert lease is not None
    queue.claim(store, running.id, process_id="another server")
    copy = tmp_path / "copy"
    copies.backup(database_url, copy)
    with closing(sqlite3.connect(copy)) as older:  # as made by an older release
        older.execute("PRAGMA journal_mode = DELETE")
        older.execute(f"PRAGMA page_size = {page_size}")
        older.execute("VACUUM")
    lost = store.aircraft.add(_rename(aircraft, "later"))
    previous = copies.restore(database_url, copy)
    # The same server continues with the restored database.
    assert store.aircraft.find() == [aircraft]
    assert {r.id: r.state for r in store.runs.find()} == {
        waiting.id: RunState.QUEUED,
        running.id: RunState.RUNNING,
    }
    store.aircraft.add(_rename(aircraft, "after"))
    # The holder of the lease detects the restore.
    assert leases.renew(store, lease, {}) is None
    assert leases.read(store).holder is None
    assert leases.read(store).epoch > lease.epoch
    # The running run has no process, so that the next holder queues it again.
    assert queue.requeue_orphans(store, lambda process_id: process_id is None) == 1
    assert previous is not None
    before = Store.open(f"sqlite:///{previous}")
    assert before.aircraft.find() == [aircraft, lost]
    before.close()


def test_ids_given_after_a_backup_are_not_given_again(
    database_url: str, store: Store, aircraft: Aircraft, tmp_path: Path
) -> None:
    copies.backup(database_url, tmp_path / "copy")
    later = store.aircraft.add(_rename(aircraft, "later"))
    flight = store.flights.add(Flight(aircraft_id=1, number=1))  # the first one of all
    copies.restore(database_url, tmp_path / "copy")
    assert (store.aircraft.add(_rename(aircraft, "after")).id or 0) > (later.id or 0)
    assert (store.flights.add(Flight(aircraft_id=1, number=1)).id or 0) > (flight.id or 0)


def test_backup_is_restored_without_a_database(
    database_url: str, aircraft: Aircraft, tmp_path: Path
) -> None:
    copies.backup(database_url, tmp_path / "copy")
    assert copies.restore(f"sqlite:///{tmp_path}/new.db", tmp_path / "copy") is None
    restored = Store.open(f"sqlite:///{tmp_path}/new.db")
    assert restored.aircraft.find() == [aircraft]
    restored.close()


def test_invalid_backup_changes_nothing(
    database_url: str, store: Store, aircraft: Aircraft, tmp_path: Path
) -> None:
    copy = tmp_path / "copy"
    copies.backup(database_url, copy)
    with pytest.raises(Conflict, match="new file"):
        copies.backup(database_url, copy)
    damaged = bytearray(copy.read_bytes())
    page = 32768
    middle = len(damaged) // 2 // page * page
    damaged[middle : middle + page] = b"\x5a" * page
    (tmp_path / "damaged").write_bytes(damaged)
    (tmp_path / "short").write_bytes(copy.read_bytes()[:20_000])
    (tmp_path / "text").write_text("no database " * 500)
    with closing(sqlite3.connect(tmp_path / "foreign")) as foreign:
        foreign.execute("CREATE TABLE t (x)")
    for name in ("damaged", "short", "text", "foreign", "missing"):
        with pytest.raises(BadInput, match=name):
            copies.restore(database_url, tmp_path / name)
    assert store.aircraft.find() == [aircraft]
    assert list(tmp_path.glob("*.before-restore-*")) == []


@_INTO_THE_OTHER
def test_every_row_is_restored_into_either_kind_of_database(
    flown_url: str, tmp_path: Path, postgresql: Cluster, target: str
) -> None:
    copy = tmp_path / "copy"
    copies.backup(flown_url, copy)
    rows = _read_rows(flown_url)
    assert {"arrays", "maneuvers", "runs"} <= {name for name, found in rows.items() if found}
    assert _read_rows(f"sqlite:///{copy}") == rows
    name = postgresql.copy("empty")
    url = postgresql.url(name) if target == "postgresql" else f"sqlite:///{tmp_path}/new.db"
    try:
        copies.restore(url, copy)
        assert _read_rows(url) == rows
        restored = Store.open(url)
        assert [one for one in check_database(restored) if one.is_damage] == []
        restored.close()
    finally:
        postgresql.drop(name)


@_INTO_THE_OTHER
def test_an_incremental_backup_writes_new_samples_only_and_is_restored_completely(
    flown_url: str, tmp_path: Path, postgresql: Cluster, target: str
) -> None:
    folder = tmp_path / "backups"
    folder.mkdir()
    rows = _read_rows(flown_url)
    n_bytes = sum(row[4] for row in rows["arrays"])  # type: ignore[misc]
    first, second = (_back_up(flown_url, folder / f"scheduled-{k}.db") for k in (1, 2))
    assert first > n_bytes
    assert second == (folder / "scheduled-2.db").stat().st_size < first - n_bytes + 1
    name = postgresql.copy("empty")
    url = postgresql.url(name) if target == "postgresql" else f"sqlite:///{tmp_path}/new.db"
    try:
        for k in (1, 2):
            copies.restore(url, folder / f"scheduled-{k}.db")
            assert _read_rows(url) == rows
        restored = Store.open(url)
        assert [one for one in check_database(restored) if one.is_damage] == []
        restored.close()
    finally:
        postgresql.drop(name)


@_SAMPLES_IN_A_FILE
def test_damaged_samples_of_incremental_backups_are_written_again(
    flown_url: str, tmp_path: Path
) -> None:
    folder = tmp_path / "backups"
    folder.mkdir()
    _back_up(flown_url, folder / "scheduled-1.db")
    with closing(sqlite3.connect(folder / SAMPLES)) as samples, samples:
        samples.execute("UPDATE arrays SET data = zeroblob(length(data)) WHERE rowid = 1")
        samples.execute("UPDATE arrays SET shape = '[' WHERE rowid = 2")
        samples.execute("DELETE FROM arrays WHERE rowid = 3")
    assert len(copies.find_damaged(folder / "scheduled-1.db")) == 2, "the shape is in the backup"
    for _ in range(PARTS):  # each compares a part of the samples
        copies.back_up_incrementally(flown_url, folder / "scheduled-2.db")
        (folder / "scheduled-2.db").rename(folder / "scheduled-1.db")
    assert copies.find_damaged(folder / "scheduled-1.db") == []
    (folder / SAMPLES).write_bytes(b"no database" * 9000)
    with pytest.raises(DatabaseUnavailable, match="move it away"):
        _back_up(flown_url, folder / "scheduled-3.db")
    with pytest.raises(DatabaseUnavailable, match=r"scheduled-1.db cannot be read"):
        copies.restore(flown_url, folder / "scheduled-1.db")
    copies.backup(flown_url, tmp_path / "copy")
    shutil.copy(folder / SAMPLES, tmp_path)
    assert copies.find_damaged(tmp_path / "copy") == [], "complete in itself"
    assert {one.name for one in folder.iterdir()} == {"scheduled-1.db", SAMPLES}


@pytest.mark.parametrize("backend", ["sqlite"])
def test_incremental_backups_read_a_part_of_the_samples_each_time(
    database_url: str, store: Store, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    names = [store.arrays.put(np.arange(100.0) + k) for k in range(3 * PARTS)]
    read: list[list[str]] = []
    hash_samples = shared_samples.hash_array

    def note(*content: Any) -> str:
        read[-1].append(hash_samples(*content))
        return read[-1][-1]

    monkeypatch.setattr(shared_samples, "hash_array", note)
    for k in range(PARTS + 1):
        read.append([])
        copies.back_up_incrementally(database_url, tmp_path / f"{k}.db")
    assert sorted(read[0]) == sorted(names), "when they are written"
    assert [len(one) for one in read[1:]] == [3] * PARTS
    assert sorted(name for one in read[1:] for name in one) == sorted(names)


@_SAMPLES_IN_A_FILE
def test_samples_of_deleted_backups_are_deleted(
    database_url: str, store: Store, tmp_path: Path
) -> None:
    folder = tmp_path / "backups"
    folder.mkdir()
    names = []
    for k in range(4):
        names.append(store.arrays.put(np.arange(100.0) + k))
        _back_up(database_url, folder / f"scheduled-{k}.db", retained=2)
        with store.database.transaction() as connection:
            connection.execute(sa.delete(arrays))
        if k == 0:  # not to be deleted, and its samples neither
            (folder / "scheduled-0.db").rename(folder / "before-the-flight.db")
    with closing(sqlite3.connect(folder / SAMPLES)) as samples:
        present = {name for (name,) in samples.execute("SELECT hash FROM arrays")}
    assert present == {names[0], *names[2:]}


@_SAMPLES_IN_A_FILE
def test_an_incremental_backup_without_its_samples_is_refused(
    flown_url: str, tmp_path: Path
) -> None:
    folder = tmp_path / "backups"
    folder.mkdir()
    _back_up(flown_url, folder / "scheduled-1.db")
    rows = _read_rows(flown_url)
    with pytest.raises(BadInput, match=SAMPLES):
        copies.restore(flown_url, (folder / "scheduled-1.db").rename(tmp_path / "alone.db"))
    assert _read_rows(flown_url) == rows


def test_what_a_killed_scheduled_backup_left_is_deleted(
    database_url: str, tmp_path: Path, aircraft: Aircraft
) -> None:
    left = tmp_path / "scheduled-1.db.x1.partial"
    running = tmp_path / "scheduled-2.db.x2.partial"
    tested = tmp_path / "restored-as-a-test-x3"
    tested.mkdir()
    for file in (left, running, tested / "restored.db"):
        file.touch()
    for one in (left, tested / "restored.db", tested):
        os.utime(one, (0, time.time() - 7200))
    copies.back_up_and_retain(database_url, tmp_path / "scheduled-3.db", 2)
    assert running.exists()
    assert not left.exists()
    assert not tested.exists()


def _back_up(url: str, target: Path, retained: int = 2) -> int:
    return copies.back_up_and_retain(url, target, retained, is_incremental=True)


@pytest.mark.parametrize("backend", ["postgresql"])
def test_a_database_of_a_server_survives_a_failed_restore_and_is_restored_when_damaged(
    flown_url: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    copies.backup(flown_url, tmp_path / "copy")
    rows = _read_rows(flown_url)

    def fail(*_: object) -> None:
        raise RuntimeError("interrupted")

    monkeypatch.setattr(row_copy, "_give_ids_from", fail)
    with pytest.raises(RuntimeError, match="interrupted"):
        copies.restore(flown_url, tmp_path / "copy")
    assert _read_rows(flown_url) == rows
    monkeypatch.undo()
    with closing(psycopg.connect(flown_url)) as connection, connection:
        connection.execute("UPDATE arrays SET data = substring(data FROM 2)")
    with pytest.raises(DatabaseUnavailable, match="damaged"):
        copies.backup(flown_url, tmp_path / "damaged")
    copies.restore(flown_url, tmp_path / "copy")
    assert _read_rows(flown_url) == rows


@pytest.mark.parametrize("backend", ["postgresql"])
def test_a_database_of_another_schema_is_not_backed_up(database_url: str, tmp_path: Path) -> None:
    with closing(psycopg.connect(database_url)) as connection, connection:
        connection.execute("UPDATE alembic_version SET version_num = '0001'")
    with pytest.raises(BadInput, match="flexsid migrate"):
        copies.backup(database_url, tmp_path / "copy")
    assert list(tmp_path.glob("copy*")) == []


def _read_rows(url: str) -> dict[str, list[tuple[object, ...]]]:
    """Rows of all tables, without lease and seals, in the order of their keys."""
    engine = make_engine(parse_url(url))
    try:
        with engine.connect() as connection:
            return {
                table.name: [
                    tuple(row)
                    for row in connection.execute(
                        sa.select(table).order_by(*table.primary_key.columns)
                    )
                ]
                for table in metadata.sorted_tables
                if table.name not in ("leases", "row_seals")
            }
    finally:
        engine.dispose()


def _rename(aircraft: Aircraft, name: str) -> Aircraft:
    return replace(aircraft, id=None, name=name)
