"""Identified roots: frequency and damping over airspeed, pressure or fuel, and root locus."""

from __future__ import annotations

import numpy as np

from flexsid.figures import style
from flexsid.figures.quantities import text
from flexsid.figures.spec import Spec, axis, column, layout_key, rows, title, vertical_mark
from flexsid.records.flutter import Along, FlutterRoots, RootBranch

_HZ = 1.0 / (2.0 * np.pi)
_FILL = 0.18
_AXES = {  # factor for display, label, unit
    Along.AIRSPEED: (1.0, "Airspeed [m/s]", "m/s"),
    Along.DYNAMIC_PRESSURE: (1.0, "Dynamic pressure [Pa]", "Pa"),
    Along.FUEL: (100.0, "Fuel [%]", "% fuel"),
}


_REAL = 0.05  # rad/s: a root below is real


def v_omega_zeta(value: FlutterRoots) -> Spec:
    """Draw frequency and damping ratio with bands of ±2 standard errors.

    Modes with fixed derivatives are drawn thin and grey, and do not affect the range.
    """
    factor, label, unit = _AXES[value.along]
    top, bottom = rows([1.0, 1.0])
    layout: Spec = {
        "xaxis": {**title(label), "anchor": axis(2)},
        layout_key(1): {**title("Frequency [Hz]"), "domain": top, **_range(value)},
        layout_key(2): {**title("Damping ratio [%]"), "domain": bottom},
        "showlegend": True,
        "hovermode": "closest",
        "shapes": [_level(axis(2))],
        "annotations": [],
        "meta": {"rows": 4, "note": value.note},
    }
    _add_marks(layout, value, factor)
    x = factor * value.at
    data: list[Spec] = []
    for branch, (colour, symbol, width) in zip(value.branches, _colours(value), strict=True):
        size = np.hypot(branch.real, branch.imag)
        oscillates = branch.imag > _REAL
        frequency = np.where(oscillates, size * _HZ, np.nan)
        spread = np.where(oscillates, branch.imag_std * _HZ, np.nan)
        damping = np.where(oscillates, 100.0 * branch.damping, np.nan)
        band = np.where(oscillates, 100.0 * branch.damping_std, np.nan)
        for row, (y, std) in enumerate(((frequency, spread), (damping, band)), start=1):
            if not branch.held:
                data += _band(x, y, std, colour, row, branch.name)
            data.append(_curve(x, y, colour, row, branch.name, unit, width))
        data += _tested(value, branch.name, colour, symbol, factor, unit)
    return {"data": data, "layout": layout}


def root_locus(value: FlutterRoots) -> Spec:
    """Draw the roots in the s-plane, with the parameter in the hover text."""
    factor, label, unit = _AXES[value.along]
    data = [
        _locus(branch, factor * value.at, unit, colour, width)
        for branch, (colour, _, width) in zip(value.branches, _colours(value), strict=True)
    ]
    layout: Spec = {
        "xaxis": {**title("Real part [rad/s]"), "zeroline": False},
        "yaxis": {**title("Imaginary part [rad/s]"), **_range(value, 1.0)},
        "shapes": [
            {
                "type": "line", "xref": "x", "yref": "paper", "x0": 0, "x1": 0, "y0": 0, "y1": 1,
                "line": {"color": style.FLAG, "width": 1.5, "dash": "dash"}, "layer": "below",
            }
        ],
        "showlegend": True,
        "hovermode": "closest",
        "meta": {"rows": 3, "note": f"Roots with increasing {label.lower()}, from the circle."},
    }  # fmt: skip
    return {"data": data, "layout": layout}


def _colours(value: FlutterRoots) -> list[tuple[str, str, float]]:
    """Select colour, symbol and width of every branch; grey for fixed modes."""
    shown, result = 0, []
    for branch in value.branches:
        if branch.held:
            result.append((style.GREY, "circle", 0.8))
        else:
            colour, symbol = style.of_index(shown)
            result.append((colour, symbol, 1.8))
            shown += 1
    return result


def _range(value: FlutterRoots, factor: float = _HZ) -> Spec:
    """Return the axis range of the identified modes."""
    known = [np.hypot(b.real, b.imag).max() for b in value.branches if not b.held]
    if not known or not any(b.held for b in value.branches):
        return {"rangemode": "tozero"}
    return {"range": [0.0, 1.1 * factor * float(max(known))]}


def _add_marks(layout: Spec, value: FlutterRoots, factor: float) -> None:
    marks = [
        (position, name)
        for position, name in ((value.tested_to, "fastest flown"), (value.flutter, "flutter"))
        if position is not None
    ]
    for position, name in marks:
        shape, note = vertical_mark(factor * position, name)
        if position == value.tested_to:  # flutter stands to its right as a rule
            note["xanchor"] = "right"
        layout["shapes"].append(shape)
        layout["annotations"].append(note)
    if value.interval is not None:
        low, high = value.interval
        layout["shapes"].append(
            {
                "type": "rect", "xref": "x", "x0": factor * low, "x1": factor * high,
                "yref": "paper", "y0": 0, "y1": 1, "fillcolor": style.FLAG, "opacity": _FILL,
                "line": {"width": 0}, "layer": "below",
            }
        )  # fmt: skip


def _level(y: str) -> Spec:
    return {
        "type": "line", "xref": "paper", "x0": 0, "x1": 1, "yref": y, "y0": 0, "y1": 0,
        "line": {"color": style.FLAG, "width": 1.5, "dash": "dash"}, "layer": "below",
    }  # fmt: skip


def _curve(
    x: np.ndarray, y: np.ndarray, colour: str, row: int, name: str, unit: str, width: float
) -> Spec:
    of_y = "Hz" if row == 1 else "%"
    return {
        "type": "scatter",
        "mode": "lines",
        "name": text(name),
        "legendgroup": name,
        "showlegend": row == 1,
        "x": column(x, exact=True),
        "y": column(y),
        "yaxis": axis(row),
        "line": {"color": colour, "width": width},
        "hovertemplate": f"%{{x:.4~g}} {unit}<br>%{{y:.3g}} {of_y}<extra>{text(name)}</extra>",
    }


def _band(
    x: np.ndarray, y: np.ndarray, std: np.ndarray, colour: str, row: int, name: str
) -> list[Spec]:
    finite = np.isfinite(y) & np.isfinite(std)
    if not finite.any():
        return []
    around = np.concatenate([y[finite] + 2.0 * std[finite], (y[finite] - 2.0 * std[finite])[::-1]])
    return [
        {
            "type": "scatter",
            "mode": "lines",
            "name": f"{text(name)} ±2σ",
            "legendgroup": name,
            "showlegend": False,
            "x": column(np.concatenate([x[finite], x[finite][::-1]])),
            "y": column(around),
            "yaxis": axis(row),
            "fill": "toself",
            "fillcolor": colour,
            "opacity": _FILL,
            "line": {"width": 0},
            "hoverinfo": "skip",
        }
    ]


def _tested(
    value: FlutterRoots, name: str, colour: str, symbol: str, factor: float, unit: str
) -> list[Spec]:
    found = [root for root in value.tested if root.name == name]
    if not found:
        return []
    shared = {
        "type": "scatter",
        "mode": "markers",
        "name": f"{text(name)}, single runs",
        "legendgroup": name,
        "showlegend": False,
        "x": column([factor * root.at for root in found]),
        "marker": {"color": colour, "symbol": f"{symbol}-open", "size": 7},
        "text": [text(root.label) for root in found],
        "customdata": [[root.run_id] for root in found],
        "hovertemplate": f"%{{text}}<br>%{{x:.4~g}} {unit}<br>%{{y:.3g}}<extra></extra>",
    }
    return [
        {**shared, "y": column([root.frequency * _HZ for root in found]), "yaxis": axis(1)},
        {**shared, "y": column([100.0 * root.damping for root in found]), "yaxis": axis(2)},
    ]


def _locus(branch: RootBranch, at: np.ndarray, unit: str, colour: str, width: float) -> Spec:
    sizes = [7.0, *[3.0 if width > 1.0 else 2.0] * (at.size - 1)]
    return {
        "type": "scatter",
        "mode": "lines+markers",
        "name": text(branch.name),
        "x": column(branch.real),
        "y": column(branch.imag),
        "marker": {"color": colour, "size": sizes},
        "line": {"color": colour, "width": 0.6 * width},
        "customdata": [[float(f"{position:.5g}")] for position in at],
        "hovertemplate": (
            f"%{{customdata[0]}} {unit}<br>%{{x:.2f}} + j %{{y:.2f}} rad/s"
            f"<extra>{text(branch.name)}</extra>"
        ),
    }
