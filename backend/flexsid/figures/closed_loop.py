"""Closed-loop stability margins and roots over airspeed."""

from __future__ import annotations

import numpy as np

from flexsid.figures import quantities, style
from flexsid.figures.spec import Spec, axis, column, layout_key, rows, title, vertical_mark
from flexsid.records.closed_loop import ClosedLoop

_DECIBEL = 20.0 / np.log(10.0)


def closed_loop_margins(value: ClosedLoop) -> Spec:
    """Draw gain, phase and disk margin of every surface's loop, with two standard errors."""
    kinds = (
        (
            "Gain margin [dB]",
            [(_DECIBEL * np.log(m.gain), _DECIBEL * m.gain_std) for m in value.margins],
        ),
        (
            "Phase margin [deg]",
            [(np.degrees(m.phase_rad), np.degrees(m.phase_std_rad)) for m in value.margins],
        ),
        ("Disk margin [1]", [(m.disk, m.disk_std) for m in value.margins]),
    )  # fmt: skip
    layout = _layout(value, len(kinds))
    data: list[Spec] = []
    for number, ((words, curves), domain) in enumerate(
        zip(kinds, rows([1.0] * len(kinds)), strict=True), start=1
    ):
        layout[layout_key(number)] = {**title(words), "domain": domain, "rangemode": "tozero"}
        for place, (margin, (middle, std)) in enumerate(zip(value.margins, curves, strict=True)):
            colour, symbol = style.of_index(place)
            label = quantities.of_channel(margin.surface).label
            shown = np.where(np.isfinite(middle), middle, np.nan)
            data.append(
                {
                    "type": "scatter",
                    "mode": "lines+markers",
                    "name": label,
                    "legendgroup": label,
                    "showlegend": number == 1,
                    "x": column(value.airspeed_m_s),
                    "y": column(shown),
                    "yaxis": axis(number),
                    "error_y": {
                        "type": "data", "array": column(np.where(np.isfinite(std), 2.0 * std, 0.0)),
                        "color": colour, "thickness": 1, "width": 2,
                    },
                    "line": {"color": colour, "width": 1},
                    "marker": {"color": colour, "symbol": symbol, "size": 6},
                    "hovertemplate": f"%{{x:.1f}} m/s<br>%{{y:.2f}}<extra>{label}</extra>",
                }
            )  # fmt: skip
    return {"data": data, "layout": layout}


def closed_loop_roots(value: ClosedLoop) -> Spec:
    """Draw roots with and without the controller, coloured by airspeed."""
    data: list[Spec] = []
    for name, roots, symbol in (
        ("Open loop", value.open_roots, "circle-open"),
        ("Closed loop", value.closed_roots, "x"),
    ):
        each = [root[np.imag(root) >= 0.0] for root in roots]
        speed = np.repeat(value.airspeed_m_s, [one.size for one in each])
        every = np.concatenate(each)
        near = np.abs(every) < 1.5 * max(float(np.abs(np.concatenate(value.open_roots)).max()), 1.0)
        data.append(
            {
                "type": "scatter",
                "mode": "markers",
                "name": name,
                "x": column(np.real(every[near])),
                "y": column(np.imag(every[near])),
                "marker": {
                    "symbol": symbol,
                    "size": 7,
                    "color": column(speed[near]),
                    "colorscale": "Cividis",
                    "showscale": name == "Closed loop",
                    "colorbar": title("Airspeed [m/s]"),
                },
                "text": [f"{v:.1f} m/s" for v in speed[near].tolist()],
                "hovertemplate": "%{text}<br>%{x:.2f} ± %{y:.2f} j rad/s"
                f"<extra>{name}</extra>",
            }
        )
    mark, _ = vertical_mark(0.0, "")
    return {
        "data": data,
        "layout": {
            "xaxis": {**title("Real part [rad/s]"), "range": _range(value)},
            "yaxis": title("Imaginary part [rad/s]"),
            "shapes": [mark],
            "showlegend": True,
            "hovermode": "closest",
            "meta": {"rows": 3},
        },
    }


def _range(value: ClosedLoop) -> list[float]:
    """Return the range of real parts of the open-loop roots; actuator roots lie farther left."""
    reals = np.concatenate([np.real(roots) for roots in (*value.open_roots, *value.closed_roots)])
    least = min(float(np.real(roots).min()) for roots in value.open_roots)
    return [1.3 * least - 1.0, 1.1 * max(float(reals.max()), 0.0) + 1.0]


def _layout(value: ClosedLoop, count: int) -> Spec:
    marks = [vertical_mark(value.tested_m_s, "fastest flown")]
    if value.lost_m_s is not None:
        marks.append(vertical_mark(value.lost_m_s, "stability limit"))
    return {
        "xaxis": {**title("Airspeed [m/s]"), "anchor": axis(count)},
        "shapes": [shape for shape, _ in marks],
        "annotations": [annotation for _, annotation in marks],
        "showlegend": True,
        "hovermode": "closest",
        "meta": {"rows": count},
    }
