"""True frequency responses of FLEX-28, as reference for measured ones."""

from __future__ import annotations

import numpy as np

from flexsid.demo.aircraft import describe_aircraft
from flexsid.demo.campaign import add_aircraft, add_maneuver
from flexsid.demo.flex28 import INPUTS, load_truth
from flexsid.demo.flights import FlownManeuver
from flexsid.demo.truth_flight import sensor_rows
from flexsid.records.maneuver import Flight, Role
from flexsid.storage.store import Store
from flexsid.sysid.signals import FrequencyResponse
from flexsid.sysid.simulation.airframe import assemble_airframe
from flexsid.sysid.spectra.measured_spectra import MeasuredSpectra
from flexsid.workflow.aircraft.aircraft_models import define_outputs, list_default_outputs
from flexsid.workflow.measurements.maneuver_spectra import read_measurement

_FLIGHT = 99  # of maneuvers that are simulated only for comparison with the truth


def compute_true_responses(
    airspeed_ratio: float, fuel: float, omega: np.ndarray, outputs: tuple[str, ...]
) -> FrequencyResponse:
    """Return responses of outputs and combinations to all surfaces, without instruments."""
    truth = load_truth()
    aircraft = describe_aircraft(truth)
    count = len(truth.symmetric)
    condition = truth.condition_at(airspeed_ratio * truth.flutter_speed_at(fuel), fuel)
    airframe = assemble_airframe(
        condition, truth.modes_at(fuel, count), truth.derivatives_at(fuel, count)
    )
    felt = sensor_rows(truth, airframe, aircraft.sensors)
    rows = {sensor.name: row for sensor, row in zip(aircraft.sensors, felt, strict=True)}
    terms = {c.name: c.terms for c in aircraft.combinations}
    output_rows = np.stack(
        [
            np.sum([w * rows[part] for part, w in terms.get(name, ((name, 1.0),))], axis=0)
            for name in outputs
        ]
    )
    n_x = airframe.n_x
    resolvent = 1j * omega[:, None, None] * np.eye(n_x) - airframe.state_matrix
    entry = np.broadcast_to(airframe.input_matrix, (omega.size, n_x, len(INPUTS)))
    values = output_rows[:, :n_x] @ np.linalg.solve(resolvent, entry) + output_rows[:, n_x:]
    return FrequencyResponse(omega, values, outputs, INPUTS)


def compute_relative_errors(
    measured: dict[str, FrequencyResponse], airspeed_ratio: float, fuel: float = 0.5
) -> np.ndarray:
    """Return complex relative errors of all data points of all responses."""
    parts = []
    for name, found in measured.items():
        true = compute_true_responses(airspeed_ratio, fuel, found.omega, found.outputs)
        column = true.values[:, :, INPUTS.index(name)]
        parts.append((found.values[:, :, 0] / column - 1.0).ravel())
    return np.concatenate(parts)


def compute_open_loop_ratios(measured: MeasuredSpectra) -> dict[str, FrequencyResponse]:
    """Return ratios of outputs to the assigned input, unbiased in open loop only."""
    inputs, outputs, result = measured.inputs, measured.true_outputs(), {}
    for j, name in enumerate(inputs.names):
        own = np.flatnonzero(measured.assigned_input == j)
        ratio = outputs.values[own] / inputs.values[own, j][:, None]
        result[name] = FrequencyResponse(
            outputs.omega[own], ratio[:, :, None], outputs.names, (name,)
        )
    return result


def save_and_measure(store: Store, flown: FlownManeuver) -> MeasuredSpectra:
    """Store a simulated maneuver and return its Fourier transforms."""
    aircraft = add_aircraft(store)
    assert aircraft.id is not None
    known = store.flights.find(aircraft_id=aircraft.id, number=_FLIGHT)
    flight = (
        known[0] if known else store.flights.add(Flight(aircraft_id=aircraft.id, number=_FLIGHT))
    )
    assert flight.id is not None
    maneuver = add_maneuver(store, flown, flight.id)
    recorded = [c.name for c in store.channels.find(maneuver_id=maneuver.id, role=Role.OUTPUT)]
    outputs = define_outputs(aircraft, list_default_outputs(aircraft, recorded))
    return read_measurement(store, maneuver, aircraft, INPUTS, outputs).transform()
