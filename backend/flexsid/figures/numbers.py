"""The numbers behind a figure, as drawn: what a spreadsheet or MATLAB gets."""

from __future__ import annotations

import base64
import csv
import html
import io
import re
from dataclasses import dataclass
from typing import Any

import numpy as np

from flexsid.figures.spec import Spec
from flexsid.text import spreadsheet_cell

_MARKUP = re.compile(r"<[^>]*>")
_COLUMNS = ("x", "y", "error", "x_error", "z")


@dataclass(frozen=True, slots=True)
class ExportedCurve:
    """One trace: its name with what it belongs to, and its columns of equal length."""

    name: str
    axes: tuple[str, str]
    columns: dict[str, np.ndarray]


def curves(spec: Spec) -> list[ExportedCurve]:
    """All traces of a figure with columns x, y and, where drawn, error, x_error and z."""
    layout = spec["layout"]
    return [
        ExportedCurve(_name(trace), (_title(layout, trace, "x"), _title(layout, trace, "y")), found)
        for trace in spec["data"]
        if (found := _columns(trace, layout))
    ]


def comma_separated(spec: Spec) -> str:
    """One row per point: curve, axes and columns as drawn; a map one row per cell, with its z."""
    out = io.StringIO(newline="")
    writer = csv.writer(out)
    writer.writerow(["curve", "x_axis", "y_axis", *_COLUMNS])
    for curve in curves(spec):
        nothing = np.full(len(curve.columns["y"]), np.nan)
        columns = (curve.columns.get(name, nothing).tolist() for name in _COLUMNS)
        for point in zip(*columns, strict=True):
            writer.writerow([*map(spreadsheet_cell, (curve.name, *curve.axes)), *map(_cell, point)])
    return out.getvalue()


def _cell(value: Any) -> Any:
    if isinstance(value, str):
        return spreadsheet_cell(value)
    return "" if isinstance(value, float) and not np.isfinite(value) else value


def _columns(trace: Spec, layout: Spec) -> dict[str, np.ndarray]:
    if trace.get("y") is None:
        return {}
    if "z" in trace:
        x, y = (_ticked(_array(trace[letter]), _axis(layout, trace, letter)) for letter in "xy")
        return {"x": np.tile(x, len(y)), "y": np.repeat(y, len(x)), "z": _array(trace["z"]).ravel()}
    y = _array(trace["y"])
    x = _array(trace["x"]) if trace.get("x") is not None else np.arange(len(y))
    found = {"x": x, "y": y}
    for name, key in (("error", "error_y"), ("x_error", "error_x")):
        bars = trace.get(key) or {}
        if bars.get("array") is not None and bars.get("symmetric", True):
            found[name] = _array(bars["array"])
    return found


def _ticked(places: np.ndarray, axis: Spec) -> np.ndarray:
    """What is written at the places of a map, where that is not the place itself."""
    if list(axis.get("tickvals", ())) != places.tolist():
        return places
    return np.array([_plain(str(words)) for words in axis["ticktext"]])


def _array(values: Any) -> np.ndarray:
    if isinstance(values, dict):
        kind = "<f8" if values["dtype"] == "f8" else "<f4"
        return np.frombuffer(base64.b64decode(values["bdata"]), kind).astype(float)
    try:
        return np.array(values, dtype=float)  # None becomes NaN
    except (TypeError, ValueError):
        return np.array([_plain(str(value)) for value in values])


def _name(trace: Spec) -> str:
    parts = [_plain(str(trace.get("name", "")))]
    meta = trace.get("meta")
    if isinstance(meta, dict):
        parts += [str(meta[key]) for key in ("channel", "output", "input") if meta.get(key)]
    elif isinstance(meta, str):
        parts.append(meta)
    return " ".join(dict.fromkeys(part for part in parts if part))


def _title(layout: Spec, trace: Spec, letter: str) -> str:
    found = _axis(layout, trace, letter).get("title", {})
    return _plain(found.get("text", "")) if isinstance(found, dict) else ""


def _axis(layout: Spec, trace: Spec, letter: str) -> Spec:
    number = str(trace.get(f"{letter}axis", letter))[1:]
    return layout.get(f"{letter}axis{number}", {})


def _plain(text: str) -> str:
    """Words without markup, as their author wrote them."""
    return html.unescape(_MARKUP.sub(" ", text)).strip()
