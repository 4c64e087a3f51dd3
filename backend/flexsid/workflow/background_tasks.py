"""Tasks: what takes longer than a second and is no estimation, with progress and cancellation."""

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
_KEPT = 200  # tasks that have ended and can still be asked about

Report = Callable[[float, str], None]


class TaskState(StrEnum):
    """Life of a task; it ends with the server, what it has made does not."""

    WAITING = "waiting"
    RUNNING = "running"
    DONE = "done"
    FAILED = "failed"
    CANCELLED = "cancelled"


@dataclass(frozen=True, slots=True, kw_only=True)
class TaskProgress:
    """How far a task is; ``made`` is the id of the record that it kept."""

    id: str
    kind: str
    title: str
    begun_at: datetime
    ended_at: datetime | None = None
    state: TaskState = TaskState.WAITING
    fraction: float = 0.0
    message: str = ""
    code: str = ""
    made: int | None = None


class Tasks:
    """The tasks of one server, carried out one after the other in a thread of their own."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._tasks: OrderedDict[str, TaskProgress] = OrderedDict()
        self._cancelled: set[str] = set()
        self._worker = ThreadPoolExecutor(1, thread_name_prefix="task")

    def begin(self, kind: str, title: str, work: Callable[[Report], int | None]) -> TaskProgress:
        """Queue work that reports how far it is, and returns the id of what it kept."""
        identity = f"t{secrets.token_hex(8)}"
        task = TaskProgress(id=identity, kind=kind, title=title, begun_at=datetime.now(UTC))
        with self._lock:
            self._tasks[task.id] = task
            for old in [t.id for t in self._tasks.values() if _is_over(t)][:-_KEPT]:
                del self._tasks[old]
        self._worker.submit(self._carry_out, task.id, work)
        return task

    def get(self, identity: str) -> TaskProgress:
        """Return a task with its present progress.

        Raises
        ------
        UnknownRecord
            If there is none, also where the server was started anew since.
        """
        with self._lock:
            found = self._tasks.get(identity)
        if found is None:
            raise UnknownRecord(
                f"there is no task '{identity}'; tasks are forgotten when the server is started"
                " anew, what they made is kept"
            )
        return found

    def all(self) -> list[TaskProgress]:
        """What is under way and what has ended lately, newest first."""
        with self._lock:
            return list(reversed(self._tasks.values()))

    def cancel(self, identity: str) -> TaskProgress:
        """Ask a task to stop; it does at its next report."""
        task = self.get(identity)
        if _is_over(task):
            raise Conflict(f"the task has {task.state.value} already", code="task-ended")
        with self._lock:
            self._cancelled.add(identity)
        return task

    def stop(self) -> None:
        """Cancel everything; nothing half-made is kept."""
        with self._lock:
            self._cancelled.update(self._tasks)
        self._worker.shutdown(wait=True, cancel_futures=True)

    def _carry_out(self, identity: str, work: Callable[[Report], int | None]) -> None:
        def report(fraction: float, message: str) -> None:
            if identity in self._cancelled:
                raise Cancelled("The task was cancelled; nothing of it was kept.")
            self._put(replace(task, state=TaskState.RUNNING, fraction=fraction, message=message))

        task = self.get(identity)
        try:
            report(0.0, "")
            ended = replace(task, state=TaskState.DONE, fraction=1.0, made=work(report))
        except Cancelled as error:
            ended = replace(task, state=TaskState.CANCELLED, message=error.message)
        except FlexsidError as error:
            ended = replace(task, state=TaskState.FAILED, code=error.code, message=error.message)
        except Exception as error:  # what nobody foresaw must still end the task in words
            _log.exception("task %s", identity)
            message = f"It stopped on an error of the software ({type(error).__name__})."
            ended = replace(task, state=TaskState.FAILED, code="internal-error", message=message)
        self._put(replace(ended, ended_at=datetime.now(UTC)))
        with self._lock:
            self._cancelled.discard(identity)

    def _put(self, task: TaskProgress) -> None:
        with self._lock:
            self._tasks[task.id] = task


def _is_over(task: TaskProgress) -> bool:
    return task.state not in (TaskState.WAITING, TaskState.RUNNING)
