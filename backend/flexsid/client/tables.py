"""Conversion of responses to DataFrames; requires pandas."""

from __future__ import annotations

import io
from collections.abc import Sequence
from types import ModuleType
from typing import TYPE_CHECKING, Any

from flexsid.errors import FlexsidError

if TYPE_CHECKING:
    import pandas


def table(items: Sequence[dict[str, Any]], index: str | None = "id") -> pandas.DataFrame:
    """Return one row per item; nested fields get columns ``outer.inner``, times are parsed."""
    frame = _pandas().json_normalize(list(items))
    for name in frame.columns:
        if name.endswith("_at"):
            frame[name] = _pandas().to_datetime(frame[name], format="ISO8601", utc=True)
    return frame.set_index(index) if index is not None and index in frame.columns else frame


def matrix(values: Sequence[Sequence[float]], names: Sequence[str]) -> pandas.DataFrame:
    """Return a square matrix with the same names on rows and columns."""
    return _pandas().DataFrame(values, index=list(names), columns=list(names))


def tabulate_comparison(comparison: dict[str, Any]) -> pandas.DataFrame:
    """Return a comparison with columns ``value`` and ``std_error`` per source.

    Predictions also have ``difference_sigma``, their largest difference from a run.
    """
    rows: dict[str, dict[tuple[str, str], float | None]] = {}
    for row in comparison["rows"]:
        cells: dict[tuple[str, str], float | None] = {}
        for source, value in zip(comparison["sources"], row["values"], strict=True):
            predicted = source["kind"] == "prediction"
            for part in ("value", "std_error", *(("difference_sigma",) if predicted else ())):
                cells[source["label"], part] = None if value is None else value[part]
        cells["max_difference_sigma", ""] = row["max_difference_sigma"]
        rows[row["name"]] = cells
    return _pandas().DataFrame.from_dict(rows, orient="index", dtype=float)


def read_csv(content: bytes) -> pandas.DataFrame:
    """Parse a CSV response."""
    return _pandas().read_csv(io.BytesIO(content))


def _pandas() -> ModuleType:
    try:
        import pandas
    except ImportError as error:
        raise FlexsidError(
            "tables need pandas; install it with `pip install flexsid[client]`, or use plain"
            " responses of `Workbench.get`",
            code="no-pandas",
        ) from error
    return pandas
