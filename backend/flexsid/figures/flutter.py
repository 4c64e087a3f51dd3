"""Flutter: predicted speed, V-g and V-f, equivalent modes over dynamic pressure."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from flexsid.figures import style
from flexsid.figures.quantities import of_unit, text
from flexsid.figures.spec import (
    Spec,
    band,
    column,
    empty,
    error_bars,
    heatmap,
    line_at,
    plane,
    scatter,
    stack,
    stagger,
    title,
    vertical_mark,
)
from flexsid.records.flutter import (
    Flutter,
    FlutterMap,
    FlutterPoint,
    Instability,
    RootBranch,
    SummaryDiagram,
    SummaryRoot,
)

# --- Predicted flutter speed during a campaign, and its map over fuel and altitude ----------------

_FILL = 0.18


def draw_flutter_forecast(value: Flutter) -> Spec:
    """Draw predicted flutter speed against flown airspeed, by run and fused."""
    known = [run for run in value.runs if run.airspeed_m_s is not None]
    if not known:
        return empty("No run predicts an instability")
    speed = of_unit("Flutter speed", "m/s")
    std = _convert([run.airspeed_std_m_s for run in known])
    data: list[Spec] = [
        scatter(
            _convert([run.tested_m_s for run in known]),
            _convert([run.airspeed_m_s for run in known]),
            name="single runs ±2σ",
            error_y=error_bars(std, style.BLUE, thickness=1),
            marker={"color": style.BLUE, "size": 8},
            text=[text(run.label) for run in known],
            customdata=[[run.run_id] for run in known],
            hovertemplate=f"%{{text}}<br>at %{{x:.1f}} {speed.unit}<br>"
            f"flutter %{{y:.2f}} {speed.unit}<extra></extra>",
        )
    ]
    data += _draw_progress(value)
    tested = [speed.factor * run.tested_m_s for run in known]
    ends = [min(tested), max(tested)]
    levels = [
        ("all runs fused", value.airspeed_m_s, style.BLUE, "solid"),
        ("predicted before flight", value.predicted_flutter_m_s, style.GREY, "dash"),
        *(
            (method.name, method.airspeed_m_s, style.PREDICTIONS[k % 4][0], "dot")
            for k, method in enumerate(value.trackers)
        ),
    ]
    for name, level, colour, dash in levels:
        if level is not None:
            data.append(
                scatter(
                    ends,
                    [speed.factor * level] * 2,
                    "lines",
                    name=name,
                    line={"color": colour, "dash": dash, "width": 1.8},
                    hovertemplate=f"%{{y:.2f}} {speed.unit}<extra>{name}</extra>",
                )
            )
    view: Spec = {}
    if value.airspeed_m_s is not None:
        fused = speed.factor * value.airspeed_m_s
        view = {"range": [0.8 * fused, 1.25 * fused]}
    shapes: list[Spec] = []
    if value.low_m_s is not None and value.high_m_s is not None:
        low, high = speed.factor * value.low_m_s, speed.factor * value.high_m_s
        shapes = [band(low, high, style.BLUE, letter="y", opacity=_FILL)]
    y_axis = {**title(speed.axis_title), **view}
    layout = plane(title(of_unit("Flown airspeed", "m/s").axis_title), y_axis, 3, shapes=shapes)
    return {"data": data, "layout": layout}


def _draw_progress(value: Flutter) -> list[Spec]:
    """Draw the fused prediction after each airspeed, with its interval."""
    known = [step for step in value.progress if step.airspeed_m_s is not None]
    if len(known) < 2:
        return []
    unit = of_unit("Flutter speed", "m/s").unit
    speed = _convert([step.airspeed_m_s for step in known])
    low = _convert([step.low_m_s for step in known])
    high = _convert([step.high_m_s for step in known])
    return [
        scatter(
            _convert([step.tested_m_s for step in known]),
            speed,
            "lines+markers",
            name="runs up to this airspeed, 95 %",
            error_y=error_bars(
                high - speed,
                style.VERMILION,
                factor=1.0,
                thickness=1.5,
                symmetric=False,
                arrayminus=column(speed - low),
            ),
            marker={"color": style.VERMILION, "size": 7, "symbol": "diamond"},
            line={"color": style.VERMILION, "width": 1.2},
            text=[f"{step.n_runs} runs" for step in known],
            hovertemplate=f"%{{text}} up to %{{x:.1f}} {unit}<br>%{{y:.2f}} {unit}<extra></extra>",
        )
    ]


def _convert(speeds_m_s: list[float | None]) -> np.ndarray:
    return of_unit("Airspeed", "m/s").factor * np.array(speeds_m_s, dtype=float)


def draw_flutter_map(value: FlutterMap) -> Spec:
    """Draw the flutter speed over fuel and altitude."""
    if not np.isfinite(value.airspeed_m_s).any():
        return empty("No instability at the searched loadings and altitudes")
    speed, altitude = of_unit("Flutter speed", "m/s"), of_unit("Altitude, standard atmosphere", "m")
    trace = heatmap(
        [100.0 * fuel for fuel in value.fuel.tolist()],
        (altitude.factor * value.altitude_m).tolist(),
        speed.factor * value.airspeed_m_s,
        name="flutter speed",
        colorscale="Viridis",
        colorbar=title(speed.axis_title),
        hovertemplate=f"fuel %{{x:.0f}} %<br>altitude %{{y:.0f}} {altitude.unit}<br>"
        f"%{{z:.2f}} {speed.unit}<extra></extra>",
    )
    layout = {
        "xaxis": title("Fuel [%]"),
        "yaxis": title(altitude.axis_title),
        "meta": {"rows": 3},
    }
    return {"data": [trace], "layout": layout}


# --- Damping and frequency over airspeed of the roots of a flutter summary: V-g and V-f -----------

_REAL = 0.05
"""rad/s: a root of a prediction below is real."""

_SHOWN_G = (-0.6, 0.3)
"""Largest range of damping in view at first; a static motion has g down to -10."""

_FACTOR = 1.15


def draw_flutter_summary(value: SummaryDiagram) -> Spec:
    """Draw structural damping g over frequency, with instabilities and a prediction, dashed.

    Neutral roots are thin and grey.
    """
    shown = value.roots
    if not shown.roots:
        return empty("No root in this analysis")
    speed, frequency = of_unit("Airspeed", "m/s"), of_unit("Frequency", "Hz")
    data: list[Spec] = []
    for root, colour, symbol, width in _select_styles(shown.roots):
        name = _name(root)
        for row, (values, of_y) in enumerate(
            (
                (np.asarray(root.damping_g), ""),
                (frequency.factor * np.asarray(root.frequency_hz), f" {frequency.unit}"),
            ),
            start=1,
        ):
            data.append(
                scatter(
                    column(speed.factor * np.asarray(root.airspeed_m_s), exact=True),
                    column(values, exact=True),
                    "lines+markers",
                    row=row,
                    name=name,
                    legendgroup=name,
                    showlegend=row == 1,
                    line={"color": colour, "width": width},
                    marker={"color": colour, "symbol": symbol, "size": 3.0 * width + 1.0},
                    hovertemplate=f"%{{x:.4~g}} {speed.unit}<br>%{{y:.4~g}}{of_y}"
                    f"<extra>{name}</extra>",
                )
            )
    if value.predicted is not None:
        for branch in value.predicted.branches:
            data += _draw_predicted(branch, value.predicted.at)
    data += _draw_points(shown.points, shown.g)
    layout = stack(
        title(speed.axis_title),
        [
            {**title("Structural damping g"), "range": _find_range(shown.roots)},
            {**title(frequency.axis_title), "rangemode": "tozero"},
        ],
        showlegend=True,
        hovermode="closest",
        meta={"rows": 4, "note": " ".join(shown.notes)},
        shapes=[line_at(0.0, "y")],
        annotations=[],
    )
    if shown.g:
        layout["shapes"].append(
            line_at(shown.g, "y", line={"color": style.GREY, "width": 1.2, "dash": "dot"})
        )
    for kind in Instability:
        seen = [point.airspeed_m_s for point in shown.points if point.kind is kind]
        if seen:
            shape, note = vertical_mark(speed.factor * min(seen), kind.value)
            layout["shapes"].append(shape)
            layout["annotations"].append(note)
    stagger(layout["annotations"], data)
    return {"data": data, "layout": layout}


def _name(root: SummaryRoot) -> str:
    return text(f"{root.number} {root.name}" if root.name else f"root {root.number}")


def _select_styles(
    roots: tuple[SummaryRoot, ...],
) -> Iterator[tuple[SummaryRoot, str, str, float]]:
    """Select colour, symbol and width of every root; grey for neutral ones."""
    shown = 0
    for root in roots:
        if root.is_neutral:
            yield root, style.GREY, "circle", 0.8
        else:
            yield root, *style.of_index(shown), 1.6
            shown += 1


def _draw_predicted(branch: RootBranch, airspeed: np.ndarray) -> list[Spec]:
    """Draw a root of a prediction; g is twice the ratio of its real and imaginary part."""
    oscillates = branch.imag > _REAL
    imag = np.where(oscillates, branch.imag, np.nan)
    name = f"{text(branch.name)}, predicted"
    speed, frequency = of_unit("Airspeed", "m/s"), of_unit("Frequency", "Hz")
    return [
        scatter(
            column(speed.factor * airspeed, exact=True),
            column(values),
            "lines",
            row=row,
            name=name,
            legendgroup=name,
            showlegend=row == 1,
            line={"color": style.GREY, "dash": "dash", "width": 1.4},
            hovertemplate=f"%{{x:.4~g}} {speed.unit}<br>%{{y:.4~g}}{of_y}<extra>{name}</extra>",
        )
        for row, (values, of_y) in enumerate(
            (
                (2.0 * branch.real / imag, ""),
                (frequency.factor * imag / (2.0 * np.pi), f" {frequency.unit}"),
            ),
            start=1,
        )
    ]


def _draw_points(points: tuple[FlutterPoint, ...], g: float) -> list[Spec]:
    """Draw where roots become unstable: at the damping g, and on the axis of frequency."""
    if not points:
        return []
    speed, frequency = of_unit("Airspeed", "m/s"), of_unit("Frequency", "Hz")
    symbols = [
        "triangle-left-open"
        if point.is_bound
        else {Instability.FLUTTER: "x", Instability.DIVERGENCE: "diamond-open"}[point.kind]
        for point in points
    ]
    labels = [
        f"{point.kind.value} of root {point.root}"
        + (", unstable at or below this speed" if point.is_bound else "")
        for point in points
    ]
    at = [0.0 if point.kind is Instability.DIVERGENCE else g for point in points]
    return [
        scatter(
            column([speed.factor * point.airspeed_m_s for point in points], exact=True),
            column(y),
            row=row,
            name="instabilities",
            legendgroup="instabilities",
            showlegend=row == 1,
            marker={"color": style.FLAG, "symbol": symbols, "size": 10},
            text=labels,
            hovertemplate=f"%{{text}}<br>%{{x:.4~g}} {speed.unit}<extra></extra>",
        )
        for row, y in (
            (1, at),
            (2, [frequency.factor * point.omega_rad_s / (2.0 * np.pi) for point in points]),
        )
    ]


def _find_range(roots: tuple[SummaryRoot, ...]) -> list[float]:
    """Return the range of damping in view: that of roots that oscillate, within ``_SHOWN_G``."""
    known = [
        g
        for root in roots
        for g, hertz in zip(root.damping_g, root.frequency_hz, strict=True)
        if hertz > 0.0 and not root.is_neutral
    ]
    low = max(min(known, default=-0.1), _SHOWN_G[0])
    high = min(max(max(known, default=0.0), -0.1 * low, 1e-3), _SHOWN_G[1])
    return [_FACTOR * low, _FACTOR * high]


# --- Equivalent frequency and damping of modes over dynamic pressure ------------------------------


def draw_equivalent_modes(value: Flutter) -> Spec:
    """Draw equivalent frequency and damping over dynamic pressure, ±2 standard errors (Eq. 25)."""
    if not value.equivalent_points:
        return empty("No estimated structural modes")
    pressure = of_unit("Dynamic pressure", "Pa")
    frequency = of_unit("Equivalent frequency", "Hz")
    data: list[Spec] = []
    lines = {line.mode: line for line in value.equivalents}
    for number, mode in enumerate(dict.fromkeys(p.mode for p in value.equivalent_points)):
        own = [p for p in value.equivalent_points if p.mode == mode and p.frequency_hz is not None]
        if not own:
            continue
        colour, symbol = style.of_index(number)
        name = text(own[0].name)
        for row, (y, std, scale) in enumerate(
            (
                ("frequency_hz", "frequency_std_hz", frequency.factor),
                ("damping", "damping_std", 100.0),
            ),
            start=1,
        ):
            errors = scale * np.array([getattr(p, std) for p in own], dtype=float)
            data.append(
                scatter(
                    column([pressure.factor * p.dynamic_pressure_pa for p in own]),
                    scale * np.array([getattr(p, y) for p in own], dtype=float),
                    row=row,
                    name=name,
                    legendgroup=own[0].name,
                    showlegend=row == 1,
                    error_y=error_bars(errors, thickness=1),
                    marker={"color": colour, "symbol": symbol, "size": 7},
                    text=[text(p.label) for p in own],
                    customdata=[[p.run_id] for p in own],
                    hovertemplate=f"%{{text}}<br>%{{x:.4~g}} {pressure.unit}<br>%{{y:.4g}}"
                    "<extra></extra>",
                )
            )
            if mode in lines:
                data.append(
                    scatter(
                        [0.0],
                        [scale * getattr(lines[mode], y)],
                        row=row,
                        name=f"{name} in vacuo",
                        legendgroup=own[0].name,
                        showlegend=False,
                        error_y=error_bars([scale * getattr(lines[mode], std)], thickness=1),
                        marker={"color": colour, "symbol": f"{symbol}-open", "size": 10},
                        hovertemplate="in vacuo<br>%{y:.4g}<extra></extra>",
                    )
                )
    layout = stack(
        {**title(pressure.axis_title), "rangemode": "tozero"},
        [title(frequency.axis_title), title("Equivalent damping [%]")],
        showlegend=True,
        hovermode="closest",
        meta={"rows": 3, "note": "Open markers: in vacuo, extrapolated by linear fits."},
    )
    return {"data": data, "layout": layout}
