"""A user relies on: amplitudes proposed for other airspeeds reach the limits there, in flight."""

from __future__ import annotations

import numpy as np
import pytest
from flown_runs import estimated, planned

from flexsid.demo.campaign import add_aircraft
from flexsid.demo.flex28 import load_truth
from flexsid.demo.flights import TRIM_S, fly
from flexsid.records.maneuver import Flight
from flexsid.storage.store import Store
from flexsid.workflow.excitation.classic_inputs import ExcitationPeaks, propose_levels
from flexsid.workflow.excitation.excitation_designs import build_multisine
from flexsid.workflow.excitation.predicted_accuracy import load_prediction_model

LOAD_FACTOR = 0.3


def test_amplitudes_at_other_airspeeds_reach_the_load_factor_limit(store: Store):
    """The flight has eight modes, its own feedback and actuators; the run was at .65 V_f."""
    aircraft = add_aircraft(store)
    flight = store.flights.add(Flight(aircraft_id=aircraft.id or 0, number=9)).id or 0
    run = estimated(store, flight, 0.65, (506, 2.0, (7, 9)), 1)
    design = planned(store, 506, 2.0)
    at = load_prediction_model(store, run.id or 0)
    limits = ExcitationPeaks(deflection=1.0, rate=20.0, load_factor=LOAD_FACTOR)
    levels = propose_levels(store, at, design, 0, limits)
    flutter = load_truth().flutter_speed_at(0.5)
    assert max(one.airspeed_m_s for one in levels) < flutter
    assert len(levels) == 7
    largest = [one.largest for one in levels]
    assert largest == sorted(largest, reverse=True)  # faster flight, larger response
    for one in levels[1], levels[-3]:
        assert one.limited_by == "load_factor"
        scale = one.largest / design.specification.peaks[0]
        flown = fly(
            airspeed_ratio=one.airspeed_m_s / flutter,
            multisine=build_multisine(design, 0).scale(scale),
            noise=False,
        )
        (channel,) = (c for c in flown.channels if c.name == "az_egi")
        trimmed = channel.samples[: int(0.9 * TRIM_S * channel.rate_hz)].mean()
        peak = float(np.abs(channel.samples - trimmed).max())
        print(one, peak)
        # The sensor is not at the c.g., and the maneuver begins at rest.
        assert peak == pytest.approx(LOAD_FACTOR, rel=0.2)
