"""The glossary."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query

from flexsid.api.answers import Glossary, GlossaryEntry
from flexsid.api.wire import Json, split_names
from flexsid.nomenclature import GLOSSARY, Symbol, describe

router = APIRouter(prefix="/nomenclature", tags=["nomenclature"])


@router.get("", response_model=Glossary)
async def list_nomenclature(
    names: Annotated[
        str | None,
        Query(
            max_length=4_000,
            description="Channels, derivatives or symbols, separated by commas; else the glossary.",
        ),
    ] = None,
) -> Json:
    """List every quantity with its unit and meaning, or describe names by what they follow."""
    asked = split_names(names)
    symbols = GLOSSARY if asked is None else tuple(describe(name) for name in asked)
    return Json(Glossary(items=[_entry(symbol) for symbol in symbols]))


def _entry(symbol: Symbol) -> GlossaryEntry:
    return GlossaryEntry(
        symbol=symbol.symbol,
        unit=symbol.unit,
        display_unit=symbol.display_unit,
        label=symbol.label,
        meaning=symbol.meaning,
    )
