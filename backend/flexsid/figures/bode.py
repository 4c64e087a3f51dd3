"""Frequency responses and fits: magnitude over phase per output (Figs 5, 6, 11, 12, 14 and 15)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Literal

import numpy as np

from flexsid.figures import quantities, style
from flexsid.figures.spec import (
    N_SIGMA,
    Spec,
    axis,
    column,
    empty,
    error_bars,
    layout_key,
    marked,
    rows,
    scatter,
    stack,
    text_at,
    title,
    vertical_mark,
)
from flexsid.nomenclature import describe
from flexsid.records.run import Method
from flexsid.records.views import Bode, FitPlot, FitTrace, NoiseShares, Response

# --- Frequency responses: magnitude over phase per output, inputs overlaid (Figs 5, 6, 11 and 15)

View = Literal["bode", "nichols", "nyquist"]
AxisScale = Literal["log", "linear"]
MagnitudeScale = Literal["dB", "log", "linear"]

_DASHES = ("solid", "dash", "dot", "dashdot")
_RIGID_DASH = "longdashdot"
_DB = 20.0 / np.log(10.0)  # dB per unit of relative change
_MOST_LISTED = 400


def draw_bode(
    value: Bode,
    view: View = "bode",
    frequency_scale: AxisScale = "log",
    magnitude_scale: MagnitudeScale = "dB",
) -> Spec:
    """Draw measured responses as markers with ±2 standard errors, models as curves.

    ``nichols`` draws magnitude in dB over phase, ``nyquist`` the complex plane. The scales are
    those of a Bode plot, below which the shares of noise of a selected parameter stand.
    """
    responses = value.measured + value.models
    outputs = {
        output: [response for response in responses if response.output == output]
        for output in dict.fromkeys(response.output for response in responses)
    }
    if not outputs:
        return empty("No frequency response: select an output and an excited input")
    coherent = any(response.coherence is not None for response in value.measured)
    n_rows = 1 if view != "bode" else 3 if coherent else 2
    layout = (
        _lay_out_rows(outputs, value, coherent, frequency_scale, magnitude_scale)
        if view == "bode"
        else _lay_out_planes(outputs, view)
    )
    layout["meta"] = {
        "rows": n_rows * len(outputs) + bool(value.noise_shares)
        if view == "bode"
        else 2 * len(outputs),
        "blanked": _list_blanked(value),
        "agreement": value.agreement,
    }
    data: list[Spec] = []
    for response in responses:
        first = n_rows * list(outputs).index(response.output) + 1
        shared = _describe(response, first, value)
        if view == "bode":
            data += _draw_rows(response, first, shared, magnitude_scale)
        else:
            data.append(_draw_locus(response, first, shared, view))
    if view == "bode":
        last = n_rows * len(outputs) + 1
        data += [_draw_noise_shares(one, last) for one in value.noise_shares]
        is_log = frequency_scale == "log"
        layout |= marked(_mark_modes(value, is_log), data, log=is_log)
    return {"data": data, "layout": {**layout, "showlegend": True, "hovermode": "closest"}}


def _list_blanked(value: Bode) -> list[Spec]:
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


def _lay_out_rows(
    outputs: dict[str, list[Response]],
    value: Bode,
    coherent: bool,
    frequency_scale: AxisScale,
    magnitude_scale: MagnitudeScale,
) -> Spec:
    axes: list[Spec] = []
    for shown in outputs.values():
        up = {"type": "log"} if magnitude_scale == "log" else {}
        axes.append({**title(_format_magnitude(shown, magnitude_scale)), **up})
        axes.append({**title("Phase [deg]"), "dtick": _find_phase_step(shown)})
        if coherent:
            axes.append({**title("Coherence"), "range": [0, 1.05]})
    heights = [1.4, 1.0, *[0.6] * coherent] * len(outputs)
    if value.noise_shares:
        label = describe(value.noise_shares[0].name).html
        axes.append({**title(f"{label} noise<br>[%]"), "rangemode": "tozero"})
        heights.append(0.6)
    frequency = quantities.of_unit("Frequency", "Hz")
    return stack({**title(frequency.axis_title), "type": frequency_scale}, axes, heights)


def _mark_modes(value: Bode, is_log: bool) -> Iterator[tuple[Spec, Spec]]:
    """Mark modes of the modal table in grey, and those of runs in red."""
    factor = quantities.of_unit("Frequency", "Hz").factor
    for mode in value.modes:
        name = quantities.text(mode.name)
        shape, label = vertical_mark(factor * mode.frequency_hz, name, log=is_log)
        if mode.run_id is not None:
            shape["line"] |= {"color": style.VERMILION, "dash": "dash"}
            label["font"] = {"size": 11, "color": style.VERMILION}
        yield shape, label


def _lay_out_planes(outputs: dict[str, list[Response]], view: View) -> Spec:
    """Lay out one plane per output, each with its own axes."""
    layout: Spec = {}
    for number, (domain, (name, shown)) in enumerate(
        zip(rows([1.0] * len(outputs)), outputs.items(), strict=True), start=1
    ):
        across, up = "Phase [deg]", _format_magnitude(shown, "dB")
        scale = {}
        if view == "nyquist":
            output = quantities.of_channel(name, shown[0].output_unit)
            unit = quantities.per(output.unit, _get_input_unit(shown[0]))
            across, up = f"Re({output.label}/δ) [{unit}]", f"Im({output.label}/δ)<br>[{unit}]"
            scale = {"scaleanchor": axis(number, "x")}  # equal scales
        layout[layout_key(number, "x")] = {**title(across), "anchor": axis(number)}
        layout[layout_key(number)] = {
            **title(up), "domain": domain, "anchor": axis(number, "x"), **scale,
        }  # fmt: skip
    return layout


def _format_magnitude(shown: list[Response], scale: MagnitudeScale) -> str:
    units = {_get_input_unit(response) for response in shown}
    output = quantities.of_channel(shown[0].output, shown[0].output_unit)
    over = units.pop() if len(units) == 1 else "input unit"
    decibel = "dB re " if scale == "dB" else ""
    return f"|{output.label}/δ|<br>[{decibel}{quantities.per(output.unit, over)}]"


def _find_phase_step(shown: list[Response]) -> float:
    """Return the tick distance in degrees for about five ticks."""
    return _choose_phase_step(np.concatenate([response.phase_rad for response in shown]))


def _choose_phase_step(phase_rad: np.ndarray) -> float:
    phases = np.rad2deg(phase_rad)
    span = float(np.ptp(phases[np.isfinite(phases)])) if np.isfinite(phases).any() else 0.0
    return next((step for step in (45.0, 90.0, 180.0) if span <= 5 * step), 360.0)


def _get_input_unit(response: Response) -> str:
    return quantities.of_channel(response.input, response.input_unit).unit


def _describe(response: Response, first: int, value: Bode) -> Spec:
    """Return name, legend and style of the traces of a response."""
    name = quantities.of_channel(response.input).label
    if response.label:
        name = f"{name} {quantities.text(response.label)}"
    return {
        "name": name,
        "legendgroup": f"{response.input} {response.run_id} {response.label}",
        "showlegend": first == 1,
        "meta": {"output": response.output, "input": response.input, "run_id": response.run_id},
        **_select_style(response, value),
    }


def _select_style(response: Response, value: Bode) -> Spec:
    """Select style: colour by input, symbol by maneuver, dash by run."""
    colour, symbol = style.of_inputs(value.inputs).get(response.input, style.of_index(0))
    if not response.is_model:
        flown = tuple(dict.fromkeys(r.maneuver_id for r in value.measured))
        if len(flown) > 1:
            _, symbol = style.of_index(flown.index(response.maneuver_id))
        return {"mode": "markers", "marker": {"color": colour, "symbol": symbol, "size": 5}}
    runs = tuple(dict.fromkeys(model.run_id for model in value.models))
    dash = _RIGID_DASH if response.rigid else _DASHES[runs.index(response.run_id) % len(_DASHES)]
    width = 1.2 if response.rigid else 1.8
    return {"mode": "lines", "line": {"color": colour, "dash": dash, "width": width}}


def _draw_rows(response: Response, first: int, shared: Spec, scale: MagnitudeScale) -> list[Spec]:
    """Draw magnitude, phase and, where known, coherence; the latter also of blanked points."""
    factor, unit = _scale(response)
    frequency = quantities.of_unit("Frequency", "Hz")
    size = _blank(response, response.magnitude * factor)
    with np.errstate(divide="ignore"):
        decibel = 20.0 * np.log10(size)
    degrees = _blank(response, np.rad2deg(response.phase_rad))
    magnitude = (
        (decibel, f"%{{y:.1f}} dB re {unit}") if scale == "dB" else (size, f"%{{y:.4g}} {unit}")
    )
    drawn = [magnitude, (degrees, "%{y:.1f} deg")]
    if response.coherence is not None:
        drawn.append((response.coherence, "%{y:.2f}"))
    traces = [
        scatter(
            column(frequency.factor * response.frequency_hz, exact=True),
            values,
            row=row,
            **(shared | {"showlegend": row == 1}),
            hovertemplate=f"%{{x:.3f}} {frequency.unit}<br>{hover}<extra>{shared['name']}</extra>",
        )
        for row, (values, hover) in enumerate(drawn, start=first)
    ]
    if response.relative_std is not None and not response.is_model:
        reach = np.nan_to_num(_blank(response, N_SIGMA * response.relative_std), posinf=0.0)
        colour = shared["marker"]["color"]
        of_magnitude = _DB if scale == "dB" else size
        for trace, factor in zip(traces, (of_magnitude, np.rad2deg(1.0)), strict=False):
            errors = np.nan_to_num(factor * reach)
            trace["error_y"] = error_bars(errors, colour, 1.0, thickness=1, width=0)
    return traces


def _draw_noise_shares(value: NoiseShares, row: int) -> Spec:
    """Draw the share of each frequency as a line from zero."""
    frequency = quantities.of_unit("Frequency", "Hz")
    percent = 100.0 * value.shares
    bottom, gap = np.zeros_like(percent), np.full_like(percent, np.nan)
    label = describe(value.name).html
    return scatter(
        np.repeat(frequency.factor * value.frequency_hz, 3),
        np.stack([bottom, percent, gap], axis=1).reshape(-1),
        row=row,
        name=f"noise of {label}",
        mode="lines",
        line={"color": style.GREY, "width": 3},
        legendgroup=f"noise {value.run_id}",
        showlegend=False,
        meta={"parameter": value.name, "run_id": value.run_id},
        hovertemplate=f"%{{x:.3f}} {frequency.unit}<br>%{{y:.1f}} % of the noise variance"
        f"<extra>{label}, run {value.run_id}</extra>",
    )


def _draw_locus(response: Response, number: int, shared: Spec, view: View) -> Spec:
    """Draw a response in a plane in order of frequency, with frequency in the hover text."""
    factor, unit = _scale(response)
    frequency = quantities.of_unit("Frequency", "Hz")
    size = _blank(response, response.magnitude * factor)
    if view == "nyquist":
        x, y = size * np.cos(response.phase_rad), size * np.sin(response.phase_rad)
        text = f"%{{x:.3g}}, %{{y:.3g}} {unit}"
    else:
        with np.errstate(divide="ignore"):
            x, y = np.rad2deg(response.phase_rad), 20.0 * np.log10(size)
        text = f"%{{x:.1f}} deg, %{{y:.1f}} dB re {unit}"
    if not response.is_model:
        shared = {**shared, "mode": "lines+markers", "line": {"width": 0.6}}
    return scatter(
        x,
        y,
        row=number,
        xaxis=axis(number, "x"),
        **shared,
        customdata=(frequency.factor * response.frequency_hz).round(4).tolist(),
        hovertemplate=f"%{{customdata}} {frequency.unit}<br>{text}<extra>{shared['name']}</extra>",
    )


def _blank(response: Response, values: np.ndarray) -> np.ndarray:
    """Replace blanked points by NaN."""
    blanked = np.isin(response.frequency_hz, [point.frequency_hz for point in response.blanked])
    return np.where(blanked, np.nan, values)


def _scale(response: Response) -> tuple[float, str]:
    shown = quantities.ratio(
        quantities.of_channel(response.output, response.output_unit),
        quantities.of_channel(response.input, response.input_unit),
    )
    return shown.factor, shown.unit


# --- Measured and fitted data: magnitude and phase per output (Figs 14 and 15) --------------------

_INPUT_UNIT = "rad"  # responses are stored per radian of surface


def draw_fit(value: FitPlot) -> Spec:
    """Draw measured data as markers, fitted data as a curve.

    Spectra have one colour and one curve per input, since adjacent harmonics belong to different
    inputs; their phases are those of the excitation, so that fitted ones are rings.
    """
    if not value.traces:
        return empty("No fitted data")
    frequency = quantities.of_unit("Frequency", "Hz")
    modelled = value.curve or f"{value.method.value} fit"
    axes: list[Spec] = []
    data: list[Spec] = []
    for trace in value.traces:
        row = len(axes) + 1
        quantity = _select_quantity(trace, value.method)
        phases = np.concatenate([trace.measured_phase_rad, trace.fitted_phase_rad])
        axes += [
            {**title(quantity.title), "rangemode": "tozero"},
            {**title("Phase [deg]"), "dtick": _choose_phase_step(phases)},
        ]
        for label, own, points, curve, rings in _select_fit_styles(value):
            for name, rows_of, drawings in (
                (
                    f"{label} measured".strip(),
                    (trace.measured_magnitude, trace.measured_phase_rad),
                    (points, points),
                ),
                (
                    f"{label} {modelled}".strip(),
                    (trace.fitted_magnitude, trace.fitted_phase_rad),
                    (curve, rings),
                ),
            ):
                shown = (
                    (rows_of[0] * quantity.factor, f"%{{y:.4g}} {quantity.unit}"),
                    (np.rad2deg(rows_of[1]), "%{y:.1f} deg"),
                )
                for index, ((y, hover), drawing) in enumerate(zip(shown, drawings, strict=True)):
                    data.append(
                        scatter(
                            frequency.factor * value.frequency_hz[own],
                            y[own],
                            row=row + index,
                            name=name if label == "" else label,
                            legendgroup=label or name,
                            # of an input its points; the title of the legend explains the lines
                            showlegend=row + index == 1 and (label == "" or drawings[0] is points),
                            customdata=[value.run_id],
                            hovertemplate=f"%{{x:.3f}} {frequency.unit}<br>{hover}"
                            f"<extra>{name}</extra>",
                            **drawing,
                        )
                    )
    heights = [1.4, 1.0] * len(value.traces)
    notes = [
        _write_r_squared(trace, top)
        for trace, (_, top) in zip(value.traces, rows(heights)[::2], strict=True)
    ]
    layout = stack(
        title(frequency.axis_title),
        axes,
        heights,
        showlegend=True,
        hovermode="closest",
        annotations=notes,
    )
    if len({trace["legendgroup"] for trace in data}) > 2:
        layout["legend"] = {"title": {"text": f"points measured, lines and rings {modelled}"}}
    return {"data": data, "layout": layout}


_FitStyle = tuple[str, np.ndarray, Spec, Spec, Spec]
"""Label of an input, its frequencies (M,), and the styles of points, curve and rings."""


def _select_fit_styles(value: FitPlot) -> list[_FitStyle]:
    """Select the style of each input; of the method where there is one, or none is known."""
    assigned = np.array(value.assigned_inputs or ("",) * value.frequency_hz.size)
    colour, symbol = style.of_method(value.method.value)
    looks = {"": (colour, symbol)}
    if value.method is not Method.FRE:
        looks = {**style.of_inputs(value.inputs), **looks}
    else:
        assigned = np.full(assigned.size, "")
    found: list[_FitStyle] = []
    for name, (own_colour, own_symbol) in looks.items():
        own = assigned == name
        if not own.any():
            continue
        label = quantities.of_channel(name).label if name else ""
        marker = {"color": own_colour if name else style.MEASURED, "symbol": own_symbol, "size": 5}
        line = {"color": own_colour, "width": 1.4 if name else 1.8}
        rings: Spec = {
            "mode": "markers",
            "marker": {"color": own_colour, "symbol": "circle-open", "size": 8},
        }
        curve: Spec = {"mode": "lines", "line": line}
        if name == "" and value.method is Method.OE:  # inputs unknown: no curve through them
            curve = rings
        found.append(
            (
                label,
                own,
                {"mode": "markers", "marker": marker},
                curve,
                curve if value.method is Method.FRE else rings,
            )
        )
    return found


def _select_quantity(trace: FitTrace, method: Method) -> quantities.DisplayQuantity:
    output = quantities.of_channel(trace.output, trace.unit)
    if method is Method.FRE and trace.input is not None:
        return quantities.ratio(output, quantities.of_channel(trace.input, _INPUT_UNIT))
    return quantities.transform(output)


def _write_r_squared(trace: FitTrace, top: float) -> Spec:
    known = "–" if trace.r_squared is None else f"{trace.r_squared:.3f}"
    return text_at(1, top, f"R² = {known}", "right", "bottom", {"size": 11})
