"""Closed-loop stability margins and roots over airspeed."""

from __future__ import annotations

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
        "Disk margin [1]": [(m.disk, m.disk_std) for m in value.margins],
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
        **marked(marks),
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
