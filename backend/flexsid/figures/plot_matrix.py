"""Plot matrix of channels with correlation coefficients (Figs 9a and 18)."""

from __future__ import annotations

import numpy as np

from flexsid.figures import quantities, style
from flexsid.figures.spec import Spec, axis, column, empty, layout_key
from flexsid.records.views import PlotMatrix

LIMIT = (
    0.9  # of |Re r|: above it equation and output error are ill-conditioned (ref. 14 of the paper)
)
_POINTS = 400  # in one cross plot
_ALL_POINTS = 8_000  # a browser draws so many within half a second
_GAP = 0.01
_FEW = 8  # largest number of channels with large font


def plot_matrix(value: PlotMatrix) -> Spec:
    """Draw names on the diagonal, cross plots above it, coefficients below.

    Spectra show real and imaginary parts together, and below the real part of their coefficient
    its magnitude and phase. Derivatives are real, so collinearity of regressors is in the real
    part, and only it is flagged: a motion and its rate are in quadrature, whatever the magnitude.
    """
    count = len(value.names)
    if count < 2:
        return empty("Select at least two channels")
    known = [
        quantities.of_channel(name, unit)
        for name, unit in zip(value.names, value.units, strict=True)
    ]
    rows = np.concatenate([np.real(value.samples), np.imag(value.samples)])
    if not np.iscomplexobj(value.samples):
        rows = value.samples
    points = min(_POINTS, _ALL_POINTS // (count * (count - 1) // 2), len(rows))
    indices = np.linspace(0, len(rows) - 1, points).astype(int)
    shown = rows[indices] * np.array([quantity.factor for quantity in known])
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
    size = 13 if count <= _FEW else 10
    for index in range(count):
        layout |= _axes_of_channel(index, count)
        layout["annotations"].append(_name(known[index], _centre(index, index, count), size))
    cells = [(row, col) for row in range(count) for col in range(row + 1, count)]
    layout["annotations"] += [
        _coefficient(value.correlation[col, row], _centre(col, row, count), size)
        for row, col in cells
    ]
    layout["shapes"] = [_frames(cells, count)]
    data = [
        _cross_plot(row, col, shown[:, col], shown[:, row], known[col], known[row])
        for row, col in cells
    ]
    return {"data": data, "layout": layout}


def _span(index: int, count: int) -> tuple[float, float]:
    return index / count + _GAP / 2, (index + 1) / count - _GAP / 2


def _centre(row: int, col: int, count: int) -> tuple[float, float]:
    return (col + 0.5) / count, 1.0 - (row + 0.5) / count


def _axes_of_channel(index: int, count: int) -> Spec:
    """Lay out the axes of a channel, shared by its column and row of cross plots."""
    left, right = _span(index, count)
    bare = {
        "showticklabels": False, "zeroline": False, "showgrid": False, "showline": False,
        "ticks": "",
    }  # fmt: skip
    return {
        layout_key(index + 1, "x"): {**bare, "domain": [left, right]},
        layout_key(index + 1): {**bare, "domain": [1.0 - right, 1.0 - left]},
    }


def _frames(cells: list[tuple[int, int]], count: int) -> Spec:
    """Draw a box around every cross plot, all in one path."""
    boxes = []
    for row, col in cells:
        (left, right), (top, bottom) = _span(col, count), _span(row, count)
        low, high = 1.0 - bottom, 1.0 - top
        boxes.append(f"M{left},{low}L{right},{low}L{right},{high}L{left},{high}Z")
    return {
        "type": "path", "xref": "paper", "yref": "paper", "path": "".join(boxes),
        "line": {"color": style.GRID, "width": 1},
    }  # fmt: skip


def _cross_plot(
    row: int,
    col: int,
    x: np.ndarray,
    y: np.ndarray,
    of_x: quantities.DisplayQuantity,
    of_y: quantities.DisplayQuantity,
) -> Spec:
    return {
        "type": "scatter",
        "mode": "markers",
        "name": f"{of_y.label} over {of_x.label}",
        "x": column(x),
        "y": column(y),
        "xaxis": axis(col + 1, "x"),
        "yaxis": axis(row + 1),
        "marker": {"color": style.BLUE, "size": 2.5, "opacity": 0.6},
        "hovertemplate": (
            f"{of_x.label} %{{x:.3g}} {of_x.unit}<br>"
            f"{of_y.label} %{{y:.3g}} {of_y.unit}<extra></extra>"
        ),
    }


def _name(quantity: quantities.DisplayQuantity, centre: tuple[float, float], size: int) -> Spec:
    return _text(f"<b>{quantity.label}</b><br>[{quantity.unit}]", centre, {"size": size})


def _coefficient(value: complex, centre: tuple[float, float], size: int) -> Spec:
    if not np.isfinite(value):  # a constant channel has no correlation
        return _text("–", centre, {"size": size})
    text, phasor = f"{np.real(value):z.2f}", ""
    if np.iscomplexobj(value):
        phasor = f"<br>({abs(value):.2f}∠{np.degrees(np.angle(value)):z.0f}°)"
    if abs(np.real(value)) > LIMIT:
        flagged = f"<b>{text} !</b>{phasor}"
        return _text(flagged, centre, {"size": size, "color": style.FLAG})
    return _text(text + phasor, centre, {"size": size})


def _text(text: str, centre: tuple[float, float], font: Spec) -> Spec:
    return {
        "xref": "paper", "yref": "paper", "x": centre[0], "y": centre[1], "text": text,
        "showarrow": False, "font": font, "xanchor": "center", "yanchor": "middle",
    }  # fmt: skip
