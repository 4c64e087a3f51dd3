"""Block diagram of a control loop, with the place where the excitation enters (Fig. 7)."""

from __future__ import annotations

from collections.abc import Sequence

from flexsid.figures import quantities, style
from flexsid.figures.spec import Spec, scatter
from flexsid.records.views import ControlLoopDiagram

_HIGH, _LOW = 1.0, 0.0  # of the forward path and of the feedback
_HALF_HEIGHT = 0.32  # of a block
_SUM, _SUM_HEIGHT, _SUM_PX = 0.1, 0.08, 20  # half width and height of a sum, and its diameter
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
        if name == before:
            x = end + 0.45
            drawing.add_arrow(end, x - _SUM)
            drawing.add_sum(x, f"Excitation {_list(value.excitation)}".strip())
            end = x + _SUM
        x = end + (0.35 if end else 0.0)
        if end:
            drawing.add_arrow(end, x)
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
        self._point(x, _HIGH + 0.62, x, _HIGH + _SUM_HEIGHT, style.VERMILION)
        self.write(x, _HIGH + 0.75, text)

    def add_arrow(self, start: float, end: float) -> None:
        self._point(start, _HIGH, end, _HIGH, style.GREY)

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
                "meta": {"rows": _ROWS},
            },
        }

    def _point(self, x0: float, y0: float, x1: float, y1: float, colour: str) -> None:
        self.words.append(
            {
                "x": x1, "y": y1, "ax": x0, "ay": y0, "axref": "x", "ayref": "y", "text": "",
                "showarrow": True, "arrowhead": 2, "arrowwidth": 1.5, "arrowcolor": colour,
            }
        )  # fmt: skip
