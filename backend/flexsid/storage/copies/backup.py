"""Backup and restore of a database, while servers work with it.

A backup is a database of SQLite, whatever kind of database it is of, and is restored into either.
The samples of an incremental backup are in a file that it shares with the others of its folder.
"""

from __future__ import annotations

import logging
import shutil
import sqlite3
import tempfile
import time
from collections.abc import Iterator, Mapping
from contextlib import closing, contextmanager, suppress
from datetime import UTC, datetime
from pathlib import Path

import sqlalchemy as sa
from sqlalchemy.engine import URL, Connection
from sqlalchemy.pool import StaticPool

from flexsid.errors import BadInput, Conflict, FlexsidError
from flexsid.records.run import Progress, ReportProgress
from flexsid.storage.copies.shared_samples import (
    add_samples,
    attach_samples,
    check_samples,
    delete_unused_samples,
    find_missing_samples,
    include_samples,
    is_sound,
)
from flexsid.storage.database import make_engine, parse_url, sqlite_file, translate_errors
from flexsid.storage.files import DatabaseUnavailable, lock_tables, new_file
from flexsid.storage.migrate import build_empty_database, upgrade
from flexsid.storage.rows import add_seal_function, copy_rows, find_changed_rows, replace_tables
from flexsid.storage.write_mark import (
    Written,
    accept_losses,
    note,
    number_transaction,
    read_last_number,
)

BACKUP = "backup"
"""Kind of the jobs that back a database up."""

SCHEDULED = "scheduled-"
"""Begin of the names of scheduled backups, the oldest of which are deleted."""

_TESTED = "restored-as-a-test-"  # begin of the names of temporary folders
_REMAINS_S = 3600.0  # since the last change of what an ended process has left

_log = logging.getLogger(__name__)


def backup(url: str, target: Path, report: ReportProgress = lambda progress: None) -> int:
    """Copy a consistent state of a database into a new file, and check the copy.

    Parameters
    ----------
    url
        Address of a database; it may be in use during the copy.
    target
        A file that does not exist yet.
    report
        Called with the progress.

    Returns
    -------
    int
        Size of the copy. [bytes]

    Raises
    ------
    BadInput
        If the database does not exist, or has another schema than this software.
    Conflict
        If the file exists.
    DatabaseUnavailable
        If the copy, its rows or samples are damaged; the copy is deleted then.
    """
    source = _find_source(url, target)
    with _new_backup(target) as partial:
        report(Progress(message="Copying the database"))
        if source is None:
            _copy_rows_of(parse_url(url), partial)
        else:
            _copy(source, partial)
        _check_copy(partial, f"{source or 'the database'}", report)
    return target.stat().st_size


def back_up_incrementally(
    url: str, target: Path, report: ReportProgress = lambda progress: None
) -> int:
    """Copy a consistent state of the rows into a new file, and new samples into the shared one.

    Parameters
    ----------
    url, target, report
        As of ``backup``; the samples are in a file beside the target.

    Returns
    -------
    int
        Size of what was written. [bytes]

    Raises
    ------
    BadInput, Conflict, DatabaseUnavailable
        As ``backup``.
    """
    source = _find_source(url, target)
    with _new_backup(target) as partial:
        report(Progress(message="Copying the database"))
        n_bytes = _copy_rows_of(parse_url(url), partial, samples=target.parent)
        _check_copy(partial, f"{source or 'the database'}", report, has_samples=False)
    if find_missing_samples(target):
        target.unlink()
        raise Conflict(f"another backup into {target.parent} deleted samples; back up again")
    return n_bytes + target.stat().st_size


def _find_source(url: str, target: Path) -> Path | None:
    """Return the file of a database, or none for that of a server, and refuse what exists."""
    source = sqlite_file(parse_url(url))
    if source is not None and not source.is_file():
        raise BadInput(f"there is no database {source}")
    if target.exists():
        raise Conflict(f"{target} exists; name a new file", code="file-exists")
    return source


@contextmanager
def _new_backup(target: Path) -> Iterator[Path]:
    try:
        with new_file(target) as partial:
            yield partial
    except OSError as error:
        raise BadInput(f"{target} cannot be written: {error.strerror}") from error


def _check_copy(
    partial: Path, source: str, report: ReportProgress, *, has_samples: bool = True
) -> None:
    _make_single_file(partial)
    report(Progress(fraction=0.3, message="Checking pages"))
    check(partial)
    report(Progress(fraction=0.5, message="Checking rows and samples"))
    _refuse_damaged(find_damaged(partial, has_samples=has_samples), source)


def _refuse_damaged(damaged: list[str], source: str) -> None:
    if damaged:
        raise DatabaseUnavailable(
            f"no backup was written: {source} is damaged: {', '.join(damaged[:5])};"
            " run `flexsid check` to list all and the remedies",
            code="damaged-data",
        )


def back_up_and_retain(
    url: str,
    target: Path,
    retained: int,
    report: ReportProgress = lambda progress: None,
    *,
    is_incremental: bool = False,
) -> int:
    """Back up, restore the copy as a test, then delete the oldest scheduled backups beside it.

    Of an incremental backup the rows are restored, its samples are compared with their names.

    Parameters
    ----------
    url, report
        As of ``backup``.
    target
        New file whose name begins with ``SCHEDULED`` and its time.
    retained
        Number of scheduled backups that stay, this one included.
    is_incremental
        Write only samples that the folder does not have.

    Returns
    -------
    int
        Size of what was written. [bytes]

    Raises
    ------
    BadInput, Conflict, DatabaseUnavailable
        As ``backup``; without a restored copy nothing is deleted.
    """
    _delete_remains(target.parent)
    size = (back_up_incrementally if is_incremental else backup)(url, target, report)
    report(Progress(fraction=0.8, message="Restoring the copy"))
    try:
        try_restore(target)
    except FlexsidError:
        target.unlink()
        raise
    for old in list_scheduled(target.parent)[:-retained]:
        old.unlink(missing_ok=True)
    delete_unused_samples(target.parent)
    return size


def _delete_remains(folder: Path) -> None:
    """Delete what a process left that was killed during a scheduled backup."""
    for one in (*folder.glob(f"{SCHEDULED}*.partial"), *folder.glob(f"{_TESTED}*")):
        with suppress(FileNotFoundError):
            changed = max(path.stat().st_mtime for path in (one, *one.rglob("*")))
            if time.time() - changed > _REMAINS_S:
                shutil.rmtree(one) if one.is_dir() else one.unlink()


def list_scheduled(folder: Path) -> list[Path]:
    """List the scheduled backups in a folder, the oldest first."""
    return sorted(folder.glob(f"{SCHEDULED}*.db"))


def restore(url: str, source: Path) -> Path | None:
    """Replace the content of a database by a backup, after a copy of the present content.

    Servers on the database continue with the restored content; their running jobs
    are dropped, and runs that were running in the backup are queued again. Who writes waits from
    before the copy until the content is replaced: all that was acknowledged is in one of them.

    Damaged rows and samples in the backup cause a warning, not an error: no other copy may
    exist, and damaged samples are not used.

    Returns
    -------
    pathlib.Path or None
        Copy of the previous content, beside the database, or beside the backup for a database of
        a server; None if there was none.

    Raises
    ------
    BadInput
        If the backup is damaged or not a database of flexsid.
    DatabaseTooNew
        If a newer release made the backup.
    """
    if not source.is_file():
        raise BadInput(f"there is no backup {source}")
    try:
        check(source)
    except DatabaseUnavailable as error:
        raise BadInput(f"{source} is not a valid backup: {error.message}") from error
    check_samples(source)
    damaged = find_damaged(source)
    if damaged:
        _log.warning(
            "%s is damaged (%s); damaged samples are not used; run `flexsid check` to list the"
            " maneuvers to be imported again, and the rows that were changed",
            source,
            ", ".join(damaged[:5]),
        )
    moment = datetime.now(UTC).strftime("%Y%m%d-%H%M%S-%f")
    file = sqlite_file(parse_url(url))
    if file is None:
        return _restore_on_server(url, source, f"before-restore-{moment}")
    return _restore_file(file, source, f"before-restore-{moment}")


def _restore_file(
    target: Path, source: Path, ending: str, *, has_samples: bool = True
) -> Path | None:
    beside = target.with_name(f"{target.name}.{ending}")
    last = read_last_number(target)
    previous = beside if target.exists() and target.stat().st_size > 0 else None
    if previous is None:
        _move_remains(target, beside)
        upgrade(f"sqlite:///{target}")
    with _upgraded_copy(source, target.parent, has_samples=has_samples) as ready:
        if _is_intact(target):
            written = _replace_tables(target, ready, previous, last)
        else:  # tables cannot be dropped; all pages are overwritten
            with new_file(beside) as partial:
                _copy(target, partial)
            written = _make_ready(ready, target, last)
            _copy(ready, target)
    note(target, written)
    accept_losses(target)
    return previous


def _is_intact(file: Path) -> bool:
    try:
        check(file)
    except DatabaseUnavailable:
        return False
    return True


def _replace_tables(target: Path, ready: Path, previous: Path | None, last: int) -> Written:
    """Copy a database to a new file and replace its tables, while writers wait."""
    try:
        with closing(sqlite3.connect(target, timeout=30.0, isolation_level=None)) as writing:
            add_seal_function(writing)
            writing.execute("ATTACH ? AS restored", (str(ready),))
            writing.execute("BEGIN IMMEDIATE")
            if previous is not None:
                with new_file(previous) as partial:
                    _copy(target, partial)
            epoch, given = _read_epoch(writing), _read_given_ids(writing)
            replace_tables(writing, "restored")
            _end_running_jobs(writing, epoch)
            _retain_given_ids(given, writing)
            written = number_transaction(writing, after=last)
            writing.execute("COMMIT")
            return written
    except sqlite3.Error as error:
        raise DatabaseUnavailable(f"{target} cannot be replaced: {error}") from error


def _restore_on_server(url: str, source: Path, ending: str) -> Path | None:
    parsed = parse_url(url)
    engine = make_engine(parsed)
    try:
        with translate_errors(), engine.connect() as connection:
            is_new = not sa.inspect(connection).has_table("alembic_version")
        upgrade(url)
        previous = None if is_new else source.with_name(f"{source.name}.{ending}")
        with (
            _upgraded_copy(source, source.parent) as ready,
            _open_copy(ready) as copy,
            translate_errors(),
            engine.begin() as target,
        ):
            lock_tables(target)
            if previous is not None:
                with new_file(previous) as partial:  # damaged or not
                    _copy_rows(target, partial)
                    _make_single_file(partial)
            epoch = target.exec_driver_sql("SELECT max(epoch) FROM leases").scalar_one()
            with closing(sqlite3.connect(ready, isolation_level=None)) as restored:
                add_seal_function(restored)
                _end_running_jobs(restored, epoch or 0)
            with copy.connect() as reading:
                copy_rows(reading, target)
    finally:
        engine.dispose()
    return previous


@contextmanager
def _upgraded_copy(source: Path, folder: Path, *, has_samples: bool = True) -> Iterator[Path]:
    """Yield a complete copy of a backup with the newest schema, which is deleted afterwards."""
    with tempfile.TemporaryDirectory(dir=folder) as name:
        ready = Path(name) / "ready.db"
        ready.touch(mode=0o600)
        _copy(source, ready)
        if has_samples:
            include_samples(ready, source.parent)
        upgrade(f"sqlite:///{ready}")
        yield ready


@contextmanager
def _open_copy(file: Path) -> Iterator[sa.Engine]:
    engine = make_engine(parse_url(f"sqlite:///{file}"), foreign_keys=False)
    try:
        yield engine
    finally:
        engine.dispose()


def try_restore(source: Path) -> None:
    """Restore a backup into a temporary database beside it, which is deleted.

    Without samples of the shared file: a large database is not to be written as a whole.

    Raises
    ------
    DatabaseTooNew
        As ``restore``.
    DatabaseUnavailable
        If the restored database is damaged.
    """
    with tempfile.TemporaryDirectory(dir=source.parent, prefix=_TESTED) as folder:
        restored = Path(folder) / "restored.db"
        _restore_file(restored, source, "", has_samples=False)
        check(restored)


def _move_remains(target: Path, beside: Path) -> None:
    """Rename an empty file, and log and mark of a missing one, to make room for a new one."""
    for end in ("", "-wal", "-shm", "-mark"):
        one = target.with_name(f"{target.name}{end}")
        if one.exists():
            one.rename(beside.with_name(f"{beside.name}{end}"))


def check(file: Path) -> None:
    """Check the pages and foreign keys of a database of flexsid.

    Raises
    ------
    DatabaseUnavailable
        If the database is damaged.
    """
    try:
        with closing(sqlite3.connect(f"{file.absolute().as_uri()}?mode=ro", uri=True)) as opened:
            found = [row[0] for row in opened.execute("PRAGMA integrity_check(5)")]
            if found != ["ok"]:
                raise DatabaseUnavailable(f"{file} is damaged: {'; '.join(found)}")
            missing = opened.execute("PRAGMA foreign_key_check").fetchone()
            if missing is not None:
                raise DatabaseUnavailable(
                    f"{file} is damaged: a record of {missing[0]} refers to one of {missing[2]}"
                    " that does not exist"
                )
            opened.execute("SELECT version_num FROM alembic_version").fetchone()
    except sqlite3.Error as error:
        raise DatabaseUnavailable(f"{file} is not a database of flexsid: {error}") from error


def find_damaged(file: Path, *, has_samples: bool = True) -> list[str]:
    """Describe the rows that differ from their seals, and name the arrays that do from theirs.

    Without ``has_samples`` these are not read: of an incremental backup they were when written.

    Raises
    ------
    DatabaseUnavailable
        If the samples cannot be read, such as those beside an incremental backup.
    """
    with closing(sqlite3.connect(f"{file.absolute().as_uri()}?mode=ro", uri=True)) as opened:
        add_seal_function(opened)
        engine = sa.create_engine("sqlite://", creator=lambda: opened, poolclass=StaticPool)
        with engine.connect() as connection:
            rows = [str(changed) for changed in find_changed_rows(connection)]
        if not has_samples:
            return rows
        try:
            data = attach_samples(opened, file.parent)
            found = opened.execute(f"SELECT hash, dtype, shape, unit, {data} FROM arrays")
            return rows + [f"samples {row[0]}" for row in found if not is_sound(*row)]
        except sqlite3.Error as error:
            raise DatabaseUnavailable(f"the samples of {file} cannot be read: {error}") from error


def find_file(url: str) -> Path:
    """Return the file of a database.

    Raises
    ------
    BadInput
        If the database is not SQLite.
    """
    file = sqlite_file(parse_url(url))
    if file is None:
        raise BadInput(
            "the server backs up databases of SQLite only; for PostgreSQL use `flexsid backup FILE`"
            " or, at intervals, `flexsid backup FOLDER --retained 7 --every 24`"
        )
    return file


def _copy_rows_of(url: URL, target: Path, samples: Path | None = None) -> int:
    """Copy the rows of a database, in one state, into an empty file; see ``_copy_rows``."""
    server = make_engine(url)
    options: dict[str, object] = {}
    if url.get_backend_name() == "postgresql":
        options = {"isolation_level": "REPEATABLE READ", "postgresql_readonly": True}
    try:
        with translate_errors(), server.connect().execution_options(**options) as source:
            return _copy_rows(source, target, samples)
    finally:
        server.dispose()


def _copy_rows(source: Connection, target: Path, samples: Path | None = None) -> int:
    """Copy all rows into an empty file.

    With a folder of samples, these are written into its file; returns their size. [bytes]
    """
    with tempfile.TemporaryDirectory(dir=target.parent) as folder:
        made = Path(folder) / "copy.db"
        newest, empty = build_empty_database()
        made.write_bytes(empty)
        has_schema = sa.inspect(source).has_table("alembic_version")
        query = "SELECT version_num FROM alembic_version"
        present = source.exec_driver_sql(query).scalar() if has_schema else None
        if present != newest:
            raise BadInput(
                f"the database has schema {present}, this flexsid {newest}; back it up with the"
                " release that uses it, or run `flexsid migrate` first"
            )
        # The seals of the copy are made from what is read.
        _refuse_damaged([str(rows) for rows in find_changed_rows(source)], "the database")
        n_bytes = 0 if samples is None else add_samples(source, samples)
        with _open_copy(made) as copy, copy.begin() as writing:
            copy_rows(source, writing, has_samples=samples is None)
        _copy(made, target)
        return n_bytes


def _copy(source: Path, target: Path) -> None:
    """Copy all pages in one step, after waiting for writers."""
    try:
        with (
            closing(sqlite3.connect(source, timeout=30.0)) as reading,
            closing(sqlite3.connect(target, timeout=30.0)) as writing,
        ):
            reading.backup(writing, pages=-1, sleep=0.05)
    except sqlite3.Error as error:
        raise DatabaseUnavailable(f"{source} cannot be copied to {target}: {error}") from error


def _make_single_file(file: Path) -> None:
    """Leave the mode with a log beside the file, which would remain under its former name."""
    with closing(sqlite3.connect(file)) as opened:
        opened.execute("PRAGMA journal_mode = DELETE")


def _make_ready(ready: Path, target: Path, last: int) -> Written:
    """Reset the lease and the running runs, and take page size and given ids of the target."""
    with (
        closing(sqlite3.connect(target)) as present,
        closing(sqlite3.connect(ready, isolation_level=None)) as restored,
    ):
        add_seal_function(restored)
        size = present.execute("PRAGMA page_size").fetchone()[0]
        _end_running_jobs(restored, _read_epoch(present))
        _retain_given_ids(_read_given_ids(present), restored)
        restored.execute("PRAGMA journal_mode = DELETE")
        restored.execute(f"PRAGMA page_size = {size}")
        restored.execute("VACUUM")
        return number_transaction(restored, after=last)


def _end_running_jobs(restored: sqlite3.Connection, epoch: int) -> None:
    """Reset the lease, to one later than any that was given, and what held jobs under it."""
    restored.execute(
        "UPDATE leases SET holder = NULL, status = NULL, beats = 0, epoch = max(epoch, ?) + 1",
        (epoch,),
    )
    # Processes of the time of the backup do not continue their runs.
    restored.execute("UPDATE jobs SET process_id = NULL WHERE state = 'running'")
    # A backup has the job that made it, which is not to be repeated.
    restored.execute(
        "UPDATE jobs SET state = 'cancelled', finished_at = created_at"
        " WHERE kind = ? AND state IN ('queued', 'running')",
        (BACKUP,),
    )


def _read_epoch(present: sqlite3.Connection) -> int:
    """Return how often the lease was taken; 0 before there were leases."""
    query = "SELECT 1 FROM main.sqlite_master WHERE name = 'leases'"
    if not present.execute(query).fetchone():
        return 0
    return present.execute("SELECT max(epoch) FROM main.leases").fetchone()[0] or 0


def _read_given_ids(present: sqlite3.Connection) -> dict[str, int]:
    """Return the largest id that each table has given."""
    return dict(present.execute("SELECT name, seq FROM main.sqlite_sequence"))


def _retain_given_ids(given: Mapping[str, int], restored: sqlite3.Connection) -> None:
    """Continue the ids of all tables: addresses name records by them, and reports cite them."""
    known = _read_given_ids(restored)
    tables = {name for (name,) in restored.execute("SELECT name FROM main.sqlite_master")}
    for name, last in given.items():
        if name in known:
            sequence = (max(last, known[name]), name)
            restored.execute("UPDATE main.sqlite_sequence SET seq = ? WHERE name = ?", sequence)
        elif name in tables:
            row = (last, name)
            restored.execute("INSERT INTO main.sqlite_sequence (seq, name) VALUES (?, ?)", row)
