"""A backup is the database of one moment, whatever goes on, and comes back whole."""

from __future__ import annotations

import sqlite3
import threading
from collections.abc import Callable
from contextlib import closing
from pathlib import Path

import pytest

from flexsid.errors import BadInput, Conflict
from flexsid.records.aircraft import Aircraft
from flexsid.records.flight import Flight
from flexsid.records.run import EstimationRun, RunState
from flexsid.storage import backup as copies
from flexsid.storage import leases, queue
from flexsid.storage.store import Store

only_sqlite = pytest.mark.parametrize("backend", ["sqlite"])


@only_sqlite
def test_a_backup_beside_a_busy_writer_is_sound_and_of_one_moment(
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
    assert list(tmp_path.glob("*.partial")) == []


@only_sqlite
@pytest.mark.parametrize("page_size", [4096, 32768])
def test_what_is_restored_is_what_was_backed_up_and_nothing_is_lost(
    database_url: str,
    store: Store,
    aircraft: Aircraft,
    add_run: Callable[..., EstimationRun],
    tmp_path: Path,
    page_size: int,
) -> None:
    waiting, under_way = add_run(), add_run()
    lease = leases.take(store, leases.read(store), "before")
    assert lease is not None
    queue.claim(store, under_way.id, owner="a server that lives on")
    copy = tmp_path / "copy"
    copies.backup(database_url, copy)
    with closing(sqlite3.connect(copy)) as older:  # as made by an older release
        older.execute("PRAGMA journal_mode = DELETE")
        older.execute(f"PRAGMA page_size = {page_size}")
        older.execute("VACUUM")
    lost = store.aircraft.add(Aircraft(**{**_fields(aircraft), "name": "later", "id": None}))
    kept = copies.restore(database_url, copy)
    # The same server goes on with what was restored.
    assert store.aircraft.find() == [aircraft]
    assert {r.id: r.state for r in store.runs.find()} == {
        waiting.id: RunState.QUEUED,
        under_way.id: RunState.RUNNING,
    }
    store.aircraft.add(Aircraft(**{**_fields(aircraft), "name": "after", "id": None}))
    # Who led the queue finds out.
    assert leases.renew(store, lease, {}) is None
    assert leases.read(store).holder is None
    assert leases.read(store).epoch > lease.epoch
    # Nobody carries out what was under way then, so whoever leads next starts it again.
    assert queue.take_over(store, lambda owner: owner is None) == 1
    assert kept is not None
    before = Store.open(f"sqlite:///{kept}")
    assert before.aircraft.find() == [aircraft, lost]
    before.close()


@only_sqlite
def test_a_backup_comes_back_where_there_is_no_database(
    database_url: str, aircraft: Aircraft, tmp_path: Path
) -> None:
    copies.backup(database_url, tmp_path / "copy")
    assert copies.restore(f"sqlite:///{tmp_path}/new.db", tmp_path / "copy") is None
    restored = Store.open(f"sqlite:///{tmp_path}/new.db")
    assert restored.aircraft.find() == [aircraft]
    restored.close()


@only_sqlite
def test_what_is_no_backup_changes_nothing(
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


@pytest.mark.parametrize("backend", ["postgresql"])
def test_postgresql_is_told_its_own_way(database_url: str, tmp_path: Path) -> None:
    with pytest.raises(BadInput, match="pg_dump"):
        copies.backup(database_url, tmp_path / "copy")
    with pytest.raises(BadInput, match="pg_restore"):
        copies.restore(database_url, tmp_path / "copy")


def _fields(aircraft: Aircraft) -> dict[str, object]:
    return {name: getattr(aircraft, name) for name in Aircraft.__dataclass_fields__}
