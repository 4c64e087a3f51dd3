"""Heat map of the relative standard errors of derivatives over the envelope of a campaign."""

from __future__ import annotations

import numpy as np

from flexsid.figures import style
from flexsid.figures.labels import parameter_label
from flexsid.figures.quantities import of_unit
from flexsid.figures.spec import Spec, empty, heatmap, scatter, title
from flexsid.records.dashboard import (
    ACCURATE,
    INSENSITIVE,
    CellEstimate,
    DerivativeCoverage,
    EnvelopeCell,
    EstimateStatus,
)

_LARGEST = 2.0 * ACCURATE
"""Relative standard error at the end of the colour scale: the guideline is in its middle."""

_ROW = 1 / 6  # of a row of panels, for one derivative
_LETTER_PX, _BESIDE_LABEL_PX = 7, 40  # of tick labels; the title of the axis and gaps
_COLUMN_PX, _COLOUR_BAR_PX = 16, 130  # least width of a cell, whose label stands upright
_MARK: Spec = {"color": "#fff", "line": {"color": "#000", "width": 1}}
"""White with a black outline: visible on every colour of the scale."""


def draw_derivative_coverage(value: DerivativeCoverage, coefficient: str | None = None) -> Spec:
    """Draw derivatives against cells of the envelope, in order of airspeed and fuel.

    The colour is the relative standard error; cells without estimate are empty and marked by a
    dash, suspect runs by a cross, insensitive derivatives by a circle, approved runs by a star.
    """
    names = [
        name for name in value.names if coefficient is None or name.partition("_")[0] == coefficient
    ]
    if not names:
        return empty("No derivative is estimated")
    row = {name: number for number, name in enumerate(names)}
    shown = [one for one in value.estimates if one.name in row]
    shape = len(names), len(value.cells)
    percent = np.full(shape, np.nan)
    texts = [["not estimated"] * shape[1] for _ in names]
    runs: list[list[int | None]] = [[None] * shape[1] for _ in names]
    for one in shown:
        place = row[one.name], one.cell
        percent[place] = np.nan if one.relative_error is None else 100.0 * one.relative_error
        texts[place[0]][place[1]] = _describe(one)
        runs[place[0]][place[1]] = one.run_id
    conditions = [_name_cell(cell) for cell in value.cells]
    data = [
        heatmap(
            list(range(shape[1])),
            list(range(shape[0])),
            percent,
            zmin=0,
            zmax=100.0 * _LARGEST,
            colorscale="Viridis",
            reversescale=True,
            xgap=1,
            ygap=1,
            colorbar={"title": {"text": "σ / |estimate| [%]", "side": "right"}},
            text=[
                [
                    f"{parameter_label(name)}, {condition}<br>{text}"
                    for condition, text in zip(conditions, line, strict=True)
                ]
                for name, line in zip(names, texts, strict=True)
            ],
            customdata=runs,
            hovertemplate="%{text}<extra></extra>",
            hoverongaps=True,
        ),
        *_mark(shown, row),
        _mark_missing(runs),
    ]
    ticks = {"tickmode": "array", "showgrid": False}
    cells = [_format_cell(cell) for cell in value.cells]
    speed = of_unit("V", "m/s")
    left = _BESIDE_LABEL_PX + _LETTER_PX * max(map(len, names))
    layout = {
        "xaxis": {
            **title(f"True airspeed [{speed.unit}], fuel [%]"),
            **ticks,
            "tickvals": list(range(shape[1])),
            "ticktext": cells,
            "tickangle": -90,
            "range": [-0.5, shape[1] - 0.5],
        },
        "yaxis": {
            **ticks,
            "tickvals": list(range(shape[0])),
            "ticktext": [parameter_label(name) for name in names],
            "range": [shape[0] - 0.5, -0.5],
        },
        # Labels that need more room than they have are drawn twice.
        "margin": {
            "l": left,
            "b": _BESIDE_LABEL_PX + _LETTER_PX * max(map(len, cells), default=0),
        },
        "showlegend": True,
        "hovermode": "closest",
        "meta": {
            "rows": max(2.0, _ROW * len(names)),
            "least_width": left + _COLUMN_PX * shape[1] + _COLOUR_BAR_PX,
            "note": _describe_cells(value),
        },
    }
    return {"data": [trace for trace in data if len(trace["x"]) > 0], "layout": layout}


def _mark(shown: list[CellEstimate], row: dict[str, int]) -> list[Spec]:
    """Mark approved, suspect and insensitive estimates, and those without standard error."""
    marks = (
        ("insensitive", "circle-open", 13, [one for one in shown if one.is_insensitive]),
        ("suspect", "x", 8, [one for one in shown if one.status is EstimateStatus.SUSPECT]),
        ("approved", "star", 8, [one for one in shown if one.status is EstimateStatus.APPROVED]),
        (
            *("no standard error", "diamond", 8),
            [one for one in shown if one.relative_error is None],
        ),
    )
    return [
        scatter(
            [one.cell for one in marked],
            [row[one.name] for one in marked],
            name=name,
            marker={**_MARK, "symbol": symbol, "size": size}
            if symbol != "circle-open"
            else {"color": style.VERMILION, "symbol": symbol, "size": size, "line": {"width": 2}},
            customdata=[one.run_id for one in marked],
            hoverinfo="skip",
        )
        for name, symbol, size, marked in marks
    ]


def _mark_missing(runs: list[list[int | None]]) -> Spec:
    missing = [
        (number, place)
        for number, line in enumerate(runs)
        for place, run in enumerate(line)
        if run is None
    ]
    return scatter(
        [place for _, place in missing],
        [number for number, _ in missing],
        name="not estimated",
        marker={"symbol": "line-ew", "size": 7, "line": {"color": style.GREY, "width": 2}},
        hoverinfo="skip",
    )


def _describe(one: CellEstimate) -> str:
    error = "no standard error"
    if one.relative_error is not None:
        error = f"σ {one.relative_error:.1%} of the estimate"
    insensitive = f"<br>insensitivity above {INSENSITIVE:.0%}" if one.is_insensitive else ""
    return f"{error}{insensitive}<br>run {one.run_id}, {one.status.value}"


def _name_cell(cell: EnvelopeCell) -> str:
    speed = of_unit("V", "m/s")
    return f"{speed.format(cell.airspeed_m_s)}, fuel {cell.fuel_fraction:.0%}"


def _format_cell(cell: EnvelopeCell) -> str:
    return f"{of_unit('V', 'm/s').factor * cell.airspeed_m_s:.3g}, {100 * cell.fuel_fraction:.0f}"


def _describe_cells(value: DerivativeCoverage) -> str:
    speed = of_unit("V", "m/s")
    return (
        f"Cells of ±{0.5 * speed.factor * value.airspeed_width_m_s:.3g} {speed.unit} and "
        f"±{50 * value.fuel_width:.3g} % fuel; standard errors within {ACCURATE:.0%} are accurate, "
        f"insensitivity above {INSENSITIVE:.0%} is marked"
    )
