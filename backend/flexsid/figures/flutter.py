"""Predicted flutter speed during a campaign, and its map over fuel and altitude."""

from __future__ import annotations

import numpy as np

from flexsid.figures import style
from flexsid.figures.quantities import of_unit, text
from flexsid.figures.spec import (
    Spec,
    band,
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
    speed = of_unit("Flutter speed", "m/s")
    std = _convert([run.airspeed_std_m_s for run in known])
    data: list[Spec] = [
        scatter(
            _convert([run.tested_m_s for run in known]),
            _convert([run.airspeed_m_s for run in known]),
            name="single runs ±2σ",
            error_y=error_bars(std, style.BLUE, thickness=1),
            marker={"color": style.BLUE, "size": 8},
            text=[text(run.label) for run in known],
            customdata=[[run.run_id] for run in known],
            hovertemplate=f"%{{text}}<br>at %{{x:.1f}} {speed.unit}<br>"
            f"flutter %{{y:.2f}} {speed.unit}<extra></extra>",
        )
    ]
    data += _draw_progress(value)
    tested = [speed.factor * run.tested_m_s for run in known]
    ends = [min(tested), max(tested)]
    levels = [
        ("all runs fused", value.airspeed_m_s, style.BLUE, "solid"),
        ("predicted before flight", value.predicted_flutter_m_s, style.GREY, "dash"),
        *(
            (method.name, method.airspeed_m_s, style.PREDICTIONS[k % 4][0], "dot")
            for k, method in enumerate(value.trackers)
        ),
    ]
    for name, level, colour, dash in levels:
        if level is not None:
            data.append(
                scatter(
                    ends,
                    [speed.factor * level] * 2,
                    "lines",
                    name=name,
                    line={"color": colour, "dash": dash, "width": 1.8},
                    hovertemplate=f"%{{y:.2f}} {speed.unit}<extra>{name}</extra>",
                )
            )
    view: Spec = {}
    if value.airspeed_m_s is not None:
        fused = speed.factor * value.airspeed_m_s
        view = {"range": [0.8 * fused, 1.25 * fused]}
    shapes: list[Spec] = []
    if value.low_m_s is not None and value.high_m_s is not None:
        low, high = speed.factor * value.low_m_s, speed.factor * value.high_m_s
        shapes = [band(low, high, style.BLUE, letter="y", opacity=_FILL)]
    y_axis = {**title(speed.axis_title), **view}
    layout = plane(title(of_unit("Flown airspeed", "m/s").axis_title), y_axis, 3, shapes=shapes)
    return {"data": data, "layout": layout}


def _draw_progress(value: Flutter) -> list[Spec]:
    """Draw the fused prediction after each airspeed, with its interval."""
    known = [step for step in value.progress if step.airspeed_m_s is not None]
    if len(known) < 2:
        return []
    unit = of_unit("Flutter speed", "m/s").unit
    speed = _convert([step.airspeed_m_s for step in known])
    high = _convert([step.high_m_s for step in known])
    return [
        scatter(
            _convert([step.tested_m_s for step in known]),
            speed,
            "lines+markers",
            name="runs up to this airspeed, 95 %",
            error_y=error_bars(high - speed, style.VERMILION, factor=1.0, thickness=1.5),
            marker={"color": style.VERMILION, "size": 7, "symbol": "diamond"},
            line={"color": style.VERMILION, "width": 1.2},
            text=[f"{step.n_runs} runs" for step in known],
            hovertemplate=f"%{{text}} up to %{{x:.1f}} {unit}<br>%{{y:.2f}} {unit}<extra></extra>",
        )
    ]


def _convert(speeds_m_s: list[float | None]) -> np.ndarray:
    return of_unit("Airspeed", "m/s").factor * np.array(speeds_m_s, dtype=float)


def draw_flutter_map(value: FlutterMap) -> Spec:
    """Draw the flutter speed over fuel and altitude."""
    if not np.isfinite(value.airspeed_m_s).any():
        return empty("No instability at the searched loadings and altitudes")
    speed, altitude = of_unit("Speed", "m/s"), of_unit("Altitude, standard atmosphere", "m")
    trace = heatmap(
        [100.0 * fuel for fuel in value.fuel.tolist()],
        (altitude.factor * value.altitude_m).tolist(),
        speed.factor * value.airspeed_m_s,
        name="flutter speed",
        colorscale="Viridis",
        colorbar=title(speed.unit),
        hovertemplate=f"fuel %{{x:.0f}} %<br>altitude %{{y:.0f}} {altitude.unit}<br>"
        f"%{{z:.2f}} {speed.unit}<extra></extra>",
    )
    layout = {
        "xaxis": title("Fuel [%]"),
        "yaxis": title(altitude.axis_title),
        "meta": {"rows": 3},
    }
    return {"data": [trace], "layout": layout}
