"""The flight condition of a maneuver with its spread, and whether one linear model holds."""

from __future__ import annotations

import numpy as np

from flexsid.errors import FlexsidError
from flexsid.records.aircraft import Aircraft
from flexsid.records.maneuver import Maneuver, Role
from flexsid.records.quality import Average, FlightConditionQuality
from flexsid.storage.store import Store
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.model.sensors import SensorRows
from flexsid.sysid.stability.poles import separation_factor
from flexsid.units import si_unit
from flexsid.workflow.models import flight_condition
from flexsid.workflow.modes import find_modal_tables, load_modes
from flexsid.workflow.predictions import best_prediction, predicted_modes, prediction_at
from flexsid.workflow.transforms import load_channels

MOST_FUEL = 0.03
"""Fuel burnt over a maneuver of four periods, which the paper's allow. [1]"""

MOST_DRIFT = 0.03
"""Share of airspeed; dynamic pressure and with it every coefficient drifts twice as much."""


def flown_condition(store: Store, maneuver: Maneuver) -> FlightConditionQuality:
    """Average what was recorded of the condition, and judge its drift.

    Notes
    -----
    Source: Sec. IV (averages), Sec. VI (separation of rigid and elastic frequencies).
    """
    assert maneuver.id is not None
    recorded = store.channels.find(maneuver_id=maneuver.id, role=Role.CONDITION)
    averages = tuple(
        _average(channel.name, si_unit(channel.unit), np.asarray(values, dtype=float))
        for channel, values in load_channels(store, maneuver.id, [c.name for c in recorded])
    )
    by_name = {average.name: average for average in averages}
    fuel, speed = by_name.get("fuel_fraction"), by_name.get("airspeed")
    fuel_change = None if fuel is None else abs(fuel.drift)
    drift = None if speed is None or speed.mean == 0.0 else abs(speed.drift / speed.mean)
    known = [
        value <= most
        for value, most in ((fuel_change, MOST_FUEL), (drift, MOST_DRIFT))
        if value is not None
    ]
    return FlightConditionQuality(
        averages=averages,
        airspeed_ratio=maneuver.airspeed_ratio,
        fuel_fraction=maneuver.condition.fuel_fraction,
        fuel_change=fuel_change,
        airspeed_drift=drift,
        separation_factor=_separation(store, maneuver),
        time_invariant=all(known) if known else None,
    )


def _average(name: str, unit: str, values: np.ndarray) -> Average:
    place = np.arange(values.size) - 0.5 * (values.size - 1)
    power = float(place @ place)
    slope = float(place @ values) / power if power > 0 else 0.0
    return Average(
        name=name,
        unit=unit,
        mean=float(values.mean()),
        std=float(values.std()),
        smallest=float(values.min()),
        largest=float(values.max()),
        drift=slope * (values.size - 1),
    )


def _separation(store: Store, maneuver: Maneuver) -> float | None:
    """Of the model that the prediction with most modes makes at this condition."""
    aircraft: Aircraft = store.aircraft.get(maneuver.aircraft_id)
    try:
        modal, damping = find_modal_tables(store, maneuver.aircraft_id, None, None)
        modes = load_modes(store, modal, damping)
        symmetric = tuple(n for n in modes.table.numbers if modes.symmetric[n])
        inputs = tuple(surface.name for surface in aircraft.surfaces)
        prediction = best_prediction(store, maneuver.aircraft_id, None, symmetric, inputs)
        if prediction is None:
            return None
        covered = predicted_modes(prediction, symmetric)
        fuel = maneuver.condition.fuel_fraction
        values = {n: value for n, (value, _) in prediction_at(store, prediction, fuel).items()}
        table = DerivativeTable.from_names(covered, (), values)
        shapes = modes.table.at(fuel).select(covered)
        blind = SensorRows((), np.zeros((4, 0, 2 + len(covered))))
        model = AeroelasticModel(flight_condition(aircraft, maneuver.condition), shapes, (), blind)
        return separation_factor(model.state_space(table).A, len(covered))
    except FlexsidError:
        return None
