"""The glossary."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query

from flexsid.api.responses import Glossary, GlossaryEntry
from flexsid.api.serialization import Json, split_names
from flexsid.nomenclature import GLOSSARY, Symbol, describe

router = APIRouter(prefix="/nomenclature", tags=["nomenclature"])


@router.get("", response_model=Glossary)
async def list_nomenclature(
    names: Annotated[
        str | None,
        Query(
            max_length=4_000,
            description="Channels, derivatives or symbols, separated by commas; all if omitted.",
        ),
    ] = None,
) -> Json:
    """List all quantities with unit and meaning, or those of the given names."""
    requested = split_names(names)
    symbols = GLOSSARY if requested is None else tuple(describe(name) for name in requested)
    return Json(Glossary(items=[_make_entry(symbol) for symbol in symbols]))


def _make_entry(symbol: Symbol) -> GlossaryEntry:
    return GlossaryEntry(
        symbol=symbol.symbol,
        unit=symbol.unit,
        display_unit=symbol.display_unit,
        label=symbol.label,
        meaning=symbol.meaning,
    )
