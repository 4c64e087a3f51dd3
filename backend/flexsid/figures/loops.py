"""Measured open-loop responses in the complex plane (Nyquist plot)."""

from __future__ import annotations

import numpy as np

from flexsid.figures import quantities, style
from flexsid.figures.spec import Spec, error_bars, plane, scatter, title
from flexsid.records.views import LoopCurve, LoopPlot


def draw_loops(value: LoopPlot) -> Spec:
    """Draw the Nyquist plot of every loop, with margins in the legend."""
    frequency = quantities.of_unit("Frequency", "Hz")
    data = []
    for number, curve in enumerate(value.curves):
        colour, symbol = style.of_index(number)
        label = quantities.of_channel(curve.surface).label
        # The error of a complex number is circular, so each part has half of its variance.
        bars = error_bars(curve.std, colour, np.sqrt(2.0), thickness=1, width=0)
        data.append(
            scatter(
                np.real(curve.gain),
                np.imag(curve.gain),
                "lines+markers",
                name=f"{label}: {_format_margins(curve)}",
                line={"color": colour, "width": 1},
                marker={"color": colour, "symbol": symbol, "size": 5},
                error_x=bars,
                error_y=bars,
                customdata=[[f] for f in (frequency.factor * curve.frequency_hz).round(4).tolist()],
                hovertemplate=f"%{{customdata[0]:.3f}} {frequency.unit}<br>"
                f"%{{x:.3f}} + j %{{y:.3f}}<extra>{label}</extra>",
                meta=curve.surface,
            )
        )
    data.append(
        scatter(
            [-1.0], [0.0], name="−1", marker={"color": style.FLAG, "symbol": "x", "size": 10},
            hovertemplate="critical point<extra></extra>",
        )
    )  # fmt: skip
    layout = plane(title("Re L [1]"), {**title("Im L [1]"), "scaleanchor": "x"}, 3)
    return {"data": data, "layout": layout}


def _format_margins(curve: LoopCurve) -> str:
    gain = "∞" if not np.isfinite(curve.gain_up) else f"{20.0 * np.log10(curve.gain_up):.1f} dB"
    phase = "∞"
    if np.isfinite(curve.phase_rad):
        phase = f"{np.degrees(curve.phase_rad):.0f} ± {2.0 * np.degrees(curve.phase_std_rad):.0f}°"
    return f"gain {gain}, phase {phase}, disk {curve.disk:.2f} ± {2.0 * curve.disk_std:.2f}"
