"""Files of an SQLite database: begun whole, on disk before they count, and read by nobody else."""

from __future__ import annotations

import logging
import os
import sqlite3
import tempfile
from collections.abc import Iterator
from contextlib import closing, contextmanager, suppress
from pathlib import Path

from flexsid.errors import FlexsidError

_log = logging.getLogger(__name__)

_PRIVATE = 0o600
_OTHERS = 0o077  # what group and others may do
# Most of a database are samples, which larger pages write and read much faster.
_PAGE_BYTES = 32768


class DatabaseUnavailable(FlexsidError):
    """The database cannot be opened or does not answer."""

    code = "database-unavailable"


def begin_database(file: Path) -> None:
    """Begin a database where there is none; let only its owner read what is there.

    Raises
    ------
    DatabaseUnavailable
        If the file is empty, or gone while its log is still there: both are damage.
    """
    log = file.with_name(f"{file.name}-wal")
    if file.exists():
        if file.stat().st_size == 0:
            raise DatabaseUnavailable(
                f"the database {file} is empty (0 bytes), which flexsid never leaves: its content"
                " is lost. Put a backup in its place with `flexsid restore`, or move the empty"
                " file away to begin a new workbench",
                code="database-empty",
            )
        close_to_others(file)
        return
    if log.exists() and log.stat().st_size > 0:
        raise DatabaseUnavailable(
            f"the database {file} is gone, but its log {log.name} is there: its content is lost."
            " Put a backup in its place with `flexsid restore`, or move the log away to begin a"
            " new workbench",
            code="database-gone",
        )
    try:
        file.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
        with new_file(file) as partial, closing(sqlite3.connect(partial)) as begun:
            # Later these would need the write lock for every connection, and have no effect.
            begun.execute(f"PRAGMA page_size = {_PAGE_BYTES}")
            begun.execute("PRAGMA auto_vacuum = INCREMENTAL")
            begun.execute("PRAGMA journal_mode = WAL")
    except FileExistsError:
        if file.is_dir() or not file.exists():
            raise DatabaseUnavailable(f"{file} is no file that a database can be in") from None
        return  # another server has begun it
    except OSError as error:
        raise DatabaseUnavailable(
            f"the folder of the database {file} cannot be written to: {error.strerror}"
        ) from error


@contextmanager
def new_file(target: Path) -> Iterator[Path]:
    """Yield a file to be filled, which then stands under its name, wholly and on disk.

    Raises
    ------
    FileExistsError
        If there is one of that name by then; it is left as it is.
    """
    number, name = tempfile.mkstemp(prefix=f"{target.name}.", suffix=".partial", dir=target.parent)
    os.close(number)  # its mode is 0600
    partial = Path(name)
    try:
        yield partial
        sync(partial)
        _give_name(partial, target)
        sync(target.parent)
    finally:
        partial.unlink(missing_ok=True)


def sync(path: Path) -> None:
    """Wait until a file, or the names in a folder, are on disk."""
    if path.is_dir() and os.name == "nt":  # has no such thing
        return
    number = os.open(path, os.O_RDONLY if path.is_dir() else os.O_RDWR)
    try:
        os.fsync(number)
    finally:
        os.close(number)


def close_to_others(file: Path) -> None:
    """Let only the owner read a database, its log and the copies beside it, and note it."""
    beside = (
        one
        for end in ("-wal", "-shm", ".backup-*", ".before-restore-*")
        for one in file.parent.glob(f"{_literally(file.name)}{end}")
    )
    for one in (file, *beside):
        with suppress(FileNotFoundError):
            mode = one.stat().st_mode & 0o777
            if os.name == "nt" or not mode & _OTHERS:
                continue
            try:
                one.chmod(_PRIVATE)
            except PermissionError:
                _log.warning(
                    "%s can be read by others (mode %o); let its owner change it to 600", one, mode
                )
            else:
                _log.warning(
                    "%s could be read by others (mode %o); now only by its owner", one, mode
                )


def close_folder(folder: Path) -> None:
    """Make a folder that only its owner reads, or take it if it is that.

    Raises
    ------
    DatabaseUnavailable
        If it is another's, as anybody can make one in a folder for temporary files.
    """
    folder.mkdir(parents=True, exist_ok=True, mode=0o700)
    if os.name == "nt":
        return
    if folder.is_symlink() or folder.stat().st_uid != os.geteuid():
        raise DatabaseUnavailable(
            f"{folder} belongs to somebody else; what is uploaded is not put there. Remove it",
            code="foreign-folder",
        )
    if folder.stat().st_mode & _OTHERS:
        folder.chmod(0o700)
        _log.warning("%s could be entered by others; now only by its owner", folder)


def _give_name(partial: Path, target: Path) -> None:
    try:
        os.link(partial, target)  # unlike rename, never in place of another
    except FileExistsError:
        raise
    except OSError:  # a file system without links
        if target.exists():
            raise FileExistsError(f"{target} exists") from None
        partial.rename(target)


def _literally(name: str) -> str:
    return "".join(f"[{letter}]" if letter in "*?[" else letter for letter in name)
