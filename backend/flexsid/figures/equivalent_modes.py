"""Equivalent frequency and damping of modes over dynamic pressure."""

from __future__ import annotations

import numpy as np

from flexsid.figures import style
from flexsid.figures.quantities import text
from flexsid.figures.spec import Spec, axis, column, empty, layout_key, rows, title
from flexsid.records.flutter import Flutter


def equivalent_modes(value: Flutter) -> Spec:
    """Draw equivalent frequency and damping over dynamic pressure, ±2 standard errors (Eq. 25)."""
    if not value.equivalent_points:
        return empty("No estimated structural modes")
    top, bottom = rows([1.0, 1.0])
    data: list[Spec] = []
    lines = {line.mode: line for line in value.equivalents}
    for number, mode in enumerate(dict.fromkeys(p.mode for p in value.equivalent_points)):
        own = [p for p in value.equivalent_points if p.mode == mode and p.frequency_hz is not None]
        if not own:
            continue
        colour, symbol = style.of_index(number)
        for row, (y, std, scale) in enumerate(
            (("frequency_hz", "frequency_std_hz", 1.0), ("damping", "damping_std", 100.0)), start=1
        ):
            values = scale * np.array([getattr(p, y) for p in own], dtype=float)
            errors = 2.0 * scale * np.array([getattr(p, std) for p in own], dtype=float)
            data.append(
                {
                    "type": "scatter", "mode": "markers", "name": text(own[0].name),
                    "legendgroup": own[0].name, "showlegend": row == 1, "yaxis": axis(row),
                    "x": column([p.dynamic_pressure_pa for p in own]), "y": column(values),
                    "error_y": {"type": "data", "array": column(errors), "thickness": 1},
                    "marker": {"color": colour, "symbol": symbol, "size": 7},
                    "text": [text(p.label) for p in own],
                    "customdata": [[p.run_id] for p in own],
                    "hovertemplate": "%{text}<br>%{x:.0f} Pa<br>%{y:.4g}<extra></extra>",
                }
            )  # fmt: skip
            line = lines.get(mode)
            if line is not None:
                at_rest, error = (
                    (line.frequency_hz, line.frequency_std_hz)
                    if row == 1
                    else (100.0 * line.damping, 100.0 * line.damping_std)
                )
                data.append(
                    {
                        "type": "scatter", "mode": "markers",
                        "name": f"{text(own[0].name)} in vacuo",
                        "legendgroup": own[0].name, "showlegend": False, "yaxis": axis(row),
                        "x": [0.0], "y": [at_rest],
                        "error_y": {"type": "data", "array": [2.0 * error], "thickness": 1},
                        "marker": {"color": colour, "symbol": f"{symbol}-open", "size": 10},
                        "hovertemplate": "in vacuo<br>%{y:.4g}<extra></extra>",
                    }
                )  # fmt: skip
    return {
        "data": data,
        "layout": {
            "xaxis": {
                **title("Dynamic pressure [Pa]"), "anchor": axis(2), "rangemode": "tozero",
            },
            layout_key(1): {**title("Equivalent frequency [Hz]"), "domain": top},
            layout_key(2): {**title("Equivalent damping [%]"), "domain": bottom},
            "showlegend": True,
            "hovermode": "closest",
            "meta": {"rows": 3, "note": "Open markers: in vacuo, extrapolated by linear fits."},
        },
    }  # fmt: skip
