"""A rigid transport: doublets and multisines in both axes, without a modal table.

Its ailerons are recorded one by one: together they excite the longitudinal, against each other
the lateral motion.
"""

from __future__ import annotations

from collections.abc import Mapping
from datetime import date

import numpy as np

from flexsid.demo.campaign import add_maneuver
from flexsid.demo.flights import FlownManeuver, describe_excitation
from flexsid.demo.truth_flight import FlownChannel
from flexsid.records.aircraft import Aircraft, Combination, Geometry, MassTable, Sensor, Surface
from flexsid.records.maneuver import COMBINED, Condition, Excitation, Flight, Maneuver, Role
from flexsid.storage.store import Store
from flexsid.sysid.excitation.multisine import assign_harmonics, design_multisine
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.condition import GRAVITY
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.model.lateral import LATERAL
from flexsid.sysid.model.longitudinal import LONGITUDINAL
from flexsid.sysid.modes import StructuralModes
from flexsid.workflow.aircraft.aircraft_models import build_model, define_outputs

NAME = "Twin-engine transport"
TRUE = {
    "longitudinal": {
        "CZ_alpha": -5.6, "CZ_q": -8.0, "CZ_elevator": -0.45, "CZ_aileron_s": -0.9,
        "Cm_alpha": -1.3, "Cm_q": -25.0, "Cm_elevator": -1.7, "Cm_aileron_s": -0.1,
    },
    "lateral": {
        "CY_beta": -0.9, "CY_p": -0.2, "CY_r": 0.6, "CY_aileron_a": -0.05, "CY_rudder": 0.3,
        "Cl_beta": -0.12, "Cl_p": -0.55, "Cl_r": 0.19, "Cl_aileron_a": -0.2, "Cl_rudder": 0.04,
        "Cn_beta": 0.13, "Cn_p": -0.06, "Cn_r": -0.19, "Cn_aileron_a": 0.01, "Cn_rudder": -0.14,
    },
}  # fmt: skip
"""True derivatives of each axis."""

_INPUTS = {"longitudinal": ("elevator", "aileron_s"), "lateral": ("aileron_a", "rudder")}
_SIDES = ("aileron_l", "aileron_r")
_RATE_HZ, _DURATION_S = 50.0, 40.0
_PERIOD_S, _START_S = 24.0, 2.0
_PEAK_RAD = 0.04
_SERVO_HZ = 3.0
_SEED = 21
_RIGID = StructuralModes(
    (), np.zeros(0), np.zeros(0), np.zeros(0), (), np.zeros((0, 3, 0)), np.zeros((0, 3, 0)),
    (), np.zeros((0, 0)),
)  # fmt: skip
_CONDITION = Condition(
    airspeed_m_s=70.0,
    density_kg_m3=1.0,
    fuel_fraction=0.5,
    mass_kg=4600.0,
    pitch_inertia_kg_m2=32_000.0,
    x_cg_m=0.0,
    z_cg_m=0.0,
    alpha_rad=0.05,
    roll_inertia_kg_m2=21_000.0,
    yaw_inertia_kg_m2=46_000.0,
    product_of_inertia_kg_m2=1_500.0,
    airspeed_std=0.0,  # as simulated
    density_std=0.0,
)
_TRIM = {
    "alpha": _CONDITION.alpha_rad,
    "theta": _CONDITION.alpha_rad,
    "az": -GRAVITY * np.cos(_CONDITION.alpha_rad),
}
_STEPS = {  # start and end [s], surface, sign
    "elevator 3-2-1-1": (
        *((2.0, 3.5, "elevator", 1.0), (3.5, 4.5, "elevator", -1.0)),
        *((4.5, 5.0, "elevator", 1.0), (5.0, 5.5, "elevator", -1.0)),
    ),
    "aileron and rudder doublets": (
        *((2.0, 3.0, "aileron_r", 1.0), (3.0, 4.0, "aileron_r", -1.0)),
        *((2.0, 3.0, "aileron_l", -1.0), (3.0, 4.0, "aileron_l", 1.0)),
        *((12.0, 13.0, "rudder", 1.0), (13.0, 14.0, "rudder", -1.0)),
    ),
}


def describe_transport() -> Aircraft:
    """Describe the aircraft: reference dimensions, mass, surfaces and sensors at the c.g."""
    at = _CONDITION
    names = (
        *(("alpha", "vane", "y", 5e-4), ("q", "gyro", "y", 5e-4), ("theta", "attitude", "y", 5e-4)),
        *(("beta", "vane", "z", 5e-4), ("p", "gyro", "x", 5e-4), ("r", "gyro", "z", 5e-4)),
        *(("phi", "attitude", "x", 5e-4), ("ay", "accelerometer", "y", 0.02)),
        ("az", "accelerometer", "z", 0.02),
    )
    both = (at.product_of_inertia_kg_m2, at.roll_inertia_kg_m2, at.yaw_inertia_kg_m2)
    product, roll, yaw = (0.0 if value is None else value for value in both)
    return Aircraft(
        name=NAME,
        geometry=Geometry(area_m2=39.0, chord_m=1.98, span_m=19.8),
        mass=MassTable(
            fuel=(at.fuel_fraction,),
            mass_kg=(at.mass_kg,),
            pitch_inertia_kg_m2=(at.pitch_inertia_kg_m2,),
            x_cg_m=(at.x_cg_m,),
            z_cg_m=(at.z_cg_m,),
            roll_inertia_kg_m2=(roll,),
            yaw_inertia_kg_m2=(yaw,),
            product_of_inertia_kg_m2=(product,),
            mass_std=0.0,  # as simulated
            inertia_std=0.0,
        ),
        surfaces=(
            Surface(name="elevator", symmetry="symmetric"),
            Surface(name="rudder", symmetry="antisymmetric"),
            *(Surface(name=name, symmetry="single") for name in _SIDES),
            Surface(name="aileron_s", symmetry="symmetric"),
            Surface(name="aileron_a", symmetry="antisymmetric"),
        ),
        sensors=tuple(
            Sensor(name=name, kind=kind, point=name, axis=axis, noise_std=noise)
            for name, kind, axis, noise in names
        ),
        combinations=(
            Combination(name="aileron_s", terms=(("aileron_l", 0.5), ("aileron_r", 0.5))),
            Combination(name="aileron_a", terms=(("aileron_l", -0.5), ("aileron_r", 0.5))),
        ),
        instruments={},
        description="Rigid: no modes. Simulated doublets and multisines in both axes.",
    )


def add_transport(store: Store) -> Aircraft:
    """Store the aircraft with one flight of three maneuvers, if missing."""
    known = store.aircraft.find(name=NAME)
    if known:
        return known[0]
    flown = fly_transport()
    with store.transaction():
        aircraft = store.aircraft.add(describe_transport())
        assert aircraft.id is not None
        flight = store.flights.add(
            Flight(
                aircraft_id=aircraft.id,
                number=1,
                flown_on=date(2025, 6, 3),
                description="Doublets and independent ailerons of a rigid transport",
            )
        )
        for one in flown:
            add_maneuver(store, one, flight.id or 0)
    return aircraft


def fly_transport() -> tuple[FlownManeuver, ...]:
    """Simulate the three maneuvers: elevator, ailerons and rudder, independent ailerons."""
    from scipy import signal  # takes a second to import, of the start of a server

    time = np.arange(0.0, _DURATION_S, 1.0 / _RATE_HZ)
    servo = signal.butter(2, _SERVO_HZ, fs=_RATE_HZ)
    flown = []
    for (label, steps), body in zip(_STEPS.items(), (LONGITUDINAL, LATERAL), strict=True):
        surfaces: dict[str, np.ndarray] = {}
        for start, stop, name, sign in steps:
            moved = surfaces.setdefault(name, np.zeros(time.size))
            moved[(time >= start) & (time < stop)] = sign * _PEAK_RAD
        filtered = {name: signal.lfilter(*servo, moved) for name, moved in surfaces.items()}
        flown.append(_record(label, body.axis, filtered, len(flown)))
    harmonics = assign_harmonics(_SIDES, 20, 2)
    multisine = design_multisine(harmonics, _PERIOD_S, dict.fromkeys(_SIDES, _PEAK_RAD))
    first, count = round(_START_S * _RATE_HZ), round(_PERIOD_S * _RATE_HZ)
    samples = np.zeros((time.size, len(_SIDES)))
    samples[first : first + count] = multisine.sample(np.arange(count) / _RATE_HZ)
    moved = dict(zip(multisine.inputs, samples.T, strict=True))
    excitation = describe_excitation(multisine, 0.0, 1)
    flown.append(_record("independent ailerons", COMBINED, moved, len(flown), excitation))
    return tuple(flown)


def _record(
    label: str,
    axis: str,
    surfaces: Mapping[str, np.ndarray],
    number: int,
    excitation: Excitation | None = None,
) -> FlownManeuver:
    """Simulate the motion of both axes and record surfaces and noisy sensors."""
    from scipy import signal

    aircraft, rng = describe_transport(), np.random.default_rng((_SEED, number))
    still = np.zeros(round(_DURATION_S * _RATE_HZ))
    left, right = (surfaces.get(name, still) for name in _SIDES)
    moved = {"aileron_s": 0.5 * (right + left), "aileron_a": 0.5 * (right - left), **surfaces}
    channels = [
        FlownChannel(name=name, unit="rad", role=Role.INPUT, rate_hz=_RATE_HZ, samples=samples)
        for name, samples in surfaces.items()
    ]
    time = np.arange(still.size) / _RATE_HZ
    truths = []
    for body in (LONGITUDINAL, LATERAL):
        own = [s for s in aircraft.sensors if s.model.measures_rigid_body(s.axis, body)]
        outputs = define_outputs(aircraft, [sensor.name for sensor in own])
        inputs = _INPUTS[body.axis]
        model: AeroelasticModel = build_model(aircraft, _CONDITION, _RIGID, inputs, outputs, body)
        truth = DerivativeTable.from_names((), inputs, TRUE[body.axis], body)
        system = model.state_space(truth)
        deflections = np.stack([moved.get(name, still) for name in inputs], axis=1)
        matrices = (system.A, system.B, system.C, system.D)
        _, values, _ = signal.lsim(matrices, deflections, time)
        truths.append(truth)
        for sensor, samples in zip(own, np.asarray(values).T, strict=True):
            noise = rng.normal(scale=sensor.noise_std or sensor.model.noise_std, size=samples.size)
            channels.append(
                FlownChannel(
                    name=sensor.name,
                    unit=sensor.model.units[0],
                    role=Role.OUTPUT,
                    rate_hz=_RATE_HZ,
                    samples=samples + noise + _TRIM.get(sensor.name, 0.0),
                )
            )
    return FlownManeuver(
        maneuver=Maneuver(
            aircraft_id=0,
            flight_id=0,
            label=label,
            axis=axis,
            start_s=0.0,
            duration_s=_DURATION_S,
            condition=_CONDITION,
            excitation=excitation,
        ),
        channels=tuple(channels),
        truth=truths[0],
    )
