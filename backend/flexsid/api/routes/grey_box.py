"""Fits of grey-box models to maneuvers; code of a file is executed in personal mode only."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from typing import Annotated

from fastapi import Query, status

from flexsid.api.authorization import TheAnalyst
from flexsid.api.context import TheContext, TheStore
from flexsid.api.models.requests import Request
from flexsid.api.responses import submit_job
from flexsid.api.router import make_router
from flexsid.api.serialization import Identity, Json
from flexsid.extensions import MODELS, find_extension_package, list_extension_names
from flexsid.jobs.kinds import GREY_BOX, read_grey_box
from flexsid.records.grey_box import GreyBoxFit
from flexsid.records.run import AdequacyState
from flexsid.request_models import body_of
from flexsid.storage.access import Forbidden, storing_in_campaign
from flexsid.storage.jobs import job_list
from flexsid.storage.jobs.job_list import JobItem
from flexsid.storage.lists.list_query import Items
from flexsid.text import LARGEST_ID
from flexsid.workflow.measurements.grey_box_fits import GreyBoxQuery

grey_box_router = make_router(tag="maneuvers")


@body_of(GreyBoxQuery)
class GreyBoxRequest(Request):
    """Maneuver, model, method and band of a fit.

    ``model`` is the name of the file with ``source``, or that of an installed model.
    """


@dataclass(frozen=True, slots=True, kw_only=True)
class GreyBoxItem:
    """A fit of the list of a maneuver; ``id`` is that of its job."""

    id: int
    model: str
    title: str
    method: str
    band_hz: tuple[float, float]
    n_parameters: int
    bic: float
    adequacy: AdequacyState
    finished_at: datetime | None


@dataclass(frozen=True, slots=True, kw_only=True)
class InstalledModel:
    """A grey-box model that an installed package adds."""

    name: str
    package: str


@dataclass(frozen=True, slots=True, kw_only=True)
class UsableModels:
    """Installed grey-box models, and whether files are accepted too (in personal mode)."""

    installed: tuple[InstalledModel, ...]
    accepts_files: bool


def refuse_code(context: TheContext) -> None:
    """Refuse to execute the code of a file, unless the server is that of one person.

    Raises
    ------
    Forbidden
        On a server of several.
    """
    if context.is_shared:
        raise Forbidden(
            "the code of a file is executed in personal mode only; on this server, models come "
            "from installed packages (entry point flexsid.models)",
            code="code-refused",
        )


@grey_box_router.get("/grey-box-models", response_model=UsableModels)
def list_grey_box_models(context: TheContext) -> Json:
    """List the grey-box models of installed packages, and whether files are accepted."""
    installed = tuple(
        InstalledModel(name=name, package=find_extension_package(MODELS, name) or "")
        for name in list_extension_names(MODELS)
    )
    return Json(UsableModels(installed=installed, accepts_files=not context.is_shared))


@grey_box_router.post(
    "/grey-box-fits", response_model=JobItem, status_code=status.HTTP_202_ACCEPTED
)
def request_grey_box_fit(context: TheContext, body: GreyBoxRequest, analyst: TheAnalyst) -> Json:
    """Queue the fit of a grey-box model to a maneuver, or return the job of an equal request."""
    query = body.make_record(GreyBoxQuery)
    if query.source:
        refuse_code(context)
    maneuver = context.store.maneuvers.get(query.maneuver_id)
    title = f"{query.model}, {maneuver.label}"
    with storing_in_campaign(maneuver.aircraft_id):
        return submit_job(context, GREY_BOX, query, analyst, title)


@grey_box_router.get("/grey-box-fits", response_model=Items[GreyBoxItem])
def list_grey_box_fits(
    store: TheStore, maneuver_id: Annotated[int, Query(ge=1, le=LARGEST_ID)]
) -> Json:
    """List the fits of grey-box models to a maneuver, newest first, for their comparison."""
    ids = job_list.list_succeeded(store, GREY_BOX.name, maneuver_id=maneuver_id)
    return Json(Items(items=[_summarise(store, number) for number in ids]))


@grey_box_router.get("/grey-box-fits/{job_id}", response_model=GreyBoxFit)
def get_grey_box_fit(store: TheStore, job_id: Identity) -> Json:
    """Return the fit that a job has computed: parameters with standard errors, model, tests."""
    return Json(read_grey_box(store, job_id))


def _summarise(store: TheStore, job_id: int) -> GreyBoxItem:
    fit = read_grey_box(store, job_id)
    return GreyBoxItem(
        id=job_id,
        model=fit.model,
        title=fit.title,
        method=fit.method,
        band_hz=fit.band_hz,
        n_parameters=len(fit.parameters),
        bic=fit.bic,
        adequacy=fit.adequacy,
        finished_at=store.jobs.get(job_id).finished_at,
    )
