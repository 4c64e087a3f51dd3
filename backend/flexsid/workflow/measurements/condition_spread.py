"""Flight condition of a maneuver with its spread, and validity of a time-invariant model."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Sequence

import numpy as np

from flexsid.errors import BadInput, FlexsidError
from flexsid.records.aircraft import Aircraft
from flexsid.records.axes import symmetric_surfaces
from flexsid.records.maneuver import Channel, Maneuver, Role
from flexsid.records.quality import Average, FlightConditionQuality
from flexsid.storage.store import Store
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.model.sensors import SensorRows
from flexsid.sysid.stability.poles import compute_separation_factor
from flexsid.units import si_unit
from flexsid.workflow.aircraft.aircraft_models import build_flight_condition
from flexsid.workflow.aircraft.derivative_predictions import (
    interpolate_prediction,
    list_predicted_modes,
    select_prediction,
)
from flexsid.workflow.aircraft.longitudinal import require_longitudinal
from flexsid.workflow.aircraft.thrust import (
    TOTAL_TEMPERATURE,
    compute_total_temperature,
    interpolate_thrust,
)
from flexsid.workflow.measurements.maneuver_spectra import load_channels
from flexsid.workflow.modal_data.aligned_modes import find_modal_tables, load_modes

MAX_FUEL_CHANGE = 0.03
"""Fuel burnt over a maneuver of four periods that the paper accepts. [fraction]"""

MAX_AIRSPEED_DRIFT = 0.03
"""Relative drift of airspeed; dynamic pressure drifts twice as much."""


def assess_condition(store: Store, maneuver: Maneuver) -> FlightConditionQuality:
    """Average the recorded condition and assess its drift.

    Notes
    -----
    Source: Sec. IV (averages), Sec. VI (separation of rigid and elastic frequencies).
    """
    assert maneuver.id is not None
    recorded = store.channels.find(maneuver_id=maneuver.id, role=Role.CONDITION)
    loaded = load_channels(store, maneuver.id, [c.name for c in recorded])
    averages = tuple(
        _average(channel.name, si_unit(channel.unit), np.asarray(values, dtype=float))
        for channel, values in loaded
    )
    names = {average.name for average in averages}
    aircraft = store.aircraft.get(maneuver.aircraft_id)
    averages += tuple(
        a for a in _average_table_values(aircraft, maneuver, loaded) if a.name not in names
    )
    by_name = {average.name: average for average in averages}
    fuel, speed = by_name.get("fuel_fraction"), by_name.get("airspeed")
    fuel_change = None if fuel is None else abs(fuel.drift)
    drift = None if speed is None or speed.mean == 0.0 else abs(speed.drift / speed.mean)
    known = [
        value <= most
        for value, most in ((fuel_change, MAX_FUEL_CHANGE), (drift, MAX_AIRSPEED_DRIFT))
        if value is not None
    ]
    return FlightConditionQuality(
        averages=averages,
        airspeed_ratio=maneuver.airspeed_ratio,
        fuel_fraction=maneuver.condition.fuel_fraction,
        fuel_change=fuel_change,
        airspeed_drift=drift,
        separation_factor=_compute_separation_factor(store, maneuver),
        time_invariant=all(known) if known else None,
    )


def _average_table_values(
    aircraft: Aircraft, maneuver: Maneuver, loaded: Sequence[tuple[Channel, np.ndarray]]
) -> Iterator[Average]:
    """Average mass properties and thrust from the tables of the aircraft, sample by sample."""
    known = {channel.name: (channel, np.asarray(values, float)) for channel, values in loaded}
    if "fuel_fraction" in known:
        table, fuel = aircraft.mass, known["fuel_fraction"][1]
        for name, unit, column in (
            ("mass", "kg", table.mass_kg),
            ("pitch_inertia", "kg*m2", table.pitch_inertia_kg_m2),
            ("x_cg", "m", table.x_cg_m),
        ):
            yield _average(name, unit, np.interp(fuel, table.fuel, column))
    engines = aircraft.thrust
    if engines is None or not all(name in known for name in engines.engines):
        return
    condition = maneuver.condition
    air = np.array(compute_total_temperature(condition.density_kg_m3, condition.airspeed_m_s))
    inputs = {name: known[name] for name in engines.engines}
    clocks = {(c.rate_hz, c.start_s, c.n_samples) for c, _ in inputs.values()}
    if TOTAL_TEMPERATURE in known:
        channel, air = known[TOTAL_TEMPERATURE]
        clocks.add((channel.rate_hz, channel.start_s, channel.n_samples))
    speeds = {name: values for name, (_, values) in inputs.items()}
    if len(clocks) > 1:  # then averages
        speeds = {name: values.mean(keepdims=True) for name, values in speeds.items()}
        air = air.mean(keepdims=True)
    with contextlib.suppress(BadInput):  # outside the table
        yield _average("thrust", "N", interpolate_thrust(engines, speeds, air))


def _average(name: str, unit: str, values: np.ndarray) -> Average:
    sample = np.arange(values.size) - 0.5 * (values.size - 1)
    power = float(sample @ sample)
    slope = float(sample @ values) / power if power > 0 else 0.0
    return Average(
        name=name,
        unit=unit,
        mean=float(values.mean()),
        std=float(values.std()),
        smallest=float(values.min()),
        largest=float(values.max()),
        drift=slope * (values.size - 1),
    )


def _compute_separation_factor(store: Store, maneuver: Maneuver) -> float | None:
    """Compute the separation factor of the model with the most predicted modes."""
    aircraft: Aircraft = store.aircraft.get(maneuver.aircraft_id)
    try:
        modal, damping = find_modal_tables(store, maneuver.aircraft_id, None, None)
        modes = load_modes(store, modal, damping)
        symmetric = tuple(n for n in modes.table.numbers if modes.symmetric[n])
        require_longitudinal(maneuver)
        inputs = symmetric_surfaces(aircraft)
        prediction = select_prediction(store, maneuver.aircraft_id, None, symmetric, inputs)
        if prediction is None:
            return None
        covered = list_predicted_modes(prediction, symmetric)
        fuel = maneuver.condition.fuel_fraction
        values = {
            n: value for n, (value, _) in interpolate_prediction(store, prediction, fuel).items()
        }
        table = DerivativeTable.from_names(covered, (), values)
        shapes = modes.table.at(fuel).select(covered)
        blind = SensorRows((), np.zeros((4, 0, 2 + len(covered))))
        model = AeroelasticModel(
            build_flight_condition(aircraft, maneuver.condition), shapes, (), blind
        )
        return compute_separation_factor(model.state_space(table).A, len(covered))
    except FlexsidError:
        return None
