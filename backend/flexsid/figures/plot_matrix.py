"""Plot matrix of channels with correlation coefficients (Figs 9a and 18)."""

from __future__ import annotations

import numpy as np

from flexsid.figures import quantities, style
from flexsid.figures.spec import Spec, axis, column, empty, layout_key, scatter, text_at
from flexsid.records.views import PlotMatrix

LIMIT = 0.9
"""Of |Re r|: above it equation and output error are ill-conditioned (ref. 14 of the paper)."""

_POINTS = 400  # in one cross plot
_ALL_POINTS = 8_000  # a browser draws so many within half a second
_GAP = 0.01
_FEW = 8  # largest number of channels with large font
_BARE = dict.fromkeys(("showticklabels", "zeroline", "showgrid", "showline"), False) | {"ticks": ""}


def draw_plot_matrix(value: PlotMatrix) -> Spec:
    """Draw names on the diagonal, cross plots above it, coefficients below.

    Spectra show real and imaginary parts together, and below the real part of their coefficient
    its magnitude and phase. Derivatives are real, so collinearity of regressors is in the real
    part, and only it is flagged: a motion and its rate are in quadrature, whatever the magnitude.
    """
    count = len(value.names)
    if count < 2:
        return empty("Select at least two channels")
    shown = [quantities.of_channel(*named) for named in zip(value.names, value.units, strict=True)]
    samples = value.samples
    if np.iscomplexobj(samples):
        samples = np.concatenate([np.real(samples), np.imag(samples)])
    samples = samples * np.array([quantity.factor for quantity in shown])
    cells = [(row, col) for row in range(count) for col in range(row + 1, count)]
    points = min(_POINTS, _ALL_POINTS // len(cells), len(samples))
    drawn = samples[np.linspace(0, len(samples) - 1, points).astype(int)]
    data = [
        scatter(
            drawn[:, col],
            drawn[:, row],
            name=f"{shown[row].label} over {shown[col].label}",
            xaxis=axis(col + 1, "x"),
            yaxis=axis(row + 1),
            marker={"color": style.BLUE, "size": 2.5, "opacity": 0.6},
            hovertemplate=f"{shown[col].label} %{{x:.3g}} {shown[col].unit}<br>"
            f"{shown[row].label} %{{y:.3g}} {shown[row].unit}<extra></extra>",
        )
        for row, col in cells
    ]
    font = {"size": 13 if count <= _FEW else 10}
    notes = [(k, k, f"<b>{q.label}</b><br>[{q.unit}]", font) for k, q in enumerate(shown)]
    notes += [(c, r, *_format_coefficient(value.correlation[c, r], font)) for r, c in cells]
    layout: Spec = {
        "showlegend": False,
        "hovermode": "closest",
        "shapes": [_draw_frames(cells, count)],
        "annotations": [
            text_at((c + 0.5) / count, 1.0 - (r + 0.5) / count, text, "center", "middle", own_font)
            for r, c, text, own_font in notes
        ],
        "meta": {
            "rows": count,
            "names": list(value.names),
            "inflation": [] if value.inflation is None else column(value.inflation),
            "condition": value.condition if np.isfinite(value.condition) else None,
        },
    }
    for index in range(count):  # axes shared by the cross plots of a column and of a row
        left, right = _find_span(index, count)
        layout[layout_key(index + 1, "x")] = {**_BARE, "domain": [left, right]}
        layout[layout_key(index + 1)] = {**_BARE, "domain": [1.0 - right, 1.0 - left]}
    return {"data": data, "layout": layout}


def _find_span(index: int, count: int) -> tuple[float, float]:
    return index / count + _GAP / 2, (index + 1) / count - _GAP / 2


def _draw_frames(cells: list[tuple[int, int]], count: int) -> Spec:
    """Draw a box around every cross plot, all in one path."""
    boxes = []
    for row, col in cells:
        (left, right), (top, bottom) = _find_span(col, count), _find_span(row, count)
        low, high = 1.0 - bottom, 1.0 - top
        boxes.append(f"M{left},{low}L{right},{low}L{right},{high}L{left},{high}Z")
    return {
        "type": "path", "xref": "paper", "yref": "paper", "path": "".join(boxes),
        "line": {"color": style.GRID, "width": 1},
    }  # fmt: skip


def _format_coefficient(value: complex, font: Spec) -> tuple[str, Spec]:
    if not np.isfinite(value):  # a constant channel has no correlation
        return "–", font
    text, phasor = f"{np.real(value):z.2f}", ""
    if np.iscomplexobj(value):
        phasor = f"<br>({abs(value):.2f}∠{np.degrees(np.angle(value)):z.0f}°)"
    if abs(np.real(value)) <= LIMIT:
        return text + phasor, font
    return f"<b>{text} !</b>{phasor}", {**font, "color": style.FLAG}
