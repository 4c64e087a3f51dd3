"""Measured open-loop responses in the complex plane (Nyquist plot)."""

from __future__ import annotations

import numpy as np

from flexsid.figures import quantities, style
from flexsid.figures.spec import Spec, column, title
from flexsid.records.views import LoopCurve, LoopPlot


def loops(value: LoopPlot) -> Spec:
    """Draw the Nyquist plot of every loop, with margins in the legend."""
    names = tuple(curve.surface for curve in value.curves)
    data: list[Spec] = [
        _curve(curve, *style.of_inputs(names)[curve.surface]) for curve in value.curves
    ]
    data.append(
        {
            "type": "scatter", "mode": "markers", "name": "−1", "x": [-1.0], "y": [0.0],
            "marker": {"color": style.FLAG, "symbol": "x", "size": 10},
            "hovertemplate": "critical point<extra></extra>",
        }
    )  # fmt: skip
    return {
        "data": data,
        "layout": {
            "xaxis": title("Re L [1]"),
            "yaxis": {**title("Im L [1]"), "scaleanchor": "x"},
            "showlegend": True,
            "hovermode": "closest",
            "meta": {"rows": 3},
        },
    }


def _curve(curve: LoopCurve, colour: str, symbol: str) -> Spec:
    label = quantities.of_channel(curve.surface).label
    return {
        "type": "scatter",
        "mode": "lines+markers",
        "name": f"{label}: {_margins(curve)}",
        "x": column(np.real(curve.gain)),
        "y": column(np.imag(curve.gain)),
        "line": {"color": colour, "width": 1},
        "marker": {"color": colour, "symbol": symbol, "size": 5},
        "error_x": _bars(curve.std, colour),
        "error_y": _bars(curve.std, colour),
        "customdata": [[hz] for hz in curve.frequency_hz.round(4).tolist()],
        "hovertemplate": (
            f"%{{customdata[0]:.3f}} Hz<br>%{{x:.3f}} + j %{{y:.3f}}<extra>{label}</extra>"
        ),
        "meta": curve.surface,
    }


def _margins(curve: LoopCurve) -> str:
    gain = "∞" if not np.isfinite(curve.gain_up) else f"{20.0 * np.log10(curve.gain_up):.1f} dB"
    phase = "∞"
    if np.isfinite(curve.phase_rad):
        phase = f"{np.degrees(curve.phase_rad):.0f} ± {2.0 * np.degrees(curve.phase_std_rad):.0f}°"
    return f"gain {gain}, phase {phase}, disk {curve.disk:.2f} ± {2.0 * curve.disk_std:.2f}"


def _bars(std: np.ndarray, colour: str) -> Spec:
    return {
        "type": "data", "array": column(np.sqrt(2.0) * std), "color": colour, "thickness": 1,
        "width": 0,
    }  # fmt: skip
