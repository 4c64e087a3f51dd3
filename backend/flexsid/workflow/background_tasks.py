"""Background tasks other than estimation, with progress and cancellation."""

from __future__ import annotations

import logging
import secrets
import threading
from collections import OrderedDict
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from enum import StrEnum

from flexsid.errors import Cancelled, Conflict, FlexsidError, UnknownRecord

_log = logging.getLogger(__name__)
_MOST_ENDED = 200  # ended tasks that can still be queried

Report = Callable[[float, str], None]


class TaskState(StrEnum):
    """State of a task. Tasks end with the server; records made by them remain."""

    WAITING = "waiting"
    RUNNING = "running"
    DONE = "done"
    FAILED = "failed"
    CANCELLED = "cancelled"


@dataclass(frozen=True, slots=True, kw_only=True)
class TaskProgress:
    """How far a task is; ``made`` is the id of the stored record."""

    id: str
    kind: str
    title: str
    begun_at: datetime
    ended_at: datetime | None = None
    state: TaskState = TaskState.WAITING
    fraction: float = 0.0
    message: str = ""
    code: str = ""
    result_id: int | None = None


class Tasks:
    """Tasks of one server, executed sequentially in a separate thread."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._tasks: OrderedDict[str, TaskProgress] = OrderedDict()
        self._cancelled: set[str] = set()
        self._worker = ThreadPoolExecutor(1, thread_name_prefix="task")

    def begin(self, kind: str, title: str, work: Callable[[Report], int | None]) -> TaskProgress:
        """Queue work that reports progress and returns the id of the stored record."""
        identity = f"t{secrets.token_hex(8)}"
        task = TaskProgress(id=identity, kind=kind, title=title, begun_at=datetime.now(UTC))
        with self._lock:
            self._tasks[task.id] = task
            for old in [t.id for t in self._tasks.values() if _is_over(t)][:-_MOST_ENDED]:
                del self._tasks[old]
        self._worker.submit(self._execute, task.id, work)
        return task

    def get(self, identity: str) -> TaskProgress:
        """Return a task with its present progress.

        Raises
        ------
        UnknownRecord
            If there is none, also after a restart of the server.
        """
        with self._lock:
            found = self._tasks.get(identity)
        if found is None:
            raise UnknownRecord(
                f"there is no task '{identity}'; tasks are dropped when the server restarts, and"
                " their records remain"
            )
        return found

    def all(self) -> list[TaskProgress]:
        """List running and recently ended tasks, newest first."""
        with self._lock:
            return list(reversed(self._tasks.values()))

    def cancel(self, identity: str) -> TaskProgress:
        """Cancel a task; it stops at its next report."""
        task = self.get(identity)
        if _is_over(task):
            raise Conflict(f"the task has {task.state.value} already", code="task-ended")
        with self._lock:
            self._cancelled.add(identity)
        return task

    def stop(self) -> None:
        """Cancel all tasks; incomplete records are not stored."""
        with self._lock:
            self._cancelled.update(self._tasks)
        self._worker.shutdown(wait=True, cancel_futures=True)

    def _execute(self, identity: str, work: Callable[[Report], int | None]) -> None:
        def report(fraction: float, message: str) -> None:
            if identity in self._cancelled:
                raise Cancelled("The task was cancelled; nothing was stored.")
            self._put(replace(task, state=TaskState.RUNNING, fraction=fraction, message=message))

        task = self.get(identity)
        try:
            report(0.0, "")
            ended = replace(task, state=TaskState.DONE, fraction=1.0, result_id=work(report))
        except Cancelled as error:
            ended = replace(task, state=TaskState.CANCELLED, message=error.message)
        except FlexsidError as error:
            ended = replace(task, state=TaskState.FAILED, code=error.code, message=error.message)
        except Exception as error:  # any other error ends the task with a message
            _log.exception("task %s", identity)
            message = f"The task failed with an internal error ({type(error).__name__})."
            ended = replace(task, state=TaskState.FAILED, code="internal-error", message=message)
        self._put(replace(ended, ended_at=datetime.now(UTC)))
        with self._lock:
            self._cancelled.discard(identity)

    def _put(self, task: TaskProgress) -> None:
        with self._lock:
            self._tasks[task.id] = task


def _is_over(task: TaskProgress) -> bool:
    return task.state not in (TaskState.WAITING, TaskState.RUNNING)
