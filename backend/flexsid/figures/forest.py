"""Forest plot: estimates of one derivative by source, with the weighted mean of the runs."""

from __future__ import annotations

from flexsid.figures import style
from flexsid.figures.derivatives import select_styles
from flexsid.figures.labels import format_axis_title
from flexsid.figures.quantities import text
from flexsid.figures.spec import (
    N_SIGMA,
    Spec,
    band,
    column,
    empty,
    error_bars,
    line_at,
    plane,
    scatter,
    title,
)
from flexsid.records.comparison import Comparison


def draw_forest(value: Comparison, name: str) -> Spec:
    """Draw one source per row with ±2 standard errors; the band is ±2σ of the runs' mean."""
    row = next((row for row in value.rows if row.name == name), None)
    if row is None:
        return empty(f"{text(name)} was not estimated")
    looks = select_styles(value.sources)
    data: list[Spec] = []
    for source, estimate in zip(value.sources, row.values, strict=True):
        if estimate is None:
            continue
        colour, symbol = looks[source.key]
        label = text(source.label)
        data.append(
            scatter(
                column([estimate.value], exact=True),
                [label],
                name=label,
                marker={"color": colour, "symbol": symbol, "size": 9},
                error_x=error_bars([estimate.std_error], colour, thickness=1.5, width=4),
                customdata=[[source.run_id, source.prediction_id]],
                hovertemplate="%{x:.5g}<extra>" + label + "</extra>",
            )
        )
    shapes: list[Spec] = []
    if row.mean is not None and row.mean_std_error is not None:
        spread = N_SIGMA * row.mean_std_error
        shapes = [
            band(row.mean - spread, row.mean + spread, style.GRID),
            line_at(row.mean, line={"color": style.GREY, "width": 1.5, "dash": "dash"}),
        ]
    layout = plane(
        title(format_axis_title(name)),
        {"type": "category", "autorange": "reversed", "automargin": True, "showgrid": False},
        max(1.0, 0.12 * len(data) + 0.4),
        shapes=shapes,
        showlegend=False,
    )
    return {"data": data, "layout": layout}
