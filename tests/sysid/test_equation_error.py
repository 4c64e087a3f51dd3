"""Equation error: reconstruction, bias of noisy regressors, batches."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from tests.sysid.conftest import OMEGA, add_noise

from flexsid.errors import BadInput, NotIdentifiable
from flexsid.sysid.estimation.agreement import apply_priors, fuse_estimates
from flexsid.sysid.estimation.estimate import Estimate, Outcome
from flexsid.sysid.estimation.linear_algebra import regress_many
from flexsid.sysid.model.rigid_body import SensorRows
from flexsid.sysid.regression.equation_error import equation_error
from flexsid.sysid.regression.least_squares import ErrorsInVariables, regress
from flexsid.sysid.regression.reconstruction import reconstruct_motion
from flexsid.sysid.signals import FrequencyData


def spectra(case, u, z):
    through = np.ones(z.shape, dtype=complex)
    return (
        FrequencyData(OMEGA, u, case.model.inputs),
        FrequencyData(OMEGA, z, case.model.outputs),
        through,
    )


def test_without_noise_motion_and_derivatives_are_exact(make_case):
    case = make_case(2)
    u, y = case.spectra(1)
    inputs, outputs, through = spectra(case, u, y)
    motion = reconstruct_motion(case.model, outputs, through)
    estimate = equation_error(case.model, motion, inputs, case.free())
    assert np.allclose(estimate.values, case.truth.values.ravel(), rtol=1e-4, atol=1e-7)


def test_taking_out_the_noise_of_regressors_takes_out_their_bias(make_case):
    case = make_case(4)
    truth = case.truth.values.ravel()
    errors = {True: [], False: []}
    for seed in range(20):
        u, y = case.spectra(2)
        z = add_noise(y, 0.1, np.random.default_rng(seed))
        inputs, outputs, through = spectra(case, u, z)
        motion = reconstruct_motion(case.model, outputs, through)
        for compensate, found in errors.items():
            estimate = equation_error(
                case.model, motion, inputs, case.free(), compensate=compensate
            )
            found.append((estimate.values - truth) / np.abs(truth))
    plain, compensated = (np.median(np.abs(np.mean(errors[c], axis=0))) for c in (False, True))
    assert compensated < 0.5 * plain


def test_unobservable_motions_are_refused(make_case):
    case = make_case(4, n_outputs=5)
    u, y = case.spectra(3)
    _, outputs, through = spectra(case, u, y)
    with pytest.raises(NotIdentifiable, match="5 outputs cannot resolve 6 motions"):
        reconstruct_motion(case.model, outputs, through)


def test_sensors_that_nothing_checks_are_named(make_case):
    case = make_case(2)
    u, y = case.spectra(2)
    z = FrequencyData(OMEGA, add_noise(y, 0.03, np.random.default_rng(2)), case.model.outputs)
    assert reconstruct_motion(case.model, z, np.ones_like(y)).assumed == ()
    rigid = ("alpha", "theta", "q", "az_egi", "az_cf", "az_ca")
    names = (*rigid, "az_ofs")
    selected = [case.model.outputs.index(name) for name in names]
    rows = SensorRows(names, case.model.sensors.polynomial[:, selected])
    rows.polynomial[:, : len(rigid), 2:] = 0.0  # the wing is seen by its own sensor only
    few = replace(case.model.with_modes(1), sensors=SensorRows(names, rows.polynomial[:, :, :3]))
    seen = (few.response(make_case(1).truth, OMEGA) @ u[:, :, None])[:, :, 0]
    z = FrequencyData(OMEGA, add_noise(seen, 0.03, np.random.default_rng(3)), names)
    assert reconstruct_motion(few, z, np.ones_like(seen)).assumed == ("az_ofs",)


@pytest.mark.parametrize("n_frequencies", [5, 6, 7])
def test_a_handful_of_frequencies_is_enough_where_it_holds_the_parameters(make_case, n_frequencies):
    case = make_case(1)
    omega = OMEGA[10 : 10 + n_frequencies]
    u, y = case.spectra(4, omega)
    z = FrequencyData(omega, add_noise(y, 0.01, np.random.default_rng(4)), case.model.outputs)
    motion = reconstruct_motion(case.model, z, np.ones_like(y))
    inputs = FrequencyData(omega, u, case.model.inputs)
    estimate = equation_error(case.model, motion, inputs, case.free())
    assert np.isfinite(estimate.std_errors).all()


def test_delays_are_not_for_equation_error(make_case):
    case = make_case(1)
    u, y = case.spectra(4)
    inputs, outputs, through = spectra(case, u, y)
    motion = reconstruct_motion(case.model, outputs, through)
    with pytest.raises(BadInput, match="need OE or FRE"):
        equation_error(case.model, motion, inputs, case.free(("delay_q",)))


def test_batched_regressions_are_the_single_ones():
    rng = np.random.default_rng(5)
    X = rng.normal(size=(4, 30, 6)) + 1j * rng.normal(size=(4, 30, 6))
    z = rng.normal(size=(4, 30, 3)) + 1j * rng.normal(size=(4, 30, 3))
    values, errors = regress_many(X, z)
    names = tuple("abcdef")
    for maneuver in range(4):
        for coefficient in range(3):
            one = regress(X[maneuver], z[maneuver, :, coefficient], names)
            assert np.allclose(values[maneuver, coefficient], one.values)
            assert np.allclose(errors[maneuver, coefficient], np.sqrt(np.diag(one.covariance)))


def test_collinear_and_still_regressors_are_named():
    rng = np.random.default_rng(6)
    X = rng.normal(size=(30, 3)) + 1j * rng.normal(size=(30, 3))
    z = X.sum(axis=1)
    twice = np.column_stack([X, X[:, 0]])
    with pytest.raises(NotIdentifiable, match="collinear"):
        regress(twice, z, ("CZ_a", "CZ_b", "CZ_c", "CZ_d"))
    X[:, 1] = 0.0
    with pytest.raises(NotIdentifiable, match="CZ_b is zero"):
        regress(X, z, ("CZ_a", "CZ_b", "CZ_c"))


def test_a_few_frequencies_of_little_known_motion_do_not_spoil_the_others():
    rng = np.random.default_rng(9)
    n = 100
    known = np.where(np.arange(n) < 4, 1e4, 1.0)  # variance of the dependent variable
    errors = ErrorsInVariables(np.zeros((n, 2, 2)), np.zeros((n, 2)), known)
    found = []
    for _ in range(200):
        X = rng.normal(size=(n, 2)) + 1j * rng.normal(size=(n, 2))
        scatter = rng.normal(size=n) + 1j * rng.normal(size=n)
        z = X @ [1.0, 2.0] + np.sqrt(0.5 * known) * scatter
        found.append(regress(X, z, ("CZ_a", "CZ_b"), errors).values)
    # 96 good frequencies of unit variance in X and z: 1 / sqrt(2 * 2 * 96)
    assert np.std(found, axis=0) == pytest.approx([0.051, 0.051], rel=0.2)


def test_fusion_and_priors_weigh_by_information(make_case):
    case = make_case(0, n_outputs=9)
    estimates = []
    for seed in range(2):
        u, y = case.spectra(seed)
        inputs, outputs, through = spectra(case, u, add_noise(y, 0.05, np.random.default_rng(seed)))
        motion = reconstruct_motion(case.model, outputs, through)
        estimates.append(equation_error(case.model, motion, inputs, case.free()))
    both = fuse_estimates(estimates, ["a", "b"])
    low = np.minimum(estimates[0].std_errors, estimates[1].std_errors)
    assert np.all(both.std_errors <= low * (1.0 + 1e-9))
    assert {block.name for block in both.lines} == {"a CZ", "a Cm", "b CZ", "b Cm"}
    held = apply_priors(both, {"Cm_q": (7.0, 1e-9)})
    assert held.values[held.names.index("Cm_q")] == pytest.approx(7.0)


def test_fusing_ill_conditioned_estimates_preserves_their_digits():
    """Powers of x from 3 to 9 as regressors: correlations of 1 - 1e-9 and beyond."""
    x = np.linspace(3.0, 9.0, 80)
    A = np.stack([x**k for k in range(11)], axis=1)
    r = np.linalg.qr(A / np.linalg.norm(A, axis=0), mode="r")
    root = np.linalg.solve(r, np.eye(11))
    C = 1e-6 * root @ root.T
    names = tuple(f"CZ_{k}" for k in range(11))
    apart = 1e-3 * root @ np.ones(11)  # one standard error in every direction
    both = [
        Estimate(names, values, values, C, C, (), (), Outcome.CONVERGED, "")
        for values in (np.ones(11), 1.0 + apart)
    ]
    fused = fuse_estimates(both, ["a", "b"])
    std = np.sqrt(np.diag(C))
    assert (fused.values - 1.0) / std == pytest.approx(0.5 * apart / std, abs=1e-4)
    assert np.diag(fused.corrected_covariance) == pytest.approx(0.5 * np.diag(C), rel=1e-4)
    assert np.diag(fused.covariance) == pytest.approx(0.5 * np.diag(C), rel=1e-4)
