"""Mode shape as a picture in lines (SVG), still or moving."""

from __future__ import annotations

from collections.abc import Iterator
from html import escape

import numpy as np

from flexsid.figures import quantities
from flexsid.records.modal_data import DrawnShape

_WIDTH, _HEIGHT = 960.0, 560.0  # px
_PHASES = 24  # pictures of one cycle
_PERIOD_S = 1.6
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
    middle = 0.5 * (nodes.min(axis=0) + nodes.max(axis=0))
    radius = max(float(np.linalg.norm(nodes - middle, axis=1).max()), 1e-9)
    size = min(_WIDTH, 1.7 * _HEIGHT) / (2.15 * radius)
    factor = scale * shape.span_m / max(shape.largest_m, 1e-30)

    def project(places: np.ndarray) -> np.ndarray:
        x, y, z = (places - middle).T
        right = -np.sin(azimuth) * x + np.cos(azimuth) * y
        towards = np.cos(azimuth) * x + np.sin(azimuth) * y
        up = np.cos(elevation) * z - np.sin(elevation) * towards
        return np.column_stack([_WIDTH / 2.0 + size * right, _HEIGHT / 2.0 - size * up])

    still = np.zeros_like(nodes)
    in_phase = factor * np.asarray(shape.displacement_m, dtype=float)
    ahead = still if shape.quadrature_m is None else factor * np.asarray(shape.quadrature_m, float)

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
    yield (
        f'<text x="16" y="{_HEIGHT - 16:g}" font-family="sans-serif" font-size="16">{title}'
        "</text></svg>\n"
    )
