"""Responses to requests that are computed in the background."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Any

from fastapi import APIRouter, Depends, status

from flexsid.api.analyst import TheAnalyst
from flexsid.api.context import Context, TheContext, TheStore
from flexsid.api.parameters import query_as
from flexsid.api.serialization import Json
from flexsid.jobs.kind import Kind, find_job, submit
from flexsid.storage import job_list
from flexsid.storage.store import Store


def submit_job(
    context: Context, kind: Kind[Any, Any], request: object, author: str, title: str
) -> Json:
    """Queue a job, or find that of an equal request; ``Location`` is its address."""
    job = submit(context.store, kind, request, author, title)
    assert job.id is not None
    context.dispatcher.wake()
    location = {"Location": f"/api/v1/jobs/{job.id}"}
    return Json(job_list.get(context.store, job.id), status.HTTP_202_ACCEPTED, location)


@dataclass(frozen=True, slots=True)
class KnownJob:
    """The newest job of an equal request; null if there is none."""

    job: job_list.JobItem | None


def add_job_routes(
    router: APIRouter,
    path: str,
    kind: Kind[Any, Any],
    name: str,
    make_title: Callable[[Store, Any], str],
    *in_path: str,
) -> None:
    """Add the routes that request a stored result, and that find the job of an equal request.

    Parameters
    ----------
    router
        Router of the feature, whose further route returns the result.
    path
        Address of the result below the router.
    kind
        Kind of the job.
    name
        Noun of the result: the routes are ``request_{name}`` and ``get_{name}_job``.
    make_title
        Returns the title of the job.
    *in_path
        Ids of the request that are in the path; all other fields are in the query.
    """
    read = query_as(kind.request, *in_path)

    def request(context: TheContext, query: Any, analyst: TheAnalyst) -> Json:
        return submit_job(context, kind, query, analyst, make_title(context.store, query))

    def find(store: TheStore, query: Any) -> Json:
        job = find_job(store, kind, query)
        return Json(KnownJob(None if job is None else job_list.get(store, job.id or 0)))

    request.__annotations__["query"] = Annotated[kind.request, Depends(read)]
    find.__annotations__["query"] = Annotated[kind.request, Depends(read)]
    router.add_api_route(
        f"{path}/results",
        request,
        methods=["POST"],
        name=f"request_{name}",
        description=f"{kind.label}: queue the job, or return that of an equal request.",
        response_model=job_list.JobItem,
        status_code=status.HTTP_202_ACCEPTED,
    )
    router.add_api_route(
        f"{path}/results",
        find,
        name=f"get_{name}_job",
        description=f"{kind.label}: return the newest job of an equal request; null without one.",
        response_model=KnownJob,
    )
