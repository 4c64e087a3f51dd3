"""Predicted flutter speed during a campaign, and its map over fuel and altitude."""

from __future__ import annotations

import numpy as np

from flexsid.figures import style
from flexsid.figures.quantities import text
from flexsid.figures.spec import (
    Spec,
    band,
    column,
    empty,
    error_bars,
    heatmap,
    plane,
    scatter,
    title,
)
from flexsid.records.flutter import Flutter, FlutterMap

_FILL = 0.18


def draw_flutter_forecast(value: Flutter) -> Spec:
    """Draw predicted flutter speed against flown airspeed, by run and fused."""
    known = [run for run in value.runs if run.airspeed_m_s is not None]
    if not known:
        return empty("No run predicts an instability")
    std = [run.airspeed_std_m_s for run in known]
    data: list[Spec] = [
        scatter(
            column([run.tested_m_s for run in known]),
            column([run.airspeed_m_s for run in known]),
            name="single runs ±2σ",
            error_y=error_bars(std, style.BLUE, thickness=1),
            marker={"color": style.BLUE, "size": 8},
            text=[text(run.label) for run in known],
            customdata=[[run.run_id] for run in known],
            hovertemplate="%{text}<br>at %{x:.1f} m/s<br>flutter %{y:.2f} m/s<extra></extra>",
        )
    ]
    data += _draw_progress(value)
    ends = [min(run.tested_m_s for run in known), max(run.tested_m_s for run in known)]
    levels = [
        ("all runs fused", value.airspeed_m_s, style.BLUE, "solid"),
        ("predicted before flight", value.predicted_flutter_m_s, style.GREY, "dash"),
        *(
            (method.name, method.airspeed_m_s, style.PREDICTIONS[k % 4][0], "dot")
            for k, method in enumerate(value.trackers)
        ),
    ]
    for name, speed, colour, dash in levels:
        if speed is not None:
            data.append(
                scatter(
                    ends,
                    [speed, speed],
                    "lines",
                    name=name,
                    line={"color": colour, "dash": dash, "width": 1.8},
                    hovertemplate=f"%{{y:.2f}} m/s<extra>{name}</extra>",
                )
            )
    speed = value.airspeed_m_s
    view = {} if speed is None else {"range": [0.8 * speed, 1.25 * speed]}
    shapes: list[Spec] = []
    if value.low_m_s is not None and value.high_m_s is not None:
        shapes = [band(value.low_m_s, value.high_m_s, style.BLUE, letter="y", opacity=_FILL)]
    y_axis = {**title("Flutter speed [m/s]"), **view}
    layout = plane(title("Flown airspeed [m/s]"), y_axis, 3, shapes=shapes)
    return {"data": data, "layout": layout}


def _draw_progress(value: Flutter) -> list[Spec]:
    """Draw the fused prediction after each airspeed, with its interval."""
    known = [step for step in value.progress if step.airspeed_m_s is not None]
    if len(known) < 2:
        return []
    speed = np.array([step.airspeed_m_s for step in known], dtype=float)
    high = np.array([step.high_m_s for step in known], dtype=float)
    return [
        scatter(
            column([step.tested_m_s for step in known]),
            speed,
            "lines+markers",
            name="runs up to this airspeed, 95 %",
            error_y=error_bars(high - speed, style.VERMILION, factor=1.0, thickness=1.5),
            marker={"color": style.VERMILION, "size": 7, "symbol": "diamond"},
            line={"color": style.VERMILION, "width": 1.2},
            text=[f"{step.n_runs} runs" for step in known],
            hovertemplate="%{text} up to %{x:.1f} m/s<br>%{y:.2f} m/s<extra></extra>",
        )
    ]


def draw_flutter_map(value: FlutterMap) -> Spec:
    """Draw the flutter speed over fuel and altitude."""
    if not np.isfinite(value.airspeed_m_s).any():
        return empty("No instability at the searched loadings and altitudes")
    trace = heatmap(
        [100.0 * fuel for fuel in value.fuel.tolist()],
        value.altitude_m.tolist(),
        value.airspeed_m_s,
        name="flutter speed",
        colorscale="Viridis",
        colorbar=title("m/s"),
        hovertemplate="fuel %{x:.0f} %<br>altitude %{y:.0f} m<br>%{z:.2f} m/s<extra></extra>",
    )
    layout = {
        "xaxis": title("Fuel [%]"),
        "yaxis": title("Altitude, standard atmosphere [m]"),
        "meta": {"rows": 3},
    }
    return {"data": [trace], "layout": layout}
