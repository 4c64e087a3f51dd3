"""Identified roots: in the s-plane with standard errors, and over airspeed, pressure or fuel."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

import numpy as np

from flexsid.figures import style
from flexsid.figures.quantities import DisplayQuantity, of_unit, text
from flexsid.figures.spec import (
    N_SIGMA,
    Spec,
    band,
    column,
    empty,
    error_bars,
    line_at,
    plane,
    scatter,
    stack,
    stagger,
    title,
    vertical_mark,
)
from flexsid.records.flutter import Along, FlutterRoots, RootBranch
from flexsid.records.run import Pole
from flexsid.records.views import PoleGroup, PoleMap

# --- Identified roots: frequency and damping over airspeed, pressure or fuel, and root locus ------

_FILL = 0.18
_REAL = 0.05  # rad/s: a root below is real
_AXES = {
    Along.AIRSPEED: ("Airspeed", "m/s"),
    Along.DYNAMIC_PRESSURE: ("Dynamic pressure", "Pa"),
}


def draw_v_omega_zeta(value: FlutterRoots) -> Spec:
    """Draw frequency and damping ratio with bands of ±2 standard errors.

    Modes with fixed derivatives are drawn thin and grey, and do not affect the range.
    """
    across = _describe_axis(value.along)
    factor, unit = across.factor, across.unit
    frequency = _describe_frequency()
    x = factor * value.at
    data: list[Spec] = []
    for branch, colour, symbol, width in _select_styles(value):
        name = text(branch.name)
        oscillates = branch.imag > _REAL
        curves = (
            (
                np.hypot(branch.real, branch.imag) * frequency.factor,
                branch.imag_std * frequency.factor,
                frequency.unit,
            ),
            (100.0 * branch.damping, 100.0 * branch.damping_std, "%"),
        )
        for row, (values, std, of_y) in enumerate(curves, start=1):
            y = np.where(oscillates, values, np.nan)
            known = np.isfinite(y) & np.isfinite(std)
            if not branch.held and known.any():
                data.append(_draw_band(x[known], y[known], std[known], colour, row, branch.name))
            data.append(
                scatter(
                    column(x, exact=True),
                    y,
                    "lines",
                    row=row,
                    name=name,
                    legendgroup=branch.name,
                    showlegend=row == 1,
                    line={"color": colour, "width": width},
                    hovertemplate=f"%{{x:.4~g}} {unit}<br>%{{y:.3g}} {of_y}<extra>{name}</extra>",
                )
            )
        data += _draw_tested(value, branch.name, {"color": colour, "symbol": f"{symbol}-open"})
    for branch, name, line in _list_predicted(value):
        for row, (values, of_y) in enumerate(
            (
                (np.hypot(branch.real, branch.imag) * frequency.factor, frequency.unit),
                (100.0 * branch.damping, "%"),
            ),
            start=1,
        ):
            data.append(
                scatter(
                    column(x, exact=True),
                    np.where(branch.imag > _REAL, values, np.nan),
                    "lines",
                    row=row,
                    name=name,
                    legendgroup=name,
                    showlegend=row == 1,
                    line=line,
                    hovertemplate=f"%{{x:.4~g}} {unit}<br>%{{y:.3g}} {of_y}<extra>{name}</extra>",
                )
            )
    layout = stack(
        title(across.axis_title),
        [
            {**title(frequency.axis_title), **_find_range(value, frequency.factor)},
            title("Damping ratio [%]"),
        ],
        showlegend=True,
        hovermode="closest",
        meta={"rows": 4, "note": value.note},
        shapes=[line_at(0, "y", yref="y2")],
        annotations=[],
    )
    for position, words in ((value.tested_to, "fastest flown"), (value.flutter, "flutter")):
        if position is not None:
            shape, note = vertical_mark(factor * position, words)
            if position == value.tested_to:  # flutter stands to its right as a rule
                note["xanchor"] = "right"
            layout["shapes"].append(shape)
            layout["annotations"].append(note)
    stagger(layout["annotations"], data)
    if value.interval is not None:
        low, high = value.interval
        layout["shapes"].append(band(factor * low, factor * high, style.FLAG, opacity=_FILL))
    return {"data": data, "layout": layout}


def draw_root_locus(value: FlutterRoots) -> Spec:
    """Draw the roots in the s-plane, with the parameter in the hover text."""
    across = _describe_axis(value.along)
    factor, unit = across.factor, across.unit
    at = [[float(f"{position:.5g}")] for position in factor * value.at]
    data = [
        scatter(
            branch.real,
            branch.imag,
            "lines+markers",
            name=text(branch.name),
            marker={
                "color": colour,
                "size": [7.0, *[3.0 if width > 1.0 else 2.0] * (value.at.size - 1)],
            },
            line={"color": colour, "width": 0.6 * width},
            customdata=at,
            hovertemplate=f"%{{customdata[0]}} {unit}<br>%{{x:.2f}} + j %{{y:.2f}} rad/s"
            f"<extra>{text(branch.name)}</extra>",
        )
        for branch, colour, _, width in _select_styles(value)
    ]
    data += [
        scatter(
            branch.real,
            branch.imag,
            "lines",
            name=name,
            line=line,
            customdata=at,
            hovertemplate=f"%{{customdata[0]}} {unit}<br>%{{x:.2f}} + j %{{y:.2f}} rad/s"
            f"<extra>{name}</extra>",
        )
        for branch, name, line in _list_predicted(value)
    ]
    layout = plane(
        {**title("Real part [rad/s]"), "zeroline": False},
        {**title("Imaginary part [rad/s]"), **_find_range(value, 1.0)},
        3,
        shapes=[line_at(0)],
    )
    layout["meta"]["note"] = f"Roots with increasing {across.label.lower()}, from the circle."
    return {"data": data, "layout": layout}


def _describe_axis(along: Along) -> DisplayQuantity:
    return DisplayQuantity("Fuel", "%", 100.0) if along is Along.FUEL else of_unit(*_AXES[along])


def _describe_frequency() -> DisplayQuantity:
    """Describe frequencies in rad/s."""
    shown = of_unit("Frequency", "Hz")
    return DisplayQuantity(shown.label, shown.unit, shown.factor / (2.0 * np.pi))


def _select_styles(value: FlutterRoots) -> Iterator[tuple[RootBranch, str, str, float]]:
    """Select colour, symbol and width of every branch; grey for fixed modes."""
    shown = 0
    for branch in value.branches:
        if branch.held:
            yield branch, style.GREY, "circle", 0.8
        else:
            yield branch, *style.of_index(shown), 1.8
            shown += 1


def _list_predicted(value: FlutterRoots) -> Iterator[tuple[RootBranch, str, Spec]]:
    """List the roots of a prediction with name and line: dashed, in the colour of the motion."""
    colours = {branch.name: colour for branch, colour, _, _ in _select_styles(value)}
    for branch in value.predicted:
        colour = colours.get(branch.name, style.GREY)
        line = {"color": colour, "dash": "dash", "width": 1.2}
        yield branch, f"{text(branch.name)}, predicted", line


def _find_range(value: FlutterRoots, factor: float) -> Spec:
    """Return the axis range of the identified modes."""
    known = [np.hypot(b.real, b.imag).max() for b in value.branches if not b.held]
    if not known or not any(b.held for b in value.branches):
        return {"rangemode": "tozero"}
    return {"range": [0.0, 1.1 * factor * float(max(known))]}


def _draw_band(
    x: np.ndarray, y: np.ndarray, std: np.ndarray, colour: str, row: int, name: str
) -> Spec:
    return scatter(
        np.concatenate([x, x[::-1]]),
        np.concatenate([y + N_SIGMA * std, (y - N_SIGMA * std)[::-1]]),
        "lines",
        row=row,
        name=f"{text(name)} ±2σ",
        legendgroup=name,
        showlegend=False,
        fill="toself",
        fillcolor=colour,
        opacity=_FILL,
        line={"width": 0},
        hoverinfo="skip",
    )


def _draw_tested(value: FlutterRoots, name: str, marker: Spec) -> list[Spec]:
    found = [root for root in value.tested if root.name == name]
    if not found:
        return []
    across = _describe_axis(value.along)
    factor, unit = across.factor, across.unit
    return [
        scatter(
            column([factor * root.at for root in found]),
            column(y),
            row=row,
            name=f"{text(name)}, single runs",
            legendgroup=name,
            showlegend=False,
            marker={**marker, "size": 7},
            text=[text(root.label) for root in found],
            customdata=[[root.run_id] for root in found],
            hovertemplate=f"%{{text}}<br>%{{x:.4~g}} {unit}<br>%{{y:.3g}}<extra></extra>",
        )
        for row, y in (
            (1, [root.frequency * _describe_frequency().factor for root in found]),
            (2, [100.0 * root.damping for root in found]),
        )
    ]


# --- Poles of the identified model in the s-plane, with ±2 standard errors ------------------------

_REFERENCE = (
    (style.GREY, "x-thin-open"),
    (style.OCHRE, "square-open"),
    (style.PINK, "diamond-open"),
)
_NAME_WIDTH, _NAME_HEIGHT = 0.12, 0.06  # of a name, as fractions of the figure


def draw_poles(value: PoleMap) -> Spec:
    """Draw poles in the upper half plane; poles right of the dashed line are unstable."""
    if not any(group.poles for group in value.groups):
        return empty("No poles")
    references = iter(_REFERENCE)
    repeats: Counter[str] = Counter()
    data = []
    for group, names in zip(value.groups, _list_names(value), strict=True):
        if group.method is None:
            look = next(references)
        else:
            look = style.of_method(group.method.value, repeats[group.method.value])
            repeats[group.method.value] += 1
        data.append(_draw_group(group, look, names))
    layout = plane(
        {**title("Real part [rad/s]"), "zeroline": False},
        {**title("Imaginary part [rad/s]"), "rangemode": "tozero"},
        2,
        shapes=[line_at(0)],
    )
    return {"data": data, "layout": layout}


def _list_names(value: PoleMap) -> list[list[str]]:
    """List pole names, once for close poles of one mode."""
    every = [pole for group in value.groups for pole in group.poles]
    wide = np.ptp([pole.real for pole in every]) * _NAME_WIDTH
    high = np.ptp([pole.imag for pole in every]) * _NAME_HEIGHT
    named: list[Pole] = []
    names = []
    for group in value.groups:
        names.append([])
        for pole in group.poles:
            close = any(
                abs(pole.real - other.real) <= wide and abs(pole.imag - other.imag) <= high
                for other in named
                if other.name == pole.name
            )
            names[-1].append("" if close else text(pole.name))
            if not close:
                named.append(pole)
    return names


def _draw_group(group: PoleGroup, look: tuple[str, str], names: list[str]) -> Spec:
    colour, symbol = look
    label = text(group.label)
    ring = {"color": colour, "width": 2}
    trace = scatter(
        column([pole.real for pole in group.poles]),
        column([pole.imag for pole in group.poles]),
        "markers+text",
        name=label,
        text=names,
        textposition="top right",
        marker={"color": colour, "symbol": symbol, "size": 9, "line": ring},
        customdata=[[group.run_id, _describe(pole)] for pole in group.poles],
        hovertemplate=f"%{{customdata[1]}}<extra>{label}</extra>",
    )
    if group.estimated:
        for key, std in (
            ("error_x", [pole.real_std for pole in group.poles]),
            ("error_y", [pole.imag_std for pole in group.poles]),
        ):
            trace[key] = error_bars(std, colour, thickness=1, width=3)
    return trace


def _describe(pole: Pole) -> str:
    radius = float(np.hypot(pole.real, pole.imag))
    name = f"<b>{text(pole.name)}</b><br>" if pole.name else ""
    real, imag = _format(pole.real, pole.real_std), _format(pole.imag, pole.imag_std)
    place = f"{name}{real} + j {imag} rad/s"
    if pole.imag == 0 or radius == 0:
        return place
    shown = of_unit("frequency", "Hz")
    frequency = f"frequency {shown.factor * radius / (2 * np.pi):.3f} {shown.unit}"
    return f"{place}<br>{frequency}<br>damping {-pole.real / radius:.4f}"


def _format(value: float, std: float | None) -> str:
    return f"{value:.3f}" if std is None else f"{value:.3f} ± {N_SIGMA * std:.3f}"
