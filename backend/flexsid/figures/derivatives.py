"""Derivatives by method, source and flight condition, with ±2 standard errors (Fig. 17)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from itertools import groupby

import numpy as np

from flexsid.figures import style
from flexsid.figures.quantities import text
from flexsid.figures.spec import (
    N_SIGMA,
    Spec,
    axis,
    band,
    column,
    empty,
    error_bars,
    layout_key,
    line_at,
    plane,
    rows,
    scatter,
    title,
)
from flexsid.figures.style import format_axis_title, format_unit, get_family, parameter_label
from flexsid.nomenclature import describe
from flexsid.records.run import sort_methods
from flexsid.records.validation import (
    Against,
    ComparedSource,
    Comparison,
    DerivativeTrend,
    Row,
    SourceValue,
    TrendLine,
)

# --- Derivatives by method and prediction with ±2 standard errors (Fig. 17) -----------------------

_GAP = 0.06
_SPREAD = 0.7  # of the distance between derivatives, shared by the sources
_NAMES = 0.15  # of the height of a row
_RING = 2.5  # pixels, around a prediction that differs from the runs


def draw_derivatives(value: Comparison) -> Spec:
    """Draw a row of panels per coefficient, in each one per kind of variable.

    Their magnitudes differ by powers of ten. Names of derivatives on which the runs differ are
    flagged; predictions that differ from a run are ringed.
    """
    if not value.rows or not value.sources:
        return empty("No derivatives in common")
    groups = [list(group) for _, group in groupby(value.rows, key=_coefficient)]
    heights = rows([1.0] * len(groups))
    looks = select_styles(value.sources)
    layout: Spec = {
        "showlegend": True,
        "hovermode": "closest",
        "meta": {"rows": 1.5 * len(groups), "least_width": 620},
    }
    data: list[Spec] = []
    number = 0
    for group, (low, high) in zip(groups, heights, strict=True):
        for panel, width in _divide(group):
            number += 1
            layout[layout_key(number, "x")] = {
                "domain": width,
                "anchor": axis(number),
                "tickmode": "array",
                "autotickangles": [0, -30],  # upwards, or the last name would leave the drawing
                "tickvals": list(range(len(panel))),
                "ticktext": [_format_tick(row) for row in panel],
                "range": [-0.6, len(panel) - 0.4],
                "showgrid": False,
                "zeroline": False,
                # below its panel: beside it, a unit would lie on the ticks of the next
                **title(format_unit(panel[0].name)),
            }
            own: Spec = {"anchor": axis(number, "x"), "zeroline": True}
            if len(groups) > 1:  # the names and the unit of a row stand above the next one
                own["domain"] = [low + _NAMES * (high - low), high]
            layout[layout_key(number)] = own
            for index, source in enumerate(value.sources):
                offset = _SPREAD * ((index + 0.5) / len(value.sources) - 0.5)
                trace = _draw_source(panel, index, source, offset, looks[source.key], number)
                data += [trace] if trace["x"] else []
    named: set[str] = set()
    for trace in data:
        trace["showlegend"] = trace["legendgroup"] not in named
        named.add(trace["legendgroup"])
    return {"data": data, "layout": layout}


def _coefficient(row: Row) -> str:
    return row.name.partition("_")[0]


def _divide(group: list[Row]) -> Iterator[tuple[list[Row], list[float]]]:
    """Yield the panels of a row with their domains."""
    panels = [list(panel) for _, panel in groupby(group, key=lambda row: get_family(row.name))]
    # a panel of one derivative still needs room for its tick labels
    weights = [max(len(panel), 1.5) for panel in panels]
    room = 1.0 - _GAP * (len(panels) - 1)
    left = 0.0
    for panel, weight in zip(panels, weights, strict=True):
        right = left + room * weight / sum(weights)
        yield panel, [left, min(right, 1.0)]
        left = right + _GAP


def _format_tick(row: Row) -> str:
    label = parameter_label(row.name)
    flagged = f'<span style="color:{style.FLAG}">{label} !</span>'
    return flagged if row.consistent is False else label


def _draw_source(
    panel: list[Row],
    index: int,
    source: ComparedSource,
    offset: float,
    look: tuple[str, str],
    number: int,
) -> Spec:
    colour, symbol = look
    shown = [
        (place + offset, row.name, value)
        for place, row in enumerate(panel)
        if (value := row.values[index]) is not None
    ]
    rings = [_RING if value.consistent is False else 0 for _, _, value in shown]
    return scatter(
        [x for x, _, _ in shown],
        column([value.value for _, _, value in shown]),
        row=number,
        name=source.label,
        legendgroup=source.key,
        xaxis=axis(number, "x"),
        marker={
            "color": colour,
            "symbol": symbol,
            "size": 8,
            "line": {"color": style.FLAG, "width": rings},
        },
        error_y=error_bars([v.std_error for _, _, v in shown], colour, thickness=1.5, width=4),
        customdata=[[source.run_id, source.prediction_id, name] for _, name, _ in shown],
        text=[parameter_label(name) + _describe(value) for _, name, value in shown],
        hovertemplate=f"%{{text}}<br>%{{y:.5g}}<extra>{source.label}</extra>",
    )


def _describe(value: SourceValue) -> str:
    """Describe the error with what it rests on, and the difference of a prediction from runs."""
    error = "" if value.std_error is None else f" (2σ = {N_SIGMA * value.std_error:.3g})"
    error += "" if value.rests_on is None else f"<br>{value.rests_on}"
    if value.difference_sigma is None:
        return error
    return f"{error}, up to {value.difference_sigma:.1f}σ from the runs"


def select_styles(sources: tuple[ComparedSource, ...]) -> dict[str, tuple[str, str]]:
    """Select colour by method or prediction; open symbols for repeated or residualised ones."""
    looks: dict[str, tuple[str, str]] = {}
    seen: Counter[str] = Counter()
    predictions: dict[int | None, int] = {}
    for source in sources:
        if not source.is_prediction:
            looks[source.key] = style.of_method(source.kind, seen[source.kind])
            seen[source.kind] += 1
        else:
            order = predictions.setdefault(source.prediction_id, len(predictions))
            colour, symbol = style.PREDICTIONS[order % len(style.PREDICTIONS)]
            looks[source.key] = colour, symbol + ("" if source.run_id is None else "-open")
    return looks


# --- Forest plot: estimates of one derivative by source, with the weighted mean of the runs -------


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


# --- Trend of one derivative over flight condition, with weighted fits and ±2 standard errors -----

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
