"""Common query parameters and response model of figures."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any

from fastapi import Query

from flexsid.storage.repository import LARGEST_ID

Id = Annotated[int, Query(ge=1, le=LARGEST_ID)]
Ids = Annotated[str | None, Query(description="Ids separated by commas.")]
Names = Annotated[str | None, Query(description="Names separated by commas.")]


@dataclass(frozen=True, slots=True, kw_only=True)
class Figure:
    """A Plotly figure; theme, fonts and height are set by the frontend."""

    data: list[dict[str, Any]]
    layout: dict[str, Any]
