"""The numbers behind a figure, as drawn: what a spreadsheet or MATLAB gets."""

from __future__ import annotations

import base64
import csv
import io
import re
from dataclasses import dataclass
from typing import Any

import numpy as np

from flexsid.figures.spec import Spec

_MARKUP = re.compile(r"<[^>]*>")


@dataclass(frozen=True, slots=True)
class Curve:
    """One trace: its name with what it belongs to, and its columns of equal length."""

    name: str
    axes: tuple[str, str]
    columns: dict[str, np.ndarray]


def curves(spec: Spec) -> list[Curve]:
    """All traces of a figure with finished columns x, y and, where drawn, error and z."""
    layout = spec["layout"]
    return [
        Curve(_name(trace), (_title(layout, trace, "x"), _title(layout, trace, "y")), found)
        for trace in spec["data"]
        if (found := _columns(trace))
    ]


def comma_separated(spec: Spec) -> str:
    """One row per point: curve, axes, x, y, error and text; a heatmap one row per cell."""
    out = io.StringIO(newline="")
    writer = csv.writer(out)
    writer.writerow(["curve", "x_axis", "y_axis", "x", "y", "error"])
    for curve in curves(spec):
        x, y = curve.columns["x"], curve.columns["y"]
        error = curve.columns.get("error", np.full(len(y), np.nan))
        for point in zip(x.tolist(), y.tolist(), error.tolist(), strict=False):
            writer.writerow([*map(_safe, (curve.name, *curve.axes)), *map(_cell, point)])
    return out.getvalue()


def _safe(text: str) -> str:
    """Text that no spreadsheet takes for a formula."""
    return f"'{text}" if text[:1] in ("=", "+", "-", "@") else text


def _cell(value: Any) -> Any:
    return "" if isinstance(value, float) and not np.isfinite(value) else value


def _columns(trace: Spec) -> dict[str, np.ndarray]:
    if trace.get("y") is None:
        return {}
    if "z" in trace:
        x, y = np.asarray(trace["x"]), np.asarray(trace["y"])
        z = _array(trace["z"]).reshape(len(y), len(x))
        return {"x": np.tile(x, len(y)), "y": np.repeat(y, len(x)), "error": z.ravel()}
    y = _array(trace["y"])
    x = _array(trace["x"]) if trace.get("x") is not None else np.arange(len(y))
    found = {"x": x, "y": y}
    bars = trace.get("error_y") or {}
    if bars.get("array") is not None and bars.get("symmetric", True):
        found["error"] = _array(bars["array"])
    return found


def _array(values: Any) -> np.ndarray:
    if isinstance(values, dict):
        kind = "<f8" if values["dtype"] == "f8" else "<f4"
        return np.frombuffer(base64.b64decode(values["bdata"]), kind).astype(float)
    try:
        return np.array(values, dtype=float)  # None becomes NaN
    except (TypeError, ValueError):
        return np.array([str(value) for value in values])


def _name(trace: Spec) -> str:
    parts = [_plain(str(trace.get("name", "")))]
    meta = trace.get("meta")
    if isinstance(meta, dict):
        parts += [str(meta[key]) for key in ("channel", "output", "input") if meta.get(key)]
    elif isinstance(meta, str):
        parts.append(meta)
    return " ".join(dict.fromkeys(part for part in parts if part))


def _title(layout: Spec, trace: Spec, letter: str) -> str:
    number = str(trace.get(f"{letter}axis", letter))[1:]
    found = layout.get(f"{letter}axis{number}", {}).get("title", {})
    return _plain(found.get("text", "")) if isinstance(found, dict) else ""


def _plain(text: str) -> str:
    return _MARKUP.sub(" ", text).strip()
