"""Query parameters of the display units of a response, and of the format of a printed figure."""

from __future__ import annotations

from typing import Annotated

from fastapi import Depends, Query

from flexsid.display_units import DisplayUnits, FrequencyUnit, UnitSystem
from flexsid.figures.print_format import PrintFormat


# Asynchronous, so that no thread of the pool is needed.
async def _read_units(
    units: Annotated[
        UnitSystem,
        Query(description="Display units: metric with deg and g, US customary, or SI with rad."),
    ] = UnitSystem.METRIC,
    frequency_unit: Annotated[
        FrequencyUnit, Query(description="Display unit of frequencies.")
    ] = FrequencyUnit.HERTZ,
) -> DisplayUnits:
    return DisplayUnits(units, frequency_unit)


TheUnits = Annotated[DisplayUnits, Depends(_read_units)]


async def _read_print_format(
    width_mm: Annotated[
        float | None,
        Query(ge=20.0, le=1000.0, allow_inf_nan=False, description="Width of the figure. [mm]"),
    ] = None,
    height_mm: Annotated[
        float | None,
        Query(ge=20.0, le=1000.0, allow_inf_nan=False, description="Height of the figure. [mm]"),
    ] = None,
    font_pt: Annotated[
        float | None,
        Query(ge=4.0, le=72.0, allow_inf_nan=False, description="Size of the font. [pt]"),
    ] = None,
    figure_title: Annotated[
        str | None, Query(max_length=200, description="Title above the figure.")
    ] = None,
) -> PrintFormat:
    return PrintFormat(width_mm, height_mm, font_pt, figure_title)


ThePrintFormat = Annotated[PrintFormat, Depends(_read_print_format)]
