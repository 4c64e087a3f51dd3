"""Tasks: progress and cancellation of long computations."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from fastapi import APIRouter
from fastapi import Path as InPath

from flexsid.api.context import TheContext
from flexsid.api.serialization import Json
from flexsid.workflow.background_tasks import TaskProgress

router = APIRouter(prefix="/tasks", tags=["tasks"])

_Id = Annotated[str, InPath(pattern="^t[0-9a-f]{16}$")]


@dataclass(frozen=True, slots=True, kw_only=True)
class TaskList:
    """Tasks of this server since its start."""

    items: list[TaskProgress]


@router.get("", response_model=TaskList)
def list_tasks(context: TheContext) -> Json:
    """List current and recently ended tasks other than runs, newest first."""
    return Json(TaskList(items=context.tasks.all()))


@router.get("/{task_id}", response_model=TaskProgress)
def get_task(context: TheContext, task_id: _Id) -> Json:
    """Return the progress of a task."""
    return Json(context.tasks.get(task_id))


@router.post("/{task_id}/cancel", response_model=TaskProgress)
def cancel_task(context: TheContext, task_id: _Id) -> Json:
    """Cancel a task; its results are discarded."""
    return Json(context.tasks.cancel(task_id))
