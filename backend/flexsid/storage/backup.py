"""Backup and restore of an SQLite database, while servers work with it."""

from __future__ import annotations

import json
import logging
import sqlite3
import tempfile
from contextlib import closing
from datetime import UTC, datetime
from pathlib import Path

from flexsid.errors import BadInput, Conflict
from flexsid.storage.arrays import content_hash
from flexsid.storage.database import parse_url, sqlite_file
from flexsid.storage.files import DatabaseUnavailable, new_file
from flexsid.storage.migrate import upgrade

_log = logging.getLogger(__name__)


def backup(url: str, target: Path) -> int:
    """Copy a database as it is at one moment into a new file, and check the copy.

    Parameters
    ----------
    url
        Address of an SQLite database; others may read and write it meanwhile.
    target
        A file that does not exist yet.

    Returns
    -------
    int
        Size of the copy. [bytes]

    Raises
    ------
    BadInput
        If the database is none of SQLite, or there is none.
    Conflict
        If the file exists.
    DatabaseUnavailable
        If the copy is not sound, or samples are damaged; it is not kept then.
    """
    source = _file_of(url, "pg_dump --format=custom --file=flexsid.dump")
    if not source.is_file():
        raise BadInput(f"there is no database {source}")
    if target.exists():
        raise Conflict(f"{target} exists; name a new file", code="file-exists")
    try:
        with new_file(target) as partial:
            _copy(source, partial)
            check(partial)
            damaged = find_damaged(partial)
            if damaged:
                raise DatabaseUnavailable(
                    f"{target} is not kept, for samples in {source} are not those that were stored:"
                    f" {', '.join(damaged[:5])}; `flexsid check` lists all, and what to do",
                    code="damaged-data",
                )
    except OSError as error:
        raise BadInput(f"{target} cannot be written: {error.strerror}") from error
    return target.stat().st_size


def restore(url: str, source: Path) -> Path | None:
    """Put a backup in place of what a database holds now, which is copied beside it first.

    Servers on the database go on with what was restored; the runs that they carry out
    are dropped, and those that were under way in the backup start again.

    Damaged samples in the backup are warned of, not refused: the rest may be all that is left,
    and nothing is computed with them.

    Returns
    -------
    pathlib.Path or None
        Copy of what the database held; None where there was none.

    Raises
    ------
    BadInput
        If the backup is no sound database of flexsid, or the database is none of SQLite.
    DatabaseTooNew
        If a newer release made the backup.
    """
    target = _file_of(url, "pg_restore --clean --dbname=...")
    if not source.is_file():
        raise BadInput(f"there is no backup {source}")
    try:
        check(source)
    except DatabaseUnavailable as error:
        raise BadInput(f"{source} is no sound backup: {error.message}") from error
    damaged = find_damaged(source)
    if damaged:
        _log.warning(
            "%d arrays in %s are not what was stored (the first: %s); nothing is computed with"
            " them, and `flexsid check` names the maneuvers to be imported again",
            len(damaged),
            source,
            damaged[0],
        )
    kept = None
    moment = datetime.now(UTC).strftime("%Y%m%d-%H%M%S-%f")
    beside = target.with_name(f"{target.name}.before-restore-{moment}")
    if target.exists() and target.stat().st_size > 0:
        kept = beside
        with new_file(kept) as partial:
            _copy(target, partial)
    else:
        _move_remains(target, beside)
        upgrade(url)
    with tempfile.TemporaryDirectory(dir=target.parent) as folder:
        ready = Path(folder) / "ready.db"
        ready.touch(mode=0o600)
        _copy(source, ready)
        upgrade(f"sqlite:///{ready}")
        _make_ready(ready, target)
        _copy(ready, target)
    return kept


def _move_remains(target: Path, beside: Path) -> None:
    """Move an empty file, and the log of one that is gone, out of the way of a new database."""
    for end in ("", "-wal", "-shm"):
        one = target.with_name(f"{target.name}{end}")
        if one.exists():
            one.rename(beside.with_name(f"{beside.name}{end}"))


def check(file: Path) -> None:
    """Check a database of flexsid page by page, and that no record refers to a missing one.

    Raises
    ------
    DatabaseUnavailable
        If something is wrong with it.
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
                    " that is not there"
                )
            opened.execute("SELECT version_num FROM alembic_version").fetchone()
    except sqlite3.Error as error:
        raise DatabaseUnavailable(f"{file} is no database of flexsid: {error}") from error


def find_damaged(file: Path) -> list[str]:
    """Return the names of arrays whose content is not what was stored."""
    with closing(sqlite3.connect(f"{file.absolute().as_uri()}?mode=ro", uri=True)) as opened:
        rows = opened.execute("SELECT hash, dtype, shape, unit, data FROM arrays")
        return [
            name
            for name, dtype, shape, unit, data in rows
            if content_hash(dtype, json.loads(shape), unit, data) != name
        ]


def _file_of(url: str, instead: str) -> Path:
    file = sqlite_file(parse_url(url))
    if file is None:
        raise BadInput(
            f"this copies databases of SQLite; PostgreSQL has its own way, while serving: {instead}"
        )
    return file


def _copy(source: Path, target: Path) -> None:
    """Copy all pages in one step, and wait for whoever writes meanwhile."""
    try:
        with (
            closing(sqlite3.connect(source, timeout=30.0)) as reading,
            closing(sqlite3.connect(target, timeout=30.0)) as writing,
        ):
            reading.backup(writing, pages=-1, sleep=0.05)
    except sqlite3.Error as error:
        raise DatabaseUnavailable(f"{source} cannot be copied to {target}: {error}") from error


def _make_ready(ready: Path, target: Path) -> None:
    """Let whoever leads the queue find out, and pages be as large as where they go."""
    with (
        closing(sqlite3.connect(target)) as present,
        closing(sqlite3.connect(ready, isolation_level=None)) as restored,
    ):
        size = present.execute("PRAGMA page_size").fetchone()[0]
        epoch = 0
        if present.execute("SELECT 1 FROM sqlite_master WHERE name = 'leases'").fetchone():
            epoch = present.execute("SELECT max(epoch) FROM leases").fetchone()[0]
        restored.execute(
            "UPDATE leases SET holder = NULL, status = NULL, beats = 0, epoch = max(epoch, ?) + 1",
            (epoch,),
        )
        # Whoever carried a run out when the backup was made does so no more, alive or not.
        restored.execute("UPDATE runs SET owner = NULL WHERE state = 'running'")
        restored.execute("PRAGMA journal_mode = DELETE")
        restored.execute(f"PRAGMA page_size = {size}")
        restored.execute("VACUUM")
