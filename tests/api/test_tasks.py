"""Background tasks: progress, cancellation and failure."""

from __future__ import annotations

import threading

import pytest
import waiting
from fastapi.testclient import TestClient
from waiting import wait_until

from flexsid.errors import BadInput, Conflict
from flexsid.workflow.background_tasks import Report, TaskProgress, Tasks, TaskState

DESIGN = {
    "name": "interleaved",
    "duration_s": 20.0,
    "rate_hz": 100.0,
    "peaks": [0.01, 0.02, 0.04],
    "inputs": [
        {"name": "bfs", "harmonics": list(range(4, 120, 2))},
        {"name": "wf1s", "harmonics": list(range(5, 121, 2))},
    ],
    "effort": "quick",
}


def ended(tasks: Tasks, begun: TaskProgress) -> TaskProgress:
    active = (TaskState.WAITING, TaskState.RUNNING)
    wait_until(lambda: tasks.get(begun.id).state not in active, begun.id)
    return tasks.get(begun.id)


@pytest.fixture
def tasks():
    made = Tasks()
    yield made
    made.stop()


def test_task_returns_id_of_its_result(tasks: Tasks):
    done = ended(tasks, tasks.begin("x", "a title", lambda report: 7))
    assert (done.state, done.result_id, done.fraction) == (TaskState.DONE, 7, 1.0)
    assert done.ended_at is not None
    with pytest.raises(Conflict, match="done"):
        tasks.cancel(done.id)
    newest = ended(tasks, tasks.begin("x", "another", lambda report: 8))
    assert [task.id for task in tasks.all()] == [newest.id, done.id]


def test_cancelled_task_stops_at_next_report(tasks: Tasks):
    begun, go = threading.Event(), threading.Event()

    def work(report: Report) -> int:
        report(0.3, "so far")
        begun.set()
        go.wait(10.0)
        report(0.6, "further")
        return 1

    task = tasks.begin("x", "a title", work)
    assert begun.wait(10.0)
    assert tasks.get(task.id).message == "so far"
    tasks.cancel(task.id)
    go.set()
    assert ended(tasks, task).state is TaskState.CANCELLED


@pytest.mark.parametrize(
    ("error", "code", "words"),
    [
        (BadInput("no such thing", code="none"), "none", "no such thing"),
        (ZeroDivisionError("secret"), "internal-error", "ZeroDivisionError"),
    ],
)
def test_failed_task_reports_reason(tasks: Tasks, error: Exception, code: str, words: str):
    def work(report: Report) -> int:
        raise error

    failed = ended(tasks, tasks.begin("x", "a title", work))
    assert (failed.state, failed.code) == (TaskState.FAILED, code)
    assert words in failed.message
    assert "secret" not in failed.message


def test_design_is_created_as_task(empty: TestClient):
    begun = empty.post("/api/v1/designs/searches", json=DESIGN)
    assert begun.status_code == 202, begun.text
    where = begun.headers["location"]
    now = waiting.ended(empty, where)
    assert now["state"] == "done"
    stored = empty.get(f"/api/v1/designs/{now['result_id']}").json()
    assert stored["name"] == "interleaved"
    wrong = empty.post("/api/v1/designs/searches", json=DESIGN | {"rate_hz": 10.0})
    assert wrong.json()["code"] == "above-nyquist"
    assert empty.get("/api/v1/tasks/t0123456789abcdef").status_code == 404
