"""Estimation runs: requests, results, lists and exports."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from fastapi import Depends, Query, Response

from flexsid.api.analyst import TheAnalyst, choose_author
from flexsid.api.context import TheContext, TheStore
from flexsid.api.models.requests import ChangeRequest
from flexsid.api.models.responses import ChangedRecords
from flexsid.api.models.run_requests import RunRequest
from flexsid.api.models.run_responses import Run, build_run_response
from flexsid.api.router import make_router
from flexsid.api.serialization import (
    After,
    Identity,
    Json,
    JsonRoute,
    Limit,
    Reference,
    describe_sort,
    dump_json,
    read_query,
)
from flexsid.records.model_structure import Structure
from flexsid.storage import batches, bulk
from flexsid.storage.list_query import Facets
from flexsid.storage.paging import Page
from flexsid.storage.run_list import RUN_SORT_FIELDS, RunFilters, RunItem
from flexsid.storage.signatures import SignaturePlace, sign_content
from flexsid.sysid.exchange.fmu import FmiVersion
from flexsid.workflow.global_model.versions import add_default_priors
from flexsid.workflow.model_structures import model_structures
from flexsid.workflow.runs import estimation
from flexsid.workflow.runs.capsule import write_capsule
from flexsid.workflow.runs.fmu import write_fmu
from flexsid.workflow.runs.jsbsim import write_jsbsim_aircraft
from flexsid.workflow.runs.model_export import ModelExport, export_model, write_matlab_model
from flexsid.workflow.runs.run_export import RunExport, export_run
from flexsid.workflow.runs.run_identity import add_hashes
from flexsid.workflow.runs.run_proposal import apply_proposal, attach_proposal_basis

router = make_router("/runs", tag="runs", route_class=JsonRoute)

_MATLAB: dict[int | str, dict[str, Any]] = {
    200: {"content": {"application/octet-stream": {"schema": {"type": "string"}}}}
}

_ZIP: dict[int | str, dict[str, Any]] = {
    200: {"content": {"application/zip": {"schema": {"type": "string", "format": "binary"}}}}
}


@router.post(
    "",
    response_model=Run,
    status_code=202,
    responses={200: {"model": Run, "description": "The same run had been requested before"}},
)
def request_run(context: TheContext, body: RunRequest, analyst: TheAnalyst) -> Json:
    """Queue an estimation run; ``Location`` is the address of its job.

    Without a structure, the run uses the proposal of `GET /maneuvers/{maneuver_id}/run-proposal`:
    the structure approved for the condition, else the stored one of this FTA, else the modes in
    the excited band; the field `proposal` records which. Unknown modes, inputs and outputs are
    refused immediately. A request equal to a queued, running or succeeded run returns that run
    (200, ``repeated``).

    Without a band, a record without known harmonics is estimated in its excited band, which the
    settings then name.

    Priors requested by ``prior_spread`` without a prediction are those of the approved global
    model at the condition, where it has the modes of the run; the settings then name them.
    """
    store = context.store
    given = None if body.structure is None else body.structure.to_record()
    reference = (body.structure_id, body.structure_version)
    author = choose_author(body.author, analyst)
    if given is None and reference == (None, None):
        run = body.make_run(structure=Structure(fixed={}), author=author)
        run = apply_proposal(store, body.apply_template(store, run))
    else:
        structure, version = model_structures.get_structure_of_run(store, given, *reference)
        run = body.make_run(structure=structure, structure_version=version, author=author)
        run = attach_proposal_basis(store, body.apply_template(store, run))
    run = add_default_priors(store, run)
    estimation.prepare(store, run)  # refused at once, not as a job
    stored, is_new = batches.add_once(store, add_hashes(store, run))
    assert stored.id is not None
    if is_new:
        context.dispatcher.wake()
    location = {"Location": f"/api/v1/jobs/{stored.id}"}
    code = 202 if is_new else 200
    return Json(build_run_response(store, stored, repeated=not is_new), code, location)


Filters = Annotated[RunFilters, Depends(read_query(RunFilters))]


@router.get("")
def list_runs(
    store: TheStore,
    filters: Filters,
    sort: Annotated[str, describe_sort(RUN_SORT_FIELDS)] = "-id",
    limit: Limit = 100,
    after: After = None,
) -> Page[RunItem]:
    """List runs with their key figures; `GET /runs/{run_id}` returns the details."""
    return store.run_page(sort=sort, limit=limit, after=after, **filters)


@router.get("/facets")
def list_run_facets(store: TheStore, filters: Filters) -> Facets:
    """Return the number of runs, in total and for each value of each filter."""
    return store.run_facets(**filters)


@router.post("/changes")
def change_runs(store: TheStore, body: ChangeRequest) -> ChangedRecords:
    """Delete, restore, tag or untag many runs; all of them, or none.

    The response lists the changed ids: the opposite action on them undoes the change.
    """
    return ChangedRecords(ids=bulk.change_runs(store, body.ids, body.action, body.tag))


@router.get("/{run_id}")
def get_run(store: TheStore, run_id: Identity) -> Run:
    """Return one run, with its parameters once it succeeded."""
    return build_run_response(store, store.runs.get(run_id))


@router.get("/{run_id}/export", response_model=RunExport)
def get_run_export(store: TheStore, run_id: Identity) -> Response:
    """Return the inputs and results of a run, with covariance matrix and fitted data points."""
    name = {"Content-Disposition": f'attachment; filename="run-{run_id}.json"'}
    content = sign_content(
        store.database, dump_json(export_run(store, run_id)), SignaturePlace.JSON
    )
    return Response(content, media_type=Json.media_type, headers=name)


@router.get("/{run_id}/fmu", response_class=Response, responses=_ZIP)
def get_run_fmu(
    store: TheStore,
    run_id: Identity,
    fmi_version: Annotated[FmiVersion, Query(description="Version of FMI.")] = FmiVersion.FMI_2,
) -> Response:
    """Return the identified model as an FMU with C sources; parameters are its derivatives."""
    name = {"Content-Disposition": f'attachment; filename="flexsid-run-{run_id}.fmu"'}
    content = write_fmu(store, run_id, fmi_version)
    return Response(content, media_type="application/zip", headers=name)


@router.get("/{run_id}/jsbsim", response_class=Response, responses=_ZIP)
def get_run_jsbsim(
    store: TheStore,
    run_id: Identity,
    other_run_id: Reference = None,
) -> Response:
    """Return the identified rigid aircraft for JSBSim, with a run of the other axis if named.

    Modes are residualised.
    """
    name = {"Content-Disposition": f'attachment; filename="flexsid-run-{run_id}.jsbsim.zip"'}
    content = write_jsbsim_aircraft(store, run_id, other_run_id)
    return Response(content, media_type="application/zip", headers=name)


@router.get("/{run_id}/capsule", response_class=Response, responses=_ZIP)
def get_run_capsule(store: TheStore, run_id: Identity) -> Response:
    """Return a run with its data, settings, software versions and results as an RO-Crate.

    `flexsid recompute FILE` computes it again in another installation and compares the results.
    """
    name = {"Content-Disposition": f'attachment; filename="flexsid-run-{run_id}.crate.zip"'}
    return Response(write_capsule(store, run_id), media_type="application/zip", headers=name)


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


@router.delete("/{run_id}", status_code=204)
def delete_run(store: TheStore, run_id: Identity) -> None:
    """Delete a run that has ended; it can be restored."""
    bulk.change_runs(store, [run_id], bulk.Action.DELETE)
