"""Mark of a database of SQLite: the last transactions that were acknowledged, beside its file.

A database whose log was deleted after a kill, or whose file was replaced by an earlier copy, is
intact, and without what was acknowledged since. Each durable transaction numbers itself in the
header of the file, and is noted in the mark afterwards.

Notes
-----
The header holds the number (``user_version``) and a random value (``application_id``) of the last
transaction, so that they are committed, copied and lost with it. The mark is not synced: after a
power failure it may lag, so that a later number in the file is no loss. Each transaction has a line
of its own, for several processes may note theirs in another order than that of their commits.
"""

from __future__ import annotations

import logging
import os
import secrets
import sqlite3
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

_log = logging.getLogger(__name__)

_LINES = 64  # more than processes that note a transaction at the same time
_BYTES = 80  # of a line
_LAST = 2**31 - 1  # number that the header holds


@dataclass(frozen=True, slots=True)
class Written:
    """Number and random value of a transaction; zeros of a database without any."""

    number: int
    value: int


def find_mark(file: Path) -> Path:
    """Return the file of the mark of a database."""
    return file.with_name(f"{file.name}-mark")


def identify(file: Path) -> tuple[int, int]:
    """Return device and inode of a file; zeros if there is none."""
    try:
        found = file.stat()
    except OSError:
        return 0, 0
    return found.st_dev, found.st_ino


def number_transaction(connection: sqlite3.Connection, *, after: int = 0) -> Written:
    """Give the present transaction the next number, one later than ``after``."""
    last = max(_read_header(connection).number, after)
    written = Written(min(last + 1, _LAST), secrets.randbits(31))
    connection.execute(f"PRAGMA user_version = {written.number}")
    connection.execute(f"PRAGMA application_id = {written.value}")
    return written


def note(file: Path, written: Written) -> None:
    """Note a transaction that is committed. It is acknowledged, though it cannot be noted."""
    line = f"{written.number} {written.value} {' '.join(map(str, identify(file)))}"
    try:
        number = os.open(find_mark(file), os.O_WRONLY | os.O_CREAT, 0o600)
        try:
            os.pwrite(number, f"{line:<{_BYTES - 1}}\n".encode(), written.number % _LINES * _BYTES)
        finally:
            os.close(number)
    except OSError as error:
        _log.warning("%s cannot be written: %s", find_mark(file), error.strerror)


def read_last_number(file: Path) -> int:
    """Return the number of the last transaction that was noted; 0 if there is none."""
    return max((written.number for written, _ in _read(file)), default=0)


def find_losses(file: Path, opened: sqlite3.Connection) -> list[str]:
    """Compare a database with its mark; describe what was lost, now and found earlier.

    A loss is described until it is accepted, although later transactions take its numbers.
    ``opened`` has read nothing in its present transaction.
    """
    noted = _read(file)  # before the header: others write meanwhile
    found = _read_header(opened)
    loss = _describe(found, noted, identify(file))
    if loss is not None:
        _log.error("%s: %s", file, loss)
        _find_losses_file(file).touch(mode=0o600)
        with _find_losses_file(file).open("a", encoding="utf-8") as losses:
            losses.write(f"{loss}\n")
        find_mark(file).unlink(missing_ok=True)
        note(file, found)
    with suppress(FileNotFoundError):
        return _find_losses_file(file).read_text(encoding="utf-8").splitlines()
    return []


def accept_losses(file: Path) -> None:
    """Describe losses that were found no longer."""
    _find_losses_file(file).unlink(missing_ok=True)


def _find_losses_file(file: Path) -> Path:
    return file.with_name(f"{file.name}-losses")


def _read_header(connection: sqlite3.Connection) -> Written:
    number, value = connection.execute(
        "SELECT user_version, application_id FROM pragma_user_version, pragma_application_id"
    ).fetchone()
    return Written(number, value)


def _read(file: Path) -> list[tuple[Written, tuple[int, int]]]:
    """Return the noted transactions, with device and inode of the file at that time."""
    try:
        text = find_mark(file).read_bytes().decode("ascii", "replace")
    except FileNotFoundError:
        return []
    noted = []
    for line in text.replace("\0", " ").splitlines():
        with suppress(ValueError):  # damaged or empty
            number, value, device, inode = map(int, line.split())
            noted.append((Written(number, value), (device, inode)))
    return noted


def _describe(
    found: Written, noted: list[tuple[Written, tuple[int, int]]], identity: tuple[int, int]
) -> str | None:
    if not noted:
        return None
    last, then = max(noted, key=lambda one: one[0].number)
    if found.number < last.number:
        lost = last.number - found.number
        return (
            f"The last {lost} acknowledged transactions are not in the database, which ends with"
            f" number {found.number} of {last.number}: its log (-wal) was deleted, or its file"
            " replaced by an earlier copy."
        )
    is_other = found.number > last.number and identity != then
    if is_other or (found.number == last.number and found != last):
        return (
            f"The file of the database was replaced by another one: its transaction {last.number}"
            " is not the one that was acknowledged."
        )
    return None
