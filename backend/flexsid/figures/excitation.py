"""Excitation designs: command time history, amplitude spectrum, information, SNR."""

from __future__ import annotations

import numpy as np

from flexsid.figures import quantities, style
from flexsid.figures.spec import (
    Spec,
    column,
    heatmap,
    marked,
    plane,
    scatter,
    stack,
    stems,
    time_axis,
    title,
    vertical_mark,
)
from flexsid.records.views import DesignedExcitation, ExpectedResponse


def draw_design_history(value: DesignedExcitation) -> Spec:
    """Draw one period of every input in its own row."""
    labels = [quantities.of_channel(name).label for name in value.names]
    units = [_show_unit(unit) for unit in value.units]
    data = [
        scatter(
            column(value.time_s, exact=True),
            units[number].factor * value.command[:, number],
            "lines",
            row=number + 1,
            name=label,
            line={"color": style.of_index(number)[0], "width": 1},
            meta=value.names[number],
            hovertemplate=f"%{{y:.3f}} {units[number].unit}<extra>{label}</extra>",
        )
        for number, label in enumerate(labels)
    ]
    axes = [title(f"{label} [{own.unit}]") for label, own in zip(labels, units, strict=True)]
    return {
        "data": data,
        "layout": stack(time_axis(), axes, showlegend=False, hovermode="x"),
    }


def draw_design_spectrum(value: DesignedExcitation) -> Spec:
    """Draw the amplitude of every harmonic, coloured by input."""
    surfaces = _show_unit("rad")
    data: list[Spec] = []
    for number, (name, unit) in enumerate(zip(value.names, value.units, strict=True)):
        shown = _show_unit(unit)
        label = quantities.of_channel(name).label
        if shown != surfaces:  # not that of the axis
            label += f" [{shown.unit}]"
        amplitude = shown.factor * value.amplitude[name]
        trace = _draw_harmonics(
            number,
            value.frequency_hz[name],
            amplitude,
            label,
            f"%{{y:.3f}} {shown.unit}<extra>{label}",
        )
        trace["error_y"] = stems(amplitude, style.of_index(number)[0])
        data.append(trace)
    y_axis = {**title(surfaces.axis_title), "rangemode": "tozero"}
    return {"data": data, "layout": plane(_title_frequency(), y_axis, 2)}


def draw_design_information(value: ExpectedResponse) -> Spec:
    """Draw the information of every harmonic, coloured by input."""
    total = sum(float(np.sum(one)) for one in value.information.values())
    data: list[Spec] = []
    for number, name in enumerate(value.names):
        label = quantities.of_channel(name).label
        share = 100.0 * float(np.sum(value.information[name])) / max(total, 1e-300)
        data.append(
            _draw_harmonics(
                number, value.frequency_hz[name], value.information[name],
                f"{label}: {share:.0f} % of total", f"%{{y:.3g}} parameters<extra>{label}",
            )
        )  # fmt: skip
    y_axis = {**title("Information per harmonic [parameters]"), "rangemode": "tozero"}
    layout = plane(_title_frequency(), y_axis, 2, **_mark_modes(value))
    for level, label in enumerate(layout["annotations"]):
        label["y"] = 1.0 - 0.06 * (level % 2)
    return {"data": data, "layout": layout}


def draw_design_signal(value: ExpectedResponse) -> Spec:
    """Draw the signal-to-noise ratio of every output at every harmonic. [dB]"""
    hertz = quantities.of_unit("Frequency", "Hz")
    frequency = np.concatenate([value.frequency_hz[name] for name in value.names])
    ratio = np.concatenate([value.signal_to_noise[name] for name in value.names])
    order = np.argsort(frequency, kind="stable")
    labels = [quantities.of_channel(name).label for name in value.outputs]
    trace = heatmap(
        column(hertz.factor * frequency[order], exact=True),
        labels,
        20.0 * np.log10(np.maximum(ratio[order], 1e-6)).T,
        zmin=-20.0,
        zmax=60.0,
        colorscale="Cividis",
        colorbar=title("SNR [dB]"),
        hovertemplate=f"%{{y}}<br>%{{x:.3f}} {hertz.unit}<br>%{{z:.1f}} dB<extra></extra>",
    )
    layout = {
        "xaxis": _title_frequency(),
        **_mark_modes(value),
        "yaxis": {"autorange": "reversed", "type": "category", "automargin": True},
        "meta": {"rows": max(2.0, len(labels) / 5)},
    }
    for mark, label in zip(layout["shapes"], layout["annotations"], strict=True):
        mark |= {"layer": "above", "line": {"color": style.MARK, "width": 1, "dash": "dot"}}
        label["yanchor"] = "bottom"
    return {"data": [trace], "layout": layout}


def _show_unit(unit: str) -> quantities.DisplayQuantity:
    """Return the display quantity of an input: a deflection, or percent of the full range."""
    name = "Amplitude per harmonic"
    if unit == "1":
        return quantities.DisplayQuantity(name, "%", 100.0)
    return quantities.of_unit(name, unit)


def _draw_harmonics(
    number: int, frequency_hz: np.ndarray, values: np.ndarray, name: str, hover: str
) -> Spec:
    colour, symbol = style.of_index(number)
    frequency = quantities.of_unit("Frequency", "Hz")
    return scatter(
        column(frequency.factor * frequency_hz, exact=True),
        values,
        name=name,
        marker={"color": colour, "symbol": symbol, "size": 6},
        hovertemplate=f"%{{x:.3f}} {frequency.unit}<br>{hover}</extra>",
    )


def _mark_modes(value: ExpectedResponse) -> Spec:
    """Mark the frequencies of identified modes."""
    frequency = quantities.of_unit("Frequency", "Hz")
    return marked(
        vertical_mark(frequency.factor * mode.frequency_hz, mode.name) for mode in value.modes
    )


def _title_frequency() -> Spec:
    return title(quantities.of_unit("Frequency", "Hz").axis_title)
