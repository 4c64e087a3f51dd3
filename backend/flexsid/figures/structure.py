"""Structures: modes against fuel, MAC, models of every order, reduced responses, V-g."""

from __future__ import annotations

import numpy as np

from flexsid.figures import style
from flexsid.figures.spec import Spec, column, empty, rows, stagger, title, vertical_mark
from flexsid.records.modal_views import (
    AssuranceMatrix,
    ModelOrder,
    ModesAgainstFuel,
    ReducedResponses,
    Stabilisation,
)

_LEFT_OUT = 0.05


def modes_against_fuel(value: ModesAgainstFuel) -> Spec:
    """Frequencies and damping of the modes over fuel; crossings are circled."""
    top, bottom = rows([3, 1])
    data: list[Spec] = []
    for place, name in enumerate(value.names):
        colour, _ = style.of_index(place)
        dash = "solid" if value.symmetric[place] else "dash"
        line = {"color": colour, "width": 1.5, "dash": dash}
        shared = {"mode": "lines", "line": line, "name": name, "legendgroup": name}
        hover = f"{name}<br>fuel %{{x:.3f}}<br>%{{y:.3f}} Hz<extra></extra>"
        data.append(
            {"type": "scatter", "x": column(value.fuel), "showlegend": True,
             "y": column(value.frequency_hz[:, place], exact=True), "hovertemplate": hover,
             **shared}
        )  # fmt: skip
        data.append(
            {"type": "scatter", "mode": "markers", "x": column(value.table_fuel),
             "y": column(value.table_hz[:, place], exact=True), "name": name,
             "legendgroup": name, "showlegend": False, "hovertemplate": hover,
             "marker": {"color": colour, "size": 4}}
        )  # fmt: skip
        if np.isfinite(value.damping[:, place]).any():
            data.append(
                {"type": "scatter", "x": column(value.fuel), "yaxis": "y2",
                 "y": column(100.0 * value.damping[:, place]), "showlegend": False,
                 "hovertemplate": f"{name}<br>fuel %{{x:.3f}}<br>%{{y:.2f}} %<extra></extra>",
                 **shared | {"showlegend": False}}
            )  # fmt: skip
    if value.crossings:
        data.append(
            {"type": "scatter", "mode": "markers", "name": "crossing",
             "x": [mark.fuel for mark in value.crossings],
             "y": [mark.frequency_hz for mark in value.crossings],
             "text": [" × ".join(mark.names) for mark in value.crossings],
             "hovertemplate": "%{text}<br>fuel %{x:.3f}<br>%{y:.2f} Hz<extra>crossing</extra>",
             "marker": {"symbol": "circle-open", "size": 14, "color": style.FLAG,
                        "line": {"width": 2}}}
        )  # fmt: skip
    if value.doubtful:
        data.append(
            {"type": "scatter", "mode": "markers", "name": "followed in doubt",
             "x": [fuel for fuel, _ in value.doubtful],
             "y": [hertz for _, hertz in value.doubtful],
             "hovertemplate": "fuel %{x:.3f}: may be another mode<extra></extra>",
             "marker": {"symbol": "x-open", "size": 11, "color": style.FLAG}}
        )  # fmt: skip
    layout: Spec = {
        "meta": {"rows": 3},
        "xaxis": {**title("Fuel fraction [1]"), "anchor": "y2"},
        "yaxis": {**title("Frequency [Hz]"), "domain": top, "rangemode": "tozero"},
        "yaxis2": {**title("Damping ratio [%]"), "domain": bottom, "rangemode": "tozero"},
    }
    return {"data": data, "layout": layout}


def assurance(value: AssuranceMatrix) -> Spec:
    """MAC as a heat map, one where shapes are alike."""
    text = [[f"{x:.2f}" if x >= _LEFT_OUT else "" for x in row] for row in value.values]
    small = max(value.values.shape) <= 16
    trace: Spec = {
        "type": "heatmap",
        "x": list(range(len(value.columns))),
        "y": list(range(len(value.rows))),
        "z": column(value.values),
        "zmin": 0.0,
        "zmax": 1.0,
        "colorscale": [[0.0, "#f4f6f8"], [0.5, "#7fb3dd"], [1.0, "#0b3d66"]],
        "colorbar": {"title": {"text": "MAC"}},
        "customdata": [[[r, c] for c in value.columns] for r in value.rows],
        "hovertemplate": "%{customdata[0]} with %{customdata[1]}<br>MAC %{z:.4f}<extra></extra>",
    }
    if small:
        trace |= {"text": text, "texttemplate": "%{text}"}
    ticks = {"tickangle": -45, "automargin": True}
    layout: Spec = {
        "xaxis": {**title(value.column_title), **ticks, "tickmode": "array",
                  "tickvals": list(range(len(value.columns))), "ticktext": list(value.columns)},
        "yaxis": {**title(value.row_title), "automargin": True, "tickmode": "array",
                  "tickvals": list(range(len(value.rows))), "ticktext": list(value.rows),
                  "autorange": "reversed"},
    }  # fmt: skip
    return {"data": [trace], "layout": layout}


def model_order(value: ModelOrder, names: tuple[str, ...]) -> Spec:
    """Derivatives against modes kept, with the band of ±10 % about the full model's (Fig. 13)."""
    chosen = [name for name in names if name in value.full]
    if not chosen:
        return empty("no such derivative")
    counts = [len(step.modes) for step in value.steps]
    domains = rows([1.0] * len(chosen))
    data: list[Spec] = []
    layout: Spec = {"shapes": [], "meta": {"rows": max(2, len(chosen))}}
    for place, name in enumerate(chosen):
        y = "y" if place == 0 else f"y{place + 1}"
        full = value.full[name]
        for kind, colour, symbol, dash in (
            ("residualized", style.BLUE, "circle", "solid"),
            ("truncated", style.VERMILION, "square", "dot"),
        ):
            values = [getattr(step, kind)[name] for step in value.steps]
            data.append(
                {"type": "scatter", "mode": "lines+markers", "x": counts, "y": values,
                 "yaxis": y, "name": kind.replace("ized", "ised"), "legendgroup": kind,
                 "showlegend": place == 0,
                 "line": {"color": colour, "dash": dash},
                 "marker": {"symbol": symbol, "size": 7},
                 "hovertemplate": f"{name} %{{y:.4g}}<br>%{{x}} modes kept<extra>{kind}</extra>"}
            )  # fmt: skip
        layout["shapes"].append(
            {"type": "rect", "xref": "paper", "x0": 0, "x1": 1, "yref": y,
             "y0": 0.9 * full, "y1": 1.1 * full, "line": {"width": 0},
             "fillcolor": "rgba(0,158,115,0.18)", "layer": "below"}
        )  # fmt: skip
        key = "yaxis" if place == 0 else f"yaxis{place + 1}"
        layout[key] = {**title(name), "domain": domains[place], "automargin": True}
    layout["xaxis"] = {
        **title("Structural modes kept"),
        "anchor": f"y{len(chosen)}" if len(chosen) > 1 else "y",
        "tickmode": "array",
        "tickvals": counts,
        "ticktext": [
            f"{count}<br>{step.names[-1]}" if step.names else "0<br>SP"
            for count, step in zip(counts, value.steps, strict=True)
        ],
    }
    layout["shapes"].append(
        {"type": "line", "xref": "x", "yref": "paper", "x0": value.needed, "x1": value.needed,
         "y0": 0, "y1": 1, "line": {"color": style.GREEN, "dash": "dash", "width": 1.5}}
    )  # fmt: skip
    return {"data": data, "layout": layout}


def reduced_responses(value: ReducedResponses) -> Spec:
    """Magnitude and phase of one response, full, reduced and blind to the structure (Fig. 11)."""
    top, bottom = rows([2, 1])
    data: list[Spec] = []
    for place, (name, values) in enumerate(value.curves):
        colour, _ = style.of_index(place - 1) if place else (style.GREY, "circle")
        width = 4 if place == 0 else 1.5
        dash = "dot" if place == len(value.curves) - 1 else "solid"
        line = {"color": colour, "width": width, "dash": dash}
        shared = {"type": "scatter", "mode": "lines", "line": line, "name": name,
                  "legendgroup": name, "x": column(value.frequency_hz)}  # fmt: skip
        data.append(
            {**shared, "y": column(20.0 * np.log10(np.maximum(np.abs(values), 1e-12))),
             "hovertemplate": f"{name}<br>%{{x:.2f}} Hz<br>%{{y:.1f}} dB<extra></extra>"}
        )  # fmt: skip
        phase = np.degrees(np.unwrap(np.angle(values)))
        data.append(
            {**shared, "y": column(phase), "yaxis": "y2", "showlegend": False,
             "hovertemplate": f"{name}<br>%{{x:.2f}} Hz<br>%{{y:.0f}}°<extra></extra>"}
        )  # fmt: skip
    layout: Spec = {
        "xaxis": {**title("Frequency [Hz]"), "type": "log", "anchor": "y2"},
        "yaxis": {**title(f"|{value.output}/{value.input}| [dB, {value.unit}]"), "domain": top},
        "yaxis2": {**title("Phase [deg]"), "domain": bottom},
    }
    return {"data": data, "layout": layout}


def stabilisation(value: Stabilisation) -> Spec:
    """Stabilisation diagram: poles by order and how far they hold, over the mean response."""
    size = np.maximum(value.magnitude, 1e-30)
    data: list[Spec] = [
        {"type": "scatter", "mode": "lines", "name": "measured", "yaxis": "y2",
         "x": column(value.frequency_hz, exact=True), "y": column(20.0 * np.log10(size)),
         "line": {"color": style.MEASURED, "width": 1.5}, "hoverinfo": "skip"},
    ]  # fmt: skip
    if np.isfinite(value.fitted).all():
        data.append(
            {"type": "scatter", "mode": "lines", "name": "modes found", "yaxis": "y2",
             "x": column(value.frequency_hz, exact=True),
             "y": column(20.0 * np.log10(np.maximum(value.fitted, 1e-30))),
             "line": {"color": style.BLUE, "width": 1.2}, "hoverinfo": "skip"}
        )  # fmt: skip
    half = value.stable_frequency & ~value.stable
    for name, chosen, colour, symbol, points in (
        ("new pole", ~value.stable & ~half, style.GREY, "x-thin-open", 5),
        ("frequency holds", half, style.OCHRE, "triangle-up-open", 6),
        ("all holds", value.stable, style.GREEN, "circle", 6),
    ):
        hover = "%{x:.3f} Hz<br>damping %{customdata:.2f} %<br>order %{y}<extra></extra>"
        data.append(
            {"type": "scatter", "mode": "markers", "name": name,
             "x": column(value.pole_hz[chosen], exact=True),
             "y": column(value.pole_order[chosen]),
             "customdata": [100.0 * float(d) for d in value.pole_damping[chosen]],
             "marker": {"color": colour, "symbol": symbol, "size": points},
             "hovertemplate": hover}
        )  # fmt: skip
    marks = [vertical_mark(float(hertz), f"{hertz:.2f}") for hertz in value.mode_hz]
    stagger([annotation for _, annotation in marks])
    layout: Spec = {
        "meta": {"rows": 3},
        "xaxis": title("Frequency [Hz]"),
        "yaxis": title("Order of the model"),
        "yaxis2": {**title(f"Mean {value.quantity}/force [dB]"), "overlaying": "y",
                   "side": "right", "showgrid": False, "tickmode": "auto"},
        "shapes": [shape for shape, _ in marks],
        "annotations": [annotation for _, annotation in marks],
    }  # fmt: skip
    return {"data": data, "layout": layout}
