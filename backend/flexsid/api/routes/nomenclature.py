"""The glossary."""

from __future__ import annotations

from fastapi import APIRouter

from flexsid.api.answers import Glossary, GlossaryEntry
from flexsid.api.wire import Json
from flexsid.nomenclature import GLOSSARY

router = APIRouter(prefix="/nomenclature", tags=["nomenclature"])


@router.get("", response_model=Glossary)
async def list_nomenclature() -> Json:
    """List every quantity with its unit and meaning."""
    entries = [
        GlossaryEntry(
            symbol=s.symbol,
            unit=s.unit,
            display_unit=s.display_unit,
            label=s.label,
            meaning=s.meaning,
        )
        for s in GLOSSARY
    ]
    return Json(Glossary(items=entries))
