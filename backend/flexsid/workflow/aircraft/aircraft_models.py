"""Aeroelastic model of one maneuver from the aircraft record and the condition."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.aircraft import Aircraft, Sensor, SensorKind
from flexsid.records.maneuver import Condition
from flexsid.sysid.model import sensors as rows
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.condition import FlightCondition
from flexsid.sysid.model.instruments import Instrument
from flexsid.sysid.modes import StructuralModes
from flexsid.workflow.aircraft.longitudinal import (
    classify_part,
    is_pitch_sensor,
    reads_symmetric_motion_only,
    require_pitch_sensor,
    require_symmetric_inputs,
    require_symmetric_part,
    resolve_terms,
)

_NO_INSTRUMENT = Instrument()


@dataclass(frozen=True, slots=True)
class OutputDefinition:
    """An output as a weighted sum of sensors of one kind."""

    name: str
    kind: SensorKind
    terms: tuple[tuple[Sensor, float], ...]


def build_flight_condition(aircraft: Aircraft, condition: Condition) -> FlightCondition:
    """Build the flight condition of a maneuver with the reference dimensions of the aircraft.

    Raises
    ------
    BadInput
        If the airspeed is zero: aerodynamic derivatives are then not identifiable.
    """
    if not condition.dynamic_pressure_pa > 0.0 or not condition.airspeed_m_s > 0.0:
        raise BadInput(
            f"the record was taken at an airspeed of {condition.airspeed_m_s:g} m/s; an "
            "aeroelastic model needs a flight maneuver (ground records are compared as mini-GVT)",
            code="no-airspeed",
        )
    polar = aircraft.polar
    return FlightCondition(
        airspeed=condition.airspeed_m_s,
        density=condition.density_kg_m3,
        mass=condition.mass_kg,
        pitch_inertia=condition.pitch_inertia_kg_m2,
        area=aircraft.geometry.area_m2,
        chord=aircraft.geometry.chord_m,
        alpha=condition.alpha_rad,
        gamma=condition.gamma_rad,
        thrust=condition.thrust_n,
        x_cg=condition.x_cg_m,
        z_cg=condition.z_cg_m,
        induced_drag=0.0 if polar is None else 1.0 / (np.pi * polar.oswald * polar.aspect_ratio),
    )


def define_outputs(aircraft: Aircraft, names: Iterable[str]) -> tuple[OutputDefinition, ...]:
    """Resolve output names to sensors.

    Raises
    ------
    BadInput
        If a name is neither a sensor nor a combination, or sensors of a
        combination differ in kind or instrument.
    """
    sensors = {sensor.name: sensor for sensor in aircraft.sensors}
    combinations = {c.name: c.terms for c in aircraft.combinations}
    result = []
    for name in names:
        terms = ((name, 1.0),) if name in sensors else combinations.get(name)
        if terms is None or any(part not in sensors for part, _ in terms):
            raise BadInput(
                f"'{name}' is not an output of {aircraft.name}; outputs are "
                f"{', '.join([*sensors, *combinations])}",
                code="unknown-output",
                output=name,
            )
        parts = tuple((sensors[part], weight) for part, weight in terms)
        if len({(s.kind, s.instrument) for s, _ in parts}) > 1:
            raise BadInput(
                f"'{name}' combines sensors of different kinds or instruments",
                code="mixed-combination",
                output=name,
            )
        result.append(OutputDefinition(name, parts[0][0].kind, parts))
    return tuple(result)


def list_default_outputs(
    aircraft: Aircraft, recorded: Iterable[str], *, separated: bool = False
) -> tuple[str, ...]:
    """List the default outputs of a longitudinal model: symmetric sensors and symmetric parts.

    Parameters
    ----------
    aircraft, recorded
        Aircraft, and the names of its recorded channels.
    separated
        Only outputs without lateral motion, for maneuvers that also excite it.
    """
    recorded = set(recorded)
    sensors = {sensor.name: sensor for sensor in aircraft.sensors}
    combined = {part for c in aircraft.combinations for part, _ in c.terms}
    single = {
        sensor.name: ((sensor, 1.0),)
        for sensor in aircraft.sensors
        if sensor.name in recorded
        and sensor.name not in combined
        and not (sensor.kind is SensorKind.ACCELEROMETER and sensor.axis == "y")
        and is_pitch_sensor(sensor)
    }
    paired = {
        c.name: terms
        for c in aircraft.combinations
        if (terms := resolve_terms(c, sensors)) is not None
        and all(sensor.name in recorded and is_pitch_sensor(sensor) for sensor, _ in terms)
        and classify_part(terms) != "antisymmetric"
    }
    usable = single | paired
    return tuple(n for n, t in usable.items() if not separated or reads_symmetric_motion_only(t))


def build_model(
    aircraft: Aircraft,
    condition: Condition,
    modes: StructuralModes,
    inputs: tuple[str, ...],
    outputs: tuple[OutputDefinition, ...],
) -> AeroelasticModel:
    """Build the aeroelastic model of a maneuver without its derivatives.

    Raises
    ------
    BadInput
        If a sensor's point has no mode shape in the table, or an input or output belongs
        to the lateral motion.
    """
    require_symmetric_inputs(aircraft, inputs)
    flight = build_flight_condition(aircraft, condition)
    polynomials = []
    for output in outputs:
        total = np.zeros((4, 2 + len(modes.numbers)))
        require_symmetric_part(output.name, output.terms)
        for sensor, weight in output.terms:
            require_pitch_sensor(sensor)
            total += weight * _build_sensor_row(sensor, flight, modes)
        polynomials.append(total)
    sensors = rows.stack_rows([output.name for output in outputs], polynomials)
    return AeroelasticModel(flight, modes, inputs, sensors)


def get_output_instrument(aircraft: Aircraft, output: OutputDefinition) -> Instrument:
    """Return the instrument of an output."""
    return _get_instrument(aircraft, output.terms[0][0].instrument)


def compute_input_correction(aircraft: Aircraft, surface: str, omega: np.ndarray) -> np.ndarray:
    """Compute the response from the recorded signal of a surface to its true deflection."""
    for candidate in aircraft.surfaces:
        if candidate.name == surface:
            recorded = _get_instrument(aircraft, candidate.instrument).response(omega)
            driven = _get_instrument(aircraft, candidate.actuator).response(omega)
            return driven / recorded
    raise BadInput(
        f"'{surface}' is not a surface of {aircraft.name}; surfaces are "
        f"{', '.join(s.name for s in aircraft.surfaces)}",
        code="unknown-input",
        input=surface,
    )


def get_servo(aircraft: Aircraft, surface: str) -> Instrument:
    """Return the servo from the command of a surface to its deflection.

    Raises
    ------
    BadInput
        If the aircraft record has none.
    """
    for candidate in aircraft.surfaces:
        if candidate.name == surface and candidate.servo is not None:
            return _get_instrument(aircraft, candidate.servo)
    raise BadInput(
        f"{aircraft.name} has no servo for '{surface}'; add the response from its command "
        "to its deflection",
        code="no-servo",
        input=surface,
    )


def _get_instrument(aircraft: Aircraft, name: str | None) -> Instrument:
    if name is None:
        return _NO_INSTRUMENT
    if name not in aircraft.instruments:
        raise BadInput(
            f"{aircraft.name} has no instrument '{name}'", code="unknown-instrument", name=name
        )
    return aircraft.instruments[name]


def _build_sensor_row(
    sensor: Sensor, flight: FlightCondition, modes: StructuralModes
) -> np.ndarray:
    if sensor.kind is SensorKind.STRAIN:
        return rows.strain_row(modes.strain[_find_shape_index(sensor, modes.gauges, modes)])
    index = _find_shape_index(sensor, modes.points, modes)
    translation, rotation = modes.translation[index], modes.rotation[index]
    position = rows.body_axes(sensor.location_m, flight)
    if sensor.kind is SensorKind.GYRO:
        return rows.gyro_row(rotation)
    if sensor.kind is SensorKind.ATTITUDE:
        return rows.attitude_row(rotation)
    if sensor.kind is SensorKind.VANE:
        return rows.vane_row(position, translation, rotation, flight)
    return rows.accelerometer_row(sensor.axis, position, translation, rotation, flight)


def _find_shape_index(sensor: Sensor, known: tuple[str, ...], modes: StructuralModes) -> int:
    if sensor.point not in known:
        raise BadInput(
            f"the modal table has no shape at '{sensor.point}', where {sensor.name} is mounted; "
            f"omit {sensor.name} or import shapes there (the table has "
            f"{', '.join(known) or 'none'})",
            code="no-shape-at-sensor",
            sensor=sensor.name,
            point=sensor.point,
        )
    return known.index(sensor.point)
