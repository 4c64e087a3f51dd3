"""FLEX-28 with left and right surfaces moved on their own: both axes in flexible flight.

The antisymmetric derivatives are those of ``data/flex28_lateral.json``. The motion is the sum of a
symmetric and an antisymmetric one, which a maneuver excites alone or together.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, replace
from datetime import date
from functools import cache
from importlib import resources
from typing import Any

import numpy as np

from flexsid.demo.aircraft import build_anti_alias_filter, describe_aircraft
from flexsid.demo.campaign import add_maneuver
from flexsid.demo.flex28 import INPUTS, Truth, load_truth
from flexsid.demo.flights import (
    ALTITUDE_M,
    FlownManeuver,
    average_condition,
    describe_excitation,
    sample_excitation,
)
from flexsid.demo.sources import SaveArray, build_modal_tables
from flexsid.demo.truth_flight import RATE_HZ, Recorder, condition_channels
from flexsid.records.aircraft import (
    Aircraft,
    Combination,
    DerivativePrediction,
    Sensor,
)
from flexsid.records.flutter import ControlLaw, Controller
from flexsid.records.maneuver import COMBINED, Condition, Flight, Maneuver
from flexsid.storage.store import Store
from flexsid.sysid.excitation.catalogue import CATALOGUE
from flexsid.sysid.excitation.multisine import Multisine, assign_harmonics, design_multisine
from flexsid.sysid.model.aeroelastic import StateSpace
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.model.lateral import LATERAL
from flexsid.sysid.model.sensor_models import ATTITUDE, GYRO, VANE
from flexsid.sysid.modes import StructuralModes
from flexsid.sysid.preparation.resampling import combine_pair, find_pairs
from flexsid.sysid.simulation.preflight_simulation import simulate_flight
from flexsid.units import factor
from flexsid.workflow.aircraft.aircraft_models import build_model, define_outputs, get_servo
from flexsid.workflow.aircraft.axes import is_axis_sensor
from flexsid.workflow.flutter.controllers import add_controller, interpolate_controller
from flexsid.workflow.importing.flight_import import correlate_inputs

NAME = "FLEX-28 with independent surfaces"
MODES = (8, 10, 13, 14, 16, 19, 20, 21)
"""Antisymmetric modes of the truth."""

_PAIRS = tuple(name.removesuffix("s") for name in INPUTS)
_SINGLES = tuple(f"{pair}{side}" for side in "lr" for pair in _PAIRS)
_ANTISYMMETRIC = tuple(f"{pair}a" for pair in _PAIRS)
_READS = ("q", "theta", "p", "phi", "r")
_DELAY_S = 1.0 / RATE_HZ  # of the simulated law, beyond that of the controller
_SEED, _PREDICTED = 2810, 2811
_ERROR = 0.15  # relative standard deviation of the predicted derivatives


@dataclass(frozen=True, slots=True)
class IndependentCard:
    """One maneuver: flight condition, flight test aid and peak deflection."""

    airspeed_ratio: float
    fuel: float
    fta: int
    peak_deg: float

    @property
    def axis(self) -> str:
        """Antisymmetric aids move left and right surfaces against each other."""
        return LATERAL.axis if self.fta < 550 else COMBINED


CARDS = (
    IndependentCard(0.65, 0.60, 536, 2.0),
    IndependentCard(0.65, 0.54, 556, 2.0),
    IndependentCard(0.80, 0.46, 536, 2.0),
    IndependentCard(0.95, 0.38, 556, 1.6),
)


@cache
def _load_source() -> dict[str, Any]:
    file = resources.files("flexsid.demo").joinpath("data", "flex28_lateral.json")
    return json.loads(file.read_text(encoding="utf-8"))


def compute_true_derivatives(fuel: float) -> DerivativeTable:
    """Compute the antisymmetric derivatives at a fuel fraction."""
    source = _load_source()
    tables = np.array(
        [
            [
                [row["beta"], row["p"], row["r"], *row["eta"], *row["etadot"], *row["delta"]]
                for row in (at_fuel["CY"], at_fuel["Cl"], at_fuel["Cn"], *at_fuel["CQ"])
            ]
            for at_fuel in source["derivatives"]
        ]
    )
    flat = tables.reshape(len(tables), -1)
    values = np.array([np.interp(fuel, source["fuel_fraction"], column) for column in flat.T])
    return DerivativeTable(MODES, _ANTISYMMETRIC, values.reshape(tables.shape[1:]), LATERAL)


def describe_independent() -> Aircraft:
    """Describe FLEX-28 with ten surfaces, their symmetric and antisymmetric parts, and sensors."""
    source, truth = _load_source(), load_truth()
    symmetric = describe_aircraft(truth)
    noise = truth.source["noise_sigma"]
    inertia = factor("slug*ft2", "inertia")

    def mount(name: str, kind: str, point: str, axis: str, std: float) -> Sensor:
        x, y, z = map(float, truth.locations[point])
        place = (x, y, z)
        return Sensor(
            name=name,
            kind=kind,
            point=point,
            axis=axis,
            location_m=place,
            instrument=kind,
            noise_std=std,
        )

    singles = tuple(replace(symmetric.surfaces[0], name=name) for name in _SINGLES)
    parts, combinations = [], []
    for left, right, both in find_pairs(_SINGLES):
        for part in ("symmetric", "antisymmetric"):
            name, terms = combine_pair(left, right, both, 1.0, part)
            std = float(noise["pot_rad"] / np.sqrt(2.0))
            parts.append(replace(singles[0], name=name, noise_std_rad=std, symmetry=part))
            combinations.append(Combination(name=name, terms=terms))
    sensors = {sensor.name: sensor for sensor in symmetric.sensors}
    for left, right, both in find_pairs(sensors):
        sign = sensors[left].model.mirror_sign(sensors[left].axis)
        name, terms = combine_pair(left, right, both, sign, "antisymmetric")
        combinations.append(Combination(name=name, terms=terms))
    return replace(
        symmetric,
        name=NAME,
        description=(
            "FLEX-28, whose ten surfaces move independently: antisymmetric maneuvers, and ones that"
            " excite both axes. Antisymmetric derivatives are of the same vortex lattice."
        ),
        mass=replace(
            symmetric.mass,
            roll_inertia_kg_m2=tuple(inertia * value for value in source["Ixx"]),
            yaw_inertia_kg_m2=tuple(inertia * value for value in source["Izz"]),
            product_of_inertia_kg_m2=tuple(inertia * value for value in source["Ixz"]),
        ),
        surfaces=(*(replace(one, symmetry="single") for one in singles), *parts),
        sensors=(
            *symmetric.sensors,
            mount("beta", VANE.kind, "boom", "z", noise["vane_rad"]),
            mount("p", GYRO.kind, "nose_gyro", "x", noise["gyro_rad_s"]),
            mount("r", GYRO.kind, "nose_gyro", "z", noise["gyro_rad_s"]),
            mount("phi", ATTITUDE.kind, "egi_att", "x", noise["attitude_rad"]),
        ),
        combinations=(*symmetric.combinations, *combinations),
    )


def describe_controller(aircraft_id: int) -> Controller:
    """Describe the law: that of FLEX-28 for all surfaces, and roll and yaw against each other."""
    symmetric, lateral = load_truth().controller, _load_source()["controller"]
    order = [lateral["meas"].index(name) for name in ("p", "phi", "r")]
    antisymmetric = np.zeros((len(_PAIRS), 3))
    for pair, row in zip(lateral["surf"], lateral["K"], strict=True):
        antisymmetric[_PAIRS.index(pair.removesuffix("a"))] = np.array(row)[order]
    corner = symmetric.filter_corner
    lowest = symmetric.low_speed + symmetric.least_gain * (
        symmetric.high_speed - symmetric.low_speed
    )
    laws = []
    for airspeed in (lowest, symmetric.high_speed):
        gains = np.zeros((len(_PAIRS), 2))
        for name, row in zip(symmetric.surfaces, symmetric.gains_at(airspeed), strict=True):
            gains[_PAIRS.index(name.removesuffix("s"))] = row
        output = np.block([[-gains, antisymmetric], [-gains, -antisymmetric]])
        laws.append(
            ControlLaw(
                airspeed_m_s=float(airspeed),
                A=_rows(-corner * np.eye(5)),
                B=_rows(corner * np.eye(5)),
                C=_rows(output),
                D=_rows(np.zeros((len(_SINGLES), 5))),
            )
        )
    return Controller(
        aircraft_id=aircraft_id,
        name="Pitch, roll and yaw feedback",
        reads=_READS,
        drives=_SINGLES,
        laws=tuple(laws),
        delay_s=symmetric.delay_s,
    )


def _rows(matrix: np.ndarray) -> tuple[tuple[float, ...], ...]:
    return tuple(tuple(row) for row in matrix.tolist())


def add_independent(store: Store) -> Aircraft:
    """Store the aircraft with modal tables, a prediction and one flight, if missing."""
    known = store.aircraft.find(name=NAME)
    if known:
        return known[0]
    flown = [fly_card(card, number) for number, card in enumerate(CARDS, start=1)]
    with store.transaction():
        aircraft = store.aircraft.add(describe_independent())
        assert aircraft.id is not None
        for table in build_modal_tables(load_truth(), aircraft.id, store.arrays.put):
            store.modal_tables.add(table)
        store.predictions.add(_predict(aircraft.id, store.arrays.put))
        add_controller(store, describe_controller(aircraft.id))
        flight = store.flights.add(
            Flight(
                aircraft_id=aircraft.id,
                number=1,
                flown_on=date(2025, 6, 5),
                description="Antisymmetric and independent surfaces to 0.95 of the flutter speed",
            )
        )
        for one in flown:
            add_maneuver(store, one, flight.id or 0)
    return aircraft


def _predict(aircraft_id: int, save: SaveArray) -> DerivativePrediction:
    """Return the derivatives of both axes with random errors."""
    truth = load_truth()
    true = [
        truth.derivatives_at(fuel, len(MODES)).named() | compute_true_derivatives(fuel).named()
        for fuel in (0.0, 0.5, 1.0)
    ]
    names = tuple(true[0])
    wrong = 1.0 + _ERROR * np.random.default_rng(_PREDICTED).standard_normal(len(names))
    return DerivativePrediction(
        aircraft_id=aircraft_id,
        source="Panel code",
        kind="panel code",
        fuel=(0.0, 0.5, 1.0),
        names=names,
        values=save(wrong * np.array([list(at_fuel.values()) for at_fuel in true])),
        note="inviscid, both axes; no error bounds are known",
    )


def fly_card(card: IndependentCard, number: int) -> FlownManeuver:
    """Simulate a maneuver in closed loop from trim and record all channels."""
    truth, aircraft = load_truth(), describe_independent()
    multisine = _design(card)
    excitation, during = sample_excitation(multisine)
    commands = excitation @ _distribute(multisine.inputs)
    duration_s = len(excitation) / RATE_HZ
    flight = truth.condition_at(card.airspeed_ratio * truth.flutter_speed_at(card.fuel), card.fuel)
    exact = average_condition(
        aircraft, condition_channels(flight, card.fuel, ALTITUDE_M, duration_s, 0.0, None)
    )
    plant = build_plant(aircraft, truth, exact, card.fuel)
    law = describe_controller(0)
    moved = simulate_flight(
        plant,
        [get_servo(aircraft, name) for name in _SINGLES],
        commands,
        RATE_HZ,
        interpolate_controller(law, exact.airspeed_m_s),
        law.delay_s - _DELAY_S,
    )
    rng = np.random.default_rng((_SEED, number))
    singles = replace(aircraft, surfaces=aircraft.surfaces[: len(_SINGLES)])
    recorder = Recorder(singles, build_anti_alias_filter(truth.source), rng)
    surfaces = recorder.surfaces(moved.deflections)
    noise_std = truth.source["noise_sigma"]["airspeed_ft_s"] * factor("ft/s", "speed")
    states = condition_channels(flight, card.fuel, ALTITUDE_M, duration_s, noise_std, rng)
    condition = average_condition(aircraft, states)
    assert condition.flutter_speed_m_s is not None
    described = describe_excitation(multisine, 0.0)
    inputs = {one.name: one.samples[during] for one in surfaces}
    return FlownManeuver(
        maneuver=Maneuver(
            aircraft_id=0,
            flight_id=0,
            label=f"1-{number:02d} FTA {card.fta}",
            fta=card.fta,
            axis=card.axis,
            start_s=0.0,
            duration_s=duration_s,
            condition=condition,
            airspeed_ratio=condition.airspeed_m_s / condition.flutter_speed_m_s,
            excitation=described,
            max_input_correlation=correlate_inputs(aircraft, card.axis, described, inputs),
            note="eight symmetric and eight antisymmetric modes in the truth",
        ),
        channels=(
            *surfaces,
            *recorder.sensors(aircraft.sensors, moved.outputs, flight),
            *recorder.commands(_SINGLES, commands),
            *states,
        ),
        truth=compute_true_derivatives(card.fuel),
    )


def _design(card: IndependentCard) -> Multisine:
    layout = load_truth().source["multisine"]
    if card.axis == LATERAL.axis:
        order = [f"{pair}a" for pair in layout["order"]]
    else:
        order = [f"{pair}{side}" for side in "lr" for pair in layout["order"]]
    assigned = assign_harmonics(order, CATALOGUE[card.fta].harmonics_per_input, layout["k0"])
    peaks = {name: float(np.radians(card.peak_deg)) * layout["scale"][name[:-1]] for name in order}
    return design_multisine(assigned, layout["T_s"], peaks)


def _distribute(inputs: Sequence[str]) -> np.ndarray:
    """Return the commands of the single surfaces by those of a multisine, (n_u, 10)."""
    sides = {"a": (-1.0, 1.0), "l": (1.0, 0.0), "r": (0.0, 1.0)}
    found = np.zeros((len(inputs), len(_SINGLES)))
    for row, name in enumerate(inputs):
        for side, share in zip("lr", sides[name[-1]], strict=True):
            found[row, _SINGLES.index(f"{name[:-1]}{side}")] = share
    return found


def build_plant(aircraft: Aircraft, truth: Truth, at: Condition, fuel: float) -> StateSpace:
    """Build the motion of both axes, driven by single surfaces, with all sensors in order.

    States are those of both models, the longitudinal ones first.
    """
    half = np.eye(len(_PAIRS)) / 2.0
    count = len(MODES)
    systems = [
        (
            _build_axis(
                aircraft, at, truth.modes_at(fuel, count), truth.derivatives_at(fuel, count)
            ),
            np.hstack([half, half]),
        ),
        (
            _build_axis(
                aircraft, at, truth.modes.at(fuel).select(MODES), compute_true_derivatives(fuel)
            ),
            np.hstack([-half, half]),
        ),
    ]
    (one, _), (other, _) = systems
    n, m = one.A.shape[0], other.A.shape[0]
    names = tuple(sensor.name for sensor in aircraft.sensors)
    through = [_place(names, system.outputs, system.D @ parts) for system, parts in systems]
    return StateSpace(
        A=np.block([[one.A, np.zeros((n, m))], [np.zeros((m, n)), other.A]]),
        B=np.vstack([system.B @ parts for system, parts in systems]),
        C=np.hstack([_place(names, system.outputs, system.C) for system, _ in systems]),
        D=np.sum(through, axis=0),
        states=(*one.states, *other.states),
        inputs=_SINGLES,
        outputs=names,
    )


def _build_axis(
    aircraft: Aircraft, at: Condition, modes: StructuralModes, true: DerivativeTable
) -> StateSpace:
    own = [sensor.name for sensor in aircraft.sensors if is_axis_sensor(sensor, true.body)]
    outputs = define_outputs(aircraft, own)
    return build_model(aircraft, at, modes, true.inputs, outputs, true.body).state_space(true)


def _place(names: Sequence[str], own: Sequence[str], rows: np.ndarray) -> np.ndarray:
    """Return the rows of some sensors at their places among all; the others are zero."""
    found = np.zeros((len(names), rows.shape[1]))
    found[[names.index(name) for name in own]] = rows
    return found
