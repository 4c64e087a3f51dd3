"""Aeroelastic model of one maneuver from the aircraft record and the condition."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from jaxtyping import Float

from flexsid.errors import BadInput
from flexsid.records.aircraft import Aircraft, Sensor
from flexsid.records.decision import Structure
from flexsid.records.maneuver import Condition
from flexsid.sysid.model import rigid_body as rows
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.condition import FlightCondition
from flexsid.sysid.model.longitudinal import LONGITUDINAL
from flexsid.sysid.model.rigid_body import RigidBody
from flexsid.sysid.model.sensor_models import ACCELEROMETER, Instrument, SensorModel
from flexsid.sysid.modes import StructuralModes
from flexsid.workflow.aircraft.axes import (
    classify_part,
    find_other,
    is_axis_sensor,
    reads_own_motion_only,
    require_axis_inputs,
    require_axis_output,
)

_NO_INSTRUMENT = Instrument()


@dataclass(frozen=True, slots=True)
class OutputDefinition:
    """An output as a weighted sum of sensors of one kind."""

    name: str
    kind: str
    terms: tuple[tuple[Sensor, float], ...]

    @property
    def model(self) -> SensorModel:
        """The model of its sensors."""
        return self.terms[0][0].model


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
        span=aircraft.geometry.span_m,
        roll_inertia=condition.roll_inertia_kg_m2 or 0.0,
        yaw_inertia=condition.yaw_inertia_kg_m2 or 0.0,
        product_of_inertia=condition.product_of_inertia_kg_m2 or 0.0,
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
    aircraft: Aircraft,
    recorded: Iterable[str],
    body: RigidBody = LONGITUDINAL,
    *,
    separated: bool = False,
) -> tuple[str, ...]:
    """List the default outputs of a model: sensors and parts of pairs that measure its motion.

    Parameters
    ----------
    aircraft, recorded
        Aircraft, and the names of its recorded channels.
    separated
        Only outputs without motion of the other axis, for maneuvers that also excite it.
    """
    recorded = set(recorded)
    sensors = {sensor.name: sensor for sensor in aircraft.sensors}
    combined = {part for c in aircraft.combinations for part, _ in c.terms}
    usable = {n for n, s in sensors.items() if n in recorded and is_axis_sensor(s, body)}
    single = {
        sensor.name: ((sensor, 1.0),)
        for sensor in aircraft.sensors
        if sensor.name in usable
        and sensor.name not in combined
        and not _measures_other_motion(sensor, body)
    }
    paired = {
        c.name: tuple((sensors[name], weight) for name, weight in c.terms)
        for c in aircraft.combinations
        if usable.issuperset(name for name, _ in c.terms)
    }
    other = find_other(body).symmetry
    outputs = single | {n: t for n, t in paired.items() if classify_part(t) != other}
    return tuple(n for n, t in outputs.items() if not separated or reads_own_motion_only(t, body))


def _measures_other_motion(sensor: Sensor, body: RigidBody) -> bool:
    """Whether a single accelerometer measures mostly, or only, the motion of the other axis."""
    if sensor.kind != ACCELEROMETER.kind:
        return False
    if ACCELEROMETER.measures_rigid_body(sensor.axis, body):
        return False
    return body.symmetry == "symmetric" or reads_own_motion_only(((sensor, 1.0),), find_other(body))


def build_model(
    aircraft: Aircraft,
    condition: Condition,
    modes: StructuralModes,
    inputs: tuple[str, ...],
    outputs: tuple[OutputDefinition, ...],
    body: RigidBody = LONGITUDINAL,
) -> AeroelasticModel:
    """Build the aeroelastic model of a maneuver without its derivatives.

    Raises
    ------
    BadInput
        If a sensor's point has no mode shape in the table, or an input or output belongs
        to the lateral motion.
    """
    require_axis_inputs(aircraft, inputs, body)
    flight = build_flight_condition(aircraft, condition)
    polynomials = []
    for output in outputs:
        total = np.zeros((4, body.size + len(modes.numbers)))
        require_axis_output(output.name, output.terms, body)
        for sensor, weight in output.terms:
            total += weight * _build_sensor_row(sensor, flight, modes, body)
        polynomials.append(total)
    sensors = rows.stack_rows([output.name for output in outputs], polynomials)
    return AeroelasticModel(flight, modes, inputs, sensors, body)


def compute_shape_sizes(
    aircraft: Aircraft,
    condition: Condition,
    modes: StructuralModes,
    outputs: tuple[OutputDefinition, ...],
    body: RigidBody = LONGITUDINAL,
) -> Float[np.ndarray, "4 n_y n_modes"]:
    """Compute the sensor equations for shapes of their root mean square at every point.

    That of each component of translation and rotation over the points of the table, and of strain
    over the gauges; the coefficients of 1/s, 1, s and s2 are the roots of their sums of squares.
    """
    translation, rotation, strain = (
        np.sqrt(np.sum(shape**2, axis=0) / max(len(shape), 1))
        for shape in (modes.translation, modes.rotation, modes.strain)
    )
    empty = replace(
        modes,
        translation=np.zeros_like(modes.translation),
        rotation=np.zeros_like(modes.rotation),
        strain=np.zeros_like(modes.strain),
    )
    parts = [replace(empty, strain=empty.strain + strain)]
    for component in range(3):
        for name, size in (("translation", translation), ("rotation", rotation)):
            shape = np.zeros_like(modes.translation)
            shape[:, component] = size[component]
            moved: dict[str, Any] = {name: shape}
            parts.append(replace(empty, **moved))
    flight = build_flight_condition(aircraft, condition)
    sizes = np.zeros((len(parts), 4, len(outputs), len(modes.numbers)))
    for own, one in zip(sizes, parts, strict=True):
        for column, output in enumerate(outputs):
            for sensor, weight in output.terms:  # errors of both sides may be equal
                row = _build_sensor_row(sensor, flight, one, body)[:, body.size :]
                own[:, column] += np.abs(weight * row)
    return np.sqrt(np.sum(sizes**2, axis=0))


def get_output_instrument(aircraft: Aircraft, output: OutputDefinition) -> Instrument:
    """Return the instrument of an output."""
    return _get_instrument(aircraft, output.terms[0][0].instrument)


def compute_input_correction(aircraft: Aircraft, surface: str, omega: np.ndarray) -> np.ndarray:
    """Compute the response from the recorded signal of a surface to its true deflection."""
    return compute_input_corrections(aircraft, (surface,), omega)[:, 0]


def compute_input_corrections(
    aircraft: Aircraft, surfaces: Sequence[str], omega: np.ndarray
) -> np.ndarray:
    """Compute the corrections of several surfaces, (n_omega, n_u); equal ones are computed once.

    Raises
    ------
    BadInput
        If a name is not that of a surface.
    """
    chains = [_find_input_instruments(aircraft, surface) for surface in surfaces]
    known = {
        (recorded, driven): driven.response(omega) / recorded.response(omega)
        for recorded, driven in dict.fromkeys(chains)
    }
    return np.stack([known[chain] for chain in chains], axis=1)


def _find_input_instruments(aircraft: Aircraft, surface: str) -> tuple[Instrument, Instrument]:
    """Return the instrument and the actuator of a surface."""
    for candidate in aircraft.surfaces:
        if candidate.name == surface:
            return (
                _get_instrument(aircraft, candidate.instrument),
                _get_instrument(aircraft, candidate.actuator),
            )
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


def get_recorded_servo(aircraft: Aircraft, surface: str) -> Instrument:
    """Return what lies between the command of a surface and its recording, as far as declared.

    Servo and instrument in sequence; an input that is no surface of the aircraft has none.
    """
    own = next((one for one in aircraft.surfaces if one.name == surface), None)
    names = () if own is None else (own.servo, own.instrument)
    chain = [_get_instrument(aircraft, name) for name in names]
    return Instrument(
        elements=tuple(element for one in chain for element in one.elements),
        delay_s=sum(one.delay_s for one in chain),
    )


def _get_instrument(aircraft: Aircraft, name: str | None) -> Instrument:
    if name is None:
        return _NO_INSTRUMENT
    if name not in aircraft.instruments:
        raise BadInput(
            f"{aircraft.name} has no instrument '{name}'; instruments are "
            f"{', '.join(aircraft.instruments) or 'none'}",
            code="unknown-instrument",
            instrument=name,
        )
    return aircraft.instruments[name]


def _build_sensor_row(
    sensor: Sensor, flight: FlightCondition, modes: StructuralModes, body: RigidBody
) -> np.ndarray:
    n_modes = len(modes.numbers)
    translation = rotation = np.zeros((3, n_modes))
    strain = np.zeros(n_modes)
    if sensor.model.senses == "strain":
        strain = modes.strain[_find_shape_index(sensor, modes.gauges, modes)]
    elif modes.numbers:  # a rigid aircraft needs no mode shapes
        index = _find_shape_index(sensor, modes.points, modes)
        translation, rotation = modes.translation[index], modes.rotation[index]
    position = rows.body_axes(sensor.location_m, flight)
    at = rows.Mounting(position, translation, rotation, strain)
    return sensor.model.build_row(sensor.axis, body, at, flight)


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


def _resolve_channels(aircraft: Aircraft, name: str) -> tuple[str, ...]:
    """Resolve a channel to sensors and surfaces; a combination resolves to its sensors."""
    for combination in aircraft.combinations:
        if combination.name == name:
            return tuple(part for part, _ in combination.terms)
    known = [*(s.name for s in aircraft.sensors), *(s.name for s in aircraft.surfaces)]
    if name not in known:
        raise BadInput(
            f"'{name}' is neither sensor nor surface of {aircraft.name}; it has {', '.join(known)}",
            code="unknown-channel",
            channel=name,
        )
    return (name,)


def insert_instruments(aircraft: Aircraft, structure: Structure) -> Aircraft:
    """Return the aircraft with the instruments and delays of the model structure.

    Raises
    ------
    BadInput
        If a channel or an instrument is unknown.
    """
    if not structure.instruments and not structure.delays:
        return aircraft
    overrides = {
        part: instrument
        for name, instrument in structure.instruments.items()
        for part in _resolve_channels(aircraft, name)
    }
    delays = {
        part: delay
        for name, delay in structure.delays.items()
        for part in _resolve_channels(aircraft, name)
    }
    instruments = dict(aircraft.instruments)

    def select_instrument(channel: str, usual: str | None) -> str | None:
        name = overrides.get(channel, usual)
        plain, delay = _get_instrument(aircraft, name), delays.get(channel, 0.0)
        if delay == 0.0:
            return name
        delayed = f"{name or 'direct'} and {delay:g} s"
        instruments[delayed] = replace(plain, delay_s=plain.delay_s + delay)
        return delayed

    sensors, surfaces = (
        tuple(replace(one, instrument=select_instrument(one.name, one.instrument)) for one in some)
        for some in (aircraft.sensors, aircraft.surfaces)
    )
    # pyrefly: ignore[bad-argument-type]
    return replace(aircraft, sensors=sensors, surfaces=surfaces, instruments=instruments)
