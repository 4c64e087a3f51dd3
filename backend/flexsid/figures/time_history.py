"""Channels against time, one row each on a shared time axis (Figs 4 and 8)."""

from __future__ import annotations

import numpy as np

from flexsid.figures import quantities, style
from flexsid.figures.spec import (
    Spec,
    band,
    column,
    empty,
    scatter,
    select_samples,
    stack,
    time_axis,
    title,
)
from flexsid.records.maneuver import Role
from flexsid.records.views import ChannelHistories, ChannelTrace

_COLOURS = {
    Role.INPUT: style.BLUE,
    Role.COMMAND: style.GREEN,
    Role.OUTPUT: style.VERMILION,
    Role.CONDITION: style.VIOLET,
}


def draw_time_history(value: ChannelHistories) -> Spec:
    """Draw each channel in its own row and unit, downsampled to screen resolution."""
    ends = [trace.time_s[[0, -1]] for trace in value.traces if trace.time_s.size]
    if not ends:
        return empty("No samples in this window")
    shown = [quantities.of_channel(trace.name, trace.unit) for trace in value.traces]
    layout = stack(
        {**time_axis(value.origin), "range": [float(np.min(ends)), float(np.max(ends))]},
        [title(quantity.title) for quantity in shown],
        showlegend=False,
        hovermode="x",
    )
    if value.excitation_s is not None:
        layout["shapes"] = [band(*value.excitation_s, style.GREY, opacity=0.08)]
    data = [
        _draw(trace, quantity, row, value.points)
        for row, (trace, quantity) in enumerate(zip(value.traces, shown, strict=True), start=1)
    ]
    return {"data": data, "layout": layout}


def _draw(trace: ChannelTrace, shown: quantities.DisplayQuantity, row: int, points: int) -> Spec:
    drawn = select_samples(trace.time_s, trace.values, points)
    return scatter(
        column(trace.time_s, exact=True, drawn=drawn),
        column(trace.values * shown.factor, drawn=drawn),
        "lines",
        row=row,
        name=shown.label,
        line={"color": _COLOURS[trace.role], "width": 1},
        meta=trace.name,
        hovertemplate=f"%{{y:.4g}} {shown.unit}<extra>{shown.label}</extra>",
    )
