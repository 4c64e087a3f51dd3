"""Channels against time, one row each on a shared time axis (Figs 4 and 8)."""

from __future__ import annotations

import numpy as np
from tsdownsample import MinMaxLTTBDownsampler

from flexsid.figures import quantities, style
from flexsid.figures.spec import Spec, axis, column, empty, layout_key, rows, title
from flexsid.records.maneuver import Role
from flexsid.records.views import ChannelHistories, ChannelTrace

_COLOURS = {
    Role.INPUT: style.BLUE,
    Role.COMMAND: style.GREEN,
    Role.OUTPUT: style.VERMILION,
    Role.CONDITION: style.VIOLET,
}


def time_history(value: ChannelHistories) -> Spec:
    """Draw each channel in its own row and unit, downsampled to screen resolution."""
    ends = [trace.time_s[[0, -1]] for trace in value.traces if trace.time_s.size]
    if not ends:
        return empty("No samples in this window")
    count = len(value.traces)
    shown = [float(np.min(ends)), float(np.max(ends))]
    layout: Spec = {
        "xaxis": {**title("Time [s]"), "anchor": axis(count), "range": shown},
        "showlegend": False,
        "hovermode": "x",
        "meta": {"rows": count},
    }
    if value.excitation_s is not None:
        layout["shapes"] = [_excitation(*value.excitation_s)]
    data = []
    for number, (trace, domain) in enumerate(
        zip(value.traces, rows([1.0] * count), strict=True), start=1
    ):
        quantity = quantities.of_channel(trace.name, trace.unit)
        layout[layout_key(number)] = {**title(quantity.title), "domain": domain}
        data.append(_trace(trace, quantity, axis(number), value.points))
    return {"data": data, "layout": layout}


def _trace(
    trace: ChannelTrace, quantity: quantities.DisplayQuantity, row: str, points: int
) -> Spec:
    indices = select_samples(trace.time_s, trace.values, points)
    return {
        "type": "scatter",
        "mode": "lines",
        "name": quantity.label,
        "x": column(trace.time_s[indices], exact=True),
        "y": column(trace.values[indices] * quantity.factor),
        "yaxis": row,
        "line": {"color": _COLOURS[trace.role], "width": 1},
        "meta": trace.name,
        "hovertemplate": f"%{{y:.4g}} {quantity.unit}<extra>{quantity.label}</extra>",
    }


def select_samples(time_s: np.ndarray, values: np.ndarray, points: int) -> np.ndarray:
    """Select at most ``points`` samples that retain every visible peak."""
    if len(values) <= points:
        return np.arange(len(values))
    indices = MinMaxLTTBDownsampler().downsample(
        np.ascontiguousarray(time_s), np.ascontiguousarray(values), n_out=points
    )
    return indices.astype(np.intp)


def _excitation(start_s: float, stop_s: float) -> Spec:
    return {
        "type": "rect", "xref": "x", "yref": "paper", "x0": start_s, "x1": stop_s, "y0": 0, "y1": 1,
        "fillcolor": style.GREY, "opacity": 0.08, "line": {"width": 0}, "layer": "below",
    }  # fmt: skip
