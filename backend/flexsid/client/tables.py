"""Answers as DataFrames, where pandas is installed."""

from __future__ import annotations

import io
from collections.abc import Sequence
from types import ModuleType
from typing import TYPE_CHECKING, Any

from flexsid.errors import FlexsidError

if TYPE_CHECKING:
    import pandas


def table(items: Sequence[dict[str, Any]], index: str | None = "id") -> pandas.DataFrame:
    """One row per item; fields within fields get columns ``outer.inner``, times are times."""
    made = _pandas().json_normalize(list(items))
    for name in made.columns:
        if name.endswith("_at"):
            made[name] = _pandas().to_datetime(made[name], format="ISO8601", utc=True)
    return made.set_index(index) if index is not None and index in made.columns else made


def matrix(values: Sequence[Sequence[float]], names: Sequence[str]) -> pandas.DataFrame:
    """A square matrix with the same names on rows and columns."""
    return _pandas().DataFrame(values, index=list(names), columns=list(names))


def side_by_side(comparison: dict[str, Any]) -> pandas.DataFrame:
    """A comparison with columns ``value`` and ``std_error`` per source.

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
    """Numbers that the workbench wrote as CSV."""
    return _pandas().read_csv(io.BytesIO(content))


def _pandas() -> ModuleType:
    try:
        import pandas
    except ImportError as error:
        raise FlexsidError(
            "tables need pandas; install it with `pip install flexsid[client]`, or take plain"
            " answers with `Workbench.get`",
            code="no-pandas",
        ) from error
    return pandas
