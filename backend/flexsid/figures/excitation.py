"""Excitation designs: command time history, amplitude spectrum, information, SNR."""

from __future__ import annotations

import numpy as np

from flexsid.figures import quantities, style
from flexsid.figures.spec import Spec, axis, column, layout_key, rows, title, vertical_mark
from flexsid.records.views import DesignedExcitation, ExpectedResponse

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


def design_worth(value: ExpectedResponse) -> Spec:
    """Draw the information of every harmonic, coloured by input."""
    total = sum(float(np.sum(worth)) for worth in value.worth.values())
    data: list[Spec] = []
    for number, name in enumerate(value.names):
        colour, symbol = style.of_index(number)
        label = quantities.of_channel(name).label
        share = 100.0 * float(np.sum(value.worth[name])) / max(total, 1e-300)
        data.append(
            {
                "type": "scatter",
                "mode": "markers",
                "name": f"{label}: {share:.0f} % of total",
                "x": column(value.frequency_hz[name], exact=True),
                "y": column(value.worth[name]),
                "marker": {"color": colour, "symbol": symbol, "size": 6},
                "hovertemplate": f"%{{x:.3f}} Hz<br>%{{y:.3g}} parameters<extra>{label}</extra>",
            }
        )
    return {
        "data": data,
        "layout": _layout(value, inside=True)
        | {
            "yaxis": {**title("Information per harmonic [parameters]"), "rangemode": "tozero"},
            "showlegend": True,
            "hovermode": "closest",
        },
    }


def design_signal(value: ExpectedResponse) -> Spec:
    """Draw the signal-to-noise ratio of every output at every harmonic. [dB]"""
    frequency = np.concatenate([value.frequency_hz[name] for name in value.names])
    ratio = np.concatenate([value.signal_to_noise[name] for name in value.names])
    order = np.argsort(frequency, kind="stable")
    decibel = 20.0 * np.log10(np.maximum(ratio[order], 1e-6))
    labels = [quantities.of_channel(name).label for name in value.outputs]
    trace = {
        "type": "heatmap",
        "x": column(frequency[order], exact=True),
        "y": labels,
        "z": column(decibel.T),
        "zmin": -20.0,
        "zmax": 60.0,
        "colorscale": "Cividis",
        "colorbar": title("SNR [dB]"),
        "hovertemplate": "%{y}<br>%{x:.3f} Hz<br>%{z:.1f} dB<extra></extra>",
    }
    layout = _layout(value, inside=False)
    for mark in layout["shapes"]:
        mark |= {"layer": "above", "line": {"color": style.MARK, "width": 1, "dash": "dot"}}
    return {
        "data": [trace],
        "layout": layout
        | {
            "yaxis": {"autorange": "reversed", "type": "category", "automargin": True},
            "meta": {"rows": max(2.0, len(labels) / 5)},
        },
    }


def _layout(value: ExpectedResponse, *, inside: bool) -> Spec:
    """Lay out a frequency axis with markers of identified modes."""
    marks = [vertical_mark(mode.frequency_hz, mode.name) for mode in value.modes]
    for level, (_, annotation) in enumerate(marks):
        if inside:
            annotation["y"] = 1.0 - 0.06 * (level % 2)
        else:
            annotation["yanchor"] = "bottom"
    return {
        "xaxis": title("Frequency [Hz]"),
        "shapes": [shape for shape, _ in marks],
        "annotations": [annotation for _, annotation in marks],
        "meta": {"rows": 2},
    }


def design_spectrum(value: DesignedExcitation) -> Spec:
    """Draw the amplitude of every harmonic, coloured by input. [deg]"""
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
            "yaxis": {**title("Amplitude per harmonic [deg]"), "rangemode": "tozero"},
            "showlegend": True,
            "hovermode": "closest",
            "meta": {"rows": 2},
        },
    }
