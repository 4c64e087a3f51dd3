"""Size, font and title of a figure as it is printed."""

from __future__ import annotations

from dataclasses import dataclass

from flexsid.figures.quantities import text
from flexsid.figures.spec import Spec

_PX_PER_MM = 96.0 / 25.4  # of CSS, in which plotly counts
_PX_PER_PT = 96.0 / 72.0


@dataclass(frozen=True, slots=True)
class PrintFormat:
    """Size of the figure [mm], size of its font [pt] and title; None for those of the reader."""

    width_mm: float | None = None
    height_mm: float | None = None
    font_pt: float | None = None
    title: str | None = None


def set_print_format(spec: Spec, value: PrintFormat) -> Spec:
    """Return the figure with the size, font and title of a print format."""
    layout = dict(spec["layout"])
    for name, size_mm in (("width", value.width_mm), ("height", value.height_mm)):
        if size_mm is not None:
            layout[name] = round(size_mm * _PX_PER_MM)
    if value.font_pt is not None:
        layout["font"] = {**layout.get("font", {}), "size": round(value.font_pt * _PX_PER_PT, 2)}
    if value.title:
        layout["title"] = {"text": text(value.title), "automargin": True}
    return {**spec, "layout": layout}
