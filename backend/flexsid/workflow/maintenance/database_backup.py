"""Backups of the database into a folder beside it, as jobs.

The worker copies the file itself, since no message holds a database: it needs the file system of
the server, as the workers of one computer have it.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from pathlib import Path

from flexsid.errors import Conflict, UnknownRecord
from flexsid.records.job import Job
from flexsid.records.run import ReportProgress, RunState
from flexsid.storage import backup as copies
from flexsid.storage.access import Forbidden, get_access
from flexsid.storage.files import make_private_folder
from flexsid.storage.shared_samples import SAMPLES, is_incremental
from flexsid.storage.store import Store

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
