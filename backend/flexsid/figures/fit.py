"""Measured and fitted data: magnitude and phase per output (Figs 14 and 15)."""

from __future__ import annotations

import numpy as np

from flexsid.figures import quantities, style
from flexsid.figures.spec import Spec, axis, column, empty, layout_key, rows, title
from flexsid.records.run import Method
from flexsid.records.views import FitPlot, FitTrace

_INPUT_UNIT = "rad"  # responses are stored per radian of surface


def fit(value: FitPlot) -> Spec:
    """Draw measured data as markers, fitted data as a curve, or for OE as rings."""
    if not value.traces:
        return empty("No fitted data")
    colour, symbol = style.METHODS[value.method.value]
    count = 2 * len(value.traces)
    domains = rows([1.4, 1.0] * len(value.traces))
    layout: Spec = {
        "xaxis": {**title("Frequency [Hz]"), "anchor": axis(count)},
        "showlegend": True,
        "hovermode": "closest",
        "annotations": [],
        "meta": {"rows": count},
    }
    data: list[Spec] = []
    for index, trace in enumerate(value.traces):
        first = 2 * index + 1
        quantity = _quantity(trace, value.method)
        layout[layout_key(first)] = {
            **title(quantity.title),
            "domain": domains[first - 1],
            "rangemode": "tozero",
        }
        layout[layout_key(first + 1)] = {**title("Phase [deg]"), "domain": domains[first]}
        layout["annotations"].append(_r_squared(trace, domains[first - 1][1]))
        points = {
            "mode": "markers",
            "marker": {"color": style.MEASURED, "symbol": symbol, "size": 5},
        }
        curve = {"mode": "lines", "line": {"color": colour, "width": 1.8}}
        if value.method is Method.OE:  # adjacent harmonics belong to different inputs
            curve = {
                "mode": "markers",
                "marker": {"color": colour, "symbol": "circle-open", "size": 8},
            }
        measured = (trace.measured_magnitude, trace.measured_phase_rad)
        fitted = (trace.fitted_magnitude, trace.fitted_phase_rad)
        data += _pair(value, "measured", measured, quantity, first, points)
        data += _pair(value, f"{value.method.value} fit", fitted, quantity, first, curve)
    return {"data": data, "layout": layout}


def _quantity(trace: FitTrace, method: Method) -> quantities.DisplayQuantity:
    output = quantities.of_channel(trace.output, trace.unit)
    if method is Method.FRE and trace.input is not None:
        return quantities.ratio(output, quantities.of_channel(trace.input, _INPUT_UNIT))
    return quantities.transform(output)


def _pair(
    value: FitPlot,
    name: str,
    curves: tuple[np.ndarray, np.ndarray],
    quantity: quantities.DisplayQuantity,
    first: int,
    drawing: Spec,
) -> list[Spec]:
    magnitude, phase = curves
    shared = {
        "type": "scatter",
        "name": name,
        "legendgroup": name,
        "x": column(value.frequency_hz),
        "customdata": [value.run_id],
        **drawing,
    }
    return [
        {
            **shared,
            "y": column(magnitude * quantity.factor),
            "yaxis": axis(first),
            "showlegend": first == 1,
            "hovertemplate": f"%{{x:.3f}} Hz<br>%{{y:.4g}} {quantity.unit}<extra>{name}</extra>",
        },
        {
            **shared,
            "y": column(np.rad2deg(phase)),
            "yaxis": axis(first + 1),
            "showlegend": False,
            "hovertemplate": f"%{{x:.3f}} Hz<br>%{{y:.1f}} deg<extra>{name}</extra>",
        },
    ]


def _r_squared(trace: FitTrace, top: float) -> Spec:
    known = "–" if trace.r_squared is None else f"{trace.r_squared:.3f}"
    return {
        "xref": "paper", "yref": "paper", "x": 1, "y": top, "xanchor": "right", "yanchor": "bottom",
        "text": f"R² = {known}", "showarrow": False, "font": {"size": 11},
    }  # fmt: skip
