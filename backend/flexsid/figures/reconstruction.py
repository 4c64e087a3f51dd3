"""Reconstructed motion and coefficients in time (Fig. 16a), and line by line with its rank."""

from __future__ import annotations

import numpy as np

from flexsid.figures import quantities, style
from flexsid.figures.spec import Spec, axis, column, empty, layout_key, rows, title
from flexsid.figures.time_history import thinned
from flexsid.records.reconstruction import ReconstructedTrace, Reconstruction

_POINTS = 2000


def reconstruction(value: Reconstruction) -> Spec:
    """Draw each quantity in time with ±2 standard errors."""
    if not value.traces:
        return empty("Nothing chosen")
    count = len(value.traces)
    layout: Spec = {
        "xaxis": {**title("Time [s]"), "anchor": axis(count)},
        "legend": {"orientation": "h", "y": 1.02, "yanchor": "bottom"},
        "hovermode": "x",
        "meta": _meta(value, count),
    }
    data: list[Spec] = []
    for number, (trace, domain) in enumerate(
        zip(value.traces, rows([1.0] * count), strict=True), start=1
    ):
        quantity = quantities.of_channel(trace.name, trace.unit)
        layout[layout_key(number)] = {**title(_heading(quantity)), "domain": domain}
        data += _in_time(value.time_s, trace, quantity, number)
    return {"data": data, "layout": layout}


def reconstruction_lines(value: Reconstruction) -> Spec:
    """Draw each quantity at the lines with ±2 standard errors, and the condition number below."""
    count = len(value.traces) + 1
    layout: Spec = {
        "xaxis": {**title("Frequency [Hz]"), "anchor": axis(count)},
        "legend": {"orientation": "h", "y": 1.02, "yanchor": "bottom"},
        "hovermode": "closest",
        "meta": _meta(value, count),
    }
    data: list[Spec] = []
    domains = rows([1.0] * count)
    for number, (trace, domain) in enumerate(zip(value.traces, domains, strict=False), start=1):
        quantity = quantities.transform(quantities.of_channel(trace.name, trace.unit))
        layout[layout_key(number)] = {**title(quantity.title), "domain": domain, "type": "log"}
        data.append(_at_lines(value.frequency_hz, trace, quantity, number))
    layout[layout_key(count)] = {
        **title("Condition [1]"),
        "domain": domains[-1],
        "type": "log",
    }
    full = value.rank == value.n_motions
    for name, chosen, colour in (
        (f"rank {value.n_motions}", full, style.BLUE),
        ("rank less", ~full, style.FLAG),
    ):
        if chosen.any():
            finite = np.where(np.isfinite(value.condition), value.condition, np.nan)
            data.append(
                {
                    "type": "scatter",
                    "mode": "markers",
                    "name": name,
                    "x": column(value.frequency_hz[chosen]),
                    "y": column(finite[chosen]),
                    "yaxis": axis(count),
                    "marker": {"color": colour, "size": 4},
                    "text": [f"rank {rank}" for rank in value.rank[chosen].tolist()],
                    "hovertemplate": "%{x:.3f} Hz<br>condition %{y:.3g}<br>%{text}<extra></extra>",
                }
            )
    return {"data": data, "layout": layout}


def _meta(value: Reconstruction, count: int) -> Spec:
    """What the page offers and tells beside the figure."""
    finite = value.condition[np.isfinite(value.condition)]
    return {
        "rows": count,
        "offered": list(value.offered),
        "modes": list(value.modes),
        "mode_names": list(value.mode_names),
        "n_motions": value.n_motions,
        "least_rank": int(value.rank.min()),
        "worst_condition": float(finite.max()) if finite.size else None,
        "n_sensors": len(value.sensors),
        "left_out": [f"{name}: {reason}" for name, reason in value.left_out.items()],
    }


def _heading(quantity: quantities.DisplayQuantity) -> str:
    return quantity.label if quantity.unit == "1" else quantity.title


def _in_time(
    time_s: np.ndarray, trace: ReconstructedTrace, quantity: quantities.DisplayQuantity, number: int
) -> list[Spec]:
    kept = thinned(time_s, trace.values, _POINTS)
    at, values = time_s[kept], trace.values[kept] * quantity.factor
    band = 2.0 * trace.std[kept] * quantity.factor
    common: Spec = {"type": "scatter", "mode": "lines", "yaxis": axis(number)}
    return [
        {
            **common,
            "name": "±2 standard errors",
            "legendgroup": "band",
            "showlegend": number == 1,
            "x": column(np.concatenate([at, at[::-1]]), exact=True),
            "y": column(np.concatenate([values + band, (values - band)[::-1]])),
            "fill": "toself",
            "fillcolor": style.GREY,
            "opacity": 0.35,
            "line": {"width": 0, "color": style.GREY},
            "hoverinfo": "skip",
        },
        {
            **common,
            "name": "reconstructed",
            "legendgroup": "value",
            "showlegend": number == 1,
            "x": column(at, exact=True),
            "y": column(values),
            "line": {"color": style.BLUE, "width": 1},
            "meta": trace.name,
            "hovertemplate": f"%{{y:.4g}} {quantity.unit}<extra>{quantity.label}</extra>",
        },
    ]


def _at_lines(
    frequency_hz: np.ndarray,
    trace: ReconstructedTrace,
    quantity: quantities.DisplayQuantity,
    number: int,
) -> Spec:
    return {
        "type": "scatter",
        "mode": "markers",
        "name": "±2 standard errors",
        "legendgroup": "lines",
        "showlegend": number == 1,
        "x": column(frequency_hz),
        "y": column(trace.line_magnitude * quantity.factor),
        "error_y": {
            "type": "data",
            "array": column(2.0 * trace.line_std * quantity.factor),
            "thickness": 1,
            "width": 0,
        },
        "yaxis": axis(number),
        "marker": {"color": style.BLUE, "size": 4},
        "meta": trace.name,
        "hovertemplate": f"%{{x:.3f}} Hz<br>%{{y:.3g}} {quantity.unit}<extra></extra>",
    }
