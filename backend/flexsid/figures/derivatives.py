"""Derivatives by method and prediction with ±2 standard errors (Fig. 17)."""

from __future__ import annotations

from collections import Counter
from itertools import groupby

from flexsid.figures import style
from flexsid.figures.labels import get_family, parameter_label, parameter_unit
from flexsid.figures.spec import (
    N_SIGMA,
    Spec,
    axis,
    column,
    empty,
    error_bars,
    layout_key,
    scatter,
    title,
)
from flexsid.records.comparison import ComparedSource, Comparison, Row, SourceValue

_GAP = 0.06
_SPREAD = 0.7  # of the distance between derivatives, shared by the sources
_RING = 2.5  # pixels, around a prediction that differs from the runs


def draw_derivatives(value: Comparison) -> Spec:
    """Draw one panel per kind of variable, since magnitudes differ by powers of ten.

    Names of derivatives on which the runs differ are flagged; predictions that differ from a
    run are ringed.
    """
    if not value.rows or not value.sources:
        return empty("No derivatives in common")
    panels = [list(group) for _, group in groupby(value.rows, key=lambda row: get_family(row.name))]
    looks = select_styles(value.sources)
    layout: Spec = {"showlegend": True, "hovermode": "closest", "meta": {"rows": 1.5}}
    data: list[Spec] = []
    left = 0.0
    room = 1.0 - _GAP * (len(panels) - 1)
    # a panel of one derivative still needs room for its tick labels
    weights = [max(len(panel), 1.5) for panel in panels]
    for number, (panel, weight) in enumerate(zip(panels, weights, strict=True), start=1):
        right = left + room * weight / sum(weights)
        layout[layout_key(number, "x")] = {
            "domain": [left, min(right, 1.0)],
            "anchor": axis(number),
            "tickmode": "array",
            "autotickangles": [0, -30],  # upwards, or the last name would leave the drawing
            "tickvals": list(range(len(panel))),
            "ticktext": [_format_tick(row) for row in panel],
            "range": [-0.6, len(panel) - 0.4],
            "showgrid": False,
            "zeroline": False,
        }
        layout[layout_key(number)] = {
            "anchor": axis(number, "x"),
            **title(f"[{parameter_unit(panel[0].name)}]"),
            "zeroline": True,
        }
        for index, source in enumerate(value.sources):
            offset = _SPREAD * ((index + 0.5) / len(value.sources) - 0.5)
            trace = _draw_source(panel, index, source, offset, looks[source.key], number)
            data += [trace] if trace["x"] else []
        left = right + _GAP
    named: set[str] = set()
    for trace in data:
        trace["showlegend"] = trace["legendgroup"] not in named
        named.add(trace["legendgroup"])
    return {"data": data, "layout": layout}


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
    """Describe the error, and the largest difference of a prediction from a run."""
    error = "" if value.std_error is None else f" (2σ = {N_SIGMA * value.std_error:.3g})"
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
