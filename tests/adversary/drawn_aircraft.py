"""Draw an aircraft with its truth, and what its analysts know of it."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from strip_theory import Flap, Planform, Shape, balance, compute_derivatives

G = 9.80665


@dataclass(frozen=True)
class Sensor:
    """A sensor at a point.

    ``lag`` is the natural frequency of its dynamics [rad/s], 0 for none, ``delay`` [s] that of its
    recording, which nobody knows.
    """

    name: str
    kind: str  # gyro, attitude, vane, accelerometer, strain
    axis: str
    point: tuple[float, float, float]
    gauge: tuple[float, str] | None = None
    lag: float = 0.0
    noise: float = 0.02  # of the rms of the signal
    delay: float = 0.0


@dataclass(frozen=True)
class Model:
    """Derivatives and structure at one condition.

    ``table`` has rows CZ, Cm, CQ and columns alpha, q, eta, etadot (nondimensional) and surfaces.
    """

    table: np.ndarray
    omega: np.ndarray
    zeta: np.ndarray
    numbers: tuple[int, ...]
    inputs: tuple[str, ...]

    @property
    def rows(self) -> tuple[str, ...]:
        return ("CZ", "Cm", *(f"CQ{k}" for k in self.numbers))

    @property
    def columns(self) -> tuple[str, ...]:
        rates = (f"etadot{k}" for k in self.numbers)
        return ("alpha", "q", *(f"eta{k}" for k in self.numbers), *rates, *self.inputs)


@dataclass(frozen=True)
class Aircraft:
    """Everything that flies."""

    name: str
    wing: Planform
    shapes: tuple[Shape, ...]
    generalized_mass: float
    truth: Model
    sensors: tuple[Sensor, ...]
    x_cg: float  # in structural axes, aft
    density: float
    airspeed: float
    alpha: float
    thrust: float
    flutter_ratio: float | None  # airspeed over flutter speed, if it was made so
    traits: tuple[str, ...] = field(default=())


@dataclass(frozen=True)
class Assumptions:
    """What the analysts take from a structural model, a balance and an air data system.

    ``shape_std`` is the standard deviation of mode shapes over their rms, which the modal table
    ``states`` or not; ``shapes`` are the errors in units of it, by mode, sensor and component, the
    last one of strain. The others are values over true ones; 2 % and 1 % wrong is what the priors
    of the product are by default.
    """

    shape_std: float
    states: bool
    shapes: np.ndarray
    mass: float
    inertia: float
    airspeed: float


@dataclass(frozen=True)
class Knowledge:
    """What the analysts have: a modal table and a prediction, both wrong, and assumptions."""

    numbers: tuple[int, ...]
    omega: np.ndarray
    zeta: np.ndarray
    table: np.ndarray
    fault: str
    assumed: Assumptions


def draw_shapes(rng: np.random.Generator, *, tail: bool) -> list[tuple[float, Shape]]:
    """Return symmetric modes with their frequencies over that of the first bending."""

    def mix(size: float) -> float:
        return float(size * rng.normal())

    torsion = rng.uniform(2.2, 5.0)
    bodies = [
        (rng.uniform(2.5, 6.0), Shape("FB1", (mix(0.1),), (mix(0.05),), body=(1.0, 0.0))),
        (rng.uniform(8.0, 14.0), Shape("FB2", (mix(0.1),), body=(-0.8, 1.2))),
    ]
    found = [
        (1.0, Shape("SW1B", (1.0,), (mix(0.05),))),
        (rng.uniform(3.2, 5.0), Shape("SW2B", (mix(0.1), 1.0), (mix(0.15),))),
        (rng.uniform(7.0, 10.0), Shape("SW3B", (0.0, mix(0.1), 1.0), (mix(0.15),))),
        (rng.uniform(13.0, 17.0), Shape("SW4B", (0.0, 0.0, mix(0.1), 1.0), (mix(0.1),))),
        (torsion, Shape("SW1T", (mix(0.1), mix(0.1)), (1.0,))),
        (2.9 * torsion, Shape("SW2T", (0.0, mix(0.1)), (mix(0.1), 1.0))),
        (4.8 * torsion, Shape("SW3T", (0.0, mix(0.1)), (0.0, mix(0.1), 1.0))),
        (rng.uniform(2.0, 4.5), Shape("SFA1", (mix(0.03),), (mix(0.02),), in_plane=(1.0,))),
        (rng.uniform(9.0, 13.0), Shape("SFA2", (mix(0.03),), in_plane=(0.0, 1.0))),
        *(bodies if tail else []),
    ]
    # Shapes of close frequencies would not stay as they are drawn.
    order = sorted(found, key=lambda one: one[0])
    apart: list[tuple[float, Shape]] = []
    for ratio, shape in order:
        apart.append((max(ratio, apart[-1][0] * 1.07 if apart else 0.0), shape))
    return apart


def draw_aircraft(rng: np.random.Generator, name: str) -> Aircraft:
    """Draw wing, tail, modes, air forces, sensors and the condition of a longitudinal flight."""
    tail = rng.random() < 0.5
    span = float(np.exp(rng.uniform(np.log(3.0), np.log(35.0))))
    ratio = rng.uniform(9.0, 20.0)
    area, chord = span**2 / ratio, span / ratio
    sweep = np.radians(rng.uniform(0.0, 8.0) if tail else rng.uniform(12.0, 25.0))
    mass = area * rng.uniform(6.0, 11.0) * (span / 5.0) ** 0.7
    density, lift = rng.uniform(0.7, 1.2), rng.uniform(0.25, 0.6)
    airspeed = float(np.sqrt(2 * mass * G / (density * area * lift)))
    arm = rng.uniform(3.5, 5.0) * chord if tail else 0.0
    radius = 0.4 * arm if tail else rng.uniform(0.9, 1.3) * chord
    wing = Planform(
        span, area, float(sweep), rng.uniform(0.4, 0.8), 0.0, mass,
        rng.uniform(0.25, 0.4) * mass, mass * radius**2,
        arm, rng.uniform(0.12, 0.2) * area if tail else 0.0,
    )  # fmt: skip
    flaps = draw_flaps(rng, tail=tail)
    wing = _trim(wing, flaps, rng.uniform(0.05, 0.15))
    generalized = float(np.exp(rng.uniform(np.log(0.3), np.log(30.0))))
    chosen = draw_shapes(rng, tail=tail)
    n_modes = int(rng.integers(8, min(12, len(chosen)) + 1))
    dropped = set(rng.choice(np.arange(3, len(chosen)), len(chosen) - n_modes, replace=False))
    chosen = [one for k, one in enumerate(chosen) if k not in dropped]
    shapes = tuple(balance(shape, wing, generalized) for _, shape in chosen)
    table = compute_derivatives(wing, shapes, flaps)
    table = table * (1 + 0.1 * rng.normal(size=table.shape))
    table = _plant_zeros(rng, table, len(flaps))
    omega = 2 * np.pi * 1.2 * (10.0 / span) ** 0.8 * np.array([ratio for ratio, _ in chosen])
    zeta = rng.uniform(0.008, 0.025, n_modes)
    truth = Model(
        table, omega, zeta, tuple(range(7, 7 + n_modes)), tuple(flap.name for flap in flaps)
    )
    alpha = lift / wing.lift_slope
    return Aircraft(
        name, wing, shapes, generalized, truth, (), float(rng.uniform(0.5, 2.0) * chord),
        float(density), airspeed, float(alpha), mass * G / rng.uniform(15.0, 25.0),
        None, ("tail" if tail else "tailless",),
    )  # fmt: skip


def draw_flaps(rng: np.random.Generator, *, tail: bool) -> tuple[Flap, ...]:
    """Draw two to five pairs of surfaces."""
    n = int(rng.integers(1, 4)) if tail else int(rng.integers(3, 6))
    edges = np.linspace(0.15, 0.98, n + 1)
    flaps = [Flap(f"wf{k + 1}s", edges[k], edges[k + 1]) for k in range(n)]
    return (*([Flap("elevator", 0, 0, tail=True)] if tail else []), *flaps)


def draw_sensors(rng: np.random.Generator, aircraft: Aircraft) -> tuple[Sensor, ...]:
    """Draw 8 to 45 sensors: on the body always, on the wing in pairs, strain and vane or none."""
    wing, half = aircraft.wing, aircraft.wing.span / 2
    wanted = int(rng.integers(8, 46))
    lag = float(aircraft.truth.omega[0] * rng.uniform(15, 40)) if rng.random() < 0.5 else 0.0
    nose, rear = 0.8 * wing.chord, -(wing.tail_arm or 0.5 * wing.chord)
    found = [
        Sensor("q", "gyro", "y", (0.2 * wing.chord, 0, 0)),
        Sensor("theta", "attitude", "y", (0.2 * wing.chord, 0, 0)),
        Sensor("az_nose", "accelerometer", "z", (nose, 0, 0), lag=lag),
        Sensor("az_rear", "accelerometer", "z", (rear, 0, 0), lag=lag),
    ]
    if rng.random() < 0.6:
        found.append(Sensor("alpha", "vane", "y", (2.0 * wing.chord, 0, 0)))
    strain = rng.random() < 0.6
    k = 0
    while len(found) + 2 <= max(wanted, 9):
        k += 1
        station = float(rng.uniform(0.3, 1.0)) if k > 2 else (0.97, 0.65)[k - 1]
        y, gauged = station * half, strain and k % 3 == 0
        if gauged:
            gauge = (0.6 * station, "bending" if k % 2 else "torsion")
            point = (float(wing.quarter_chord(np.array([y]))[0]), y, 0.0)
            one = Sensor(f"s_{k}r", "strain", "", point, gauge)
        else:
            place = wing.quarter_chord(np.array([y])) + rng.uniform(-0.6, 0.2) * wing.chord
            one = Sensor(f"az_{k}r", "accelerometer", "z", (float(place[0]), y, 0.0), lag=lag)
        x, y, z = one.point
        left = Sensor(one.name[:-1] + "l", one.kind, one.axis, (x, -y, z), one.gauge, one.lag)
        found += [one, left]
    level = float(np.exp(rng.uniform(np.log(0.005), np.log(0.04))))
    return tuple(
        Sensor(s.name, s.kind, s.axis, s.point, s.gauge, s.lag, level * rng.uniform(0.7, 1.5))
        for s in found
    )


def draw_delays(rng: np.random.Generator, aircraft: Aircraft) -> Aircraft:
    """Record each kind of sensor 0 to 5 ms late, of one in three aircraft."""
    if rng.random() > 1 / 3:
        return aircraft
    late = {
        kind: float(rng.uniform(0.0, 0.005)) for kind in sorted({s.kind for s in aircraft.sensors})
    }
    sensors = tuple(replace(s, delay=late[s.kind]) for s in aircraft.sensors)
    return replace(aircraft, sensors=sensors, traits=(*aircraft.traits, "late sensors"))


def draw_assumptions(rng: np.random.Generator, aircraft: Aircraft) -> Assumptions:
    """Draw mode shapes that are 2 to 20 % wrong, mass and inertia 2 %, airspeed 1 %."""
    return Assumptions(
        float(np.exp(rng.uniform(np.log(0.02), np.log(0.2)))),
        bool(rng.random() < 0.5),
        rng.normal(size=(len(aircraft.shapes), len(aircraft.sensors), 7)),
        *(float(1 + std * rng.normal()) for std in (0.02, 0.02, 0.01)),
    )


def draw_knowledge(rng: np.random.Generator, aircraft: Aircraft, assumed: Assumptions) -> Knowledge:
    """Draw a modal table of five to eight modes and a prediction, wrong in one more way."""
    truth = aircraft.truth
    n = min(int(rng.integers(5, 9)), len(truth.numbers) - 1)
    known = select(truth, n)
    table = known.table * (1 + 0.2 * rng.normal(size=known.table.shape))
    fault = str(rng.choice(["none", "terms", "row", "column", "signs"]))
    rows, columns = table.shape
    if fault == "terms":
        for _ in range(4):
            table[rng.integers(rows), rng.integers(columns)] *= rng.choice([0.0, 3.0])
    elif fault == "row":
        table[rng.integers(rows)] *= rng.choice([0.5, 1.6])
    elif fault == "column":
        table[:, rng.integers(columns)] *= rng.choice([0.5, 1.6])
    elif fault == "signs":
        for _ in range(3):
            table[rng.integers(2, rows), rng.integers(columns)] *= -1
    return Knowledge(
        known.numbers,
        known.omega * (1 + 0.03 * rng.normal(size=n)),
        known.zeta * np.clip(1 + 0.3 * rng.normal(size=n), 0.2, None),
        table,
        fault,
        assumed,
    )


def select(model: Model, n: int) -> Model:
    """Return the model of the first modes, the others truncated."""
    m = len(model.numbers)
    kept = np.r_[0:2, 2 : 2 + n, 2 + m : 2 + m + n, 2 + 2 * m : model.table.shape[1]]
    table = model.table[: 2 + n][:, kept]
    return Model(table, model.omega[:n], model.zeta[:n], model.numbers[:n], model.inputs)


def _trim(wing: Planform, flaps: tuple[Flap, ...], margin: float) -> Planform:
    """Move the centre of gravity ahead of the neutral point, by a share of the chord."""
    table = compute_derivatives(wing, (), flaps)
    neutral = -table[1, 0] / table[0, 0]  # x of the neutral point over the chord
    return replace(wing, apex=wing.apex - float(neutral + margin) * wing.chord)


def _plant_zeros(rng: np.random.Generator, table: np.ndarray, n_inputs: int) -> np.ndarray:
    """Set an eighth of the terms to zero, of those that are small in row and column."""
    size = np.abs(table)
    typical = np.median(size, axis=1)[:, None] * np.median(size, axis=0)[None, :]
    typical = typical / max(np.median(size), 1e-12)
    small = size < 0.5 * typical
    small[:2, :2] = False
    return np.where(small & (rng.random(table.shape) < 0.4), 0.0, table)
