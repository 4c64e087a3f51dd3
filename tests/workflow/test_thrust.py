"""Thrust from the engine state by a ground-test table."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from flexsid.demo.aircraft import build_thrust_table
from flexsid.demo.campaign import add_aircraft, add_maneuver
from flexsid.demo.flex28 import load_truth
from flexsid.demo.flights import add_recording, fly, record_flight
from flexsid.errors import BadInput
from flexsid.importers.aircraft import AircraftMapping
from flexsid.importers.table import read_table
from flexsid.records.maneuver import Cut, Flight
from flexsid.storage.store import Store
from flexsid.units import to_si
from flexsid.workflow.aircraft.flight_condition import (
    complete_condition,
    compute_total_temperature,
    interpolate_thrust,
    parse_thrust_table,
    set_thrust_table,
)
from flexsid.workflow.importing.maneuver_cutting import cut_maneuver
from flexsid.workflow.quality.maneuver_quality import assess_condition

TEXT = """speed;0;20
30000; 10; 9
60000; 80; 72
90000;200;180
"""


def test_table_is_parsed_and_interpolated_in_both_axes():
    table = parse_thrust_table(TEXT, ("left", "right"), ("rpm", "degC", "lbf"), "bench")
    assert table.source == "bench"
    assert table.total_temperature_k == pytest.approx((273.15, 293.15))
    rpm = np.array([30e3, 45e3, 75e3])
    speeds = {"left": to_si(rpm, "rpm"), "right": to_si(rpm[::-1], "rpm")}
    found = interpolate_thrust(table, speeds, 278.15)
    cold = np.array([10.0, 45.0, 140.0])
    each = 0.75 * cold + 0.25 * np.array([9.0, 40.5, 126.0])
    assert found == pytest.approx((each + each[::-1]) * 4.4482216152605)
    alone = parse_thrust_table("30000,10\n60000,80", ("left",), ("rpm", "K", "N"))
    assert interpolate_thrust(alone, {"left": to_si([45e3], "rpm")}, 200.0) == pytest.approx([45.0])


@pytest.mark.parametrize(
    ("text", "engines", "words"),
    [
        ("", ("a",), "two rows"),
        ("30000,10", ("a",), "two rows"),
        ("30000,10\n20000,20", ("a",), "increasing rotation speeds"),
        ("30000,10\n40000,x", ("a",), "row 2, column 2 is 'x'"),
        ("30000,10\n40000,nan", ("a",), "finite"),
        ("30000,10,9\n40000,20,18", ("a",), "temperatures in the first row"),
        ("rpm,260,280\n30000,10,9\n40000,20", ("a",), "row 3 has 2 numbers"),
        ("rpm,280,260\n30000,10,9\n40000,20,18", ("a",), "increasing temperatures"),
        ("30000,10\n40000,20", (), "has no engine"),
        ("30000,10\n40000,20", ("a", "a"), "one twice"),
    ],
)
def test_tables_that_cannot_be_interpolated_are_refused(text: str, engines, words: str):
    with pytest.raises(BadInput, match=words):
        parse_thrust_table(text, engines, ("rpm", "K", "N"))


def test_units_that_do_not_fit_are_refused():
    with pytest.raises(BadInput, match="angular rate is expected"):
        parse_thrust_table(TEXT, ("a",), ("N", "K", "N"))


def test_engine_outside_the_table_is_reported():
    with pytest.raises(BadInput, match="'engine_speed_l' ranges"):
        interpolate_thrust(build_thrust_table(), {"engine_speed_l": np.array([20e3])}, 288.0)


def test_total_temperature_of_standard_air():
    # ISO 2533 at 1524 m: 278.244 K, 1.05555 kg/m3
    assert compute_total_temperature(1.05555, 0.0) == pytest.approx(278.244, abs=0.01)
    assert compute_total_temperature(1.05555, 100.0) == pytest.approx(278.244 + 4.977, abs=0.01)


def test_a_cut_maneuver_has_the_thrust_of_its_engines(store: Store):
    aircraft = add_aircraft(store)
    assert aircraft.id is not None
    flown = fly(airspeed_ratio=0.7, modes_in_truth=2, seed=3)
    flight = store.flights.add(Flight(aircraft_id=aircraft.id, number=50))
    assert flight.id is not None
    add_recording(store, record_flight([flown]), flight)
    cut = cut_maneuver(store, flight.id, Cut(label="a", start_s=20.0, stop_s=50.0))
    truth = load_truth()
    thrust = truth.condition_at(0.7 * truth.flutter_speed_at(0.5), 0.5).thrust
    assert cut.condition.thrust_n == pytest.approx(thrust, rel=1e-4)
    averages = {a.name: a for a in assess_condition(store, cut).averages}
    assert averages["thrust"].mean == pytest.approx(thrust, rel=1e-4)
    assert averages["mass"].mean == pytest.approx(cut.condition.mass_kg, rel=1e-4)
    assert averages["mass"].drift < 0.0
    assert averages["engine_speed_l"].unit == "rad/s"
    # A table with half the thrust gives half of it to maneuvers that are cut afterwards.
    assert aircraft.thrust is not None
    half = tuple(tuple(0.5 * value for value in row) for row in aircraft.thrust.thrust_n)
    set_thrust_table(store, aircraft.id, replace(aircraft.thrust, thrust_n=half))
    again = cut_maneuver(store, flight.id, Cut(label="b", start_s=20.0, stop_s=50.0))
    assert again.condition.thrust_n == pytest.approx(0.5 * thrust, rel=1e-4)
    assert store.maneuvers.get(cut.id or 0).condition.thrust_n == pytest.approx(thrust, rel=1e-4)
    # Without any, thrust balances the drag; what was measured counts more than a table.
    bare = set_thrust_table(store, aircraft.id, None)
    measured = {"airspeed": 40.0, "density": 1.05, "fuel_fraction": 0.5}
    drag = complete_condition(bare, measured).thrust_n
    assert drag > 0.0
    engines = {"engine_speed_l": 7000.0, "engine_speed_r": 7000.0}
    assert complete_condition(aircraft, measured | engines).thrust_n != pytest.approx(drag)
    assert complete_condition(aircraft, measured | engines | {"thrust": 5.0}).thrust_n == 5.0


def test_a_mapping_brings_a_thrust_table():
    part = {
        "name": "X-9",
        "geometry": {
            "area": {"value": 1.0, "unit": "m2"},
            "chord": {"value": 0.3, "unit": "m"},
            "span": {"value": 3.0, "unit": "m"},
        },
        "mass": {
            "fuel": [0.5],
            "mass": {"value": 10.0, "unit": "kg"},
            "pitch_inertia": {"value": 1.0, "unit": "kg*m2"},
            "x_cg": {"value": 0.5, "unit": "m"},
        },
        "surfaces": [{"name": "bfs"}],
        "sensors": [{"name": "q", "kind": "gyro"}],
        "thrust": {
            "engines": ["n1"],
            "engine_speed": {"values": [30e3, 60e3], "unit": "rpm"},
            "total_temperature": {"values": [0.0, 20.0], "unit": "degC"},
            "thrust": {"values": [10.0, 9.0, 80.0, 72.0], "unit": "N"},
        },
    }
    definition = read_table(AircraftMapping, part).build().definition
    assert definition is not None
    assert definition.thrust is not None
    assert definition.thrust.thrust_n == ((10.0, 9.0), (80.0, 72.0))
    part["thrust"]["thrust"]["values"] = [10.0, 9.0, 80.0]
    with pytest.raises(BadInput, match="2 x 2 values"):
        read_table(AircraftMapping, part)


def test_recorded_maneuver_retains_its_thrust(store: Store):
    aircraft = add_aircraft(store)
    assert aircraft.id is not None
    flight = store.flights.add(Flight(aircraft_id=aircraft.id, number=51))
    assert flight.id is not None
    stored = add_maneuver(store, fly(modes_in_truth=2, noise=False), flight.id)
    truth = load_truth()
    expected = truth.condition_at(0.65 * truth.flutter_speed_at(0.5), 0.5).thrust
    assert stored.condition.thrust_n == pytest.approx(expected, rel=1e-5)
