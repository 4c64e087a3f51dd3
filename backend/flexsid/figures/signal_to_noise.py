"""Signal-to-noise ratio by channel and harmonic."""

from __future__ import annotations

from flexsid.figures import quantities
from flexsid.figures.spec import Spec, empty, heatmap, title
from flexsid.records.quality import SignalToNoise

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
