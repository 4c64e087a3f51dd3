"""Channels against each other, with their correlation coefficients (Figs 9a and 18)."""

from __future__ import annotations

import numpy as np

from flexsid.figures import quantities, style
from flexsid.figures.spec import Spec, axis, column, empty, layout_key
from flexsid.records.views import PlotMatrix

LIMIT = 0.9  # |r| beyond which equation error and output error suffer (ref. 14 of the paper)
_POINTS = 400
_GAP = 0.01


def plot_matrix(value: PlotMatrix) -> Spec:
    """Draw names on the diagonal, cross plots above it, coefficients below.

    Spectra show real and imaginary parts in one cloud, their coefficient as magnitude
    and phase.
    """
    count = len(value.names)
    if count < 2:
        return empty("A plot matrix takes at least two channels")
    known = [
        quantities.of_channel(name, unit)
        for name, unit in zip(value.names, value.units, strict=True)
    ]
    rows = np.concatenate([np.real(value.samples), np.imag(value.samples)])
    if not np.iscomplexobj(value.samples):
        rows = value.samples
    keep = np.linspace(0, len(rows) - 1, min(_POINTS, len(rows))).astype(int)
    shown = rows[keep] * np.array([quantity.factor for quantity in known])
    layout: Spec = {
        "showlegend": False,
        "hovermode": "closest",
        "annotations": [],
        "meta": {
            "rows": count,
            "names": list(value.names),
            "inflation": [] if value.inflation is None else column(value.inflation),
            "condition": value.condition if np.isfinite(value.condition) else None,
        },
    }
    data: list[Spec] = []
    for row in range(count):
        layout["annotations"].append(_name(known[row], _centre(row, row, count)))
        for col in range(row + 1, count):
            number = len(data) + 1
            layout |= _cell_axes(number, row, col, count)
            data.append(_cross_plot(number, shown[:, col], shown[:, row], known[col], known[row]))
            coefficient = value.correlation[col, row]
            layout["annotations"].append(_coefficient(coefficient, _centre(col, row, count)))
    return {"data": data, "layout": layout}


def _span(index: int, count: int) -> tuple[float, float]:
    return index / count + _GAP / 2, (index + 1) / count - _GAP / 2


def _centre(row: int, col: int, count: int) -> tuple[float, float]:
    return (col + 0.5) / count, 1.0 - (row + 0.5) / count


def _cell_axes(number: int, row: int, col: int, count: int) -> Spec:
    left, right = _span(col, count)
    top, bottom = _span(row, count)
    bare = {
        "showticklabels": False,
        "zeroline": False,
        "showgrid": False,
        "showline": True,
        "mirror": True,
    }
    frame = {**bare, "linecolor": style.GRID, "ticks": ""}
    return {
        layout_key(number, "x"): {**frame, "domain": [left, right], "anchor": axis(number)},
        layout_key(number): {
            **frame,
            "domain": [1.0 - bottom, 1.0 - top],
            "anchor": axis(number, "x"),
        },
    }


def _cross_plot(
    number: int, x: np.ndarray, y: np.ndarray, of_x: quantities.Quantity, of_y: quantities.Quantity
) -> Spec:
    return {
        "type": "scatter",
        "mode": "markers",
        "name": f"{of_y.label} over {of_x.label}",
        "x": column(x),
        "y": column(y),
        "xaxis": axis(number, "x"),
        "yaxis": axis(number),
        "marker": {"color": style.BLUE, "size": 2.5, "opacity": 0.6},
        "hovertemplate": (
            f"{of_x.label} %{{x:.3g}} {of_x.unit}<br>"
            f"{of_y.label} %{{y:.3g}} {of_y.unit}<extra></extra>"
        ),
    }


def _name(quantity: quantities.Quantity, centre: tuple[float, float]) -> Spec:
    return _text(f"<b>{quantity.label}</b><br>[{quantity.unit}]", centre, {"size": 14})


def _coefficient(value: complex, centre: tuple[float, float]) -> Spec:
    if not np.isfinite(value):  # a channel that never moves has no correlation
        return _text("–", centre, {"size": 13})
    text = f"{np.real(value):z.2f}"
    if np.iscomplexobj(value):
        text = f"{abs(value):.2f} ∠{np.degrees(np.angle(value)):z.0f}°"
    if abs(value) > LIMIT:
        return _text(f"<b>{text} !</b>", centre, {"size": 13, "color": style.FLAG})
    return _text(text, centre, {"size": 13})


def _text(text: str, centre: tuple[float, float], font: Spec) -> Spec:
    return {
        "xref": "paper", "yref": "paper", "x": centre[0], "y": centre[1], "text": text,
        "showarrow": False, "font": font, "xanchor": "center", "yanchor": "middle",
    }  # fmt: skip
