"""The glossary."""

from __future__ import annotations

from typing import Annotated

from fastapi import Query

from flexsid.api.display import TheUnits
from flexsid.api.models.response_models import extend_record
from flexsid.api.models.responses import AxisNames, DisplayUnit, GlossaryEntry
from flexsid.api.router import make_router
from flexsid.api.serialization import JsonRoute
from flexsid.display_units import list_display_units, show_in
from flexsid.nomenclature import GLOSSARY, TERMS, explain
from flexsid.storage.paging import Page
from flexsid.sysid.model.axes import RIGID_BODIES
from flexsid.text import split_names

router = make_router("/nomenclature", tag="nomenclature", route_class=JsonRoute)


@router.get("")
def list_nomenclature(
    units: TheUnits,
    names: Annotated[
        str | None,
        Query(
            max_length=4_000,
            description="Channels, derivatives, symbols or terms, by commas; all if omitted.",
        ),
    ] = None,
) -> Page[GlossaryEntry]:
    """List all quantities and terms with unit and meaning, or those of the given names."""
    requested = split_names(names)
    symbols = (*GLOSSARY, *TERMS) if requested is None else tuple(map(explain, requested))
    with show_in(units):
        return Page(items=[extend_record(GlossaryEntry, symbol) for symbol in symbols])


@router.get("/units")
def list_units(units: TheUnits) -> Page[DisplayUnit]:
    """List the SI units, and Hz, with their display unit: displayed = factor * SI value."""
    with show_in(units):
        shown = list_display_units()
    return Page(
        items=[
            DisplayUnit(unit=unit, display_unit=name, factor=factor)
            for unit, (name, factor) in shown.items()
        ]
    )


@router.get("/axes")
def list_axes() -> Page[AxisNames]:
    """List the axes of models, with the coefficients and motions that name derivatives."""
    return Page(items=[extend_record(AxisNames, body) for body in RIGID_BODIES.values()])
