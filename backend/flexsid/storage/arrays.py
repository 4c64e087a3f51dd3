"""Bulk arrays as immutable rows, named by their content.

The name is a hash. Checks, backups and capsules compare each array with its name. Reads compare it
with its checksum, which detects damage, too, and takes a fiftieth of the time; the hash decides
where they differ, and for arrays that were stored before there were checksums.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Iterator, Sequence
from typing import Any, TypedDict

import numpy as np
import sqlalchemy as sa
import xxhash
from sqlalchemy.dialects import postgresql, sqlite
from sqlalchemy.engine import Connection

from flexsid.errors import BadInput, Conflict, UnknownRecord
from flexsid.storage.array_references import find_referring_record
from flexsid.storage.database import Database
from flexsid.storage.tables import arrays

HASH_BYTES = 32
"""Bytes of a SHA-256."""

_AT_ONCE = 500  # names in one query


class DamagedData(Conflict):
    """Stored samples do not match their hash."""

    code = "damaged-data"


class ArrayRow(TypedDict):
    """Row of the table; ``data`` is a view of the array, not a copy."""

    hash: str
    dtype: str
    shape: list[int]
    unit: str
    n_bytes: int
    data: memoryview | bytes
    checksum: bytes


class Arrays:
    """Store of arrays; equal content is stored once.

    Samples are stored in the row as raw little-endian bytes in C order, in their
    original precision: no format is faster to read, one transaction
    covers an array and the record that refers to it, and one file is backed up.
    """

    def __init__(self, database: Database) -> None:
        self._database = database

    def put(self, array: np.ndarray, unit: str = "") -> str:
        """Store an array and return its name.

        Parameters
        ----------
        array
            Numbers or booleans of any shape.
        unit
            Unit of the samples; part of the content.

        Returns
        -------
        str
            SHA-256 of type, shape, unit and bytes.
        """
        return self.put_many([describe_array(array, unit)])[0]

    def put_many(self, content: Sequence[ArrayRow]) -> list[str]:
        """Store arrays from ``describe`` and return their names."""
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
                # On PostgreSQL another transaction may store the same array at the same time.
                dialect = postgresql if connection.dialect.name == "postgresql" else sqlite
                insert = dialect.insert(arrays).on_conflict_do_nothing()
                connection.execute(insert, [dict(row) for row in new])
        return [row["hash"] for row in content]

    def get(self, name: str) -> np.ndarray:
        """Return an array; it is read-only, as stored arrays never change."""
        return self.get_many([name])[name]

    def get_many(self, names: Iterable[str]) -> dict[str, np.ndarray]:
        """Return arrays by name, after comparison of each with its checksum.

        Raises
        ------
        DamagedData
            If an array is not what was stored.
        """
        requested = list(dict.fromkeys(names))
        columns = (arrays.c.dtype, arrays.c.shape, arrays.c.unit, arrays.c.data)
        query = sa.select(arrays.c.hash, arrays.c.checksum, *columns)
        found: dict[str, np.ndarray] = {}
        with self._database.reading() as connection:
            for some in _pieces(requested):
                rows = connection.execute(query.where(arrays.c.hash.in_(some)))
                for name, checksum, dtype, shape, unit, data in rows:
                    if not is_intact(name, checksum, dtype, shape, unit, data):
                        raise build_damage_error(connection, name)
                    found[name] = build_array(dtype, shape, data)
        for name in requested:
            if name not in found:
                raise UnknownRecord(f"there is no array {name}")
        return found


def describe_array(array: np.ndarray, unit: str = "") -> ArrayRow:
    """Return the row of an array; needs no database, and most of its time is hashing."""
    samples = np.asarray(array)
    if samples.dtype.kind not in "biufc":
        raise BadInput(f"an array of {samples.dtype} cannot be stored; expected numbers")
    samples = np.ascontiguousarray(samples, dtype=samples.dtype.newbyteorder("<"))
    # ascontiguousarray makes a scalar one-dimensional.
    samples = samples.reshape(np.shape(array))
    data = samples.data.cast("B") if samples.size else b""
    dtype = samples.dtype.str
    return {
        "hash": hash_array(dtype, samples.shape, unit, data),
        "dtype": dtype,
        "shape": list(samples.shape),
        "unit": unit,
        "n_bytes": len(data),
        "data": data,
        "checksum": compute_checksum(dtype, samples.shape, unit, data),
    }


def hash_array(dtype: str, shape: Sequence[int], unit: str, data: Any) -> str:
    """Return the SHA-256 of type, shape, unit and bytes: the name of an array."""
    content = hashlib.sha256(_encode_type(dtype, shape, unit))
    content.update(data)
    return content.hexdigest()


def compute_checksum(dtype: str, shape: Sequence[int], unit: str, data: Any) -> bytes:
    """Return the XXH3 (64 bits) of type, shape, unit and bytes."""
    content = xxhash.xxh3_64(_encode_type(dtype, shape, unit))
    content.update(data)
    return content.digest()


def is_intact(
    name: str, checksum: bytes | None, dtype: str, shape: Sequence[int], unit: str, data: Any
) -> bool:
    """Return whether an array is what was stored: its checksum or, if that differs, its hash."""
    if checksum is not None and checksum == compute_checksum(dtype, shape, unit, data):
        return True
    return hash_array(dtype, shape, unit, data) == name


def _encode_type(dtype: str, shape: Sequence[int], unit: str) -> bytes:
    return f"{dtype} {tuple(shape)} {unit}\n".encode()


def build_damage_error(connection: Connection, name: str) -> DamagedData:
    """Return the error that names the record with damaged samples."""
    record = find_referring_record(connection, name)
    return DamagedData(
        f"the samples of {record} are damaged: their content does not match"
        f" their name {name[:12]}... Restore a backup from before the damage, or import the file"
        " again; `flexsid check` lists all damaged records",
        record=record,
        array=name,
    )


def _pieces(names: list[str]) -> Iterator[list[str]]:
    return (names[first : first + _AT_ONCE] for first in range(0, len(names), _AT_ONCE))


def build_array(dtype: str, shape: Sequence[int], data: Any) -> np.ndarray:
    """Return the array of the bytes of a row."""
    return np.frombuffer(data, dtype=np.dtype(dtype)).reshape(tuple(shape))
