"""Measured and fitted data: magnitude and phase per output (Figs 14 and 15)."""

from __future__ import annotations

import numpy as np

from flexsid.figures import quantities, style
from flexsid.figures.spec import Spec, empty, rows, scatter, stack, text_at, title
from flexsid.records.run import Method
from flexsid.records.views import FitPlot, FitTrace

_INPUT_UNIT = "rad"  # responses are stored per radian of surface


def draw_fit(value: FitPlot) -> Spec:
    """Draw measured data as markers, fitted data as a curve, or for OE as rings."""
    if not value.traces:
        return empty("No fitted data")
    colour, symbol = style.of_method(value.method.value)
    points = {
        "mode": "markers",
        "marker": {"color": style.MEASURED, "symbol": symbol, "size": 5},
    }
    curve: Spec = {"mode": "lines", "line": {"color": colour, "width": 1.8}}
    if value.method is Method.OE:  # adjacent harmonics belong to different inputs
        curve = {
            "mode": "markers",
            "marker": {"color": colour, "symbol": "circle-open", "size": 8},
        }
    modelled = value.curve or f"{value.method.value} fit"
    frequency = quantities.of_unit("Frequency", "Hz")
    axes: list[Spec] = []
    data: list[Spec] = []
    for trace in value.traces:
        row = len(axes) + 1
        quantity = _select_quantity(trace, value.method)
        axes += [{**title(quantity.title), "rangemode": "tozero"}, title("Phase [deg]")]
        for name, magnitude, phase_rad, drawing in (
            ("measured", trace.measured_magnitude, trace.measured_phase_rad, points),
            (modelled, trace.fitted_magnitude, trace.fitted_phase_rad, curve),
        ):
            for index, (y, hover) in enumerate(
                (
                    (magnitude * quantity.factor, f"%{{y:.4g}} {quantity.unit}"),
                    (np.rad2deg(phase_rad), "%{y:.1f} deg"),
                )
            ):
                data.append(
                    scatter(
                        frequency.factor * value.frequency_hz,
                        y,
                        row=row + index,
                        name=name,
                        legendgroup=name,
                        showlegend=row + index == 1,
                        customdata=[value.run_id],
                        hovertemplate=f"%{{x:.3f}} {frequency.unit}<br>{hover}"
                        f"<extra>{name}</extra>",
                        **drawing,
                    )
                )
    heights = [1.4, 1.0] * len(value.traces)
    notes = [
        _write_r_squared(trace, top)
        for trace, (_, top) in zip(value.traces, rows(heights)[::2], strict=True)
    ]
    layout = stack(
        title(frequency.axis_title),
        axes,
        heights,
        showlegend=True,
        hovermode="closest",
        annotations=notes,
    )
    return {"data": data, "layout": layout}


def _select_quantity(trace: FitTrace, method: Method) -> quantities.DisplayQuantity:
    output = quantities.of_channel(trace.output, trace.unit)
    if method is Method.FRE and trace.input is not None:
        return quantities.ratio(output, quantities.of_channel(trace.input, _INPUT_UNIT))
    return quantities.transform(output)


def _write_r_squared(trace: FitTrace, top: float) -> Spec:
    known = "–" if trace.r_squared is None else f"{trace.r_squared:.3f}"
    return text_at(1, top, f"R² = {known}", "right", "bottom", {"size": 11})
