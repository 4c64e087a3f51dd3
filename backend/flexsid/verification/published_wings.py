"""Wings with published forces or flutter speeds, computed by the lattice and the p-k method.

HA144A is the forward-swept wing with canard of the aeroelastic user's guide of MSC Nastran; its
geometry is in feet, its rigid derivatives are those that the guide prints. The wing of Goland is of
J. Appl. Mech. 12 (1945) A197 and, with Luke, 15 (1948) 13; AGARD 445.6 of Yates, NASA TM 100492.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import eigh
from scipy.special import hankel2

from flexsid.sysid.aerodynamics.boxes import Boxes, Panel, mesh_panels
from flexsid.sysid.aerodynamics.coefficients import compute_coefficients
from flexsid.sysid.aerodynamics.doublet_lattice import Symmetry
from flexsid.sysid.aerodynamics.pk_flutter import (
    ModalSystem,
    PkCrossing,
    build_modal_system,
    track_pk_roots,
)
from flexsid.sysid.aerodynamics.splines import BoxShapes, ControlSurface, Reference

# --- HA144A: rigid derivatives of a forward-swept wing with canard at Mach 0.9 --------------------

HA144A = {
    ("CZ", "alpha"): -5.071, ("Cm", "alpha"): -2.871, ("CZ", "q"): -12.074,
    ("Cm", "q"): -9.954, ("CZ", "elevator"): -0.2461, ("Cm", "elevator"): 0.5715,
}  # fmt: skip
"""Printed derivatives; the canard turns as a whole."""


def compute_ha144a() -> dict[tuple[str, str], float]:
    """Compute the derivatives of HA144A, on the boxes of the guide."""
    chordwise = np.linspace(0.0, 1.0, 5)
    sweep = 20.0 * np.tan(np.pi / 6.0)
    boxes = mesh_panels(
        [
            _make_panel((10.0, 0.0), 10.0, (10.0, 5.0), 10.0, chordwise, 2),
            _make_panel((25.0, 0.0), 10.0, (25.0 - sweep, 20.0), 10.0, chordwise, 8),
        ]
    )
    is_canard = boxes.panel == 0
    hinge = np.where(is_canard, 12.5, 0.0)
    elevator = ControlSurface("elevator", is_canard, hinge, 0.25, (0.0, 5.0))
    none = np.zeros((0, len(boxes)))
    found = compute_coefficients(
        boxes,
        BoxShapes(none, none, none),
        [elevator],
        Reference(400.0, 10.0, 40.0, np.array([15.0, 0.0, 0.0])),
        mach=0.9,
        symmetry=Symmetry.SYMMETRIC,
        k=np.array([0.0, 0.1]),
    )
    return {
        (row, column): float(found.values[0, found.rows.index(row), found.column(column)].real)
        for row, column in HA144A
    }


def _make_panel(
    left: tuple[float, float],
    left_chord: float,
    right: tuple[float, float],
    right_chord: float,
    chordwise: np.ndarray,
    n_spanwise: int,
) -> Panel:
    spanwise = np.linspace(0.0, 1.0, n_spanwise + 1)
    return Panel((*left, 0.0), left_chord, (*right, 0.0), right_chord, chordwise, spanwise)


# --- Wing of Goland: a uniform cantilever with a published exact flutter speed, in SI -------------

GOLAND_EXACT = (137.2, 70.7)
"""Flutter speed [m/s] and frequency [rad/s] of the exact solution by strip theory, 1.225 kg/m3."""

GOLAND_SHARPY = 166.0
"""Flutter speed of SHARPy's vortex lattice, 16 chordwise boxes, at 1.02 kg/m3. [m/s]"""

_SPAN, _CHORD, _ELASTIC_AXIS, _MASS_AXIS = 6.096, 1.8288, 0.33, 0.43
_MASS, _INERTIA, _BENDING, _TORSION = 35.71, 8.64, 9.77e6, 0.987e6
_CANTILEVER = np.array([1.875104069, 4.694091133, 7.854757438]) / _SPAN
_TWIST = (2.0 * np.arange(3) + 1.0) * np.pi / 2.0 / _SPAN


def predict_goland_by_strips() -> PkCrossing | None:
    """Predict flutter by Theodorsen's forces on strips of the wing."""
    omega, modes = _compute_goland_modes()
    b, a = 0.5 * _CHORD, 2.0 * _ELASTIC_AXIS - 1.0
    y, w = _place_strips()
    H, T = _bending(y), _twist(y)
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
    return track_pk_roots(system, np.linspace(60.0, 180.0, 25), 1.225).flutter


def predict_goland_by_lattice() -> PkCrossing | None:
    """Predict flutter by the doublet lattice."""
    omega, modes = _compute_goland_modes()
    wing = _make_panel((0.0, 0.0), _CHORD, (0.0, _SPAN), _CHORD, np.linspace(0.0, 1.0, 13), 20)
    boxes = mesh_panels([wing])

    def displacement(at: np.ndarray) -> np.ndarray:
        arm = at[:, 0] - _ELASTIC_AXIS * _CHORD
        return modes.T @ np.concatenate([_bending(at[:, 1]), -arm * _twist(at[:, 1])])

    y = boxes.control[:, 1]
    slope = modes.T @ np.concatenate([0.0 * _bending(y), -_twist(y)])
    shapes = BoxShapes(displacement(boxes.control), slope, displacement(boxes.load))
    reference = Reference(2.0 * _SPAN * _CHORD, _CHORD, 2.0 * _SPAN, np.zeros(3))
    k = np.array([0.0, 0.1, 0.25, 0.4, 0.6, 1.0])
    system = _build_system(boxes, shapes, reference, omega, 0.0, k)
    return track_pk_roots(system, np.linspace(100.0, 200.0, 11), 1.02).flutter


def _compute_goland_modes() -> tuple[np.ndarray, np.ndarray]:
    """Frequencies, and modes of unit mass in terms of three bending and three torsion modes."""
    y, w = _place_strips()
    H, T = _bending(y), _twist(y)
    coupling = -_MASS * (_MASS_AXIS - _ELASTIC_AXIS) * _CHORD * (H * w) @ T.T
    M = np.block([[_MASS * (H * w) @ H.T, coupling], [coupling.T, _INERTIA * (T * w) @ T.T]])
    stiffness = [_BENDING * _CANTILEVER**4 * (H**2 @ w), _TORSION * _TWIST**2 * (T**2 @ w)]
    square, modes = eigh(np.diag(np.concatenate(stiffness)), M)
    return np.sqrt(square), modes


def _place_strips() -> tuple[np.ndarray, np.ndarray]:
    """Stations over the span and their weights."""
    nodes, weights = np.polynomial.legendre.leggauss(40)
    return 0.5 * _SPAN * (nodes + 1.0), 0.5 * _SPAN * weights


def _bending(y: np.ndarray) -> np.ndarray:
    """Modes of a uniform cantilever, (3, n)."""
    b = _CANTILEVER[:, None]
    ratio = (np.sinh(b * _SPAN) - np.sin(b * _SPAN)) / (np.cosh(b * _SPAN) + np.cos(b * _SPAN))
    return np.cosh(b * y) - np.cos(b * y) - ratio * (np.sinh(b * y) - np.sin(b * y))


def _twist(y: np.ndarray) -> np.ndarray:
    return np.sin(_TWIST[:, None] * y)


def _build_system(
    boxes: Boxes,
    shapes: BoxShapes,
    reference: Reference,
    omega: np.ndarray,
    mach: float,
    k: np.ndarray,
) -> ModalSystem:
    """Build the equations of a clamped half wing, whose modes have unit mass."""
    coefficients = compute_coefficients(
        boxes, shapes, [], reference, mach=mach, symmetry=Symmetry.SYMMETRIC, k=k
    )
    both_sides = 2.0 * np.ones(omega.size)
    return build_modal_system(coefficients, reference, both_sides, omega, np.zeros(omega.size))


# --- AGARD 445.6, weakened model 3: a mahogany plate with the section NACA 65A004, in SI ----------

AGARD_MEASURED = 172.5
"""Flutter speed in air at Mach 0.499. [m/s]"""

_AGARD_SPAN, _AGARD_ROOT, _AGARD_TIP = 0.762, 0.5588, 0.3682
AGARD_FREQUENCIES_HZ = np.array([9.5992, 38.1650, 48.3482, 91.5448])
_AGARD_DENSITY = 381.98
_AGARD_FLEXURE = (3.1511e9, 0.4162e9, 0.31, 0.4392e9)  # along and across the 45 degree grain
_NACA_65A004_STATION = np.array([*range(0, 50, 5), *range(50, 101, 5), 0.5, 1.25, 2.5, 7.5])
_NACA_65A004 = np.array(
    [
        *(0.0, 0.877, 1.216, 1.463, 1.649, 1.790, 1.894, 1.962, 1.996, 1.996, 1.952),
        *(1.867, 1.742, 1.584, 1.400, 1.193, 0.966, 0.728, 0.490, 0.249, 0.009),
        *(0.311, 0.481, 0.656, 1.062),
    ]
)[np.argsort(_NACA_65A004_STATION)]


def predict_agard() -> PkCrossing | None:
    """Predict flutter by the doublet lattice with the measured frequencies."""
    _, modes = compute_agard_modes()
    tip = (float(_get_agard_edge(np.array(_AGARD_SPAN))), _AGARD_SPAN)
    wing = _make_panel((0.0, 0.0), _AGARD_ROOT, tip, _AGARD_TIP, np.linspace(0.0, 1.0, 11), 16)
    boxes = mesh_panels([wing])
    control, load = (_evaluate_plate(at[:, 0], at[:, 1]) for at in (boxes.control, boxes.load))
    shapes = BoxShapes(modes.T @ control[0], modes.T @ control[1], modes.T @ load[0])
    area_both = (_AGARD_ROOT + _AGARD_TIP) * _AGARD_SPAN
    reference = Reference(area_both, _AGARD_ROOT, 2.0 * _AGARD_SPAN, np.zeros(3))
    omega = 2.0 * np.pi * AGARD_FREQUENCIES_HZ
    k = np.array([0.0, 0.1, 0.2, 0.3, 0.5])
    system = _build_system(boxes, shapes, reference, omega, 0.499, k)
    return track_pk_roots(system, np.linspace(130.0, 220.0, 10), 0.4278).flutter


def compute_agard_modes() -> tuple[np.ndarray, np.ndarray]:
    """Frequencies [Hz] of the plate, and modes of unit mass in terms of polynomials.

    Moduli are those of Kolonay, AIAA J. 39 (2001) 2030-2036.
    """
    nodes, weights = np.polynomial.legendre.leggauss(20)
    y, part = (v.ravel() for v in np.meshgrid(*[0.5 * (nodes + 1.0)] * 2, indexing="ij"))
    y = y * _AGARD_SPAN
    area = 0.25 * np.outer(weights, weights).ravel() * _AGARD_SPAN * _get_agard_chord(y)
    thickness = (
        0.02
        * np.interp(100.0 * part, np.sort(_NACA_65A004_STATION), _NACA_65A004)
        * _get_agard_chord(y)
    )
    w, _, curvature = _evaluate_plate(_get_agard_edge(y) + part * _get_agard_chord(y), y)
    bent = np.einsum("ab,bip->aip", _compute_plate_stiffness(), curvature) * (
        thickness**3 / 12.0 * area
    )
    square, modes = eigh(
        np.einsum("aip,ajp->ij", curvature, bent), (w * _AGARD_DENSITY * thickness * area) @ w.T
    )
    return np.sqrt(square[:4]) / (2.0 * np.pi), modes[:, :4]


def _get_agard_chord(y: np.ndarray) -> np.ndarray:
    return _AGARD_ROOT + (_AGARD_TIP - _AGARD_ROOT) * y / _AGARD_SPAN


def _get_agard_edge(y: np.ndarray) -> np.ndarray:
    """Leading edge; the quarter chord is swept by 45 degrees."""
    return 0.25 * _AGARD_ROOT + y - 0.25 * _get_agard_chord(y)


def _evaluate_plate(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Polynomials of a clamped plate, their slope along x, and their curvatures (3, n, points)."""
    tip = _get_agard_edge(np.array(_AGARD_SPAN)) + 0.5 * _AGARD_TIP
    sweep = float(tip - 0.5 * _AGARD_ROOT) / _AGARD_SPAN
    across, along = (x - 0.5 * _AGARD_ROOT - y * sweep) / _AGARD_SPAN, y / _AGARD_SPAN
    polynomial = np.polynomial.Polynomial
    powers = [(polynomial.basis(i), polynomial.basis(j)) for i in range(5) for j in range(2, 8)]

    def derivative(m: int, n: int) -> np.ndarray:
        return np.array([f.deriv(m)(across) * g.deriv(n)(along) for f, g in powers])

    f20, f11, f02 = derivative(2, 0), derivative(1, 1), derivative(0, 2)
    curvature = np.array([f20, f02 - 2 * sweep * f11 + sweep**2 * f20, 2 * (f11 - sweep * f20)])
    return derivative(0, 0), derivative(1, 0) / _AGARD_SPAN, curvature / _AGARD_SPAN**2


def _compute_plate_stiffness() -> np.ndarray:
    """Stiffness of the material in x and y: its grain is swept by 45 degrees."""
    E1, E2, nu, G = _AGARD_FLEXURE
    rest = 1.0 - nu**2 * E2 / E1
    Q = np.array([[E1, nu * E2, 0.0], [nu * E2, E2, 0.0], [0.0, 0.0, G * rest]]) / rest
    turn = 0.5 * np.array([[1.0, 1.0, 1.0], [1.0, 1.0, -1.0], [-2.0, 2.0, 0.0]])  # of strains
    return turn.T @ Q @ turn
