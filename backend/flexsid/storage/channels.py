"""Channels of a maneuver or a whole flight together with their samples, in one statement."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from operator import itemgetter
from typing import Any, TypeVar

import numpy as np

from flexsid.records.maneuver import Channel, FlightChannel, Role
from flexsid.storage.arrays import HASH_BYTES, build_damage_error, is_intact
from flexsid.storage.database import Database
from flexsid.storage.files import DatabaseUnavailable
from flexsid.storage.tables import arrays, channels, flight_channels

_Kind = TypeVar("_Kind", Channel, FlightChannel)
_ROLES = {role.value: role for role in Role}


def read_channels(
    database: Database, maneuver_id: int, names: Sequence[str] | None = None
) -> dict[str, tuple[Channel, np.ndarray]]:
    """Read channels of a maneuver with their samples, by name, in the order of the record.

    Parameters
    ----------
    database
        The database.
    maneuver_id
        Id of the maneuver.
    names
        Names of channels, all with None; names that are not recorded are omitted.

    Returns
    -------
    dict
        Channels with samples in native unit and precision, read-only.

    Raises
    ------
    DamagedData
        If samples are not what was stored.
    """
    return _read(database, Channel, channels.name, "maneuver_id", maneuver_id, names)


def read_flight_channels(
    database: Database, flight_id: int, names: Sequence[str] | None = None
) -> dict[str, tuple[FlightChannel, np.ndarray]]:
    """Read channels of a whole flight; see ``read_channels``.

    The array of a channel in chunks has the names of its chunks, (n_chunks, 32) bytes.
    """
    return _read(database, FlightChannel, flight_channels.name, "flight_id", flight_id, names)


def _read(
    database: Database,
    kind: type[_Kind],
    table: str,
    key: str,
    identity: int,
    names: Sequence[str] | None,
) -> dict[str, tuple[_Kind, np.ndarray]]:
    requested = None if names is None else tuple(dict.fromkeys(names))
    if requested == ():
        return {}
    fields = tuple(kind.__dataclass_fields__)
    with database.reading() as connection:
        mark = "?" if connection.dialect.paramstyle == "qmark" else "%s"
        query = _query(table, key, fields, mark, None if requested is None else len(requested))
        cursor = connection.connection.cursor()
        try:
            cursor.execute(query, (identity, *(requested or ())))
            rows = cursor.fetchall()
        except connection.dialect.loaded_dbapi.Error as error:
            raise DatabaseUnavailable(f"the database does not respond: {error}") from error
        finally:
            cursor.close()
    # Sorted here: the database would sort the samples with their rows.
    rows = sorted(rows, key=itemgetter(fields.index("id")))
    found: dict[str, tuple[_Kind, np.ndarray]] = {}
    for row in rows:
        channel, (checksum, unit, dtype, data) = _record(kind, fields, row), row[-4:]
        shape = _find_shape(channel)
        if not is_intact(channel.array, checksum, dtype, shape, unit, data):
            with database.reading() as connection:
                raise build_damage_error(connection, channel.array)
        found[channel.name] = channel, np.frombuffer(data, dtype).reshape(shape)
    return found


def _find_shape(channel: Channel | FlightChannel) -> tuple[int, ...]:
    if isinstance(channel, FlightChannel) and channel.samples_per_chunk is not None:
        return -(-channel.n_samples // channel.samples_per_chunk), HASH_BYTES
    return (channel.n_samples,)


@lru_cache(maxsize=256)
def _query(table: str, key: str, fields: tuple[str, ...], mark: str, n_names: int | None) -> str:
    """Return plain SQL for the driver: SQLAlchemy would double the time of the query."""
    # Quoted: ``array`` is a reserved word of PostgreSQL.
    columns = ", ".join(f'{table}."{name}"' for name in fields)
    selection = "" if n_names is None else f" AND name IN ({', '.join([mark] * n_names)})"
    return (
        f"SELECT {columns}, checksum, arrays.unit, dtype, data FROM {table} "
        f'JOIN {arrays.name} ON hash = "array" WHERE {key} = {mark}{selection}'
    )


def _record(kind: type[_Kind], fields: tuple[str, ...], row: Sequence[Any]) -> _Kind:
    values = dict(zip(fields, row, strict=False))
    values["role"] = _ROLES[values["role"]]
    return kind(**values)
