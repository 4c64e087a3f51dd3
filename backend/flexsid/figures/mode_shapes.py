"""Mode shapes, and the lattice of a computed prediction, as pictures."""

from __future__ import annotations

from collections.abc import Iterator
from html import escape
from typing import Any

import numpy as np

from flexsid.figures import quantities, style
from flexsid.figures.quantities import of_unit
from flexsid.figures.spec import Spec, column, plane, scatter, title
from flexsid.figures.style import format_unit, parameter_label
from flexsid.records.modal_data import DrawnShape
from flexsid.records.views import LatticeQuantity, LatticeView

# --- Boxes of a lattice by a quantity in oblique view, and the layout of surfaces and sensors -----

_AZIMUTH, _ELEVATION = np.radians(65.0), np.radians(40.0)  # of the view, from ahead on the left
_SEQUENTIAL = ("#0d0887", "#5b02a3", "#9a179b", "#cb4678", "#eb7852", "#fbb32f", "#f0f921")
_DIVERGING = ("#2166ac", "#67a9cf", "#d1e5f0", "#f7f7f7", "#fddbc7", "#ef8a62", "#b2182b")
_PLAIN = "rgba(134,142,150,0.18)"
_EDGE = {"color": style.GREY, "width": 0.5}


def draw_lattice(value: LatticeView) -> Spec:
    """Draw boxes coloured by a quantity; of the layout from above, with the sensors."""
    if value.quantity is LatticeQuantity.LAYOUT:
        return _draw_layout(value)
    return _draw_quantity(value)


def _draw_layout(value: LatticeView) -> Spec:
    right, aft = of_unit("Y, right", "m"), of_unit("X, aft", "m")
    places = right.factor * value.corners[:, :, [1, 0]]
    data = [_fill(places[np.isnan(value.values)], _PLAIN, "boxes")]
    for index, name in enumerate(value.surfaces):
        colour, _ = style.of_index(index)
        data.append(_fill(places[value.values == index], colour, name))
    if value.sensors:
        names: dict[tuple[float, float], list[str]] = {}
        for name, x, y in value.sensors:
            names.setdefault((right.factor * y, right.factor * x), []).append(name)
        places_of_sensors = np.array(list(names))
        data.append(
            scatter(
                places_of_sensors[:, 0], places_of_sensors[:, 1], "markers+text", name="sensors",
                text=[_shorten(own) for own in names.values()],
                customdata=[", ".join(own) for own in names.values()],
                textposition="top center", textfont={"size": 10},
                marker={"color": style.FLAG, "size": 7},
                hovertemplate=f"%{{customdata}}<br>X %{{y:.3g}} {aft.unit}<br>"
                f"Y %{{x:.3g}} {right.unit}<extra></extra>",
            )
        )  # fmt: skip
    horizontal = {**title(right.axis_title), "zeroline": False}
    vertical = {**title(aft.axis_title), "autorange": "reversed", "zeroline": False}
    return {"data": data, "layout": _lay_out(horizontal, vertical, value.note)}


def _shorten(names: list[str]) -> str:
    """Return the names at one place, those beyond two as a count."""
    return ", ".join(names[:2]) + (f" +{len(names) - 2}" if len(names) > 2 else "")


def _name_pressure(variable: str) -> str:
    """Return the pressure coefficient per nondimensional variable, with its unit."""
    length = {"q": "c̄", "p": "b", "r": "b"}.get(variable, "c̄" * variable.startswith("etadot"))
    per = parameter_label(variable) + (f" {length}/2V" if length else "")
    return f"pressure coefficient per {per} {format_unit(f'CZ_{variable}')}".strip()


def _draw_quantity(value: LatticeView) -> Spec:
    names = {
        LatticeQuantity.MODE: f"displacement of {value.parameter}, largest 1",
        LatticeQuantity.ASPECT_RATIO: "aspect ratio of boxes",
        LatticeQuantity.RESOLUTION: "boxes per wavelength",
    }
    name = names.get(value.quantity) or _name_pressure(value.parameter)
    places = _project(value.corners)
    is_signed = value.quantity in (LatticeQuantity.PRESSURE, LatticeQuantity.MODE)
    colours = _DIVERGING if is_signed else _SEQUENTIAL
    # A few boxes at the leading edge would leave no colours of pressure to the others.
    share_shown = 0.98 if value.quantity is LatticeQuantity.PRESSURE else 1.0
    largest = float(np.quantile(np.abs(value.values), share_shown))
    low, high = (
        (-largest, largest) if is_signed else (float(value.values.min()), float(value.values.max()))
    )
    share = (np.clip(value.values, low, high) - low) / max(high - low, 1e-30)
    place = np.minimum((share * len(colours)).astype(int), len(colours) - 1)
    data = [
        _fill(places[place == index], colour, f"class {index + 1}", showlegend=False)
        for index, colour in enumerate(colours)
    ]
    middle = places.mean(axis=1)
    steps = np.linspace(0.0, 1.0, len(colours) + 1)
    scale = [
        [float(end), colour]
        for low_end, high_end, colour in zip(steps[:-1], steps[1:], colours, strict=True)
        for end in (low_end, high_end)
    ]
    data.append(
        scatter(
            middle[:, 0], middle[:, 1], name=name, showlegend=False,
            marker={
                "size": 6, "opacity": 0, "color": column(value.values), "cmin": low, "cmax": high,
                "colorscale": scale, "showscale": True,
                "colorbar": {"title": {"text": name, "side": "right"}, "thickness": 14},
            },
            customdata=column(value.values),
            hovertemplate="%{customdata:.4g}<extra></extra>",
        )
    )  # fmt: skip
    hidden = {"visible": False}
    return {"data": data, "layout": _lay_out(hidden, hidden, value.note)}


def _lay_out(horizontal: Spec, vertical: Spec, note: str) -> Spec:
    layout = plane(horizontal, {**vertical, "scaleanchor": "x"}, 4)
    return {**layout, "meta": {"rows": 4, "note": note}}


def _fill(places: np.ndarray, colour: str, name: str, **more: Any) -> Spec:
    """Return closed outlines (n, 4, 2) as one filled trace; NaN separates them."""
    outlines = np.full((places.shape[0], 6, 2), np.nan)
    outlines[:, :4], outlines[:, 4] = places, places[:, 0]
    x, y = outlines.reshape(-1, 2).T
    fill = {"fill": "toself", "fillcolor": colour, "line": _EDGE, "hoverinfo": "skip"}
    return scatter(x, y, "lines", name=name, **fill, **more)


def _project(places: np.ndarray) -> np.ndarray:
    """Project (n, 4, 3) places, x aft, y right and z up, onto the plane of the view."""
    x, y, z = np.moveaxis(places, -1, 0)
    across = np.sin(_AZIMUTH) * y - np.cos(_AZIMUTH) * x
    towards = np.cos(_AZIMUTH) * y + np.sin(_AZIMUTH) * x
    return np.stack([across, np.cos(_ELEVATION) * z - np.sin(_ELEVATION) * towards], axis=-1)


# --- Mode shape as a picture in lines (SVG), still or moving --------------------------------------

_WIDTH, _HEIGHT = 960.0, 560.0  # px
_PHASES = 24  # pictures of one cycle
_PERIOD_S = 1.6
_MARGIN, _CAPTION, _ARROW = 24.0, 32.0, 36.0  # px
_STILL, _MOVED, _SENSOR = "#adb5bd", "#111111", "#d55e00"


def draw_shape_picture(
    shape: DrawnShape,
    *,
    scale: float = 0.1,
    azimuth: float = -2.2,
    elevation: float = 0.42,
    moving: bool = False,
) -> Iterator[str]:
    """Draw a mode: undeformed faint, deformed strong, sensors as dots; moving through one cycle.

    Parameters
    ----------
    shape
        Nodes, lines and displacements.
    scale
        Largest displacement as a share of the span.
    azimuth, elevation
        Direction of view, about the vertical and up from the horizon. [rad]
    moving
        Whether the lines move (SMIL, in any browser), instead of the largest displacement.
    """
    nodes = np.asarray(shape.nodes_m, dtype=float)
    factor = scale * shape.span_m / max(shape.largest_m, 1e-30)
    still = np.zeros_like(nodes)
    in_phase = factor * np.asarray(shape.displacement_m, dtype=float)
    ahead = still if shape.quadrature_m is None else factor * np.asarray(shape.quadrature_m, float)
    s = np.sin(elevation)
    # rows: to the right and up on the page
    view = np.array(
        [
            [-np.sin(azimuth), np.cos(azimuth), 0.0],
            [-s * np.cos(azimuth), -s * np.sin(azimuth), np.cos(elevation)],
        ]
    )
    farthest = np.concatenate(
        [nodes + share * in_phase for share in (-1, 0, 1) if moving or share >= 0]
    )
    if moving:
        farthest = np.concatenate([farthest, nodes + ahead, nodes - ahead])
    across = farthest @ view.T
    low, high = across.min(axis=0), across.max(axis=0)
    room = np.array([_WIDTH, _HEIGHT - _CAPTION]) - 2.0 * _MARGIN
    size = float(np.min(room / np.maximum(high - low, 1e-9)))
    centre = np.array([_WIDTH, _HEIGHT - _CAPTION]) / 2.0

    def project(places: np.ndarray) -> np.ndarray:
        return centre + size * (places @ view.T - (low + high) / 2.0) * [1.0, -1.0]

    def trace(displacement: np.ndarray) -> str:
        places = project(nodes + displacement)
        return "".join(
            f"M{a[0]:.1f} {a[1]:.1f}L{b[0]:.1f} {b[1]:.1f}" for a, b in places[shape.lines]
        )

    hertz = quantities.of_unit("Frequency", "Hz")
    frequency = f"{hertz.factor * shape.frequency_hz:.3f} {hertz.unit}"
    title = escape(f"{shape.name}, {frequency}, fuel {100.0 * shape.fuel:g} %")
    yield (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_WIDTH:g} {_HEIGHT:g}">'
        f'<title>{title}</title><rect width="100%" height="100%" fill="#ffffff"/>'
        f'<path d="{trace(still)}" stroke="{_STILL}" stroke-width="1" fill="none"/>'
    )
    drawn = f'stroke="{_MOVED}" stroke-width="1.4" fill="none"'
    if moving:
        yield f'<path d="{trace(ahead)}" {drawn}><animate attributeName="d" values="'
        for place in range(_PHASES + 1):
            angle = 2.0 * np.pi * place / _PHASES
            moved = np.sin(angle) * in_phase + np.cos(angle) * ahead
            yield (";" if place else "") + trace(moved)
        yield f'" dur="{_PERIOD_S:g}s" repeatCount="indefinite"/></path>'
    else:
        yield f'<path d="{trace(in_phase)}" {drawn}/>'
    if shape.sensors:
        for x, y in project(np.array([sensor.location_m for sensor in shape.sensors])):
            yield f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3" fill="{_SENSOR}"/>'
    yield from _draw_axes(view)
    yield (
        f'<text x="16" y="{_HEIGHT - 16:g}" font-family="sans-serif" font-size="16">{title}'
        "</text></svg>\n"
    )


def _draw_axes(view: np.ndarray) -> Iterator[str]:
    """Draw the axes of the nodes as arrows of one length in the lower right corner."""
    origin = np.array([_WIDTH - 3.0 * _MARGIN, _HEIGHT - 2.5 * _MARGIN])
    for name, direction in zip("xyz", view.T, strict=True):
        (x, y), (u, v) = (
            origin + _ARROW * direction * [1, -1],
            origin + 1.3 * _ARROW * direction * [1, -1],
        )
        yield (
            f'<line x1="{origin[0]:.1f}" y1="{origin[1]:.1f}" x2="{x:.1f}" y2="{y:.1f}"'
            f' stroke="{_MOVED}"/>'
            f'<text x="{u:.1f}" y="{v:.1f}" font-family="sans-serif" font-size="14"'
            f' text-anchor="middle" dominant-baseline="middle">{name}</text>'
        )
