"""Posterior check of a stored run: its standard errors, intervals and poles."""

from __future__ import annotations

import pytest

from flexsid.errors import BadInput
from flexsid.jobs.dispatcher import execute_request, execute_run
from flexsid.jobs.kind import get_result
from flexsid.jobs.kinds import POSTERIOR, RUN
from flexsid.records.decision import Structure
from flexsid.records.run import EstimationRun, Method, RunSettings, Start
from flexsid.storage.store import Store
from flexsid.workflow.validation.posterior_check import PosteriorQuery


def estimate(store: Store, method: Method) -> int:
    run = EstimationRun(
        maneuver_id=1,
        method=method,
        structure=Structure(modes=(7, 9), fixed={}),
        settings=RunSettings(start=Start.PREDICTION),
    )
    return execute_run(store, run, RUN, lambda _: None).id or 0


def test_the_posterior_of_a_precise_run_confirms_its_standard_errors(
    flown_url: str, monkeypatch: pytest.MonkeyPatch
):
    for name, count in (("_SAMPLES", 110), ("_STABILITY_SAMPLES", 8)):
        monkeypatch.setattr(f"flexsid.workflow.validation.posterior_check.{name}", count)
    store = Store.open(flown_url)
    query = PosteriorQuery(run_id=estimate(store, Method.OE))
    execute_request(store, POSTERIOR, query, lambda _: None)
    found = get_result(store, POSTERIOR, query)
    result = store.runs.get(query.run_id).result
    assert result is not None
    assert found.is_confirmed, found.sentence
    assert [one.name for one in found.parameters] == [one.name for one in result.parameters]
    for one in found.parameters:
        assert one.std_error is not None
        assert one.low < one.value < one.high
        assert one.high - one.low == pytest.approx(4.0 * one.std_error, rel=0.4)
    assert {one.name.split(",")[0] for one in found.poles} <= {pole.name for pole in result.poles}
    assert len(found.poles) >= 4
    assert found.flutter is not None
    assert found.flutter.ratio == pytest.approx(1.0, abs=0.5)
    store.close()


def test_only_output_error_has_a_posterior_check(flown_url: str):
    store = Store.open(flown_url)
    query = PosteriorQuery(run_id=estimate(store, Method.EE))
    with pytest.raises(BadInput, match="OE"):
        execute_request(store, POSTERIOR, query, lambda _: None)
    store.close()
