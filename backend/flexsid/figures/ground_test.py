"""Spectra on the runway before and after a flight, with expected modes (Fig. 10)."""

from __future__ import annotations

import numpy as np

from flexsid.figures import quantities, style
from flexsid.figures.spec import Spec, column, title, vertical_mark
from flexsid.records.views import GroundSpectra


def ground_test(value: GroundSpectra) -> Spec:
    """Draw response power of all gauges and accelerometers over excitation power."""
    marks = [
        vertical_mark(mode.frequency_hz, quantities.text(mode.name)) for mode in value.expected
    ]
    return {
        "data": [
            _curve("before flight", value.before, style.BLUE, "circle"),
            _curve("after flight", value.after, style.VERMILION, "square"),
        ],
        "layout": {
            "xaxis": title("Frequency [Hz]"),
            "yaxis": {**title("Response/excitation power,<br>all channels [dB]")},
            "showlegend": True,
            "hovermode": "closest",
            "shapes": [shape for shape, _ in marks],
            "annotations": [name for _, name in marks],
            "meta": {"rows": 2},
        },
    }


def _curve(name: str, spectrum: tuple[np.ndarray, np.ndarray], colour: str, symbol: str) -> Spec:
    frequency, power = spectrum
    with np.errstate(divide="ignore"):
        decibel = 10.0 * np.log10(power)
    return {
        "type": "scatter",
        "mode": "lines+markers",
        "name": name,
        "x": column(frequency, exact=True),
        "y": column(decibel),
        "line": {"color": colour, "width": 1.2},
        "marker": {"color": colour, "symbol": symbol, "size": 4},
        "hovertemplate": f"%{{x:.3f}} Hz<br>%{{y:.1f}} dB<extra>{name}</extra>",
    }
