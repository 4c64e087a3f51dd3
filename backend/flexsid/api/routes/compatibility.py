"""Compatibility of the sensors of maneuvers by kinematics."""

from __future__ import annotations

from typing import Annotated

from fastapi import Depends

from flexsid.api.context import TheStore
from flexsid.api.parameters import query_as
from flexsid.api.router import make_router
from flexsid.api.serialization import Json
from flexsid.api.submission import add_job_routes
from flexsid.jobs.kind import get_result
from flexsid.jobs.kinds import COMPATIBILITY
from flexsid.records.compatibility import CompatibilityReport
from flexsid.storage.store import Store
from flexsid.text import count_noun
from flexsid.workflow.quality.compatibility import CompatibilityQuery

router = make_router(tag="quality")


TheQuery = Annotated[CompatibilityQuery, Depends(query_as(CompatibilityQuery))]


def _make_title(store: Store, query: CompatibilityQuery) -> str:
    if len(query.maneuver_ids) == 1:
        return store.maneuvers.get(query.maneuver_ids[0]).label
    return count_noun(len(query.maneuver_ids), "maneuver")


add_job_routes(router, "/compatibility", COMPATIBILITY, "compatibility", _make_title)


@router.get("/compatibility", response_model=CompatibilityReport)
def get_compatibility(store: TheStore, query: TheQuery) -> Json:
    """Return the stored comparison of the sensors of maneuvers by kinematics.

    It needs the locations of the sensors, and neither aerodynamics nor a modal table. Each fault
    has its correction, for ``/conditioning``, and the faults that the data do not separate from it.
    """
    return Json(get_result(store, COMPATIBILITY, query))
