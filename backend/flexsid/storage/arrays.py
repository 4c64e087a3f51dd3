"""Bulk arrays as immutable rows, named by their content.

The name is a hash, so damaged samples give themselves away: whatever is read is compared with
its name first, which takes about a millisecond for a maneuver of a megabyte.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Iterator, Sequence
from typing import Any, TypedDict

import numpy as np
import sqlalchemy as sa
from sqlalchemy.dialects import postgresql, sqlite
from sqlalchemy.engine import Connection

from flexsid.errors import BadInput, Conflict, UnknownRecord
from flexsid.storage.array_owners import owner_of
from flexsid.storage.database import Database
from flexsid.storage.tables import arrays

_AT_ONCE = 500  # names in one query


class DamagedData(Conflict):
    """Samples that are kept are not those that were stored."""

    code = "damaged-data"


class ArrayRow(TypedDict):
    """What stands in the table; the bytes are those of the array itself, not a copy."""

    hash: str
    dtype: str
    shape: list[int]
    unit: str
    n_bytes: int
    data: memoryview | bytes


class Arrays:
    """Keeps arrays; the same content is kept once.

    Samples lie in the row as raw little-endian bytes in C order, at the
    precision they were given: no format is faster to read, one transaction
    covers an array and the record that names it, and one file is backed up.
    """

    def __init__(self, database: Database) -> None:
        self._database = database

    def put(self, array: np.ndarray, unit: str = "") -> str:
        """Keep an array and return its name.

        Parameters
        ----------
        array
            Numbers or booleans of any shape.
        unit
            Unit of the samples; belongs to the content.

        Returns
        -------
        str
            SHA-256 of type, shape, unit and bytes.
        """
        return self.put_many([describe(array, unit)])[0]

    def put_many(self, content: Sequence[ArrayRow]) -> list[str]:
        """Keep arrays that were described before and return their names."""
        rows = {row["hash"]: row for row in content}
        with self._database.transaction() as connection:
            known = {
                name
                for some in _pieces(list(rows))
                for name in connection.scalars(
                    sa.select(arrays.c.hash).where(arrays.c.hash.in_(some))
                )
            }
            new = [row for name, row in rows.items() if name not in known]
            if new:
                # On PostgreSQL another may keep the same array at the same moment.
                dialect = postgresql if connection.dialect.name == "postgresql" else sqlite
                insert = dialect.insert(arrays).on_conflict_do_nothing()
                connection.execute(insert, [dict(row) for row in new])
        return [row["hash"] for row in content]

    def get(self, name: str) -> np.ndarray:
        """Return an array; it is read-only, as what is kept never changes."""
        return self.get_many([name])[name]

    def get_many(self, names: Iterable[str]) -> dict[str, np.ndarray]:
        """Return arrays by name, each compared with its name first.

        Raises
        ------
        DamagedData
            If an array is not what was stored.
        """
        wanted = list(dict.fromkeys(names))
        columns = (arrays.c.dtype, arrays.c.shape, arrays.c.unit, arrays.c.data)
        query = sa.select(arrays.c.hash, *columns)
        found: dict[str, np.ndarray] = {}
        with self._database.reading() as connection:
            for some in _pieces(wanted):
                rows = connection.execute(query.where(arrays.c.hash.in_(some)))
                for name, dtype, shape, unit, data in rows:
                    if content_hash(dtype, shape, unit, data) != name:
                        raise damaged(connection, name)
                    found[name] = restore(dtype, shape, data)
        for name in wanted:
            if name not in found:
                raise UnknownRecord(f"there is no array {name}")
        return found


def describe(array: np.ndarray, unit: str = "") -> ArrayRow:
    """Make the row of an array, which takes no database; hashing is most of it."""
    samples = np.asarray(array)
    if samples.dtype.kind not in "biufc":
        raise BadInput(f"an array of {samples.dtype} cannot be kept; expected numbers")
    samples = np.ascontiguousarray(samples, dtype=samples.dtype.newbyteorder("<"))
    # ascontiguousarray makes a scalar one-dimensional.
    samples = samples.reshape(np.shape(array))
    data = samples.data.cast("B") if samples.size else b""
    dtype = samples.dtype.str
    return {
        "hash": content_hash(dtype, samples.shape, unit, data),
        "dtype": dtype,
        "shape": list(samples.shape),
        "unit": unit,
        "n_bytes": len(data),
        "data": data,
    }


def content_hash(dtype: str, shape: Sequence[int], unit: str, data: Any) -> str:
    """SHA-256 of type, shape, unit and bytes: the name of an array."""
    content = hashlib.sha256(f"{dtype} {tuple(shape)} {unit}\n".encode())
    content.update(data)
    return content.hexdigest()


def damaged(connection: Connection, name: str) -> DamagedData:
    """Say which record it is whose samples are not those that were stored."""
    owner = owner_of(connection, name)
    return DamagedData(
        f"the samples of {owner} are not those that were stored: their content does not match"
        f" their name {name[:12]}... Restore a backup from before the damage, or import the file"
        " again; `flexsid check` lists all that is damaged",
        owner=owner,
        array=name,
    )


def _pieces(names: list[str]) -> Iterator[list[str]]:
    return (names[first : first + _AT_ONCE] for first in range(0, len(names), _AT_ONCE))


def restore(dtype: str, shape: Sequence[int], data: Any) -> np.ndarray:
    """Give the bytes of a row their type and shape."""
    return np.frombuffer(data, dtype=np.dtype(dtype)).reshape(tuple(shape))
