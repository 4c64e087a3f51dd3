"""Surfaces against their commands through the servos, left against right (Fig. 4)."""

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
from flexsid.records.views import ChannelTrace, SurfaceHistories

_MEASURED = (style.BLUE, style.VERMILION)  # of a pair: left, right


def draw_surface_histories(value: SurfaceHistories) -> Spec:
    """Draw measured deflections, and over them what the commands make of them."""
    if not any(one.measured.time_s.size for row in value.rows for one in row):
        return empty("No samples in this window")
    headings, data, named = [], [], set[str]()
    for number, row in enumerate(value.rows, start=1):
        shown = [quantities.of_channel(one.measured.name, one.measured.unit) for one in row]
        headings.append(title("<br>".join(one.title for one in shown)))
        sides = ("measured",) if len(row) == 1 else ("measured, left", "measured, right")
        for one, quantity, side, colour in zip(row, shown, sides, _MEASURED, strict=False):
            curves: list[tuple[ChannelTrace | None, str, dict[str, object]]] = [
                (one.measured, side, {"color": colour, "width": 1}),
                (
                    one.commanded,
                    "command through the servo",
                    {"color": style.GREY, "width": 1, "dash": "dot"},
                ),
            ]
            for trace, name, line in curves:
                if trace is None:
                    continue
                drawn = select_samples(trace.time_s, trace.values, value.points)
                data.append(
                    scatter(
                        column(trace.time_s, exact=True, drawn=drawn),
                        column(trace.values * quantity.factor, drawn=drawn),
                        "lines",
                        row=number,
                        name=name,
                        legendgroup=name,
                        showlegend=name not in named,
                        line=line,
                        meta=one.measured.name,
                        hovertemplate=f"%{{y:.4g}} {quantity.unit}<extra>{quantity.label}, "
                        f"{name}</extra>",
                    )
                )
                named.add(name)
    legend = {"orientation": "h", "y": 1.02, "yanchor": "bottom"}
    return {
        "data": data,
        "layout": stack(time_axis(), headings, legend=legend, hovermode="x"),
    }
