"""Mode shapes of beams and air forces of strips: where the truth of a drawn aircraft comes from.

Body axes: x forward, y right, z down, origin at the centre of gravity. A shape has, at every point,
the displacement and the rotation for a unit modal coordinate.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

_CLAMPED = (1.8751, 4.6941, 7.8548, 10.9955)  # roots of cos b cosh b = -1
STRIPS = 24  # of half a wing
ELASTIC_AXIS = 0.40  # of the chord


@dataclass(frozen=True)
class Planform:
    """A wing, with a tail or without, of mass that is spread over it."""

    span: float
    area: float
    sweep: float  # of the quarter chord [rad]
    taper: float
    apex: float  # x of the quarter chord at the root
    mass: float
    wing_mass: float
    pitch_inertia: float
    tail_arm: float  # 0 without a tail
    tail_area: float

    @property
    def chord(self) -> float:
        return self.area / self.span

    @property
    def lift_slope(self) -> float:
        ratio = self.span / self.chord
        return 2 * np.pi * ratio / (ratio + 2) * np.cos(self.sweep)

    def chords(self, y: np.ndarray) -> np.ndarray:
        """Chord at distances from the plane of symmetry."""
        root = 2 * self.chord / (1 + self.taper)
        return root * (1 - (1 - self.taper) * np.abs(y) / (self.span / 2))

    def quarter_chord(self, y: np.ndarray) -> np.ndarray:
        return self.apex - np.abs(y) * np.tan(self.sweep)


@dataclass(frozen=True)
class Shape:
    """A symmetric mode: bending, torsion and in-plane motion of the wing, bending of the body."""

    name: str
    bending: tuple[float, ...] = ()  # weights of the clamped beam's modes
    torsion: tuple[float, ...] = ()  # weights of sin((2k - 1) pi y / b)
    in_plane: tuple[float, ...] = ()
    body: tuple[float, ...] = ()  # weights of ((x / arm)^2, (x / arm)^3) behind the wing
    heave: float = 0.0  # momentum of the others
    pitch: float = 0.0
    scale: float = 1.0

    def at(self, wing: Planform, point: np.ndarray) -> np.ndarray:
        """Displacement and rotation [phi_x, phi_y, phi_z, nu_x, nu_y, nu_z] at points (n, 3)."""
        x, y = point[:, 0], point[:, 1]
        half = wing.span / 2
        on_wing = np.abs(y) > 1e-9
        station = np.clip(np.abs(y) / half, 0, 1)
        down, slope = _bend(self.bending, station)[:2]
        twist = _twist(self.torsion, station)
        slope = slope / half
        along, along_slope = _bend(self.in_plane, station)[:2]
        nu_y = twist + slope * np.sin(wing.sweep)
        axis = wing.quarter_chord(y) - (ELASTIC_AXIS - 0.25) * wing.chords(y)
        phi_z = down - nu_y * np.where(on_wing, x - axis, 0.0)
        arm = wing.tail_arm or wing.chord
        behind = np.where(on_wing, 0.0, np.minimum(x, 0.0) / arm)
        for power, weight in enumerate(self.body, 2):
            phi_z = phi_z + weight * (-behind) ** power
            nu_y = nu_y + weight * power * (-behind) ** (power - 1) / arm
        side = np.sign(y)
        found = np.zeros((x.size, 6))
        found[:, 0] = along
        found[:, 2] = phi_z - self.heave + self.pitch * x
        found[:, 3] = side * slope
        found[:, 4] = nu_y - self.pitch
        found[:, 5] = -side * along_slope / half
        return self.scale * found

    def strain(self, wing: Planform, station: float, kind: str) -> float:
        """Strain of a gauge on the wing: bending, or the shear of torsion."""
        depth, half = 0.06 * wing.chord, wing.span / 2
        at = np.array([station])
        if kind == "bending":
            return -self.scale * depth * _bend(self.bending, at)[2][0] / half**2
        step = 1e-4
        rate = _twist(self.torsion, at + step) - _twist(self.torsion, at - step)
        return self.scale * 0.5 * depth * rate[0] / (2 * step * half)


def balance(shape: Shape, wing: Planform, generalized_mass: float) -> Shape:
    """Return the shape without momentum (mean axes), scaled to a generalised mass [kg m^2]."""
    points, masses = _masses(wing)
    free = shape.at(wing, points)
    spin = masses * (0.25 * wing.chord) ** 2
    heave = masses @ free[:, 2] / wing.mass
    moment = -masses @ (points[:, 0] * free[:, 2]) + spin @ free[:, 4]
    pitch = moment / wing.pitch_inertia
    bound = replace(shape, heave=heave, pitch=pitch)  # pyrefly: ignore[bad-argument-type]
    moved = bound.at(wing, points)
    rest = max(wing.mass - masses.sum(), 0.0)
    own = masses @ (moved[:, 0] ** 2 + moved[:, 2] ** 2) + spin @ moved[:, 4] ** 2
    own = own + rest * heave**2 + 0.1 * wing.pitch_inertia * pitch**2
    return replace(bound, scale=float(np.sqrt(generalized_mass / own)))


@dataclass(frozen=True)
class Flap:
    """A pair of surfaces that moves as one; on the tail if ``tail``."""

    name: str
    inner: float
    outer: float
    tail: bool = False


def compute_derivatives(
    wing: Planform, shapes: tuple[Shape, ...], flaps: tuple[Flap, ...]
) -> np.ndarray:
    """Return CZ, Cm, CQ (rows) per alpha, q c/2V, eta, etadot c/2V and surface (columns)."""
    centre, chords, areas, slopes, moment = _aerodynamic_strips(wing, flaps)
    control = centre - np.stack([chords / 2, 0 * chords, 0 * chords], axis=1)
    half = wing.chord / 2
    ones = np.ones(chords.size)
    at_load = [shape.at(wing, centre) for shape in shapes]
    at_control = [shape.at(wing, control) for shape in shapes]
    wash = [ones, -control[:, 0] / half]
    wash += [one[:, 4] for one in at_control] + [one[:, 2] / half for one in at_control]
    turn = (
        [0 * ones, ones / half] + [0 * ones] * len(shapes) + [one[:, 4] / half for one in at_load]
    )
    force = [-areas * slopes * one for one in wash]
    couple = [-areas * chords**2 / 4 * one for one in turn]  # damping of a strip's pitch
    for flap, share in zip(flaps, moment, strict=True):
        effect = 0.55 if not flap.tail else 0.7
        force.append(-areas * slopes * effect * share)
        couple.append(-0.5 * areas * chords * share)
    rows = []
    for f, m in zip(force, couple, strict=True):
        pitching = (-centre[:, 0] @ f + m.sum()) / wing.chord
        modal = [(one[:, 2] @ f + one[:, 4] @ m) / wing.chord for one in at_load]
        rows.append([f.sum(), pitching, *modal])
    return np.array(rows).T / wing.area


def _aerodynamic_strips(wing: Planform, flaps: tuple[Flap, ...]) -> tuple[np.ndarray, ...]:
    """Return points, chords, areas (of both sides), slopes and flap shares of the strips."""
    y = (np.arange(STRIPS) + 0.5) / STRIPS * wing.span / 2
    chords = wing.chords(y)
    points = np.stack([wing.quarter_chord(y), y, 0 * y], axis=1)
    areas = 2 * chords * wing.span / 2 / STRIPS
    slopes = wing.lift_slope * np.sqrt(1.02 - (y / (wing.span / 2)) ** 2) ** 0.5
    station = y / (wing.span / 2)
    shares = [
        0.0 * y if flap.tail else ((station > flap.inner) & (station < flap.outer)).astype(float)
        for flap in flaps
    ]
    if wing.tail_area:
        points = np.vstack([points, [wing.apex - wing.tail_arm, 0, 0]])
        chords = np.append(chords, 0.6 * wing.chord)
        areas = np.append(areas, wing.tail_area)
        slopes = np.append(slopes, 0.65 * 4.2)  # with the downwash of the wing
        shares = [np.append(s, float(f.tail)) for s, f in zip(shares, flaps, strict=True)]
    return points, chords, areas, slopes, np.array(shares)


def _masses(wing: Planform) -> tuple[np.ndarray, np.ndarray]:
    y = (np.arange(STRIPS) + 0.5) / STRIPS * wing.span / 2
    chords = wing.chords(y)
    x = wing.quarter_chord(y) - 0.18 * chords
    masses = wing.wing_mass * chords / chords.sum()
    points = np.stack([x, y, 0 * y], axis=1)
    if wing.tail_area:
        points = np.vstack([points, [wing.apex - wing.tail_arm, 0, 0]])
        masses = np.append(masses, 0.05 * wing.mass)
    return points, masses


def _bend(weights: tuple[float, ...], s: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Deflection, slope and curvature of a clamped beam over its relative length."""
    found = [np.zeros_like(s), np.zeros_like(s), np.zeros_like(s)]
    for root, weight in zip(_CLAMPED, weights, strict=False):
        ratio = (np.cosh(root) + np.cos(root)) / (np.sinh(root) + np.sin(root))
        b = root * s
        parts = (
            np.cosh(b) - np.cos(b) - ratio * (np.sinh(b) - np.sin(b)),
            root * (np.sinh(b) + np.sin(b) - ratio * (np.cosh(b) - np.cos(b))),
            root**2 * (np.cosh(b) + np.cos(b) - ratio * (np.sinh(b) + np.sin(b))),
        )
        for k, part in enumerate(parts):
            found[k] = found[k] + weight / 2 * part
    return found[0], found[1], found[2]


def _twist(weights: tuple[float, ...], s: np.ndarray) -> np.ndarray:
    found = np.zeros_like(s)
    for k, weight in enumerate(weights, 1):
        found = found + weight * np.sin((2 * k - 1) * np.pi / 2 * s)
    return found
