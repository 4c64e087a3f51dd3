"""The ``[aircraft]`` part of a mapping: a name, or a whole definition."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from math import pi

from flexsid.importers.quantity import refuse
from flexsid.importers.table import MappingTable
from flexsid.records.aircraft import (
    Aircraft,
    Combination,
    DragPolar,
    FlutterTable,
    Geometry,
    MassTable,
    Sensor,
    SensorKind,
    Surface,
    SurfaceSymmetry,
    ThrustTable,
)
from flexsid.records.axes import PITCH_AXIS, find_axis_in_name, find_contradicting_axis
from flexsid.sysid.model.instruments import (
    Butterworth,
    Element,
    FirstOrder,
    Instrument,
    SecondOrder,
)
from flexsid.sysid.preparation.symmetry import combine_pair, find_pairs, mirror_sign


@dataclass(frozen=True, slots=True, kw_only=True)
class AircraftPart:
    """Aircraft of the maneuver; ``definition`` is set if the mapping defines it.

    ``builtin`` marks an aircraft that is part of the workbench.
    """

    name: str
    builtin: bool = False
    definition: Aircraft | None = None


def read_aircraft(table: MappingTable) -> AircraftPart:
    """Read ``name``, ``builtin``, or ``name`` with geometry, mass, surfaces and sensors."""
    if "builtin" in table:
        part = AircraftPart(name=table.text("builtin"), builtin=True)
    elif "geometry" in table:
        definition = _definition(table)
        part = AircraftPart(name=definition.name, definition=definition)
    else:
        part = AircraftPart(name=table.label("name"))
    table.close()
    return part


def _definition(table: MappingTable) -> Aircraft:
    instruments = _instruments(table)
    sensors = tuple(_sensor(row, instruments) for row in table.tables("sensors"))
    aircraft = Aircraft(
        name=table.label("name"),
        description=table.note("description"),
        geometry=_geometry(table.table("geometry")),
        mass=_mass(table.table("mass")),
        surfaces=tuple(_surface(row, instruments) for row in table.tables("surfaces")),
        sensors=sensors,
        combinations=(*_pairs(table, sensors), *map(_combination, table.tables("combinations"))),
        instruments=instruments,
        polar=_polar(table.table("polar")) if "polar" in table else None,
        flutter=_flutter(table.table("flutter")) if "flutter" in table else None,
        thrust=_thrust(table.table("thrust")) if "thrust" in table else None,
    )
    if not aircraft.surfaces:
        raise refuse(table.path("surfaces"), "is missing; expected at least one surface.")
    names = [item.name for item in (*aircraft.surfaces, *aircraft.sensors, *aircraft.combinations)]
    for name in names:
        if names.count(name) > 1:
            raise refuse(table.path("sensors"), f"use the name '{name}' twice.")
    return aircraft


def _geometry(table: MappingTable) -> Geometry:
    geometry = Geometry(
        area_m2=table.si_scalar("area", "area"),
        chord_m=table.si_scalar("chord", "length"),
        span_m=table.si_scalar("span", "length"),
    )
    table.close()
    if min(geometry.area_m2, geometry.chord_m, geometry.span_m) <= 0:
        raise refuse(table.path("area"), "and the lengths must be positive.")
    return geometry


def _mass(table: MappingTable) -> MassTable:
    fuel = table.numbers("fuel")
    mass = MassTable(
        fuel=fuel,
        mass_kg=table.si("mass", "mass"),
        pitch_inertia_kg_m2=table.si("pitch_inertia", "inertia"),
        x_cg_m=table.si("x_cg", "length"),
        z_cg_m=table.si("z_cg", "length") if "z_cg" in table else (0.0,) * len(fuel),
    )
    table.close()
    columns = (mass.mass_kg, mass.pitch_inertia_kg_m2, mass.x_cg_m, mass.z_cg_m)
    if not fuel or any(len(column) != len(fuel) for column in columns):
        raise refuse(
            table.path("fuel"), "and the mass properties must have the same number of values."
        )
    if any(later <= earlier for earlier, later in pairwise(fuel)):
        raise refuse(table.path("fuel"), "must increase.")
    if min(mass.mass_kg) <= 0 or min(mass.pitch_inertia_kg_m2) <= 0:
        raise refuse(table.path("mass"), "and the inertia must be positive.")
    return mass


def _surface(table: MappingTable, instruments: dict[str, Instrument]) -> Surface:
    surface = Surface(
        name=table.label("name"),
        instrument=_instrument_name(table, "instrument", instruments),
        actuator=_instrument_name(table, "actuator", instruments),
        servo=_instrument_name(table, "servo", instruments),
        noise_std_rad=table.si_scalar("noise_std", "angle") if "noise_std" in table else None,
        symmetry=_symmetry(table),
    )
    table.close()
    return surface


def _symmetry(table: MappingTable) -> SurfaceSymmetry | None:
    if "symmetry" not in table:
        return None
    choices: tuple[SurfaceSymmetry, ...] = ("symmetric", "antisymmetric", "single")
    found = table.choice("symmetry", choices)
    return next(choice for choice in choices if choice == found)


def _sensor(table: MappingTable, instruments: dict[str, Instrument]) -> Sensor:
    name = table.label("name")
    kind = SensorKind(table.choice("kind", tuple(kind.value for kind in SensorKind)))
    location = table.si("location", "length") if "location" in table else (0.0, 0.0, 0.0)
    if len(location) != 3:
        raise refuse(table.path("location"), "must be the three coordinates x aft, y right, z up.")
    usual = "z" if kind is SensorKind.ACCELEROMETER else PITCH_AXIS
    sensor = Sensor(
        name=name,
        kind=kind,
        point=table.text("point", name),
        axis=table.choice("axis", ("x", "y", "z"), find_axis_in_name(kind, name) or usual),
        location_m=(location[0], location[1], location[2]),
        instrument=_instrument_name(table, "instrument", instruments),
        noise_std=table.optional_number("noise_std"),
    )
    table.close()
    if (named := find_contradicting_axis(sensor)) is not None:
        raise refuse(
            table.path("axis"),
            f"is '{sensor.axis}', but a {kind.value} called '{name}' measures along or about "
            f"{named}; correct the axis, or give the sensor another name.",
        )
    return sensor


def _instrument_name(
    table: MappingTable, key: str, instruments: dict[str, Instrument]
) -> str | None:
    name = table.optional_text(key)
    if name is not None and name not in instruments:
        known = ", ".join(instruments) or "none"
        raise refuse(
            table.path(key), f"names '{name}', which is not an instrument; defined: {known}."
        )
    return name


def _pairs(table: MappingTable, sensors: tuple[Sensor, ...]) -> tuple[Combination, ...]:
    """Return the symmetric or antisymmetric parts, as ``pairs`` requests, of left-right pairs."""
    requested = table.texts("pairs") if "pairs" in table else ()
    known = {sensor.name: sensor for sensor in sensors}
    found: list[Combination] = []
    for part in requested:
        if part not in ("symmetric", "antisymmetric"):
            raise refuse(
                table.path("pairs"), f"may hold 'symmetric' and 'antisymmetric', found '{part}'."
            )
        for left, right, both in find_pairs(known):
            one, other = known[left], known[right]
            if (one.kind, one.axis, one.instrument) != (other.kind, other.axis, other.instrument):
                continue
            sign = mirror_sign(one.kind.value, one.axis)
            name, terms = combine_pair(left, right, both, sign, part)
            found.append(Combination(name=name, terms=terms))
    return tuple(found)


def _combination(table: MappingTable) -> Combination:
    weights = table.table("terms")
    combination = Combination(
        name=table.label("name"),
        terms=tuple((channel, weights.number(channel)) for channel in weights.names()),
    )
    table.close()
    return combination


def _instruments(table: MappingTable) -> dict[str, Instrument]:
    if "instruments" not in table:
        return {}
    rows = table.table("instruments")
    return {name: _instrument(rows.table(name)) for name in rows.names()}


def _instrument(table: MappingTable) -> Instrument:
    instrument = Instrument(
        elements=tuple(_element(row) for row in table.tables("elements")),
        delay_s=table.si_scalar("delay", "time") if "delay" in table else 0.0,
    )
    table.close()
    return instrument


def _element(table: MappingTable) -> Element:
    kind = table.choice("type", ("first-order", "second-order", "butterworth"))
    element: Element
    if kind == "first-order":
        element = FirstOrder(corner=_angular(table, "corner"))
    elif kind == "second-order":
        element = SecondOrder(
            natural_frequency=_angular(table, "natural_frequency"),
            damping=table.number("damping"),
        )
    else:
        element = Butterworth(order=table.integer("order"), corner=_angular(table, "corner"))
    table.close()
    return element


def _angular(table: MappingTable, key: str) -> float:
    if table.table(key).text("unit") == "Hz":
        return 2.0 * pi * table.si_scalar(key, "frequency")
    return table.si_scalar(key, "angular rate")


def _polar(table: MappingTable) -> DragPolar:
    polar = DragPolar(
        cd_min=table.number("cd_min"),
        oswald=table.number("oswald"),
        aspect_ratio=table.number("aspect_ratio"),
        lift_slope=table.number("lift_slope"),
    )
    table.close()
    return polar


def _flutter(table: MappingTable) -> FlutterTable:
    flutter = FlutterTable(fuel=table.numbers("fuel"), speed_m_s=table.si("speed", "speed"))
    table.close()
    if len(flutter.fuel) != len(flutter.speed_m_s) or not flutter.fuel:
        raise refuse(table.path("fuel"), "and speed must have the same number of values.")
    return flutter


def _thrust(table: MappingTable) -> ThrustTable:
    """Read the thrust table of one engine, one row per rotation speed."""
    speeds = table.si("engine_speed", "angular rate")
    temperatures = (
        table.si("total_temperature", "temperature") if "total_temperature" in table else (288.15,)
    )
    values = table.si("thrust", "force")
    if len(values) != len(speeds) * len(temperatures) or len(speeds) < 2:
        raise refuse(
            table.path("thrust"),
            f"must have {len(speeds)} x {len(temperatures)} values, a row of temperatures for each "
            "of two engine speeds or more.",
        )
    if any(b <= a for axis in (speeds, temperatures) for a, b in pairwise(axis)):
        raise refuse(table.path("engine_speed"), "and total_temperature must increase.")
    found = ThrustTable(
        engines=table.texts("engines"),
        engine_speed_rad_s=speeds,
        total_temperature_k=temperatures,
        thrust_n=tuple(
            values[k : k + len(temperatures)] for k in range(0, len(values), len(temperatures))
        ),
        source=table.note("source"),
    )
    table.close()
    if not found.engines or len(set(found.engines)) < len(found.engines):
        raise refuse(table.path("engines"), "must name a channel for each engine, none twice.")
    return found
