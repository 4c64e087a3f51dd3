"""Correlation matrix of the parameter estimates."""

from __future__ import annotations

import numpy as np

from flexsid.figures import style
from flexsid.figures.labels import parameter_label
from flexsid.figures.spec import Spec, column, empty, title
from flexsid.records.views import ParameterCorrelation

LIMIT = 0.9  # |rho| above which two parameters are nearly collinear
_NAMED = 120  # largest number of parameters with hover names


def parameter_correlation(value: ParameterCorrelation) -> Spec:
    """Draw the correlation matrix of the estimates, with pairs above 0.9 marked."""
    if not value.names:
        return empty("No free parameters")
    labels = [parameter_label(name) for name in value.names]
    places = list(range(len(labels)))
    ticks = {"tickmode": "array", "tickvals": places, "ticktext": labels, "automargin": True}
    layout: Spec = {
        "xaxis": {**ticks, "tickangle": -90, "constrain": "domain"},
        "yaxis": {**ticks, "autorange": "reversed", "scaleanchor": "x", "constrain": "domain"},
        "showlegend": False,
        "meta": {"rows": max(2.0, len(labels) / 8)},
    }
    named = len(labels) <= _NAMED
    heatmap: Spec = {
        "type": "heatmap",
        "x": places,
        "y": places,
        "z": column(value.correlation),
        "zmin": -1,
        "zmax": 1,
        "colorscale": "RdBu",
        "colorbar": title("ρ [1]"),
        "hovertemplate": ("%{text}<br>" if named else "") + "ρ = %{z:.3f}<extra></extra>",
    }
    if named:
        heatmap["text"] = [[f"{a}, {b}" for b in labels] for a in labels]
    marked = _marked(value.correlation, labels)
    return {"data": [heatmap, marked] if marked["x"] else [heatmap], "layout": layout}


def _marked(correlation: np.ndarray, labels: list[str]) -> Spec:
    off_diagonal = np.where(np.eye(len(labels), dtype=bool), 0.0, correlation)
    rows, columns = np.nonzero(np.abs(np.nan_to_num(off_diagonal)) > LIMIT)
    return {
        "type": "scatter",
        "mode": "markers",
        "name": f"|ρ| > {LIMIT}",
        "x": columns.tolist(),
        "y": rows.tolist(),
        "marker": {"symbol": "x-thin", "size": 8, "line": {"color": style.MARK, "width": 2}},
        "text": [
            f"{labels[row]}, {labels[column]}<br>ρ = {correlation[row, column]:.3f}"
            for row, column in zip(rows, columns, strict=True)
        ],
        "hovertemplate": "%{text}<extra>|ρ| > 0.9</extra>",
    }
