"""Reconstructed motion and coefficients in time (Fig. 16a) and over frequency, with rank."""

from __future__ import annotations

from typing import Literal

import numpy as np

from flexsid.figures import quantities, style
from flexsid.figures.spec import (
    N_SIGMA,
    Spec,
    column,
    empty,
    error_bars,
    scatter,
    select_samples,
    stack,
    time_axis,
    title,
)
from flexsid.records.views import ReconstructedTrace, Reconstruction

_POINTS = 2000
_LEGEND = {"orientation": "h", "y": 1.02, "yanchor": "bottom"}


def draw_reconstruction(
    value: Reconstruction, domain: Literal["time", "frequency"] = "time"
) -> Spec:
    """Draw each quantity with ±2 standard errors, in time or over frequency.

    Over frequency with the condition number in a further row.
    """
    return _draw_histories(value) if domain == "time" else _draw_spectra(value)


def _draw_histories(value: Reconstruction) -> Spec:
    if not value.traces:
        return empty("No quantity selected")
    titles, data = [], []
    for row, trace in enumerate(value.traces, start=1):
        quantity = quantities.of_channel(trace.name, trace.unit)
        titles.append(title(quantity.label if quantity.unit == "1" else quantity.title))
        data += _draw_history(value.time_s, trace, quantity, row)
    layout = stack(time_axis(), titles, legend=_LEGEND, hovermode="x")
    return {"data": data, "layout": layout | {"meta": _describe(value, len(titles))}}


def _draw_spectra(value: Reconstruction) -> Spec:
    frequency = quantities.of_unit("Frequency", "Hz")
    titles, data = [], []
    for row, trace in enumerate(value.traces, start=1):
        quantity = quantities.transform(quantities.of_channel(trace.name, trace.unit))
        titles.append(quantity.title)
        data.append(
            scatter(
                frequency.factor * value.frequency_hz,
                trace.spectrum_magnitude * quantity.factor,
                row=row,
                name="±2 standard errors",
                legendgroup="lines",
                showlegend=row == 1,
                error_y=error_bars(trace.spectrum_std * quantity.factor, thickness=1, width=0),
                marker={"color": style.BLUE, "size": 4},
                meta=trace.name,
                hovertemplate=f"%{{x:.3f}} {frequency.unit}<br>%{{y:.3g}} {quantity.unit}"
                "<extra></extra>",
            )
        )
    titles.append("Condition number [1]")
    full = value.rank == value.n_motions
    for name, selected, colour in (
        (f"rank {value.n_motions}", full, style.BLUE),
        ("rank-deficient", ~full, style.FLAG),
    ):
        if selected.any():
            data.append(
                scatter(
                    frequency.factor * value.frequency_hz[selected],
                    value.condition[selected],
                    row=len(titles),
                    name=name,
                    marker={"color": colour, "size": 4},
                    text=[f"rank {rank}" for rank in value.rank[selected].tolist()],
                    hovertemplate=f"%{{x:.3f}} {frequency.unit}<br>cond. %{{y:.3g}}<br>%{{text}}"
                    "<extra></extra>",
                )
            )
    axes = [{**title(text), "type": "log"} for text in titles]
    layout = stack(title(frequency.axis_title), axes, legend=_LEGEND, hovermode="closest")
    return {"data": data, "layout": layout | {"meta": _describe(value, len(titles))}}


def _describe(value: Reconstruction, count: int) -> Spec:
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
        "excluded": [
            f"{', '.join(name for name, given in value.excluded.items() if given == reason)}: "
            f"{reason}"
            for reason in dict.fromkeys(value.excluded.values())
        ],
    }


def _draw_history(
    time_s: np.ndarray, trace: ReconstructedTrace, quantity: quantities.DisplayQuantity, row: int
) -> list[Spec]:
    drawn = select_samples(time_s, trace.values, _POINTS)
    # There and back, around the band.
    around = np.concatenate([drawn, 2 * time_s.size - 1 - drawn[::-1]])
    values = trace.values * quantity.factor
    spread = N_SIGMA * trace.std * quantity.factor
    return [
        scatter(
            column(np.concatenate([time_s, time_s[::-1]]), exact=True, drawn=around),
            column(np.concatenate([values + spread, (values - spread)[::-1]]), drawn=around),
            "lines",
            row=row,
            name="±2 standard errors",
            legendgroup="band",
            showlegend=row == 1,
            fill="toself",
            fillcolor=style.GREY,
            opacity=0.35,
            line={"width": 0, "color": style.GREY},
            hoverinfo="skip",
        ),
        scatter(
            column(time_s, exact=True, drawn=drawn),
            column(values, drawn=drawn),
            "lines",
            row=row,
            name="reconstructed",
            legendgroup="value",
            showlegend=row == 1,
            line={"color": style.BLUE, "width": 1},
            meta=trace.name,
            hovertemplate=f"%{{y:.4g}} {quantity.unit}<extra>{quantity.label}</extra>",
        ),
    ]
