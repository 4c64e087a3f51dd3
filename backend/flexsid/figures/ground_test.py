"""Spectra on the runway before and after a flight, with expected modes (Fig. 10)."""

from __future__ import annotations

import numpy as np

from flexsid.figures import quantities, style
from flexsid.figures.spec import Spec, column, marked, plane, scatter, title, vertical_mark
from flexsid.records.views import GroundSpectra


def draw_ground_test(value: GroundSpectra) -> Spec:
    """Draw response power of all gauges and accelerometers over excitation power."""
    shown = quantities.of_unit("Frequency", "Hz")
    data = []
    for name, (frequency, power), colour, symbol in (
        ("before flight", value.before, style.BLUE, "circle"),
        ("after flight", value.after, style.VERMILION, "square"),
    ):
        with np.errstate(divide="ignore"):
            decibel = 10.0 * np.log10(power)
        data.append(
            scatter(
                column(shown.factor * frequency, exact=True),
                decibel,
                "lines+markers",
                name=name,
                line={"color": colour, "width": 1.2},
                marker={"color": colour, "symbol": symbol, "size": 4},
                hovertemplate=f"%{{x:.3f}} {shown.unit}<br>%{{y:.1f}} dB<extra>{name}</extra>",
            )
        )
    layout = plane(
        title(shown.axis_title),
        title("Response/excitation power,<br>all channels [dB]"),
        2,
        **marked(
            vertical_mark(shown.factor * m.frequency_hz, quantities.text(m.name))
            for m in value.expected
        ),
    )
    return {"data": data, "layout": layout}
