"""Fourier transform magnitudes at the excited lines, coloured by their owner (Fig. 9b)."""

from __future__ import annotations

import numpy as np

from flexsid.figures import quantities, style
from flexsid.figures.spec import Spec, axis, column, empty, layout_key, rows, title
from flexsid.records.views import Spectra

_NOBODY = "no owner"


def spectrum(value: Spectra) -> Spec:
    """Draw one row per channel; each line wears the colour of the input that was given it."""
    if not value.names:
        return empty("No channel chosen")
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
        layout[layout_key(index + 1)] = {
            **title(quantity.title),
            "domain": domain,
            "rangemode": "tozero",
        }
        data += _row(value, index, quantity)
    return {"data": data, "layout": layout}


def _row(value: Spectra, index: int, quantity: quantities.Quantity) -> list[Spec]:
    styles = {**style.of_inputs(value.inputs), "": (style.GREY, "circle-open")}
    owners = np.array(value.owners)
    return [
        _lines(value, index, quantity, owner, owners == owner, styles[owner])
        for owner in styles
        if (owners == owner).any()
    ]


def _lines(
    value: Spectra,
    index: int,
    quantity: quantities.Quantity,
    owner: str,
    own: np.ndarray,
    look: tuple[str, str],
) -> Spec:
    colour, symbol = look
    height = value.magnitude[own, index] * quantity.factor
    name = quantities.of_channel(owner).label if owner else _NOBODY
    return {
        "type": "scatter",
        "mode": "markers",
        "name": name,
        "legendgroup": owner or _NOBODY,
        "showlegend": index == 0,
        "x": column(value.frequency_hz[own]),
        "y": column(height),
        "yaxis": axis(index + 1),
        "marker": {"color": colour, "symbol": symbol, "size": 4},
        # stems: a spectrum of lines, not a curve
        "error_y": {
            "type": "data", "symmetric": False, "array": [0.0] * len(height),
            "arrayminus": column(height), "color": colour, "thickness": 1, "width": 0,
        },
        "meta": {"channel": value.names[index], "owner": owner},
        "hovertemplate": f"%{{x:.3f}} Hz<br>%{{y:.4g}} {quantity.unit}<extra>{name}</extra>",
    }  # fmt: skip
