"""Query parameters of responses in display units; all other responses are in SI."""

from __future__ import annotations

from typing import Annotated

from fastapi import Depends, Query

from flexsid.display_units import DisplayUnits, FrequencyUnit, UnitSystem


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
