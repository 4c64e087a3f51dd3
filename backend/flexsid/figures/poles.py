"""Poles of the identified model in the s-plane, with ±1 standard error."""

from __future__ import annotations

from collections import Counter

import numpy as np

from flexsid.figures import style
from flexsid.figures.quantities import of_unit, text
from flexsid.figures.spec import Spec, column, empty, error_bars, line_at, plane, scatter, title
from flexsid.records.run import Pole
from flexsid.records.views import PoleGroup, PoleMap

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
            trace[key] = error_bars(std, colour, factor=1.0, thickness=1, width=3)
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


def _format(value: float, error: float | None) -> str:
    return f"{value:.3f}" if error is None else f"{value:.3f} ± {error:.3f}"
