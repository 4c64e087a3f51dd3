"""Lateral-directional model against the independent truth of FLEX-28's antisymmetric half."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from lateral_flying_wing import (
    FOOT,
    condition_at,
    derivatives_at,
    load_source,
    modes_at,
    needs_records,
)

from flexsid.sysid.estimation.experiment import select_parameters
from flexsid.sysid.excitation.fisher_information import _stack_limited
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.condition import GRAVITY
from flexsid.sysid.model.lateral import LATERAL, side_acceleration
from flexsid.sysid.model.reduction import residualize
from flexsid.sysid.model.rigid_body import SensorRows, stack_rows
from flexsid.sysid.stability.poles import Aeroelastic, build_state_family, compute_named_poles
from flexsid.sysid.stability.root_errors import UncertainDerivatives, estimate_root_bands
from flexsid.sysid.stability.root_tracking import Mechanism, track_family_roots, track_roots

pytestmark = needs_records


def build_model(airspeed_ft_s: float, fuel: float, n: int, product: float | None = None):
    modes = modes_at(fuel, n)
    blind = SensorRows((), np.zeros((4, 0, 3 + n)))
    condition = condition_at(airspeed_ft_s, fuel, product)
    return AeroelasticModel(condition, modes, derivatives_at(fuel, n).inputs, blind, LATERAL)


def name_poles(model: AeroelasticModel, fuel: float) -> dict[str, complex]:
    table = derivatives_at(fuel, len(model.modes.numbers))
    parameters = select_parameters(table, None, ())
    size = parameters.start.size
    labels = tuple(f"mode{number}" for number in model.modes.numbers)
    poles = compute_named_poles(model, parameters, parameters.start, np.eye(size), labels)
    return {str(pole.name): pole.value for pole in poles}


def read_roots(values: dict) -> dict[str, complex]:
    """True eigenvalues by the names of the workbench."""
    names = {"dutch_roll": "DR", "AW1B": "mode8", "AW1T": "mode10"}
    return {
        str(names.get(name, name)): complex(*value) if isinstance(value, list) else complex(value)
        for name, value in values.items()
    }


def test_named_poles_are_the_true_eigenvalues_at_every_condition():
    for point in load_source()["eigenvalues"]["points"]:
        fuel = point["fuel_fraction"]
        found = name_poles(build_model(point["airspeed_ft_s"], fuel, 8), fuel)
        for name, expected in read_roots(point["eigenvalues"]).items():
            assert found[name] == pytest.approx(expected, rel=3e-5, abs=3e-7), (point, name)


@pytest.mark.parametrize(("sign", "key"), [(1, "eigenvalues"), (-1, "with_Ixz_minus_60")])
def test_the_sign_of_the_product_of_inertia_decides_the_damping_of_the_dutch_roll(sign, key):
    check = load_source()["eigenvalues_check_Ixz"]
    expected = read_roots(check[key])
    found = name_poles(build_model(check["airspeed_ft_s"], 0.5, 2, sign * check["Ixz"]), 0.5)
    assert found.keys() == expected.keys()
    for name, value in expected.items():
        assert found[name] == pytest.approx(value, rel=1e-4)
    turned = name_poles(build_model(check["airspeed_ft_s"], 0.5, 2, -sign * check["Ixz"]), 0.5)
    assert abs(turned["DR"] - expected["DR"]) > 0.1


@pytest.mark.parametrize("product", [None, 60.0])
def test_eigenvalues_of_matrix_and_family_and_poles_of_responses_agree(product):
    model, table = build_model(126.5, 0.5, 3, product), derivatives_at(0.5, 3)
    A = model.state_space(table).A
    family = build_state_family(
        Aeroelastic(model.condition, model.modes, table), np.array([model.condition.airspeed])
    )
    assert np.sort_complex(np.linalg.eigvals(family.A[0])) == pytest.approx(
        np.sort_complex(np.linalg.eigvals(A)), rel=1e-10
    )
    omega = np.array([1.3, 40.0])
    system = model.state_space(table)
    motion = model.motion(table, omega)
    for k, w in enumerate(omega.tolist()):
        states = np.linalg.solve(1j * w * np.eye(len(A)) - A, system.B)
        assert states[[0, 1, 2, 4, 5, 6]] == pytest.approx(motion[k], rel=1e-9, abs=1e-12)


def test_slopes_of_roots_in_the_derivatives_hold_with_inertial_coupling():
    model, table = build_model(126.5, 0.5, 2, 60.0), derivatives_at(0.5, 2)
    aircraft = Aeroelastic(model.condition, model.modes, table)
    locus = track_roots(aircraft, np.linspace(0.98, 1.02, 3) * model.condition.airspeed)
    places = (np.array([1, 2]), np.array([1, 0]))  # Cl_p and Cn_beta
    for i, j in zip(*places, strict=True):
        uncertain = UncertainDerivatives(np.array([i]), np.array([j]), np.array([[1e-6]]))
        bands = estimate_root_bands(aircraft, locus, uncertain)
        values = table.values.copy()
        values[i, j] += 1e-5
        moved = track_roots(
            replace(aircraft, derivatives=replace(table, values=values)), locus.airspeed
        )
        slope = np.abs(np.real(moved.roots - locus.roots)) / 1e-5
        assert bands.real_std[1] == pytest.approx(1e-3 * slope[1], rel=2e-3, abs=1e-8)


def test_antisymmetric_flutter_follows_from_the_true_derivatives_without_the_spiral():
    source = load_source()
    for case in source["flutter_antisymmetric"]:
        fuel, n = case["fuel_fraction"], case["modes"]
        aircraft = Aeroelastic(
            condition_at(126.5, fuel), modes_at(fuel, n), derivatives_at(fuel, n)
        )
        locus = track_roots(aircraft, FOOT * np.linspace(60.0, 330.0, 80))
        if case["airspeed_ft_s"] is None:
            assert locus.flutter is None
            continue
        assert locus.flutter is not None
        assert locus.flutter.mechanism is Mechanism.FLUTTER
        expected = FOOT * case["airspeed_ft_s"]
        assert locus.flutter.airspeed == pytest.approx(expected, rel=1e-6), case
        assert locus.flutter.frequency == pytest.approx(case["omega_rad_s"], rel=1e-5)


def test_a_spiral_that_passes_zero_is_no_divergence():
    table = derivatives_at(0.5, 2)
    values = table.values.copy()
    values[1, 0] *= 1.5  # Cl_beta: the spiral is stable above 160 ft/s
    table = replace(table, values=values)
    aircraft = Aeroelastic(condition_at(126.5, 0.5), modes_at(0.5, 2), table)
    rising = track_roots(aircraft, FOOT * np.linspace(60.0, 250.0, 120))
    assert np.real(rising.roots[0, rising.names.index("spiral")]) > 0.0
    assert rising.unstable == ()
    assert rising.flutter is None
    falling = track_family_roots(
        lambda slower: build_state_family(aircraft, FOOT * 250.0 - slower),
        FOOT * np.linspace(0.0, 190.0, 120),
        aircraft.motions,
    )
    assert [one.mechanism for one in falling.crossings] == [Mechanism.SPIRAL]
    assert falling.flutter is None


def test_residualised_derivatives_are_those_of_the_reference():
    """Reference values of the design notes, fuel 0.5: no mode retained, two airspeeds."""
    modes, table = modes_at(0.5, 8), derivatives_at(0.5, 8)
    for ratio, expected in (
        (0.65, {"Cl_p": -0.5705, "Cl_beta": -0.0887, "Cn_beta": 0.0242, "Cl_wf4a": -0.1001}),
        (1.05, {"Cl_p": -0.6468, "Cl_beta": -0.1046, "Cn_beta": 0.0247, "Cl_wf4a": -0.0364}),
    ):
        condition = condition_at(ratio * 194.603, 0.5)
        found = residualize(table, modes, condition, ()).named()
        for name, value in expected.items():
            assert found[name] == pytest.approx(value, abs=2e-4)


def test_the_load_factor_of_a_lateral_design_is_that_of_an_accelerometer_at_the_center_of_gravity():
    model = build_model(140.0, 0.5, 2)
    omega = np.linspace(1.0, 60.0, 20)
    motion = model.motion(derivatives_at(0.5, 2), omega)[:, :, 0]
    row = stack_rows(["ay"], [side_acceleration(model.condition, 2)])
    measured = np.einsum("kyr,kr->ky", row.response(omega), motion) / GRAVITY
    load = _stack_limited(model, omega, np.zeros((omega.size, 0), dtype=complex), motion)
    np.testing.assert_allclose(load, measured, rtol=1e-9)
