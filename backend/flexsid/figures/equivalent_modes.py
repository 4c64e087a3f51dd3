"""Equivalent frequency and damping of modes over dynamic pressure."""

from __future__ import annotations

import numpy as np

from flexsid.figures import style
from flexsid.figures.quantities import of_unit, text
from flexsid.figures.spec import Spec, column, empty, error_bars, scatter, stack, title
from flexsid.records.flutter import Flutter


def draw_equivalent_modes(value: Flutter) -> Spec:
    """Draw equivalent frequency and damping over dynamic pressure, ±2 standard errors (Eq. 25)."""
    if not value.equivalent_points:
        return empty("No estimated structural modes")
    pressure = of_unit("Dynamic pressure", "Pa")
    frequency = of_unit("Equivalent frequency", "Hz")
    data: list[Spec] = []
    lines = {line.mode: line for line in value.equivalents}
    for number, mode in enumerate(dict.fromkeys(p.mode for p in value.equivalent_points)):
        own = [p for p in value.equivalent_points if p.mode == mode and p.frequency_hz is not None]
        if not own:
            continue
        colour, symbol = style.of_index(number)
        name = text(own[0].name)
        for row, (y, std, scale) in enumerate(
            (
                ("frequency_hz", "frequency_std_hz", frequency.factor),
                ("damping", "damping_std", 100.0),
            ),
            start=1,
        ):
            errors = scale * np.array([getattr(p, std) for p in own], dtype=float)
            data.append(
                scatter(
                    column([pressure.factor * p.dynamic_pressure_pa for p in own]),
                    scale * np.array([getattr(p, y) for p in own], dtype=float),
                    row=row,
                    name=name,
                    legendgroup=own[0].name,
                    showlegend=row == 1,
                    error_y=error_bars(errors, thickness=1),
                    marker={"color": colour, "symbol": symbol, "size": 7},
                    text=[text(p.label) for p in own],
                    customdata=[[p.run_id] for p in own],
                    hovertemplate=f"%{{text}}<br>%{{x:.4~g}} {pressure.unit}<br>%{{y:.4g}}"
                    "<extra></extra>",
                )
            )
            if mode in lines:
                data.append(
                    scatter(
                        [0.0],
                        [scale * getattr(lines[mode], y)],
                        row=row,
                        name=f"{name} in vacuo",
                        legendgroup=own[0].name,
                        showlegend=False,
                        error_y=error_bars([scale * getattr(lines[mode], std)], thickness=1),
                        marker={"color": colour, "symbol": f"{symbol}-open", "size": 10},
                        hovertemplate="in vacuo<br>%{y:.4g}<extra></extra>",
                    )
                )
    layout = stack(
        {**title(pressure.axis_title), "rangemode": "tozero"},
        [title(frequency.axis_title), title("Equivalent damping [%]")],
        showlegend=True,
        hovermode="closest",
        meta={"rows": 3, "note": "Open markers: in vacuo, extrapolated by linear fits."},
    )
    return {"data": data, "layout": layout}
