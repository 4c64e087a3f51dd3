"""Frequency responses: magnitude over phase per output, inputs overlaid (Figs 5, 6 and 15)."""

from __future__ import annotations

import numpy as np

from flexsid.figures import quantities, style
from flexsid.figures.spec import Spec, axis, column, empty, layout_key, rows, title, vertical_mark
from flexsid.records.views import Bode, Response

_DASHES = ("solid", "dash", "dot", "dashdot")
_DB = 20.0 / np.log(10.0)  # dB per unit of relative change
_POOR = 0.3  # relative standard error beyond which a line says little
_N_SIGMA = 2.0


def bode(value: Bode) -> Spec:
    """Draw measured responses as markers with ±2 standard errors, models as lines."""
    shown = value.measured + value.models
    outputs = tuple(dict.fromkeys(response.output for response in shown))
    if not outputs:
        return empty("No frequency response: choose an output and an input that was excited")
    layout = _layout(outputs, value)
    looks = style.of_inputs(value.inputs)
    run_ids = tuple(dict.fromkeys(model.run_id for model in value.models))
    data: list[Spec] = []
    for response in shown:
        first = 2 * outputs.index(response.output) + 1
        legend = first == 1
        if response.run_id is None:
            data += _measured(response, first, legend, looks.get(response.input, style.of_index(0)))
        else:
            colour, _ = looks.get(response.input, style.of_index(0))
            dash = _DASHES[run_ids.index(response.run_id) % len(_DASHES)]
            data += _model(response, first, legend, {"color": colour, "dash": dash, "width": 1.8})
    return {"data": data, "layout": layout}


def _layout(outputs: tuple[str, ...], value: Bode) -> Spec:
    count = 2 * len(outputs)
    layout: Spec = {
        "xaxis": {**title("Frequency [Hz]"), "type": "log", "anchor": axis(count)},
        "showlegend": True,
        "hovermode": "closest",
        "meta": {"rows": count},
    }
    domains = rows([1.4, 1.0] * len(outputs))
    for index, name in enumerate(outputs):
        shown = [r for r in value.measured + value.models if r.output == name]
        inputs = {_over(response) for response in shown}
        output = quantities.of_channel(name, shown[0].output_unit)
        over = inputs.pop() if len(inputs) == 1 else "input unit"
        layout[layout_key(2 * index + 1)] = {
            **title(f"|{output.label}/δ|<br>[dB re {quantities.per(output.unit, over)}]"),
            "domain": domains[2 * index],
        }
        layout[layout_key(2 * index + 2)] = {
            **title("Phase [deg]"),
            "domain": domains[2 * index + 1],
            "dtick": _phase_step(shown),
        }
    marks = [
        vertical_mark(mode.frequency_hz, quantities.text(mode.name), log=True)
        for mode in value.modes
    ]
    layout["shapes"] = [shape for shape, _ in marks]
    layout["annotations"] = [name for _, name in marks]
    return layout


def _phase_step(shown: list[Response]) -> float:
    """Degrees between ticks: whole fractions of a turn, about five in view."""
    phases = np.rad2deg(np.concatenate([response.phase_rad for response in shown]))
    span = float(np.ptp(phases[np.isfinite(phases)])) if np.isfinite(phases).any() else 0.0
    return next((step for step in (45.0, 90.0, 180.0) if span <= 5 * step), 360.0)


def _over(response: Response) -> str:
    return quantities.of_channel(response.input, response.input_unit).unit


def _curves(response: Response) -> tuple[np.ndarray, np.ndarray, str]:
    shown = quantities.ratio(
        quantities.of_channel(response.output, response.output_unit),
        quantities.of_channel(response.input, response.input_unit),
    )
    with np.errstate(divide="ignore"):
        decibel = 20.0 * np.log10(response.magnitude * shown.factor)
    return decibel, np.rad2deg(response.phase_rad), shown.unit


def _pair(response: Response, first: int, legend: bool, drawing: Spec) -> list[Spec]:
    decibel, degrees, unit = _curves(response)
    name = quantities.of_channel(response.input).label
    if response.run_id is not None:
        name = f"{name} {quantities.text(response.label)}"
    shared = {
        "type": "scatter",
        "name": name,
        "legendgroup": f"{response.input} {response.run_id}",
        "x": column(response.frequency_hz, exact=True),
        "meta": {"output": response.output, "input": response.input, "run_id": response.run_id},
        **drawing,
    }
    return [
        {
            **shared,
            "y": column(decibel),
            "yaxis": axis(first),
            "showlegend": legend,
            "hovertemplate": f"%{{x:.3f}} Hz<br>%{{y:.1f}} dB re {unit}<extra>{name}</extra>",
        },
        {
            **shared,
            "y": column(degrees),
            "yaxis": axis(first + 1),
            "showlegend": False,
            "hovertemplate": f"%{{x:.3f}} Hz<br>%{{y:.1f}} deg<extra>{name}</extra>",
        },
    ]


def _measured(response: Response, first: int, legend: bool, look: tuple[str, str]) -> list[Spec]:
    colour, symbol = look
    marker: Spec = {"color": colour, "symbol": symbol, "size": 5}
    relative = response.relative_std
    if relative is None:
        return _pair(response, first, legend, {"mode": "markers", "marker": marker})
    poor = ~(relative <= _POOR)
    marker["opacity"] = np.where(poor, 0.25, 1.0).tolist()
    pair = _pair(response, first, legend, {"mode": "markers", "marker": marker})
    reach = np.where(poor, 0.0, _N_SIGMA * relative)
    for trace, size in zip(pair, (_DB * reach, np.rad2deg(reach)), strict=True):
        trace["error_y"] = {
            "type": "data", "array": column(size), "color": colour, "thickness": 1, "width": 0,
        }  # fmt: skip
    return pair


def _model(response: Response, first: int, legend: bool, line: Spec) -> list[Spec]:
    return _pair(response, first, legend, {"mode": "lines", "line": line})
