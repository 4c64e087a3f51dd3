"""A designed excitation: what is commanded in time, and which lines are whose."""

from __future__ import annotations

import numpy as np

from flexsid.figures import quantities, style
from flexsid.figures.spec import Spec, axis, column, layout_key, rows, title
from flexsid.records.views import DesignedExcitation

_DEGREES = 180.0 / np.pi


def design_history(value: DesignedExcitation) -> Spec:
    """Draw one period of every input in its own row. [deg]"""
    count = len(value.names)
    layout: Spec = {
        "xaxis": {**title("Time [s]"), "anchor": axis(count)},
        "showlegend": False,
        "hovermode": "x",
        "meta": {"rows": count},
    }
    data: list[Spec] = []
    for number, (name, domain) in enumerate(
        zip(value.names, rows([1.0] * count), strict=True), start=1
    ):
        label = quantities.of_channel(name).label
        colour, _ = style.of_index(number - 1)
        layout[layout_key(number)] = {**title(f"{label} [deg]"), "domain": domain}
        data.append(
            {
                "type": "scatter",
                "mode": "lines",
                "name": label,
                "x": column(value.time_s, exact=True),
                "y": column(_DEGREES * value.command[:, number - 1]),
                "yaxis": axis(number),
                "line": {"color": colour, "width": 1},
                "meta": name,
                "hovertemplate": f"%{{y:.3f}} deg<extra>{label}</extra>",
            }
        )
    return {"data": data, "layout": layout}


def design_spectrum(value: DesignedExcitation) -> Spec:
    """Draw the amplitude of every line, coloured by the input that owns it. [deg]"""
    data: list[Spec] = []
    for number, name in enumerate(value.names):
        colour, symbol = style.of_index(number)
        label = quantities.of_channel(name).label
        data.append(
            {
                "type": "scatter",
                "mode": "markers",
                "name": label,
                "x": column(value.frequency_hz[name], exact=True),
                "y": column(_DEGREES * value.amplitude[name]),
                "marker": {"color": colour, "symbol": symbol, "size": 6},
                "error_y": {
                    "type": "data", "symmetric": False, "color": colour, "thickness": 1,
                    "width": 0, "array": [0.0] * value.amplitude[name].size,
                    "arrayminus": column(_DEGREES * value.amplitude[name]),
                },
                "hovertemplate": f"%{{x:.3f}} Hz<br>%{{y:.3f}} deg<extra>{label}</extra>",
            }
        )  # fmt: skip
    return {
        "data": data,
        "layout": {
            "xaxis": title("Frequency [Hz]"),
            "yaxis": {**title("Amplitude of a line [deg]"), "rangemode": "tozero"},
            "showlegend": True,
            "hovermode": "closest",
            "meta": {"rows": 2},
        },
    }
