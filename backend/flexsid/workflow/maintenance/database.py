"""Backups of the database, and its integrity check: pages, rows, references, arrays, decisions.

The worker copies the file itself, since no message holds a database: it needs the file system of
the server, as the workers of one computer have it.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from pathlib import Path

import sqlalchemy as sa

from flexsid.errors import Conflict, FlexsidError, UnknownRecord
from flexsid.importers import jail
from flexsid.records.decision import Decision, DecisionState
from flexsid.records.job import Job
from flexsid.records.run import ReportProgress, RunState
from flexsid.storage import tables
from flexsid.storage.access import Forbidden, get_access
from flexsid.storage.arrays import DamagedData, compute_checksum, hash_array, list_referring_records
from flexsid.storage.audit_recording import is_chain_intact
from flexsid.storage.changes import count_without_campaign, read_events
from flexsid.storage.content import find_changes
from flexsid.storage.copies import backup as copies
from flexsid.storage.copies.shared_samples import SAMPLES, is_incremental
from flexsid.storage.database import Database
from flexsid.storage.files import make_private_folder
from flexsid.storage.lists.run_list import SEALED, is_altered
from flexsid.storage.rows import find_changed_rows
from flexsid.storage.store import Store
from flexsid.workflow.review.audit import replay
from flexsid.workflow.review.decision_review import find_clock_error
from flexsid.workflow.review.evidence import GONE, hash_evidence
from flexsid.workflow.review.frozen_sheet import hash_frozen_sheets

# --- Backups of the database into a folder beside it, as jobs -------------------------------------

_RETRY = timedelta(hours=1)


@dataclass(frozen=True, slots=True, kw_only=True)
class BackupRequest:
    """The database is that of the server; the newest ``retained`` scheduled backups stay.

    Scheduled backups that are incremental share the file of their samples.
    """

    retained: int | None = None
    incremental: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class BackupFile:
    """A backup in the folder of backups, and its size."""

    name: str
    n_bytes: int


@dataclass(frozen=True, slots=True)
class BackupTask:
    """Address of a database, the new file, and the number of scheduled backups to retain."""

    url: str
    target: Path
    retained: int | None = None
    is_incremental: bool = False


def refuse_backup(store: Store) -> None:
    """Refuse accounts without access to the whole database, and databases of a server.

    Raises
    ------
    BadInput
        If the database is not SQLite.
    Forbidden
        If the account is not an administrator of all campaigns.
    """
    access = get_access()
    if access is not None and access.writable is not None:
        raise Forbidden("backups have all campaigns: they are made by administrators of all")
    _locate(store)


def prepare_backup(store: Store, job: Job, request: BackupRequest) -> BackupTask:
    """Return the task of a job; what earlier jobs left when they were cancelled is deleted."""
    source, folder = _locate(store)
    make_private_folder(folder)
    for partial in folder.glob("*.partial"):
        if not _is_running(store, partial, job):
            partial.unlink(missing_ok=True)
    assert job.started_at is not None
    name = f"{job.started_at:%Y%m%d-%H%M%S}-{job.id}-{job.attempt}.db"
    name = name if request.retained is None else f"{copies.SCHEDULED}{name}"
    return BackupTask(f"sqlite:///{source}", folder / name, request.retained, request.incremental)


def compute_backup(task: BackupTask, report: ReportProgress) -> BackupFile:
    """Copy the database and check the copy; raises as ``storage.backup.backup``.

    A scheduled backup is also restored into a temporary database, and then replaces the oldest.
    """
    if task.retained is None:
        n_bytes = copies.backup(task.url, task.target, report)
    else:
        n_bytes = copies.back_up_and_retain(
            *(task.url, task.target, task.retained, report), is_incremental=task.is_incremental
        )
    return BackupFile(name=task.target.name, n_bytes=n_bytes)


def is_backup_due(store: Store, interval: timedelta, now: datetime) -> bool:
    """Whether the last scheduled backup is older than the interval.

    Not while a backup is queued or running, and one hour after one that failed.
    """
    for state in (RunState.QUEUED, RunState.RUNNING):
        if store.jobs.find(kind=copies.BACKUP, state=state):
            return False
    failed = store.jobs.find(kind=copies.BACKUP, state=RunState.FAILED)
    if any(job.finished_at is not None and now - job.finished_at < _RETRY for job in failed):
        return False
    made = copies.list_scheduled(_locate(store)[1])
    return not made or now - datetime.fromtimestamp(made[-1].stat().st_mtime, UTC) >= interval


def find_backup(store: Store, backup: BackupFile) -> Path:
    """Return the file of a backup.

    Raises
    ------
    UnknownRecord
        If the file was deleted or moved.
    Conflict
        If the backup is incremental: it is two files.
    """
    file = _locate(store)[1] / backup.name
    if not file.is_file():
        raise UnknownRecord(f"the backup {file} is no longer there")
    if is_incremental(file):
        raise Conflict(
            f"{file.name} is an incremental backup without samples; copy the folder {file.parent}"
            f" of the server, where {SAMPLES} has them",
            code="incremental-backup",
        )
    return file


def _locate(store: Store) -> tuple[Path, Path]:
    """Return the file of the database and the folder of its backups."""
    file = copies.find_file(str(store.database.url)).absolute()
    return file, file.with_name(f"{file.name}-backups")


def _is_running(store: Store, partial: Path, job: Job) -> bool:
    *_, number, attempt = partial.name.split(".")[0].split("-")
    if int(number) == job.id:
        return int(attempt) == job.attempt
    with suppress(UnknownRecord):
        return store.jobs.get(int(number)).state is RunState.RUNNING
    return False


# --- Integrity check of a database: pages, rows, references, arrays, results, decisions, clock

_AT_ONCE = 20  # arrays read at once; one of a flight may weigh tens of megabytes
_REPAIR = "restore a backup from before"


@dataclass(frozen=True, slots=True)
class DatabaseProblem:
    """A problem with a stable code and advice.

    ``is_damage`` is False for a remark.
    """

    code: str
    record: str
    text: str
    is_damage: bool = True


def check_database(store: Store) -> list[DatabaseProblem]:
    """Check pages, rows, references, samples, results, their inputs, decisions, and the clock."""
    return [
        *_check_mark(store.database),
        *_check_pages(store.database),
        *_check_rows(store.database),
        *_check_references(store.database),
        *_check_campaigns(store.database),
        *_check_arrays(store.database),
        *_check_chunks(store),
        *_check_results(store.database),
        *_check_inputs(store.database),
        *_check_decisions(store),
        *_check_audit_log(store),
        *_check_clock(store),
        *_check_readers(),
    ]


def _check_mark(database: Database) -> Iterator[DatabaseProblem]:
    for loss in database.find_losses():
        text = f"{loss} {_REPAIR.capitalize()}, or run `flexsid check --accept-losses`."
        yield DatabaseProblem("lost-transactions", "database", text)


def _check_pages(database: Database) -> Iterator[DatabaseProblem]:
    with database.reading() as connection:
        if connection.dialect.name == "sqlite":
            found = connection.exec_driver_sql("PRAGMA integrity_check(20)").scalars().all()
            for damage in (one for one in found if one != "ok"):
                text = f"The database file is damaged: {damage}. Stop the server and {_REPAIR}."
                yield DatabaseProblem("damaged-page", "database", text)
            return
        checksums = connection.exec_driver_sql("SHOW data_checksums").scalar()
        loose = connection.exec_driver_sql(
            "SELECT conname FROM pg_constraint WHERE contype = 'f' AND NOT convalidated"
        )
        for name in loose.scalars():
            text = (
                f"The foreign key {name} is not enforced for rows that were there before it;"
                f" ALTER TABLE ... VALIDATE CONSTRAINT {name} checks them."
            )
            yield DatabaseProblem("unchecked-reference", name, text)
        if checksums != "on":
            text = (
                "This PostgreSQL has no page checksums, so damage of the disk is not"
                " detected; pg_checksums --enable adds them while it is stopped."
            )
            yield DatabaseProblem("no-checksums", "database", text, is_damage=False)


def _check_rows(database: Database) -> Iterator[DatabaseProblem]:
    with database.reading() as connection:
        for changed in find_changed_rows(connection):
            text = (
                f"{changed} were changed or lost by the disk or another program; {_REPAIR}, or"
                " correct the records and run `flexsid check --accept-rows`."
            )
            yield DatabaseProblem("damaged-row", changed.table, text)


def _check_references(database: Database) -> Iterator[DatabaseProblem]:
    """Check every foreign key, independent of database constraints."""
    with database.reading() as connection:
        for table in tables.metadata.sorted_tables:
            for key in table.foreign_keys:
                far = key.column.table.alias("far")
                is_missing = ~sa.exists().where(far.c[key.column.name] == key.parent)
                query = sa.select(sa.func.count(), sa.func.min(key.parent)).where(
                    key.parent.is_not(None), is_missing
                )
                count, example = connection.execute(query).one()
                if count:
                    text = (
                        f"{count} rows of {table.name} refer by {key.parent.name} to rows of"
                        f" {key.column.table.name} that do not exist (the first: {example});"
                        f" {_REPAIR}."
                    )
                    yield DatabaseProblem("broken-reference", table.name, text)


def _check_campaigns(database: Database) -> Iterator[DatabaseProblem]:
    for table, count in count_without_campaign(database).items():
        name = table.replace("_", " ")
        text = (
            f"{count} {name} belong to no campaign, and are seen by administrators of all"
            " campaigns only; `flexsid users adopt NAME` puts them into the campaign of an"
            " aircraft."
        )
        yield DatabaseProblem("without-campaign", name, text, is_damage=False)


def _check_arrays(database: Database) -> Iterator[DatabaseProblem]:
    arrays = tables.arrays.c
    columns = (arrays.hash, arrays.checksum, arrays.dtype, arrays.shape, arrays.unit, arrays.data)
    with database.reading() as connection:
        records = list_referring_records(connection)
        names = list(connection.scalars(sa.select(arrays.hash).order_by(arrays.hash)))
        for first in range(0, len(names), _AT_ONCE):
            some = names[first : first + _AT_ONCE]
            for row in connection.execute(sa.select(*columns).where(arrays.hash.in_(some))):
                content = (row.dtype, row.shape, row.unit, row.data)
                record = records.get(row.hash, "an array that no record names")
                if hash_array(*content) != row.hash:
                    text = (
                        f"The samples of {record} were changed after storage (their hash"
                        f" differs) and cannot be used. Import the file again, or"
                        f" {_REPAIR}."
                    )
                    yield DatabaseProblem("damaged-data", record, text)
                elif row.checksum not in {None, compute_checksum(*content)}:
                    text = (
                        f"The checksum of {record} is damaged; its samples are intact (their hash"
                        " does not differ)."
                    )
                    yield DatabaseProblem("damaged-checksum", record, text, is_damage=False)
        for name in sorted(records.keys() - set(names)):
            text = f"The samples of {records[name]} are gone; import the file again, or {_REPAIR}."
            yield DatabaseProblem("missing-data", records[name], text)
        orphans = set(names) - records.keys()
        if orphans:
            text = f"{len(orphans)} arrays belong to no record; they only take space."
            yield DatabaseProblem("orphaned-data", "arrays", text, is_damage=False)


def _check_chunks(store: Store) -> Iterator[DatabaseProblem]:
    channels = [c for c in store.flight_channels.find() if c.samples_per_chunk is not None]
    if channels and store.recordings is None:
        text = (
            f"The samples of {len(channels)} channels of flights are in chunks outside the"
            " database; set FLEXSID_RECORDINGS to their address to check them."
        )
        yield DatabaseProblem("unchecked-recordings", "recordings", text, is_damage=False)
        return
    for channel in channels:
        assert store.recordings is not None
        record = f"channel '{channel.name}' of flight {channel.flight_id}"
        with suppress(DamagedData, UnknownRecord):  # found with the arrays
            for damage in store.recordings.find_damaged(store.arrays.get(channel.array)):
                yield DatabaseProblem("damaged-data", record, f"{record}: {damage}.")


def _check_results(database: Database) -> Iterator[DatabaseProblem]:
    runs = tables.runs
    columns = (runs.c[name] for name in ("id", "state", "result_hash", *SEALED))
    with database.reading() as connection:
        for row in connection.execute(sa.select(*columns).order_by(runs.c.id)).mappings():
            number = row["id"]
            if is_altered({name: row[name] for name in ("result_hash", *SEALED)}):
                text = (
                    f"The result or request of run {number} was altered after it"
                    f" finished; estimate again, or {_REPAIR}."
                )
                yield DatabaseProblem("result-altered", f"run {number}", text)
            elif row["state"] == RunState.SUCCEEDED.value and row["result_hash"] is None:
                text = (
                    f"Run {number} has succeeded, but has no stored hash of the result;"
                    " estimate again."
                )
                yield DatabaseProblem("result-not-sealed", f"run {number}", text)


def _check_inputs(database: Database) -> Iterator[DatabaseProblem]:
    """Compare the records that runs rest on with those of the time of the run."""
    runs = tables.runs.c
    query = sa.select(runs.id, runs.rests_on).where(runs.state == RunState.SUCCEEDED.value)
    with database.reading() as connection:
        found = connection.execute(query.order_by(runs.id)).all()
        changes = find_changes(database, [rests_on for _, rests_on in found])
    changed: dict[str, list[int]] = {}
    for (number, _), names in zip(found, changes, strict=True):
        for name in names:
            changed.setdefault(name, []).append(number)
    for name, numbers in changed.items():
        text = (
            f"{name.capitalize()} differs from what {len(numbers)} runs were estimated with (the"
            f" first: run {numbers[0]}); unless it was corrected since, {_REPAIR}."
        )
        yield DatabaseProblem("inputs-changed", name, text, is_damage=False)


def _check_decisions(store: Store) -> Iterator[DatabaseProblem]:
    for decision in store.decisions.find():
        name = f"decision {decision.id}"
        events = store.decision_events.find(decision_id=decision.id)
        if not events or not is_chain_intact(events) or replay(decision, events) != decision:
            text = (
                f"The record of {name} was changed: its events do not match their hashes"
                f" or its state; {_REPAIR}."
            )
            yield DatabaseProblem("broken-chain", name, text)
            continue
        if decision.superseded_by == decision.id:
            text = (
                f"{name.capitalize()} was superseded by itself, when the clock was set"
                " back: it is no longer in force, though approved last. Propose and approve"
                " it again."
            )
            yield DatabaseProblem("superseded-by-itself", name, text)
        yield from _check_evidence(store, decision, events[-1].data)


def _check_evidence(
    store: Store, decision: Decision, then: dict[str, str]
) -> Iterator[DatabaseProblem]:
    """Check the evidence of a decision against its last event."""
    name = f"decision {decision.id}"
    try:
        now = hash_evidence(store, decision.proposal) | hash_frozen_sheets(store, then)
    except FlexsidError as error:
        text = f"The evidence of {name} cannot be read: {error.message}; {_REPAIR}."
        yield DatabaseProblem("evidence-gone", name, text)
        return
    for what, content in then.items():
        if now.get(what) == content:
            continue
        if now.get(what, GONE) == GONE:
            text = f"{what.capitalize()}, evidence of {name}, was deleted; restore it."
            is_damage = decision.state is DecisionState.APPROVED
            yield DatabaseProblem("evidence-gone", name, text, is_damage=is_damage)
        else:
            text = (
                f"{what.capitalize()}, evidence of {name}, was changed; check whether the decision"
                " is still valid."
            )
            yield DatabaseProblem("evidence-changed", name, text, is_damage=False)


def _check_audit_log(store: Store) -> Iterator[DatabaseProblem]:
    if not is_chain_intact(read_events(store)):
        text = f"The audit log was changed: its events do not match their hashes; {_REPAIR}."
        yield DatabaseProblem("broken-audit-log", "audit log", text)


def _check_clock(store: Store) -> Iterator[DatabaseProblem]:
    text = find_clock_error(store)
    if text is not None:
        yield DatabaseProblem("clock-behind", "clock", text, is_damage=False)


def _check_readers() -> Iterator[DatabaseProblem]:
    for one in jail.list_missing():
        text = f"On this computer a file that attacks its reader could {one}."
        yield DatabaseProblem("reader-not-confined", "computer", text, is_damage=False)
