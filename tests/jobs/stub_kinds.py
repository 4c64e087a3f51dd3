"""Kinds of jobs whose task states what happens to it; workers load this module by name."""

from __future__ import annotations

import ctypes
import os
import signal
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from flexsid.errors import BadInput, NotIdentifiable
from flexsid.records.run import Fit, ParameterEstimate, Progress, RunResult

if TYPE_CHECKING:
    from flexsid.jobs.kind import Kind, Kinds
    from flexsid.records.job import Job
    from flexsid.storage.store import Store

# Longer than any test waits: PostgreSQL takes a minute to end the transaction of a server
# stopped within it, and a task that ends by itself would leave its worker idle, not killed.
_HOLD_S = 600.0


@dataclass(frozen=True)
class Request:
    """What is to happen."""

    text: str = ""


class EveryKind(dict[str, "Kind[Any, Any]"]):
    """A stub for every name."""

    def __contains__(self, name: object) -> bool:
        return True

    def __missing__(self, name: str) -> Any:
        return Stub(name)


class Stub:
    """A kind that is imported where more than its computation is used: workers start quickly."""

    def __init__(self, name: str) -> None:
        self._name = name

    @staticmethod
    def compute(task: dict[str, Any], report: Callable[[Progress], None]) -> dict[str, Any]:
        return compute(task, report)

    def __getattr__(self, name: str) -> Any:
        from flexsid.jobs.kind import Kind

        made: Kind[Any, Any] = Kind(
            name=self._name,
            label=self._name,
            request=Request,
            prepare=prepare,
            compute=compute,
            save=save_run if self._name == "estimation" else save,
        )
        return getattr(made, name)


def load() -> Kinds:
    return EveryKind()


def prepare(store: Store, job: Job, request: Request) -> dict[str, Any]:
    words = (request.text or job.author).split()
    if words[0] == "unprepared":
        raise BadInput("there is no mode 99 in the table", code="unknown-mode")
    return {"do": words[0], "file": words[1] if len(words) > 1 else ""}


def compute(task: dict[str, Any], report: Callable[[Progress], None]) -> dict[str, Any]:
    report(Progress(iteration=1, cost=float("nan"), fraction=0.5, message="half way"))
    what = task["do"]
    if what == "refuse":
        raise NotIdentifiable("the input never moves")
    if what == "stumble":
        return {"value": [][0]}
    if what == "sleep":
        time.sleep(_HOLD_S)
    is_first = not Path(task["file"]).is_file()
    if what == "hold" or (what == "hold-once" and is_first):
        Path(task["file"]).write_text(str(os.getpid()))
        time.sleep(_HOLD_S)
    if what == "crash" or (what == "crash-once" and is_first):
        Path(task["file"] or os.devnull).write_text(str(os.getpid()))
        os.kill(os.getpid(), signal.SIGKILL)
    if what == "segfault":
        ctypes.string_at(0)
    if what == "devour":
        return {"value": float(len(b"x" * 2**35))}
    if what == "loop":
        Path(task["file"]).write_text(str(os.getpid()))
        while True:
            pass
    if what == "brief":
        time.sleep(0.05)
    if what == "unpicklable":
        return {"value": lambda: 1}
    if what == "threads":
        return {"value": float(os.environ["OPENBLAS_NUM_THREADS"])}
    return {"value": 2.0}


def save(store: Store, job: Job, request: Request, outcome: dict[str, Any]) -> None:
    # Imported here, so that workers start quickly.
    import numpy as np

    from flexsid.storage.jobs import queue

    with store.transaction():
        array = store.arrays.put(np.array([outcome["value"]]))
        result = {"value": outcome["value"], "array": array}
        queue.finish_job(store, job.id or 0, job.attempt, result, {"flexsid": "test"}, job.worker)


def save_run(store: Store, job: Job, request: Request, outcome: dict[str, Any]) -> None:
    import numpy as np

    from flexsid.storage.jobs import queue

    with store.transaction():
        result = RunResult(
            parameters=(ParameterEstimate(name="Cm_q", value=outcome["value"], std_error=0.1),),
            covariance=store.arrays.put(np.array([[0.01]])),
            fit=Fit(
                outcome="converged",
                message="",
                iterations=(),
                cost=1.0,
                r_squared={},
                n_lines=1,
                n_parameters=1,
                seconds=0.0,
                start="",
            ),
            poles=(),
            blocks=(),
        )
        queue.finish(store, job.id or 0, job.attempt, result, {"flexsid": "test"}, job.worker)
