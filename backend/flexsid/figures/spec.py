"""Elements of plotly figures as plain data: columns, traces, rows, bands and marks."""

from __future__ import annotations

import base64
from collections.abc import Iterable, Sequence
from typing import Any, Literal

import numpy as np
from tsdownsample import MinMaxLTTBDownsampler

from flexsid.figures import style

Spec = dict[str, Any]
Numbers = Sequence[float | None] | np.ndarray

N_SIGMA = 2.0
"""Standard errors that an error bar or a band extends to either side."""

BOUNDARY: Spec = {"color": style.FLAG, "width": 1.5, "dash": "dash"}
"""Line of a stability boundary."""

_LONG = 64
_GAP = 0.035
_LETTER = 0.011  # width of a letter in a figure, as a share of it
_LINE_PX = 14


class PackedColumn(dict[str, Any]):
    """Numbers packed as base64 for plotly; ``numbers`` are all in double precision."""

    def __init__(self, packed: Spec, numbers: np.ndarray) -> None:
        super().__init__(packed)
        self.numbers = numbers


class ListedColumn(list[Any]):
    """Numbers listed for plotly; ``numbers`` are all in double precision."""

    def __init__(self, listed: list[Any], numbers: np.ndarray) -> None:
        super().__init__(listed)
        self.numbers = numbers


Column = PackedColumn | ListedColumn


def column(values: Numbers, *, exact: bool = False, drawn: np.ndarray | None = None) -> Column:
    """Convert numbers of a trace: to base64 where long, else to a list with None for NaN.

    Parameters
    ----------
    values
        One number per point, or a matrix (one row per y of a heatmap).
    exact
        Draw in 64 instead of 32 bit, for axes that are zoomed into. Exports are always in
        64 bit.
    drawn
        Indices of the points that are drawn, all by default; exports have all.
    """
    numbers = np.asarray(values, dtype=float)
    array = numbers if drawn is None else numbers[drawn]
    if array.size < _LONG or not np.isfinite(array).all():
        return ListedColumn(_nullable(array), numbers)
    packed = array.astype("<f8" if exact else "<f4")
    spec: Spec = {
        "dtype": "f8" if exact else "f4",
        "bdata": base64.b64encode(np.ascontiguousarray(packed).tobytes()).decode("ascii"),
    }
    if array.ndim > 1:
        spec["shape"] = ", ".join(str(size) for size in array.shape)
    return PackedColumn(spec, numbers)


def _nullable(array: np.ndarray) -> list[Any]:
    if array.ndim > 1:
        return [_nullable(row) for row in array]
    return [value if np.isfinite(value) else None for value in array.tolist()]


def scatter(x: Any, y: Any, mode: str = "markers", *, row: int | None = None, **more: Any) -> Spec:
    """Return a scatter trace, in a row of the figure if there are several.

    Arrays are converted by :func:`column`; lists are drawn as they are.
    """
    trace: Spec = {"type": "scatter", "mode": mode, "x": _convert(x), "y": _convert(y), **more}
    return trace if row is None else {**trace, "yaxis": axis(row)}


def heatmap(x: Any, y: Any, z: np.ndarray, **more: Any) -> Spec:
    """Return a heat map of ``z``, with one row per y."""
    return {"type": "heatmap", "x": _convert(x), "y": _convert(y), "z": column(z), **more}


def _convert(values: Any) -> Any:
    return column(values) if isinstance(values, np.ndarray) else values


def error_bars(
    std: Numbers, color: str | None = None, factor: float = N_SIGMA, **more: Any
) -> Spec:
    """Return error bars of ``factor`` standard errors; None where there is no standard error."""
    bars: Spec = {"type": "data", "array": column(factor * np.array(std, dtype=float)), **more}
    return bars if color is None else {**bars, "color": color}


def stems(heights: np.ndarray, color: str) -> Spec:
    """Return the lines from markers down to zero, of a line spectrum."""
    return {
        "type": "data", "symmetric": False, "array": [0.0] * len(heights),
        "arrayminus": column(heights), "color": color, "thickness": 1, "width": 0,
    }  # fmt: skip


def select_samples(time_s: np.ndarray, values: np.ndarray, points: int) -> np.ndarray:
    """Select at most ``points`` samples that retain every visible peak."""
    if len(values) <= points:
        return np.arange(len(values))
    indices = MinMaxLTTBDownsampler().downsample(
        np.ascontiguousarray(time_s), np.ascontiguousarray(values), n_out=points
    )
    return indices.astype(np.intp)


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


def stack(
    x_axis: Spec, y_axes: Sequence[Spec], heights: Sequence[float] | None = None, **more: Any
) -> Spec:
    """Lay out rows with a common x axis below them, each as high as the others by default."""
    layout: Spec = {"xaxis": {**x_axis, "anchor": axis(len(y_axes))}}
    domains = rows(heights or [1.0] * len(y_axes))
    for number, (own, domain) in enumerate(zip(y_axes, domains, strict=True), start=1):
        layout[layout_key(number)] = {**own, "domain": domain}
    return {**layout, "meta": {"rows": len(y_axes)}, **more}


def plane(x_axis: Spec, y_axis: Spec, height: float, **more: Any) -> Spec:
    """Lay out one pair of axes with a legend, as high as ``height`` rows."""
    common = {"showlegend": True, "hovermode": "closest", "meta": {"rows": height}}
    return {"xaxis": x_axis, "yaxis": y_axis, **common, **more}


def title(text: str) -> Spec:
    """Return an axis title."""
    return {"title": {"text": text}}


def time_axis(origin: str = "") -> Spec:
    """Return an axis of time in plain seconds: 51240, not 51.24 times a power of ten."""
    return {**title(f"Time from {origin} [s]" if origin else "Time [s]"), "exponentformat": "none"}


def line_at(value: float, letter: str = "x", *, line: Spec = BOUNDARY, **more: Any) -> Spec:
    """Return a line across the figure at a value of an axis; a stability boundary by default."""
    return {**_across(value, value, letter), "type": "line", "line": line, **more}


def band(low: float, high: float, color: str, *, letter: str = "x", **more: Any) -> Spec:
    """Return a shaded band across the figure between two values of an axis."""
    shape = {"type": "rect", "fillcolor": color, "line": {"width": 0}, **more}
    return {**_across(low, high, letter), **shape}


def _across(low: float, high: float, letter: str) -> Spec:
    other = "y" if letter == "x" else "x"
    return {
        f"{letter}ref": letter, f"{letter}0": low, f"{letter}1": high,
        f"{other}ref": "paper", f"{other}0": 0, f"{other}1": 1, "layer": "below",
    }  # fmt: skip


def text_at(
    x: float,
    y: float,
    text: str,
    xanchor: Literal["left", "center", "right"],
    yanchor: Literal["top", "middle", "bottom"],
    font: Spec,
    **more: Any,
) -> Spec:
    """Return a text at a place of the figure, as a share of its width and height."""
    return {
        "xref": "paper", "yref": "paper", "x": x, "y": y, "text": text, "showarrow": False,
        "xanchor": xanchor, "yanchor": yanchor, "font": font, **more,
    }  # fmt: skip


def vertical_mark(x: float, text: str, *, log: bool = False) -> tuple[Spec, Spec]:
    """Return a vertical line over all rows and its label: a shape and an annotation."""
    shape = line_at(x, line={"color": style.MARKER_LINE, "width": 1, "dash": "dot"})
    # an annotation on a log axis is placed by its exponent, a shape by its value
    at = float(np.log10(x)) if log else x
    return shape, text_at(at, 1, text, "left", "top", {"size": 11}, xref="x")


def marked(marks: Iterable[tuple[Spec, Spec]]) -> Spec:
    """Return the part of a layout that draws vertical marks and their labels."""
    listed = list(marks)
    return {
        "shapes": [shape for shape, _ in listed],
        "annotations": [label for _, label in listed],
    }


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
    note = {"xref": "paper", "yref": "paper", "x": 0.5, "y": 0.5, "text": text, "showarrow": False}
    hidden = {"visible": False}
    return {"data": [], "layout": {"xaxis": hidden, "yaxis": hidden, "annotations": [note]}}
