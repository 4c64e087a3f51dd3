"""Estimation runs: requests, templates and batches of them, results, lists and exports."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated, Any, Literal

from fastapi import Depends, Query, Request, Response, status

from flexsid.api.authorization import TheAnalyst, choose_author
from flexsid.api.context import TheContext, TheStore
from flexsid.api.models.requests import ChangeRequest
from flexsid.api.models.responses import ChangedRecords
from flexsid.api.models.runs import (
    BatchRequest,
    Run,
    RunRequest,
    RunTemplateEditRequest,
    RunTemplateItem,
    RunTemplateRequest,
    build_run_response,
    build_template_response,
)
from flexsid.api.responses import (
    NOTEBOOK,
    NOTEBOOK_TYPE,
    get_address,
    make_file_response,
)
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
from flexsid.records.decision import Structure
from flexsid.records.maneuver import ConditioningStep
from flexsid.records.run import Batch, EstimationRun
from flexsid.reports.notebook import write_run_notebook
from flexsid.storage import bulk
from flexsid.storage.jobs import batches
from flexsid.storage.jobs.batches import BatchProgress
from flexsid.storage.lists.list_query import Facets, Items, Page
from flexsid.storage.lists.run_list import RUN_SORT_FIELDS, RunFilters, RunItem
from flexsid.storage.signatures import SignaturePlace, sign_content
from flexsid.storage.store import Store
from flexsid.sysid.exchange.fmu import FmiVersion
from flexsid.workflow.global_model.versions import add_default_priors
from flexsid.workflow.measurements.maneuver_spectra import take_named_corrections
from flexsid.workflow.model_structures import model_structures
from flexsid.workflow.model_structures.model_structures import get_result
from flexsid.workflow.runs import estimation, run_templates
from flexsid.workflow.runs.capsule import write_capsule
from flexsid.workflow.runs.exports import (
    ModelExport,
    RunExport,
    export_model,
    export_run,
    write_fmu,
    write_jsbsim_aircraft,
    write_matlab_model,
)
from flexsid.workflow.runs.run_identity import add_hashes
from flexsid.workflow.runs.run_proposal import apply_proposal, attach_proposal_basis
from flexsid.workflow.runs.run_templates import queue_batch

# --- Estimation runs: requests, results, lists and exports ----------------------------------------

runs_router = make_router("/runs", tag="runs", route_class=JsonRoute)

_MATLAB: dict[int | str, dict[str, Any]] = {
    200: {"content": {"application/octet-stream": {"schema": {"type": "string"}}}}
}

_ZIP: dict[int | str, dict[str, Any]] = {
    200: {"content": {"application/zip": {"schema": {"type": "string", "format": "binary"}}}}
}


@runs_router.post(
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


@runs_router.get("")
def list_runs(
    store: TheStore,
    filters: Filters,
    sort: Annotated[str, describe_sort(RUN_SORT_FIELDS)] = "-id",
    limit: Limit = 100,
    after: After = None,
) -> Page[RunItem]:
    """List runs with their key figures; `GET /runs/{run_id}` returns the details."""
    return store.run_page(sort=sort, limit=limit, after=after, **filters)


@runs_router.get("/facets")
def list_run_facets(store: TheStore, filters: Filters) -> Facets:
    """Return the number of runs, in total and for each value of each filter."""
    return store.run_facets(**filters)


@runs_router.post("/changes")
def change_runs(store: TheStore, body: ChangeRequest) -> ChangedRecords:
    """Delete, restore, tag or untag many runs; all of them, or none.

    The response lists the changed ids: the opposite action on them undoes the change.
    """
    return ChangedRecords(ids=bulk.change_runs(store, body.ids, body.action, body.tag))


@runs_router.get("/{run_id}")
def get_run(store: TheStore, run_id: Identity) -> Run:
    """Return one run, with its parameters once it succeeded."""
    return build_run_response(store, store.runs.get(run_id))


@runs_router.post("/{run_id}/corrections", status_code=status.HTTP_201_CREATED)
def correct_cause(
    store: TheStore, run_id: Identity, analyst: TheAnalyst
) -> Items[ConditioningStep]:
    """Take the corrections of the causes that a run names, as steps of its maneuver.

    Those of a recorder are taken for all maneuvers of the aircraft that have the channel.
    """
    return Items(items=take_named_corrections(store, run_id, analyst))


@runs_router.get("/{run_id}/export", response_model=RunExport)
def get_run_export(store: TheStore, run_id: Identity) -> Response:
    """Return the inputs and results of a run, with covariance matrix and fitted data points."""
    name = {"Content-Disposition": f'attachment; filename="run-{run_id}.json"'}
    content = sign_content(
        store.database, dump_json(export_run(store, run_id)), SignaturePlace.JSON
    )
    return Response(content, media_type=Json.media_type, headers=name)


@runs_router.get("/{run_id}/notebook", response_class=Response, responses=NOTEBOOK)
def get_run_notebook(store: TheStore, request: Request, run_id: Identity) -> Response:
    """Return a notebook (`.ipynb`) that reads a run by the client of this server."""
    run = store.runs.get(run_id)
    result = get_result(run, "no result to read")
    label = store.maneuvers.get(run.maneuver_id).label
    title = f"{run.method.value} run {run_id} of {label}"
    url, channels = get_address(request), list(result.fit.r_squared)
    text = write_run_notebook(url, run_id, run.maneuver_id, channels, title)
    return make_file_response(text.encode(), NOTEBOOK_TYPE)


@runs_router.get("/{run_id}/fmu", response_class=Response, responses=_ZIP)
def get_run_fmu(
    store: TheStore,
    run_id: Identity,
    fmi_version: Annotated[FmiVersion, Query(description="Version of FMI.")] = FmiVersion.FMI_2,
) -> Response:
    """Return the identified model as an FMU with C sources; parameters are its derivatives."""
    name = {"Content-Disposition": f'attachment; filename="flexsid-run-{run_id}.fmu"'}
    content = write_fmu(store, run_id, fmi_version)
    return Response(content, media_type="application/zip", headers=name)


@runs_router.get("/{run_id}/jsbsim", response_class=Response, responses=_ZIP)
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


@runs_router.get("/{run_id}/capsule", response_class=Response, responses=_ZIP)
def get_run_capsule(store: TheStore, run_id: Identity) -> Response:
    """Return a run with its data, settings, software versions and results as an RO-Crate.

    `flexsid recompute FILE` computes it again in another installation and compares the results.
    """
    name = {"Content-Disposition": f'attachment; filename="flexsid-run-{run_id}.crate.zip"'}
    return Response(write_capsule(store, run_id), media_type="application/zip", headers=name)


@runs_router.get("/{run_id}/model", response_model=ModelExport, responses=_MATLAB)
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


@runs_router.delete("/{run_id}", status_code=204)
def delete_run(store: TheStore, run_id: Identity) -> None:
    """Delete a run that has ended; it can be restored."""
    bulk.change_runs(store, [run_id], bulk.Action.DELETE)


# --- Batches: many runs requested at once, with a common progress ---------------------------------

batches_router = make_router("/batches", tag="jobs")


@dataclass(frozen=True, slots=True, kw_only=True)
class QueuedBatch:
    """A queued batch; ``repeated`` of its runs had been requested before."""

    id: int
    total: int
    repeated: int


@batches_router.post("", response_model=QueuedBatch, status_code=status.HTTP_202_ACCEPTED)
def request_batch(context: TheContext, body: BatchRequest, analyst: TheAnalyst) -> Json:
    """Queue many runs; all of them, or none.

    Without structures, each run uses the proposed structure of its maneuver, as a single run does.
    """
    store = context.store
    templates = []
    for item in body.structures:
        given = None if item.structure is None else item.structure.to_record()
        structure, version = model_structures.get_structure_of_run(
            store, given, item.structure_id, item.structure_version
        )
        templates.append(body.make_template(structure, item.structure_id, version, analyst))
    if not body.structures:
        templates.append(body.make_template(Structure(fixed={}), None, None, analyst))
    templates = [_apply_run_template(store, body, one) for one in templates]
    queued = queue_batch(
        store,
        Batch(name=body.name, author=analyst),
        body.maneuver_ids,
        body.methods,
        templates,
        from_equation_error=body.from_equation_error,
        by_proposal=not body.structures,
    )
    context.dispatcher.wake()
    assert queued.batch.id is not None
    response = QueuedBatch(
        id=queued.batch.id, total=queued.total, repeated=queued.total - queued.new
    )
    return Json(
        response, status.HTTP_202_ACCEPTED, {"Location": f"/api/v1/batches/{queued.batch.id}"}
    )


def _apply_run_template(store: Store, body: BatchRequest, run: EstimationRun) -> EstimationRun:
    """Return the common part of runs with the settings of the template, of every method."""
    applied = [body.apply_template(store, replace(run, method=one)) for one in body.methods]
    return applied[0]


@batches_router.get("", response_model=Page[BatchProgress])
def list_batches(store: TheStore, limit: Limit = 100, after: After = None) -> Json:
    """List batches with their progress, newest first."""
    return Json(batches.read_page(store, limit=limit, after=after))


@batches_router.get("/{batch_id}", response_model=BatchProgress)
def get_batch(store: TheStore, batch_id: Identity) -> Json:
    """Return the progress of a batch."""
    return Json(batches.read_progress(store, batch_id))


@batches_router.post(
    "/{batch_id}/cancel", response_model=BatchProgress, status_code=status.HTTP_202_ACCEPTED
)
def cancel_batch(context: TheContext, batch_id: Identity) -> Json:
    """Cancel the unfinished runs of a batch; runs shared with another batch continue."""
    progress = batches.cancel(context.store, batch_id)
    context.dispatcher.wake()
    return Json(progress, status.HTTP_202_ACCEPTED)


@batches_router.post(
    "/{batch_id}/retry", response_model=BatchProgress, status_code=status.HTTP_202_ACCEPTED
)
def retry_batch(context: TheContext, batch_id: Identity) -> Json:
    """Queue the failed and cancelled runs of a batch again."""
    progress = batches.retry(context.store, batch_id)
    context.dispatcher.wake()
    return Json(progress, status.HTTP_202_ACCEPTED)


# --- Templates of runs: settings under a name in a campaign, by revision --------------------------

run_templates_router = make_router("/run-templates", tag="runs", route_class=JsonRoute)


@run_templates_router.get("")
def list_run_templates(store: TheStore, aircraft_id: Reference = None) -> Items[RunTemplateItem]:
    """List the templates of a campaign, or of all, in their newest revision, by name."""
    found = run_templates.list_run_templates(store, aircraft_id)
    return Items(items=[build_template_response(one) for one in found])


@run_templates_router.post("", response_model=RunTemplateItem, status_code=201)
def add_run_template(store: TheStore, body: RunTemplateRequest, analyst: TheAnalyst) -> Json:
    """Save method and settings of a run as a template of its campaign.

    Values of the maneuver or its condition are not part of it: additional maneuvers, the run to
    start from, priors by value.
    """
    stored = run_templates.save_run_template(store, body.run_id, body.name, body.note, analyst)
    location = {"Location": f"/api/v1/run-templates/{stored.id}"}
    return Json(build_template_response(stored), 201, location)


@run_templates_router.get("/{run_template_id}")
def get_run_template(
    store: TheStore,
    run_template_id: Identity,
    revision: Annotated[int | None, Query(ge=1, le=2**31 - 1)] = None,
) -> RunTemplateItem:
    """Return a template in a revision, by default the newest, also if it is deleted."""
    return build_template_response(run_templates.get_run_template(store, run_template_id, revision))


@run_templates_router.put("/{run_template_id}")
def edit_run_template(
    store: TheStore, run_template_id: Identity, body: RunTemplateEditRequest, analyst: TheAnalyst
) -> RunTemplateItem:
    """Save method and settings of a run as the next revision; earlier ones remain."""
    stored = run_templates.revise_run_template(
        store, run_template_id, body.revision, body.run_id, body.note, analyst
    )
    return build_template_response(stored)


@run_templates_router.delete("/{run_template_id}", status_code=204)
def delete_run_template(
    store: TheStore,
    run_template_id: Identity,
    analyst: TheAnalyst,
    revision: Annotated[int, Query(ge=1, le=2**31 - 1, description="Revision that was read.")],
) -> Response:
    """Mark a template as deleted; runs still name its revisions."""
    run_templates.delete_run_template(store, run_template_id, revision, analyst)
    return Response(status_code=204)
