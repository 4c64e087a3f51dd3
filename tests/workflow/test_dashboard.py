"""Dashboard of a campaign: which estimate counts where, and which warnings are open."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from flexsid.errors import UnknownRecord
from flexsid.figures.global_model import draw_derivative_coverage
from flexsid.figures.spec import extract_curves
from flexsid.records.aircraft import Aircraft
from flexsid.records.decision import (
    ModelProposal,
    ModelStructure,
    ReviewRules,
    Structure,
    StructureReference,
    Vote,
)
from flexsid.records.maneuver import Maneuver
from flexsid.records.run import (
    AdequacyState,
    EstimationRun,
    Fit,
    Method,
    ModelAdequacy,
    ParameterEstimate,
    RunResult,
    RunSettings,
    RunState,
)
from flexsid.records.search import EstimateStatus, WarningKind
from flexsid.storage import bulk
from flexsid.storage.bulk import Action
from flexsid.storage.jobs import queue
from flexsid.storage.store import Store
from flexsid.workflow.model_structures.model_structures import add_structure
from flexsid.workflow.review import decision_review
from flexsid.workflow.views.dashboard import read_dashboard, read_derivative_coverage

AddManeuver = Callable[..., Maneuver]
AddRun = Callable[..., EstimationRun]
CONSISTENT, SUSPECT = AdequacyState.CONSISTENT, AdequacyState.SUSPECT


@pytest.fixture
def estimate(store: Store, add_run: AddRun) -> Callable[..., int]:
    """Store a run that succeeded, whose derivatives have the size 1 and these standard errors."""

    def add(maneuver_id: int, state: AdequacyState, *also: int, **errors: float | None) -> int:
        settings = RunSettings(additional_maneuver_ids=also)
        run = add_run(Method.OE, maneuver_id=maneuver_id, settings=settings)
        job = queue.claim(store, run.id)
        assert job is not None
        assert run.id is not None
        queue.finish(store, run.id, job.attempt, _make_result(store, state, errors), {})
        return run.id

    return add


def _make_result(store: Store, state: AdequacyState, errors: dict[str, float | None]) -> RunResult:
    return RunResult(
        parameters=tuple(
            ParameterEstimate(name=name, value=-1.0, std_error=error, insensitivity=error)
            for name, error in errors.items()
        ),
        covariance=store.arrays.put(np.eye(len(errors))),
        fit=Fit(
            outcome="converged",
            message="",
            iterations=(),
            cost=1.0,
            r_squared={},
            n_lines=1,
            n_parameters=len(errors),
            seconds=0.0,
            start="",
        ),
        poles=(),
        blocks=(),
        adequacy=ModelAdequacy(state=state, reason=""),
    )


@pytest.fixture
def conditions(maneuver: Maneuver, add_maneuver: AddManeuver) -> list[int]:
    """Return maneuvers: two of one cell of the envelope, one of another, one without a run."""
    others = [
        add_maneuver(fuel=fuel, airspeed=airspeed)
        for fuel, airspeed in ((0.55, 20.4), (0.0, 40.0), (1.0, 30.0))
    ]
    return [one.id or 0 for one in (maneuver, *others)]


def test_each_cell_has_the_best_consistent_estimate(
    store: Store, conditions: list[int], estimate: Callable[..., int]
) -> None:
    first, second, fast, _ = conditions
    estimate(first, CONSISTENT, Cm_alpha=0.3)
    better = estimate(first, CONSISTENT, Cm_alpha=0.05, CZ_q=0.5, tau_q=0.1)
    suspect = estimate(second, SUSPECT, Cm_alpha=0.01, Cm_q=0.04)
    estimate(fast, CONSISTENT, Cm_alpha=None)
    found = read_derivative_coverage(store, 1)
    assert found.names == ("CZ_q", "Cm_alpha", "Cm_q"), "delays are no derivatives"
    assert [(c.airspeed_m_s, c.fuel_fraction, c.n_maneuvers) for c in found.cells] == [
        *((20.0, 0.5, 2), (30.0, 1.0, 1), (40.0, 0.0, 1)),
    ]
    by_place = {(one.name, one.cell): one for one in found.estimates}
    assert {place: one.run_id for place, one in by_place.items() if place[1] == 0} == {
        ("Cm_alpha", 0): better,
        ("CZ_q", 0): better,
        ("Cm_q", 0): suspect,
    }
    assert by_place["Cm_q", 0].status is EstimateStatus.SUSPECT
    assert by_place["CZ_q", 0].is_insensitive
    assert by_place["Cm_alpha", 2].relative_error is None
    spec = draw_derivative_coverage(found)
    assert [trace.get("name") for trace in spec["data"]] == [
        *(None, "insensitive", "suspect", "no standard error", "not estimated"),
    ]
    (errors, *_) = extract_curves(spec)
    assert errors.columns["y"][:3].tolist() == ["C Zq"] * 3
    assert errors.columns["z"][0] == 50.0
    assert spec["data"][0]["customdata"][1] == [better, None, found.estimates[-1].run_id]


def test_a_joint_run_counts_for_all_its_maneuvers(
    store: Store, conditions: list[int], estimate: Callable[..., int]
) -> None:
    first, second, fast, missing = conditions
    joint = estimate(first, CONSISTENT, second, fast, Cm_alpha=0.1)
    found = read_dashboard(store, 1)
    (derivative,) = found.derivatives
    assert (derivative.n_estimated, derivative.n_accurate) == (2, 2)
    assert derivative.best is not None
    assert derivative.best.run_id == joint
    without = {one.kind: one for one in found.warnings}[WarningKind.MANEUVERS_WITHOUT_RUN]
    assert [one.id for one in without.items] == [missing]


def test_an_approved_run_precedes_more_accurate_ones(
    store: Store,
    aircraft: Aircraft,
    modal_table: Any,
    conditions: list[int],
    estimate: Callable[..., int],
) -> None:
    del modal_table
    approved = estimate(conditions[0], SUSPECT, Cm_alpha=0.3)
    estimate(conditions[0], CONSISTENT, Cm_alpha=0.01)
    assert aircraft.id is not None
    structure = Structure(modes=(7,), fixed={})
    stored = add_structure(
        store, ModelStructure(aircraft_id=aircraft.id, name="SP + SW1B", structure=structure)
    )
    proposal = ModelProposal(
        title="baseline",
        structure=StructureReference(id=stored.id or 0, version=1),
        limits={},
        reasoning="",
        run_ids=(approved,),
    )
    store.review_rules.add(ReviewRules(aircraft_id=aircraft.id, version=1))
    decision = decision_review.propose(store, proposal, "Ann")
    reviews = {one.kind: one for one in read_dashboard(store, 1).warnings}[WarningKind.REVIEWS]
    assert [(one.title, one.text) for one in reviews.items] == [("baseline", "awaits votes")]
    decision_review.cast_vote(store, decision.id or 0, 1, Vote.APPROVE, "yes", "Bo")
    (one,) = read_derivative_coverage(store, 1).estimates
    assert (one.run_id, one.status) == (approved, EstimateStatus.APPROVED)
    assert {each.kind: each.total for each in read_dashboard(store, 1).warnings} == {
        WarningKind.SUSPECT_RUNS: 1,
        WarningKind.FAILED_JOBS: 0,
        WarningKind.REVIEWS: 0,
        WarningKind.MANEUVERS_WITHOUT_RUN: 3,
    }


def test_deleted_runs_are_in_no_count(
    store: Store, conditions: list[int], estimate: Callable[..., int], add_run: AddRun
) -> None:
    deleted = estimate(conditions[0], SUSPECT, Cm_alpha=0.1)
    failed = add_run(Method.EE)
    queue.claim(store, failed.id)
    queue.fail(store, failed.id or 0, 1, "singular", "the information matrix is singular")
    assert [one.id for one in store.run_page(adequacy=SUSPECT).items] == [deleted]
    bulk.change_runs(store, [deleted], Action.DELETE)
    found = read_dashboard(store, 1)
    assert (found.n_runs, found.derivatives) == ({"EE": 1}, ())
    suspect, jobs, _, _ = found.warnings
    assert suspect.total == 0
    assert [(one.id, one.text) for one in jobs.items] == [
        (failed.id, "the information matrix is singular")
    ]
    assert store.runs.get(failed.id or 0).state is RunState.FAILED
    assert store.run_page(adequacy=SUSPECT).items == []
    with pytest.raises(UnknownRecord):
        read_dashboard(store, 9)
