"""Trend of one derivative over flight condition, with weighted fits and ±2 standard errors."""

from __future__ import annotations

import numpy as np

from flexsid.figures import style
from flexsid.figures.labels import format_axis_title
from flexsid.figures.spec import N_SIGMA, Spec, column, error_bars, plane, scatter, title
from flexsid.nomenclature import describe
from flexsid.records.comparison import Against, DerivativeTrend, TrendLine
from flexsid.records.run import sort_methods

_SYMBOLS = {
    Against.DYNAMIC_PRESSURE: "dynamic_pressure",
    Against.AIRSPEED_RATIO: "airspeed_ratio",
    Against.FUEL: "fuel_fraction",
}


def draw_trend(value: DerivativeTrend) -> Spec:
    """Draw estimates with their errors, a fit with its band per method, and predictions."""
    data: list[Spec] = []
    predictions = iter(style.PREDICTIONS * 4)
    for line in value.lines:
        if line.std_errors is None:
            data.append(_draw_prediction(line, next(predictions), value.against))
        else:
            data += _draw_fit(line, value.against)
    data += [_draw_points(value, kind) for kind in sort_methods(p.kind for p in value.points)]
    y_axis = {**title(format_axis_title(value.name)), "zeroline": True}
    layout = plane(_lay_out_x(value.against), y_axis, 1.5)
    return {"data": [trace for trace in data if len(trace["x"]) > 0], "layout": layout}


def _lay_out_x(against: Against) -> Spec:
    if against is Against.FTA:
        return {**title("FTA"), "type": "category"}
    return {**title(describe(_SYMBOLS[against]).axis_title), "zeroline": False}


def _scale_x(x: tuple[float, ...], against: Against) -> Spec | list[str]:
    if against is Against.FTA:
        return [f"{number:.0f}" for number in x]
    return column(np.array(x) * describe(_SYMBOLS[against]).display_factor, exact=True)


def _draw_points(value: DerivativeTrend, kind: str) -> Spec:
    colour, symbol = style.of_method(kind)
    own = [point for point in value.points if point.kind == kind]
    return scatter(
        _scale_x(tuple(point.x for point in own), value.against),
        column([point.value for point in own], exact=True),
        name=kind,
        legendgroup=kind,
        marker={"color": colour, "symbol": symbol, "size": 8},
        error_y=error_bars([point.std_error for point in own], colour, thickness=1.5, width=3),
        customdata=[[point.run_id, point.maneuver_id] for point in own],
        text=[point.label for point in own],
        hovertemplate="%{text}<br>%{y:.5g}<extra></extra>",
    )


def _draw_fit(line: TrendLine, against: Against) -> list[Spec]:
    colour, _ = style.of_method(line.kind)
    assert line.std_errors is not None
    values, errors = np.array(line.values), N_SIGMA * np.array(line.std_errors)
    x = _scale_x(line.x, against)
    edge = {"showlegend": False, "line": {"width": 0, "color": colour}}
    drawn: list[tuple[np.ndarray, Spec]] = [
        (values - errors, edge),
        (values + errors, {**edge, "fill": "tonexty", "fillcolor": f"{colour}26"}),
        (values, {"name": line.label, "line": {"color": colour}}),
    ]
    return [
        scatter(x, y, "lines", legendgroup=line.kind, hoverinfo="skip", **own) for y, own in drawn
    ]


def _draw_prediction(line: TrendLine, look: tuple[str, str], against: Against) -> Spec:
    colour, symbol = look
    return scatter(
        _scale_x(line.x, against),
        column(line.values),
        "lines+markers",
        name=line.label,
        line={"color": colour, "dash": "dot", "width": 1},
        marker={"color": colour, "symbol": f"{symbol}-open", "size": 6},
        hovertemplate="%{y:.5g}<extra>" + line.label + "</extra>",
    )
