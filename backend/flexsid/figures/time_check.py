"""Measured and simulated outputs against time, one row each."""

from __future__ import annotations

from flexsid.figures import quantities, style
from flexsid.figures.spec import (
    Spec,
    column,
    empty,
    scatter,
    select_samples,
    stack,
    time_axis,
    title,
)
from flexsid.records.views import TimeCheck


def draw_time_check(value: TimeCheck) -> Spec:
    """Draw measured and simulated outputs with R2 by row."""
    if not value.traces:
        return empty("No outputs selected")
    headings, data = [], []
    for row, trace in enumerate(value.traces, start=1):
        quantity = quantities.of_channel(trace.name, trace.unit)
        headings.append(title(f"{quantity.title}<br>R² = {trace.r_squared:.3f}"))
        for name, samples, colour in (
            ("measured", trace.measured, style.GREY),
            (
                f"{value.method.value} model",
                trace.simulated,
                style.of_method(value.method.value)[0],
            ),
        ):
            drawn = select_samples(trace.time_s, samples, value.points)
            data.append(
                scatter(
                    column(trace.time_s, exact=True, drawn=drawn),
                    column(samples * quantity.factor, drawn=drawn),
                    "lines",
                    row=row,
                    name=name,
                    legendgroup=name,
                    showlegend=row == 1,
                    line={"color": colour, "width": 1},
                    hovertemplate=f"%{{y:.4g}} {quantity.unit}<extra>{name}</extra>",
                )
            )
    legend = {"orientation": "h", "y": 1.02, "yanchor": "bottom"}
    return {
        "data": data,
        "layout": stack(time_axis(), headings, legend=legend, hovermode="x"),
    }
