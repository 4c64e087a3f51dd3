"""Modal data: modes over fuel, MAC, model order, reduced responses, stabilisation diagram."""

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

_LEAST_SHOWN = 0.05


def modes_against_fuel(value: ModesAgainstFuel) -> Spec:
    """Draw frequencies and damping of the modes over fuel, with crossings circled."""
    top, bottom = rows([3, 1])
    data: list[Spec] = []
    for index, name in enumerate(value.names):
        colour, _ = style.of_index(index)
        dash = "solid" if value.symmetric[index] else "dash"
        line = {"color": colour, "width": 1.5, "dash": dash}
        shared = {"mode": "lines", "line": line, "name": name, "legendgroup": name}
        hover = f"{name}<br>fuel %{{x:.3f}}<br>%{{y:.3f}} Hz<extra></extra>"
        data.append(
            {"type": "scatter", "x": column(value.fuel), "showlegend": True,
             "y": column(value.frequency_hz[:, index], exact=True), "hovertemplate": hover,
             **shared}
        )  # fmt: skip
        data.append(
            {"type": "scatter", "mode": "markers", "x": column(value.table_fuel),
             "y": column(value.table_hz[:, index], exact=True), "name": name,
             "legendgroup": name, "showlegend": False, "hovertemplate": hover,
             "marker": {"color": colour, "size": 4}}
        )  # fmt: skip
        if np.isfinite(value.damping[:, index]).any():
            data.append(
                {"type": "scatter", "x": column(value.fuel), "yaxis": "y2",
                 "y": column(100.0 * value.damping[:, index]), "showlegend": False,
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
    if value.uncertain:
        data.append(
            {"type": "scatter", "mode": "markers", "name": "low MAC",
             "x": [fuel for fuel, _ in value.uncertain],
             "y": [hertz for _, hertz in value.uncertain],
             "hovertemplate": "fuel %{x:.3f}: low MAC, tracking uncertain<extra></extra>",
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
    """Draw the MAC as a heat map."""
    text = [[f"{x:.2f}" if x >= _LEAST_SHOWN else "" for x in row] for row in value.values]
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
    """Draw derivatives over retained modes, with ±10 % of the full model (Fig. 13)."""
    selected = [name for name in names if name in value.full]
    if not selected:
        return empty("No such derivative")
    counts = [len(step.modes) for step in value.steps]
    domains = rows([1.0] * len(selected))
    data: list[Spec] = []
    layout: Spec = {"shapes": [], "meta": {"rows": max(2, len(selected))}}
    for index, name in enumerate(selected):
        y = "y" if index == 0 else f"y{index + 1}"
        full = value.full[name]
        for kind, colour, symbol, dash in (
            ("residualized", style.BLUE, "circle", "solid"),
            ("truncated", style.VERMILION, "square", "dot"),
        ):
            values = [getattr(step, kind)[name] for step in value.steps]
            hover = "%{x} modes retained"
            data.append(
                {"type": "scatter", "mode": "lines+markers", "x": counts, "y": values,
                 "yaxis": y, "name": kind.replace("ized", "ised"), "legendgroup": kind,
                 "showlegend": index == 0,
                 "line": {"color": colour, "dash": dash},
                 "marker": {"symbol": symbol, "size": 7},
                 "hovertemplate": f"{name} %{{y:.4g}}<br>{hover}<extra>{kind}</extra>"}
            )  # fmt: skip
        layout["shapes"].append(
            {"type": "rect", "xref": "paper", "x0": 0, "x1": 1, "yref": y,
             "y0": 0.9 * full, "y1": 1.1 * full, "line": {"width": 0},
             "fillcolor": "rgba(0,158,115,0.18)", "layer": "below"}
        )  # fmt: skip
        key = "yaxis" if index == 0 else f"yaxis{index + 1}"
        layout[key] = {**title(name), "domain": domains[index], "automargin": True}
    layout["xaxis"] = {
        **title("Retained structural modes"),
        "anchor": f"y{len(selected)}" if len(selected) > 1 else "y",
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
    """Draw a response of the full, reduced and rigid-sensor models (Fig. 11)."""
    top, bottom = rows([2, 1])
    data: list[Spec] = []
    for index, (name, values) in enumerate(value.curves):
        colour, _ = style.of_index(index - 1) if index else (style.GREY, "circle")
        width = 4 if index == 0 else 1.5
        dash = "dot" if index == len(value.curves) - 1 else "solid"
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
    """Draw the stabilisation diagram: poles by model order, over the mean response."""
    size = np.maximum(value.magnitude, 1e-30)
    data: list[Spec] = [
        {"type": "scatter", "mode": "lines", "name": "measured", "yaxis": "y2",
         "x": column(value.frequency_hz, exact=True), "y": column(20.0 * np.log10(size)),
         "line": {"color": style.MEASURED, "width": 1.5}, "hoverinfo": "skip"},
    ]  # fmt: skip
    if np.isfinite(value.fitted).all():
        data.append(
            {"type": "scatter", "mode": "lines", "name": "fitted", "yaxis": "y2",
             "x": column(value.frequency_hz, exact=True),
             "y": column(20.0 * np.log10(np.maximum(value.fitted, 1e-30))),
             "line": {"color": style.BLUE, "width": 1.2}, "hoverinfo": "skip"}
        )  # fmt: skip
    half = value.stable_frequency & ~value.stable
    for name, selected, colour, symbol, points in (
        ("new pole", ~value.stable & ~half, style.GREY, "x-thin-open", 5),
        ("stable frequency", half, style.OCHRE, "triangle-up-open", 6),
        ("stable", value.stable, style.GREEN, "circle", 6),
    ):
        hover = "%{x:.3f} Hz<br>damping %{customdata:.2f} %<br>order %{y}<extra></extra>"
        data.append(
            {"type": "scatter", "mode": "markers", "name": name,
             "x": column(value.pole_hz[selected], exact=True),
             "y": column(value.pole_order[selected]),
             "customdata": [100.0 * float(d) for d in value.pole_damping[selected]],
             "marker": {"color": colour, "symbol": symbol, "size": points},
             "hovertemplate": hover}
        )  # fmt: skip
    marks = [vertical_mark(float(hertz), f"{hertz:.2f}") for hertz in value.mode_hz]
    stagger([annotation for _, annotation in marks])
    layout: Spec = {
        "meta": {"rows": 3},
        "xaxis": title("Frequency [Hz]"),
        "yaxis": title("Model order"),
        "yaxis2": {**title(f"Mean {value.quantity}/force [dB]"), "overlaying": "y",
                   "side": "right", "showgrid": False, "tickmode": "auto"},
        "shapes": [shape for shape, _ in marks],
        "annotations": [annotation for _, annotation in marks],
    }  # fmt: skip
    return {"data": data, "layout": layout}
