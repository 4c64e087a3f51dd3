"""Mode shapes: comparison, tracking over fuel, symmetry and names."""

from __future__ import annotations

import numpy as np
import pytest

from flexsid.demo.flex28 import load_nodes, load_truth
from flexsid.errors import BadInput
from flexsid.sysid.modes.assurance import (
    compute_comac,
    compute_mac,
    compute_mass_orthogonality,
    compute_modal_scale_factors,
    compute_reduced_cross_orthogonality,
)
from flexsid.sysid.modes.naming import name_modes
from flexsid.sysid.modes.shapes import find_symmetry
from flexsid.sysid.modes.table import (
    compute_fuel_weights,
    find_mode_crossings,
    sum_weighted_rows,
    track_modes,
)

RNG = np.random.default_rng(5)
SHAPES = RNG.normal(size=(4, 30))


def flex28(every: int = 1) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Fuel, frequency and node translations as rows, of every so many fuel weights."""
    modes = load_truth().modes
    shapes = load_nodes()[1].astype(float)[..., :3].reshape(modes.fuel.size, -1, 133 * 3)
    return modes.fuel[::every], modes.omega[::every], shapes[::every]


def test_the_assurance_criterion_knows_neither_scale_nor_phase():
    turned = SHAPES * (-3.0 * np.exp(0.7j))
    assert np.allclose(np.diag(compute_mac(SHAPES, turned)), 1.0)
    assert np.allclose(turned * compute_modal_scale_factors(SHAPES, turned)[:, None], SHAPES)
    assert compute_mac(SHAPES, np.zeros((1, 30))).max() == 0.0
    one = np.array([[1.0, 0.0], [1.0, 1.0]])
    assert compute_mac(one, one)[0, 1] == pytest.approx(0.5)


def test_one_sensor_that_is_wrong_stands_out_by_coordinate():
    measured = SHAPES.copy()
    measured[:, 7] = RNG.normal(size=4)
    comac = compute_comac(SHAPES, -2.0 * measured)
    assert np.argmin(comac) == 7
    assert comac[7] < 0.9
    assert np.delete(comac, 7).min() > 0.97


def test_shapes_of_a_structure_are_orthogonal_over_its_mass():
    factor = RNG.normal(size=(30, 30))
    mass = factor @ factor.T + 30.0 * np.eye(30)
    shapes = np.linalg.solve(np.linalg.cholesky(mass).T, np.linalg.qr(SHAPES.T)[0]).T
    assert np.allclose(
        compute_mass_orthogonality(5.0 * shapes, shapes, mass), np.eye(4), atol=1e-12
    )
    with pytest.raises(BadInput, match="generalised mass -"):
        compute_mass_orthogonality(shapes, shapes, -mass)


def test_fuel_weights_reproduce_parabolas_and_hold_the_ends():
    fuel = np.array([0.0, 0.1, 0.3, 0.6, 1.0])
    table = 3.0 - fuel + 2.0 * fuel**2
    for at in (0.0, 0.05, 0.3, 0.44, 0.99, 1.0):
        weights = compute_fuel_weights(fuel, at)
        assert len(weights) <= 4
        assert sum_weighted_rows(weights, table) == pytest.approx(3.0 - at + 2.0 * at**2)
    assert compute_fuel_weights(fuel, -1.0) == {0: 1.0}
    assert compute_fuel_weights(fuel, 2.0) == {4: 1.0}
    assert compute_fuel_weights(fuel[:2], 0.05) == pytest.approx({0: 0.5, 1: 0.5})


@pytest.mark.parametrize("every", [2, 4])
def test_excluded_fuel_weights_of_flex28_are_interpolated(every):
    """Rows in random order with random signs, as from a solver, at every n-th fuel weight."""
    fuel, omega, shapes = flex28()
    used = np.arange(0, fuel.size, every)
    mixed = np.stack([RNG.permutation(omega.shape[1]) for _ in used])
    mixed[0] = np.arange(omega.shape[1])
    sign = RNG.choice([-1.0, 1.0], size=mixed.shape)
    tracking = track_modes(
        np.stack([shapes[row, order] for row, order in zip(used, mixed, strict=True)])
        * sign[..., None],
        np.stack([omega[row, order] for row, order in zip(used, mixed, strict=True)]),
    )
    sorted_omega = tracking.sort(np.stack([omega[r, o] for r, o in zip(used, mixed, strict=True)]))
    assert np.array_equal(sorted_omega, omega[used])
    aligned = tracking.align(
        np.stack([shapes[r, o] for r, o in zip(used, mixed, strict=True)]) * sign[..., None]
    )
    for row in np.setdiff1d(np.arange(fuel.size), used):
        weights = compute_fuel_weights(fuel[used], float(fuel[row]))
        assert np.abs(sum_weighted_rows(weights, sorted_omega) / omega[row] - 1.0).max() < 0.002
        assert np.diag(compute_mac(sum_weighted_rows(weights, aligned), shapes[row])).min() > 0.999


@pytest.mark.parametrize("mixed", [False, True])
def test_modes_are_followed_through_a_crossing_near_three_tenths(mixed):
    """A wing and a winglet mode cross; at 0.3 itself the solver may give any two mixtures."""
    fuel = np.linspace(0.0, 1.0, 11)
    change = RNG.normal(size=(3, 40)) * 0.1
    true = RNG.normal(size=(3, 40)) + fuel[:, None, None] * change
    omega = np.stack([30.0 - 10.0 * fuel, 25.5 + 5.0 * fuel, 50.0 + fuel], axis=1)
    order = np.argsort(omega, axis=1)
    shapes = np.take_along_axis(true, order[..., None], axis=1)
    if mixed:
        first, second = shapes[3, 0].copy(), shapes[3, 1].copy()
        shapes[3, 0], shapes[3, 1] = 0.8 * first + 0.6 * second, 0.6 * first - 0.8 * second
    shapes[5:, 1] *= -1.0
    tracking = track_modes(shapes, np.take_along_axis(omega, order, axis=1))
    followed = tracking.sort(np.take_along_axis(omega, order, axis=1))
    start = order[0]
    assert np.allclose(followed[np.arange(11) != 3], omega[:, start][np.arange(11) != 3])
    aligned = tracking.align(shapes)
    assert np.allclose(aligned[4:], true[4:, start])
    (crossing,) = find_mode_crossings(fuel, followed)
    assert crossing.fuel == pytest.approx(0.3, abs=0.05)
    assert crossing.omega == pytest.approx(27.0, abs=0.5)
    assert not tracking.low_mac
    for at in (0.26, 0.3, 0.34):  # a table point that the solver has mixed does not count
        for index, mode in enumerate(start):
            weights = compute_fuel_weights(fuel, at, tracking.mixed[:, index])
            found = sum_weighted_rows(weights, aligned[:, index])
            expected = true[0, mode] + at * change[mode]
            assert compute_mac(found[None], expected[None])[0, 0] > 0.999


def test_a_mode_that_leaves_the_table_is_not_tracked():
    shapes = np.stack([SHAPES[:3], SHAPES[[0, 1, 3]]])
    omega = np.array([[10.0, 20.0, 30.0], [10.0, 20.0, 30.0]])
    assert track_modes(shapes, omega).low_mac == ((1, 2),)


def test_symmetry_is_found_from_shapes_wherever_the_plane_lies():
    nodes, shapes = load_nodes()
    translation = shapes[8, :, :, :3].astype(float)
    classes = [kind == "S" for kind in load_truth().source["mode_class"]]
    for shift in (0.0, 2.5):
        found = find_symmetry(nodes + np.array([0.0, shift, 0.0]), translation)
        assert list(found) == classes
    half = nodes[:, 1] >= 0
    # A half model: by the motion of its plane of symmetry, not by that of a wing with itself.
    assert list(find_symmetry(nodes[half], translation[:, half])) == classes
    clamped = translation[:, half] * np.square(np.minimum(nodes[half, 1], 1.0))[:, None]
    assert set(find_symmetry(nodes[half], clamped)) == {None}
    one_wing = np.where(half[:, None], translation[:1], 0.0)
    assert find_symmetry(nodes, one_wing) == (None,)


def test_modes_are_named_by_their_largest_motion():
    nodes, shapes = load_nodes()
    named = name_modes(nodes, shapes[8, :, :, :3].astype(float))
    assert [mode.name for mode in named[:6]] == ["SW1B", "AW1B", "SW1T", "AW1T", "SFA", "SWL"]
    assert len({mode.name for mode in named}) == 25
    assert named[0].reason == "90 % of the wing's motion is bending; symmetric"
    pitch = np.cross([0.0, 1.0, 0.0], nodes)[None]
    assert name_modes(nodes, pitch)[0].name == "R1"


def make_airplane() -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Nodes of a wing, a fuselage, a horizontal tail and a fin, and which are of each."""
    parts = {
        "wing": [(x, y, 0.0) for y in np.linspace(-6, 6, 25) for x in (3.5, 4.0, 4.5)],
        "fuselage": [(x, 0.0, -0.2) for x in np.linspace(0, 12, 25)],
        "tail": [(x, y, 1.0) for y in np.linspace(-2, 2, 9) for x in (11.3, 11.8)],
        "fin": [(11.6, 0.0, z) for z in np.linspace(0, 2.5, 8)],
    }
    part_of = np.repeat(list(parts), [len(part) for part in parts.values()])
    return np.concatenate(list(parts.values())), {name: part_of == name for name in parts}


def test_modes_of_fuselage_and_tail_are_not_named_as_those_of_the_wing():
    nodes, of = make_airplane()
    x, y, z = nodes.T
    shapes = np.zeros((5, len(nodes), 3))
    shapes[0, of["wing"], 2] = (y[of["wing"]] / 6.0) ** 2  # bending of the wing
    shapes[0, ~of["wing"], 2] = 0.01 * (x[~of["wing"]] - 4.0)
    shapes[1, of["fuselage"], 2] = np.cos(np.pi * x[of["fuselage"]] / 6.0)
    shapes[1, of["wing"], 2] = np.cos(np.pi * x[of["wing"]] / 6.0)  # follows as a rigid body
    shapes[1, of["tail"] | of["fin"], 2] = 1.0
    shapes[2, of["tail"], 2] = np.abs(y[of["tail"]]) * y[of["tail"]]
    shapes[3, of["fin"], 1] = z[of["fin"]] ** 2
    shapes[4] = [0.0, 0.0, 1.0]
    named = name_modes(nodes, shapes)
    assert [mode.name for mode in named] == ["SW1B", "", "", "", "R1"]
    assert [mode.symmetric for mode in named[:4]] == [True, True, False, False]
    assert "not a mode of the wing" in named[1].reason


def test_cross_orthogonality_at_few_points_is_that_of_the_whole_model():
    """A model of 3000 nodes: the mass matrix of all degrees of freedom against 60 points."""
    lumped = RNG.uniform(0.1, 1.0, 9000)
    orthonormal = np.linalg.qr(RNG.normal(size=(9000, 12)))[0].T / np.sqrt(lumped)
    mass = RNG.uniform(0.5, 2.0, 12)
    model = orthonormal * np.sqrt(mass)[:, None]  # generalised masses other than one
    mixture = np.eye(12) + 0.1 * RNG.normal(size=(12, 12))
    measured = 3.0 * mixture @ orthonormal
    whole = (model * lumped) @ measured.T
    whole /= np.sqrt(mass)[:, None] * np.sqrt(np.sum(measured**2 * lumped, axis=1))
    points = RNG.choice(9000, 180, replace=False)
    cross, share = compute_reduced_cross_orthogonality(model[:, points], mass, measured[:, points])
    assert cross == pytest.approx(whole, abs=1e-9)
    assert share == pytest.approx(np.ones(12))
    other = measured[:, points] + np.where(np.arange(180) == 7, 5.0, 0.0) * np.abs(measured).max()
    assert compute_reduced_cross_orthogonality(model[:, points], mass, other)[1].max() < 0.9
    for few, message in (
        (points[:10], "12 modes cannot be distinguished at 10"),
        (np.repeat(points[:9], 20), "are alike at the 180 measured degrees of freedom"),
    ):
        with pytest.raises(BadInput, match=message):
            compute_reduced_cross_orthogonality(model[:, few], mass, measured[:, few])
