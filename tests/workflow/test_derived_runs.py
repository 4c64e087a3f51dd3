"""Refits on which a flutter prediction rests are stored, linked runs."""

from __future__ import annotations

import pytest

from flexsid.errors import NotIdentifiable
from flexsid.jobs.dispatcher import execute_request
from flexsid.jobs.kind import get_result
from flexsid.jobs.kinds import FLUTTER
from flexsid.records.job import Job
from flexsid.records.run import Progress, RunState
from flexsid.storage.store import Store
from flexsid.workflow.flutter.flutter_models import FlutterQuery
from flexsid.workflow.runs import derived_runs
from flexsid.workflow.runs.run_identity import add_hashes

pytestmark = pytest.mark.parametrize("backend", ["sqlite"])


@pytest.fixture
def flown(flown_url: str):
    store = Store.open(flown_url)
    yield store
    store.close()


def predict(store: Store, report=lambda progress: None, fuel: float | None = None) -> Job:
    job = execute_request(store, FLUTTER, FlutterQuery(run_ids=(1,), fuel=fuel), report)
    assert job.state is RunState.SUCCEEDED, job.error
    return job


def test_a_refit_is_a_run_and_is_fitted_once(flown: Store):
    reported: list[Progress] = []
    job = predict(flown, reported.append)
    flutter = get_result(flown, FLUTTER, FlutterQuery(run_ids=(1,))).flutter
    (used,) = flutter.derived_runs
    assert (used.run_id, used.failure) == (1, None)
    assert any(used.purpose in one.message for one in reported), "its progress is reported"
    run, parent = flown.runs.get(used.derived_run_id), flown.runs.get(1)
    assert run.state is RunState.SUCCEEDED
    assert run.derived_from_run_id == 1
    assert run.derivation is not None
    assert (run.derivation.job_kind, run.derivation.job_id) == ("flutter-prediction", job.id)
    assert run.structure.modes == parent.structure.modes[:-1]
    assert run.rests_on is not None, "it has the provenance of every run"
    assert add_hashes(flown, run).input_hash == run.input_hash
    assert flown.jobs.get(run.id or 0).title.startswith("derived from run 1, to bound")
    predict(flown, fuel=0.3)
    again = get_result(flown, FLUTTER, FlutterQuery(run_ids=(1,), fuel=0.3)).flutter
    assert again.derived_runs == flutter.derived_runs
    assert len(flown.runs.find()) == 2


def test_a_failed_refit_is_a_failed_run_and_withholds_the_interval(flown: Store, monkeypatch):
    def fail(*_: object) -> None:
        raise NotIdentifiable("too few data")

    monkeypatch.setattr(derived_runs, "compute_run", fail)
    predict(flown)
    flutter = get_result(flown, FLUTTER, FlutterQuery(run_ids=(1,))).flutter
    (used,) = flutter.derived_runs
    assert used.failure == "too few data"
    assert "refits failed (run 1, to bound the effect of" in flutter.sentence
    assert (flutter.spread_m_s, flutter.low_m_s) == (None, None)
    run = flown.runs.get(used.derived_run_id)
    assert run.state is RunState.FAILED
    assert run.error == {"code": "not-identifiable", "message": "too few data"}
