"""Acknowledged data are on disk; a lost database is never replaced by an empty one."""

from __future__ import annotations

import shutil
import sqlite3
import stat
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from pathlib import Path

import numpy as np
import pytest
import sqlalchemy as sa
from sqlalchemy import event
from sqlalchemy.engine import Connection

from flexsid.errors import Conflict
from flexsid.records.aircraft import Aircraft
from flexsid.records.decision import (
    EventKind,
    ModelProposal,
    ModelStructure,
    Structure,
    StructureReference,
    Vote,
)
from flexsid.records.maneuver import Flight, Maneuver
from flexsid.records.run import EstimationRun, Progress
from flexsid.storage import tables
from flexsid.storage.bulk import Action, change_maneuvers
from flexsid.storage.copies import backup as copies
from flexsid.storage.database import Database
from flexsid.storage.files import DatabaseUnavailable
from flexsid.storage.jobs import leases, queue
from flexsid.storage.migrate import upgrade
from flexsid.storage.store import Store
from flexsid.workflow.maintenance.database import check_database
from flexsid.workflow.model_structures.model_structures import add_structure
from flexsid.workflow.review import decision_review

only_sqlite = pytest.mark.parametrize("backend", ["sqlite"])


@contextmanager
def _commits(store: Store) -> Iterator[list[bool]]:
    """Record of every commit whether it waits for the disk."""
    waits: list[bool] = []

    def note(connection: Connection) -> None:
        if connection.dialect.name == "sqlite":
            (level,) = connection.exec_driver_sql("PRAGMA synchronous").one()
            waits.append(level >= 2)  # FULL: the log is synchronised with every commit
        else:
            waits.append(connection.exec_driver_sql("SHOW synchronous_commit").scalar() == "on")

    event.listen(store.database.engine, "commit", note)
    try:
        yield waits
    finally:
        event.remove(store.database.engine, "commit", note)


def test_every_acknowledged_write_waits_for_the_disk(
    store: Store, aircraft: Aircraft, maneuver: Maneuver, add_run: Callable[..., EstimationRun]
) -> None:
    assert aircraft.id is not None
    assert maneuver.id is not None
    lease = leases.take(store, leases.read(store), "me")
    assert lease is not None
    # A beat before, so that the connection was lax a moment ago.
    assert leases.renew(store, lease, {}) is not None
    with _commits(store) as waits:
        structure = add_structure(
            store, ModelStructure(aircraft_id=aircraft.id, name="SP", structure=Structure(fixed={}))
        )
        assert structure.id is not None
        decision = decision_review.propose(
            store,
            ModelProposal(
                title="SP",
                structure=StructureReference(id=structure.id, version=1),
                limits={},
                reasoning="enough",
            ),
            "Ann",
        )
        assert decision.id is not None
        decision_review.comment(store, decision.id, "a word", "Bob")
        decision_review.cast_vote(store, decision.id, 1, Vote.APPROVE, "yes", "Bob")
        store.arrays.put(np.arange(3.0))
        change_maneuvers(store, [maneuver.id], Action.TAG, "checked")
        run = add_run()
        claimed = queue.claim(store, run.id)
        assert claimed is not None
        assert claimed.id is not None
        queue.fail(store, claimed.id, claimed.attempt, "x", "y")
        queue.request_retry(store, claimed.id)
        queue.request_cancel(store, claimed.id)
    assert len(waits) >= 11
    assert all(waits)


def test_only_the_beats_of_the_queue_do_not(
    store: Store, add_run: Callable[..., EstimationRun]
) -> None:
    run = queue.claim(store, add_run().id)
    assert run is not None
    assert run.id is not None
    lease = leases.take(store, leases.read(store), "me")
    assert lease is not None
    with _commits(store) as waits:
        assert leases.renew(store, lease, {"workers": 1}) is not None
        assert queue.note_progress(store, run.id, run.attempt, Progress(message="step 1"))
        queue.log_message(store, run.id, run.attempt, "step 1")
    assert waits == [False] * 3
    assert store.runs.get(run.id).progress == Progress(message="step 1")


@only_sqlite
@pytest.mark.parametrize(
    "seed", [0, *(pytest.param(seed, marks=pytest.mark.long) for seed in range(1, 41))]
)
def test_acknowledged_events_survive_a_power_cut(
    store: Store, database_url: str, aircraft: Aircraft, tmp_path: Path, seed: int
) -> None:
    """The log of the database is cut anywhere behind what was synchronised with the disk."""
    rng = np.random.default_rng(seed)
    file = Path(database_url.removeprefix("sqlite:///"))
    structure = add_structure(
        store,
        ModelStructure(aircraft_id=aircraft.id or 0, name="SP", structure=Structure(fixed={})),
    )
    reference = StructureReference(id=structure.id or 0, version=1)
    proposal = ModelProposal(title="SP", structure=reference, limits={}, reasoning="enough")
    decision = decision_review.propose(store, proposal, "Ann").id or 0
    lease = leases.take(store, leases.read(store), "me")
    acknowledged, on_disk = 0, 0
    with _commits(store) as waits:
        for is_event in [*(rng.random(rng.integers(5, 30)) < 0.5), True, False, False]:
            if is_event:
                decision_review.comment(store, decision, f"comment {acknowledged}", "Bob")
                acknowledged += 1
            else:
                assert lease is not None
                lease = leases.renew(store, lease, {"workers": int(rng.integers(99))})
            if waits[-1]:
                on_disk = file.with_name(f"{file.name}-wal").stat().st_size
    log = file.with_name(f"{file.name}-wal").read_bytes()
    assert on_disk < len(log), "the last beats were not synchronised"
    cut = tmp_path / "cut.db"
    cut.write_bytes(file.read_bytes())
    left = int(rng.integers(on_disk, len(log)))
    cut.with_name("cut.db-wal").write_bytes(log[:left] + rng.bytes(int(rng.integers(0, 9000))))
    after = Store.open(f"sqlite:///{cut}")
    events = after.decision_events.find(decision_id=decision)
    after.close()
    comments = [event.text for event in events if event.kind is EventKind.COMMENTED]
    assert comments == [f"comment {number}" for number in range(acknowledged)]


def test_durable_transaction_is_not_nested_in_a_lax_one(store: Store) -> None:
    with pytest.raises(RuntimeError, match="durable"):  # noqa: SIM117
        with store.database.transaction(lax=True), store.database.transaction():
            pass


@pytest.mark.parametrize("backend", ["postgresql"])
def test_postgresql_with_asynchronous_commit_is_reconfigured(database_url: str) -> None:
    name = database_url.rpartition("/")[2]
    first = Database(database_url)
    with first.engine.connect().execution_options(isolation_level="AUTOCOMMIT") as connection:
        connection.exec_driver_sql(f'ALTER DATABASE "{name}" SET synchronous_commit = off')
    first.close()
    again = Database(database_url)
    with again.transaction() as connection:
        assert connection.exec_driver_sql("SHOW synchronous_commit").scalar() == "on"
    again.close()


@pytest.mark.parametrize("backend", ["postgresql"])
def test_a_transaction_that_stands_still_ends_and_holds_nobody(
    database_url: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As of a server that is stopped, or whose computer is gone, in the middle of a change."""
    monkeypatch.setattr("flexsid.storage.database._LONGEST_PAUSE_S", 1)
    with closing(Store.open(database_url)) as stopped, closing(Store.open(database_url)) as other:
        change = sa.update(tables.leases).values(holder="changed")
        with pytest.raises(DatabaseUnavailable), stopped.database.transaction() as connection:  # noqa: PT012
            connection.execute(change)
            with other.database.transaction() as waiting:
                waiting.execute(change.values(holder="other"))
            connection.execute(change)
        with other.database.reading() as connection:
            assert set(connection.scalars(sa.select(tables.leases.c.holder))) == {"other"}


def test_empty_file_is_damage(tmp_path: Path) -> None:
    file = tmp_path / "flexsid.db"
    file.touch()
    with pytest.raises(DatabaseUnavailable, match="flexsid restore") as refused:
        upgrade(f"sqlite:///{file}")
    assert refused.value.code == "database-empty"
    assert file.stat().st_size == 0


def test_a_log_without_its_database_is_damage_too(tmp_path: Path) -> None:
    (tmp_path / "flexsid.db-wal").write_bytes(b"what was voted")
    with pytest.raises(DatabaseUnavailable, match="backup") as refused:
        upgrade(f"sqlite:///{tmp_path}/flexsid.db")
    assert refused.value.code == "database-gone"
    assert [file.name for file in tmp_path.iterdir()] == ["flexsid.db-wal"]


def test_database_of_another_program_is_rejected(tmp_path: Path) -> None:
    with closing(sqlite3.connect(tmp_path / "other.db")) as other:
        other.execute("CREATE TABLE birds (name)")
    with pytest.raises(DatabaseUnavailable, match="birds"):
        upgrade(f"sqlite:///{tmp_path}/other.db")


@only_sqlite
def test_a_changed_bit_in_the_schema_is_named_as_damage(
    database_url: str, store: Store, tmp_path: Path
) -> None:
    """SQLite quotes the text that it cannot read, which is then no UTF-8."""
    copies.backup(database_url, tmp_path / "copy")
    content = (tmp_path / "copy").read_bytes()
    assert b"CREATE TABLE decisions" in content
    damaged = content.replace(b"CREATE TABLE decisions", b"CREATE T\xa0BLE decisions", 1)
    (tmp_path / "damaged.db").write_bytes(damaged)
    with (
        pytest.raises(DatabaseUnavailable, match="not UTF-8"),
        closing(Store.open(f"sqlite:///{tmp_path}/damaged.db")) as opened,
    ):
        opened.runs.find()


@only_sqlite
def test_missing_file_is_not_replaced_by_a_server(database_url: str, store: Store) -> None:
    file = Path(database_url.removeprefix("sqlite:///"))
    file.unlink()
    with pytest.raises(DatabaseUnavailable):
        store.runs.find()
    assert not file.exists()


@only_sqlite
def test_backup_is_restored_over_an_empty_file(
    database_url: str, aircraft: Aircraft, tmp_path: Path
) -> None:
    copies.backup(database_url, tmp_path / "copy")
    lost = tmp_path / "lost.db"
    lost.touch()
    copies.restore(f"sqlite:///{lost}", tmp_path / "copy")
    restored = Store.open(f"sqlite:///{lost}")
    assert restored.aircraft.find() == [aircraft]
    restored.close()
    assert [file.stat().st_size for file in tmp_path.glob("lost.db.before-restore-*")] == [0]


def test_database_logs_and_copies_are_private(tmp_path: Path) -> None:
    url = f"sqlite:///{tmp_path}/var/flexsid.db"
    upgrade(url)
    store = Store.open(url)
    store.arrays.put(np.arange(3.0))
    copies.backup(url, tmp_path / "copy")
    copies.restore(url, tmp_path / "copy")
    files = [*(tmp_path / "var").iterdir(), tmp_path / "copy"]
    assert {"flexsid.db-wal", "flexsid.db-shm"} <= {file.name for file in files}
    assert {stat.filemode(file.stat().st_mode) for file in files} == {"-rw-------"}
    assert stat.filemode((tmp_path / "var").stat().st_mode) == "drwx------"
    store.close()


def _copy_with_mark(file: Path, folder: Path, *ends: str) -> Path:
    """Copy what remains of a database, and the mark of its last transactions."""
    folder.mkdir()
    for end in (*ends, "-mark"):
        shutil.copy(f"{file}{end}", folder)
    return folder / file.name


def _find_losses(file: Path) -> list[str]:
    upgrade(f"sqlite:///{file}")  # as every command and server begins
    database = Database(f"sqlite:///{file}")
    try:
        return database.find_losses()
    finally:
        database.close()


@only_sqlite
def test_acknowledged_transactions_that_are_gone_are_described(
    database_url: str, store: Store, aircraft: Aircraft, tmp_path: Path
) -> None:
    file = Path(database_url.removeprefix("sqlite:///"))
    copies.backup(database_url, tmp_path / "earlier")
    assert aircraft.id is not None
    for number in (11, 12, 13):
        store.flights.add(Flight(aircraft_id=aircraft.id, number=number))
    intact = _copy_with_mark(file, tmp_path / "intact", "", "-wal")
    without_log = _copy_with_mark(file, tmp_path / "without-log", "")
    replaced = _copy_with_mark(file, tmp_path / "replaced", "")
    shutil.copy(tmp_path / "earlier", replaced)
    incremental = _copy_with_mark(file, tmp_path / "incremental", "")
    copies.back_up_incrementally(database_url, tmp_path / "rows")
    shutil.copy(tmp_path / "rows", incremental)
    continued = _copy_with_mark(file, tmp_path / "continued", "")
    shutil.copy(tmp_path / "earlier", tmp_path / "elsewhere.db")
    other = Store.open(f"sqlite:///{tmp_path}/elsewhere.db")
    for number in (11, 12, 13):
        other.flights.add(Flight(aircraft_id=aircraft.id, number=number))
    other.close()
    shutil.copy(tmp_path / "elsewhere.db", continued)
    assert _find_losses(intact) == []
    for case in (without_log, replaced, incremental):
        (loss,) = _find_losses(case)
        assert "acknowledged transactions are not in the database" in loss, case
    (loss,) = _find_losses(continued)
    assert "replaced by another one" in loss
    # Later transactions take the numbers of the lost ones, and the loss is still described.
    later = Store.open(f"sqlite:///{replaced}")
    for number in range(20, 30):
        later.flights.add(Flight(aircraft_id=aircraft.id, number=number))
    assert len(later.database.find_losses()) == 1
    assert "lost-transactions" in [one.code for one in check_database(later)]
    later.database.accept_losses()
    assert later.database.find_losses() == []
    later.close()
    assert _find_losses(replaced) == []
    # A restored backup is what was requested.
    copies.restore(f"sqlite:///{without_log}", tmp_path / "earlier")
    assert _find_losses(without_log) == []
    replaced.unlink()
    with pytest.raises(DatabaseUnavailable, match="missing, but") as deleted:
        upgrade(f"sqlite:///{replaced}")
    assert deleted.value.code == "database-gone"
    copies.restore(f"sqlite:///{replaced}", tmp_path / "earlier")
    assert _find_losses(replaced) == []


@only_sqlite
def test_a_log_that_is_deleted_beneath_a_server_is_noticed(
    database_url: str, store: Store, aircraft: Aircraft
) -> None:
    log = Path(f"{database_url.removeprefix('sqlite:///')}-wal")
    kept = log.rename(log.with_name("kept"))
    with pytest.raises(DatabaseUnavailable) as deleted:
        store.aircraft.find()
    assert deleted.value.code == "database-replaced"
    kept.rename(log)
    assert store.aircraft.find() == [aircraft]


@only_sqlite
def test_readable_files_are_made_private_with_a_log_message(
    database_url: str, caplog: pytest.LogCaptureFixture
) -> None:
    file = Path(database_url.removeprefix("sqlite:///"))
    older = file.with_name(f"{file.name}.backup-0001")
    older.write_bytes(b"a copy")
    beside = file.with_name("notes.txt")
    beside.write_text("not ours")
    for one in (file, older, beside):
        one.chmod(0o644)
    upgrade(database_url)
    modes = [stat.S_IMODE(one.stat().st_mode) for one in (file, older, beside)]
    assert modes == [0o600, 0o600, 0o644]
    assert caplog.text.count("mode 644") == 2


@only_sqlite
def test_interrupted_backup_leaves_no_file(
    database_url: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def damaged(file: Path) -> None:
        raise DatabaseUnavailable("damaged")

    monkeypatch.setattr(copies, "check", damaged)
    with pytest.raises(DatabaseUnavailable):
        copies.backup(database_url, tmp_path / "copy")
    assert list(tmp_path.glob("copy*")) == []
    monkeypatch.undo()
    (tmp_path / "copy").write_bytes(b"another's")
    with pytest.raises(Conflict):
        copies.backup(database_url, tmp_path / "copy")
