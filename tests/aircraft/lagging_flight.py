"""A run whose derivatives have the frequency shape of a lattice, from a flight with such forces."""

from __future__ import annotations

from flexsid.demo.campaign import add_aircraft, add_maneuver
from flexsid.demo.flights import fly
from flexsid.jobs.dispatcher import execute_run
from flexsid.jobs.kinds import RUN
from flexsid.records.decision import Structure
from flexsid.records.maneuver import Flight
from flexsid.records.run import Aerodynamics, EstimationRun, Method, OutOfBandModes, RunSettings
from flexsid.storage.store import Store


def estimate_with_shape(store: Store, airspeed_ratio: float, method: Method) -> EstimationRun:
    """Fly FLEX-28U with two modes and estimate both with the shape of its lattice."""
    aircraft = add_aircraft(store, unsteady=True)
    flight = store.flights.add(Flight(aircraft_id=aircraft.id or 0, number=9))
    flown = fly(airspeed_ratio=airspeed_ratio, seed=4, modes_in_truth=2, unsteady=True)
    asked = EstimationRun(
        maneuver_id=add_maneuver(store, flown, flight.id or 0).id or 0,
        method=method,
        structure=Structure(modes=(7, 9), fixed={}),
        settings=RunSettings(
            aerodynamics=Aerodynamics.SHAPED, out_of_band_modes=OutOfBandModes.OMITTED
        ),
        prediction_id=store.predictions.find(source="Doublet lattice")[0].id,
    )
    return execute_run(store, asked, RUN, lambda progress: None)
