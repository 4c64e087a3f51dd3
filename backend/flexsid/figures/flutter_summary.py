"""Damping and frequency over airspeed of the roots of a flutter summary: V-g and V-f."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from flexsid.figures import style
from flexsid.figures.quantities import of_unit, text
from flexsid.figures.spec import (
    Spec,
    column,
    empty,
    line_at,
    scatter,
    stack,
    title,
    vertical_mark,
)
from flexsid.records.flutter import RootBranch
from flexsid.records.flutter_summary import (
    FlutterPoint,
    Instability,
    SummaryDiagram,
    SummaryRoot,
)

_REAL = 0.05
"""rad/s: a root of a prediction below is real."""

_SHOWN_G = (-0.6, 0.3)
"""Largest range of damping in view at first; a static motion has g down to -10."""

_FACTOR = 1.15


def draw_flutter_summary(value: SummaryDiagram) -> Spec:
    """Draw structural damping g over frequency, with instabilities and a prediction, dashed.

    Neutral roots are thin and grey.
    """
    shown = value.roots
    if not shown.roots:
        return empty("No root in this analysis")
    speed, frequency = of_unit("Airspeed", "m/s"), of_unit("Frequency", "Hz")
    data: list[Spec] = []
    for root, colour, symbol, width in _select_styles(shown.roots):
        name = _name(root)
        for row, (values, of_y) in enumerate(
            (
                (np.asarray(root.damping_g), ""),
                (frequency.factor * np.asarray(root.frequency_hz), f" {frequency.unit}"),
            ),
            start=1,
        ):
            data.append(
                scatter(
                    column(speed.factor * np.asarray(root.airspeed_m_s), exact=True),
                    column(values, exact=True),
                    "lines+markers",
                    row=row,
                    name=name,
                    legendgroup=name,
                    showlegend=row == 1,
                    line={"color": colour, "width": width},
                    marker={"color": colour, "symbol": symbol, "size": 3.0 * width + 1.0},
                    hovertemplate=f"%{{x:.4~g}} {speed.unit}<br>%{{y:.4~g}}{of_y}"
                    f"<extra>{name}</extra>",
                )
            )
    if value.predicted is not None:
        for branch in value.predicted.branches:
            data += _draw_predicted(branch, value.predicted.at)
    data += _draw_points(shown.points, shown.g)
    layout = stack(
        title(speed.axis_title),
        [
            {**title("Structural damping g"), "range": _find_range(shown.roots)},
            {**title(frequency.axis_title), "rangemode": "tozero"},
        ],
        showlegend=True,
        hovermode="closest",
        meta={"rows": 4, "note": " ".join(shown.notes)},
        shapes=[line_at(0.0, "y")],
        annotations=[],
    )
    if shown.g:
        layout["shapes"].append(
            line_at(shown.g, "y", line={"color": style.GREY, "width": 1.2, "dash": "dot"})
        )
    for kind in Instability:
        seen = [point.airspeed_m_s for point in shown.points if point.kind is kind]
        if seen:
            shape, note = vertical_mark(speed.factor * min(seen), kind.value)
            layout["shapes"].append(shape)
            layout["annotations"].append(note)
    return {"data": data, "layout": layout}


def _name(root: SummaryRoot) -> str:
    return text(f"{root.number} {root.name}" if root.name else f"root {root.number}")


def _select_styles(
    roots: tuple[SummaryRoot, ...],
) -> Iterator[tuple[SummaryRoot, str, str, float]]:
    """Select colour, symbol and width of every root; grey for neutral ones."""
    shown = 0
    for root in roots:
        if root.is_neutral:
            yield root, style.GREY, "circle", 0.8
        else:
            yield root, *style.of_index(shown), 1.6
            shown += 1


def _draw_predicted(branch: RootBranch, airspeed: np.ndarray) -> list[Spec]:
    """Draw a root of a prediction; g is twice the ratio of its real and imaginary part."""
    oscillates = branch.imag > _REAL
    imag = np.where(oscillates, branch.imag, np.nan)
    name = f"{text(branch.name)}, predicted"
    speed, frequency = of_unit("Airspeed", "m/s"), of_unit("Frequency", "Hz")
    return [
        scatter(
            column(speed.factor * airspeed, exact=True),
            column(values),
            "lines",
            row=row,
            name=name,
            legendgroup=name,
            showlegend=row == 1,
            line={"color": style.GREY, "dash": "dash", "width": 1.4},
            hovertemplate=f"%{{x:.4~g}} {speed.unit}<br>%{{y:.4~g}}{of_y}<extra>{name}</extra>",
        )
        for row, (values, of_y) in enumerate(
            (
                (2.0 * branch.real / imag, ""),
                (frequency.factor * imag / (2.0 * np.pi), f" {frequency.unit}"),
            ),
            start=1,
        )
    ]


def _draw_points(points: tuple[FlutterPoint, ...], g: float) -> list[Spec]:
    """Draw where roots become unstable: at the damping g, and on the axis of frequency."""
    if not points:
        return []
    speed, frequency = of_unit("Airspeed", "m/s"), of_unit("Frequency", "Hz")
    symbols = [
        "triangle-left-open"
        if point.is_bound
        else {Instability.FLUTTER: "x", Instability.DIVERGENCE: "diamond-open"}[point.kind]
        for point in points
    ]
    labels = [
        f"{point.kind.value} of root {point.root}"
        + (", unstable at or below this speed" if point.is_bound else "")
        for point in points
    ]
    at = [0.0 if point.kind is Instability.DIVERGENCE else g for point in points]
    return [
        scatter(
            column([speed.factor * point.airspeed_m_s for point in points], exact=True),
            column(y),
            row=row,
            name="instabilities",
            legendgroup="instabilities",
            showlegend=row == 1,
            marker={"color": style.FLAG, "symbol": symbols, "size": 10},
            text=labels,
            hovertemplate=f"%{{text}}<br>%{{x:.4~g}} {speed.unit}<extra></extra>",
        )
        for row, y in (
            (1, at),
            (2, [frequency.factor * point.omega_rad_s / (2.0 * np.pi) for point in points]),
        )
    ]


def _find_range(roots: tuple[SummaryRoot, ...]) -> list[float]:
    """Return the range of damping in view: that of roots that oscillate, within ``_SHOWN_G``."""
    known = [
        g
        for root in roots
        for g, hertz in zip(root.damping_g, root.frequency_hz, strict=True)
        if hertz > 0.0 and not root.is_neutral
    ]
    low = max(min(known, default=-0.1), _SHOWN_G[0])
    high = min(max(max(known, default=0.0), -0.1 * low, 1e-3), _SHOWN_G[1])
    return [_FACTOR * low, _FACTOR * high]
