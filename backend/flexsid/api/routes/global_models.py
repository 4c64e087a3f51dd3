"""Global aerodynamic model: derivatives over the envelope from the estimates of all runs."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Depends, Query, status

from flexsid.api.analyst import TheAnalyst
from flexsid.api.context import TheContext, TheStore
from flexsid.api.serialization import Json
from flexsid.api.submission import KnownJob, respond_with_job, submit_job
from flexsid.figure_table import GlobalModelParameters
from flexsid.jobs.kind import get_result
from flexsid.jobs.kinds import GLOBAL_MODEL
from flexsid.records.global_model import GlobalModelSummary
from flexsid.storage.job_list import JobItem
from flexsid.workflow.global_model.estimates import GlobalModelQuery

router = APIRouter(prefix="/global-models", tags=["global model"])


async def _read_query(
    parameters: Annotated[GlobalModelParameters, Query()],
) -> GlobalModelQuery:
    return GlobalModelQuery(**dict(parameters))


TheGlobalModelQuery = Annotated[GlobalModelQuery, Depends(_read_query)]


@router.post("/results", response_model=JobItem, status_code=status.HTTP_202_ACCEPTED)
def request_global_model(
    context: TheContext, query: TheGlobalModelQuery, analyst: TheAnalyst
) -> Json:
    """Queue the global model of these runs, or return the job of an equal request."""
    return submit_job(context, GLOBAL_MODEL, query, analyst, f"{len(query.run_ids)} runs")


@router.get("/results", response_model=KnownJob)
def get_global_model_job(store: TheStore, query: TheGlobalModelQuery) -> Json:
    """Return the newest job of an equal request; null if there is none."""
    return respond_with_job(store, GLOBAL_MODEL, query)


@router.get("", response_model=GlobalModelSummary)
def get_global_model(store: TheStore, query: TheGlobalModelQuery) -> Json:
    """Return the stored global model of these runs: derivatives, scores and outlying runs.

    The figures ``global-slice`` and ``global-coverage`` have its values over the envelope.
    """
    return Json(get_result(store, GLOBAL_MODEL, query).summary)
