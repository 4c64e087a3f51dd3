"""Closed-loop stability of identified models with a controller."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from fastapi import Depends

from flexsid.api.context import TheStore
from flexsid.api.queries import query_as
from flexsid.api.router import make_router
from flexsid.api.serialization import Json
from flexsid.api.submission import add_job_routes
from flexsid.jobs.kind import get_result
from flexsid.jobs.kinds import CLOSED_LOOP
from flexsid.records import finite_or_none
from flexsid.records.run import DerivedRun
from flexsid.text import count_noun
from flexsid.workflow.flutter.closed_loop import ClosedLoopQuery

router = make_router("/closed-loop", tag="closed-loop")


@dataclass(frozen=True, slots=True, kw_only=True)
class MarginRow:
    """Stability margins of the loop of one surface at one airspeed.

    A margin is null if the loop is unstable or has no crossover. ``gain_std`` is the standard
    deviation of the natural logarithm of the gain margin.
    """

    surface: str
    airspeed_m_s: float
    gain: float | None
    gain_std: float | None
    phase_rad: float | None
    phase_std_rad: float | None
    disk: float | None
    disk_std: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class ClosedLoopStability:
    """Airspeed at which the closed loop becomes unstable, and stability margins over airspeed."""

    sentence: str
    controller: str
    fuel_fraction: float
    density_kg_m3: float
    tested_m_s: float
    lost_m_s: float | None
    spread_m_s: float
    low_m_s: float | None
    high_m_s: float | None
    margins: list[MarginRow]
    derived_runs: tuple[DerivedRun, ...]


TheClosedLoopQuery = Annotated[ClosedLoopQuery, Depends(query_as(ClosedLoopQuery))]

add_job_routes(
    *(router, "", CLOSED_LOOP, "closed_loop"),
    lambda store, query: count_noun(len(query.flutter.run_ids), "run"),
)


@router.get("", response_model=ClosedLoopStability)
def get_closed_loop(store: TheStore, query: TheClosedLoopQuery) -> Json:
    """Return the stored stability limit and margins of the runs with a controller."""
    found = get_result(store, CLOSED_LOOP, query)
    return Json(
        ClosedLoopStability(
            sentence=found.sentence,
            controller=found.controller,
            fuel_fraction=found.fuel_fraction,
            density_kg_m3=found.density_kg_m3,
            tested_m_s=found.tested_m_s,
            lost_m_s=found.lost_m_s,
            spread_m_s=found.spread_m_s,
            low_m_s=found.low_m_s,
            high_m_s=found.high_m_s,
            margins=[
                MarginRow(
                    surface=margin.surface,
                    airspeed_m_s=float(found.airspeed_m_s[k]),
                    gain=finite_or_none(margin.gain[k]),
                    gain_std=finite_or_none(margin.gain_std[k]),
                    phase_rad=finite_or_none(margin.phase_rad[k]),
                    phase_std_rad=finite_or_none(margin.phase_std_rad[k]),
                    disk=finite_or_none(margin.disk[k]),
                    disk_std=finite_or_none(margin.disk_std[k]),
                )
                for margin in found.margins
                for k in range(found.airspeed_m_s.size)
            ],
            derived_runs=found.derived_runs,
        )
    )
