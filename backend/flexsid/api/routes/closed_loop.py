"""Closed loop: a controller around what runs identified."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from fastapi import APIRouter, Query, status

from flexsid.api.context import TheContext, TheStore
from flexsid.api.routes.flutter import TheQuestion
from flexsid.api.wire import Json
from flexsid.storage.repository import LARGEST_ID
from flexsid.workflow.background_tasks import Report, TaskProgress
from flexsid.workflow.flutter import closed_loop as workflow

router = APIRouter(prefix="/closed-loop", tags=["closed-loop"])

ControllerId = Annotated[int, Query(ge=1, le=LARGEST_ID)]


@dataclass(frozen=True, slots=True, kw_only=True)
class MarginRow:
    """Margins of one surface's loop at one airspeed; None where unstable or not crossed.

    A gain margin scatters as a factor: ``gain_std`` is the standard deviation of its logarithm.
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
class ClosedLoopAnswer:
    """Where the closed loop loses stability, and its margins over airspeed."""

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


@router.post("/answers", response_model=TaskProgress, status_code=status.HTTP_202_ACCEPTED)
def find_closed_loop(
    context: TheContext, question: TheQuestion, controller_id: ControllerId
) -> Json:
    """Begin to find the answer for many runs; then it is there at once."""

    def work(report: Report) -> None:
        workflow.find_closed_loop(context.store, question, controller_id, report)

    known = len(question.run_ids)
    title = f"{known} run{'' if known == 1 else 's'}"
    begun = context.tasks.begin("closed-loop", title, work)
    return Json(begun, status.HTTP_202_ACCEPTED, {"Location": f"/api/v1/tasks/{begun.id}"})


@router.get("", response_model=ClosedLoopAnswer)
def get_closed_loop(store: TheStore, question: TheQuestion, controller_id: ControllerId) -> Json:
    """Say how far a controller's loop around the identified aircraft is from instability."""
    found = workflow.closed_loop(store, question, controller_id)
    return Json(
        ClosedLoopAnswer(
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
                    gain=_finite(margin.gain[k]),
                    gain_std=_finite(margin.gain_std[k]),
                    phase_rad=_finite(margin.phase_rad[k]),
                    phase_std_rad=_finite(margin.phase_std_rad[k]),
                    disk=_finite(margin.disk[k]),
                    disk_std=_finite(margin.disk_std[k]),
                )
                for margin in found.margins
                for k in range(found.airspeed_m_s.size)
            ],
        )
    )


def _finite(value: float) -> float | None:
    return float(value) if abs(value) < float("inf") else None
