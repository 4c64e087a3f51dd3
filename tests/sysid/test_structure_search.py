"""Which terms the data ask for: stepwise regression, orthogonal functions, many maneuvers."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from tests.sysid.conftest import OMEGA, Case, add_noise

from flexsid.errors import BadInput, Cancelled
from flexsid.sysid.estimation.likelihood import maximize
from flexsid.sysid.estimation.reconstruction import reconstruct_motion
from flexsid.sysid.estimation.regression import ErrorsInVariables, regress
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.signals import FrequencyData
from flexsid.sysid.spectra.collinearity import find_near_dependencies
from flexsid.sysid.structure_determination.candidates import search_candidates
from flexsid.sysid.structure_determination.equation import (
    compute_equation_evidence,
    compute_regression_evidence,
)
from flexsid.sysid.structure_determination.evidence import estimate_subset
from flexsid.sysid.structure_determination.likelihood import (
    compute_likelihood_evidence,
    select_candidates,
)
from flexsid.sysid.structure_determination.search import (
    StructureSelection,
    search_equations,
    select_stepwise,
)
from flexsid.sysid.structure_determination.selection import (
    Thresholds,
    compute_selection_frequency,
)
from flexsid.sysid.structure_determination.validation import cross_validate

ABSENT = (
    "CZ_eta9", "CZ_etadot9", "CZ_wf2s", "Cm_eta7", "Cm_etadot9", "Cm_bfs", "CQ7_q",
    "CQ7_etadot9", "CQ7_wf1s", "CQ9_alpha", "CQ9_q", "CQ9_etadot7", "CQ9_bfs",
)  # fmt: skip


def without(case: Case, absent: tuple[str, ...], scale: float = 1.0) -> Case:
    """The same aircraft with some derivatives zero and the others all changed."""
    values = {k: 0.0 if k in absent else scale * v for k, v in case.truth.named().items()}
    truth = case.truth
    return replace(case, truth=DerivativeTable.from_names(truth.modes, truth.inputs, values))


def evidence(case: Case, seed: int, share: float = 0.03):
    u, y = case.spectra(seed)
    z = add_noise(y, share, np.random.default_rng(1000 + seed))
    through = np.ones(z.shape, dtype=complex)
    motion = reconstruct_motion(case.model, FrequencyData(OMEGA, z, case.model.outputs), through)
    inputs = FrequencyData(OMEGA, u, case.model.inputs)
    return compute_equation_evidence(case.model, motion, inputs, case.free())


def exact(n_omega: int, p: int) -> ErrorsInVariables:
    """Nothing is uncertain but a little of the dependent variable."""
    return ErrorsInVariables(
        np.zeros((n_omega, p, p)), np.zeros((n_omega, p)), np.full(n_omega, 1e-6)
    )


def find_absent(found: StructureSelection) -> list[str]:
    """Candidates that were not selected."""
    terms = (term for one in found.coefficients.values() for term in one.terms)
    return sorted(term.name for term in terms if not term.selected)


@pytest.mark.parametrize("method", ["stepwise", "orthogonal functions"])
def test_the_true_structure_is_found_seed_by_seed(make_case, method):
    case = without(make_case(2), ABSENT)
    for seed in range(8):
        found = search_equations([evidence(case, seed)], method)
        assert find_absent(found) == sorted(ABSENT), seed


def test_many_maneuvers_support_together_what_none_supports_alone(make_case):
    case = without(make_case(2), ABSENT)
    weak = [evidence(case, seed, share=0.4) for seed in range(16)]
    alone = [len(set(find_absent(search_equations([one]))) - set(ABSENT)) for one in weak]
    together = search_equations(weak)
    lost = set(find_absent(together)) - set(ABSENT)
    assert len(lost) < 0.8 * np.mean(alone)
    assert not set(together.selected) & set(ABSENT)


def test_drift_of_one_term_over_the_envelope_is_not_taken_for_another(make_case):
    base = make_case(2)
    maneuvers = [
        evidence(without(base, ABSENT, scale), seed)
        for seed, scale in enumerate(np.linspace(0.7, 1.3, 12))
    ]
    assert find_absent(search_equations(maneuvers)) == sorted(ABSENT)


def test_the_path_reports_each_step_and_its_criteria(make_case):
    case = without(make_case(1), ())
    selection = search_equations([evidence(case, 3)]).coefficients["CZ"]
    assert [step.action for step in selection.path].count("enter") >= len(selection.selected)
    fits = [step.criteria.r_squared for step in selection.path if step.action == "enter"]
    assert fits == sorted(fits)
    assert selection.criteria.r_squared > 0.9
    first, last = selection.path[0].criteria, selection.criteria
    assert last.bic < first.bic
    assert last.pse < first.pse


def test_evidence_gives_the_values_and_errors_of_the_regression_itself():
    rng = np.random.default_rng(4)
    X = rng.normal(size=(80, 4)) + 1j * rng.normal(size=(80, 4))
    z = X @ [1.0, -0.5, 0.0, 0.2] + 0.3 * (rng.normal(size=80) + 1j * rng.normal(size=80))
    names = ("CZ_a", "CZ_b", "CZ_c", "CZ_d")
    found = compute_regression_evidence(X, z, names, exact(80, 4))
    plain = regress(X, z, names)
    all_in = estimate_subset(found, np.ones(4, dtype=bool))
    assert np.allclose(all_in.values, plain.values)
    assert np.all(all_in.variance > 0.999 * np.diag(plain.corrected_covariance))
    assert np.all(all_in.variance < 1.5 * np.diag(plain.corrected_covariance))
    three = np.array([True, True, False, True])
    fewer = regress(X[:, three], z, ("CZ_a", "CZ_b", "CZ_d"))
    subset = estimate_subset(found, three)
    assert np.allclose(subset.values[three], fewer.values)
    # the next to enter takes the value it has with all four, for they are then all in
    assert subset.values[2] == pytest.approx(plain.values[2])


def test_one_of_two_identical_terms_is_selected():
    rng = np.random.default_rng(5)
    X = rng.normal(size=(60, 3)) + 1j * rng.normal(size=(60, 3))
    X = np.column_stack([X, X[:, 0], np.zeros(60)])
    z = X[:, 0] + X[:, 1] + 0.1 * (rng.normal(size=60) + 1j * rng.normal(size=60))
    names = ("CZ_a", "CZ_b", "CZ_c", "CZ_same", "CZ_still")
    found = select_stepwise([compute_regression_evidence(X, z, names, exact(60, 5))])
    assert "CZ_b" in found.selected
    assert len({"CZ_a", "CZ_same"} & set(found.selected)) == 1
    assert not {"CZ_c", "CZ_still"} & set(found.selected)


def test_more_candidates_than_frequencies_still_end_in_a_choice():
    rng = np.random.default_rng(6)
    X = rng.normal(size=(10, 30)) + 1j * rng.normal(size=(10, 30))
    z = 5.0 * X[:, 3] + 0.01 * (rng.normal(size=10) + 1j * rng.normal(size=10))
    names = tuple(f"CZ_t{k}" for k in range(30))
    found = select_stepwise([compute_regression_evidence(X, z, names, exact(10, 30))])
    assert "CZ_t3" in found.selected
    assert len(found.selected) < 20


def test_resampled_frequencies_choose_strong_terms_always_and_absent_ones_hardly(make_case):
    case = without(make_case(1), ("CZ_etadot7", "CZ_wf2s"))
    row = [evidence(case, 7)["CZ"]]
    often = dict(
        zip(
            row[0].names,
            compute_selection_frequency(row, select_stepwise, n_resamplings=20),
            strict=True,
        )
    )
    assert often["CZ_alpha"] == often["CZ_wf1s"] == 1.0
    assert max(often["CZ_etadot7"], often["CZ_wf2s"]) < 0.3


def test_thresholds_that_would_never_end_are_refused():
    with pytest.raises(BadInput, match="f_out 5 is above f_in 4"):
        Thresholds(f_in=4.0, f_out=5.0)
    with pytest.raises(BadInput, match="above zero"):
        Thresholds(f_in=float("nan"))
    with pytest.raises(BadInput, match="at least one maneuver"):
        search_equations([])


def output_error_of(case: Case, seed: int, share: float = 0.03):
    u, y = case.spectra(seed)
    return case.experiment(u, add_noise(y, share, np.random.default_rng(2000 + seed)))


@pytest.mark.parametrize("n_modes", [1, 2])
def test_output_error_finds_the_true_structure_from_all_terms(make_case, n_modes):
    base = make_case(n_modes)
    absent = tuple(name for name in ABSENT if name in base.truth.named())
    case = without(base, absent)
    for seed in range(6):
        candidates = base.free(off=0.2, seed=seed)
        found = search_candidates([output_error_of(case, seed)], candidates)
        assert set(candidates.names) - set(found.best.selected) == set(absent), seed
        assert found.best.converged
        assert found.best is found.candidates[-1]


def test_terms_missing_at_the_start_come_in_by_their_score(make_case):
    base = make_case(1)
    case = without(base, ("CZ_etadot7", "Cm_bfs"))
    candidates = case.free()
    missing = {"CZ_etadot7", "Cm_bfs", "Cm_eta7", "CQ7_wf2s", "CZ_wf4s"}
    begin = [name for name in candidates.names if name not in missing]
    start = replace(candidates, start=case.truth.values.ravel() * 1.1)
    found = search_candidates([output_error_of(case, 11)], start, begin)
    assert set(candidates.names) - set(found.best.selected) == {"CZ_etadot7", "Cm_bfs"}
    assert found.candidates[0].selected == tuple(begin)
    assert "entered by the score" in found.candidates[1].why


def test_a_search_is_cancelled_within_a_fit(make_case):
    case, seen = make_case(1), []

    def cancel_fit(fitted: int, message: str) -> None:
        seen.append(message)
        if message.endswith("iteration 2"):
            raise Cancelled("cancelled")

    with pytest.raises(Cancelled):
        search_candidates([output_error_of(case, 0)], case.free(off=0.2), report=cancel_fit)
    assert len(seen) == 3  # before the fit, and two of its iterations


def test_the_predicted_change_agrees_with_the_refit(make_case):
    case = without(make_case(1), ("CZ_etadot7", "Cm_bfs"))
    experiment, candidates = output_error_of(case, 12), case.free()
    full = maximize([experiment], candidates)
    evidence = compute_likelihood_evidence(experiment, candidates, full.values, full.values.size)
    inside = np.ones(full.values.size, dtype=bool)
    inside[candidates.names.index("Cm_bfs")] = False
    fewer = maximize([experiment], select_candidates(candidates, inside, full.values))
    rose = 2.0 * (fewer.steps[-1].cost - full.steps[-1].cost)
    out = estimate_subset(evidence, np.ones_like(inside))
    assert out.change[~inside][0] == pytest.approx(rose, rel=0.1, abs=0.05)
    theta = np.zeros(full.values.size)
    theta[inside] = fewer.values
    back = estimate_subset(
        compute_likelihood_evidence(experiment, candidates, theta, int(inside.sum())), inside
    )
    assert back.change[~inside][0] == pytest.approx(rose, rel=0.1, abs=0.05)
    assert back.values[~inside] == pytest.approx(full.values[~inside], rel=0.05)


def test_several_maneuvers_share_a_model_structure_and_have_their_own_values(make_case):
    base = make_case(1)
    absent = ("CZ_etadot7", "Cm_bfs")
    maneuvers = [
        output_error_of(without(base, absent, scale), seed, share=0.1)
        for seed, scale in enumerate((0.8, 1.0, 1.2))
    ]
    found = search_candidates(maneuvers, base.free())
    assert set(base.truth.named()) - set(found.best.selected) == set(absent)
    slopes = [dict(zip(e.names, e.values, strict=True)) for e in found.best.estimates]
    assert [round(one["CZ_alpha"] / base.truth.named()["CZ_alpha"], 1) for one in slopes] == [
        0.8, 1.0, 1.2,
    ]  # fmt: skip


def test_a_start_that_is_no_candidate_is_refused(make_case):
    case = make_case(0, n_outputs=9)
    with pytest.raises(BadInput, match="CZ_eta7 cannot be in the model"):
        search_candidates([output_error_of(case, 1)], case.free(), ["CZ_eta7"])


def test_nearly_dependent_terms_are_named_with_their_condition_index():
    rng = np.random.default_rng(8)
    X = rng.normal(size=(200, 5))
    X[:, 4] = 100.0 * (X[:, 0] + X[:, 1] + 0.01 * rng.normal(size=200))
    (found,) = find_near_dependencies(X.T @ X, ("a", "b", "c", "d", "e"))
    assert set(found.shares) == {"a", "b", "e"}
    assert found.index == pytest.approx(np.linalg.cond(X / np.linalg.norm(X, axis=0)), rel=1e-6)
    assert find_near_dependencies(X[:, :4].T @ X[:, :4], ("a", "b", "c", "d")) == ()


def test_the_true_structure_predicts_best_what_it_did_not_see(make_case):
    base = make_case(1)
    absent = ("CZ_etadot7", "Cm_bfs")
    case = without(base, absent)
    candidates = case.free()
    fitted, unseen = output_error_of(case, 21, share=0.3), output_error_of(case, 22, share=0.3)
    other_speed = replace(make_case(1, airspeed_ratio=0.8), truth=case.truth)
    faster = output_error_of(other_speed, 23, share=0.3)
    costs = {}
    everything = np.ones(candidates.start.size, dtype=bool)
    for name, gone in (("true", absent), ("all", ()), ("few", ("CZ_wf1s", "Cm_q", *absent))):
        free = everything & [n not in gone for n in candidates.names]
        estimate = maximize([fitted], select_candidates(candidates, free, candidates.start))
        halves = cross_validate([fitted], [estimate], candidates)
        elsewhere = cross_validate([fitted], [estimate], candidates, [unseen, faster])
        assert [len(halves), len(elsewhere)] == [2, 2]
        assert all(0.8 < one.r_squared < 1.0 for one in elsewhere)
        costs[name] = sum(one.cost for one in elsewhere)
        assert sum(one.cost for one in halves) < 0.0
    assert costs["true"] < costs["all"] + 5.0
    assert costs["true"] < costs["few"] - 10.0


def test_every_maneuver_is_predicted_by_the_rest(make_case):
    case = make_case(1)
    maneuvers = [replace(output_error_of(case, k, 0.1), name=f"m{k}") for k in range(3)]
    estimates = [maximize([one], case.free()) for one in maneuvers]
    found = cross_validate(maneuvers, estimates, case.free())
    assert [one.name for one in found] == ["m0", "m1", "m2"]
    assert min(one.r_squared for one in found) > 0.98
