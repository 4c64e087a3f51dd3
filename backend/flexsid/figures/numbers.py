"""Numbers of a figure for CSV and MAT export, in double precision."""

from __future__ import annotations

import base64
import csv
import html
import io
import re
from dataclasses import dataclass
from typing import Any

import numpy as np

from flexsid.figures.spec import PackedColumn, Spec
from flexsid.text import escape_spreadsheet_cell

_MARKUP = re.compile(r"<[^>]*>")
_COLUMNS = ("x", "y", "error", "x_error", "z")


@dataclass(frozen=True, slots=True)
class ExportedCurve:
    """One trace: name with channel or output and input, axes, and columns of equal length."""

    name: str
    axes: tuple[str, str]
    columns: dict[str, np.ndarray]


def extract_curves(spec: Spec) -> list[ExportedCurve]:
    """Extract all traces with columns x, y and, where drawn, error, x_error and z."""
    layout = spec["layout"]
    return [
        ExportedCurve(
            _format_name(trace),
            (_get_title(layout, trace, "x"), _get_title(layout, trace, "y")),
            found,
        )
        for trace in spec["data"]
        if (found := _extract_columns(trace, layout))
    ]


def write_csv(spec: Spec) -> str:
    """Write one row per point with curve, axes and columns; a heat map one row per cell, with z."""
    out = io.StringIO(newline="")
    writer = csv.writer(out)
    writer.writerow(["curve", "x_axis", "y_axis", *_COLUMNS])
    for curve in extract_curves(spec):
        nothing = np.full(len(curve.columns["y"]), np.nan)
        columns = (curve.columns.get(name, nothing).tolist() for name in _COLUMNS)
        for point in zip(*columns, strict=True):
            writer.writerow(
                [
                    *map(escape_spreadsheet_cell, (curve.name, *curve.axes)),
                    *map(_format_cell, point),
                ]
            )
    return out.getvalue()


def _format_cell(value: Any) -> Any:
    if isinstance(value, str):
        return escape_spreadsheet_cell(value)
    return "" if isinstance(value, float) and not np.isfinite(value) else value


def _extract_columns(trace: Spec, layout: Spec) -> dict[str, np.ndarray]:
    if trace.get("y") is None:
        return {}
    if "z" in trace:
        x, y = (
            _replace_ticks(_unpack(trace[letter]), _get_axis(layout, trace, letter))
            for letter in "xy"
        )
        return {
            "x": np.tile(x, len(y)),
            "y": np.repeat(y, len(x)),
            "z": _unpack(trace["z"]).ravel(),
        }
    y = _unpack(trace["y"])
    x = _unpack(trace["x"]) if trace.get("x") is not None else np.arange(len(y))
    found = {"x": x, "y": y}
    for name, key in (("error", "error_y"), ("x_error", "error_x")):
        bars = trace.get(key) or {}
        if bars.get("array") is not None and bars.get("symmetric", True):
            found[name] = _unpack(bars["array"])
    return found


def _replace_ticks(positions: np.ndarray, axis: Spec) -> np.ndarray:
    """Replace tick positions of a heat map by their labels."""
    if list(axis.get("tickvals", ())) != positions.tolist():
        return positions
    return np.array([_remove_markup(str(label)) for label in axis["ticktext"]])


def _unpack(values: Any) -> np.ndarray:
    if isinstance(values, PackedColumn):
        return values.numbers.ravel()
    if isinstance(values, dict):  # a stored figure has the numbers that were drawn
        kind = "<f8" if values["dtype"] == "f8" else "<f4"
        return np.frombuffer(base64.b64decode(values["bdata"]), kind).astype(float)
    try:
        return np.array(values, dtype=float)  # None becomes NaN
    except (TypeError, ValueError):
        return np.array([_remove_markup(str(value)) for value in values])


def _format_name(trace: Spec) -> str:
    parts = [_remove_markup(str(trace.get("name", "")))]
    meta = trace.get("meta")
    if isinstance(meta, dict):
        parts += [str(meta[key]) for key in ("channel", "output", "input") if meta.get(key)]
    elif isinstance(meta, str):
        parts.append(meta)
    return " ".join(dict.fromkeys(part for part in parts if part))


def _get_title(layout: Spec, trace: Spec, letter: str) -> str:
    found = _get_axis(layout, trace, letter).get("title", {})
    return _remove_markup(found.get("text", "")) if isinstance(found, dict) else ""


def _get_axis(layout: Spec, trace: Spec, letter: str) -> Spec:
    number = str(trace.get(f"{letter}axis", letter))[1:]
    return layout.get(f"{letter}axis{number}", {})


def _remove_markup(text: str) -> str:
    """Remove markup and unescape HTML."""
    return html.unescape(_MARKUP.sub(" ", text)).strip()
