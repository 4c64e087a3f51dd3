"""Correlation matrix of the parameter estimates."""

from __future__ import annotations

import numpy as np

from flexsid.figures import style
from flexsid.figures.labels import parameter_label
from flexsid.figures.spec import Spec, empty, heatmap, scatter, title
from flexsid.records.views import ParameterCorrelation

LIMIT = 0.9  # |rho| above which two parameters are nearly collinear
_NAMED = 120  # largest number of parameters with hover names


def draw_parameter_correlation(value: ParameterCorrelation, selected: str | None = None) -> Spec:
    """Draw the correlation matrix of the estimates, with pairs above ``LIMIT`` marked.

    Row and column of the ``selected`` derivative are framed.
    """
    if not value.names:
        return empty("No free parameters")
    labels = [parameter_label(name) for name in value.names]
    places = list(range(len(labels)))
    named = len(labels) <= _NAMED
    data = [
        heatmap(
            places,
            places,
            value.correlation,
            zmin=-1,
            zmax=1,
            colorscale="RdBu",
            colorbar=title("ρ [1]"),
            hovertemplate=("%{text}<br>" if named else "") + "ρ = %{z:.3f}<extra></extra>",
        )
    ]
    if named:
        data[0]["text"] = [[f"{a}, {b}" for b in labels] for a in labels]
    off_diagonal = np.where(np.eye(len(labels), dtype=bool), 0.0, value.correlation)
    pairs = np.argwhere(np.abs(np.nan_to_num(off_diagonal)) > LIMIT).tolist()
    if pairs:
        ring = {"color": style.MARK, "width": 2}
        data.append(
            scatter(
                [j for _, j in pairs],
                [i for i, _ in pairs],
                name=f"|ρ| > {LIMIT}",
                marker={"symbol": "x-thin", "size": 8, "line": ring},
                text=[
                    f"{labels[i]}, {labels[j]}<br>ρ = {value.correlation[i, j]:.3f}"
                    for i, j in pairs
                ],
                hovertemplate=f"%{{text}}<extra>|ρ| > {LIMIT}</extra>",
            )
        )
    ticks = {"tickmode": "array", "tickvals": places, "ticktext": labels, "automargin": True}
    layout = {
        "xaxis": {**ticks, "tickangle": -90, "constrain": "domain"},
        "yaxis": {**ticks, "autorange": "reversed", "scaleanchor": "x", "constrain": "domain"},
        "showlegend": False,
        "shapes": _frame(value.names, selected),
        "meta": {"rows": max(2.0, len(labels) / 8)},
    }
    return {"data": data, "layout": layout}


def _frame(names: tuple[str, ...], selected: str | None) -> list[Spec]:
    """Return frames around the row and the column of a derivative."""
    if selected not in names:
        return []
    at, last = names.index(selected), len(names) - 0.5
    line = {"color": style.OCHRE, "width": 2}
    spans = ((-0.5, last, at - 0.5, at + 0.5), (at - 0.5, at + 0.5, -0.5, last))
    return [
        {"type": "rect", "x0": x0, "x1": x1, "y0": y0, "y1": y1, "line": line}
        for x0, x1, y0, y1 in spans
    ]
