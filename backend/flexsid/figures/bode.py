"""Frequency responses: magnitude over phase per output, inputs overlaid (Figs 5, 6, 11 and 15)."""

from __future__ import annotations

from typing import Literal

import numpy as np

from flexsid.figures import quantities, style
from flexsid.figures.spec import (
    Spec,
    axis,
    column,
    empty,
    layout_key,
    rows,
    stagger,
    title,
    vertical_mark,
)
from flexsid.records.views import Bode, Response

View = Literal["bode", "nichols", "nyquist"]

_DASHES = ("solid", "dash", "dot", "dashdot")
_RIGID_DASH = "longdashdot"
_DB = 20.0 / np.log(10.0)  # dB per unit of relative change
_N_SIGMA = 2.0
_MOST_LISTED = 400


def bode(value: Bode, view: View = "bode") -> Spec:
    """Draw measured responses as markers with ±2 standard errors, models as curves.

    ``nichols`` draws magnitude over phase, ``nyquist`` the complex plane.
    """
    shown = value.measured + value.models
    outputs = tuple(dict.fromkeys(response.output for response in shown))
    if not outputs:
        return empty("No frequency response: select an output and an excited input")
    bode_plane = view == "bode"
    coherent = any(response.coherence is not None for response in value.measured)
    per_output = 1 if not bode_plane else 3 if coherent else 2
    if bode_plane:
        layout = _layout(outputs, value, per_output)
    else:
        layout = _plane_layout(outputs, value, view)
    layout["meta"] = {
        "rows": per_output * len(outputs) * (1 if view == "bode" else 2),
        "blanked": _blanked(value),
        "agreement": value.agreement,
    }
    data: list[Spec] = []
    for response in shown:
        first = per_output * outputs.index(response.output) + 1
        drawing = _select_style(response, value)
        if view == "bode":
            data += _pair(response, first, drawing)
            if response.coherence is not None:
                data.append(_coherence(response, first, drawing))
        else:
            data.append(_locus(response, first, drawing, view))
    return {"data": data, "layout": layout}


def _blanked(value: Bode) -> list[Spec]:
    return [
        {
            "output": response.output,
            "input": response.input,
            "maneuver_id": response.maneuver_id,
            "frequency_hz": point.frequency_hz,
            "reason": point.reason,
        }
        for response in value.measured
        for point in response.blanked
    ][:_MOST_LISTED]


def _layout(outputs: tuple[str, ...], value: Bode, per_output: int) -> Spec:
    count = per_output * len(outputs)
    layout: Spec = {
        "xaxis": {**title("Frequency [Hz]"), "type": "log", "anchor": axis(count)},
        "showlegend": True,
        "hovermode": "closest",
    }
    domains = rows([1.4, 1.0, 0.6][:per_output] * len(outputs))
    for index, name in enumerate(outputs):
        shown = [r for r in value.measured + value.models if r.output == name]
        first = per_output * index
        layout[layout_key(first + 1)] = {
            **title(_magnitude_title(name, shown)),
            "domain": domains[first],
        }
        layout[layout_key(first + 2)] = {
            **title("Phase [deg]"),
            "domain": domains[first + 1],
            "dtick": _phase_step(shown),
        }
        if per_output == 3:
            layout[layout_key(first + 3)] = {
                **title("Coherence"),
                "domain": domains[first + 2],
                "range": [0, 1.05],
            }
    layout["shapes"], layout["annotations"] = [], []
    for mode in value.modes:
        shape, name = vertical_mark(mode.frequency_hz, quantities.text(mode.name), log=True)
        if mode.run_id is not None:
            shape["line"] |= {"color": style.VERMILION, "dash": "dash"}
            name["font"] = {"size": 11, "color": style.VERMILION}
        layout["shapes"].append(shape)
        layout["annotations"].append(name)
    stagger(layout["annotations"])
    return layout


def _magnitude_title(name: str, shown: list[Response]) -> str:
    inputs = {_over(response) for response in shown}
    output = quantities.of_channel(name, shown[0].output_unit)
    over = inputs.pop() if len(inputs) == 1 else "input unit"
    return f"|{output.label}/δ|<br>[dB re {quantities.per(output.unit, over)}]"


def _plane_layout(outputs: tuple[str, ...], value: Bode, view: View) -> Spec:
    """Lay out one plane per output, each with its own axes."""
    layout: Spec = {"showlegend": True, "hovermode": "closest"}
    for index, domain in enumerate(rows([1.0] * len(outputs))):
        name, number = outputs[index], index + 1
        shown = [r for r in value.measured + value.models if r.output == name]
        across, up = "Phase [deg]", _magnitude_title(name, shown)
        if view == "nyquist":
            output = quantities.of_channel(name, shown[0].output_unit)
            unit = quantities.per(output.unit, _over(shown[0]))
            across, up = f"Re({output.label}/δ) [{unit}]", f"Im({output.label}/δ)<br>[{unit}]"
        layout[layout_key(number, "x")] = {**title(across), "anchor": axis(number)}
        layout[layout_key(number)] = {
            **title(up),
            "domain": domain,
            "anchor": axis(number, "x"),
        }
        if view == "nyquist":  # equal scales
            layout[layout_key(number)] |= {"scaleanchor": axis(number, "x")}
    return layout


def _phase_step(shown: list[Response]) -> float:
    """Return the tick distance in degrees for about five ticks."""
    phases = np.rad2deg(np.concatenate([response.phase_rad for response in shown]))
    span = float(np.ptp(phases[np.isfinite(phases)])) if np.isfinite(phases).any() else 0.0
    return next((step for step in (45.0, 90.0, 180.0) if span <= 5 * step), 360.0)


def _over(response: Response) -> str:
    return quantities.of_channel(response.input, response.input_unit).unit


def _select_style(response: Response, value: Bode) -> Spec:
    """Select style: colour by input, symbol by maneuver, dash by run."""
    colour, symbol = style.of_inputs(value.inputs).get(response.input, style.of_index(0))
    if response.run_id is None:
        flown = tuple(dict.fromkeys(r.maneuver_id for r in value.measured))
        if len(flown) > 1:
            _, symbol = style.of_index(flown.index(response.maneuver_id))
        return {"mode": "markers", "marker": {"color": colour, "symbol": symbol, "size": 5}}
    runs = tuple(dict.fromkeys(model.run_id for model in value.models))
    dash = _RIGID_DASH if response.rigid else _DASHES[runs.index(response.run_id) % len(_DASHES)]
    width = 1.2 if response.rigid else 1.8
    return {"mode": "lines", "line": {"color": colour, "dash": dash, "width": width}}


def _shared(response: Response, first: int, drawing: Spec) -> Spec:
    name = quantities.of_channel(response.input).label
    if response.label:
        name = f"{name} {quantities.text(response.label)}"
    return {
        "type": "scatter",
        "name": name,
        "legendgroup": f"{response.input} {response.run_id} {response.label}",
        "showlegend": first == 1,
        "yaxis": axis(first),
        "meta": {"output": response.output, "input": response.input, "run_id": response.run_id},
        **drawing,
    }


def _blank(response: Response, values: np.ndarray) -> np.ndarray:
    """Replace blanked points by NaN."""
    blanked = np.isin(response.frequency_hz, [point.frequency_hz for point in response.blanked])
    return np.where(blanked, np.nan, values)


def _pair(response: Response, first: int, drawing: Spec) -> list[Spec]:
    factor, unit = _scale(response)
    with np.errstate(divide="ignore"):
        decibel = _blank(response, 20.0 * np.log10(response.magnitude * factor))
    degrees = _blank(response, np.rad2deg(response.phase_rad))
    shared = _shared(response, first, drawing) | {"x": column(response.frequency_hz, exact=True)}
    name = shared["name"]
    pair: list[Spec] = [
        {
            **shared,
            "y": column(decibel),
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
    if response.relative_std is not None and response.run_id is None:
        reach = np.nan_to_num(_blank(response, _N_SIGMA * response.relative_std), posinf=0.0)
        colour = drawing["marker"]["color"]
        for trace, size in zip(pair, (_DB * reach, np.rad2deg(reach)), strict=True):
            trace["error_y"] = {
                "type": "data", "array": column(size), "color": colour,
                "thickness": 1, "width": 0,
            }  # fmt: skip
    return pair


def _coherence(response: Response, first: int, drawing: Spec) -> Spec:
    """Draw coherence, also where the response is blanked."""
    assert response.coherence is not None
    shared = _shared(response, first, drawing)
    return {
        **shared,
        "x": column(response.frequency_hz, exact=True),
        "y": column(response.coherence),
        "yaxis": axis(first + 2),
        "showlegend": False,
        "hovertemplate": f"%{{x:.3f}} Hz<br>%{{y:.2f}}<extra>{shared['name']}</extra>",
    }


def _locus(response: Response, number: int, drawing: Spec, view: View) -> Spec:
    """Draw a response in a plane in order of frequency, with frequency in the hover text."""
    factor, unit = _scale(response)
    size = _blank(response, response.magnitude * factor)
    if view == "nyquist":
        x, y = size * np.cos(response.phase_rad), size * np.sin(response.phase_rad)
        text = f"%{{x:.3g}}, %{{y:.3g}} {unit}"
    else:
        with np.errstate(divide="ignore"):
            x, y = np.rad2deg(response.phase_rad), 20.0 * np.log10(size)
        text = f"%{{x:.1f}} deg, %{{y:.1f}} dB re {unit}"
    shared = _shared(response, number, drawing)
    if response.run_id is None:
        shared |= {"mode": "lines+markers", "line": {"width": 0.6}}
    return {
        **shared,
        "x": column(x),
        "y": column(y),
        "xaxis": axis(number, "x"),
        "customdata": [round(f, 4) for f in response.frequency_hz.tolist()],
        "hovertemplate": f"%{{customdata}} Hz<br>{text}<extra>{shared['name']}</extra>",
    }


def _scale(response: Response) -> tuple[float, str]:
    shown = quantities.ratio(
        quantities.of_channel(response.output, response.output_unit),
        quantities.of_channel(response.input, response.input_unit),
    )
    return shown.factor, shown.unit
