"""Parquet: columns through pyarrow, an extra (``pip install flexsid[parquet]``)."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from flexsid.errors import UnreadableFile
from flexsid.importers.source import NOT_READ, Field


def recognises(head: bytes) -> bool:
    """Return whether the file has the magic number of Parquet."""
    return head.startswith(b"PAR1")


def read(path: Path) -> Iterator[Field]:
    """Read the columns of numbers or times; time stamps and durations are converted to seconds.

    The field ``not_read`` lists the other columns.

    Raises
    ------
    UnreadableFile
        If a column has empty cells.
    """
    import pyarrow as pa
    import pyarrow.parquet as pq

    pa.set_cpu_count(1)
    left: list[str] = []
    with pq.ParquetFile(path) as file:
        schema = file.schema_arrow
        for described in schema:
            name, kind = described.name, described.type
            is_time = pa.types.is_timestamp(kind) or pa.types.is_duration(kind)
            is_flag = pa.types.is_boolean(kind)
            if not (is_time or is_flag or pa.types.is_floating(kind) or pa.types.is_integer(kind)):
                left.append(f"{name}: a column of type {kind}")
                continue
            column = file.read([name], use_threads=False).column(0)
            if is_time:
                steps = {"s": 1.0, "ms": 1e3, "us": 1e6, "ns": 1e9}[kind.unit]
                yield Field(name, _plain(column.cast(pa.int64()), name) / steps, "s")
            elif is_flag:
                yield Field(name, _plain(column.cast(pa.uint8()), name))
            else:
                yield Field(name, _plain(column, name), _unit(described.metadata))
    if left:
        yield Field(NOT_READ, np.array(left))


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
