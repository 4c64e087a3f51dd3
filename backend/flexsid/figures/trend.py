"""Trend of one derivative over flight condition, with weighted fits and ±2 standard errors."""

from __future__ import annotations

import numpy as np

from flexsid.figures import style
from flexsid.figures.labels import parameter_label, parameter_unit
from flexsid.figures.spec import Spec, column, title
from flexsid.nomenclature import describe
from flexsid.records.comparison import Against, DerivativeTrend, TrendLine

_N_SIGMA = 2.0
_SYMBOLS = {
    Against.DYNAMIC_PRESSURE: "dynamic_pressure",
    Against.AIRSPEED_RATIO: "airspeed_ratio",
    Against.FUEL: "fuel_fraction",
}


def trend(value: DerivativeTrend) -> Spec:
    """Draw estimates with their errors, a fit with its band per method, and predictions."""
    data: list[Spec] = []
    predictions = iter(style.PREDICTIONS * 4)
    for line in value.lines:
        if line.kind in style.METHODS:
            data += _fit(line, value.against)
        else:
            data.append(_prediction(line, next(predictions), value.against))
    data += [_points(value, kind) for kind in style.METHODS]
    return {
        "data": [trace for trace in data if len(trace["x"]) > 0],
        "layout": {
            "xaxis": _axis(value.against),
            "yaxis": {
                **title(f"{parameter_label(value.name)} [{parameter_unit(value.name)}]"),
                "zeroline": True,
            },
            "showlegend": True,
            "hovermode": "closest",
            "meta": {"rows": 1.5},
        },
    }


def _axis(against: Against) -> Spec:
    if against is Against.FTA:
        return {**title("FTA"), "type": "category"}
    return {**title(describe(_SYMBOLS[against]).axis_title), "zeroline": False}


def _scale_x(x: tuple[float, ...], against: Against) -> list[float | None] | list[str] | Spec:
    if against is Against.FTA:
        return [f"{number:.0f}" for number in x]
    return column(np.array(x) * describe(_SYMBOLS[against]).display_factor, exact=True)


def _points(value: DerivativeTrend, kind: str) -> Spec:
    colour, symbol = style.METHODS[kind]
    own = [point for point in value.points if point.kind == kind]
    errors = [np.nan if point.std_error is None else _N_SIGMA * point.std_error for point in own]
    return {
        "type": "scatter",
        "mode": "markers",
        "name": kind,
        "legendgroup": kind,
        "x": _scale_x(tuple(point.x for point in own), value.against),
        "y": column([point.value for point in own], exact=True),
        "marker": {"color": colour, "symbol": symbol, "size": 8},
        "error_y": {
            "type": "data",
            "array": column(errors),
            "color": colour,
            "thickness": 1.5,
            "width": 3,
        },
        "customdata": [[point.run_id, point.maneuver_id] for point in own],
        "text": [point.label for point in own],
        "hovertemplate": "%{text}<br>%{y:.5g}<extra></extra>",
    }


def _fit(line: TrendLine, against: Against) -> list[Spec]:
    colour, _ = style.METHODS[line.kind]
    assert line.std_errors is not None
    values, errors = np.array(line.values), _N_SIGMA * np.array(line.std_errors)
    x = _scale_x(line.x, against)
    shared: Spec = {
        "type": "scatter",
        "mode": "lines",
        "legendgroup": line.kind,
        "x": x,
        "hoverinfo": "skip",
    }
    edge = {**shared, "showlegend": False, "line": {"width": 0, "color": colour}}
    return [
        {**edge, "y": column(values - errors)},
        {**edge, "y": column(values + errors), "fill": "tonexty", "fillcolor": f"{colour}26"},
        {**shared, "name": line.label, "y": column(values), "line": {"color": colour}},
    ]


def _prediction(line: TrendLine, colour_symbol: tuple[str, str], against: Against) -> Spec:
    colour, symbol = colour_symbol
    return {
        "type": "scatter",
        "mode": "lines+markers",
        "name": line.label,
        "x": _scale_x(line.x, against),
        "y": column(line.values),
        "line": {"color": colour, "dash": "dot", "width": 1},
        "marker": {"color": colour, "symbol": f"{symbol}-open", "size": 6},
        "hovertemplate": "%{y:.5g}<extra>" + line.label + "</extra>",
    }
