"""Bulk arrays as immutable rows, named by their content."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
import sqlalchemy as sa

from flexsid.errors import BadInput, UnknownRecord
from flexsid.storage.database import Database
from flexsid.storage.tables import arrays

_AT_ONCE = 500  # names in one query


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
        samples = np.asarray(array)
        if samples.dtype.kind not in "biufc":
            raise BadInput(f"an array of {samples.dtype} cannot be kept; expected numbers")
        samples = np.ascontiguousarray(samples, dtype=samples.dtype.newbyteorder("<"))
        # ascontiguousarray makes a scalar one-dimensional.
        samples = samples.reshape(np.shape(array))
        data = samples.tobytes()
        dtype = samples.dtype.str
        heading = f"{dtype} {samples.shape} {unit}\n".encode()
        name = hashlib.sha256(heading + data).hexdigest()
        with self._database.transaction() as connection:
            known = connection.scalar(sa.select(arrays.c.hash).where(arrays.c.hash == name))
            if known is None:
                connection.execute(
                    sa.insert(arrays).values(
                        hash=name,
                        dtype=dtype,
                        shape=list(samples.shape),
                        unit=unit,
                        n_bytes=len(data),
                        data=data,
                    )
                )
        return name

    def get(self, name: str) -> np.ndarray:
        """Return an array; it is read-only, as what is kept never changes."""
        return self.get_many([name])[name]

    def get_many(self, names: Iterable[str]) -> dict[str, np.ndarray]:
        """Return arrays by name."""
        wanted = list(dict.fromkeys(names))
        query = sa.select(arrays.c.hash, arrays.c.dtype, arrays.c.shape, arrays.c.data)
        found: dict[str, np.ndarray] = {}
        with self._database.reading() as connection:
            for first in range(0, len(wanted), _AT_ONCE):
                some = arrays.c.hash.in_(wanted[first : first + _AT_ONCE])
                for name, dtype, shape, data in connection.execute(query.where(some)):
                    found[name] = _restore(dtype, shape, data)
        for name in wanted:
            if name not in found:
                raise UnknownRecord(f"there is no array {name}")
        return found


def _restore(dtype: str, shape: Sequence[int], data: Any) -> np.ndarray:
    return np.frombuffer(data, dtype=np.dtype(dtype)).reshape(tuple(shape))
