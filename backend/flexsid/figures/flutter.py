"""Flutter: roots over airspeed, forecasts against the speed flown, and a map over loading."""

from __future__ import annotations

import numpy as np

from flexsid.figures import style
from flexsid.figures.quantities import text
from flexsid.figures.spec import Spec, axis, column, empty, layout_key, rows, title, vertical_mark
from flexsid.records.flutter import Flutter, FlutterMap, FlutterRoots, RootBranch

_HZ = 1.0 / (2.0 * np.pi)
_FILL = 0.18
_STILL = 0.05  # rad/s: a root below stands still and has no frequency


def v_omega_zeta(value: FlutterRoots) -> Spec:
    """Draw frequency and damping ratio over airspeed with bands of ±2 standard errors."""
    top, bottom = rows([1.0, 1.0])
    layout: Spec = {
        "xaxis": {**title("Airspeed [m/s]"), "anchor": axis(2)},
        layout_key(1): {**title("Frequency [Hz]"), "domain": top, "rangemode": "tozero"},
        layout_key(2): {**title("Damping ratio [%]"), "domain": bottom},
        "showlegend": True,
        "hovermode": "closest",
        "shapes": [_level(axis(2))],
        "annotations": [],
        "meta": {"rows": 4},
    }
    _mark_speeds(layout, value)
    data: list[Spec] = []
    for number, branch in enumerate(value.branches):
        colour, symbol = style.of_index(number)
        size = np.hypot(branch.real, branch.imag)
        moves = branch.imag > _STILL
        frequency = np.where(moves, size * _HZ, np.nan)
        spread = np.where(moves, branch.imag_std * _HZ, np.nan)
        damping = np.where(moves, 100.0 * branch.damping, np.nan)
        band = np.where(moves, 100.0 * branch.damping_std, np.nan)
        for row, (y, std) in enumerate(((frequency, spread), (damping, band)), start=1):
            data += _band(value.airspeed_m_s, y, std, colour, row, branch.name)
            data.append(_curve(value.airspeed_m_s, y, colour, row, branch.name))
        data += _tested(value, branch.name, colour, symbol)
    return {"data": data, "layout": layout}


def root_locus(value: FlutterRoots) -> Spec:
    """Draw the roots in the s-plane as airspeed rises; the hover text tells the speed."""
    data = []
    for number, branch in enumerate(value.branches):
        colour, _ = style.of_index(number)
        data.append(_locus(value, branch, colour))
    layout: Spec = {
        "xaxis": {**title("Real part [rad/s]"), "zeroline": False},
        "yaxis": {**title("Imaginary part [rad/s]"), "rangemode": "tozero"},
        "shapes": [
            {
                "type": "line", "xref": "x", "yref": "paper", "x0": 0, "x1": 0, "y0": 0, "y1": 1,
                "line": {"color": style.FLAG, "width": 1.5, "dash": "dash"}, "layer": "below",
            }
        ],
        "showlegend": True,
        "hovermode": "closest",
        "meta": {"rows": 3},
    }  # fmt: skip
    return {"data": data, "layout": layout}


def flutter_forecast(value: Flutter) -> Spec:
    """Draw the flutter speed that each run predicts against the speed at which it was flown."""
    known = [run for run in value.runs if run.airspeed_m_s is not None]
    if not known:
        return empty("No run sees an instability")
    errors = [np.nan if r.airspeed_std_m_s is None else 2.0 * r.airspeed_std_m_s for r in known]
    data: list[Spec] = [
        {
            "type": "scatter",
            "mode": "markers",
            "name": "single runs ±2σ",
            "x": column([run.tested_m_s for run in known]),
            "y": column([float(run.airspeed_m_s or 0.0) for run in known]),
            "error_y": {
                "type": "data", "array": column(errors), "color": style.BLUE, "thickness": 1,
            },
            "marker": {"color": style.BLUE, "size": 8},
            "text": [text(run.label) for run in known],
            "customdata": [[run.run_id] for run in known],
            "hovertemplate": "%{text}<br>at %{x:.1f} m/s<br>flutter %{y:.2f} m/s<extra></extra>",
        }
    ]  # fmt: skip
    shapes: list[Spec] = []
    if value.low_m_s is not None and value.high_m_s is not None:
        shapes.append(
            {
                "type": "rect", "xref": "paper", "x0": 0, "x1": 1, "yref": "y",
                "y0": value.low_m_s, "y1": value.high_m_s, "fillcolor": style.BLUE,
                "opacity": _FILL, "line": {"width": 0}, "layer": "below",
            }
        )  # fmt: skip
    ends = [min(run.tested_m_s for run in known), max(run.tested_m_s for run in known)]
    levels = [("all runs together", value.airspeed_m_s, style.BLUE, "solid")]
    levels.append(("predicted before flight", value.known_m_s, style.GREY, "dash"))
    levels += [
        (tracker.name, tracker.airspeed_m_s, style.PREDICTIONS[k % 4][0], "dot")
        for k, tracker in enumerate(value.trackers)
    ]
    for name, speed, colour, dash in levels:
        if speed is not None:
            data.append(
                {
                    "type": "scatter", "mode": "lines", "name": name, "x": ends,
                    "y": [speed, speed], "line": {"color": colour, "dash": dash, "width": 1.8},
                    "hovertemplate": f"%{{y:.2f}} m/s<extra>{name}</extra>",
                }
            )  # fmt: skip
    layout: Spec = {
        "xaxis": title("Airspeed flown [m/s]"),
        "yaxis": title("Flutter speed [m/s]") | _near(value.airspeed_m_s),
        "shapes": shapes,
        "showlegend": True,
        "hovermode": "closest",
        "meta": {"rows": 3},
    }
    return {"data": data, "layout": layout}


def flutter_map(value: FlutterMap) -> Spec:
    """Draw the flutter speed over fuel and altitude."""
    if not np.isfinite(value.airspeed_m_s).any():
        return empty("No instability at any loading or altitude looked at")
    return {
        "data": [
            {
                "type": "heatmap",
                "name": "flutter speed",
                "x": [100.0 * fuel for fuel in value.fuel.tolist()],
                "y": value.altitude_m.tolist(),
                "z": column(value.airspeed_m_s),
                "colorscale": "Viridis",
                "colorbar": {"title": {"text": "m/s"}},
                "hovertemplate": (
                    "fuel %{x:.0f} %<br>altitude %{y:.0f} m<br>%{z:.2f} m/s<extra></extra>"
                ),
            }
        ],
        "layout": {
            "xaxis": title("Fuel [%]"),
            "yaxis": title("Altitude, standard atmosphere [m]"),
            "meta": {"rows": 3},
        },
    }


def _near(speed: float | None) -> Spec:
    """Zoomed in on the answer; a tracker that is far off is found by zooming out."""
    return {} if speed is None else {"range": [0.8 * speed, 1.25 * speed]}


def _mark_speeds(layout: Spec, value: FlutterRoots) -> None:
    marks = [(value.tested_m_s, "fastest flown")]
    if value.flutter_m_s is not None:
        marks.append((value.flutter_m_s, "flutter"))
    for speed, name in marks:
        shape, note = vertical_mark(speed, name)
        layout["shapes"].append(shape)
        layout["annotations"].append(note)
    if value.interval_m_s is not None:
        low, high = value.interval_m_s
        layout["shapes"].append(
            {
                "type": "rect", "xref": "x", "x0": low, "x1": high, "yref": "paper", "y0": 0,
                "y1": 1, "fillcolor": style.FLAG, "opacity": _FILL, "line": {"width": 0},
                "layer": "below",
            }
        )  # fmt: skip


def _level(y: str) -> Spec:
    return {
        "type": "line", "xref": "paper", "x0": 0, "x1": 1, "yref": y, "y0": 0, "y1": 0,
        "line": {"color": style.FLAG, "width": 1.5, "dash": "dash"}, "layer": "below",
    }  # fmt: skip


def _curve(x: np.ndarray, y: np.ndarray, colour: str, row: int, name: str) -> Spec:
    unit = "Hz" if row == 1 else "%"
    return {
        "type": "scatter",
        "mode": "lines",
        "name": text(name),
        "legendgroup": name,
        "showlegend": row == 1,
        "x": column(x, exact=True),
        "y": column(y),
        "yaxis": axis(row),
        "line": {"color": colour, "width": 1.8},
        "hovertemplate": f"%{{x:.1f}} m/s<br>%{{y:.3g}} {unit}<extra>{text(name)}</extra>",
    }


def _band(
    x: np.ndarray, y: np.ndarray, std: np.ndarray, colour: str, row: int, name: str
) -> list[Spec]:
    keep = np.isfinite(y) & np.isfinite(std)
    if not keep.any():
        return []
    around = np.concatenate([y[keep] + 2.0 * std[keep], (y[keep] - 2.0 * std[keep])[::-1]])
    return [
        {
            "type": "scatter",
            "mode": "lines",
            "name": f"{text(name)} ±2σ",
            "legendgroup": name,
            "showlegend": False,
            "x": column(np.concatenate([x[keep], x[keep][::-1]])),
            "y": column(around),
            "yaxis": axis(row),
            "fill": "toself",
            "fillcolor": colour,
            "opacity": _FILL,
            "line": {"width": 0},
            "hoverinfo": "skip",
        }
    ]


def _tested(value: FlutterRoots, name: str, colour: str, symbol: str) -> list[Spec]:
    found = [root for root in value.tested if root.name == name]
    if not found:
        return []
    shared = {
        "type": "scatter",
        "mode": "markers",
        "name": f"{text(name)} in single runs",
        "legendgroup": name,
        "showlegend": False,
        "x": column([root.airspeed_m_s for root in found]),
        "marker": {"color": colour, "symbol": f"{symbol}-open", "size": 7},
        "text": [text(root.label) for root in found],
        "customdata": [[root.run_id] for root in found],
        "hovertemplate": "%{text}<br>%{x:.1f} m/s<br>%{y:.3g}<extra></extra>",
    }
    return [
        {**shared, "y": column([root.frequency * _HZ for root in found]), "yaxis": axis(1)},
        {**shared, "y": column([100.0 * root.damping for root in found]), "yaxis": axis(2)},
    ]


def _locus(value: FlutterRoots, branch: RootBranch, colour: str) -> Spec:
    return {
        "type": "scatter",
        "mode": "lines+markers",
        "name": text(branch.name),
        "x": column(branch.real),
        "y": column(branch.imag),
        "marker": {"color": colour, "size": 3},
        "line": {"color": colour, "width": 1},
        "customdata": [[speed] for speed in value.airspeed_m_s.round(2).tolist()],
        "hovertemplate": (
            f"%{{customdata[0]:.1f}} m/s<br>%{{x:.2f}} + j %{{y:.2f}} rad/s"
            f"<extra>{text(branch.name)}</extra>"
        ),
    }
