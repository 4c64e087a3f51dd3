"""Which terms the data ask for: stepwise regression, orthogonal functions, many maneuvers."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from tests.sysid.conftest import OMEGA, Case, add_noise

from flexsid.errors import BadInput, NotIdentifiable
from flexsid.sysid.estimation.estimate import Estimate, Outcome
from flexsid.sysid.estimation.likelihood import maximize
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.regression.equation_error import equation_error
from flexsid.sysid.regression.least_squares import Regression, regress
from flexsid.sysid.regression.reconstruction import reconstruct_motion
from flexsid.sysid.signals import FrequencyData
from flexsid.sysid.spectra.collinearity import find_near_dependencies
from flexsid.sysid.structure_determination.evidence import (
    Evidence,
    compute_evidence,
    estimate_subset,
)
from flexsid.sysid.structure_determination.search import (
    StructureSelection,
    ValidationModel,
    cross_validate,
    search_equations,
    select_stepwise,
)
from flexsid.sysid.structure_determination.selection import (
    SelectionState,
    Thresholds,
    compute_selection_frequency,
    select_candidates,
    select_terms,
)

ABSENT = (
    "CZ_eta9", "CZ_etadot9", "CZ_wf2s", "Cm_eta7", "Cm_etadot9", "Cm_bfs", "CQ7_q",
    "CQ7_etadot9", "CQ7_wf1s", "CQ9_alpha", "CQ9_q", "CQ9_etadot7", "CQ9_bfs",
)  # fmt: skip


def without(case: Case, absent: tuple[str, ...], scale: float = 1.0) -> Case:
    """The same aircraft with some derivatives zero and the others all changed."""
    values = {k: 0.0 if k in absent else scale * v for k, v in case.truth.named().items()}
    truth = case.truth
    return replace(case, truth=DerivativeTable.from_names(truth.modes, truth.inputs, values))


def evidence(case: Case, seed: int, share: float = 0.03) -> dict[str, Evidence]:
    """Evidence of equation error with all terms, by coefficient."""
    u, y = case.spectra(seed)
    z = add_noise(y, share, np.random.default_rng(1000 + seed))
    through = np.ones(z.shape, dtype=complex)
    motion = reconstruct_motion(case.model, FrequencyData(OMEGA, z, case.model.outputs), through)
    inputs = FrequencyData(OMEGA, u, case.model.inputs)
    estimate = equation_error(case.model, motion, inputs, case.free())
    terms: dict[str, list[str]] = {}
    for name in estimate.names:
        terms.setdefault(name.split("_")[0], []).append(name)
    return {
        row: compute_evidence(estimate, names, 2.0 * OMEGA.size) for row, names in terms.items()
    }


def build_estimate(names: tuple[str, ...], values: np.ndarray, covariance: np.ndarray) -> Estimate:
    return Estimate(
        names, values, values, covariance, covariance, (), (), Outcome.CONVERGED, "solved"
    )


def as_estimate(names: tuple[str, ...], found: Regression) -> Estimate:
    estimate = build_estimate(names, found.values, found.covariance)
    return replace(estimate, corrected_covariance=found.corrected_covariance)


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
    plain = regress(X, z, names)
    found = compute_evidence(as_estimate(names, plain), names, 160.0)
    all_in = estimate_subset(found, np.ones(4, dtype=bool))
    assert np.allclose(all_in.values, plain.values)
    assert np.allclose(all_in.variance, np.diag(plain.corrected_covariance))
    three = np.array([True, True, False, True])
    fewer = regress(X[:, three], z, ("CZ_a", "CZ_b", "CZ_d"))
    subset = estimate_subset(found, three)
    assert np.allclose(subset.values[three], fewer.values)
    # the next to enter takes the value it has with all four, for they are then all in
    assert subset.values[2] == pytest.approx(plain.values[2])


def test_evidence_on_some_terms_is_that_of_the_marginal_likelihood():
    """The Schur complement over the other parameters, their priors included."""
    rng = np.random.default_rng(9)
    root = rng.normal(size=(40, 6))
    information = root.T @ root + np.diag([0.0, 0.0, 0.0, 4.0, 4.0, 4.0])
    A, B, D = information[:3, :3], information[:3, 3:], information[3:, 3:]
    names = ("CZ_a", "CZ_b", "CZ_c", "CZ_n1", "CZ_n2", "CZ_n3")
    values = rng.normal(size=6)
    found = compute_evidence(
        build_estimate(names, values, np.linalg.inv(information)), names[:3], 80.0
    )
    marginal = A - B @ np.linalg.inv(D) @ B.T
    assert np.allclose(found.information, marginal)
    assert np.allclose(found.moment, marginal @ values[:3])
    assert np.allclose(found.scatter, marginal)


def test_terms_that_a_run_holds_are_never_dropped(make_case):
    case = without(make_case(1), ("CZ_etadot7", "CZ_wf2s"))
    row = evidence(case, 7)
    for method in ("stepwise", "orthogonal functions"):
        free = search_equations([row], method)
        held = search_equations([row], method, forced={"CZ_wf2s"})
        assert set(find_absent(free)) == {"CZ_etadot7", "CZ_wf2s"}
        assert find_absent(held) == ["CZ_etadot7"]


@pytest.mark.parametrize("weak", [0.0, 3.0])
def test_standard_errors_include_the_bias_by_dropped_terms(weak):
    """A correlated term of three standard errors is dropped, but not zero: nine of ten draws are
    then within two standard errors, without the bias four of ten.
    """
    rng = np.random.default_rng(4)
    information = np.array([[1.0, 0.6], [0.6, 1.0]])
    covariance = np.linalg.inv(information)
    names, truth = ("CZ_a", "CZ_b"), np.array([30.0, weak * covariance[1, 1] ** 0.5])
    inside, plain = [], []
    for values in rng.multivariate_normal(truth, covariance, size=150):
        row = compute_evidence(build_estimate(names, values, covariance), names, 80.0)
        term = select_stepwise([row]).terms[0]
        assert term.value is not None
        assert term.std_error is not None
        error = abs(term.value - truth[0])
        inside.append(error < 2.0 * term.std_error)
        plain.append(error < 2.0 * information[0, 0] ** -0.5)
    assert np.mean(inside) > 0.86
    assert np.mean(plain) < 0.6 or not weak


def test_terms_without_standard_errors_have_no_evidence():
    estimate = build_estimate(("CZ_a", "CZ_b"), np.ones(2), np.diag([1.0, np.nan]))
    with pytest.raises(NotIdentifiable, match="CZ_b have no standard error"):
        compute_evidence(estimate, ("CZ_a", "CZ_b"), 80.0)


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
        experiment, candidates = output_error_of(case, seed), base.free(off=0.2, seed=seed)
        full = maximize([experiment], candidates)
        found = compute_evidence(full, full.names, 2.0 * experiment.measured.size)
        everything = np.ones(len(full.names), dtype=bool)
        end = select_terms([found], SelectionState(everything), Thresholds())
        dropped = {full.names[k] for k in np.flatnonzero(~end.selected)}
        assert dropped == set(absent), seed


def test_the_predicted_change_agrees_with_the_refit(make_case):
    case = without(make_case(1), ("CZ_etadot7", "Cm_bfs"))
    experiment, candidates = output_error_of(case, 12), case.free()
    full = maximize([experiment], candidates)
    found = compute_evidence(full, full.names, 2.0 * experiment.measured.size)
    inside = np.ones(full.values.size, dtype=bool)
    inside[candidates.names.index("Cm_bfs")] = False
    fewer = maximize([experiment], select_candidates(candidates, inside, full.values))
    rose = 2.0 * (fewer.steps[-1].cost - full.steps[-1].cost)
    out = estimate_subset(found, np.ones_like(inside))
    assert out.change[~inside][0] == pytest.approx(rose, rel=0.1, abs=0.05)


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
        models = [ValidationModel(one, candidates) for one in (fitted, unseen, faster)]
        halves = cross_validate(models[:1], [estimate])
        elsewhere = cross_validate(models[:1], [estimate], models[1:])
        assert [len(halves), len(elsewhere)] == [2, 2]
        assert all(0.8 < (one.r_squared or 0.0) < 1.0 for one in elsewhere)
        costs[name] = sum(one.cost or np.inf for one in elsewhere)
        assert sum(one.cost or np.inf for one in halves) < 0.0
    assert costs["true"] < costs["all"] + 5.0
    assert costs["true"] < costs["few"] - 10.0


def test_every_maneuver_is_predicted_by_the_rest(make_case):
    case = make_case(1)
    maneuvers = [replace(output_error_of(case, k, 0.1), name=f"m{k}") for k in range(3)]
    estimates = [maximize([one], case.free()) for one in maneuvers]
    found = cross_validate([ValidationModel(one, case.free()) for one in maneuvers], estimates)
    assert [one.name for one in found] == ["m0", "m1", "m2"]
    assert min(one.r_squared or 0.0 for one in found) > 0.98
