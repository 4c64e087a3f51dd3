"""Loops read from one closed-loop flight are those of the controller that flew it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from true_responses import compute_true_responses

from flexsid.demo.aircraft import describe_aircraft
from flexsid.demo.campaign import add_aircraft, add_maneuver
from flexsid.demo.flex28 import INPUTS, load_truth
from flexsid.demo.flights import fly
from flexsid.errors import BadInput
from flexsid.figures.closed_loop import draw_loops
from flexsid.records.maneuver import Flight
from flexsid.storage.store import Store
from flexsid.workflow.views.bode import estimate_loops

RATIO, FUEL = 0.80, 0.5


def true_loop(omega: np.ndarray, surface: str) -> np.ndarray:
    """Broken in front of one servo, the other loops closed."""
    truth = load_truth()
    law, s = truth.controller, 1j * omega
    servo = describe_aircraft(truth).instruments["servo"].response(omega)
    lag = law.filter_corner / (s + law.filter_corner) * np.exp(-s * law.delay_s)
    gains = np.zeros((len(INPUTS), 2))
    speed = RATIO * truth.flutter_speed_at(FUEL)
    gains[[INPUTS.index(name) for name in law.surfaces]] = law.gains_at(speed)
    H = compute_true_responses(RATIO, FUEL, omega, ("q", "theta")).values
    L = (lag * servo)[:, None, None] * (gains @ H)
    k = INPUTS.index(surface)
    return 1.0 / np.linalg.inv(np.eye(len(INPUTS)) + L)[:, k, k] - 1.0


@pytest.mark.parametrize("noise", [False, True])
def test_loops_and_their_errors_are_true(store: Store, noise: bool):
    aircraft = add_aircraft(store)
    flight = store.flights.add(Flight(aircraft_id=aircraft.id or 0, number=3))
    flown = fly(airspeed_ratio=RATIO, fuel=FUEL, fta=506, seed=2, noise=noise)
    maneuver = add_maneuver(store, flown, flight.id or 0)
    found = estimate_loops(store, maneuver.id or 0)
    assert tuple(curve.surface for curve in found.curves) == INPUTS
    held = []
    for curve in found.curves:
        error = np.abs(curve.gain - true_loop(2.0 * np.pi * curve.frequency_hz, curve.surface))
        if not noise:
            assert np.median(error) < 3e-3
        held.append(error < 2.0 * curve.std)
    if noise:
        assert 0.90 < np.mean(held) < 1.0
    widest = max(found.curves, key=lambda curve: np.abs(curve.gain).max())
    assert 0.3 < widest.disk < 1.5
    assert np.isfinite(widest.phase_rad)
    spec = draw_loops(found)
    assert "phase" in spec["data"][INPUTS.index(widest.surface)]["name"]


def test_missing_elements_of_a_loop_are_reported(store: Store):
    aircraft = add_aircraft(store)
    flight = store.flights.add(Flight(aircraft_id=aircraft.id or 0, number=4))
    maneuver = add_maneuver(store, fly(fta=503, seed=2), flight.id or 0)
    surfaces = tuple(replace(surface, servo=None) for surface in aircraft.surfaces)
    store.aircraft.replace(replace(aircraft, surfaces=surfaces))
    with pytest.raises(BadInput, match="no servo for 'bfs'"):
        estimate_loops(store, maneuver.id or 0)
    store.maneuvers.replace(replace(maneuver, excitation=None))
    with pytest.raises(BadInput, match="excitation"):
        estimate_loops(store, maneuver.id or 0)
