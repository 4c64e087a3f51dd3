"""Surfaces over time against what their commands make of them."""

from __future__ import annotations

from math import radians

import numpy as np
import pytest

from flexsid.demo.campaign import add_aircraft, add_maneuver
from flexsid.demo.flights import fly
from flexsid.demo.independent_surfaces import NAME
from flexsid.demo.truth_flight import FaultKind, SurfaceFault
from flexsid.figures.time_histories import draw_surface_histories
from flexsid.records.maneuver import Flight
from flexsid.records.views import SurfaceHistories, SurfaceHistory
from flexsid.storage.store import Store
from flexsid.workflow.views.time_comparison import read_surface_histories


def read(store: Store, fault: SurfaceFault | None = None) -> SurfaceHistories:
    aircraft = add_aircraft(store)
    flight = store.flights.add(Flight(aircraft_id=aircraft.id or 0, number=1))
    maneuver = add_maneuver(store, fly(airspeed_ratio=0.65, fault=fault), flight.id or 0)
    return read_surface_histories(store, maneuver.id or 0)


def compare(one: SurfaceHistory) -> float:
    """Root mean square of measured less commanded, over that of the commanded. [1]"""
    assert one.commanded is not None
    at = one.commanded.time_s
    measured = np.interp(at, one.measured.time_s, one.measured.values)
    return float(np.std(measured - one.commanded.values) / np.std(one.commanded.values))


def test_surfaces_follow_their_commands_through_the_servo_unless_they_are_stuck(store: Store):
    stuck = SurfaceFault(kind=FaultKind.STUCK, surface="wf2s")
    found = {row[0].measured.name: row[0] for row in read(store, stuck).rows}
    # Without feedback, which moves the outer flaps, what remains is noise of the potentiometer.
    assert compare(found["bfs"]) < 0.05
    assert compare(found["wf2s"]) > 0.9
    assert np.std(found["wf2s"].measured.values) < radians(0.1)


def test_left_and_right_surfaces_share_a_row(independent_store: Store):
    store = independent_store
    (aircraft,) = store.aircraft.find(name=NAME)
    (maneuver, *_) = store.maneuvers.find(aircraft_id=aircraft.id)
    assert maneuver.fta == 536
    found = read_surface_histories(store, maneuver.id or 0, 5.0, 6.0, points=200)
    assert [len(row) for row in found.rows] == [2] * 5
    for left, right in found.rows:
        assert left.commanded is not None
        assert right.commanded is not None
        moved = np.corrcoef(left.commanded.values, right.commanded.values)[0, 1]
        assert moved == pytest.approx(-1.0)  # an antisymmetric maneuver
        assert max(compare(left), compare(right)) < 0.7  # with feedback
    curves = draw_surface_histories(found)["data"]
    assert len(curves) == 20
    assert sum(curve["showlegend"] for curve in curves) == 3


def test_a_surface_without_recorded_command_is_drawn_alone(store: Store, aircraft, add_maneuver):
    ((surface,),) = read_surface_histories(store, add_maneuver().id).rows
    assert surface.measured.name == "bfs"
    assert surface.commanded is None
