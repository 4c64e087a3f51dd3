"""Batches: many runs asked for at once, with one progress."""

from __future__ import annotations

from dataclasses import dataclass

from fastapi import APIRouter, status

from flexsid.api.analyst import TheAnalyst
from flexsid.api.context import TheContext, TheStore
from flexsid.api.run_requests import BatchRequest
from flexsid.api.wire import After, Identity, Json, Limit
from flexsid.records.batch import Batch
from flexsid.records.model_structure import Structure
from flexsid.storage import batches
from flexsid.storage.batches import BatchProgress
from flexsid.workflow.model_structures import model_structures
from flexsid.workflow.runs.batch import queue_batch

router = APIRouter(prefix="/batches", tags=["jobs"])


@dataclass(frozen=True, slots=True, kw_only=True)
class BatchList:
    """A page of batches."""

    items: list[BatchProgress]
    next: str | None


@dataclass(frozen=True, slots=True, kw_only=True)
class QueuedBatch:
    """A batch that was queued; ``repeated`` of its runs had been asked for before."""

    id: int
    total: int
    repeated: int


@router.post("", response_model=QueuedBatch, status_code=status.HTTP_202_ACCEPTED)
def request_batch(context: TheContext, wanted: BatchRequest, analyst: TheAnalyst) -> Json:
    """Queue many runs; all of them, or none.

    Without structures each maneuver takes what is proposed for it, as single runs do.
    """
    store = context.store
    templates = []
    for asked in wanted.structures:
        given = None if asked.structure is None else asked.structure.record()
        structure, version = model_structures.structure_of_run(
            store, given, asked.structure_id, asked.structure_version
        )
        templates.append(wanted.template(structure, asked.structure_id, version, analyst))
    if not wanted.structures:
        templates.append(wanted.template(Structure(fixed={}), None, None, analyst))
    queued = queue_batch(
        store,
        Batch(name=wanted.name, author=analyst),
        wanted.maneuver_ids,
        wanted.methods,
        templates,
        from_equation_error=wanted.from_equation_error,
        by_proposal=not wanted.structures,
    )
    context.dispatcher.wake()
    assert queued.batch.id is not None
    answer = QueuedBatch(id=queued.batch.id, total=queued.total, repeated=queued.total - queued.new)
    return Json(
        answer, status.HTTP_202_ACCEPTED, {"Location": f"/api/v1/batches/{queued.batch.id}"}
    )


@router.get("", response_model=BatchList)
def list_batches(store: TheStore, limit: Limit = 100, after: After = None) -> Json:
    """List batches with their progress, newest first."""
    return Json(batches.page(store, limit=limit, after=after))


@router.get("/{batch_id}", response_model=BatchProgress)
def get_batch(store: TheStore, batch_id: Identity) -> Json:
    """Tell how far a batch is."""
    return Json(batches.progress(store, batch_id))


@router.post(
    "/{batch_id}/cancel", response_model=BatchProgress, status_code=status.HTTP_202_ACCEPTED
)
def cancel_batch(context: TheContext, batch_id: Identity) -> Json:
    """Cancel what has not ended of a batch; runs that another batch also wants go on."""
    progress = batches.cancel(context.store, batch_id)
    context.dispatcher.wake()
    return Json(progress, status.HTTP_202_ACCEPTED)


@router.post(
    "/{batch_id}/retry", response_model=BatchProgress, status_code=status.HTTP_202_ACCEPTED
)
def retry_batch(context: TheContext, batch_id: Identity) -> Json:
    """Queue again what failed or was cancelled of a batch."""
    progress = batches.retry(context.store, batch_id)
    context.dispatcher.wake()
    return Json(progress, status.HTTP_202_ACCEPTED)
