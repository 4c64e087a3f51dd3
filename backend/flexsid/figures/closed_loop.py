"""Closed loop: its block diagram, measured responses, stability margins and roots over airspeed."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flexsid.figures import quantities, style
from flexsid.figures.spec import (
    Spec,
    column,
    error_bars,
    marked,
    plane,
    scatter,
    stack,
    title,
    vertical_mark,
)
from flexsid.records.flutter import ClosedLoop
from flexsid.records.views import ControlLoopDiagram, LoopCurve, LoopPlot

# --- Closed-loop stability margins and roots over airspeed ----------------------------------------

_DECIBEL = 20.0 / np.log(10.0)


def draw_closed_loop_margins(value: ClosedLoop) -> Spec:
    """Draw gain, phase and disk margin of every surface's loop, with two standard errors."""
    kinds = {
        "Gain margin [dB]": [
            (_DECIBEL * np.log(m.gain), _DECIBEL * m.gain_std) for m in value.margins
        ],
        "Phase margin [deg]": [
            (np.degrees(m.phase_rad), np.degrees(m.phase_std_rad)) for m in value.margins
        ],
        "Disk margin": [(m.disk, m.disk_std) for m in value.margins],
    }
    speed = quantities.of_unit("Airspeed", "m/s")
    data: list[Spec] = []
    for row, curves in enumerate(kinds.values(), start=1):
        for place, (margin, (middle, std)) in enumerate(zip(value.margins, curves, strict=True)):
            colour, symbol = style.of_index(place)
            label = quantities.of_channel(margin.surface).label
            shown = np.where(np.isfinite(std), std, 0.0)
            data.append(
                scatter(
                    speed.factor * value.airspeed_m_s,
                    middle,
                    "lines+markers",
                    row=row,
                    name=label,
                    legendgroup=label,
                    showlegend=row == 1,
                    error_y=error_bars(shown, colour, thickness=1, width=2),
                    line={"color": colour, "width": 1},
                    marker={"color": colour, "symbol": symbol, "size": 6},
                    hovertemplate=f"%{{x:.1f}} {speed.unit}<br>%{{y:.2f}}<extra>{label}</extra>",
                )
            )
    marks = [vertical_mark(speed.factor * value.tested_m_s, "fastest flown")]
    if value.lost_m_s is not None:
        marks.append(vertical_mark(speed.factor * value.lost_m_s, "stability limit"))
    layout = stack(
        title(speed.axis_title),
        [{**title(text), "rangemode": "tozero"} for text in kinds],
        showlegend=True,
        hovermode="closest",
        **marked(marks, data),
    )
    return {"data": data, "layout": layout}


def draw_closed_loop_roots(value: ClosedLoop) -> Spec:
    """Draw roots with and without the controller, coloured by airspeed."""
    speed = quantities.of_unit("Airspeed", "m/s")
    data: list[Spec] = []
    reach = 1.5 * max(float(np.abs(np.concatenate(value.open_roots)).max()), 1.0)
    for name, roots, symbol in (
        ("Open loop", value.open_roots, "circle-open"),
        ("Closed loop", value.closed_roots, "x"),
    ):
        each = [root[(np.imag(root) >= 0.0) & (np.abs(root) < reach)] for root in roots]
        shown = np.concatenate(each)
        flown = np.repeat(speed.factor * value.airspeed_m_s, [one.size for one in each])
        data.append(
            scatter(
                np.real(shown),
                np.imag(shown),
                name=name,
                marker={
                    "symbol": symbol,
                    "size": 7,
                    "color": column(flown),
                    "colorscale": "Cividis",
                    "showscale": name == "Closed loop",
                    "colorbar": title(speed.axis_title),
                },
                text=[f"{v:.1f} {speed.unit}" for v in flown.tolist()],
                hovertemplate=f"%{{text}}<br>%{{x:.2f}} ± %{{y:.2f}} j rad/s<extra>{name}</extra>",
            )
        )
    mark, _ = vertical_mark(0.0, "")
    x_axis = {**title("Real part [rad/s]"), "range": _find_range(value)}
    layout = plane(x_axis, title("Imaginary part [rad/s]"), 3, shapes=[mark])
    return {"data": data, "layout": layout}


def _find_range(value: ClosedLoop) -> list[float]:
    """Return the range of real parts of the open-loop roots; actuator roots lie farther left."""
    reals = np.concatenate([np.real(roots) for roots in (*value.open_roots, *value.closed_roots)])
    least = min(float(np.real(roots).min()) for roots in value.open_roots)
    return [1.3 * least - 1.0, 1.1 * max(float(reals.max()), 0.0) + 1.0]


# --- Block diagram of a control loop, with the place where the excitation enters (Fig. 7) ---------

_HIGH, _LOW = 1.0, 0.0  # of the forward path and of the feedback
_HALF_HEIGHT = 0.32  # of a block
_GAP = 0.4  # between blocks and sums, of which a usual block is one wide
_BLOCK_PX = 105  # least width of a block with its words
_SUM_PX, _RADIUS_PX = 20, 10  # of a sum
_ROWS = 1.8
_MOST = 3  # names in a line, more are counted


def draw_control_loop(value: ControlLoopDiagram) -> Spec:
    """Draw law, mixer, excitation, actuators and aircraft, and the feedback of the sensors."""
    drawing = _Drawing()
    blocks = [("Control law", _describe_law(value), 1.0)]
    if value.commands:
        blocks.append(("Mixer", f"{_list(value.commands)}<br>→ {_list(value.drives)}", 1.0))
    if value.rate_limit_rad_s is not None:
        rate = quantities.of_unit("Rate limit", "rad/s")
        limit = f"{rate.factor * value.rate_limit_rad_s:.3g} {rate.unit}"
        blocks.append(("Rate limit", limit, 0.8))
    blocks += [
        ("Actuators", _list(value.drives), 0.9),
        ("Aircraft", "bare airframe", 0.9),
        ("Sensors", _list(value.reads), 0.9),
    ]
    before = "Mixer" if value.is_before_mixer else "Actuators"
    end = 0.0
    for name, text, width in blocks:
        is_after_sum = name == before
        if is_after_sum:
            x = end + _GAP
            drawing.add_arrow(end, x, standoff=_RADIUS_PX)
            drawing.add_sum(x, f"Excitation {_list(value.excitation)}".strip())
            end = x
        x = end + (_GAP if end else 0.0)
        if end:
            drawing.add_arrow(end, x, startstandoff=_RADIUS_PX if is_after_sum else 0.0)
        drawing.add_block(x, width, name, text)
        end = x + width
    drawing.close(end, blocks[0][2])
    return drawing.finish(end)


def _describe_law(value: ControlLoopDiagram) -> str:
    airspeed = quantities.of_unit("Airspeed", "m/s")
    speeds = [f"{airspeed.factor * one:.3g}" for one in value.airspeeds_m_s]
    schedule = (
        f"{speeds[0]} to {speeds[-1]} {airspeed.unit}" if len(speeds) > 1 else "all airspeeds"
    )
    delay = f"<br>delay {1e3 * value.delay_s:.3g} ms" if value.delay_s else ""
    return schedule + delay


def _list(names: Sequence[str]) -> str:
    shown = ", ".join(names[:_MOST])
    return shown if len(names) <= _MOST else f"{shown} + {len(names) - _MOST}"


class _Drawing:
    """Lines, shapes and words of a diagram while it is drawn from left to right."""

    def __init__(self) -> None:
        self.shapes: list[Spec] = []
        self.words: list[Spec] = []
        self.sums: list[float] = []

    def add_block(self, x: float, width: float, name: str, text: str) -> None:
        self.shapes.append(
            {
                "type": "rect", "x0": x, "x1": x + width, "y0": _HIGH - _HALF_HEIGHT,
                "y1": _HIGH + _HALF_HEIGHT, "line": {"color": style.BLUE, "width": 1.5},
            }
        )  # fmt: skip
        self.write(x + 0.5 * width, _HIGH, f"<b>{name}</b><br>{text}")

    def add_sum(self, x: float, text: str) -> None:
        self.sums.append(x)
        self.write(x, _HIGH, "+")
        self._point(x, _HIGH + 0.62, x, _HIGH, style.VERMILION, standoff=_RADIUS_PX)
        self.write(x, _HIGH + 0.75, text)

    def add_arrow(self, start: float, end: float, **gaps: float) -> None:
        self._point(start, _HIGH, end, _HIGH, style.GREY, **gaps)

    def close(self, end: float, first_width: float) -> None:
        """Draw the feedback from the last block to the first."""
        corner, middle = end + 0.2, 0.5 * first_width
        for x0, y0, x1, y1 in (
            (end, _HIGH, corner, _HIGH),
            (corner, _HIGH, corner, _LOW + 0.3),
            (corner, _LOW + 0.3, middle, _LOW + 0.3),
        ):
            line = {"color": style.GREY, "width": 1.5}
            self.shapes.append(
                {"type": "line", "x0": x0, "y0": y0, "x1": x1, "y1": y1, "line": line}
            )
        self._point(middle, _LOW + 0.3, middle, _HIGH - _HALF_HEIGHT, style.GREY)

    def write(self, x: float, y: float, text: str) -> None:
        self.words.append({"x": x, "y": y, "text": text, "showarrow": False, "font": {"size": 11}})

    def finish(self, end: float) -> Spec:
        hidden = {"visible": False, "fixedrange": True}
        line = {"width": 1.5}
        marker = {"symbol": "circle-open", "size": _SUM_PX, "color": style.VERMILION, "line": line}
        sums = scatter(self.sums, [_HIGH] * len(self.sums), marker=marker, hoverinfo="skip")
        return {
            "data": [sums],
            "layout": {
                "xaxis": {**hidden, "range": [-0.1, end + 0.3]},
                "yaxis": {**hidden, "range": [_LOW + 0.15, _HIGH + 0.95]},
                "shapes": self.shapes,
                "annotations": self.words,
                "showlegend": False,
                "meta": {"rows": _ROWS, "least_width": round(_BLOCK_PX * end)},
            },
        }

    def _point(
        self, x0: float, y0: float, x1: float, y1: float, colour: str, **gaps: float
    ) -> None:
        self.words.append(
            {
                "x": x1, "y": y1, "ax": x0, "ay": y0, "axref": "x", "ayref": "y", "text": "",
                "showarrow": True, "arrowhead": 2, "arrowwidth": 1.5, "arrowcolor": colour,
                **gaps,
            }
        )  # fmt: skip


# --- Measured open-loop responses in the complex plane (Nyquist plot) -----------------------------


def draw_loops(value: LoopPlot) -> Spec:
    """Draw the Nyquist plot of every loop, with margins in the legend."""
    frequency = quantities.of_unit("Frequency", "Hz")
    data = []
    for number, curve in enumerate(value.curves):
        colour, symbol = style.of_index(number)
        label = quantities.of_channel(curve.surface).label
        # The error of a complex number is circular, so each part has half of its variance.
        bars = error_bars(curve.std, colour, np.sqrt(2.0), thickness=1, width=0)
        data.append(
            scatter(
                np.real(curve.gain),
                np.imag(curve.gain),
                "lines+markers",
                name=f"{label}: {_format_margins(curve)}",
                line={"color": colour, "width": 1},
                marker={"color": colour, "symbol": symbol, "size": 5},
                error_x=bars,
                error_y=bars,
                customdata=[[f] for f in (frequency.factor * curve.frequency_hz).round(4).tolist()],
                hovertemplate=f"%{{customdata[0]:.3f}} {frequency.unit}<br>"
                f"%{{x:.3f}} + j %{{y:.3f}}<extra>{label}</extra>",
                meta=curve.surface,
            )
        )
    data.append(
        scatter(
            [-1.0], [0.0], name="−1", marker={"color": style.FLAG, "symbol": "x", "size": 10},
            hovertemplate="critical point<extra></extra>",
        )
    )  # fmt: skip
    layout = plane(title("Re L"), {**title("Im L"), "scaleanchor": "x"}, 3)
    return {"data": data, "layout": layout}


def _format_margins(curve: LoopCurve) -> str:
    gain = "∞" if not np.isfinite(curve.gain_up) else f"{20.0 * np.log10(curve.gain_up):.1f} dB"
    phase = "∞"
    if np.isfinite(curve.phase_rad):
        phase = f"{np.degrees(curve.phase_rad):.0f} ± {2.0 * np.degrees(curve.phase_std_rad):.0f}°"
    return f"gain {gain}, phase {phase}, disk {curve.disk:.2f} ± {2.0 * curve.disk_std:.2f}"
