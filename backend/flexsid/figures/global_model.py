"""Slices of the global aerodynamic model with their runs, and its coverage of the envelope."""

from __future__ import annotations

import numpy as np

from flexsid.figures import style
from flexsid.figures.labels import format_axis_title
from flexsid.figures.spec import (
    N_SIGMA,
    Spec,
    column,
    empty,
    error_bars,
    heatmap,
    plane,
    scatter,
    title,
)
from flexsid.nomenclature import Symbol, describe
from flexsid.records.decision import LimitedQuantity
from flexsid.records.global_model import DerivativeSlice, EnvelopeCoverage
from flexsid.records.run import sort_methods

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
            colorbar={"title": {"text": "σ / smallest σ [1]", "side": "right"}},
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
