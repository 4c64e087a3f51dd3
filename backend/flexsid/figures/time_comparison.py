"""One output of several maneuvers over time, with the outputs of runs and their fit."""

from __future__ import annotations

from collections import Counter
from typing import Literal

import numpy as np

from flexsid.figures import quantities, style
from flexsid.figures.spec import (
    Spec,
    column,
    rows,
    scatter,
    select_samples,
    stack,
    text_at,
    title,
)
from flexsid.records.views import ComparedRecord, SimulatedOutput, TimeComparison

Arrangement = Literal["rows", "overlay"]
_DASHES = ("solid", "dash", "dot", "dashdot")


def draw_time_comparison(value: TimeComparison, arrangement: Arrangement = "rows") -> Spec:
    """Draw the record of each maneuver with the outputs of runs and their fit in percent.

    ``rows`` has one row per maneuver in order of dynamic pressure; ``overlay`` has all maneuvers
    in one, from their starts, coloured by maneuver.
    """
    shown = quantities.of_channel(value.output, value.unit)
    is_overlay = arrangement == "overlay"
    looks = _select_styles(value)
    named: set[str] = set()
    data: list[Spec] = []

    def draw(
        record: ComparedRecord, row: int, samples: np.ndarray, name: str, hover: str, line: Spec
    ) -> None:
        drawn = select_samples(record.time_s, samples, value.points)
        data.append(
            scatter(
                column(record.time_s, exact=True, drawn=drawn),
                column(shown.factor * samples, drawn=drawn),
                "lines",
                row=row,
                name=name,
                legendgroup=name,
                showlegend=name not in named,
                line=line,
                meta=record.maneuver_id,
                hovertemplate=f"%{{x:.3f}} s<br>%{{y:.4g}} {shown.unit}<extra>{hover}</extra>",
            )
        )
        named.add(name)

    for number, record in enumerate(value.records):
        row = 1 if is_overlay else number + 1
        colour = style.of_index(number)[0]
        condition = _describe_condition(record)
        name = f"{condition}: measured" if is_overlay else "measured"
        own = colour if is_overlay else style.MEASURED
        draw(record, row, record.measured, name, name, {"color": own, "width": 1})
        for place, one in enumerate(record.simulated):
            of_run, dash = looks[one.run_id]
            if is_overlay:  # the record is solid
                of_run, dash = colour, _DASHES[1 + place % (len(_DASHES) - 1)]
            line = {"color": of_run, "width": 1.4, "dash": dash}
            fit = _describe_fit(one)
            name = f"{condition}: {fit}" if is_overlay else _name_run(one)
            draw(record, row, one.values, name, fit, line)
    count = 1 if is_overlay else len(value.records)
    layout = stack(
        title("Time from the start [s]"),
        [title(shown.title)] * count,
        showlegend=True,
        hovermode="closest" if is_overlay else "x",
        meta={"rows": 2 if is_overlay else max(2, count)},
    )
    if not is_overlay:
        layout["annotations"] = [
            text_at(0, top, _describe_row(record), "left", "bottom", {"size": 11})
            for record, (_, top) in zip(value.records, rows([1.0] * count), strict=True)
        ]
        layout["legend"] = {"orientation": "h", "y": 1.06, "yanchor": "bottom"}
    return {"data": data, "layout": layout}


def _select_styles(value: TimeComparison) -> dict[int, tuple[str, str]]:
    """Select colour and dash of each run: of its method, with other dashes for further runs."""
    looks: dict[int, tuple[str, str]] = {}
    repeats: Counter[str] = Counter()
    for one in (one for record in value.records for one in record.simulated):
        if one.run_id not in looks:
            method = one.method.value
            colour = style.of_method(method)[0]
            looks[one.run_id] = (colour, _DASHES[repeats[method] % len(_DASHES)])
            repeats[method] += 1
    return looks


def _name_run(one: SimulatedOutput) -> str:
    return f"run {one.run_id}, {one.method.value}"


def _describe_fit(one: SimulatedOutput) -> str:
    fit = "–" if one.fit_percent is None else f"{one.fit_percent:.1f} %"
    return f"{_name_run(one)}: {fit}"


def _describe_condition(record: ComparedRecord) -> str:
    speed = quantities.of_unit("V", "m/s").format(record.airspeed_m_s)
    pressure = quantities.of_unit("q̄", "Pa").format(record.dynamic_pressure_pa)
    return f"{speed}, {pressure}, fuel {100.0 * record.fuel_fraction:.0f} %"


def _describe_row(record: ComparedRecord) -> str:
    fits = "; ".join(_describe_fit(one) for one in record.simulated)
    return f"<b>{quantities.text(record.label)}</b>, {_describe_condition(record)}. Fit: {fits}"
