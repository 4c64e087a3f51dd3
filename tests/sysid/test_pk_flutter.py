"""Flutter by the p-k method against rational functions, published speeds and exact theory."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.special import hankel2

from flexsid.errors import BadInput
from flexsid.sysid.aerodynamics.boxes import Boxes, Panel, mesh_panels
from flexsid.sysid.aerodynamics.coefficients import UnsteadyCoefficients, compute_coefficients
from flexsid.sysid.aerodynamics.doublet_lattice import Symmetry
from flexsid.sysid.aerodynamics.pk_flutter import (
    ModalSystem,
    build_free_system,
    build_modal_system,
    track_pk_roots,
)
from flexsid.sysid.aerodynamics.splines import BoxShapes, Reference
from flexsid.sysid.model.condition import FlightCondition
from flexsid.sysid.model.longitudinal import LONGITUDINAL

DATA = Path(__file__).parents[3] / "shared" / "data" / "flex28_unsteady"
needs_flex28 = pytest.mark.skipif(not DATA.exists(), reason="FLEX-28U is not beside the project")

# Goland wing: Goland, J. Appl. Mech. 12 (1945) A197-A208; Goland and Luke, 15 (1948) 13-20. In SI.
SPAN, CHORD, ELASTIC_AXIS, MASS_AXIS = 6.096, 1.8288, 0.33, 0.43
MASS, INERTIA, BENDING, TORSION = 35.71, 8.64, 9.77e6, 0.987e6
CANTILEVER = np.array([1.875104069, 4.694091133, 7.854757438]) / SPAN
TWIST = (2.0 * np.arange(3) + 1.0) * np.pi / 2.0 / SPAN


def bending(y: np.ndarray) -> np.ndarray:
    """Modes of a uniform cantilever, (3, n)."""
    b = CANTILEVER[:, None]
    ratio = (np.sinh(b * SPAN) - np.sin(b * SPAN)) / (np.cosh(b * SPAN) + np.cos(b * SPAN))
    return np.cosh(b * y) - np.cos(b * y) - ratio * (np.sinh(b * y) - np.sin(b * y))


def twist(y: np.ndarray) -> np.ndarray:
    return np.sin(TWIST[:, None] * y)


def goland_modes() -> tuple[np.ndarray, np.ndarray]:
    """Frequencies, and modes of unit mass in terms of three bending and three torsion modes."""
    nodes, weights = np.polynomial.legendre.leggauss(40)
    y, w = 0.5 * SPAN * (nodes + 1.0), 0.5 * SPAN * weights
    H, T = bending(y), twist(y)
    coupling = -MASS * (MASS_AXIS - ELASTIC_AXIS) * CHORD * (H * w) @ T.T
    M = np.block([[MASS * (H * w) @ H.T, coupling], [coupling.T, INERTIA * (T * w) @ T.T]])
    stiffness = [BENDING * CANTILEVER**4 * (H**2 @ w), TORSION * TWIST**2 * (T**2 @ w)]
    square, modes = eigh(np.diag(np.concatenate(stiffness)), M)
    return np.sqrt(square), modes


def goland_shapes(boxes: Boxes, modes: np.ndarray) -> BoxShapes:
    def displacement(at: np.ndarray) -> np.ndarray:
        arm = at[:, 0] - ELASTIC_AXIS * CHORD
        return modes.T @ np.concatenate([bending(at[:, 1]), -arm * twist(at[:, 1])])

    y = boxes.control[:, 1]
    slope = modes.T @ np.concatenate([0.0 * bending(y), -twist(y)])
    return BoxShapes(displacement(boxes.control), slope, displacement(boxes.load))


def test_goland_wing_flutters_at_the_speed_of_another_lattice_code():
    # SHARPy (unsteady vortex lattice, 16 chordwise boxes), tests/linear/goland_wing: 166 m/s at
    # 1.02 kg/m3.
    omega, modes = goland_modes()
    wing = Panel(
        np.zeros(3),
        CHORD,
        np.array([0.0, SPAN, 0.0]),
        CHORD,
        np.linspace(0.0, 1.0, 13),
        np.linspace(0.0, 1.0, 21),
    )
    boxes = mesh_panels([wing])
    reference = Reference(2.0 * SPAN * CHORD, CHORD, 2.0 * SPAN, np.zeros(3))
    k = np.array([0.0, 0.1, 0.25, 0.4, 0.6, 1.0])
    coefficients = compute_coefficients(
        boxes,
        goland_shapes(boxes, modes),
        [],
        reference,
        mach=0.0,
        symmetry=Symmetry.SYMMETRIC,
        k=k,
    )
    both_sides = 2.0 * np.ones(6)
    system = build_modal_system(coefficients, reference, both_sides, omega, np.zeros(6))
    flutter = track_pk_roots(system, np.linspace(100.0, 200.0, 11), 1.02).flutter
    assert flutter is not None
    assert flutter.airspeed == pytest.approx(166.0, rel=0.02)
    assert 68.0 < flutter.omega < 71.0


def test_goland_wing_in_strip_theory_flutters_at_the_published_speed():
    # Exact solution of Goland and Luke: 137.2 m/s (450 ft/s), 70.7 rad/s, at 1.225 kg/m3.
    omega, modes = goland_modes()
    b, a = 0.5 * CHORD, 2.0 * ELASTIC_AXIS - 1.0
    nodes, weights = np.polynomial.legendre.leggauss(40)
    y, w = 0.5 * SPAN * (nodes + 1.0), 0.5 * SPAN * weights
    H, T = bending(y), twist(y)
    overlaps = [[(one * w) @ other.T for other in (H, T)] for one in (H, T)]
    k = np.concatenate([[0.0], np.linspace(0.02, 1.5, 60)])
    forces = np.empty((k.size, 6, 6), dtype=complex)
    for index, one in enumerate(k):
        theodorsen = (
            1.0 if one == 0.0 else hankel2(1, one) / (hankel2(1, one) + 1j * hankel2(0, one))
        )
        ik = 1j * one
        # Heave h up and twist: wash at 3/4 chord, lift and moment per unit span and qbar.
        wash = {"h": -ik / b, "t": 1.0 + ik * (0.5 - a)}
        circulatory = {name: 4.0 * np.pi * b * theodorsen * value for name, value in wash.items()}
        lift = {
            "h": circulatory["h"] + 2.0 * np.pi * one**2,
            "t": circulatory["t"] + 2.0 * np.pi * b * (ik + a * one**2),
        }
        moment = {
            "h": b * (a + 0.5) * circulatory["h"] + 2.0 * np.pi * b * a * one**2,
            "t": b * (a + 0.5) * circulatory["t"]
            + 2.0 * np.pi * b**2 * (-ik * (0.5 - a) + (0.125 + a**2) * one**2),
        }
        strip = np.block(
            [
                [lift["h"] * overlaps[0][0], lift["t"] * overlaps[0][1]],
                [moment["h"] * overlaps[1][0], moment["t"] * overlaps[1][1]],
            ]
        )
        forces[index] = modes.T @ strip @ modes
    system = ModalSystem(np.eye(6), np.zeros((6, 6)), np.diag(omega**2), k, forces, b)
    flutter = track_pk_roots(system, np.linspace(60.0, 180.0, 25), 1.225).flutter
    assert flutter is not None
    assert flutter.airspeed == pytest.approx(137.2, rel=0.02)
    assert flutter.omega == pytest.approx(70.7, rel=0.02)


# AGARD 445.6, weakened model 3 (Yates, NASA TM 100492, 1987): a mahogany plate with the section
# NACA 65A004; moduli of Kolonay, AIAA J. 39 (2001) 2030-2036. In SI.
AGARD_SPAN, AGARD_ROOT, AGARD_TIP = 0.762, 0.5588, 0.3682
AGARD_FREQUENCIES_HZ = np.array([9.5992, 38.1650, 48.3482, 91.5448])
AGARD_DENSITY = 381.98
AGARD_FLEXURE = (3.1511e9, 0.4162e9, 0.31, 0.4392e9)  # along and across the 45 degree grain
NACA_65A004_STATION = np.array([*range(0, 50, 5), *range(50, 101, 5), 0.5, 1.25, 2.5, 7.5])
NACA_65A004 = np.array(
    [
        *(0.0, 0.877, 1.216, 1.463, 1.649, 1.790, 1.894, 1.962, 1.996, 1.996, 1.952),
        *(1.867, 1.742, 1.584, 1.400, 1.193, 0.966, 0.728, 0.490, 0.249, 0.009),
        *(0.311, 0.481, 0.656, 1.062),
    ]
)[np.argsort(NACA_65A004_STATION)]


def agard_chord(y: np.ndarray) -> np.ndarray:
    return AGARD_ROOT + (AGARD_TIP - AGARD_ROOT) * y / AGARD_SPAN


def agard_edge(y: np.ndarray) -> np.ndarray:
    """Leading edge; the quarter chord is swept by 45 degrees."""
    return 0.25 * AGARD_ROOT + y - 0.25 * agard_chord(y)


def agard_basis(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Polynomials of a clamped plate, their slope along x, and their curvatures (3, n, points)."""
    tip = agard_edge(np.array(AGARD_SPAN)) + 0.5 * AGARD_TIP
    sweep = float(tip - 0.5 * AGARD_ROOT) / AGARD_SPAN
    across, along = (x - 0.5 * AGARD_ROOT - y * sweep) / AGARD_SPAN, y / AGARD_SPAN
    polynomial = np.polynomial.Polynomial
    powers = [(polynomial.basis(i), polynomial.basis(j)) for i in range(5) for j in range(2, 8)]

    def derivative(m: int, n: int) -> np.ndarray:
        return np.array([f.deriv(m)(across) * g.deriv(n)(along) for f, g in powers])

    f20, f11, f02 = derivative(2, 0), derivative(1, 1), derivative(0, 2)
    curvature = np.array([f20, f02 - 2 * sweep * f11 + sweep**2 * f20, 2 * (f11 - sweep * f20)])
    return derivative(0, 0), derivative(1, 0) / AGARD_SPAN, curvature / AGARD_SPAN**2


def agard_plate() -> np.ndarray:
    """Stiffness of the material in x and y: its grain is swept by 45 degrees."""
    E1, E2, nu, G = AGARD_FLEXURE
    rest = 1.0 - nu**2 * E2 / E1
    Q = np.array([[E1, nu * E2, 0.0], [nu * E2, E2, 0.0], [0.0, 0.0, G * rest]]) / rest
    turn = 0.5 * np.array([[1.0, 1.0, 1.0], [1.0, 1.0, -1.0], [-2.0, 2.0, 0.0]])  # of strains
    return turn.T @ Q @ turn


def test_agard_wing_flutters_at_the_measured_speed():
    nodes, weights = np.polynomial.legendre.leggauss(20)
    y, part = (v.ravel() for v in np.meshgrid(*[0.5 * (nodes + 1.0)] * 2, indexing="ij"))
    y = y * AGARD_SPAN
    area = 0.25 * np.outer(weights, weights).ravel() * AGARD_SPAN * agard_chord(y)
    thickness = (
        0.02 * np.interp(100.0 * part, np.sort(NACA_65A004_STATION), NACA_65A004) * agard_chord(y)
    )
    w, _, curvature = agard_basis(agard_edge(y) + part * agard_chord(y), y)
    bent = np.einsum("ab,bip->aip", agard_plate(), curvature) * (thickness**3 / 12.0 * area)
    square, modes = eigh(
        np.einsum("aip,ajp->ij", curvature, bent), (w * AGARD_DENSITY * thickness * area) @ w.T
    )
    modes = modes[:, :4]
    frequencies = np.sqrt(square[:4]) / (2.0 * np.pi)
    assert np.allclose(frequencies, AGARD_FREQUENCIES_HZ, rtol=0.06)  # the plate is that wing

    tip = np.array([agard_edge(np.array(AGARD_SPAN)), AGARD_SPAN, 0.0])
    divisions = np.linspace(0.0, 1.0, 11), np.linspace(0.0, 1.0, 17)
    boxes = mesh_panels([Panel(np.zeros(3), AGARD_ROOT, tip, AGARD_TIP, *divisions)])
    control, load = (agard_basis(at[:, 0], at[:, 1]) for at in (boxes.control, boxes.load))
    shapes = BoxShapes(modes.T @ control[0], modes.T @ control[1], modes.T @ load[0])
    area_both = (AGARD_ROOT + AGARD_TIP) * AGARD_SPAN
    reference = Reference(area_both, AGARD_ROOT, 2.0 * AGARD_SPAN, np.zeros(3))
    k = np.array([0.0, 0.1, 0.2, 0.3, 0.5])
    coefficients = compute_coefficients(
        boxes, shapes, [], reference, mach=0.499, symmetry=Symmetry.SYMMETRIC, k=k
    )
    omega = 2.0 * np.pi * AGARD_FREQUENCIES_HZ
    system = build_modal_system(coefficients, reference, 2.0 * np.ones(4), omega, np.zeros(4))
    flutter = track_pk_roots(system, np.linspace(130.0, 220.0, 10), 0.4278).flutter
    assert flutter is not None
    assert flutter.airspeed == pytest.approx(172.5, rel=0.05)  # in air at Mach 0.499


@needs_flex28
@pytest.mark.parametrize("modes", [2, 8])
def test_free_flight_flutter_agrees_with_rational_functions(modes):
    arrays = np.load(DATA / "flex28_unsteady.npz")
    tables = json.loads((DATA / "flex28_unsteady.json").read_text())
    columns = [0, 1, *range(2, 2 + modes), *range(10, 10 + modes)]
    for fuel, state in enumerate(tables["fuel_data"]):
        (expected,) = (
            one
            for one in tables["flutter"]
            if one["fuel"] == state["fuel"] and one["modes"] == modes and one["aircraft"] == "dlm"
        )
        C = UnsteadyCoefficients(
            arrays["k"],
            tuple(map(str, arrays["rows"][: 2 + modes])),
            tuple(str(arrays["columns"][column]) for column in columns),
            arrays["C"][fuel][:, : 2 + modes][:, :, columns],
        )
        reference = Reference(float(arrays["S"]), float(arrays["cbar"]), 28.0, np.zeros(3))
        condition = FlightCondition(
            airspeed=180.0,
            density=0.0020482,
            mass=state["mass_slug"],
            pitch_inertia=state["Iyy"],
            area=reference.area,
            chord=reference.chord,
        )
        assert LONGITUDINAL.free_flight is not None
        system = build_free_system(
            C,
            reference,
            LONGITUDINAL.free_flight(condition),
            np.ones(modes),
            np.array(state["omega_rad_s"][:modes]),
            np.array(state["zeta"][:modes]),
        )
        roots = track_pk_roots(system, np.array([150.0, 180.0, 230.0]), 0.0020482)
        assert roots.flutter is not None
        assert roots.flutter.airspeed == pytest.approx(expected["roger_ft_s"], rel=0.003)
        assert roots.flutter.omega == pytest.approx(expected["roger_rad_s"], rel=0.003)


def test_roots_without_air_are_those_of_the_structure_at_every_airspeed():
    omega = np.array([10.0, 11.0, 30.0])
    zeta = np.array([0.01, 0.02, 0.03])
    k = np.array([0.0, 1.0, 5.0])
    system = ModalSystem(
        np.eye(3), np.diag(2.0 * zeta * omega), np.diag(omega**2), k, np.zeros((3, 3, 3)) + 0j, 1.0
    )
    roots = track_pk_roots(system, np.linspace(10.0, 40.0, 7), 1.0)
    exact = omega * (-zeta + 1j * np.sqrt(1.0 - zeta**2))
    assert np.allclose(roots.roots, exact)
    assert roots.flutter is None
    assert roots.unstable_from_start == ()


def test_roots_that_are_never_stable_are_listed():
    k = np.array([0.0, 1.0, 5.0])
    system = ModalSystem(
        np.eye(2), np.diag([-0.1, 0.1]), np.diag([100.0, 400.0]), k, np.zeros((3, 2, 2)) + 0j, 1.0
    )
    roots = track_pk_roots(system, np.linspace(10.0, 40.0, 7), 1.0)
    assert roots.flutter is None
    assert roots.unstable_from_start == (0,)


def test_airspeeds_must_rise():
    system = ModalSystem(
        np.eye(1), np.eye(1), np.eye(1), np.array([0.0, 1.0]), np.zeros((2, 1, 1)) + 0j, 1.0
    )
    with pytest.raises(BadInput) as refused:
        track_pk_roots(system, np.array([20.0, 10.0]), 1.0)
    assert refused.value.code == "bad-airspeed"
