"""Estimation runs: requests, results, lists and exports."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from fastapi import APIRouter, Depends, Query, Response, status

from flexsid.api.analyst import TheAnalyst
from flexsid.api.context import TheContext, TheStore
from flexsid.api.requests import ChangeRequest
from flexsid.api.responses import ChangedRecords
from flexsid.api.run_requests import RunRequest
from flexsid.api.run_responses import Run, RunList, build_run_response
from flexsid.api.serialization import After, Identity, Json, Limit, Reference
from flexsid.records.model_structure import Structure
from flexsid.records.run import Method, RunState
from flexsid.storage import batches, bulk
from flexsid.storage.facets import Facets
from flexsid.storage.run_list import RUN_SORT_FIELDS, RunFilters
from flexsid.workflow.model_structures import model_structures
from flexsid.workflow.runs import estimation
from flexsid.workflow.runs.model_export import ModelExport, export_model, write_matlab_model
from flexsid.workflow.runs.run_export import RunExport, export_run
from flexsid.workflow.runs.run_identity import add_hashes
from flexsid.workflow.runs.run_proposal import apply_proposal, attach_proposal_basis

router = APIRouter(prefix="/runs", tags=["runs"])

_Finite = Annotated[float | None, Query(allow_inf_nan=False)]
_MATLAB: dict[int | str, dict[str, Any]] = {
    200: {"content": {"application/octet-stream": {"schema": {"type": "string"}}}}
}


@router.post(
    "",
    response_model=Run,
    status_code=status.HTTP_202_ACCEPTED,
    responses={200: {"model": Run, "description": "The same run had been requested before"}},
)
def request_run(context: TheContext, body: RunRequest, analyst: TheAnalyst) -> Json:
    """Queue an estimation run; ``Location`` is the address of its job.

    Without a structure, the run uses the proposal of `GET /maneuvers/{maneuver_id}/run-proposal`:
    the structure approved for the condition, else the stored one of this FTA, else the modes in
    the excited band; the field `proposal` records which. Unknown modes, inputs and outputs are
    refused immediately. A request equal to a queued, running or succeeded run returns that run
    (200, ``repeated``).
    """
    store = context.store
    given = None if body.structure is None else body.structure.to_record()
    reference = (body.structure_id, body.structure_version)
    if given is None and reference == (None, None):
        run = apply_proposal(store, body.to_record(Structure(fixed={}), None, analyst))
    else:
        structure, version = model_structures.get_structure_of_run(store, given, *reference)
        run = attach_proposal_basis(store, body.to_record(structure, version, analyst))
    task = estimation.prepare(store, run)
    stored, is_new = batches.add_once(store, add_hashes(store, run))
    assert stored.id is not None
    if is_new:
        context.dispatcher.reuse_task(stored.id, task)
    location = {"Location": f"/api/v1/jobs/{stored.id}"}
    code = status.HTTP_202_ACCEPTED if is_new else status.HTTP_200_OK
    return Json(build_run_response(store, stored, repeated=not is_new), code, location)


async def read_filters(
    aircraft_id: Reference = None,
    flight_id: Reference = None,
    maneuver_id: Reference = None,
    structure_id: Reference = None,
    fta: Annotated[int | None, Query(ge=0, le=10**9)] = None,
    min_airspeed_ratio: _Finite = None,
    max_airspeed_ratio: _Finite = None,
    min_fuel: _Finite = None,
    max_fuel: _Finite = None,
    method: Method | None = None,
    state: RunState | None = None,
    tag: Annotated[str | None, Query(max_length=64, description="Only runs with this tag.")] = None,
    search: Annotated[
        str | None,
        Query(max_length=200, description="Text contained in maneuver or author, or an id."),
    ] = None,
    deleted: Annotated[bool, Query(description="Deleted runs instead.")] = False,
) -> RunFilters:
    """Return the filters of the list of runs."""
    return {
        "aircraft_id": aircraft_id,
        "flight_id": flight_id,
        "maneuver_id": maneuver_id,
        "structure_id": structure_id,
        "fta": fta,
        "min_airspeed_ratio": min_airspeed_ratio,
        "max_airspeed_ratio": max_airspeed_ratio,
        "min_fuel": min_fuel,
        "max_fuel": max_fuel,
        "method": method,
        "state": state,
        "tag": tag,
        "search": search,
        "deleted": deleted,
    }


Filters = Annotated[RunFilters, Depends(read_filters)]


@router.get("", response_model=RunList)
def list_runs(
    store: TheStore,
    filters: Filters,
    sort: Annotated[
        str,
        Query(description=f"`-` for descending order, then one of {', '.join(RUN_SORT_FIELDS)}."),
    ] = "-id",
    limit: Limit = 100,
    after: After = None,
) -> Json:
    """List runs with their key figures; `GET /runs/{run_id}` returns the details."""
    return Json(store.run_page(sort=sort, limit=limit, after=after, **filters))


@router.get("/facets", response_model=Facets)
def list_run_facets(store: TheStore, filters: Filters) -> Json:
    """Return the number of runs, in total and for each value of each filter."""
    return Json(store.run_facets(**filters))


@router.post("/changes", response_model=ChangedRecords)
def change_runs(store: TheStore, body: ChangeRequest) -> Json:
    """Delete, restore, tag or untag many runs; all of them, or none.

    The response lists the changed ids: the opposite action on them undoes the change.
    """
    return Json(ChangedRecords(ids=bulk.change_runs(store, body.ids, body.action, body.tag)))


@router.get("/{run_id}", response_model=Run)
def get_run(store: TheStore, run_id: Identity) -> Json:
    """Return one run, with its parameters once it succeeded."""
    return Json(build_run_response(store, store.runs.get(run_id)))


@router.get("/{run_id}/export", response_model=RunExport)
def get_run_export(store: TheStore, run_id: Identity) -> Json:
    """Return the inputs and results of a run, with covariance matrix and fitted data points."""
    name = {"Content-Disposition": f'attachment; filename="run-{run_id}.json"'}
    return Json(export_run(store, run_id), headers=name)


@router.get("/{run_id}/model", response_model=ModelExport, responses=_MATLAB)
def get_run_model(
    store: TheStore,
    run_id: Identity,
    form: Annotated[
        Literal["json", "mat"], Query(alias="format", description="`mat` for MATLAB.")
    ] = "json",
) -> Response:
    """Return the identified model as state-space matrices with names and units."""
    model = export_model(store, run_id)
    name = {"Content-Disposition": f'attachment; filename="model-{run_id}.{form}"'}
    if form == "mat":
        content = write_matlab_model(model)
        return Response(content, media_type="application/octet-stream", headers=name)
    return Json(model, headers=name)


@router.delete("/{run_id}", status_code=status.HTTP_204_NO_CONTENT)
def delete_run(store: TheStore, run_id: Identity) -> Response:
    """Delete a run that has ended; it can be restored."""
    bulk.change_runs(store, [run_id], bulk.Action.DELETE)
    return Response(status_code=status.HTTP_204_NO_CONTENT)
