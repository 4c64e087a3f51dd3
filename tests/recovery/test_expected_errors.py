"""A user relies on: standard errors predicted before a flight agree with those after it."""

from __future__ import annotations

import numpy as np
import pytest
from flown_runs import estimated, planned

from flexsid.demo.campaign import add_aircraft
from flexsid.records.maneuver import Flight
from flexsid.storage.store import Store
from flexsid.sysid.simulation.turbulence import Turbulence
from flexsid.workflow.excitation.predicted_accuracy import DesignQuery, predict_accuracy

BEFORE = 2.0  # degrees of the body flap in the maneuver that is known
PLANNED = [(506, 4.0, (7, 9)), (506, 1.0, (7, 9)), (503, 2.0, (7,))]  # aid, degrees, modes


@pytest.mark.parametrize(
    ("ratio", "turbulence"),
    [
        (0.56, Turbulence.NONE),
        pytest.param(0.95, Turbulence.NONE, marks=pytest.mark.long),
        pytest.param(0.65, Turbulence.LIGHT, marks=pytest.mark.long),
    ],
)
def test_expected_errors_are_those_of_the_flight(
    store: Store, ratio: float, turbulence: Turbulence
):
    """The flight includes feedback, actuators, input noise and unmodelled modes."""
    aircraft = add_aircraft(store)
    flight = store.flights.add(Flight(aircraft_id=aircraft.id or 0, number=9)).id or 0
    flown = {}
    for fta, peak_deg, modes in PLANNED:
        if fta not in flown:
            flown[fta] = estimated(store, flight, ratio, (fta, BEFORE, modes), 1, None, turbulence)
        before = flown[fta]
        design = planned(store, fta, peak_deg)
        query = DesignQuery(design_id=design.id or 0, run_id=before.id or 0, level=0)
        predicted = predict_accuracy(store, query, lambda progress: None).errors
        after = estimated(store, flight, ratio, (fta, peak_deg, modes), 2, None, turbulence)
        assert after.result is not None
        found = {row.name: row.std_error for row in after.result.parameters}
        ratios = [row.std_error / (found[row.name] or np.nan) for row in predicted.items]
        assert 0.8 < np.median(ratios) < 1.25
        assert predicted.harmonics_outside_band == 0
        assert "as recorded" in predicted.surfaces
