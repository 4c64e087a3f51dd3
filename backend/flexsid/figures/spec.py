"""Pieces of a plotly figure as plain data: columns, stacked rows, vertical marks."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from typing import Any

import numpy as np

from flexsid.figures import style

Spec = dict[str, Any]

_LONG = 64
_GAP = 0.035
_LETTER = 0.011  # width of a letter in a figure, as a share of it
_LINE_PX = 14


def column(
    values: Sequence[float] | np.ndarray, *, exact: bool = False
) -> list[float | None] | Spec:
    """Numbers of one trace: base64 where long, a list with None for NaN otherwise.

    Parameters
    ----------
    values
        One number per point, or a matrix (one row per y of a heatmap).
    exact
        Keep 64 bit, for axes that are zoomed into.
    """
    array = np.asarray(values, dtype=float)
    if array.size < _LONG or not np.isfinite(array).all():
        return _nullable(array)
    packed = array.astype("<f8" if exact else "<f4")
    spec: Spec = {
        "dtype": "f8" if exact else "f4",
        "bdata": base64.b64encode(np.ascontiguousarray(packed).tobytes()).decode("ascii"),
    }
    if array.ndim > 1:
        spec["shape"] = ", ".join(str(size) for size in array.shape)
    return spec


def _nullable(array: np.ndarray) -> list[Any]:
    if array.ndim > 1:
        return [_nullable(row) for row in array]
    return [value if np.isfinite(value) else None for value in array.tolist()]


def axis(number: int, letter: str = "y") -> str:
    """Name of an axis in a trace: y, y2, y3 ..."""
    return letter if number == 1 else f"{letter}{number}"


def layout_key(number: int, letter: str = "y") -> str:
    """Name of an axis in the layout: yaxis, yaxis2 ..."""
    return f"{letter}axis" if number == 1 else f"{letter}axis{number}"


def rows(heights: Sequence[float]) -> list[list[float]]:
    """Domains of rows stacked from the top, in proportion to ``heights``."""
    gaps = _GAP * min(1.0, 8.0 / len(heights))
    free = 1.0 - gaps * (len(heights) - 1)
    total = float(sum(heights))
    domains, top = [], 1.0
    for height in heights:
        bottom = top - free * height / total
        domains.append([max(round(bottom, 5), 0.0), round(top, 5)])
        top = bottom - gaps
    return domains


def title(text: str) -> Spec:
    """Axis title."""
    return {"title": {"text": text}}


def vertical_mark(x: float, text: str, *, log: bool = False) -> tuple[Spec, Spec]:
    """Line over all rows and its name beside its top: a shape and an annotation."""
    shape = {
        "type": "line", "xref": "x", "yref": "paper", "x0": x, "x1": x, "y0": 0, "y1": 1,
        "line": {"color": style.MARKER_LINE, "width": 1, "dash": "dot"}, "layer": "below",
    }  # fmt: skip
    annotation = {
        # an annotation on a log axis is placed by its exponent, a shape by its value
        "xref": "x", "yref": "paper", "x": float(np.log10(x)) if log else x, "y": 1,
        "text": text, "showarrow": False, "yanchor": "top", "xanchor": "left",
        "font": {"size": 11},
    }  # fmt: skip
    return shape, annotation


def stagger(names: list[Spec]) -> None:
    """Write the names of vertical marks below each other where side by side they would overlap."""
    names.sort(key=lambda name: name["x"])
    reach = names[-1]["x"] - names[0]["x"] if names else 0.0
    ends: list[float] = []  # of what is written so far, by line
    for name in names:
        line = next((k for k, end in enumerate(ends) if end <= name["x"]), len(ends))
        end = name["x"] + _LETTER * len(name["text"]) * reach
        ends[line : line + 1] = [end]
        name["yshift"] = -_LINE_PX * line


def empty(text: str) -> Spec:
    """A figure that says why it has nothing to show."""
    return {
        "data": [],
        "layout": {
            "xaxis": {"visible": False},
            "yaxis": {"visible": False},
            "annotations": [
                {
                    "xref": "paper",
                    "yref": "paper",
                    "x": 0.5,
                    "y": 0.5,
                    "text": text,
                    "showarrow": False,
                }
            ],
        },
    }
