"""Excitation: commands, spectra by input (Fig. 9b), information and signal-to-noise ratio."""

from __future__ import annotations

import numpy as np

from flexsid.figures import quantities, style
from flexsid.figures.spec import (
    Spec,
    band,
    column,
    empty,
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
from flexsid.records.quality import SignalToNoise
from flexsid.records.views import DesignedExcitation, ExpectedResponse, Spectra

# --- Excitation designs: command time history, amplitude spectrum, information, SNR ---------------


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
    layout = plane(_title_frequency(), y_axis, 2, **_mark_modes(value, data))
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
    layout: Spec = {
        "xaxis": _title_frequency(),
        **_mark_modes(value, [trace]),
        "yaxis": {"autorange": "reversed", "type": "category", "automargin": True},
        "meta": {"rows": max(2.0, len(labels) / 5)},
    }
    for mark, label in zip(layout["shapes"], layout["annotations"], strict=True):
        mark |= {"layer": "above", "line": {"color": style.MARK, "width": 1, "dash": "dot"}}
        label |= {"yanchor": "bottom", "yshift": -label["yshift"]}
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


def _mark_modes(value: ExpectedResponse, data: list[Spec]) -> Spec:
    """Mark the frequencies of identified modes."""
    factor = quantities.of_unit("Frequency", "Hz").factor
    marks = [vertical_mark(factor * mode.frequency_hz, mode.name) for mode in value.modes]
    return marked(marks, data)


def _title_frequency() -> Spec:
    return title(quantities.of_unit("Frequency", "Hz").axis_title)


# --- Fourier transform magnitudes at excited harmonics, coloured by assigned input (Fig. 9b) ------

_UNASSIGNED = "not assigned"


def draw_spectrum(value: Spectra) -> Spec:
    """Draw one row per channel, with harmonics coloured by assigned input."""
    if not value.names:
        return empty("No channel selected")
    scale = {"rangemode": "tozero"} if value.background is None else {"type": "log"}
    frequency = quantities.of_unit("Frequency", "Hz")
    axes, data = [], []
    for index, (name, unit) in enumerate(zip(value.names, value.units, strict=True)):
        quantity = quantities.transform(quantities.of_channel(name, unit))
        axes.append({**title(quantity.title), **scale})
        if value.background is not None and value.background_hz is not None:
            level = value.background[:, index] * quantity.factor
            seen = np.isfinite(level)
            data.append(
                _draw_curve(
                    value, index, "whole spectrum", frequency.factor * value.background_hz[seen],
                    level[seen],
                    {"color": style.GREY, "width": 1},
                    f"%{{x:.2f}} {frequency.unit}<br>%{{y:.3g}} {quantity.unit}<extra></extra>",
                )
            )  # fmt: skip
        data += _draw_lines(value, index, quantity)
        if value.noise is not None:
            data.append(
                _draw_curve(
                    value, index, "noise", frequency.factor * value.frequency_hz,
                    value.noise[:, index] * quantity.factor,
                    {"color": style.GREY, "width": 1.2, "dash": "dash"},
                    f"%{{x:.3f}} {frequency.unit}<br>%{{y:.3g}} {quantity.unit}"
                    "<extra>noise</extra>",
                )
            )  # fmt: skip
    layout = stack(title(frequency.axis_title), axes, showlegend=True, hovermode="closest")
    if value.background is not None and value.band_hz is not None:  # the modelled band (Fig. 12)
        low, high = (frequency.factor * end for end in value.band_hz)
        layout["shapes"] = [band(low, high, style.BLUE, opacity=0.08)]
    return {"data": data, "layout": layout}


def _draw_curve(
    value: Spectra, index: int, name: str, x: np.ndarray, y: np.ndarray, line: Spec, hover: str
) -> Spec:
    return scatter(
        x, y, "lines", row=index + 1, name=name, legendgroup=name, showlegend=index == 0,
        line=line, meta={"channel": value.names[index], "assigned_input": None},
        hovertemplate=hover,
    )  # fmt: skip


def _draw_lines(value: Spectra, index: int, quantity: quantities.DisplayQuantity) -> list[Spec]:
    """Draw the harmonics of each input in its style, as stems without a spectrum behind them."""
    frequency = quantities.of_unit("Frequency", "Hz")
    assigned_inputs = np.array(value.assigned_inputs)
    data = []
    for assigned, (colour, symbol) in {
        **style.of_inputs(value.inputs),
        "": (style.GREY, "circle-open"),
    }.items():
        own = assigned_inputs == assigned
        if not own.any():
            continue
        heights = value.magnitude[own, index] * quantity.factor
        name = quantities.of_channel(assigned).label if assigned else _UNASSIGNED
        trace = scatter(
            frequency.factor * value.frequency_hz[own],
            heights,
            row=index + 1,
            name=name,
            legendgroup=assigned or _UNASSIGNED,
            showlegend=index == 0,
            marker={"color": colour, "symbol": symbol, "size": 4},
            text=_format_signal_to_noise(value, own, index),
            meta={"channel": value.names[index], "assigned_input": assigned},
            hovertemplate=f"%{{x:.3f}} {frequency.unit}<br>%{{y:.4g}} {quantity.unit}<br>%{{text}}"
            f"<extra>{name}</extra>",
        )
        if value.background is None:
            trace["error_y"] = stems(heights, colour)
        data.append(trace)
    return data


def _format_signal_to_noise(value: Spectra, own: np.ndarray, index: int) -> list[str]:
    """Format the signal-to-noise ratio of every harmonic."""
    if value.noise is None:
        return []
    noise = np.where(value.noise[own, index] > 0, value.noise[own, index], np.nan)
    with np.errstate(divide="ignore"):
        decibel = 20.0 * np.log10(value.magnitude[own, index] / noise)
    return [f"SNR {level:.0f} dB" if np.isfinite(level) else "" for level in decibel]


# --- Signal-to-noise ratio by channel and harmonic ------------------------------------------------

_ROW_PX = 17


def draw_signal_to_noise(value: SignalToNoise) -> Spec:
    """Draw signal-to-noise ratios as a heat map."""
    if not value.names:
        return empty("No channel selected")
    frequency = quantities.of_unit("Frequency", "Hz")
    labels = [quantities.of_channel(name).label for name in value.names]
    trace = heatmap(
        frequency.factor * value.frequency_hz,
        labels,
        value.decibel.T,
        name="SNR",
        zmin=0.0,
        zmax=40.0,
        colorscale="Viridis",
        colorbar={**title("SNR [dB]"), "thickness": 12},
        hovertemplate=f"%{{y}} at %{{x:.3f}} {frequency.unit}: %{{z:.1f}} dB<extra></extra>",
    )
    layout = {
        "xaxis": title(frequency.axis_title),
        "yaxis": {"autorange": "reversed", "automargin": True, "tickfont": {"size": 10}},
        "height": 120 + _ROW_PX * len(labels),
        "meta": {"rows": 1},
    }
    return {"data": [trace], "layout": layout}
