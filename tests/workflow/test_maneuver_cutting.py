"""Cutting of a whole flight into maneuvers."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from flexsid.demo.campaign import add_aircraft
from flexsid.demo.flights import (
    PAUSE_S,
    SETTLE_S,
    TRIM_S,
    FlownManeuver,
    add_recording,
    fly,
    record_flight,
)
from flexsid.errors import BadInput, Conflict
from flexsid.records.maneuver import Cut, Flight, Role
from flexsid.storage.store import Store
from flexsid.workflow.aircraft.aircraft_models import define_outputs
from flexsid.workflow.importing.maneuver_cutting import (
    cut_maneuver,
    find_maneuvers,
    read_flight_history,
)
from flexsid.workflow.measurements.maneuver_spectra import read_measurement
from flexsid.workflow.views.maneuver import read_traces

START_S = 1000.0


@pytest.fixture(scope="module")
def flown() -> list[FlownManeuver]:
    return [
        fly(airspeed_ratio=0.65, fta=506, seed=31, modes_in_truth=2),
        fly(airspeed_ratio=0.70, fta=503, seed=32, modes_in_truth=2, fuel=0.48),
    ]


@pytest.fixture
def flight_id(store: Store, flown: list[FlownManeuver]) -> int:
    aircraft = add_aircraft(store)
    assert aircraft.id is not None
    flight = store.flights.add(Flight(aircraft_id=aircraft.id, number=80))
    add_recording(store, record_flight(flown), flight, START_S)
    assert flight.id is not None
    return flight.id


def test_maneuvers_are_found_with_trim_and_harmonics_and_cut(
    store: Store, flight_id: int, flown: list[FlownManeuver]
):
    found = find_maneuvers(store, flight_id)
    assert [one.basis for one in found] == ["recorded excitation"] * 2
    length = flown[0].maneuver.duration_s
    for index, (one, was) in enumerate(zip(found, [one.maneuver for one in flown], strict=True)):
        begins = START_S + PAUSE_S + index * (length + PAUSE_S)
        assert one.excitation is not None
        assert was.excitation is not None
        assert one.excitation.harmonics == was.excitation.harmonics
        assert one.excitation.period_s == pytest.approx(was.excitation.period_s)
        assert one.excitation.start_s == pytest.approx(begins + TRIM_S, abs=0.01)
        assert one.start_s == pytest.approx(begins, abs=0.01)
        assert one.stop_s == pytest.approx(begins + TRIM_S + 24.0 + SETTLE_S, abs=0.01)
        assert one.maneuver_id is None

    first = found[0]
    cut = Cut(label="first", start_s=first.start_s, stop_s=first.stop_s, fta=506)
    stored = cut_maneuver(store, flight_id, cut)
    assert stored.id is not None
    assert stored.excitation == first.excitation
    known = flown[0].maneuver.condition
    assert stored.condition.airspeed_m_s == pytest.approx(known.airspeed_m_s, rel=1e-3)
    assert stored.condition.mass_kg == pytest.approx(known.mass_kg, rel=1e-3)
    assert stored.airspeed_ratio == pytest.approx(0.65, abs=0.002)
    aircraft = store.aircraft.get(stored.aircraft_id)
    spectra = read_measurement(
        store, stored, aircraft, tuple(flown[0].truth.inputs), define_outputs(aircraft, ["q"])
    ).transform()
    assert spectra.commands is not None
    responses = spectra.responses
    assert np.all(np.isfinite(responses["bfs"].values))
    (trace,) = read_traces(store, stored, ["az_egi"])
    original = next(c for c in flown[0].channels if c.name == "az_egi")
    assert np.array_equal((trace.values / 9.80665).astype(np.float32), original.samples)

    again = find_maneuvers(store, flight_id)
    assert [one.maneuver_id for one in again] == [stored.id, None]
    # FTA numbers follow from maneuvers with the same harmonics
    assert [one.fta for one in again] == [506, None]
    with pytest.raises(Conflict, match="another label"):
        cut_maneuver(store, flight_id, cut)


def test_marker_is_labelled_with_the_maneuver(store: Store, flight_id: int):
    channels = store.flight_channels.find(flight_id=flight_id)
    clock = next(c for c in channels if c.role is Role.CONDITION)
    number = np.zeros(clock.n_samples, dtype=np.float32)
    at = round((PAUSE_S + TRIM_S) * clock.rate_hz)
    number[at : at + round(24.0 * clock.rate_hz)] = 506
    marker = replace(clock, id=None, name="fta", unit="1", array=store.arrays.put(number, "1"))
    store.flight_channels.add(marker)
    assert [one.fta for one in find_maneuvers(store, flight_id)] == [506, None]
    for channel in channels:
        if channel.role is Role.COMMAND:
            assert channel.id is not None
            store.flight_channels.delete(channel.id)
    (marked,) = find_maneuvers(store, flight_id)
    assert marked.basis == "marker fta"
    assert marked.label == "80-01 FTA 506"
    assert marked.excitation is None


def test_excitation_is_recognised_from_surfaces_alone(store: Store, flight_id: int):
    for channel in store.flight_channels.find(flight_id=flight_id, role=Role.COMMAND):
        assert channel.id is not None
        store.flight_channels.delete(channel.id)
    found = find_maneuvers(store, flight_id)
    assert [one.basis for one in found] == ["motion of the surfaces"] * 2
    assert found[0].start_s == pytest.approx(START_S + PAUSE_S, abs=0.5)
    assert found[0].stop_s == pytest.approx(START_S + PAUSE_S + 30.0, abs=1.5)


def test_empty_windows_are_refused(store: Store, flight_id: int):
    for start_s, stop_s in ((5.0, 4.0), (0.0, 10.0), (1020.0, 1020.01), (9000.0, 9010.0)):
        with pytest.raises(BadInput):
            cut_maneuver(store, flight_id, Cut(label="x", start_s=start_s, stop_s=stop_s))
    assert store.maneuvers.find() == []
    empty = store.flights.add(Flight(aircraft_id=1, number=81))
    with pytest.raises(BadInput, match="no recording"):
        find_maneuvers(store, empty.id or 0)


def test_a_flight_is_read_over_a_window(store: Store, flight_id: int):
    value = read_flight_history(store, flight_id, ["q", "bfs_command"], 1040.0, 1041.0)
    assert [trace.name for trace in value.traces] == ["q", "bfs_command"]
    assert value.traces[0].time_s[[0, -1]] == pytest.approx([1040.0, 1041.0], abs=0.006)
    assert len(read_flight_history(store, flight_id).traces) == 4
    with pytest.raises(BadInput, match="no channel"):
        read_flight_history(store, flight_id, ["nothing"])
