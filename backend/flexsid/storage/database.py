"""Engine and transactions: SQLite in WAL mode, PostgreSQL by URL.

A transaction is on disk when it ends: a power failure loses no acknowledged data. Only a ``lax``
transaction, of data that are written again within seconds, may be lost.
"""

from __future__ import annotations

import json
import re
import sqlite3
import threading
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path
from typing import Any

import orjson
import sqlalchemy as sa
from sqlalchemy import event
from sqlalchemy.engine import URL, Connection, Engine, make_url
from sqlalchemy.exc import (
    ArgumentError,
    DatabaseError,
    DontWrapMixin,
    OperationalError,
)
from sqlalchemy.pool import ConnectionPoolEntry, StaticPool

from flexsid.errors import BadInput
from flexsid.storage.access import add_access_control
from flexsid.storage.audit_recording import add_recording, recording_changes
from flexsid.storage.files import DatabaseUnavailable
from flexsid.storage.rows import add_seal_function
from flexsid.storage.write_mark import (
    Written,
    accept_losses,
    find_losses,
    identify,
    note,
    number_transaction,
)

_WRITES = "flexsid_writes"
_LAX = "flexsid_lax"
_WAITS_MS = "flexsid_waits_ms"
_LOG = "flexsid_log"
_LONGEST_WAIT_MS = 30_000
"""Longest time for which a writer waits for the lock of SQLite."""
_LONGEST_PAUSE_S = 60
"""Longest pause within a transaction on PostgreSQL, which then ends it: a stopped process, or one
on a computer that is gone, would hold its locks for hours. [s]"""
_ENDED = "25P03"  # of a transaction that paused for longer
_ALONE = 0x666C6578  # any number not used by other advisory locks


class NotFinite(BadInput, DontWrapMixin):
    """A number to be stored is NaN or infinite."""

    code = "not-finite"


class NotText(BadInput, DontWrapMixin):
    """A text to be stored holds characters that a database cannot store."""

    code = "bad-text"


def parse_url(url: str) -> URL:
    """Read a database address, e.g. ``sqlite:///var/flexsid.db``."""
    try:
        parsed = make_url(url)
        if parsed.drivername == "postgresql":
            parsed = parsed.set(drivername="postgresql+psycopg")
        parsed.get_dialect()
    except ArgumentError as error:
        raise BadInput(
            f"{url!r} is not a database address; expected one like sqlite:///var/flexsid.db"
        ) from error
    if parsed.get_backend_name() not in ("sqlite", "postgresql"):
        raise BadInput(
            f"flexsid stores its data in SQLite or PostgreSQL, not in {parsed.get_backend_name()}; "
            "name a database like sqlite:///var/flexsid.db or postgresql://user@host/flexsid"
        )
    if parsed.get_backend_name() == "sqlite" and parsed.database in (None, "", ":memory:"):
        raise BadInput("a database in memory cannot be shared with the workers; name a file")
    return parsed


def sqlite_file(url: URL) -> Path | None:
    """Return the file of an SQLite database, None for other databases."""
    if url.get_backend_name() != "sqlite" or url.database is None:
        return None
    return Path(url.database)


@contextmanager
def translate_errors() -> Iterator[None]:
    """Raise DatabaseUnavailable where a database is locked, damaged or not a database."""
    try:
        yield
    except DatabaseError as error:
        # Other subclasses denote an invalid statement, not an unavailable database.
        is_ended = getattr(error.orig, "sqlstate", None) == _ENDED
        if type(error) not in (DatabaseError, OperationalError) and not is_ended:
            raise
        raise DatabaseUnavailable(f"the database does not respond: {error.orig}") from error
    except UnicodeDecodeError as error:  # of names in the schema, in a message of SQLite
        raise DatabaseUnavailable("the database is damaged: a text in it is not UTF-8") from error


def make_engine(url: URL, *, foreign_keys: bool = True) -> Engine:
    """Return an engine; on SQLite in WAL mode, without lost updates.

    ``foreign_keys`` is off only while migrations rebuild tables.

    Notes
    -----
    Writers use BEGIN IMMEDIATE and wait for the lock; a deferred BEGIN fails
    with "database is locked" as soon as two transactions that have read try to
    write, and the default of the driver loses updates. With ``synchronous = NORMAL``
    a commit in WAL mode does not wait for the disk, and a power failure reverts it.
    """
    file = sqlite_file(url)
    if file is None:
        return _make_postgresql_engine(url)
    if not file.parent.is_dir():
        raise DatabaseUnavailable(f"the folder of the database {file} does not exist")
    # Never created on opening: a missing or empty file is a loss of data to be reported.
    address = f"{file.absolute().as_uri()}?mode=rw"
    engine = sa.create_engine(
        url,
        creator=lambda: sqlite3.connect(address, uri=True, check_same_thread=False),
        **_JSON,
    )
    event.listen(engine, "before_cursor_execute", _check_text)
    log = file.with_name(f"{file.name}-wal")
    opened: list[tuple[int, int]] = []  # device and inode of the file

    @event.listens_for(engine, "connect")
    def _prepare(connection: sqlite3.Connection, record: ConnectionPoolEntry) -> None:
        if not opened:
            opened.append(identify(file))
        connection.isolation_level = None  # transactions begin explicitly
        add_seal_function(connection)
        for pragma in (
            f"busy_timeout = {_LONGEST_WAIT_MS}",
            "journal_mode = WAL",
            "synchronous = FULL",
            "journal_size_limit = 67108864",
            f"foreign_keys = {'ON' if foreign_keys else 'OFF'}",
            "user_version",  # reading creates the log
        ):
            connection.execute(f"PRAGMA {pragma}")
        record.info[_LOG] = identify(log)  # which stays until the last connection is closed

    @event.listens_for(engine, "begin")
    def _begin(connection: Connection) -> None:
        if identify(file) != opened[0] or identify(log) != connection.info[_LOG]:
            raise DatabaseUnavailable(
                f"the database {file} or its log (-wal) was deleted, or replaced by another file,"
                " while this program used it: what it would write is lost. Stop all programs that"
                " use the database; put the file back, or restore a backup by `flexsid restore`",
                code="database-replaced",
            )
        options = connection.get_execution_options()
        # These have no effect within a transaction, and persist for the connection.
        connection.exec_driver_sql(
            f"PRAGMA busy_timeout = {options.get(_WAITS_MS, _LONGEST_WAIT_MS)}"
        )
        if options.get(_WRITES, False):
            level = "NORMAL" if options.get(_LAX, False) else "FULL"
            connection.exec_driver_sql(f"PRAGMA synchronous = {level}")
            connection.exec_driver_sql("BEGIN IMMEDIATE")
        else:
            connection.exec_driver_sql("BEGIN")

    return engine


def get_driver_connection(connection: Connection) -> sqlite3.Connection:
    """Return the connection of SQLite beneath one of SQLAlchemy."""
    opened = connection.connection.driver_connection
    assert isinstance(opened, sqlite3.Connection)
    return opened


def make_memory_engine(connection: sqlite3.Connection) -> Engine:
    """Return an engine on a database in memory, whose one connection all threads share."""
    connection.isolation_level = None
    return sa.create_engine("sqlite://", creator=lambda: connection, poolclass=StaticPool, **_JSON)


def _make_postgresql_engine(url: URL) -> Engine:
    try:
        # Pinged before use: the server may have been restarted.
        engine = sa.create_engine(url, pool_pre_ping=True, pool_size=10, **_JSON)
    except ModuleNotFoundError as error:
        raise BadInput(
            "PostgreSQL needs the extra `postgresql`: pip install 'flexsid[postgresql]'"
        ) from error
    event.listen(engine, "before_cursor_execute", _check_text)

    @event.listens_for(engine, "connect")
    def _prepare(connection: Any, _record: object) -> None:
        with connection.cursor() as cursor:
            cursor.execute(
                "SELECT set_config('idle_in_transaction_session_timeout', %s, false)",
                (f"{_LONGEST_PAUSE_S}s",),
            )
            # A server may be configured to acknowledge commits before they are on disk.
            cursor.execute(
                "SELECT set_config('synchronous_commit', 'on', false)"
                " WHERE current_setting('synchronous_commit') = 'off'"
            )
            # Compiling the counts of large lists takes longer than it saves.
            cursor.execute("SELECT set_config('jit', 'off', false)")
        connection.commit()

    @event.listens_for(engine, "begin")
    def _begin(connection: Connection) -> None:
        options = connection.get_execution_options()
        if options.get(_LAX, False):
            connection.exec_driver_sql("SET LOCAL synchronous_commit = off")
        if _WAITS_MS in options:
            connection.exec_driver_sql(f"SET LOCAL lock_timeout = {options[_WAITS_MS]}")

    return engine


class Database:
    """One engine, and the current transaction or reading of each thread.

    Parameters
    ----------
    url
        Address of the database.
    engine
        Engine of a database in memory; by default one of the address.
    """

    def __init__(
        self, url: str, engine: Engine | None = None, site_key: Path | None = None
    ) -> None:
        self.url = parse_url(url)
        self.site_key = site_key
        self._file = sqlite_file(self.url) if engine is None else None
        self.engine = make_engine(self.url) if engine is None else engine
        add_access_control(self.engine)
        add_recording(self.engine)
        self._writing_engine = self.engine.execution_options(**{_WRITES: True})
        self._lax_engine = self._writing_engine.execution_options(**{_LAX: True})
        self._reading_engine = self.engine
        if self.url.get_backend_name() == "postgresql":
            self._reading_engine = self.engine.execution_options(
                isolation_level="REPEATABLE READ", postgresql_readonly=True
            )
        self._of_thread = threading.local()

    def close(self) -> None:
        """Close all connections."""
        self.engine.dispose()

    @contextmanager
    def transaction(
        self, *, lax: bool = False, within_s: float | None = None
    ) -> Iterator[Connection]:
        """Write all or nothing; a transaction inside another joins it.

        Parameters
        ----------
        lax
            A power failure may revert the data, e.g. beats and progress, which are written
            every few seconds.
        within_s
            Longest wait for the lock of a writer; half a minute without it.
        """
        current = self._writing
        if current is not None:
            if self._is_lax and not lax:
                raise RuntimeError("a durable transaction cannot be nested in a lax transaction")
            yield current
            return
        if self._reading is not None:
            raise RuntimeError("a transaction cannot be nested in a reading")
        engine = self._lax_engine if lax else self._writing_engine
        if within_s is not None:
            engine = engine.execution_options(**{_WAITS_MS: round(1000 * within_s)})
        written: Written | None = None
        with translate_errors(), engine.begin() as connection:
            self._of_thread.writing, self._of_thread.lax = connection, lax
            before = 0 if self._file is None else get_driver_connection(connection).total_changes
            try:
                with nullcontext() if lax else recording_changes(connection):
                    yield connection
            finally:
                self._of_thread.writing = None
            if self._file is not None and not lax:
                opened = get_driver_connection(connection)
                if opened.total_changes != before:
                    written = number_transaction(opened)
        if self._file is not None and written is not None:
            note(self._file, written)

    def lock_writers(self, connection: Connection) -> None:
        """Block other transactions that take this lock until the present one ends."""
        if connection.dialect.name == "postgresql":  # SQLite has one writer
            connection.execute(sa.select(sa.func.pg_advisory_xact_lock(_ALONE)))

    def check_writing(self, within_s: float) -> None:
        """Take the lock of a writer, and leave it.

        Raises
        ------
        DatabaseUnavailable
            If it is not free within this time.
        """
        engine = self._writing_engine.execution_options(**{_WAITS_MS: round(1000 * within_s)})
        with translate_errors(), engine.begin() as connection:
            if connection.dialect.name == "postgresql":
                connection.exec_driver_sql("LOCK TABLE leases IN ROW EXCLUSIVE MODE")

    def find_losses(self) -> list[str]:
        """Describe acknowledged transactions that are not in the file, until they are accepted."""
        if self._file is None:
            return []
        with translate_errors(), self.engine.connect() as connection, connection.begin():
            return find_losses(self._file, get_driver_connection(connection))

    def accept_losses(self) -> None:
        """Describe losses that were found no longer."""
        if self._file is not None:
            accept_losses(self._file)

    @contextmanager
    def reading(self) -> Iterator[Connection]:
        """Read one consistent state; a nested reading uses the state of the outer one."""
        current = self._writing or self._reading
        if current is not None:
            yield current
            return
        with translate_errors(), self._reading_engine.connect() as connection:
            self._of_thread.reading = connection
            try:
                yield connection
            finally:
                self._of_thread.reading = None

    @property
    def in_transaction(self) -> bool:
        """Whether this thread is in a transaction that writes."""
        return self._writing is not None

    @property
    def _writing(self) -> Connection | None:
        return getattr(self._of_thread, "writing", None)

    @property
    def _is_lax(self) -> bool:
        return getattr(self._of_thread, "lax", False)

    @property
    def _reading(self) -> Connection | None:
        return getattr(self._of_thread, "reading", None)


def _check_text(
    _connection: Connection,
    _cursor: object,
    _statement: str,
    parameters: Any,
    _context: object,
    many: bool,
) -> None:
    """Reject text that PostgreSQL cannot store, on both databases and in every statement.

    Input is checked at the entry points; this check covers all other text.
    """
    for row in parameters if many else (parameters,):
        for value in row.values() if isinstance(row, dict) else row or ():
            if isinstance(value, str) and ("\x00" in value or not _is_unicode(value)):
                raise NotText(
                    "a text holds the character U+0000 or an unpaired surrogate; remove it"
                )


def _is_unicode(text: str) -> bool:
    try:
        text.encode()
    except UnicodeEncodeError:
        return False
    return True


def _to_json(value: Any) -> str:
    """Return JSON; NaN is rejected, so that it is never read as a number."""
    try:
        text = json.dumps(value, allow_nan=False, separators=(",", ":"), ensure_ascii=False)
    except ValueError as error:
        raise NotFinite(
            f"a record cannot be stored ({error}); unknown numbers must be None"
        ) from error
    if _ESCAPED_NUL.search(text):
        raise NotText("a text holds the character U+0000; remove it")
    return text


_ESCAPED_NUL = re.compile(r"(?<!\\)(?:\\\\)*\\u0000")
_JSON: dict[str, Any] = {"json_serializer": _to_json, "json_deserializer": orjson.loads}
