"""Elements of plotly figures as plain data: columns, rows, vertical marks."""

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


class PackedColumn(dict[str, Any]):
    """Numbers packed as base64 for plotly; ``numbers`` are the same in double precision."""

    def __init__(self, packed: Spec, numbers: np.ndarray) -> None:
        super().__init__(packed)
        self.numbers = numbers


def column(
    values: Sequence[float] | np.ndarray, *, exact: bool = False
) -> list[float | None] | Spec:
    """Convert numbers of a trace: to base64 where long, else to a list with None for NaN.

    Parameters
    ----------
    values
        One number per point, or a matrix (one row per y of a heatmap).
    exact
        Draw in 64 instead of 32 bit, for axes that are zoomed into. Exports are always in
        64 bit.
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
    return PackedColumn(spec, array)


def _nullable(array: np.ndarray) -> list[Any]:
    if array.ndim > 1:
        return [_nullable(row) for row in array]
    return [value if np.isfinite(value) else None for value in array.tolist()]


def axis(number: int, letter: str = "y") -> str:
    """Return the name of an axis in a trace: y, y2, y3 ..."""
    return letter if number == 1 else f"{letter}{number}"


def layout_key(number: int, letter: str = "y") -> str:
    """Return the name of an axis in the layout: yaxis, yaxis2 ..."""
    return f"{letter}axis" if number == 1 else f"{letter}axis{number}"


def rows(heights: Sequence[float]) -> list[list[float]]:
    """Compute domains of stacked rows from the top, in proportion to ``heights``."""
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
    """Return an axis title."""
    return {"title": {"text": text}}


def vertical_mark(x: float, text: str, *, log: bool = False) -> tuple[Spec, Spec]:
    """Return a vertical line over all rows and its label: a shape and an annotation."""
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
    """Shift overlapping labels of vertical marks below each other."""
    names.sort(key=lambda name: name["x"])
    reach = names[-1]["x"] - names[0]["x"] if names else 0.0
    ends: list[float] = []  # of the labels, by text line
    for name in names:
        line = next((k for k, end in enumerate(ends) if end <= name["x"]), len(ends))
        end = name["x"] + _LETTER * len(name["text"]) * reach
        ends[line : line + 1] = [end]
        name["yshift"] = -_LINE_PX * line


def empty(text: str) -> Spec:
    """Return an empty figure with a message."""
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
