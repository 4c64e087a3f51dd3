"""Reconstructed motion and coefficients in time (Fig. 16a) and over frequency, with rank."""

from __future__ import annotations

import numpy as np

from flexsid.figures import quantities, style
from flexsid.figures.spec import Spec, axis, column, empty, layout_key, rows, title
from flexsid.figures.time_history import select_samples
from flexsid.records.reconstruction import ReconstructedTrace, Reconstruction

_POINTS = 2000


def reconstruction(value: Reconstruction) -> Spec:
    """Draw each quantity in time with ±2 standard errors."""
    if not value.traces:
        return empty("No quantity selected")
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
        layout[layout_key(number)] = {**title(_format_title(quantity)), "domain": domain}
        data += _draw_history(value.time_s, trace, quantity, number)
    return {"data": data, "layout": layout}


def reconstruction_lines(value: Reconstruction) -> Spec:
    """Draw each quantity over frequency with ±2 standard errors, and the condition number."""
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
        data.append(_draw_spectrum(value.frequency_hz, trace, quantity, number))
    layout[layout_key(count)] = {
        **title("Condition number [1]"),
        "domain": domains[-1],
        "type": "log",
    }
    full = value.rank == value.n_motions
    for name, selected, colour in (
        (f"rank {value.n_motions}", full, style.BLUE),
        ("rank-deficient", ~full, style.FLAG),
    ):
        if selected.any():
            finite = np.where(np.isfinite(value.condition), value.condition, np.nan)
            data.append(
                {
                    "type": "scatter",
                    "mode": "markers",
                    "name": name,
                    "x": column(value.frequency_hz[selected]),
                    "y": column(finite[selected]),
                    "yaxis": axis(count),
                    "marker": {"color": colour, "size": 4},
                    "text": [f"rank {rank}" for rank in value.rank[selected].tolist()],
                    "hovertemplate": "%{x:.3f} Hz<br>cond. %{y:.3g}<br>%{text}<extra></extra>",
                }
            )
    return {"data": data, "layout": layout}


def _meta(value: Reconstruction, count: int) -> Spec:
    """Collect values for the page beside the figure."""
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
        "excluded": [f"{name}: {reason}" for name, reason in value.excluded.items()],
    }


def _format_title(quantity: quantities.DisplayQuantity) -> str:
    return quantity.label if quantity.unit == "1" else quantity.title


def _draw_history(
    time_s: np.ndarray, trace: ReconstructedTrace, quantity: quantities.DisplayQuantity, number: int
) -> list[Spec]:
    indices = select_samples(time_s, trace.values, _POINTS)
    at, values = time_s[indices], trace.values[indices] * quantity.factor
    band = 2.0 * trace.std[indices] * quantity.factor
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


def _draw_spectrum(
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
