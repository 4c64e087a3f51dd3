"""Samples of incremental backups: one file, which all backups of a folder share.

Samples are most of a large database. They are named by their content and never change, so that each
array is written once, however many backups have it; the rows of an incremental backup name their
arrays without data.
"""

from __future__ import annotations

import json
import logging
import sqlite3
from collections.abc import Iterable, Iterator
from contextlib import closing, contextmanager, suppress
from pathlib import Path

import sqlalchemy as sa
from sqlalchemy.engine import Connection

from flexsid.errors import BadInput
from flexsid.storage.arrays import hash_array
from flexsid.storage.files import PAGE_BYTES, DatabaseUnavailable, new_file
from flexsid.storage.tables import arrays

SAMPLES = "samples.db"
"""Name of the file in the folder of backups."""

_log = logging.getLogger(__name__)

_IS_APART = "length(data) = 0 AND n_bytes > 0"
_AT_ONCE = 4  # arrays, of up to hundreds of megabytes each
PARTS = 7
"""Backups within which all arrays of the file are compared with their names."""
_TABLE = """CREATE TABLE arrays (
    hash TEXT PRIMARY KEY, dtype TEXT NOT NULL, shape TEXT NOT NULL, unit TEXT NOT NULL,
    data BLOB NOT NULL)"""
_CHECKS = """CREATE TABLE IF NOT EXISTS checks (hash TEXT PRIMARY KEY, number INTEGER NOT NULL)
    WITHOUT ROWID"""


def add_samples(source: Connection, folder: Path) -> int:
    """Write the arrays of a database that the file does not have yet.

    Some that it has are compared with their names first, those that were not for longest: damaged
    ones are written again. To compare all would read a large database each time.

    Parameters
    ----------
    source
        Connection to a database, in one consistent state.
    folder
        Folder of backups.

    Returns
    -------
    int
        Size of what was written. [bytes]

    Raises
    ------
    DatabaseUnavailable
        If samples of the database are damaged, or the file cannot be read.
    """
    file, n_bytes = folder / SAMPLES, 0
    if not file.exists():
        # A single file, without the log of a database in use.
        with suppress(FileExistsError), new_file(file) as partial, _open(partial) as opened:
            opened.execute(f"PRAGMA page_size = {PAGE_BYTES}")
            opened.execute(_TABLE)
    with _open(file) as opened:
        opened.execute(_CHECKS)
        _delete_damaged(opened)
        present = {name for (name,) in opened.execute("SELECT hash FROM arrays")}
        names = source.scalars(sa.select(arrays.c.hash).order_by(arrays.c.hash)).all()
        new = [name for name in names if name not in present]
        for first in range(0, len(new), _AT_ONCE):
            some = arrays.c.hash.in_(new[first : first + _AT_ONCE])
            columns = (arrays.c[name] for name in ("hash", "dtype", "shape", "unit", "data"))
            rows = [tuple(row) for row in source.execute(sa.select(*columns).where(some))]
            # pyrefly: ignore[bad-unpacking]
            for name, dtype, shape, unit, data in rows:
                if hash_array(dtype, shape, unit, data) != name:
                    raise DatabaseUnavailable(
                        f"samples {name} are damaged; run `flexsid check` to list all damage and"
                        " the remedies",
                        code="damaged-data",
                    )
                n_bytes += len(data)
            _write(opened, rows)
    return n_bytes


def _write(opened: sqlite3.Connection, rows: Iterable[tuple]) -> None:
    """Write some arrays; what is written stays if the backup is interrupted."""
    with opened:
        opened.execute("BEGIN IMMEDIATE")
        opened.executemany(
            "INSERT OR IGNORE INTO arrays VALUES (?, ?, ?, ?, ?)",
            (
                (name, dtype, json.dumps(shape), unit, data)
                for name, dtype, shape, unit, data in rows
            ),
        )


def _delete_damaged(opened: sqlite3.Connection) -> None:
    """Compare arrays with their names, a part of all, and delete those that differ."""
    number, count = opened.execute(
        "SELECT (SELECT coalesce(max(number), 0) + 1 FROM checks), (SELECT count(*) FROM arrays)"
    ).fetchone()
    names = opened.execute(
        "SELECT hash FROM arrays LEFT JOIN checks USING (hash) ORDER BY number, hash LIMIT ?",
        (-(-count // PARTS),),
    ).fetchall()
    damaged = []
    for one in names:
        query = "SELECT hash, dtype, shape, unit, data FROM arrays WHERE hash = ?"
        row = opened.execute(query, one).fetchone()
        if row is not None and not is_sound(*row):
            damaged.append(one)
    with opened:
        opened.execute("BEGIN IMMEDIATE")
        opened.executemany("DELETE FROM arrays WHERE hash = ?", damaged)
        opened.executemany("REPLACE INTO checks VALUES (?, ?)", [(*one, number) for one in names])


def is_sound(name: str, dtype: str, shape: str, unit: str, data: bytes | None) -> bool:
    """Whether a row, with its shape as JSON, is what its name states."""
    try:
        return data is not None and hash_array(dtype, json.loads(shape), unit, data) == name
    except (TypeError, ValueError):  # the shape is damaged
        return False


def delete_unused_samples(folder: Path) -> None:
    """Delete the arrays that no backup of a folder names.

    No other process writes meanwhile: a backup that ends at the same time is either among them, or
    finds its arrays missing (``find_missing_samples``). None is deleted while a file that may be a
    backup cannot be read.
    """
    file = folder / SAMPLES
    if not file.exists():
        return
    with _open(file) as opened, opened:
        opened.execute("BEGIN IMMEDIATE")
        others = (one for one in folder.glob("*.db") if one.name != SAMPLES)
        try:
            used = {name for backup in others for name in _list_apart(backup)}
        except DatabaseUnavailable as error:
            _log.warning("samples of deleted backups remain: %s", error.message)
            return
        names = opened.execute("SELECT hash FROM arrays").fetchall()
        unused = [(name,) for (name,) in names if name not in used]
        opened.executemany("DELETE FROM arrays WHERE hash = ?", unused)
        opened.execute(_CHECKS)
        opened.execute("DELETE FROM checks WHERE hash NOT IN (SELECT hash FROM arrays)")


def find_missing_samples(backup: Path) -> list[str]:
    """Return the names of arrays that are neither in a backup nor in the file beside it."""
    apart, file = _list_apart(backup), backup.parent / SAMPLES
    if not apart or not file.exists():
        return apart
    with _open(file) as opened, opened:
        opened.execute("BEGIN IMMEDIATE")  # after a deletion by another process
        present = {name for (name,) in opened.execute("SELECT hash FROM arrays")}
    return [name for name in apart if name not in present]


def is_incremental(backup: Path) -> bool:
    """Whether samples of a backup are in the file that the backups of its folder share."""
    with _open(backup) as opened:
        return _has_samples_apart(opened)


def check_samples(backup: Path) -> None:
    """Refuse a backup without the file of its samples.

    Raises
    ------
    BadInput
        If the backup is incremental, and the file is not beside it.
    """
    file = backup.parent / SAMPLES
    if is_incremental(backup) and not file.is_file():
        raise BadInput(
            f"{backup} is an incremental backup, whose samples are in {SAMPLES} of the folder in"
            " which it was made; restore it there, or copy both files"
        )


def include_samples(copy: Path, folder: Path) -> None:
    """Write the samples of a copy of an incremental backup into the copy itself."""
    if not is_incremental(copy):
        return
    with _open(copy) as opened:
        expression = attach_samples(opened, folder)
        opened.execute(f"UPDATE arrays SET data = coalesce({expression}, data) WHERE {_IS_APART}")


def attach_samples(opened: sqlite3.Connection, folder: Path) -> str:
    """Make the file of a folder readable in an open backup; return the expression of the data.

    A complete backup has no samples in the file, whatever it is.
    """
    file = folder / SAMPLES
    if not _has_samples_apart(opened) or not file.is_file():
        return "data"
    opened.execute("ATTACH ? AS shared", (f"{file.absolute().as_uri()}?mode=ro",))
    found = "(SELECT s.data FROM shared.arrays AS s WHERE s.hash = arrays.hash)"
    return f"CASE WHEN {_IS_APART} THEN {found} ELSE data END"


def _has_samples_apart(opened: sqlite3.Connection) -> bool:
    return opened.execute(f"SELECT 1 FROM arrays WHERE {_IS_APART}").fetchone() is not None


def _list_apart(backup: Path) -> list[str]:
    with _open(backup) as opened:
        query = f"SELECT hash FROM arrays WHERE {_IS_APART}"
        return [name for (name,) in opened.execute(query)]


@contextmanager
def _open(file: Path) -> Iterator[sqlite3.Connection]:
    try:
        address = f"{file.absolute().as_uri()}?mode=rw"
        with closing(
            sqlite3.connect(address, uri=True, isolation_level=None, timeout=30.0)
        ) as opened:
            yield opened
    except sqlite3.Error as error:
        raise DatabaseUnavailable(
            f"{file} cannot be read or written: {error}. If the file of samples is damaged, move"
            " it away: the next incremental backup writes all samples again"
        ) from error
