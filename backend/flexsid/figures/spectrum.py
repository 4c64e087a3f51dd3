"""Fourier transform magnitudes at excited harmonics, coloured by assigned input (Fig. 9b)."""

from __future__ import annotations

import numpy as np

from flexsid.figures import quantities, style
from flexsid.figures.spec import Spec, axis, column, empty, layout_key, rows, title
from flexsid.records.views import Spectra

_UNASSIGNED = "not assigned"


def spectrum(value: Spectra) -> Spec:
    """Draw one row per channel, with harmonics coloured by assigned input."""
    if not value.names:
        return empty("No channel selected")
    count = len(value.names)
    layout: Spec = {
        "xaxis": {**title("Frequency [Hz]"), "anchor": axis(count)},
        "showlegend": True,
        "hovermode": "closest",
        "meta": {"rows": count},
    }
    data = []
    for index, domain in enumerate(rows([1.0] * count)):
        name = value.names[index]
        quantity = quantities.transform(quantities.of_channel(name, value.units[index]))
        scale: Spec = {"rangemode": "tozero"} if value.background is None else {"type": "log"}
        layout[layout_key(index + 1)] = {**title(quantity.title), "domain": domain, **scale}
        data += _background(value, index, quantity)
        data += _row(value, index, quantity)
        data += _noise(value, index, quantity)
    if value.background is not None and value.band_hz is not None:
        layout["shapes"] = [_band(*value.band_hz)]
    return {"data": data, "layout": layout}


def _background(value: Spectra, index: int, quantity: quantities.DisplayQuantity) -> list[Spec]:
    """Draw the spectrum up to the Nyquist frequency behind the harmonics."""
    if value.background is None or value.background_hz is None:
        return []
    seen = np.isfinite(value.background[:, index])
    return [
        {
            "type": "scatter",
            "mode": "lines",
            "name": "whole spectrum",
            "legendgroup": "whole spectrum",
            "showlegend": index == 0,
            "x": column(value.background_hz[seen]),
            "y": column(value.background[seen, index] * quantity.factor),
            "yaxis": axis(index + 1),
            "line": {"color": style.GREY, "width": 1},
            "meta": {"channel": value.names[index], "assigned_input": None},
            "hovertemplate": f"%{{x:.2f}} Hz<br>%{{y:.3g}} {quantity.unit}<extra></extra>",
        }
    ]


def _noise(value: Spectra, index: int, quantity: quantities.DisplayQuantity) -> list[Spec]:
    if value.noise is None:
        return []
    return [
        {
            "type": "scatter",
            "mode": "lines",
            "name": "noise",
            "legendgroup": "noise",
            "showlegend": index == 0,
            "x": column(value.frequency_hz),
            "y": column(value.noise[:, index] * quantity.factor),
            "yaxis": axis(index + 1),
            "line": {"color": style.GREY, "width": 1.2, "dash": "dash"},
            "meta": {"channel": value.names[index], "assigned_input": None},
            "hovertemplate": f"%{{x:.3f}} Hz<br>%{{y:.3g}} {quantity.unit}<extra>noise</extra>",
        }
    ]


def _band(low_hz: float, high_hz: float) -> Spec:
    """Shade the modelled band (Fig. 12)."""
    return {
        "type": "rect", "xref": "x", "yref": "paper",
        "x0": low_hz, "x1": high_hz, "y0": 0, "y1": 1,
        "fillcolor": style.BLUE, "opacity": 0.08, "line": {"width": 0}, "layer": "below",
    }  # fmt: skip


def _signal_to_noise(value: Spectra, own: np.ndarray, index: int) -> list[str]:
    """Format the signal-to-noise ratio of every harmonic."""
    if value.noise is None:
        return []
    noise = value.noise[own, index]
    ratio = np.divide(
        value.magnitude[own, index], noise, out=np.full(noise.shape, np.nan), where=noise > 0
    )
    with np.errstate(divide="ignore"):
        decibel = 20.0 * np.log10(ratio)
    return [f"SNR {level:.0f} dB" if np.isfinite(level) else "" for level in decibel]


def _row(value: Spectra, index: int, quantity: quantities.DisplayQuantity) -> list[Spec]:
    styles = {**style.of_inputs(value.inputs), "": (style.GREY, "circle-open")}
    assigned_inputs = np.array(value.assigned_inputs)
    return [
        _draw_harmonics(
            value, index, quantity, assigned, assigned_inputs == assigned, styles[assigned]
        )
        for assigned in styles
        if (assigned_inputs == assigned).any()
    ]


def _draw_harmonics(
    value: Spectra,
    index: int,
    quantity: quantities.DisplayQuantity,
    assigned: str,
    own: np.ndarray,
    colour_symbol: tuple[str, str],
) -> Spec:
    colour, symbol = colour_symbol
    height = value.magnitude[own, index] * quantity.factor
    name = quantities.of_channel(assigned).label if assigned else _UNASSIGNED
    spec: Spec = {
        "type": "scatter",
        "mode": "markers",
        "name": name,
        "legendgroup": assigned or _UNASSIGNED,
        "showlegend": index == 0,
        "x": column(value.frequency_hz[own]),
        "y": column(height),
        "yaxis": axis(index + 1),
        "marker": {"color": colour, "symbol": symbol, "size": 4},
        "text": _signal_to_noise(value, own, index),
        "meta": {"channel": value.names[index], "assigned_input": assigned},
        "hovertemplate": (
            f"%{{x:.3f}} Hz<br>%{{y:.4g}} {quantity.unit}<br>%{{text}}<extra>{name}</extra>"
        ),
    }
    if value.background is None:
        # stems for a line spectrum
        spec["error_y"] = {
            "type": "data", "symmetric": False, "array": [0.0] * len(height),
            "arrayminus": column(height), "color": colour, "thickness": 1, "width": 0,
        }  # fmt: skip
    return spec
