"""Flight conditions, and the numbers of their sheet."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from flexsid.errors import UnknownRecord
from flexsid.figures.condition_sheet import draw_condition_derivatives, format_with_error
from flexsid.records.condition_sheet import SimulatedAircraft, SourceRole
from flexsid.records.decision import (
    ModelProposal,
    ModelStructure,
    ReviewRules,
    Structure,
    StructureReference,
    Vote,
)
from flexsid.records.maneuver import GROUND
from flexsid.records.run import Method
from flexsid.sysid.estimation.agreement import compute_correlation, find_correlated_pairs
from flexsid.workflow.model_structures.model_structures import add_structure
from flexsid.workflow.review import decision_review
from flexsid.workflow.review.condition_sheet import (
    build_condition_sheet,
    find_condition,
    list_conditions,
)
from flexsid.workflow.review.vote_evidence import collect_vote_evidence

STRUCTURE = Structure(modes=(7,), fixed={})


def never(*ids: tuple[int, ...]) -> None:
    del ids


def read_sheet(store, maneuver_id, truth=None):
    simulated = truth and SimulatedAircraft(name="X-1", compute_derivatives=lambda fuel: truth)
    return build_condition_sheet(
        store, maneuver_id, never, never, simulated=simulated, shows_truth=True
    )


def test_a_condition_is_one_airspeed_and_nearly_one_fuel(store, add_maneuver):
    first = add_maneuver(fuel=0.7, airspeed=38.3)
    repeat = add_maneuver(fuel=0.55, airspeed=38.6)
    lighter = add_maneuver(fuel=0.4, airspeed=38.3)
    faster = add_maneuver(fuel=0.7, airspeed=42.5)
    lateral = add_maneuver(fuel=0.7, airspeed=38.3, axis="lateral")
    ground = add_maneuver(fuel=0.7, axis=GROUND)
    found = [[one.maneuver_id for one in item.records] for item in list_conditions(store)]
    assert found == [[first.id, repeat.id], [lighter.id], [faster.id], [lateral.id]]
    assert find_condition(store, repeat.id).id == first.id
    with pytest.raises(UnknownRecord):
        find_condition(store, ground.id)


def test_a_sheet_compares_methods_repeats_predictions_and_truth(
    store, maneuver, add_maneuver, add_result, prediction
):
    repeat = add_maneuver(fuel=0.4)
    predicted = {"prediction_id": prediction.id}
    own = {"Cm_alpha": (-1.0, 0.1), "CQ7_eta7": (0.5, 0.1)}
    modal = {"CQ7_eta7": 0.0999}
    reference = add_result(own, modal_std=modal, structure=STRUCTURE, **predicted)
    add_result({"Cm_alpha": (-1.2, 0.1)}, method=Method.EE, structure=STRUCTURE)
    again = add_result(
        {"Cm_alpha": (-1.3, 0.1), "CQ7_eta7": (0.5, 0.1)},
        modal_std=modal,
        structure=STRUCTURE,
        maneuver_id=repeat.id,
    )
    sheet = read_sheet(store, repeat.id, {"Cm_alpha": -1.1})

    assert (sheet.reference_run_id, sheet.record.maneuver_id) == (reference.id, maneuver.id)
    assert (sheet.has_truth, sheet.n_true, sheet.n_inside) == (True, 1, 1)
    roles = [(one.role, one.run_id) for one in sheet.sources]
    assert roles[0] == (SourceRole.REFERENCE, reference.id)
    assert (SourceRole.REPEAT, again.id) in roles
    assert roles[-1] == (SourceRole.TRUTH, None)
    alpha, eta = sheet.rows
    assert (alpha.name, alpha.is_testable, eta.is_testable) == ("Cm_alpha", True, False)
    values = dict(zip([one.role for one in sheet.sources], alpha.values, strict=True))
    method, moved, truth = (
        values[role] for role in (SourceRole.METHOD, SourceRole.REPEAT, SourceRole.TRUTH)
    )
    assert method is not None
    assert method.deviation_sigma == pytest.approx(-2.0)
    assert method.deviation_percent == pytest.approx(-20.0)
    assert truth is not None
    assert truth.deviation_sigma == pytest.approx(-1.0)
    assert moved is not None
    assert moved.moved is not None
    assert moved.value == pytest.approx(-1.3 + moved.moved), "moved to the fuel of the sheet"
    assert moved.deviation_sigma == pytest.approx((moved.value + 1.0) / (0.1 * 2**0.5))
    assert (sheet.n_testable, sheet.n_pairs) == (1, 1), "shared errors are not counted"
    assert "their agreement shows that the computation is right" in sheet.note
    assert [one.label for one in sheet.held_out] == [repeat.label]


def test_without_a_decision_the_structure_is_that_of_most_methods(
    store, aircraft, modal_table, add_result, maneuver
):
    del modal_table
    larger, smaller = (
        add_structure(store, ModelStructure(aircraft_id=aircraft.id, name=name, structure=kind))
        for name, kind in (("A", STRUCTURE), ("B", replace(STRUCTURE, absent=("CZ_q",))))
    )
    for record, method in ((larger, Method.OE), (larger, Method.EE), (smaller, Method.OE)):
        add_result(
            {"Cm_q": (-8.0, 0.3)},
            method=method,
            structure=record.structure,
            structure_id=record.id,
            structure_version=1,
        )
    sheet = read_sheet(store, maneuver.id)
    assert sheet.structure is not None
    assert sheet.structure.name == "A", "not that of the newest run"
    assert [one.method for one in sheet.sources] == [Method.OE, Method.EE]


def test_without_a_run_a_sheet_says_so(store, maneuver):
    sheet = read_sheet(store, maneuver.id)
    assert sheet.reference_run_id is None
    assert sheet.sentence == "No run of this condition has succeeded."
    assert draw_condition_derivatives(sheet)["data"] == []


def test_an_open_proposal_is_compared_with_the_baseline_on_the_sheet(
    store, aircraft, modal_table, add_result, maneuver
):
    del modal_table
    rules = ReviewRules(aircraft_id=aircraft.id, own_allowed=True, author="Bo")
    decision_review.change_rules(store, rules)
    kinds = [STRUCTURE, replace(STRUCTURE, absent=("CZ_q",))]
    before, after = (
        add_structure(store, ModelStructure(aircraft_id=aircraft.id, name=name, structure=kind))
        for name, kind in zip("AB", kinds, strict=True)
    )

    def propose(record, *run_ids):
        proposal = ModelProposal(
            title=record.name,
            structure=StructureReference(id=record.id, version=1),
            limits={},
            reasoning="r",
            run_ids=run_ids,
        )
        return decision_review.propose(store, proposal, "Ann")

    baseline = propose(before)
    decision_review.cast_vote(store, baseline.id or 0, 1, Vote.APPROVE, "yes", "Bo")
    known = {"Cm_alpha": (-1.0, 0.1), "Cm_q": (-8.0, 0.3)}
    add_result(known, structure=kinds[0])
    own = add_result({"Cm_alpha": (-1.01, 0.1), "Cm_q": (-8.1, 0.3)}, structure=kinds[1])
    decision = propose(after, own.id)
    sheet = read_sheet(store, maneuver.id)
    assert (sheet.decision_id, sheet.decision_state) == (decision.id, "open")
    assert (sheet.baseline_decision_id, sheet.reference_run_id) == (baseline.id, own.id)

    evidence = collect_vote_evidence(store, decision.proposal, never, decision)
    assert evidence.consequence == (
        f"supersedes decision {baseline.id}, default of all new runs of {aircraft.name}"
    )
    reference = evidence.reference
    assert reference is not None
    assert reference.derivatives == (), "none moved by more than 2 sigma"
    assert [one.name for one in reference.largest_changes] == ["Cm_q", "Cm_alpha"]


def test_pairs_are_sorted_by_the_size_of_their_correlation():
    covariance = np.array([[4.0, -3.0, 0.5], [-3.0, 9.0, 0.0], [0.5, 0.0, 1.0]])
    pairs = find_correlated_pairs(compute_correlation(covariance), 2)
    assert [(i, j) for i, j, _ in pairs] == [(0, 1), (0, 2)]
    assert [rho for *_, rho in pairs] == pytest.approx([-0.5, 0.25])


def test_the_error_decides_how_many_digits_are_written():
    assert format_with_error(-4.65146, 0.0248) == ("−4.651", "0.025")
    assert format_with_error(-5.35, 0.115) == ("−5.35", "0.12")
