"""Predicted flutter speed during a campaign, and its map over fuel and altitude."""

from __future__ import annotations

import numpy as np

from flexsid.figures import style
from flexsid.figures.quantities import text
from flexsid.figures.spec import Spec, column, empty, title
from flexsid.records.flutter import Flutter, FlutterMap

_FILL = 0.18


def flutter_forecast(value: Flutter) -> Spec:
    """Draw predicted flutter speed against flown airspeed, by run and fused."""
    known = [run for run in value.runs if run.airspeed_m_s is not None]
    if not known:
        return empty("No run predicts an instability")
    errors = [np.nan if r.airspeed_std_m_s is None else 2.0 * r.airspeed_std_m_s for r in known]
    data: list[Spec] = [
        {
            "type": "scatter",
            "mode": "markers",
            "name": "single runs ±2σ",
            "x": column([run.tested_m_s for run in known]),
            "y": column([float(run.airspeed_m_s or 0.0) for run in known]),
            "error_y": {
                "type": "data", "array": column(errors), "color": style.BLUE, "thickness": 1,
            },
            "marker": {"color": style.BLUE, "size": 8},
            "text": [text(run.label) for run in known],
            "customdata": [[run.run_id] for run in known],
            "hovertemplate": "%{text}<br>at %{x:.1f} m/s<br>flutter %{y:.2f} m/s<extra></extra>",
        }
    ]  # fmt: skip
    data += _progress(value)
    shapes: list[Spec] = []
    if value.low_m_s is not None and value.high_m_s is not None:
        shapes.append(
            {
                "type": "rect", "xref": "paper", "x0": 0, "x1": 1, "yref": "y",
                "y0": value.low_m_s, "y1": value.high_m_s, "fillcolor": style.BLUE,
                "opacity": _FILL, "line": {"width": 0}, "layer": "below",
            }
        )  # fmt: skip
    ends = [min(run.tested_m_s for run in known), max(run.tested_m_s for run in known)]
    levels = [("all runs fused", value.airspeed_m_s, style.BLUE, "solid")]
    levels.append(("predicted before flight", value.predicted_flutter_m_s, style.GREY, "dash"))
    levels += [
        (method.name, method.airspeed_m_s, style.PREDICTIONS[k % 4][0], "dot")
        for k, method in enumerate(value.trackers)
    ]
    for name, speed, colour, dash in levels:
        if speed is not None:
            data.append(
                {
                    "type": "scatter", "mode": "lines", "name": name, "x": ends,
                    "y": [speed, speed], "line": {"color": colour, "dash": dash, "width": 1.8},
                    "hovertemplate": f"%{{y:.2f}} m/s<extra>{name}</extra>",
                }
            )  # fmt: skip
    layout: Spec = {
        "xaxis": title("Flown airspeed [m/s]"),
        "yaxis": title("Flutter speed [m/s]") | _range(value.airspeed_m_s),
        "shapes": shapes,
        "showlegend": True,
        "hovermode": "closest",
        "meta": {"rows": 3},
    }
    return {"data": data, "layout": layout}


def _progress(value: Flutter) -> list[Spec]:
    """Draw the fused prediction after each airspeed, with its interval."""
    known = [step for step in value.progress if step.airspeed_m_s is not None]
    if len(known) < 2:
        return []
    up = [float(step.high_m_s or np.nan) - float(step.airspeed_m_s or 0.0) for step in known]
    return [
        {
            "type": "scatter",
            "mode": "lines+markers",
            "name": "runs up to this airspeed, 95 %",
            "x": column([step.tested_m_s for step in known]),
            "y": column([float(step.airspeed_m_s or 0.0) for step in known]),
            "error_y": {
                "type": "data", "array": column(up), "color": style.VERMILION, "thickness": 1.5,
            },
            "marker": {"color": style.VERMILION, "size": 7, "symbol": "diamond"},
            "line": {"color": style.VERMILION, "width": 1.2},
            "text": [f"{step.n_runs} runs" for step in known],
            "hovertemplate": "%{text} up to %{x:.1f} m/s<br>%{y:.2f} m/s<extra></extra>",
        }
    ]  # fmt: skip


def flutter_map(value: FlutterMap) -> Spec:
    """Draw the flutter speed over fuel and altitude."""
    if not np.isfinite(value.airspeed_m_s).any():
        return empty("No instability at the searched loadings and altitudes")
    return {
        "data": [
            {
                "type": "heatmap",
                "name": "flutter speed",
                "x": [100.0 * fuel for fuel in value.fuel.tolist()],
                "y": value.altitude_m.tolist(),
                "z": column(value.airspeed_m_s),
                "colorscale": "Viridis",
                "colorbar": {"title": {"text": "m/s"}},
                "hovertemplate": (
                    "fuel %{x:.0f} %<br>altitude %{y:.0f} m<br>%{z:.2f} m/s<extra></extra>"
                ),
            }
        ],
        "layout": {
            "xaxis": title("Fuel [%]"),
            "yaxis": title("Altitude, standard atmosphere [m]"),
            "meta": {"rows": 3},
        },
    }


def _range(speed: float | None) -> Spec:
    """Return a range about the predicted flutter speed."""
    return {} if speed is None else {"range": [0.8 * speed, 1.25 * speed]}
