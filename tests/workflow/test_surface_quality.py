"""What a surface did instead of its command is named in the quality of a maneuver."""

from __future__ import annotations

from math import radians

import pytest

from flexsid.demo.campaign import add_aircraft, add_maneuver
from flexsid.demo.flights import fly
from flexsid.demo.truth_flight import FaultKind, SurfaceFault
from flexsid.records.maneuver import Flight
from flexsid.records.quality import QualityVerdict, SurfaceQuality
from flexsid.storage.store import Store
from flexsid.sysid.simulation.turbulence import Turbulence
from flexsid.workflow.quality.quality_warnings import warn_of_surfaces
from flexsid.workflow.quality.sensor_skews import check_surfaces

FAULTS = {
    "wf2s does not follow": SurfaceFault(kind=FaultKind.STUCK, surface="wf2s"),
    "wf3s moved against": SurfaceFault(kind=FaultKind.REVERSED, surface="wf3s"),
    "wf1s oscillates without command at 6.29 Hz with 0.20 deg": SurfaceFault(
        kind=FaultKind.OSCILLATING, surface="wf1s", amplitude=radians(0.2), frequency_hz=6.3
    ),
    "bfs is at its rate limit of about 7": SurfaceFault(
        kind=FaultKind.SLOW, surface="bfs", rate_limit=radians(74.0)
    ),
}


def check(store: Store, **flown) -> tuple[SurfaceQuality, ...]:
    aircraft = add_aircraft(store)
    flight = store.flights.add(Flight(aircraft_id=aircraft.id or 0, number=1))
    maneuver = add_maneuver(store, fly(airspeed_ratio=0.65, **flown), flight.id or 0)
    return check_surfaces(store, maneuver, aircraft)


@pytest.mark.parametrize("text", FAULTS)
def test_fault_of_a_surface_is_named(store: Store, text: str) -> None:
    fault = FAULTS[text]
    named = list(warn_of_surfaces(check(store, seed=5, fault=fault)))
    (own,) = (one for one in named if one.channel == fault.surface)
    assert own.text.startswith(text)
    assert own.severity is not QualityVerdict.GOOD
    assert len(named) == 1 or fault.kind is FaultKind.SLOW


def test_servos_are_those_of_the_aircraft_in_turbulence(store: Store) -> None:
    found = check(store, seed=6, turbulence=Turbulence.MODERATE)
    assert not list(warn_of_surfaces(found))
    assert len(found) == 5
    for one in found:
        assert one.gain == pytest.approx(1.0, abs=0.01)
        # 12 ms of the actuator, and half a sample for which the simulation holds commands.
        assert one.delay_s == pytest.approx(0.0125, abs=3e-4)
        assert one.natural_frequency_hz == pytest.approx(9.87, rel=0.02)
        assert one.damping == pytest.approx(0.75, rel=0.02)
    fed_back = {one.name: one.fed_back for one in found}
    assert "q" in fed_back["wf1s"]
    assert fed_back["bfs"] == ()
