"""Batches: many runs requested at once, with a common progress."""

from __future__ import annotations

from dataclasses import dataclass, replace

from fastapi import status

from flexsid.api.analyst import TheAnalyst
from flexsid.api.context import TheContext, TheStore
from flexsid.api.models.run_requests import BatchRequest
from flexsid.api.router import make_router
from flexsid.api.serialization import After, Identity, Json, Limit
from flexsid.records.model_structure import Structure
from flexsid.records.run import Batch, EstimationRun
from flexsid.storage import batches
from flexsid.storage.batches import BatchProgress
from flexsid.storage.paging import Page
from flexsid.storage.store import Store
from flexsid.workflow.model_structures import model_structures
from flexsid.workflow.runs.batch import queue_batch

router = make_router("/batches", tag="jobs")


@dataclass(frozen=True, slots=True, kw_only=True)
class QueuedBatch:
    """A queued batch; ``repeated`` of its runs had been requested before."""

    id: int
    total: int
    repeated: int


@router.post("", response_model=QueuedBatch, status_code=status.HTTP_202_ACCEPTED)
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


@router.get("", response_model=Page[BatchProgress])
def list_batches(store: TheStore, limit: Limit = 100, after: After = None) -> Json:
    """List batches with their progress, newest first."""
    return Json(batches.read_page(store, limit=limit, after=after))


@router.get("/{batch_id}", response_model=BatchProgress)
def get_batch(store: TheStore, batch_id: Identity) -> Json:
    """Return the progress of a batch."""
    return Json(batches.read_progress(store, batch_id))


@router.post(
    "/{batch_id}/cancel", response_model=BatchProgress, status_code=status.HTTP_202_ACCEPTED
)
def cancel_batch(context: TheContext, batch_id: Identity) -> Json:
    """Cancel the unfinished runs of a batch; runs shared with another batch continue."""
    progress = batches.cancel(context.store, batch_id)
    context.dispatcher.wake()
    return Json(progress, status.HTTP_202_ACCEPTED)


@router.post(
    "/{batch_id}/retry", response_model=BatchProgress, status_code=status.HTTP_202_ACCEPTED
)
def retry_batch(context: TheContext, batch_id: Identity) -> Json:
    """Queue the failed and cancelled runs of a batch again."""
    progress = batches.retry(context.store, batch_id)
    context.dispatcher.wake()
    return Json(progress, status.HTTP_202_ACCEPTED)
