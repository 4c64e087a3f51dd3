"""What was known during a flight: flutter speed and damping of each mode over time."""

from __future__ import annotations

from flexsid.figures import style
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
    time = column(value.time_s, exact=True)
    blue, symbol = style.of_index(0)
    data = [
        scatter(
            time,
            column(value.flutter_m_s),
            row=1,
            name="flutter speed",
            marker={"color": blue, "symbol": symbol},
            error_y=error_bars([std or float("nan") for std in value.flutter_std_m_s], blue),
            hovertemplate="%{x:.1f} s<br>%{y:.2f} m/s<extra>flutter speed</extra>",
        ),
        scatter(
            time,
            column(value.airspeed_m_s),
            "lines",
            row=1,
            name="present airspeed",
            line={"color": style.GREY},
            hovertemplate="%{x:.1f} s<br>%{y:.2f} m/s<extra>airspeed</extra>",
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
    axes = (title("Speed [m/s]"), title("Damping ratio [1]"))
    stability = line_at(0.0, "y", line=BOUNDARY) | {"yref": "y2", "xref": "paper"}
    return {"data": data, "layout": stack(time_axis(), axes, showlegend=True, shapes=[stability])}
