"""Parquet: columns through pyarrow, an extra (``pip install flexsid[parquet]``)."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from flexsid.errors import UnreadableFile
from flexsid.importers.source import Field


def recognises(head: bytes) -> bool:
    """Return whether the file has the magic number of Parquet."""
    return head.startswith(b"PAR1")


def read(path: Path) -> Iterator[Field]:
    """Read the columns of numbers or time stamps; time stamps are converted to seconds.

    Raises
    ------
    UnreadableFile
        If a column has empty cells.
    """
    import pyarrow as pa
    import pyarrow.parquet as pq

    pa.set_cpu_count(1)
    with pq.ParquetFile(path) as file:
        schema = file.schema_arrow
        for described in schema:
            name, kind = described.name, described.type
            is_time, is_flag = pa.types.is_timestamp(kind), pa.types.is_boolean(kind)
            if not (is_time or is_flag or pa.types.is_floating(kind) or pa.types.is_integer(kind)):
                continue
            column = file.read([name], use_threads=False).column(0)
            if is_time:
                steps = {"s": 1.0, "ms": 1e3, "us": 1e6, "ns": 1e9}[kind.unit]
                yield Field(name, _plain(column.cast(pa.int64()), name) / steps, "s")
            elif is_flag:
                yield Field(name, _plain(column.cast(pa.uint8()), name))
            else:
                yield Field(name, _plain(column, name), _unit(described.metadata))


def _plain(column: Any, name: str) -> np.ndarray:
    if column.null_count:
        row = int(np.flatnonzero(np.asarray(column.is_null()))[0]) + 1
        raise UnreadableFile(
            f"row {row}, column '{name}' is empty; a number is expected.",
            code="not-numeric",
            row=row,
            column=name,
        )
    return column.to_numpy()


def _unit(metadata: dict[bytes, bytes] | None) -> str:
    for key in (b"unit", b"units"):
        if metadata and key in metadata:
            return metadata[key].decode("utf-8", "replace").strip()
    return ""
