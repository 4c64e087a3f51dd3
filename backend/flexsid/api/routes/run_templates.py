"""Templates of runs: settings under a name in a campaign, by revision."""

from __future__ import annotations

from typing import Annotated

from fastapi import Query, Response

from flexsid.api.analyst import TheAnalyst
from flexsid.api.context import TheStore
from flexsid.api.models.run_requests import RunTemplateEditRequest, RunTemplateRequest
from flexsid.api.models.run_responses import RunTemplateItem, build_template_response
from flexsid.api.router import make_router
from flexsid.api.serialization import Identity, Json, JsonRoute, Reference
from flexsid.storage.paging import Items
from flexsid.workflow.runs import run_templates

router = make_router("/run-templates", tag="runs", route_class=JsonRoute)


@router.get("")
def list_run_templates(store: TheStore, aircraft_id: Reference = None) -> Items[RunTemplateItem]:
    """List the templates of a campaign, or of all, in their newest revision, by name."""
    found = run_templates.list_run_templates(store, aircraft_id)
    return Items(items=[build_template_response(one) for one in found])


@router.post("", response_model=RunTemplateItem, status_code=201)
def add_run_template(store: TheStore, body: RunTemplateRequest, analyst: TheAnalyst) -> Json:
    """Save method and settings of a run as a template of its campaign.

    Values of the maneuver or its condition are not part of it: additional maneuvers, the run to
    start from, priors by value.
    """
    stored = run_templates.save_run_template(store, body.run_id, body.name, body.note, analyst)
    location = {"Location": f"/api/v1/run-templates/{stored.id}"}
    return Json(build_template_response(stored), 201, location)


@router.get("/{run_template_id}")
def get_run_template(
    store: TheStore,
    run_template_id: Identity,
    revision: Annotated[int | None, Query(ge=1, le=2**31 - 1)] = None,
) -> RunTemplateItem:
    """Return a template in a revision, by default the newest, also if it is deleted."""
    return build_template_response(run_templates.get_run_template(store, run_template_id, revision))


@router.put("/{run_template_id}")
def edit_run_template(
    store: TheStore, run_template_id: Identity, body: RunTemplateEditRequest, analyst: TheAnalyst
) -> RunTemplateItem:
    """Save method and settings of a run as the next revision; earlier ones remain."""
    stored = run_templates.revise_run_template(
        store, run_template_id, body.revision, body.run_id, body.note, analyst
    )
    return build_template_response(stored)


@router.delete("/{run_template_id}", status_code=204)
def delete_run_template(
    store: TheStore,
    run_template_id: Identity,
    analyst: TheAnalyst,
    revision: Annotated[int, Query(ge=1, le=2**31 - 1, description="Revision that was read.")],
) -> Response:
    """Mark a template as deleted; runs still name its revisions."""
    run_templates.delete_run_template(store, run_template_id, revision, analyst)
    return Response(status_code=204)
