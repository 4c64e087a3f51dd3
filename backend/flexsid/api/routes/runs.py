"""Estimation runs: ask for one, read what came out."""

from __future__ import annotations

from typing import Annotated, Literal

from fastapi import APIRouter, Query, Response, status

from flexsid.api.analyst import TheAnalyst
from flexsid.api.answers import Run, RunList, run_answer
from flexsid.api.context import TheContext, TheStore
from flexsid.api.requests import RunRequest
from flexsid.api.wire import After, Identity, Json, Limit, Reference
from flexsid.records.run import Method, RunState
from flexsid.storage import queue
from flexsid.workflow import estimation, structures
from flexsid.workflow.export import RunExport, export_run
from flexsid.workflow.identified_export import ModelExport, export_model, matlab_model

router = APIRouter(prefix="/runs", tags=["runs"])


@router.post("", response_model=Run, status_code=status.HTTP_202_ACCEPTED)
def request_run(context: TheContext, wanted: RunRequest, analyst: TheAnalyst) -> Json:
    """Queue an estimation run; follow it at the answer's ``Location``.

    What cannot be estimated (an unknown mode, input or output) is refused at once.
    """
    store = context.store
    given = None if wanted.structure is None else wanted.structure.record()
    structure, version = structures.structure_of_run(
        store, given, wanted.structure_id, wanted.structure_version
    )
    run = wanted.record(structure, version, analyst)
    estimation.prepare(store, run)
    kept = store.runs.add(run)
    context.dispatcher.wake()
    location = {"Location": f"/api/v1/jobs/{kept.id}"}
    return Json(run_answer(kept), status.HTTP_202_ACCEPTED, location)


@router.get("", response_model=RunList)
def list_runs(
    store: TheStore,
    maneuver_id: Reference = None,
    method: Method | None = None,
    state: RunState | None = None,
    limit: Limit = 100,
    after: After = None,
) -> Json:
    """List runs, newest first."""
    page = queue.page(
        store, maneuver_id=maneuver_id, method=method, state=state, limit=limit, after=after
    )
    return Json(RunList(items=[run_answer(run) for run in page.items], next=page.next))


@router.get("/{run_id}", response_model=Run)
def get_run(store: TheStore, run_id: Identity) -> Json:
    """Return one run; its parameters once it succeeded."""
    return Json(run_answer(store.runs.get(run_id)))


@router.get("/{run_id}/export", response_model=RunExport)
def get_run_export(store: TheStore, run_id: Identity) -> Json:
    """Return everything a run rests on and gave, with covariance and fitted lines."""
    name = {"Content-Disposition": f'attachment; filename="run-{run_id}.json"'}
    return Json(export_run(store, run_id), headers=name)


@router.get("/{run_id}/model", response_model=ModelExport)
def get_run_model(
    store: TheStore,
    run_id: Identity,
    form: Annotated[
        Literal["json", "mat"], Query(alias="format", description="`mat` for MATLAB.")
    ] = "json",
) -> Response:
    """Return the identified model as matrices with names and units."""
    model = export_model(store, run_id)
    name = {"Content-Disposition": f'attachment; filename="model-{run_id}.{form}"'}
    if form == "mat":
        content = matlab_model(model)
        return Response(content, media_type="application/octet-stream", headers=name)
    return Json(model, headers=name)


@router.delete("/{run_id}", status_code=status.HTTP_204_NO_CONTENT)
def delete_run(store: TheStore, run_id: Identity) -> Response:
    """Forget a run that has ended."""
    queue.delete(store, run_id)
    return Response(status_code=status.HTTP_204_NO_CONTENT)
