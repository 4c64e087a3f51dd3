"""Closed-loop stability of identified models with a controller."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from fastapi import APIRouter, Query, status

from flexsid.api.context import TheContext, TheStore
from flexsid.api.routes.flutter import TheFlutterQuery
from flexsid.api.serialization import Json
from flexsid.storage.repository import LARGEST_ID
from flexsid.workflow.background_tasks import Report, TaskProgress
from flexsid.workflow.flutter import closed_loop as workflow

router = APIRouter(prefix="/closed-loop", tags=["closed-loop"])

ControllerId = Annotated[int, Query(ge=1, le=LARGEST_ID)]


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


@router.post("/results", response_model=TaskProgress, status_code=status.HTTP_202_ACCEPTED)
def start_closed_loop_analysis(
    context: TheContext, query: TheFlutterQuery, controller_id: ControllerId
) -> Json:
    """Start the closed-loop analysis as a task; its result is cached."""

    def work(report: Report) -> None:
        workflow.compute_closed_loop(context.store, query, controller_id, report)

    n_runs = len(query.run_ids)
    title = f"{n_runs} run{'' if n_runs == 1 else 's'}"
    task = context.tasks.begin("closed-loop", title, work)
    return Json(task, status.HTTP_202_ACCEPTED, {"Location": f"/api/v1/tasks/{task.id}"})


@router.get("", response_model=ClosedLoopStability)
def get_closed_loop(store: TheStore, query: TheFlutterQuery, controller_id: ControllerId) -> Json:
    """Return the stability limit and margins of the identified aircraft with a controller."""
    found = workflow.analyse_closed_loop(store, query, controller_id)
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
                    gain=_finite_or_none(margin.gain[k]),
                    gain_std=_finite_or_none(margin.gain_std[k]),
                    phase_rad=_finite_or_none(margin.phase_rad[k]),
                    phase_std_rad=_finite_or_none(margin.phase_std_rad[k]),
                    disk=_finite_or_none(margin.disk[k]),
                    disk_std=_finite_or_none(margin.disk_std[k]),
                )
                for margin in found.margins
                for k in range(found.airspeed_m_s.size)
            ],
        )
    )


def _finite_or_none(value: float) -> float | None:
    return float(value) if abs(value) < float("inf") else None
