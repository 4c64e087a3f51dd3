"""Fit of a grey-box model: amplitudes of its outputs, measured and modelled."""

from __future__ import annotations

import numpy as np

from flexsid.figures import style
from flexsid.figures.quantities import of_unit
from flexsid.figures.spec import Spec, column, scatter, stack, title
from flexsid.records.grey_box import GreyBoxFit


def draw_grey_box(value: GreyBoxFit) -> Spec:
    """Draw the amplitude of each output, or response, with the model and the residuals."""
    frequency = of_unit("Frequency", "Hz")
    data, axes = [], []
    for row, one in enumerate(value.responses, start=1):
        shown = column(frequency.factor * np.array(one.frequency_hz), exact=True)
        first = row == 1
        curves = (
            ("measured", one.measured, {"marker": {"color": style.MEASURED, "size": 4}}),
            ("model", one.modelled, {"line": {"color": style.BLUE, "width": 1.5}}),
            ("residual", one.residual, {"line": {"color": style.VERMILION, "width": 1.0}}),
        )
        for name, values, drawn in curves:
            mode = "markers" if "marker" in drawn else "lines"
            more = {"legendgroup": name, "showlegend": first, "hoverinfo": "skip", **drawn}
            data.append(scatter(shown, np.array(values), mode, row=row, name=name, **more))
        of = f"{one.output} / {one.input}" if one.input else one.output
        axes.append({**title(f"{of} [{one.unit}]"), "type": "log"})
    return {
        "data": data,
        "layout": stack(title(frequency.axis_title), axes, showlegend=True),
    }
