"""Closed-loop stability of identified models with a controller."""

from __future__ import annotations

from dataclasses import fields
from typing import Annotated

from fastapi import Depends

from flexsid.api.context import TheStore
from flexsid.api.models.response_models import extend_record, response_of
from flexsid.api.parameters import query_as
from flexsid.api.router import make_router
from flexsid.api.serialization import Json
from flexsid.api.submission import add_job_routes
from flexsid.jobs.kind import get_result
from flexsid.jobs.kinds import CLOSED_LOOP
from flexsid.records import finite_or_none
from flexsid.records.flutter import ClosedLoop, LoopMargin
from flexsid.text import count_noun
from flexsid.workflow.flutter.closed_loop import ClosedLoopQuery

router = make_router("/closed-loop", tag="closed-loop")


@response_of(LoopMargin, array=float | None)
class MarginRow:
    """Stability margins of the loop of one surface at one airspeed.

    A margin is null if the loop is unstable or has no crossover. ``gain_std`` is the standard
    deviation of the natural logarithm of the gain margin.
    """

    airspeed_m_s: float


@response_of(
    ClosedLoop,
    without=("airspeed_m_s", "growth", "growth_std", "closed_roots", "open_roots"),
)
class ClosedLoopStability:
    """Airspeed at which the closed loop becomes unstable, and stability margins over airspeed."""

    margins: list[MarginRow]


_MARGINS = tuple(one.name for one in fields(LoopMargin) if one.name != "surface")
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
        extend_record(
            ClosedLoopStability,
            found,
            margins=[
                extend_record(
                    *(MarginRow, margin),
                    airspeed_m_s=float(airspeed),
                    **{name: finite_or_none(getattr(margin, name)[k]) for name in _MARGINS},
                )
                for margin in found.margins
                for k, airspeed in enumerate(found.airspeed_m_s)
            ],
        )
    )
