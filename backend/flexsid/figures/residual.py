"""What the model left over, per output and frequency, against its own noise level."""

from __future__ import annotations

from flexsid.figures import quantities
from flexsid.figures.spec import Spec, column, empty, title
from flexsid.records.views import Residuals

_CEILING = 3.0  # 1e-4 of circular Gaussian noise lies above: what is there is not noise


def residual(value: Residuals) -> Spec:
    """Draw |residual| over rms: noise is an even speckle, a missing mode a bright band."""
    if value.relative.size == 0:
        return empty("Nothing was fitted")
    labels = [quantities.of_channel(name).label for name in value.outputs]
    trace = {
        "type": "heatmap",
        "x": column(value.frequency_hz),
        "y": labels,
        "z": column(value.relative.T),
        "zmin": 0,
        "zmax": _CEILING,
        "colorscale": "Cividis",
        "colorbar": title("|residual| / rms [1]"),
        "hovertemplate": "%{y}<br>%{x:.3f} Hz<br>%{z:.2f} of rms<extra></extra>",
    }
    layout: Spec = {
        "xaxis": title("Frequency [Hz]"),
        "yaxis": {"autorange": "reversed", "type": "category", "automargin": True},
        "meta": {"rows": max(1.0, len(labels) / 5)},
    }
    return {"data": [trace], "layout": layout}
