"""Vortex and doublet lattice against PanelAero, published wings and the theory of sections."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import hankel2

from flexsid.errors import BadInput
from flexsid.sysid.aerodynamics.boxes import Boxes, Panel, mesh_panels
from flexsid.sysid.aerodynamics.coefficients import compute_coefficients
from flexsid.sysid.aerodynamics.doublet_lattice import Symmetry, compute_influence
from flexsid.sysid.aerodynamics.splines import BoxShapes, Reference

HALVES = np.array([0.0, 0.5, 1.0])


def wing_with_winglet() -> Boxes:
    wing = Panel((0.0, 0.0, 0.0), 2.0, (1.0, 4.0, 0.0), 1.0, HALVES, HALVES)
    tip = (1.8, 4.5, 1.5)
    winglet = Panel((1.1, 4.0, 0.0), 0.9, tip, 0.6, HALVES, np.array([0.0, 1.0]))
    return mesh_panels([wing, winglet])


def no_shapes(boxes: Boxes) -> BoxShapes:
    return BoxShapes(*(np.empty((0, len(boxes))) for _ in range(3)))


@pytest.mark.parametrize(
    ("wave_number", "expected"),
    [
        (0.0, [0.22717848, -0.00081498, -0.00730898, -0.0080395, -0.02022574, 0.09976937]),
        (
            0.7,
            [
                2.46390816e-01 - 0.03019792j,
                7.10877944e-06 + 0.0006296j,
                -5.13770446e-03 + 0.00391944j,
                -7.34342359e-04 + 0.00508452j,
                -9.88608440e-03 + 0.01226684j,
                1.05428490e-01 - 0.02636692j,
            ],
        ),
    ],
)
def test_a_wing_with_winglet_has_the_influence_matrix_of_panelaero(wave_number, expected):
    # PanelAero 2025.8 (parabolic kernel), -(VLM.calc_Ajj + DLM.calc_Ajj), Mach 0.5.
    A = compute_influence(wing_with_winglet(), 0.5, wave_number, Symmetry.NONE)
    assert np.allclose(A[[0, 0, 2, 5, 1, 5], [0, 5, 4, 0, 3, 4]], expected, rtol=0.0, atol=1e-8)


@pytest.mark.parametrize("symmetry", [Symmetry.SYMMETRIC, Symmetry.ANTISYMMETRIC])
def test_half_the_aircraft_gives_the_pressures_of_the_whole(symmetry):
    half = wing_with_winglet()
    other = half.mirrored()
    n = len(half)
    whole = Boxes(
        np.concatenate([half.corners, other.corners]),
        np.tile(half.panel, 2),
        np.concatenate([half.strip, half.strip + half.strip.max() + 1]),
    )
    wash = np.linspace(0.5, 1.5, n)
    own = np.linalg.solve(compute_influence(half, 0.3, 0.4, symmetry), wash)
    both = np.concatenate([wash, symmetry.value * wash])
    pressure = np.linalg.solve(compute_influence(whole, 0.3, 0.4, Symmetry.NONE), both)
    assert np.allclose(pressure[:n], own, rtol=1e-12)
    assert np.allclose(pressure[n:], symmetry.value * own, rtol=1e-12)


def test_a_swept_wing_has_the_published_lift_curve_slope():
    # Bertin and Smith, Aerodynamics for Engineers, section 7.5: aspect ratio 5, sweep 45 degrees,
    # 4 horseshoe vortices on each half: C_L = 3.443 alpha.
    wing = Panel(
        (0.0, 0.0, 0.0), 0.2, (0.5, 0.5, 0.0), 0.2, np.array([0.0, 1.0]), np.linspace(0, 1, 5)
    )
    boxes = mesh_panels([wing])
    result = compute_coefficients(
        boxes,
        no_shapes(boxes),
        [],
        Reference(0.2, 0.2, 1.0, np.zeros(3)),
        mach=0.0,
        symmetry=Symmetry.SYMMETRIC,
        k=np.array([0.0]),
    )
    assert result.values[0, 0, 0].real == pytest.approx(-3.443, rel=1e-3)


@pytest.mark.parametrize("k", [0.1, 0.3, 0.6])
def test_the_middle_of_a_long_wing_has_the_lift_of_theodorsen(k):
    # Section in heave: c_l = 2 pi C(k) + i pi k per w/V (NACA Report 496, 1935).
    span = 30.0
    # Narrow strips where the lift is compared: boxes wider than long are less accurate.
    edges = np.concatenate([np.linspace(0.0, 3.0, 19), np.geomspace(3.0, span, 26)[1:]]) / span
    wing = Panel((0.0, 0.0, 0.0), 1.0, (0.0, span, 0.0), 1.0, np.linspace(0.0, 1.0, 9), edges)
    boxes = mesh_panels([wing])
    A = compute_influence(boxes, 0.0, 2.0 * k, Symmetry.SYMMETRIC)
    lift = np.linalg.solve(A, np.ones(len(boxes)))[:8].mean()
    circulation = hankel2(1, k) / (hankel2(1, k) + 1j * hankel2(0, k))
    expected = 2.0 * np.pi * circulation + 1j * np.pi * k
    assert abs(lift - expected) < 0.03 * abs(expected)


def test_impossible_geometry_and_conditions_are_refused():
    boxes = wing_with_winglet()
    with pytest.raises(BadInput, match="Mach number") as refused:
        compute_influence(boxes, 1.0, 0.1, Symmetry.NONE)
    assert refused.value.code == "bad-mach"
    with pytest.raises(BadInput, match="must rise from 0 to 1"):
        Panel((0.0, 0.0, 0.0), 1.0, (0.0, 1.0, 0.0), 1.0, np.array([0.0, 0.5]), HALVES)
    with pytest.raises(BadInput, match="no span"):
        Panel((0.0, 0.0, 0.0), 1.0, (1.0, 0.0, 0.0), 1.0, HALVES, HALVES)
    with pytest.raises(BadInput, match="at least one panel"):
        mesh_panels([])


@pytest.mark.parametrize("wave_number", [0.0, 0.5])
def test_strips_whose_edges_meet_the_control_points_behind_them_are_refused(wave_number):
    wing = Panel((0.0, 0.0, 0.0), 1.0, (0.0, 2.0, 0.0), 1.0, HALVES, HALVES)
    tail_start, tail_end = (3.0, 0.5, 0.0), (3.0, 1.5, 0.0)
    tail = Panel(tail_start, 0.5, tail_end, 0.5, HALVES, np.array([0.0, 1.0]))
    boxes = mesh_panels([wing, tail])
    with pytest.raises(BadInput, match="equal edges") as refused:
        compute_influence(boxes, 0.2, wave_number, Symmetry.SYMMETRIC)
    assert refused.value.code == "misaligned-strips"
