"""What was known during a flight: flutter speed and damping of each mode over time."""

from __future__ import annotations

import numpy as np

from flexsid.figures import style
from flexsid.figures.quantities import of_unit
from flexsid.figures.spec import (
    BOUNDARY,
    Spec,
    column,
    empty,
    error_bars,
    line_at,
    scatter,
    stack,
    time_axis,
    title,
)
from flexsid.records.live import LiveHistory


def draw_live_history(value: LiveHistory) -> Spec:
    """Draw the flutter speed with the present airspeed, and damping ratios, ±2 standard errors."""
    if not value.time_s:
        return empty("No estimate")
    speed = of_unit("Speed", "m/s")
    time = column(value.time_s, exact=True)
    blue, symbol = style.of_index(0)
    data = [
        scatter(
            time,
            _convert(value.flutter_m_s, speed.factor),
            row=1,
            name="flutter speed",
            marker={"color": blue, "symbol": symbol},
            error_y=error_bars(_convert(value.flutter_std_m_s, speed.factor), blue),
            hovertemplate=f"%{{x:.1f}} s<br>%{{y:.2f}} {speed.unit}<extra>flutter speed</extra>",
        ),
        scatter(
            time,
            _convert(value.airspeed_m_s, speed.factor),
            "lines",
            row=1,
            name="present airspeed",
            line={"color": style.GREY},
            hovertemplate=f"%{{x:.1f}} s<br>%{{y:.2f}} {speed.unit}<extra>airspeed</extra>",
        ),
    ]
    for index, (name, damping) in enumerate(value.damping.items(), start=1):
        color, symbol = style.of_index(index)
        data.append(
            scatter(
                time,
                column(damping),
                row=2,
                name=name,
                marker={"color": color, "symbol": symbol},
                error_y=error_bars([std or float("nan") for std in value.damping_std[name]], color),
                hovertemplate=f"%{{x:.1f}} s<br>%{{y:.4f}}<extra>{name}</extra>",
            )
        )
    axes = (title(speed.axis_title), title("Damping ratio [1]"))
    stability = line_at(0.0, "y", line=BOUNDARY) | {"yref": "y2", "xref": "paper"}
    return {"data": data, "layout": stack(time_axis(), axes, showlegend=True, shapes=[stability])}


def _convert(speeds_m_s: tuple[float | None, ...], factor: float) -> np.ndarray:
    return factor * np.array(speeds_m_s, dtype=float)
