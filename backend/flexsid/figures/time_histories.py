"""Channels over time: recorded, commanded, simulated, reconstructed, known in flight."""

from __future__ import annotations

from collections import Counter
from typing import Literal

import numpy as np

from flexsid.figures import quantities, style
from flexsid.figures.quantities import of_unit
from flexsid.figures.spec import (
    BOUNDARY,
    N_SIGMA,
    Spec,
    band,
    column,
    empty,
    error_bars,
    line_at,
    rows,
    scatter,
    select_samples,
    stack,
    text_at,
    time_axis,
    title,
)
from flexsid.records.live import LiveHistory
from flexsid.records.maneuver import Role
from flexsid.records.views import (
    ChannelHistories,
    ChannelTrace,
    ComparedRecord,
    ReconstructedTrace,
    Reconstruction,
    SimulatedOutput,
    SurfaceHistories,
    TimeCheck,
    TimeComparison,
)

# --- Channels against time, one row each on a shared time axis (Figs 4 and 8) ---------------------

_COLOURS = {
    Role.INPUT: style.BLUE,
    Role.COMMAND: style.GREEN,
    Role.OUTPUT: style.VERMILION,
    Role.CONDITION: style.VIOLET,
}


def draw_time_history(value: ChannelHistories) -> Spec:
    """Draw each channel in its own row and unit, downsampled to screen resolution."""
    ends = [trace.time_s[[0, -1]] for trace in value.traces if trace.time_s.size]
    if not ends:
        return empty("No samples in this window")
    shown = [quantities.of_channel(trace.name, trace.unit) for trace in value.traces]
    layout = stack(
        {**time_axis(value.origin), "range": [float(np.min(ends)), float(np.max(ends))]},
        [title(quantity.title) for quantity in shown],
        showlegend=False,
        hovermode="x",
    )
    if value.excitation_s is not None:
        layout["shapes"] = [band(*value.excitation_s, style.GREY, opacity=0.08)]
    data = [
        _draw(trace, quantity, row, value.points)
        for row, (trace, quantity) in enumerate(zip(value.traces, shown, strict=True), start=1)
    ]
    return {"data": data, "layout": layout}


def _draw(trace: ChannelTrace, shown: quantities.DisplayQuantity, row: int, points: int) -> Spec:
    drawn = select_samples(trace.time_s, trace.values, points)
    return scatter(
        column(trace.time_s, exact=True, drawn=drawn),
        column(trace.values * shown.factor, drawn=drawn),
        "lines",
        row=row,
        name=shown.label,
        line={"color": _COLOURS[trace.role], "width": 1},
        meta=trace.name,
        hovertemplate=f"%{{y:.4g}} {shown.unit}<extra>{shown.label}</extra>",
    )


# --- Surfaces against their commands through the servos, left against right (Fig. 4) --------------

_MEASURED = (style.BLUE, style.VERMILION)  # of a pair: left, right


def draw_surface_histories(value: SurfaceHistories) -> Spec:
    """Draw measured deflections, and over them what the commands make of them."""
    if not any(one.measured.time_s.size for row in value.rows for one in row):
        return empty("No samples in this window")
    headings, data, named = [], [], set[str]()
    for number, row in enumerate(value.rows, start=1):
        shown = [quantities.of_channel(one.measured.name, one.measured.unit) for one in row]
        headings.append(title("<br>".join(one.title for one in shown)))
        sides = ("measured",) if len(row) == 1 else ("measured, left", "measured, right")
        for one, quantity, side, colour in zip(row, shown, sides, _MEASURED, strict=False):
            curves: list[tuple[ChannelTrace | None, str, dict[str, object]]] = [
                (one.measured, side, {"color": colour, "width": 1}),
                (
                    one.commanded,
                    "command through the servo",
                    {"color": style.GREY, "width": 1, "dash": "dot"},
                ),
            ]
            for trace, name, line in curves:
                if trace is None:
                    continue
                drawn = select_samples(trace.time_s, trace.values, value.points)
                data.append(
                    scatter(
                        column(trace.time_s, exact=True, drawn=drawn),
                        column(trace.values * quantity.factor, drawn=drawn),
                        "lines",
                        row=number,
                        name=name,
                        legendgroup=name,
                        showlegend=name not in named,
                        line=line,
                        meta=one.measured.name,
                        hovertemplate=f"%{{y:.4g}} {quantity.unit}<extra>{quantity.label}, "
                        f"{name}</extra>",
                    )
                )
                named.add(name)
    legend = {"orientation": "h", "y": 1.02, "yanchor": "bottom"}
    return {
        "data": data,
        "layout": stack(time_axis(), headings, legend=legend, hovermode="x"),
    }


# --- Measured and simulated outputs against time, one row each ------------------------------------


def draw_time_check(value: TimeCheck) -> Spec:
    """Draw measured and simulated outputs with R2 by row."""
    if not value.traces:
        return empty("No outputs selected")
    headings, data = [], []
    for row, trace in enumerate(value.traces, start=1):
        quantity = quantities.of_channel(trace.name, trace.unit)
        headings.append(title(f"{quantity.title}<br>R² = {trace.r_squared:.3f}"))
        for name, samples, colour in (
            ("measured", trace.measured, style.GREY),
            (
                f"{value.method.value} model",
                trace.simulated,
                style.of_method(value.method.value)[0],
            ),
        ):
            drawn = select_samples(trace.time_s, samples, value.points)
            data.append(
                scatter(
                    column(trace.time_s, exact=True, drawn=drawn),
                    column(samples * quantity.factor, drawn=drawn),
                    "lines",
                    row=row,
                    name=name,
                    legendgroup=name,
                    showlegend=row == 1,
                    line={"color": colour, "width": 1},
                    hovertemplate=f"%{{y:.4g}} {quantity.unit}<extra>{name}</extra>",
                )
            )
    legend = {"orientation": "h", "y": 1.02, "yanchor": "bottom"}
    return {
        "data": data,
        "layout": stack(time_axis(), headings, legend=legend, hovermode="x"),
    }


# --- One output of several maneuvers over time, with the outputs of runs and their fit ------------

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


# --- What was known during a flight: flutter speed and damping of each mode over time -------------


def draw_live_history(value: LiveHistory) -> Spec:
    """Draw the flutter speed with the present airspeed, and damping ratios, ±2 standard errors."""
    if not value.time_s:
        return empty("No estimate")
    speed = of_unit("Speed", "m/s")
    time = column(value.time_s, exact=True)
    blue, symbol = style.of_index(0)
    data = [
        scatter(
            time,
            _convert(value.flutter_m_s, speed.factor),
            row=1,
            name="flutter speed",
            marker={"color": blue, "symbol": symbol},
            error_y=error_bars(_convert(value.flutter_std_m_s, speed.factor), blue),
            hovertemplate=f"%{{x:.1f}} s<br>%{{y:.2f}} {speed.unit}<extra>flutter speed</extra>",
        ),
        scatter(
            time,
            _convert(value.airspeed_m_s, speed.factor),
            "lines",
            row=1,
            name="present airspeed",
            line={"color": style.GREY},
            hovertemplate=f"%{{x:.1f}} s<br>%{{y:.2f}} {speed.unit}<extra>airspeed</extra>",
        ),
    ]
    for index, (name, damping) in enumerate(value.damping.items(), start=1):
        color, symbol = style.of_index(index)
        data.append(
            scatter(
                time,
                column(damping),
                row=2,
                name=name,
                marker={"color": color, "symbol": symbol},
                error_y=error_bars([std or float("nan") for std in value.damping_std[name]], color),
                hovertemplate=f"%{{x:.1f}} s<br>%{{y:.4f}}<extra>{name}</extra>",
            )
        )
    axes = (title(speed.axis_title), title("Damping ratio"))
    stability = line_at(0.0, "y", line=BOUNDARY) | {"yref": "y2", "xref": "paper"}
    return {"data": data, "layout": stack(time_axis(), axes, showlegend=True, shapes=[stability])}


def _convert(speeds_m_s: tuple[float | None, ...], factor: float) -> np.ndarray:
    return factor * np.array(speeds_m_s, dtype=float)


# --- Reconstructed motion and coefficients in time (Fig. 16a) and over frequency, with rank -------

_POINTS = 2000
_LEGEND = {"orientation": "h", "y": 1.02, "yanchor": "bottom"}


def draw_reconstruction(
    value: Reconstruction, domain: Literal["time", "frequency"] = "time"
) -> Spec:
    """Draw each quantity with ±2 standard errors, in time or over frequency.

    Over frequency with the condition number in a further row.
    """
    return _draw_histories(value) if domain == "time" else _draw_spectra(value)


def _draw_histories(value: Reconstruction) -> Spec:
    if not value.traces:
        return empty("No quantity selected")
    titles, data = [], []
    for row, trace in enumerate(value.traces, start=1):
        quantity = quantities.of_channel(trace.name, trace.unit)
        titles.append(title(quantity.label if quantity.unit == "1" else quantity.title))
        data += _draw_history(value.time_s, trace, quantity, row)
    layout = stack(time_axis(), titles, legend=_LEGEND, hovermode="x")
    return {"data": data, "layout": layout | {"meta": _describe(value, len(titles))}}


def _draw_spectra(value: Reconstruction) -> Spec:
    frequency = quantities.of_unit("Frequency", "Hz")
    titles, data = [], []
    for row, trace in enumerate(value.traces, start=1):
        quantity = quantities.transform(quantities.of_channel(trace.name, trace.unit))
        titles.append(quantity.title)
        data.append(
            scatter(
                frequency.factor * value.frequency_hz,
                trace.spectrum_magnitude * quantity.factor,
                row=row,
                name="±2 standard errors",
                legendgroup="lines",
                showlegend=row == 1,
                error_y=error_bars(trace.spectrum_std * quantity.factor, thickness=1, width=0),
                marker={"color": style.BLUE, "size": 4},
                meta=trace.name,
                hovertemplate=f"%{{x:.3f}} {frequency.unit}<br>%{{y:.3g}} {quantity.unit}"
                "<extra></extra>",
            )
        )
    titles.append("Condition number")
    full = value.rank == value.n_motions
    for name, selected, colour in (
        (f"rank {value.n_motions}", full, style.BLUE),
        ("rank-deficient", ~full, style.FLAG),
    ):
        if selected.any():
            data.append(
                scatter(
                    frequency.factor * value.frequency_hz[selected],
                    value.condition[selected],
                    row=len(titles),
                    name=name,
                    marker={"color": colour, "size": 4},
                    text=[f"rank {rank}" for rank in value.rank[selected].tolist()],
                    hovertemplate=f"%{{x:.3f}} {frequency.unit}<br>cond. %{{y:.3g}}<br>%{{text}}"
                    "<extra></extra>",
                )
            )
    axes = [{**title(text), "type": "log"} for text in titles]
    layout = stack(title(frequency.axis_title), axes, legend=_LEGEND, hovermode="closest")
    return {"data": data, "layout": layout | {"meta": _describe(value, len(titles))}}


def _describe(value: Reconstruction, count: int) -> Spec:
    """Collect values for the page beside the figure."""
    finite = value.condition[np.isfinite(value.condition)]
    return {
        "rows": count,
        "offered": list(value.offered),
        "modes": list(value.modes),
        "mode_names": list(value.mode_names),
        "n_motions": value.n_motions,
        "least_rank": int(value.rank.min()),
        "worst_condition": float(finite.max()) if finite.size else None,
        "n_sensors": len(value.sensors),
        "excluded": [
            f"{', '.join(name for name, given in value.excluded.items() if given == reason)}: "
            f"{reason}"
            for reason in dict.fromkeys(value.excluded.values())
        ],
    }


def _draw_history(
    time_s: np.ndarray, trace: ReconstructedTrace, quantity: quantities.DisplayQuantity, row: int
) -> list[Spec]:
    drawn = select_samples(time_s, trace.values, _POINTS)
    # There and back, around the band.
    around = np.concatenate([drawn, 2 * time_s.size - 1 - drawn[::-1]])
    values = trace.values * quantity.factor
    spread = N_SIGMA * trace.std * quantity.factor
    return [
        scatter(
            column(np.concatenate([time_s, time_s[::-1]]), exact=True, drawn=around),
            column(np.concatenate([values + spread, (values - spread)[::-1]]), drawn=around),
            "lines",
            row=row,
            name="±2 standard errors",
            legendgroup="band",
            showlegend=row == 1,
            fill="toself",
            fillcolor=style.GREY,
            opacity=0.35,
            line={"width": 0, "color": style.GREY},
            hoverinfo="skip",
        ),
        scatter(
            column(time_s, exact=True, drawn=drawn),
            column(values, drawn=drawn),
            "lines",
            row=row,
            name="reconstructed",
            legendgroup="value",
            showlegend=row == 1,
            line={"color": style.BLUE, "width": 1},
            meta=trace.name,
            hovertemplate=f"%{{y:.4g}} {quantity.unit}<extra>{quantity.label}</extra>",
        ),
    ]
