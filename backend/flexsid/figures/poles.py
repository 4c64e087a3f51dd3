"""Poles of the identified model in the s-plane, with ±1 standard error."""

from __future__ import annotations

from collections import Counter

import numpy as np

from flexsid.figures import style
from flexsid.figures.quantities import text
from flexsid.figures.spec import Spec, column, empty, title
from flexsid.records.run import Pole
from flexsid.records.views import PoleGroup, PoleMap

_REFERENCE = (
    (style.GREY, "x-thin-open"),
    (style.OCHRE, "square-open"),
    (style.PINK, "diamond-open"),
)


_NAME_WIDTH, _NAME_HEIGHT = 0.12, 0.06  # of a name, as fractions of the figure


def poles(value: PoleMap) -> Spec:
    """Draw poles in the upper half plane; poles right of the dashed line are unstable."""
    if not any(group.poles for group in value.groups):
        return empty("No poles")
    references = iter(_REFERENCE)
    repeats: Counter[str] = Counter()
    data = []
    names = iter(_names(value))
    for group in value.groups:
        if group.method is None:
            colour_symbol = next(references)
        else:
            colour_symbol = style.of_method(group.method.value, repeats[group.method.value])
            repeats[group.method.value] += 1
        data.append(_trace(group, colour_symbol, next(names)))
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
        "meta": {"rows": 2},
    }  # fmt: skip
    return {"data": data, "layout": layout}


def _names(value: PoleMap) -> list[list[str]]:
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


def _trace(group: PoleGroup, colour_symbol: tuple[str, str], names: list[str]) -> Spec:
    colour, symbol = colour_symbol
    trace: Spec = {
        "type": "scatter",
        "mode": "markers+text",
        "name": text(group.label),
        "x": column([pole.real for pole in group.poles]),
        "y": column([pole.imag for pole in group.poles]),
        "text": names,
        "textposition": "top right",
        "marker": {
            "color": colour,
            "symbol": symbol,
            "size": 9,
            "line": {"color": colour, "width": 2},
        },
        "customdata": [[group.run_id, _hover(pole)] for pole in group.poles],
        "hovertemplate": f"%{{customdata[1]}}<extra>{text(group.label)}</extra>",
    }
    if group.estimated:
        trace["error_x"] = _bars([pole.real_std for pole in group.poles], colour)
        trace["error_y"] = _bars([pole.imag_std for pole in group.poles], colour)
    return trace


def _bars(errors: list[float | None], colour: str) -> Spec:
    array = column([np.nan if error is None else error for error in errors])
    return {"type": "data", "array": array, "color": colour, "thickness": 1, "width": 3}


def _hover(pole: Pole) -> str:
    radius = float(np.hypot(pole.real, pole.imag))
    name = f"<b>{text(pole.name)}</b><br>" if pole.name else ""
    place = f"{name}{_pm(pole.real, pole.real_std)} + j {_pm(pole.imag, pole.imag_std)} rad/s"
    if pole.imag == 0 or radius == 0:
        return place
    return (
        f"{place}<br>frequency {radius / (2 * np.pi):.3f} Hz<br>damping {-pole.real / radius:.4f}"
    )


def _pm(value: float, error: float | None) -> str:
    return f"{value:.3f}" if error is None else f"{value:.3f} ± {error:.3f}"
