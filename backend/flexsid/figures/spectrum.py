"""Fourier transform magnitudes at excited harmonics, coloured by assigned input (Fig. 9b)."""

from __future__ import annotations

import numpy as np

from flexsid.figures import quantities, style
from flexsid.figures.spec import Spec, band, empty, scatter, stack, stems, title
from flexsid.records.views import Spectra

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
        data += _draw_harmonics(value, index, quantity)
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


def _draw_harmonics(value: Spectra, index: int, quantity: quantities.DisplayQuantity) -> list[Spec]:
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
