"""A server killed in the middle of a job: the page reports it, goes on, the result comes."""

from __future__ import annotations

import shutil
from dataclasses import replace
from pathlib import Path

import pytest
from interpreter import make_interpreter
from playwright.sync_api import Browser, expect
from ports import find_free_port
from waiting import wait_until

from flexsid.jobs.kinds import KINDS
from flexsid.records.decision import Structure
from flexsid.records.job import NEW_JOB
from flexsid.records.run import EstimationRun, Method, RunSettings, RunState
from flexsid.storage.jobs import queue
from flexsid.storage.store import Store

from .conftest import serving

pytestmark = [pytest.mark.e2e, pytest.mark.long]
_START = ("-c", "import sys, held_kinds; sys.exit(held_kinds.serve())")
_MODULES = Path(__file__).parents[1] / "jobs"
# What the page reads of the requests of all kinds.
_REQUEST = {
    **dict.fromkeys(("run_id", "design_id", "search_id", "prediction_id", "maneuver_id"), 1),
    **dict.fromkeys(("responses_id", "controller_id", "order", "low_hz", "high_hz"), 2),
    **{"run_ids": [1], "maneuver_ids": [1], "modes": [7], "variables": ["fuel_fraction"]},
    **{"flutter": {"run_ids": [1]}, "upload_id": "u1", "partition": "folds", "folds": 5},
}


def _add_job(store: Store, kind: str, text: str) -> int:
    if kind != "estimation":
        job = replace(NEW_JOB, kind=kind, author=text, title="held", request=_REQUEST)
        return queue.add_job(store, job).id or 0
    run = EstimationRun(
        maneuver_id=1,
        method=Method.EE,
        structure=Structure(modes=(7, 9), fixed={}),
        settings=RunSettings(),
        author=text,
    )
    return queue.add(store, run).id or 0


@pytest.mark.parametrize("kind", KINDS)
def test_a_job_survives_a_restart_in_its_middle(
    browser: Browser, campaign: Path, tmp_path: Path, kind: str
) -> None:
    database, log, port = tmp_path / "flexsid.db", tmp_path / "server.log", find_free_port()
    shutil.copy(campaign, database)
    store, held = Store.open(f"sqlite:///{database}"), tmp_path / "held"
    number = _add_job(store, kind, f"hold-once {held}")
    context = browser.new_context(base_url=f"http://127.0.0.1:{port}")
    page = context.new_page()
    state = page.get_by_test_id("jobs-table").get_by_test_id("run-state").first
    lost = page.get_by_test_id("lost-connection")
    program = [str(make_interpreter(tmp_path, _MODULES)), *_START]
    with serving(database, port, log, program) as process:
        page.goto("/jobs")
        page.evaluate("window.openedOnce = true")
        expect(state).to_have_attribute("data-state", "running")
        wait_until(held.exists, "the job is computed")
        process.kill()
        process.wait()
        expect(lost).to_contain_text("not reachable")
    with serving(database, port, log, program):
        expect(state).to_have_attribute("data-state", "succeeded")
        expect(lost).to_have_count(0)
    assert page.evaluate("window.openedOnce") is True, "loaded again"
    ended = store.jobs.get(number)
    assert (ended.state, ended.attempt) == (RunState.SUCCEEDED, 2)
    context.close()
    store.close()
