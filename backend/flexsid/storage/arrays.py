"""Bulk arrays as immutable rows, named by their content, and the records that refer to them.

The name is a hash. Checks, backups and capsules compare each array with its name. Reads compare it
with its checksum, which detects damage, too, and takes a fiftieth of the time; the hash decides
where they differ, and for arrays that were stored before there were checksums.

A figure needs one mode at up to four fuel weights; one array of all modes may have a hundred
megabytes.
"""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterable, Iterator, Sequence
from typing import Any, TypedDict

import numpy as np
import sqlalchemy as sa
import xxhash
from sqlalchemy.dialects import postgresql, sqlite
from sqlalchemy.engine import Connection

from flexsid.errors import BadInput, Conflict, UnknownRecord
from flexsid.storage import tables
from flexsid.storage.database import Database
from flexsid.storage.tables import arrays, modal_shapes

# --- Records that refer to arrays, to name them in reports of damage ------------------------------

_NAME = re.compile(r"\b[0-9a-f]{64}\b")
_GEOMETRY = re.compile(r'"geometry": *"[0-9a-f]{64}"')  # of a prediction: hash of a description
# Records that refer to arrays in nested values.
_NESTED = (
    ("modal table", tables.modal_tables.c.arrays),
    ("flutter summary", tables.flutter_summaries.c.arrays),
    ("set of measured responses", tables.measured_responses.c.arrays),
    ("run", tables.runs.c.result),
    ("prediction", tables.predictions.c.unsteady),
    ("job", tables.jobs.c.request),
    ("job", tables.jobs.c.result),
)


def list_referring_records(connection: Connection) -> dict[str, str]:
    """Return a referring record for every array that has one."""
    return {name: record for record, name in _pairs(connection)}


def find_referring_record(connection: Connection, name: str) -> str:
    """Return the description of a record that refers to this array."""
    return list_referring_records(connection).get(name, "an array without a record")


def _pairs(connection: Connection) -> Iterator[tuple[str, str]]:
    for noun, column in _NESTED:
        identity = column.table.c.id
        texts = sa.select(identity, sa.cast(column, sa.Text)).where(column.is_not(None))
        for number, text in connection.execute(texts):
            # pyrefly: ignore[no-matching-overload]
            for name in _NAME.findall(_GEOMETRY.sub("", text)):
                yield f"{noun} {number}", name
    shapes = tables.modal_shapes.c
    for number, name in connection.execute(sa.select(shapes.modal_table_id, shapes.array)):
        yield f"a shape of modal table {number}", name
    for noun, table, columns in (
        ("prediction", tables.predictions, ("values", "std_errors")),
        ("frozen figure", tables.frozen_figures, ("array",)),
        ("version of a global model", tables.global_model_versions, ("result",)),
        ("write-back", tables.write_backs, ("covariance",)),
    ):
        for column in columns:
            for number, name in connection.execute(sa.select(table.c.id, table.c[column])):
                if name is not None:
                    yield f"{noun} {number}", name
    for noun, table, key in (
        ("flight", tables.flight_channels, "flight_id"),
        ("maneuver", tables.channels, "maneuver_id"),
    ):
        query = sa.select(table.c[key], table.c.name, table.c.array)
        for number, channel, name in connection.execute(query):
            yield f"channel '{channel}' of {noun} {number}", name


# --- Bulk arrays as immutable rows, named by their content ----------------------------------------

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


# --- Mode shapes at all nodes: one array per fuel weight and mode ---------------------------------


class ModalShapes:
    """Store of shapes (n_nodes, 6) by modal table, fuel index and mode index."""

    def __init__(self, database: Database, arrays: Arrays) -> None:
        self._database = database
        self._arrays = arrays

    def put(self, modal_table_id: int, shapes: np.ndarray) -> None:
        """Store all shapes of a table, (n_fuel, n_modes, n_nodes, 6)."""
        n_fuel, n_modes = shapes.shape[:2]
        with self._database.transaction() as connection:
            for fuel in range(n_fuel):
                content = [describe_array(shapes[fuel, mode]) for mode in range(n_modes)]
                names = self._arrays.put_many(content)
                rows = [
                    {"modal_table_id": modal_table_id, "fuel": fuel, "mode": mode, "array": name}
                    for mode, name in enumerate(names)
                ]
                connection.execute(sa.insert(modal_shapes), rows)

    def copy(self, modal_table_id: int, new_id: int) -> None:
        """Refer from a new table to the stored shapes of another."""
        columns = modal_shapes.c
        query = sa.select(columns.fuel, columns.mode, columns.array).where(
            columns.modal_table_id == modal_table_id
        )
        with self._database.transaction() as connection:
            # Rows, since access and audit log cannot see those of INSERT ... SELECT.
            rows = [
                {**shape, "modal_table_id": new_id}
                for shape in connection.execute(query).mappings()
            ]
            if rows:
                # pyrefly: ignore[no-matching-overload]
                connection.execute(sa.insert(modal_shapes), rows)

    def has(self, modal_table_id: int) -> bool:
        """Return whether a table has stored shapes."""
        query = sa.select(modal_shapes.c.mode).where(
            modal_shapes.c.modal_table_id == modal_table_id
        )
        with self._database.reading() as connection:
            return connection.execute(query.limit(1)).first() is not None

    def get(
        self, modal_table_id: int, places: Sequence[tuple[int, int]]
    ) -> dict[tuple[int, int], np.ndarray]:
        """Return shapes by (fuel index, mode index)."""
        columns = modal_shapes.c
        query = sa.select(columns.fuel, columns.mode, columns.array).where(
            columns.modal_table_id == modal_table_id,
            sa.tuple_(columns.fuel, columns.mode).in_(list(places)),
        )
        with self._database.reading() as connection:
            names = {(fuel, mode): name for fuel, mode, name in connection.execute(query)}
        arrays = self._arrays.get_many(names.values())
        return {place: arrays[name] for place, name in names.items()}
