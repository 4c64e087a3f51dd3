"""Residuals by output and frequency, normalised by their rms."""

from __future__ import annotations

from flexsid.figures import quantities
from flexsid.figures.spec import Spec, empty, heatmap, title
from flexsid.records.views import Residuals

_CEILING = 3.0  # exceeded with probability 1e-4 by circular Gaussian noise


def draw_residual(value: Residuals) -> Spec:
    """Draw |residual|/rms: noise is uniform, an unmodelled mode is a bright band."""
    if value.relative.size == 0:
        return empty("No fitted data")
    frequency = quantities.of_unit("Frequency", "Hz")
    labels = [quantities.of_channel(name).label for name in value.outputs]
    trace = heatmap(
        frequency.factor * value.frequency_hz,
        labels,
        value.relative.T,
        zmin=0,
        zmax=_CEILING,
        colorscale="Cividis",
        colorbar=title("|residual| / rms [1]"),
        hovertemplate=f"%{{y}}<br>%{{x:.3f}} {frequency.unit}<br>%{{z:.2f}} rms<extra></extra>",
    )
    layout = {
        "xaxis": title(frequency.axis_title),
        "yaxis": {"autorange": "reversed", "type": "category", "automargin": True},
        "meta": {"rows": max(1.0, len(labels) / 5)},
    }
    return {"data": [trace], "layout": layout}
