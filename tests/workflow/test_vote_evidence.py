"""Evidence beside a vote: fits of the runs, and comparison with the present baseline."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from flexsid.records.decision import (
    LimitedQuantity,
    ModelProposal,
    ModelStructure,
    ReviewRules,
    Structure,
    StructureReference,
    Vote,
)
from flexsid.records.run import AdequacyState, Method, ModelAdequacy, RunState
from flexsid.records.search import SearchCandidate, SearchResult, SearchSettings, StructureSearch
from flexsid.workflow.model_structures.model_structures import add_structure
from flexsid.workflow.review import decision_review
from flexsid.workflow.review.vote_evidence import collect_vote_evidence

BEFORE = Structure(modes=(7,), fixed={})
AFTER = replace(BEFORE, absent=("CZ_q",))


@pytest.fixture
def structures(store, aircraft, modal_table) -> tuple[int, int]:
    """Return the ids of the baseline's model structure, and of that without CZ_q."""
    del modal_table
    stored = [
        add_structure(store, ModelStructure(aircraft_id=aircraft.id, name=name, structure=one))
        for name, one in (("SP + SW1B", BEFORE), ("without CZ_q", AFTER))
    ]
    return stored[0].id or 0, stored[1].id or 0


def propose(structure_id: int, *run_ids: int, **changes: Any) -> ModelProposal:
    return replace(
        ModelProposal(
            title="t",
            structure=StructureReference(id=structure_id, version=1),
            limits={},
            reasoning="r",
            run_ids=run_ids,
        ),
        **changes,
    )


def never(run_ids: tuple[int, ...]) -> None:
    del run_ids


def test_a_proposal_is_compared_with_the_baseline_on_the_same_maneuver(
    store, aircraft, structures, add_result
):
    before, after = structures
    rules = ReviewRules(aircraft_id=aircraft.id, own_allowed=True, author="Bo")
    decision_review.change_rules(store, rules)
    baseline = decision_review.propose(store, propose(before), "Ann")
    decision_review.cast_vote(store, baseline.id or 0, 1, Vote.APPROVE, "yes", "Bo")
    known = {"Cm_alpha": (-1.0, 0.1), "Cm_q": (-8.0, 0.3), "CZ_q": (-2.0, 0.4)}
    add_result(known, structure=BEFORE)
    newest = add_result(known, structure=BEFORE)
    add_result(known, structure=BEFORE, method=Method.EE)
    own = add_result({"Cm_alpha": (-1.05, 0.1), "Cm_q": (-9.5, 0.3)}, structure=AFTER)
    speeds: dict[tuple[int, ...], float] = {(own.id,): 41.5, (newest.id,): 43.0}

    def find_flutter(run_ids: tuple[int, ...]) -> Any:
        return SimpleNamespace(
            sentence="s", airspeed_m_s=speeds[run_ids], low_m_s=40.0, high_m_s=45.0
        )

    proposal = propose(after, own.id)
    decision = decision_review.propose(store, proposal, "Ann")
    evidence = collect_vote_evidence(store, proposal, find_flutter, decision)

    (run,) = evidence.runs
    assert (run.lowest_output, run.lowest_r_squared) == ("az_egi", 0.8)
    assert (run.has_proposed_structure, run.baseline_run_id) == (True, newest.id)
    reference = evidence.reference
    assert reference is not None
    assert (reference.decision_id, reference.name) == (baseline.id, "SP + SW1B")
    assert [(one.what, one.before, one.after) for one in reference.terms] == [
        ("CZ_q", "free", "absent")
    ]
    (moved,) = reference.derivatives
    assert (moved.name, moved.baseline_run_id, reference.n_derivatives) == ("Cm_q", newest.id, 2)
    assert moved.difference_sigma == pytest.approx(1.5 / (0.3 * 2**0.5))
    assert reference.flutter_change_m_s == pytest.approx(-1.5)
    assert evidence.limits == {
        LimitedQuantity.AIRSPEED: (19.0, 21.0),
        LimitedQuantity.FUEL: (0.45, 0.55),
    }


def test_missing_evidence_is_a_warning(store, structures):
    evidence = collect_vote_evidence(store, propose(structures[1]), never)
    assert evidence.warnings == ("No run is attached: there is no evidence for this proposal.",)
    assert (evidence.runs, evidence.reference, evidence.limits) == ((), None, {})


def test_what_speaks_against_a_proposal_is_a_warning(store, structures, add_result):
    before, after = structures
    other = add_result({"Cm_q": (-8.0, 0.3)}, structure=BEFORE, structure_id=before)
    suspect = add_result({"Cm_q": (-8.0, 0.3)}, structure=AFTER, method=Method.EE)
    assert suspect.result is not None
    result = replace(
        suspect.result,
        fit=replace(suspect.result.fit, outcome="iteration limit", warnings=("CZ_q insensitive",)),
        adequacy=ModelAdequacy(state=AdequacyState.SUSPECT, reason="output delay of q"),
    )
    store.runs.replace(replace(suspect, result=result))
    proposal = propose(
        after,
        *(other.id, suspect.id, 99),
        changes=StructureReference(id=before, version=1),
        limits={LimitedQuantity.AIRSPEED: (25.0, 30.0)},
    )
    decision = decision_review.propose(store, replace(proposal, run_ids=()), "Ann")
    evidence = collect_vote_evidence(store, proposal, never, decision)
    words = " ".join(evidence.warnings)
    for part in (
        "Run 99 was deleted.",
        f"Run {other.id} estimated another model structure",
        f"Run {suspect.id} has not converged (iteration limit).",
        f"Run {suspect.id}: a test for remaining model error rejects the model.",
        "Maneuver m is outside the proposed range.",
        "airspeeds from 25 to 30 m/s; the runs cover airspeeds from 19 to 21 m/s.",
        "'SP + SW1B', version 1, was not estimated from the same maneuver",
    ):
        assert part in words
    assert evidence.runs[1].warnings == ("output delay of q", "CZ_q insensitive")
    assert evidence.reference is not None
    assert evidence.reference.decision_id is None, "no baseline, but a structure that it changes"
    assert evidence.flutter.sentence is None


def test_the_search_of_a_proposal_is_evidence(store, aircraft, modal_table, add_result):
    del modal_table
    free = ("CZ_alpha", "Cm_alpha")
    fewer = replace(BEFORE, free=free[:1], absent=free[1:])
    candidate = SearchCandidate(
        name="1 term", why="", structure=fewer, n_terms=1, proposed=False, converged=True,
        cost=0.0, bic=0.0, likelihood_ratio=None, predicted_ratio=None, predicted=(),
        predictive_cost=-50.0, flutter_m_s=None, flutter_std_m_s=None, flutter="",
        adequacy=AdequacyState.CONSISTENT, adequacy_reason="None of 9 tests rejects the model.",
    )  # fmt: skip
    everything = replace(
        candidate,
        structure=replace(BEFORE, free=free),
        n_terms=2,
        predictive_cost=-80.0,
        adequacy=AdequacyState.SUSPECT,
        adequacy_reason="A mode is missing.",
    )
    run = add_result({"CZ_alpha": (1.0, 0.1)}, structure=fewer)
    store.searches.add(
        StructureSearch(
            aircraft_id=aircraft.id,
            maneuver_ids=(run.maneuver_id,),
            method=Method.OE,
            structure=BEFORE,
            settings=SearchSettings(),
            state=RunState.SUCCEEDED,
            result=SearchResult(
                sentence="", groups=(), candidates=(candidate, everything), warnings=(),
                seconds=1.0, undecided="a test rejects it",
            ),
        )
    )  # fmt: skip
    structure = ModelStructure(aircraft_id=aircraft.id, name="fewer", structure=fewer)
    stored = add_structure(store, structure)
    evidence = collect_vote_evidence(store, propose(stored.id or 0, run.id or 0), never)
    (found,) = evidence.searches
    assert (found.n_terms, found.n_candidate_terms) == (1, 2)
    assert found.adequacy is AdequacyState.SUSPECT
    assert found.likelihood_difference == -30.0
    assert not found.is_proposed
    assert (
        "Search 1: a test rejects the model with all terms. A mode is missing." in evidence.warnings
    )
    assert any("held-out data is lower by 30" in one for one in evidence.warnings)
