"""Forest plot: estimates of one derivative by source, with the weighted mean of the runs."""

from __future__ import annotations

import numpy as np

from flexsid.figures import style
from flexsid.figures.derivatives import select_styles
from flexsid.figures.labels import parameter_label, parameter_unit
from flexsid.figures.quantities import text
from flexsid.figures.spec import Spec, column, empty, title
from flexsid.records.comparison import Comparison

_N_SIGMA = 2.0


def forest(value: Comparison, name: str) -> Spec:
    """Draw one source per row with ±2 standard errors; the band is ±2σ of the runs' mean."""
    row = next((row for row in value.rows if row.name == name), None)
    if row is None:
        return empty(f"{text(name)} was not estimated")
    looks = select_styles(value.sources)
    shown = [(s, v) for s, v in zip(value.sources, row.values, strict=True) if v is not None]
    data: list[Spec] = []
    for source, value_of_source in shown:
        colour, symbol = looks[source.key]
        error = (
            np.nan if value_of_source.std_error is None else _N_SIGMA * value_of_source.std_error
        )
        data.append(
            {
                "type": "scatter",
                "mode": "markers",
                "name": text(source.label),
                "x": column([value_of_source.value], exact=True),
                "y": [text(source.label)],
                "marker": {"color": colour, "symbol": symbol, "size": 9},
                "error_x": {
                    "type": "data",
                    "array": column([error]),
                    "color": colour,
                    "thickness": 1.5,
                    "width": 4,
                },
                "customdata": [[source.run_id, source.prediction_id]],
                "hovertemplate": "%{x:.5g}<extra>" + text(source.label) + "</extra>",
            }
        )
    shapes: list[Spec] = []
    if row.mean is not None and row.mean_std_error is not None:
        low, high = (row.mean + sign * _N_SIGMA * row.mean_std_error for sign in (-1, 1))
        shared = {"xref": "x", "yref": "paper", "y0": 0, "y1": 1, "layer": "below"}
        shapes = [
            {**shared, "type": "rect", "x0": low, "x1": high, "fillcolor": style.GRID,
             "line": {"width": 0}},
            {**shared, "type": "line", "x0": row.mean, "x1": row.mean,
             "line": {"color": style.GREY, "width": 1.5, "dash": "dash"}},
        ]  # fmt: skip
    return {
        "data": data,
        "layout": {
            "xaxis": {**title(f"{parameter_label(name)} [{parameter_unit(name)}]")},
            "yaxis": {
                "type": "category",
                "autorange": "reversed",
                "automargin": True,
                "showgrid": False,
            },
            "shapes": shapes,
            "showlegend": False,
            "hovermode": "closest",
            "meta": {"rows": max(1.0, 0.12 * len(shown) + 0.4)},
        },
    }
