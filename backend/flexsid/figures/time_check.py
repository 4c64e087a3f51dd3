"""Measured and simulated outputs against time, one row each."""

from __future__ import annotations

import numpy as np

from flexsid.figures import quantities, style
from flexsid.figures.spec import Spec, axis, column, empty, layout_key, rows, title
from flexsid.figures.time_history import select_samples
from flexsid.records.views import CheckedTrace, TimeCheck


def time_check(value: TimeCheck) -> Spec:
    """Draw measured and simulated outputs with R2 by row."""
    if not value.traces:
        return empty("No outputs selected")
    count = len(value.traces)
    layout: Spec = {
        "xaxis": {**title("Time [s]"), "anchor": axis(count)},
        "legend": {"orientation": "h", "y": 1.02, "yanchor": "bottom"},
        "hovermode": "x",
        "meta": {"rows": count},
    }
    data: list[Spec] = []
    colour_of_model, _ = style.METHODS[value.method.value]
    for number, (trace, domain) in enumerate(
        zip(value.traces, rows([1.0] * count), strict=True), start=1
    ):
        quantity = quantities.of_channel(trace.name, trace.unit)
        heading = f"{quantity.title}<br>R² = {trace.r_squared:.3f}"
        layout[layout_key(number)] = {**title(heading), "domain": domain}
        for name, samples, colour in (
            ("measured", trace.measured, style.GREY),
            (f"{value.method.value} model", trace.simulated, colour_of_model),
        ):
            data.append(_line(trace, samples, name, colour, quantity, number, value.points))
    return {"data": data, "layout": layout}


def _line(
    trace: CheckedTrace,
    samples: np.ndarray,
    name: str,
    colour: str,
    quantity: quantities.DisplayQuantity,
    number: int,
    points: int,
) -> Spec:
    indices = select_samples(trace.time_s, samples, points)
    return {
        "type": "scatter",
        "mode": "lines",
        "name": name,
        "legendgroup": name,
        "showlegend": number == 1,
        "x": column(trace.time_s[indices], exact=True),
        "y": column(samples[indices] * quantity.factor),
        "yaxis": axis(number),
        "line": {"color": colour, "width": 1},
        "hovertemplate": f"%{{y:.4g}} {quantity.unit}<extra>{name}</extra>",
    }
