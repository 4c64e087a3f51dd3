"""Channels of one maneuver together with their samples, in one statement."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from operator import itemgetter
from typing import Any

import numpy as np

from flexsid.records.maneuver import Channel, Role
from flexsid.storage.database import Database, DatabaseUnavailable
from flexsid.storage.tables import arrays, channels

_FIELDS = tuple(Channel.__dataclass_fields__)
_NAME = _FIELDS.index("name")
_ROLES = {role.value: role for role in Role}
_identity = itemgetter(_FIELDS.index("id"))


def read_channels(
    database: Database, maneuver_id: int, names: Sequence[str] | None = None
) -> dict[str, tuple[Channel, np.ndarray]]:
    """Read channels of a maneuver with their samples, by name, in the order of the record.

    Parameters
    ----------
    database
        Where they are.
    maneuver_id
        Of the maneuver.
    names
        Which channels, all with None; a name that is not recorded is left out.

    Returns
    -------
    dict
        Channels with samples in native unit and precision, which cannot be written to.
    """
    asked = None if names is None else tuple(dict.fromkeys(names))
    if asked == ():
        return {}
    with database.reading() as connection:
        mark = "?" if connection.dialect.paramstyle == "qmark" else "%s"
        query = _query(mark, None if asked is None else len(asked))
        cursor = connection.connection.cursor()
        try:
            cursor.execute(query, (maneuver_id, *(asked or ())))
            rows = cursor.fetchall()
        except connection.dialect.loaded_dbapi.Error as error:
            raise DatabaseUnavailable(f"the database does not answer: {error}") from error
        finally:
            cursor.close()
    # Sorted here, for the database would sort the samples with their rows.
    ordered = sorted(rows, key=_identity)
    return {row[_NAME]: (_channel(row), np.frombuffer(row[-1], row[-2])) for row in ordered}


@lru_cache(maxsize=256)
def _query(mark: str, n_names: int | None) -> str:
    """Plain SQL for the driver: SQLAlchemy around it takes as long as the answer of SQLite."""
    fields = ", ".join(f"{channels.name}.{name}" for name in _FIELDS)
    chosen = "" if n_names is None else f" AND name IN ({', '.join([mark] * n_names)})"
    return (
        f"SELECT {fields}, dtype, data FROM {channels.name} "
        f"JOIN {arrays.name} ON hash = array WHERE maneuver_id = {mark}{chosen}"
    )


def _channel(row: Sequence[Any]) -> Channel:
    values = dict(zip(_FIELDS, row, strict=False))
    values["role"] = _ROLES[values["role"]]
    return Channel(**values)
