"""Models: an aircraft record and a condition to the mathematics of one maneuver."""

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
    is_pitch_sensor,
    part_of,
    parts_of,
    reads_symmetric_motion_only,
    require_pitch_sensor,
    require_symmetric_inputs,
    require_symmetric_part,
)

_NO_INSTRUMENT = Instrument()


@dataclass(frozen=True, slots=True)
class OutputDefinition:
    """An output as a weighted sum of sensors of one kind."""

    name: str
    kind: SensorKind
    terms: tuple[tuple[Sensor, float], ...]


def flight_condition(aircraft: Aircraft, condition: Condition) -> FlightCondition:
    """Condition of a maneuver with the aircraft's reference dimensions.

    Raises
    ------
    BadInput
        If the aircraft stood: without airspeed nothing aerodynamic can be told.
    """
    if not condition.dynamic_pressure_pa > 0.0 or not condition.airspeed_m_s > 0.0:
        raise BadInput(
            f"the record was taken at an airspeed of {condition.airspeed_m_s:g} m/s; a model of "
            "the flying aircraft needs a maneuver that was flown (ground records are compared as "
            "mini-GVT)",
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


def default_outputs(
    aircraft: Aircraft, recorded: Iterable[str], *, separated: bool = False
) -> tuple[str, ...]:
    """What a longitudinal model can use: sensors of the symmetric motion, and symmetric parts.

    Parameters
    ----------
    aircraft, recorded
        Whose sensors, and which of them were recorded.
    separated
        Only what lateral motion leaves alone, for maneuvers that excite it too.
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
        if (terms := parts_of(c, sensors)) is not None
        and all(sensor.name in recorded and is_pitch_sensor(sensor) for sensor, _ in terms)
        and part_of(terms) != "antisymmetric"
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
    """Everything known about the maneuver but the derivatives.

    Raises
    ------
    BadInput
        If a sensor's point has no mode shape in the table, or an input or output belongs
        to the lateral motion.
    """
    require_symmetric_inputs(aircraft, inputs)
    flight = flight_condition(aircraft, condition)
    polynomials = []
    for output in outputs:
        total = np.zeros((4, 2 + len(modes.numbers)))
        require_symmetric_part(output.name, output.terms)
        for sensor, weight in output.terms:
            require_pitch_sensor(sensor)
            total += weight * _sensor_row(sensor, flight, modes)
        polynomials.append(total)
    sensors = rows.stack_rows([output.name for output in outputs], polynomials)
    return AeroelasticModel(flight, modes, inputs, sensors)


def output_instrument(aircraft: Aircraft, output: OutputDefinition) -> Instrument:
    """Instrument of an output."""
    return _instrument(aircraft, output.terms[0][0].instrument)


def input_correction(aircraft: Aircraft, surface: str, omega: np.ndarray) -> np.ndarray:
    """Factor from the recorded signal of a surface to its true deflection."""
    for candidate in aircraft.surfaces:
        if candidate.name == surface:
            recorded = _instrument(aircraft, candidate.instrument).response(omega)
            driven = _instrument(aircraft, candidate.actuator).response(omega)
            return driven / recorded
    raise BadInput(
        f"'{surface}' is not a surface of {aircraft.name}; surfaces are "
        f"{', '.join(s.name for s in aircraft.surfaces)}",
        code="unknown-input",
        input=surface,
    )


def servo_of(aircraft: Aircraft, surface: str) -> Instrument:
    """What lies between the command of a surface and its deflection.

    Raises
    ------
    BadInput
        If the aircraft does not describe it.
    """
    for candidate in aircraft.surfaces:
        if candidate.name == surface and candidate.servo is not None:
            return _instrument(aircraft, candidate.servo)
    raise BadInput(
        f"{aircraft.name} has no servo for '{surface}'; describe what lies between its command "
        "and its deflection",
        code="no-servo",
        input=surface,
    )


def _instrument(aircraft: Aircraft, name: str | None) -> Instrument:
    if name is None:
        return _NO_INSTRUMENT
    if name not in aircraft.instruments:
        raise BadInput(
            f"{aircraft.name} has no instrument '{name}'", code="unknown-instrument", name=name
        )
    return aircraft.instruments[name]


def _sensor_row(sensor: Sensor, flight: FlightCondition, modes: StructuralModes) -> np.ndarray:
    if sensor.kind is SensorKind.STRAIN:
        return rows.strain_row(modes.strain[_place(sensor, modes.gauges, modes)])
    place = _place(sensor, modes.points, modes)
    translation, rotation = modes.translation[place], modes.rotation[place]
    position = rows.body_axes(sensor.location_m, flight)
    if sensor.kind is SensorKind.GYRO:
        return rows.gyro_row(rotation)
    if sensor.kind is SensorKind.ATTITUDE:
        return rows.attitude_row(rotation)
    if sensor.kind is SensorKind.VANE:
        return rows.vane_row(position, translation, rotation, flight)
    return rows.accelerometer_row(sensor.axis, position, translation, rotation, flight)


def _place(sensor: Sensor, known: tuple[str, ...], modes: StructuralModes) -> int:
    if sensor.point not in known:
        raise BadInput(
            f"the modal table has no shape at '{sensor.point}', where {sensor.name} sits; leave "
            f"{sensor.name} out or import shapes there (the table has "
            f"{', '.join(known) or 'none'})",
            code="no-shape-at-sensor",
            sensor=sensor.name,
            point=sensor.point,
        )
    return known.index(sensor.point)
