"""Figures as Plotly specifications; colours and fonts are set by the frontend."""

from __future__ import annotations

from fastapi import APIRouter

from flexsid.api.export import FILES
from flexsid.api.routes.figures import (
    comparisons,
    decisions,
    designs,
    flutter,
    maneuvers,
    modes,
    runs,
    searches,
)

router = APIRouter(prefix="/figures", tags=["figures"], responses=FILES)
for _module in (maneuvers, runs, comparisons, flutter, searches, designs, decisions, modes):
    router.include_router(_module.router)
