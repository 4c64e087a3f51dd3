"""Small synthetic flexible aircraft, simulated and recorded within a second.

Each is a beam model of the wing and the fuselage with strip aerodynamics, written apart from
the estimators' model. They have 5 to 16 sensors, as most aircraft do and the demonstration
does not, so that what holds with redundant sensors only shows here.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cache
from itertools import pairwise

import numpy as np
from scipy import linalg, signal

from flexsid.demo.campaign import add_maneuver
from flexsid.demo.flights import FlownManeuver
from flexsid.demo.truth_flight import FlownChannel
from flexsid.records.aircraft import (
    Aircraft,
    Combination,
    Geometry,
    MassTable,
    Sensor,
    Surface,
)
from flexsid.records.maneuver import Condition, Excitation, Flight, Maneuver, Role
from flexsid.records.modal_data import ModalKind, ModalTable
from flexsid.storage.store import Store
from flexsid.sysid.excitation.multisine import assign_harmonics, design_multisine
from flexsid.sysid.model.condition import GRAVITY, FlightCondition
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.model.sensor_models import (
    ACCELEROMETER,
    ATTITUDE,
    GYRO,
    STRAIN,
    VANE,
    Butterworth,
    Instrument,
    SecondOrder,
    load_sensor_models,
)
from flexsid.sysid.modes import StructuralModes
from flexsid.sysid.simulation import sensors as feel
from flexsid.sysid.simulation.airframe import (
    ALPHA,
    THETA,
    Airframe,
    apply_instruments,
    assemble_airframe,
)

RATE_HZ = 200.0
TRIM_S, SETTLE_S = 2.0, 6.0
_SIMULATED_HZ = 1000.0
_STATIONS = 11  # of half the wing
_MODES = 8  # that fly
_ZETA = 0.03
_ACTUATOR = Instrument(elements=(SecondOrder(natural_frequency=60.0, damping=0.7),))
_FILTER = Butterworth(order=4, corner=2.0 * np.pi * 60.0)
_INSTRUMENTS = {
    "accelerometer": Instrument(elements=(_FILTER,), delay_s=0.004),
    "gyro": Instrument(elements=(_FILTER,), delay_s=0.006),
    "attitude": Instrument(elements=(_FILTER,), delay_s=0.010),
    "vane": Instrument(elements=(_FILTER,), delay_s=0.008),
    "strain": Instrument(elements=(_FILTER,), delay_s=0.002),
    "potentiometer": Instrument(elements=(_FILTER,)),
}
_NOISE = {  # SI, at ``RATE_HZ``
    ACCELEROMETER.kind: 0.05,
    GYRO.kind: 1e-3,
    ATTITUDE.kind: 5e-4,
    VANE.kind: 2e-3,
    STRAIN.kind: 1e-6,
}
_UNITS = {
    ACCELEROMETER.kind: "m/s2",
    GYRO.kind: "rad/s",
    ATTITUDE.kind: "rad",
    VANE.kind: "rad",
    STRAIN.kind: "1",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Design:
    """What an aircraft is built from; x forward of the elastic axis, lengths in m.

    ``sensors`` are name, kind, and place: a wing station from 0 to 10 with its side (``3l``),
    or a fuselage node (``f0``), with an offset in x and an axis where it is not the usual one.
    """

    name: str
    span: float
    chord: float
    wing_mass: float
    fuselage: tuple[tuple[float, float], ...]  # x, mass; one at x = 0
    bending: float  # EI [N m2]
    torsion: float  # GJ [N m2]
    fuselage_bending: float  # EI [N m2]
    airspeed: float
    sensors: tuple[tuple[str, str, str, float], ...]
    surfaces: tuple[tuple[str, float, float], ...]  # from, to in half spans; beyond 1: tail
    tail_area: float = 0.0
    band_hz: tuple[float, float] = (0.3, 12.0)
    has_table: bool = True
    fore_mass: float = 0.12  # of the wing, in chords ahead of the elastic axis


@dataclass(frozen=True, slots=True, eq=False)
class SyntheticAircraft:
    """A design with its modes and derivatives; ``record`` is what the workbench knows of it."""

    design: Design
    record: Aircraft
    modes: StructuralModes
    locations: dict[str, tuple[float, float, float]]
    mass: float
    pitch_inertia: float
    x_cg: float
    _strips: dict[str, np.ndarray] = field(repr=False)

    def condition_at(self, airspeed: float) -> FlightCondition:
        """Level flight."""
        design = self.design
        return FlightCondition(
            airspeed=airspeed,
            density=1.1,
            mass=self.mass,
            pitch_inertia=self.pitch_inertia,
            area=design.span * design.chord,
            chord=design.chord,
            alpha=0.05,
            x_cg=self.x_cg,
        )

    def derivatives_at(self, airspeed: float) -> DerivativeTable:
        """Derivatives of the strips; they do not depend on airspeed, being nondimensional."""
        s, chord = self._strips, self.design.chord
        n = s["z_ac"].shape[1]
        angle = np.concatenate(
            [
                np.ones((s["slope"].size, 1)),
                -2.0 * s["x_aft"][:, None] / chord,
                s["twist"],
                2.0 * s["z_aft"] / chord,
                s["flap"],
            ],
            axis=1,
        )
        force = -s["slope"][:, None] * angle
        arm = np.concatenate([-s["x_ac"][:, None], s["z_ac"]], axis=1) / chord
        values = np.concatenate([force.sum(axis=0)[None], arm.T @ force])
        moment = -0.15 * s["slope"][:, None] * s["flap"]
        values[1, 2 + 2 * n :] += moment.sum(axis=0)
        values[2:, 2 + 2 * n :] += s["twist"].T @ moment
        names = tuple(name for name, _, _ in self.design.surfaces)
        return DerivativeTable(self.modes.numbers, names, values)

    def airframe_at(self, airspeed: float) -> Airframe:
        """Equations of motion."""
        return assemble_airframe(
            self.condition_at(airspeed), self.modes, self.derivatives_at(airspeed)
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Fault:
    """Fault of one channel; ``step`` is the size of a digit in SI, none by default."""

    delay_s: float = 0.0
    scale: float = 1.0
    step: float = 0.0


@cache
def build(design: Design) -> SyntheticAircraft:
    """Solve the beam model and return the aircraft with its record."""
    beam = _Beam(design)
    half_span, chord = 0.5 * design.span, design.chord
    edges = np.linspace(0.0, half_span, 4 * (_STATIONS - 1) + 1)
    y = 0.5 * (edges[1:] + edges[:-1])
    slope = 2.0 * np.pi * design.span / (design.span + 2.0 * chord)
    share = np.diff(edges) / half_span * slope * np.sqrt(1.0 - (y / half_span) ** 2) * 4.0 / np.pi
    flap = [(y >= a * half_span) & (y < b * half_span) for _, a, b in design.surfaces]
    z, _, twist = beam.wing_shapes(y)
    strips = {
        "slope": share,
        "x_ac": np.full(y.size, 0.15 * chord),
        "x_aft": np.full(y.size, -0.35 * chord),
        "z": z,
        "twist": twist,
        "flap": 0.5 * np.array(flap, dtype=float).T,
    }
    if design.tail_area:
        index = int(np.argmin([x for x, _ in design.fuselage]))
        x_tail = design.fuselage[index][0]
        z_tail, twist_tail = beam.fuselage_shapes(index)
        tail_slope = 3.5 * 0.7 * design.tail_area / (design.span * chord)
        controls = [0.6 * (a > 1.0) for _, a, _ in design.surfaces]
        one = {"slope": tail_slope, "x_ac": x_tail, "x_aft": x_tail - 0.1 * chord}
        one |= {"z": z_tail, "twist": twist_tail, "flap": controls}
        for key, value in one.items():
            strips[key] = np.concatenate(
                [
                    strips[key],
                    np.atleast_1d(value)[None].reshape((1, -1) if strips[key].ndim == 2 else (1,)),
                ]
            )
    for end in ("ac", "aft"):
        root = np.zeros(strips["slope"].size)
        root[-1] = strips["x_ac"][-1] if design.tail_area else 0.0
        lever = strips[f"x_{end}"] - (root if design.tail_area else 0.0)
        strips[f"z_{end}"] = strips["z"] - lever[:, None] * strips["twist"]
        strips[f"x_{end}"] = strips[f"x_{end}"] - beam.x_cg
    sensors, points, gauges, locations = [], [], [], {}
    for name, kind, where, offset in design.sensors:
        if kind == STRAIN.kind:
            gauges.append((where, beam.strain(where)))
        else:
            points.append((f"{where}{offset:+g}", beam.point(where, offset)))
        aft = beam.place(where, offset)
        locations[name] = (-aft[0], aft[1], 0.0)
        sensors.append(
            Sensor(
                name=name,
                kind=kind,
                point=where if kind == STRAIN.kind else f"{where}{offset:+g}",
                axis="z" if kind == ACCELEROMETER.kind else "y",
                location_m=locations[name],
                instrument=kind,
                noise_std=_NOISE[kind],
            )
        )
    shapes = dict(points)
    modes = StructuralModes(
        numbers=tuple(range(7, 7 + _MODES)),
        omega=beam.omega,
        zeta=np.full(_MODES, _ZETA),
        mass=np.full(_MODES, 2.0),  # both halves
        points=tuple(shapes),
        translation=np.stack([shape[:3] for shape in shapes.values()]),
        rotation=np.stack([shape[3:] for shape in shapes.values()]),
        gauges=tuple(dict(gauges)),
        strain=np.array(list(dict(gauges).values())).reshape(-1, _MODES),
    )
    record = Aircraft(
        name=design.name,
        geometry=Geometry(area_m2=design.span * chord, chord_m=chord, span_m=design.span),
        mass=MassTable(
            fuel=(0.0, 1.0),
            mass_kg=(beam.mass,) * 2,
            pitch_inertia_kg_m2=(beam.pitch_inertia,) * 2,
            x_cg_m=(-beam.x_cg,) * 2,
            z_cg_m=(0.0, 0.0),
        ),
        surfaces=tuple(
            Surface(name=name, instrument="potentiometer", noise_std_rad=2e-4)
            for name, _, _ in design.surfaces
        ),
        sensors=tuple(sensors),
        combinations=_pairs(tuple(name for name, *_ in design.sensors)),
        instruments=_INSTRUMENTS,
    )
    return SyntheticAircraft(
        design, record, modes, locations, beam.mass, beam.pitch_inertia, -beam.x_cg, strips
    )


def add(store: Store, aircraft: SyntheticAircraft, has_table: bool = True) -> int:
    """Store an aircraft with its modal table and a flight; return the id of the flight."""
    stored = store.aircraft.add(aircraft.record)
    assert stored.id is not None
    if has_table:
        modes = aircraft.modes
        shape = np.concatenate([modes.translation, modes.rotation], axis=1).transpose(2, 0, 1)
        # an antisymmetric copy of every mode, which a symmetric model must not use
        side = np.array([-1.0 if "l" in point else 1.0 for point in modes.points])
        omega = np.concatenate([modes.omega, 1.3 * modes.omega])
        arrays = {
            "omega": omega[None],
            "zeta": np.full((1, omega.size), _ZETA),
            "mass": np.full((1, omega.size), 2.0),
            "shape": np.concatenate([shape, shape * side[:, None]])[None],
            "strain": np.concatenate([modes.strain.T, modes.strain.T])[None],
        }
        store.modal_tables.add(
            ModalTable(
                aircraft_id=stored.id,
                name="FEM",
                kind=ModalKind.FEM,
                fuel=(0.5,),
                numbers=(*modes.numbers, *(n + 20 for n in modes.numbers)),
                names=tuple(f"S{n}" for n in range(_MODES)) + tuple(f"A{n}" for n in range(_MODES)),
                symmetric=(True,) * _MODES + (False,) * _MODES,
                points=modes.points,
                gauges=modes.gauges,
                arrays={name: store.arrays.put(values) for name, values in arrays.items()},
            )
        )
    flight = store.flights.add(Flight(aircraft_id=stored.id, number=1))
    assert flight.id is not None
    return flight.id


def save_maneuver(store: Store, flight_id: int, flown: FlownManeuver) -> Maneuver:
    """Store a simulated record."""
    return add_maneuver(store, flown, flight_id)


def fly(
    aircraft: SyntheticAircraft,
    *,
    seed: int | tuple[int, ...] = 0,
    kind: str = "multisine",
    airspeed: float = 1.0,
    band_hz: tuple[float, float] | None = None,
    peak_deg: float = 3.0,
    faults: Mapping[str, Fault] | None = None,
    gust_deg: float = 0.0,
    is_excitation_known: bool = True,
    speed_varies: bool = False,
) -> FlownManeuver:
    """Fly one maneuver open loop from trim and record all channels.

    Parameters
    ----------
    aircraft
        What flies.
    seed
        Of the noise and of the turbulence.
    kind
        ``multisine``, ``doublet`` or ``3-2-1-1``.
    airspeed
        In airspeeds of the design. [1]
    band_hz
        Of the multisine; the design's by default. [Hz]
    peak_deg
        Largest deflection. [deg]
    faults
        By channel.
    gust_deg
        Standard deviation of turbulence in angle of attack, which no model has. [deg]
    is_excitation_known
        Whether the record contains the harmonics of the multisine.
    speed_varies
        With the phugoid, which the models of the workbench leave out.
    """
    rng = np.random.default_rng(seed)
    names = tuple(name for name, _, _ in aircraft.design.surfaces)
    excitation, commands = _commands(names, kind, band_hz or aircraft.design.band_hz, peak_deg)
    deflections = apply_instruments(commands, _SIMULATED_HZ, [_ACTUATOR] * len(names))
    speed = airspeed * aircraft.design.airspeed
    frame = aircraft.airframe_at(speed)
    gust = _gust(commands.shape[0], gust_deg, rng)
    felt = _simulate(aircraft, frame, deflections, gust, speed_varies)
    faults = faults or {}
    channels = []
    sources = [(n, Role.INPUT, "rad", "potentiometer", 2e-4) for n in names]
    sources += [
        (s.name, Role.OUTPUT, _UNITS[s.kind], s.kind, _NOISE[s.kind])
        for s in aircraft.record.sensors
    ]
    true = np.concatenate([deflections, felt], axis=1)
    fault = [faults.get(name, Fault()) for name, *_ in sources]
    instruments = [_INSTRUMENTS[instrument] for *_, instrument, _ in sources]
    late = [
        replace(instrument, delay_s=instrument.delay_s + one.delay_s)
        for instrument, one in zip(instruments, fault, strict=True)
    ]
    seen = apply_instruments(true, _SIMULATED_HZ, late)[:: round(_SIMULATED_HZ / RATE_HZ)]
    for (name, role, unit, _, std), one, samples in zip(sources, fault, seen.T, strict=True):
        values = one.scale * samples + std * rng.standard_normal(samples.size)
        if one.step:
            values = one.step * np.round(values / one.step)
        channels.append(
            FlownChannel(
                name=name, unit=unit, role=role, rate_hz=RATE_HZ, samples=values.astype(np.float32)
            )
        )
    condition = Condition(
        airspeed_m_s=speed,
        density_kg_m3=1.1,
        fuel_fraction=0.5,
        mass_kg=aircraft.mass,
        pitch_inertia_kg_m2=aircraft.pitch_inertia,
        x_cg_m=aircraft.x_cg,
        z_cg_m=0.0,
        alpha_rad=0.05,
    )
    return FlownManeuver(
        maneuver=Maneuver(
            aircraft_id=0,
            flight_id=0,
            label=f"{aircraft.design.name} {kind} {seed}",
            fta=1,
            start_s=0.0,
            duration_s=commands.shape[0] / _SIMULATED_HZ,
            condition=condition,
            excitation=excitation if is_excitation_known else None,
            max_input_correlation=0.0,
        ),
        channels=tuple(channels),
        truth=aircraft.derivatives_at(speed),
    )


class _Beam:
    """Finite elements of half the aircraft: heave, slope and twist along wing and fuselage."""

    def __init__(self, design: Design) -> None:
        self._design = design
        self._y = np.linspace(0.0, 0.5 * design.span, _STATIONS)
        n_f = len(design.fuselage)
        n = 3 * _STATIONS + 2 * n_f
        self._root = next(k for k, (x, _) in enumerate(design.fuselage) if x == 0.0)
        stiff, mass = np.zeros((n, n)), np.zeros((n, n))
        chord = design.chord
        step = self._y[1]
        for k in range(_STATIONS - 1):
            at = 3 * k + np.array([0, 1, 3, 4])
            stiff[np.ix_(at, at)] += design.bending * _hermite(step)
            at = 3 * k + np.array([2, 5])
            stiff[np.ix_(at, at)] += design.torsion / step * np.array([[1, -1], [-1, 1]])
        weights = np.ones(_STATIONS)
        weights[[0, -1]] = 0.5
        for k, lump in enumerate(0.5 * design.wing_mass * weights / weights.sum()):
            ahead = np.zeros(n)
            ahead[3 * k], ahead[3 * k + 2] = 1.0, -design.fore_mass * chord
            mass += lump * np.outer(ahead, ahead)
            mass[3 * k + 2, 3 * k + 2] += lump * (0.25 * chord) ** 2
            mass[3 * k + 1, 3 * k + 1] += lump * (0.25 * step) ** 2
        order = np.argsort([x for x, _ in design.fuselage])
        first = 3 * _STATIONS
        for a, b in pairwise(order):
            at = first + np.array([2 * a, 2 * a + 1, 2 * b, 2 * b + 1])
            turn = np.array([1.0, -1.0, 1.0, -1.0])  # dz/dx is minus the nose-up angle
            length = design.fuselage[b][0] - design.fuselage[a][0]
            element = _hermite(length) * np.outer(turn, turn)
            stiff[np.ix_(at, at)] += 0.5 * design.fuselage_bending * element
        for k, (_, lump) in enumerate(design.fuselage):
            mass[first + 2 * k, first + 2 * k] += 0.5 * lump
            mass[first + 2 * k + 1, first + 2 * k + 1] += 0.5 * lump * (0.1 * chord) ** 2
        tie = np.eye(n)
        tie[first + 2 * self._root] = tie[0]
        tie[first + 2 * self._root + 1] = tie[2]
        free = [k for k in range(n) if k not in (1, *(first + 2 * self._root + np.arange(2)))]
        tie = tie[:, free]
        values, vectors = linalg.eigh(tie.T @ stiff @ tie, tie.T @ mass @ tie)
        self._shape = (tie @ vectors)[:, 2 : 2 + _MODES]
        self.omega = np.sqrt(values[2 : 2 + _MODES])
        heave, pitch = np.zeros(n), np.zeros(n)
        heave[0:first:3] = heave[first::2] = 1.0
        pitch[2:first:3] = pitch[first + 1 :: 2] = 1.0
        pitch[first::2] = [-x for x, _ in design.fuselage]
        self.mass = 2.0 * float(heave @ mass @ heave)
        self.x_cg = -2.0 * float(heave @ mass @ pitch) / self.mass
        self.pitch_inertia = 2.0 * float(pitch @ mass @ pitch) - self.mass * self.x_cg**2

    def wing_shapes(self, y: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Heave, slope and twist at stations, (n, n_modes) each."""
        n = 3 * _STATIONS
        z, slope, twist = (
            np.stack([np.interp(y, self._y, column) for column in self._shape[k:n:3].T], axis=1)
            for k in range(3)
        )
        return z, slope, twist

    def fuselage_shapes(self, node: int) -> tuple[np.ndarray, np.ndarray]:
        """Heave and pitch of a fuselage node."""
        first = 3 * _STATIONS + 2 * node
        return self._shape[first], self._shape[first + 1]

    def place(self, where: str, offset: float) -> tuple[float, float]:
        """Place forward of the elastic axis and to the right."""
        if where.startswith("f"):
            return self._design.fuselage[int(where[1:])][0] + offset, 0.0
        station = self._y[int(where.rstrip("lr"))]
        return offset, -station if where.endswith("l") else station

    def point(self, where: str, offset: float) -> np.ndarray:
        """Translation and rotation (6, n_modes) at a place, z down and nose up."""
        shape = np.zeros((6, _MODES))
        if where.startswith("f"):
            z, twist = self.fuselage_shapes(int(where[1:]))
            slope = np.zeros(_MODES)
        else:
            station = int(where.rstrip("lr"))
            z, slope, twist = self._shape[3 * station : 3 * station + 3]
            slope = -slope if where.endswith("l") else slope
        shape[2], shape[3], shape[4] = z - offset * twist, slope, twist
        return shape

    def strain(self, where: str) -> np.ndarray:
        """Bending strain outboard of a station, 20 mm off the neutral axis."""
        station = int(where.rstrip("lr"))
        slope = self._shape[1 : 3 * _STATIONS : 3]
        return 0.02 * (slope[station + 1] - slope[station]) / self._y[1]


def _hermite(length: float) -> np.ndarray:
    """Bending stiffness of an element per EI, of (z, dz/dx) at both ends."""
    a = length
    return (
        np.array(
            [
                [12.0, 6 * a, -12.0, 6 * a],
                [6 * a, 4 * a * a, -6 * a, 2 * a * a],
                [-12.0, -6 * a, 12.0, -6 * a],
                [6 * a, 2 * a * a, -6 * a, 4 * a * a],
            ]
        )
        / a**3
    )


def _pairs(names: tuple[str, ...]) -> tuple[Combination, ...]:
    return tuple(
        Combination(name=f"{name[:-1]}s", terms=((name, 0.5), (f"{name[:-1]}r", 0.5)))
        for name in names
        if name.endswith("l") and f"{name[:-1]}r" in names
    )


def _commands(
    names: tuple[str, ...], kind: str, band_hz: tuple[float, float], peak_deg: float
) -> tuple[Excitation | None, np.ndarray]:
    peak = np.radians(peak_deg)
    period_s = 20.0
    n_trim = round(TRIM_S * _SIMULATED_HZ)
    n_total = round((TRIM_S + period_s + SETTLE_S) * _SIMULATED_HZ)
    commands = np.zeros((n_total, len(names)))
    if kind == "multisine":
        first = max(1, round(band_hz[0] * period_s))
        per_input = int((band_hz[1] * period_s - first + 1) / len(names))
        design = design_multisine(
            assign_harmonics(names, per_input, first), period_s, {name: peak for name in names}
        )
        time = np.arange(round(period_s * _SIMULATED_HZ)) / _SIMULATED_HZ
        commands[n_trim : n_trim + time.size] = design.sample(time)
        return Excitation(period_s=period_s, harmonics=design.harmonics(), start_s=TRIM_S), commands
    signs = {"doublet": (1, -1), "3-2-1-1": (1, 1, 1, -1, -1, 1, -1)}[kind]
    pulse = np.repeat(np.array(signs, dtype=float), round(0.5 * _SIMULATED_HZ))
    for column in range(len(names)):
        at = n_trim + round(column * 6.0 * _SIMULATED_HZ)
        commands[at : at + pulse.size, column] = peak * pulse
    return None, commands


def _gust(n: int, std_deg: float, rng: np.random.Generator) -> np.ndarray:
    """Turbulence in angle of attack, of first order with a corner of 0.5 Hz. [rad]"""
    pole = np.exp(-2.0 * np.pi * 0.5 / _SIMULATED_HZ)
    white = rng.standard_normal(n) * np.sqrt(1.0 - pole**2)
    return np.radians(std_deg) * signal.lfilter([1.0], [1.0, -pole], white)


def _simulate(
    aircraft: SyntheticAircraft,
    frame: Airframe,
    deflections: np.ndarray,
    gust: np.ndarray,
    speed_varies: bool,
) -> np.ndarray:
    """What the sensors feel, (n_samples, n_sensors)."""
    n_x = frame.n_x
    rows = np.stack([_row(aircraft, frame, sensor) for sensor in aircraft.record.sensors])
    aero = frame.rates[:, ALPHA].copy()  # level flight without thrust: all of it aerodynamic
    A, B = frame.state_matrix, np.column_stack([frame.input_matrix, aero])
    if speed_varies:  # airspeed over its mean, less one
        by_speed = np.zeros((n_x, 1))
        by_speed[ALPHA] = -2.0 * GRAVITY / frame.condition.airspeed
        own = np.zeros((1, n_x + 1))
        own[0, ALPHA], own[0, THETA] = 1.0, -1.0
        own *= GRAVITY / frame.condition.airspeed
        own[0, -1] = -0.05
        A = np.vstack([np.hstack([A, by_speed]), own])
        B = np.vstack([B, np.zeros((1, B.shape[1]))])
    states = _respond(A, B, np.column_stack([deflections, gust]))
    felt = np.hstack([states[:, :n_x], deflections]) @ rows.T + np.outer(gust, rows[:, ALPHA])
    if speed_varies:
        is_heave = [s.kind == ACCELEROMETER.kind for s in aircraft.record.sensors]
        felt -= 2.0 * GRAVITY * np.outer(states[:, -1], is_heave)
    return felt


def _respond(A: np.ndarray, B: np.ndarray, inputs: np.ndarray) -> np.ndarray:
    """States from rest, exact for inputs that are straight between samples."""
    poles, vectors = np.linalg.eig(A)
    drive = inputs @ np.linalg.solve(vectors, B.astype(complex)).T
    h = 1.0 / _SIMULATED_HZ
    modal = np.empty_like(drive)
    for k, pole in enumerate(poles):
        g = np.exp(pole * h)
        small = abs(pole * h) < 1e-6
        after = 0.5 * h if small else (g - 1.0 - pole * h) / (pole**2 * h)
        before = (h if small else (g - 1.0) / pole) - after
        modal[:, k] = signal.lfilter([after, before], [1.0, -g], drive[:, k])
    return np.real(modal @ vectors.T)


def _row(aircraft: SyntheticAircraft, frame: Airframe, sensor: Sensor) -> np.ndarray:
    if sensor.kind == STRAIN.kind:
        return feel.strain_gauge(frame, sensor.point)
    if sensor.kind == GYRO.kind:
        return feel.gyro(frame, sensor.point)
    if sensor.kind == ATTITUDE.kind:
        return feel.attitude(frame, sensor.point)
    aft, right, _ = aircraft.locations[sensor.name]
    position = np.array([aircraft.x_cg - aft, right, 0.0])
    if sensor.kind == VANE.kind:
        return feel.vane(frame, sensor.point, position)
    return feel.accelerometer(frame, "z", sensor.point, position)


_ACC, _GYRO, _ATT, _VANE, _GAUGE, _ = load_sensor_models()

TAILED_40_FT = Design(
    name="tailed, 40 ft",
    span=12.2,
    chord=1.0,
    wing_mass=70.0,
    fuselage=((1.2, 60.0), (0.0, 70.0), (-2.0, 10.0), (-4.5, 15.0)),
    bending=1.2e5,
    torsion=1.2e5,
    fuselage_bending=1.5e5,
    airspeed=40.0,
    tail_area=1.8,
    band_hz=(0.3, 10.0),
    sensors=(
        ("az_cg", _ACC, "f1", 0.0),
        ("az_nose", _ACC, "f0", 0.0),
        ("az_tail", _ACC, "f3", 0.0),
        ("az_midl", _ACC, "6l", 0.2),
        ("az_midr", _ACC, "6r", 0.2),
        ("az_tipl", _ACC, "10l", 0.2),
        ("az_tipr", _ACC, "10r", 0.2),
        ("alpha", _VANE, "f0", 0.8),
        ("q", _GYRO, "f1", 0.0),
        ("q_tip", _GYRO, "10r", 0.0),
        ("theta", _ATT, "f1", 0.0),
        ("s_rootl", _GAUGE, "1l", 0.0),
        ("s_rootr", _GAUGE, "1r", 0.0),
    ),
    surfaces=(("flap_in", 0.3, 0.6), ("flap_out", 0.6, 0.95), ("elevator", 1.1, 1.2)),
)
TAILLESS_10_FT = Design(
    name="tailless, 10 ft",
    span=3.05,
    chord=0.4,
    wing_mass=2.4,
    fuselage=((0.28, 2.2), (0.0, 1.2), (-0.25, 0.3)),
    bending=500.0,
    torsion=250.0,
    fuselage_bending=600.0,
    airspeed=22.0,
    band_hz=(0.5, 16.0),
    sensors=(
        ("az_fore", _ACC, "f0", 0.0),
        ("az_aft", _ACC, "f2", 0.0),
        ("az_tfl", _ACC, "9l", 0.12),
        ("az_tfr", _ACC, "9r", 0.12),
        ("az_tal", _ACC, "9l", -0.2),
        ("az_tar", _ACC, "9r", -0.2),
        ("q", _GYRO, "f1", 0.0),
        ("theta", _ATT, "f1", 0.0),
    ),
    surfaces=(("body", 0.05, 0.4), ("wing", 0.5, 0.95)),
)
GLIDER_20_FT = Design(
    name="glider, 20 ft",
    span=6.1,
    chord=0.45,
    wing_mass=14.0,
    fuselage=((0.6, 10.0), (0.0, 12.0), (-0.9, 1.5), (-2.0, 2.5)),
    bending=6.0e3,
    torsion=6.0e3,
    fuselage_bending=6.0e3,
    airspeed=26.0,
    tail_area=0.35,
    band_hz=(0.4, 14.0),
    sensors=(
        ("az_cg", _ACC, "f1", 0.0),
        ("az_nose", _ACC, "f0", 0.0),
        ("az_tail", _ACC, "f3", 0.0),
        ("az_inl", _ACC, "4l", 0.1),
        ("az_inr", _ACC, "4r", 0.1),
        ("az_midl", _ACC, "7l", -0.1),
        ("az_midr", _ACC, "7r", -0.1),
        ("az_tipl", _ACC, "10l", 0.1),
        ("az_tipr", _ACC, "10r", 0.1),
        ("alpha", _VANE, "f0", 0.3),
        ("q", _GYRO, "f1", 0.0),
        ("theta", _ATT, "f1", 0.0),
        ("s_inl", _GAUGE, "1l", 0.0),
        ("s_inr", _GAUGE, "1r", 0.0),
        ("s_outl", _GAUGE, "5l", 0.0),
        ("s_outr", _GAUGE, "5r", 0.0),
    ),
    surfaces=(("flap_in", 0.2, 0.6), ("flap_out", 0.6, 0.95), ("elevator", 1.1, 1.2)),
)
RIGID = Design(
    name="rigid",
    span=15.0,
    chord=1.9,
    wing_mass=900.0,
    fuselage=((3.0, 1300.0), (0.0, 2000.0), (-7.5, 350.0)),
    bending=2.0e8,
    torsion=1.0e8,
    fuselage_bending=2.0e8,
    airspeed=75.0,
    tail_area=9.0,
    sensors=(
        ("az_cg", _ACC, "f1", 0.0),
        ("alpha", _VANE, "f0", 0.5),
        ("q", _GYRO, "f1", 0.0),
        ("theta", _ATT, "f1", 0.0),
        ("az_nose", _ACC, "f0", 0.0),
    ),
    surfaces=(("elevator", 1.1, 1.2),),
)
FLEXIBLE = (TAILED_40_FT, TAILLESS_10_FT, GLIDER_20_FT)
