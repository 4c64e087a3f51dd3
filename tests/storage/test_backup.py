"""A backup is a consistent copy of a database in use, and is restored completely."""

from __future__ import annotations

import sqlite3
import subprocess
import threading
from collections.abc import Callable
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import pytest
from postgresql import find_programs

from flexsid.errors import BadInput, Conflict
from flexsid.records.aircraft import Aircraft
from flexsid.records.maneuver import Flight
from flexsid.records.run import EstimationRun, RunState
from flexsid.storage import backup as copies
from flexsid.storage import leases, queue
from flexsid.storage.store import Store

ROOT = Path(__file__).parents[2]
only_sqlite = pytest.mark.parametrize("backend", ["sqlite"])


@only_sqlite
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
    assert list(tmp_path.glob("*.partial")) == []


@only_sqlite
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


@only_sqlite
def test_ids_given_after_a_backup_are_not_given_again(
    database_url: str, store: Store, aircraft: Aircraft, tmp_path: Path
) -> None:
    copies.backup(database_url, tmp_path / "copy")
    later = store.aircraft.add(_rename(aircraft, "later"))
    flight = store.flights.add(Flight(aircraft_id=1, number=1))  # the first one of all
    copies.restore(database_url, tmp_path / "copy")
    assert (store.aircraft.add(_rename(aircraft, "after")).id or 0) > (later.id or 0)
    assert (store.flights.add(Flight(aircraft_id=1, number=1)).id or 0) > (flight.id or 0)


@pytest.mark.parametrize("backend", ["postgresql"])
def test_the_documented_commands_continue_the_ids_of_postgresql(
    database_url: str, store: Store, aircraft: Aircraft, tmp_path: Path
) -> None:
    page = (ROOT / "docs" / "how-to" / "operate.md").read_text()
    statement = page.partition('psql -At -c "')[2].partition('"')[0]
    programs = find_programs()
    assert programs is not None
    copy, address = tmp_path / "copy", f"--dbname={database_url}"
    subprocess.run([programs / "pg_dump", "--format=custom", f"--file={copy}", address], check=True)
    later = store.aircraft.add(_rename(aircraft, "later"))
    with store.database.reading() as connection:
        statements = connection.exec_driver_sql(statement.replace("%", "%%")).scalars().all()
    store.close()
    subprocess.run([programs / "pg_restore", "--clean", address, copy], check=True)
    with store.database.transaction() as connection:
        for one in statements:
            connection.exec_driver_sql(one)
    assert store.aircraft.find() == [aircraft]
    assert (store.aircraft.add(_rename(aircraft, "after")).id or 0) > (later.id or 0)


@only_sqlite
def test_backup_is_restored_without_a_database(
    database_url: str, aircraft: Aircraft, tmp_path: Path
) -> None:
    copies.backup(database_url, tmp_path / "copy")
    assert copies.restore(f"sqlite:///{tmp_path}/new.db", tmp_path / "copy") is None
    restored = Store.open(f"sqlite:///{tmp_path}/new.db")
    assert restored.aircraft.find() == [aircraft]
    restored.close()


@only_sqlite
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


@pytest.mark.parametrize("backend", ["postgresql"])
def test_postgresql_is_referred_to_pg_dump(database_url: str, tmp_path: Path) -> None:
    with pytest.raises(BadInput, match="pg_dump"):
        copies.backup(database_url, tmp_path / "copy")
    with pytest.raises(BadInput, match="pg_restore"):
        copies.restore(database_url, tmp_path / "copy")


def _rename(aircraft: Aircraft, name: str) -> Aircraft:
    return replace(aircraft, id=None, name=name)
