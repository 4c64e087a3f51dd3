"""Modal data: modes over fuel, MAC, model order, stabilisation, ground records (Fig. 10)."""

from __future__ import annotations

import numpy as np

from flexsid.figures import quantities, style
from flexsid.figures.quantities import of_unit
from flexsid.figures.spec import (
    Spec,
    axis,
    band,
    column,
    empty,
    error_bars,
    heatmap,
    line_at,
    marked,
    plane,
    scatter,
    stack,
    title,
    vertical_mark,
)
from flexsid.records.modal_data import (
    AssuranceMatrix,
    ModelOrder,
    ModesAgainstFuel,
    ReducedResponses,
    ResponseFunction,
    Stabilisation,
)
from flexsid.records.views import GroundSpectra, OutputOnlyResult

# --- Modal data: modes over fuel, MAC, model order, reduced responses, stabilisation diagram ------

_LEAST_SHOWN = 0.05
_DASHES = {True: "solid", False: "dash", None: "dot"}  # symmetric, antisymmetric, not known


def draw_modes_against_fuel(value: ModesAgainstFuel) -> Spec:
    """Draw frequencies and damping of the modes over fuel, with crossings circled."""
    frequency = of_unit("Frequency", "Hz")
    data: list[Spec] = []
    over_fuel = "lines" if value.fuel.size > 1 else "markers"
    for index, name in enumerate(value.names):
        colour, _ = style.of_index(index)
        dash = _DASHES[value.symmetric[index]]
        shared: Spec = {"name": name, "legendgroup": name}
        line = {"color": colour, "width": 1.5, "dash": dash}
        hover = f"{name}<br>fuel %{{x:.3f}}<br>%{{y:.3f}} {frequency.unit}<extra></extra>"
        data += [
            scatter(
                value.fuel, column(frequency.factor * value.frequency_hz[:, index], exact=True),
                "lines",
                showlegend=True, line=line, hovertemplate=hover, **shared,
            ),
            scatter(
                value.table_fuel, column(frequency.factor * value.table_hz[:, index], exact=True),
                showlegend=False,
                marker={"color": colour, "size": 4}, hovertemplate=hover, **shared,
            ),
        ]  # fmt: skip
        if np.isfinite(value.damping[:, index]).any():
            hover = f"{name}<br>fuel %{{x:.3f}}<br>%{{y:.2f}} %<extra></extra>"
            data.append(
                scatter(
                    value.fuel, 100.0 * value.damping[:, index], over_fuel, row=2,
                    showlegend=False, line=line, marker={"color": colour, "size": 4},
                    hovertemplate=hover, **shared,
                )
            )  # fmt: skip
    ring = {"symbol": "circle-open", "size": 14, "color": style.FLAG, "line": {"width": 2}}
    if value.crossings:
        data.append(
            scatter(
                [mark.fuel for mark in value.crossings],
                [frequency.factor * mark.frequency_hz for mark in value.crossings],
                name="crossing",
                text=[" × ".join(mark.names) for mark in value.crossings],
                marker=ring,
                hovertemplate=f"%{{text}}<br>fuel %{{x:.3f}}<br>%{{y:.2f}} {frequency.unit}"
                "<extra>crossing</extra>",
            )
        )
    if value.uncertain:
        data.append(
            scatter(
                [fuel for fuel, _ in value.uncertain],
                [frequency.factor * hertz for _, hertz in value.uncertain],
                name="low MAC",
                marker={"symbol": "x-open", "size": 11, "color": style.FLAG},
                hovertemplate="fuel %{x:.3f}: low MAC, tracking uncertain<extra></extra>",
            )
        )
    titles = (frequency.axis_title, "Damping ratio [%]")
    axes = [{**title(text), "rangemode": "tozero"} for text in titles]
    fuel = {**title("Fuel fraction"), "range": [-0.02, 1.02]}
    layout = stack(fuel, axes, [3, 1], meta={"rows": 3})
    return {"data": data, "layout": layout}


def draw_assurance(value: AssuranceMatrix) -> Spec:
    """Draw the MAC as a heat map."""
    columns, rows = list(range(len(value.columns))), list(range(len(value.rows)))
    trace = heatmap(
        columns,
        rows,
        value.values,
        zmin=0.0,
        zmax=1.0,
        colorscale=[[0.0, "#f4f6f8"], [0.5, "#7fb3dd"], [1.0, "#0b3d66"]],
        colorbar=title("MAC"),
        customdata=[[[r, c] for c in value.columns] for r in value.rows],
        hovertemplate="%{customdata[0]} with %{customdata[1]}<br>MAC %{z:.4f}<extra></extra>",
    )
    if max(value.values.shape) <= 16:
        text = [[f"{x:.2f}" if x >= _LEAST_SHOWN else "" for x in row] for row in value.values]
        trace |= {"text": text, "texttemplate": "%{text}"}
    ticks = {"tickmode": "array", "automargin": True}
    layout = {
        "xaxis": {**title(value.column_title), **ticks, "tickangle": -45,
                  "tickvals": columns, "ticktext": list(value.columns)},
        "yaxis": {**title(value.row_title), **ticks, "autorange": "reversed",
                  "tickvals": rows, "ticktext": list(value.rows)},
    }  # fmt: skip
    return {"data": [trace], "layout": layout}


def draw_model_order(value: ModelOrder, derivatives: tuple[str, ...]) -> Spec:
    """Draw derivatives over retained modes, with ±10 % of the full model (Fig. 13)."""
    selected = [name for name in derivatives if name in value.full]
    if not selected:
        return empty("No such derivative")
    counts = [len(step.modes) for step in value.steps]
    data: list[Spec] = []
    shapes: list[Spec] = []
    for row, name in enumerate(selected, start=1):
        for kind, colour, symbol, dash in (
            ("residualized", style.BLUE, "circle", "solid"),
            ("truncated", style.VERMILION, "square", "dot"),
        ):
            data.append(
                scatter(
                    counts,
                    [getattr(step, kind)[name] for step in value.steps],
                    "lines+markers",
                    row=row,
                    name=kind.replace("ized", "ised"),
                    legendgroup=kind,
                    showlegend=row == 1,
                    line={"color": colour, "dash": dash},
                    marker={"symbol": symbol, "size": 7},
                    hovertemplate=f"{style.parameter_label(name)} %{{y:.4g}}<br>"
                    "%{x} modes retained"
                    f"<extra>{kind}</extra>",
                )
            )
        full, green = value.full[name], "rgba(0,158,115,0.18)"
        shapes.append(band(0.9 * full, 1.1 * full, green, letter="y", yref=axis(row)))
    needed = {"color": style.GREEN, "dash": "dash", "width": 1.5}
    shapes.append(line_at(value.needed, line=needed, layer="above"))
    ticks = [f"{len(s.modes)}<br>{s.names[-1]}" if s.names else "0<br>SP" for s in value.steps]
    layout = stack(
        {
            **title("Retained structural modes"),
            "tickmode": "array",
            "tickvals": counts,
            "ticktext": ticks,
        },
        [{**title(style.format_axis_title(name)), "automargin": True} for name in selected],
        shapes=shapes,
        meta={"rows": max(2, len(selected))},
    )
    return {"data": data, "layout": layout}


def draw_reduced_responses(value: ReducedResponses) -> Spec:
    """Draw a response of the full, reduced and rigid-sensor models (Fig. 11)."""
    frequency = of_unit("Frequency", "Hz")
    x = frequency.factor * value.frequency_hz
    data: list[Spec] = []
    for index, (name, values) in enumerate(value.curves):
        line = {
            "color": style.of_index(index - 1)[0] if index else style.GREY,
            "width": 1.5 if index else 4,
            "dash": "dot" if index == len(value.curves) - 1 else "solid",
        }
        shared = {"line": line, "name": name, "legendgroup": name}
        hover = f"{name}<br>%{{x:.2f}} {frequency.unit}<br>%{{y:"
        data += [
            scatter(
                x, 20.0 * np.log10(np.maximum(np.abs(values), 1e-12)), "lines",
                hovertemplate=f"{hover}.1f}} dB<extra></extra>", **shared,
            ),
            scatter(
                x, np.degrees(np.unwrap(np.angle(values))), "lines", row=2,
                showlegend=False, hovertemplate=f"{hover}.0f}}°<extra></extra>", **shared,
            ),
        ]  # fmt: skip
    titles = (f"|{value.output}/{value.input}| [dB, {value.unit}]", "Phase [deg]")
    layout = stack({**title(frequency.axis_title), "type": "log"}, list(map(title, titles)), [2, 1])
    del layout["meta"]  # the default height
    return {"data": data, "layout": layout}


def draw_measured_response(value: ResponseFunction) -> Spec:
    """Draw magnitude, phase and coherence of a measured response over frequency."""
    frequency = of_unit("Frequency", "Hz")
    x = column(frequency.factor * value.frequency_hz, exact=True)
    response = value.real + 1j * value.imaginary
    curves: list[tuple[int, str, np.ndarray | None, str]] = [
        (1, "measured", _to_decibel(np.abs(response)), style.MEASURED),
        (1, "standard deviation", _to_decibel(value.std), style.VERMILION),
        (2, "phase", np.degrees(np.angle(response)), style.MEASURED),
        (3, "multiple coherence", value.multiple_coherence, style.BLUE),
        (3, "ordinary coherence", value.ordinary_coherence, style.OCHRE),
    ]
    data = [
        scatter(
            x,
            numbers,
            "lines",
            row=row,
            name=name,
            line={"color": colour, "width": 1.2},
            hovertemplate=f"%{{x:.3f}} {frequency.unit}<br>%{{y:.4g}}<extra>{name}</extra>",
        )
        for row, name, numbers, colour in curves
        if numbers is not None
    ]
    axes = [title(f"{value.quantity.capitalize()}/force [dB]"), title("Phase [deg]")]
    if value.multiple_coherence is not None:
        axes.append({**title("Coherence"), "range": [0.0, 1.05]})
    layout = stack(title(frequency.axis_title), axes, [2.0, 1.0, 1.0][: len(axes)], showlegend=True)
    return {"data": data, "layout": layout}


def _to_decibel(magnitude: np.ndarray | None) -> np.ndarray | None:
    return None if magnitude is None else 20.0 * np.log10(np.maximum(magnitude, 1e-30))


def draw_stabilisation(value: Stabilisation) -> Spec:
    """Draw the stabilisation diagram: poles by model order, over the mean response."""
    frequency = of_unit("Frequency", "Hz")
    data: list[Spec] = []
    for name, magnitude, line in (
        ("measured", value.magnitude, {"color": style.MEASURED, "width": 1.5}),
        ("fitted", value.fitted, {"color": style.BLUE, "width": 1.2}),
    ):
        if name == "measured" or np.isfinite(magnitude).all():
            decibel = 20.0 * np.log10(np.maximum(magnitude, 1e-30))
            x = column(frequency.factor * value.frequency_hz, exact=True)
            data.append(scatter(x, decibel, "lines", row=2, name=name, line=line, hoverinfo="skip"))
    for index, singular in enumerate(value.indicator.T):
        decibel = 20.0 * np.log10(np.maximum(singular, 1e-30))
        x = column(frequency.factor * value.frequency_hz, exact=True)
        line = {"color": style.of_index(index)[0], "width": 1.2}
        name = "mode indicator" if index == 0 else f"mode indicator {index + 1}"
        data.append(
            scatter(
                x, decibel, "lines", row=2, name=name, line=line, hoverinfo="skip",
                visible="legendonly",
            )
        )  # fmt: skip
    half = value.stable_frequency & ~value.stable
    for name, selected, colour, symbol, size in (
        ("new pole", ~value.stable & ~half, style.GREY, "x-thin-open", 5),
        ("stable frequency", half, style.OCHRE, "triangle-up-open", 6),
        ("stable", value.stable, style.GREEN, "circle", 6),
    ):
        data.append(
            scatter(
                column(frequency.factor * value.pole_hz[selected], exact=True),
                value.pole_order[selected],
                name=name,
                customdata=[
                    [int(at) + 1, 100.0 * float(value.pole_damping[at])]
                    for at in np.flatnonzero(selected)
                ],
                marker={"color": colour, "symbol": symbol, "size": size},
                hovertemplate=f"%{{x:.3f}} {frequency.unit}<br>damping %{{customdata[1]:.2f}} %<br>"
                "order %{y}"
                "<extra></extra>",
            )
        )
    if value.selected:
        at = np.array(value.selected) - 1
        data.append(
            scatter(
                column(frequency.factor * value.pole_hz[at], exact=True),
                value.pole_order[at],
                name="selected by hand",
                marker={"color": style.VERMILION, "symbol": "circle-open", "size": 12},
                hoverinfo="skip",
            )
        )
    layout: Spec = {
        "meta": {"rows": 3},
        "xaxis": title(frequency.axis_title),
        "yaxis": title("Model order"),
        "yaxis2": {**title(f"Mean {value.quantity}/force [dB]"), "overlaying": "y",
                   "side": "right", "showgrid": False, "tickmode": "auto"},
        **marked(
            [vertical_mark(float(at), f"{at:.2f}") for at in frequency.factor * value.mode_hz]
            + [
                vertical_mark(float(at), "not modelled")
                for at in frequency.factor * np.asarray(value.unmodelled_hz)
            ],
            data,
        ),
    }  # fmt: skip
    return {"data": data, "layout": layout}


# --- Modes from outputs alone: density with the fitted model, damping over frequency --------------


def draw_output_only(value: OutputOnlyResult) -> Spec:
    """Draw the density of the outputs with that of the model, and damping with ±2 std errors."""
    frequency = of_unit("Frequency", "Hz")
    shown = column(frequency.factor * np.array(value.frequency_hz), exact=True)
    measured, fitted = (
        10.0 * np.log10(np.maximum(density, 1e-30)) for density in (value.measured, value.fitted)
    )
    modes = value.modes
    at = frequency.factor * np.array([mode.frequency_hz for mode in modes])
    std = frequency.factor * np.array([mode.frequency_std_hz for mode in modes])
    dot = {"color": style.MEASURED, "size": 3}
    line = {"color": style.BLUE, "width": 1.5}
    data = [
        scatter(shown, measured, name="measured", marker=dot, hoverinfo="skip"),
        scatter(shown, fitted, "lines", name="fitted", line=line, hoverinfo="skip"),
        scatter(
            at,
            100.0 * np.array([mode.damping for mode in modes]),
            row=2,
            name="modes, ±2σ",
            text=[mode.name or "not named" for mode in modes],
            marker={"color": style.BLUE, "size": 7},
            error_x=error_bars(std, style.BLUE),
            error_y=error_bars(100.0 * np.array([m.damping_std for m in modes]), style.BLUE),
            hovertemplate=f"%{{text}}<br>%{{x:.3f}} {frequency.unit}<br>%{{y:.2f}} %"
            "<extra></extra>",
        ),
    ]
    marks = [vertical_mark(float(x), mode.name) for x, mode in zip(at, modes, strict=True)]
    marks += [vertical_mark(frequency.factor * tone, "tone") for tone in value.tones_hz]
    axes = [title("Mean density / variance [dB(1/Hz)]"), title("Damping ratio [%]")]
    axes[1]["rangemode"] = "tozero"
    drawn = marked(marks, data)
    layout = stack(title(frequency.axis_title), axes, [3, 2], meta={"rows": 4}, **drawn)
    return {"data": data, "layout": layout}


# --- Spectra on the runway before and after a flight, with expected modes (Fig. 10) ---------------


def draw_ground_test(value: GroundSpectra) -> Spec:
    """Draw response power of all gauges and accelerometers over excitation power."""
    shown = quantities.of_unit("Frequency", "Hz")
    data = []
    for name, (frequency, power), colour, symbol in (
        ("before flight", value.before, style.BLUE, "circle"),
        ("after flight", value.after, style.VERMILION, "square"),
    ):
        with np.errstate(divide="ignore"):
            decibel = 10.0 * np.log10(power)
        data.append(
            scatter(
                column(shown.factor * frequency, exact=True),
                decibel,
                "lines+markers",
                name=name,
                line={"color": colour, "width": 1.2},
                marker={"color": colour, "symbol": symbol, "size": 4},
                hovertemplate=f"%{{x:.3f}} {shown.unit}<br>%{{y:.1f}} dB<extra>{name}</extra>",
            )
        )
    layout = plane(
        title(shown.axis_title),
        title("Response/excitation power,<br>all channels [dB]"),
        2,
        **marked(
            [
                vertical_mark(shown.factor * m.frequency_hz, quantities.text(m.name))
                for m in value.expected
            ],
            data,
        ),
    )
    return {"data": data, "layout": layout}
