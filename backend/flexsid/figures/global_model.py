"""Flight envelope of a campaign and of its global model: runs, slices, coverage by derivatives."""

from __future__ import annotations

from itertools import groupby

import numpy as np

from flexsid.figures import style
from flexsid.figures.quantities import of_unit, text
from flexsid.figures.spec import (
    N_SIGMA,
    Spec,
    column,
    empty,
    error_bars,
    heatmap,
    line_at,
    plane,
    scatter,
    text_at,
    title,
)
from flexsid.figures.style import format_axis_title, parameter_label
from flexsid.nomenclature import Symbol, describe
from flexsid.records.decision import LimitedQuantity
from flexsid.records.global_model import DerivativeSlice, EnvelopeCoverage
from flexsid.records.run import sort_methods
from flexsid.records.search import (
    ACCURATE,
    INSENSITIVE,
    CellEstimate,
    DerivativeCoverage,
    EnvelopeCell,
    EstimateStatus,
)
from flexsid.records.views import Envelope, EnvelopeMark

# --- Slices of the global aerodynamic model with their runs, and its coverage of the envelope -----

_SYMBOLS = {
    LimitedQuantity.DYNAMIC_PRESSURE: "dynamic_pressure",
    LimitedQuantity.FUEL: "fuel_fraction",
    LimitedQuantity.AIRSPEED: "airspeed",
    LimitedQuantity.AIRSPEED_RATIO: "airspeed_ratio",
    LimitedQuantity.ALPHA: "alpha",
}
_OUTLYING = "outlying"


def draw_slice(value: DerivativeSlice) -> Spec:
    """Draw a derivative along one variable with ±2σ, its runs, and the prediction."""
    symbol = describe(_SYMBOLS[value.along])
    x = value.x * symbol.display_factor
    inside = np.where(value.is_extrapolated, np.nan, value.values)
    data = [
        *_draw_band(x, value.values, value.scatter_std, "14", "±2σ of a further run"),
        *_draw_band(x, value.values, value.std_errors, "33", "±2σ of the model"),
        scatter(
            x,
            value.values,
            "lines",
            name="extrapolated",
            line={"color": style.GREY, "dash": "dot"},
            hoverinfo="skip",
        ),
        scatter(
            x,
            inside,
            "lines",
            name="global model",
            line={"color": style.TEAL},
            hovertemplate="%{y:.5g}<extra>global model</extra>",
        ),
    ]
    if value.predicted is not None:
        data.append(
            scatter(
                x,
                value.predicted,
                "lines",
                name=value.prediction_source,
                line={"color": style.PREDICTIONS[0][0], "dash": "dash", "width": 1},
                hovertemplate=f"%{{y:.5g}}<extra>{value.prediction_source}</extra>",
            )
        )
    kinds = (*sort_methods(p.kind for p in value.points), _OUTLYING)
    data += [_draw_points(value, kind, symbol) for kind in kinds]
    layout = plane(
        {**title(symbol.axis_title), "zeroline": False}, title(format_axis_title(value.name)), 1.5
    )
    layout["meta"] = {"note": _describe_condition(value)}
    return {"data": [trace for trace in data if len(trace["x"]) > 0], "layout": layout}


def draw_coverage(value: EnvelopeCoverage) -> Spec:
    """Draw the standard error over the envelope relative to its smallest, with the runs."""
    if len(value.variables) < 2:
        return empty("The coverage is drawn over two variables")
    across, up = (describe(_SYMBOLS[quantity]) for quantity in value.variables[:2])
    data = [
        heatmap(
            value.x * across.display_factor,
            value.y * up.display_factor,
            value.ratio,
            colorscale="Viridis",
            reversescale=True,
            colorbar={"title": {"text": "σ / smallest σ", "side": "right"}},
            hovertemplate="σ %{z:.2f} times the smallest<extra></extra>",
        )
    ]
    for is_outlying, name, colour, mark in (
        (False, "runs", style.MARK, "circle"),
        (True, _OUTLYING, style.FLAG, "x"),
    ):
        own = [run for run in value.runs if run.is_outlying is is_outlying]
        if own:
            data.append(
                scatter(
                    [run.condition[0] * across.display_factor for run in own],
                    [run.condition[1] * up.display_factor for run in own],
                    name=name,
                    marker={
                        "color": colour,
                        "symbol": mark,
                        "size": 8,
                        "line": {"color": "#000", "width": 1},
                    },
                    customdata=[[run.run_id, run.maneuver_id] for run in own],
                    text=[f"{run.method} {run.run_id}, {run.label}" for run in own],
                    hovertemplate="%{text}<extra></extra>",
                )
            )
    if value.next_condition is not None:
        first, second = value.next_condition.condition[:2]
        data.append(
            scatter(
                [first * across.display_factor],
                [second * up.display_factor],
                name="next condition",
                marker={
                    "color": style.VERMILION,
                    "symbol": "star",
                    "size": 15,
                    "line": {"color": "#000", "width": 1},
                },
                hovertemplate="largest reduction of the variance<extra></extra>",
            )
        )
    layout = plane(
        {**title(across.axis_title), "zeroline": False},
        {**title(up.axis_title), "zeroline": False},
        1.5,
    )
    return {"data": data, "layout": layout}


def _draw_band(
    x: np.ndarray, values: np.ndarray, std: np.ndarray, opacity: str, name: str
) -> list[Spec]:
    edge: Spec = {
        "line": {"width": 0, "color": style.TEAL},
        "hoverinfo": "skip",
        "legendgroup": name,
    }
    low, high = values - N_SIGMA * std, values + N_SIGMA * std
    fill: Spec = {"fill": "tonexty", "fillcolor": f"{style.TEAL}{opacity}", "name": name}
    return [
        scatter(x, low, "lines", showlegend=False, **edge),
        scatter(x, high, "lines", **edge, **fill),
    ]


def _draw_points(value: DerivativeSlice, kind: str, symbol: Symbol) -> Spec:
    own = [p for p in value.points if (_OUTLYING if p.is_outlying else p.kind) == kind]
    colour, mark = (style.FLAG, "x") if kind == _OUTLYING else style.of_method(kind)
    return scatter(
        column(np.array([p.x for p in own]) * symbol.display_factor, exact=True),
        column([p.value for p in own], exact=True),
        name=kind,
        legendgroup=kind,
        marker={"color": colour, "symbol": mark, "size": 7},
        error_y=error_bars([p.std_error for p in own], colour, thickness=1, width=2),
        customdata=[[p.run_id, p.maneuver_id] for p in own],
        text=[p.label for p in own],
        hovertemplate="%{text}<br>%{y:.5g}<extra></extra>",
    )


def _describe_condition(value: DerivativeSlice) -> str:
    others = [
        f"{symbol.label} = {number * symbol.display_factor:.4g} {symbol.display_unit.strip('1')}"
        for quantity, number in zip(value.variables, value.condition, strict=True)
        if quantity is not value.along and (symbol := describe(_SYMBOLS[quantity]))
    ]
    at = f"At {', '.join(others)}; estimates" if others else "Estimates"
    return f"{at} moved along the model to this condition"


# --- Flight envelope: airspeed against fuel fraction, one marker per maneuver ---------------------


def draw_envelope(value: Envelope) -> Spec:
    """Draw the flown conditions over fuel fraction.

    The axis is V/V_f where every maneuver has it, with the predicted flutter boundary at 1;
    else true airspeed.
    """
    if not value.marks:
        return empty("No matching maneuvers")
    as_ratio = all(mark.airspeed_ratio is not None for mark in value.marks)
    by_fta = sorted(
        value.marks, key=lambda mark: (-1 if mark.fta is None else mark.fta, mark.maneuver_id)
    )
    speed = describe("airspeed")
    data = []
    for fta, group in groupby(by_fta, key=lambda mark: mark.fta):
        marks = tuple(group)
        colour, symbol = style.of_fta(fta)
        data.append(
            scatter(
                [mark.fuel_fraction for mark in marks],
                [
                    mark.airspeed_ratio if as_ratio else speed.display_factor * mark.airspeed_m_s
                    for mark in marks
                ],
                name="no FTA" if fta is None else f"FTA {fta}",
                marker={"color": colour, "symbol": symbol, "size": 10},
                customdata=[mark.maneuver_id for mark in marks],
                text=[_describe(mark) for mark in marks],
                hovertemplate="%{text}<extra></extra>",
            )
        )
    layout = plane(
        {**title("Fuel fraction"), "range": [-0.05, 1.05]},
        title("V/V<sub>f</sub>" if as_ratio else f"True airspeed {speed.axis_title}"),
        1,
    )
    if as_ratio:
        font = {"color": style.FLAG}
        layout["shapes"] = [line_at(1, "y")]
        layout["annotations"] = [
            text_at(1, 1, "predicted flutter", "right", "bottom", font, yref="y")
        ]
    return {"data": data, "layout": layout}


def _describe(mark: EnvelopeMark) -> str:
    ratio = "" if mark.airspeed_ratio is None else f"V/V<sub>f</sub> {mark.airspeed_ratio:.2f}, "
    speed, pressure = of_unit("V", "m/s"), of_unit("dynamic pressure", "Pa")
    return (
        f"<b>{text(mark.label)}</b><br>{ratio}{speed.format(mark.airspeed_m_s)}<br>"
        f"{pressure.format(mark.dynamic_pressure_pa)}<br>"
        f"fuel fraction {mark.fuel_fraction:.2f}"
    )


# --- Heat map of the relative standard errors of derivatives over the envelope of a campaign ------

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
        texts[place[0]][place[1]] = _describe_cell(one)
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
    left = _BESIDE_LABEL_PX + _LETTER_PX * max(map(len, names))
    layout = {
        "xaxis": {
            **title("True airspeed, fuel"),
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


def _describe_cell(one: CellEstimate) -> str:
    error = "no standard error"
    if one.relative_error is not None:
        error = f"σ {one.relative_error:.1%} of the estimate"
    insensitive = f"<br>insensitivity above {INSENSITIVE:.0%}" if one.is_insensitive else ""
    return f"{error}{insensitive}<br>run {one.run_id}, {one.status.value}"


def _name_cell(cell: EnvelopeCell) -> str:
    speed = of_unit("V", "m/s")
    return f"{speed.format(cell.airspeed_m_s)}, fuel {cell.fuel_fraction:.0%}"


def _format_cell(cell: EnvelopeCell) -> str:
    speed = of_unit("V", "m/s")
    return f"{speed.factor * cell.airspeed_m_s:.3g} {speed.unit}, {100 * cell.fuel_fraction:.0f} %"


def _describe_cells(value: DerivativeCoverage) -> str:
    speed = of_unit("V", "m/s")
    return (
        f"Cells of ±{0.5 * speed.factor * value.airspeed_width_m_s:.3g} {speed.unit} and "
        f"±{50 * value.fuel_width:.3g} % fuel; standard errors within {ACCURATE:.0%} are accurate, "
        f"insensitivity above {INSENSITIVE:.0%} is marked"
    )
