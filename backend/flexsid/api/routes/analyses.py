"""Routes of all analyses: they request a stored result, find its job, and return the result."""

from __future__ import annotations

import re
from functools import partial
from inspect import cleandoc
from typing import Annotated, Any

from fastapi import Depends, status

from flexsid.api.authorization import TheAnalyst
from flexsid.api.context import TheContext, TheStore
from flexsid.api.parameters import query_as
from flexsid.api.responses import KnownJob, submit_job
from flexsid.api.router import make_router
from flexsid.api.serialization import Json
from flexsid.jobs.kind import Analysis, find_job, get_result
from flexsid.jobs.kinds import ANALYSES
from flexsid.storage.jobs import job_list


def _add_routes(analysis: Analysis[Any, Any]) -> None:
    in_path = sorted(set(re.findall(r"{(\w+)}", analysis.path)))
    query_type = Annotated[analysis.request, Depends(query_as(analysis.request, *in_path))]

    def request(context: TheContext, query: Any, analyst: TheAnalyst) -> Json:
        return submit_job(context, analysis, query, analyst)

    def find(store: TheStore, query: Any) -> Json:
        job = find_job(store, analysis, query)
        return Json(KnownJob(None if job is None else job_list.get(store, job.id or 0)))

    def read(store: TheStore, query: Any) -> Json:
        return Json(analysis.show(get_result(store, analysis, query)))

    for function in (request, find, read):
        function.__annotations__["query"] = query_type
    add = partial(analyses_router.add_api_route, tags=[analysis.tag])
    add(
        f"{analysis.path}/results",
        request,
        methods=["POST"],
        name=f"request_{analysis.noun}",
        description=f"{analysis.label}: queue the job, or return that of an equal request.",
        response_model=job_list.JobItem,
        status_code=status.HTTP_202_ACCEPTED,
    )
    add(
        f"{analysis.path}/results",
        find,
        name=f"get_{analysis.noun}_job",
        description=f"{analysis.label}: return the newest job of an equal request; null without"
        " one.",
        response_model=KnownJob,
    )
    if analysis.about:
        add(
            analysis.path,
            read,
            name=f"get_{analysis.noun}",
            description=f"Return the stored {cleandoc(analysis.about)}",
            response_model=analysis.response,
        )


analyses_router = make_router(tag=None)
for _analysis in ANALYSES:
    _add_routes(_analysis)
