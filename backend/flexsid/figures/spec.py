"""Elements of plotly figures as plain data, their size in print, and their numbers for export."""

from __future__ import annotations

import base64
import csv
import html
import io
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from tsdownsample import MinMaxLTTBDownsampler

from flexsid.figures import style
from flexsid.figures.quantities import text
from flexsid.text import escape_spreadsheet_cell

# --- Elements of plotly figures as plain data: columns, traces, rows, bands and marks -------------

Spec = dict[str, Any]
Numbers = Sequence[float | None] | np.ndarray

N_SIGMA = 2.0
"""Standard errors that an error bar or a band extends to either side."""

BOUNDARY: Spec = {"color": style.FLAG, "width": 1.5, "dash": "dash"}
"""Line of a stability boundary."""

_LONG = 64
_GAP = 0.035
_NARROW_PX = 220.0  # width of the traces of a figure on a telephone, or in half a column
_LETTER_PX = 7.0  # mean width of a letter of 11 px, with the space between two labels
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


def marked(
    marks: Iterable[tuple[Spec, Spec]], traces: Iterable[Spec], *, log: bool = False
) -> Spec:
    """Return the part of a layout that draws vertical marks over traces, and their labels."""
    listed = list(marks)
    labels = [label for _, label in listed]
    stagger(labels, traces, log=log)
    return {"shapes": [shape for shape, _ in listed], "annotations": labels}


def stagger(labels: Sequence[Spec], traces: Iterable[Spec], *, log: bool = False) -> None:
    """Shift labels of vertical marks below each other where they overlap in a narrow figure.

    A label that would end beyond the traces stands at the left of its mark.
    """
    if not labels:
        return
    shown = np.concatenate([_unpack(trace["x"]) for trace in traces])
    if log:
        shown = np.log10(shown[shown > 0.0])
    shown = np.append(shown[np.isfinite(shown)], [label["x"] for label in labels])
    letter = _LETTER_PX / _NARROW_PX * float(np.ptp(shown))
    placed = []
    for label in labels:
        width = letter * len(_remove_markup(label["text"]))
        if label["x"] + width > shown.max():
            label["xanchor"] = "right"
        start = label["x"] - (width if label["xanchor"] == "right" else 0.0)
        placed.append((start, start + width, label))
    free: list[float] = []  # from where on each text line is free
    for start, end, label in sorted(placed, key=lambda one: one[0]):
        line = next((k for k, least in enumerate(free) if least <= start), len(free))
        free[line : line + 1] = [end]
        label["yshift"] = -_LINE_PX * line


def empty(text: str) -> Spec:
    """Return an empty figure with a message."""
    note = {"xref": "paper", "yref": "paper", "x": 0.5, "y": 0.5, "text": text, "showarrow": False}
    hidden = {"visible": False}
    return {"data": [], "layout": {"xaxis": hidden, "yaxis": hidden, "annotations": [note]}}


# --- Size, font and title of a figure as it is printed --------------------------------------------

_PX_PER_MM = 96.0 / 25.4  # of CSS, in which plotly counts
_PX_PER_PT = 96.0 / 72.0


@dataclass(frozen=True, slots=True)
class PrintFormat:
    """Size of the figure [mm], size of its font [pt] and title; None for those of the reader."""

    width_mm: float | None = None
    height_mm: float | None = None
    font_pt: float | None = None
    title: str | None = None


def set_print_format(spec: Spec, value: PrintFormat) -> Spec:
    """Return the figure with the size, font and title of a print format."""
    layout = dict(spec["layout"])
    for name, size_mm in (("width", value.width_mm), ("height", value.height_mm)):
        if size_mm is not None:
            layout[name] = round(size_mm * _PX_PER_MM)
    if value.font_pt is not None:
        layout["font"] = {**layout.get("font", {}), "size": round(value.font_pt * _PX_PER_PT, 2)}
    if value.title:
        layout["title"] = {"text": text(value.title), "automargin": True}
    return {**spec, "layout": layout}


# --- Numbers of a figure for CSV and MAT export, in double precision ------------------------------

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
