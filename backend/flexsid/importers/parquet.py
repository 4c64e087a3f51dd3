"""Parquet: columns through pyarrow, an extra (``pip install flexsid[parquet]``)."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from flexsid.errors import UnreadableFile
from flexsid.importers.source import LARGEST_CONTENT, Content, Field

LARGEST_COLUMNS = 4096


def recognises(head: bytes) -> bool:
    """Return whether the file has the magic number of Parquet."""
    return head.startswith(b"PAR1")


def read(path: Path) -> Content:
    """Read the columns of numbers or time stamps; time stamps are converted to seconds.

    Raises
    ------
    UnreadableFile
        If the file is damaged, claims more than LARGEST_CONTENT, or a column
        has empty cells.
    """
    return Content(_fields(path))


def _fields(path: Path) -> Iterator[Field]:
    import pyarrow as pa
    import pyarrow.parquet as pq

    pa.set_cpu_count(1)
    try:
        with pq.ParquetFile(path) as file:
            schema = file.schema_arrow
            n_rows = file.metadata.num_rows
            names = list(schema.names)
            _check(names, n_rows)
            for index, name in enumerate(names):
                kind = schema.field(index).type
                if pa.types.is_timestamp(kind):
                    column = file.read([name], use_threads=False).column(0).cast(pa.int64())
                    unit = {"s": 1.0, "ms": 1e3, "us": 1e6, "ns": 1e9}[kind.unit]
                    yield Field(name, _plain(column, name) / unit, "s")
                elif pa.types.is_floating(kind) or pa.types.is_integer(kind):
                    column = file.read([name], use_threads=False).column(0)
                    yield Field(name, _plain(column, name), _unit(schema.field(index).metadata))
                elif pa.types.is_boolean(kind):
                    column = file.read([name], use_threads=False).column(0).cast(pa.uint8())
                    yield Field(name, _plain(column, name))
    except MemoryError:
        raise
    except (pa.ArrowException, OSError, ValueError, KeyError, TypeError) as error:
        raise UnreadableFile(f"the Parquet file is damaged ({error}).") from error


def _check(names: list[str], n_rows: int) -> None:
    if len(names) > LARGEST_COLUMNS:
        raise UnreadableFile(f"the file has {len(names)} columns; at most {LARGEST_COLUMNS}.")
    if n_rows * len(names) * 8 > LARGEST_CONTENT:
        raise UnreadableFile(
            f"the file claims {n_rows} rows of {len(names)} columns, more than "
            f"{LARGEST_CONTENT / 1024**3:.0f} GB."
        )
    for name in names:
        if names.count(name) > 1:
            raise UnreadableFile(
                f"two columns are called '{name}'.", code="duplicate-channel", column=name
            )


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
