"""The ``[aircraft]`` part of a mapping: a name, or a whole definition."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from itertools import pairwise
from math import sqrt
from typing import Annotated, Literal

from pydantic import Field

from flexsid.errors import BadInput
from flexsid.importers.quantity import Dimension
from flexsid.importers.record_table import table_of
from flexsid.importers.table import (
    FromTable,
    Integer,
    InvalidValue,
    Line,
    MappingTable,
    Number,
    Text,
    key,
)
from flexsid.records.aircraft import (
    Aircraft,
    Combination,
    DragPolar,
    FlutterTable,
    Geometry,
    MassTable,
    Sensor,
    Surface,
    ThrustTable,
    find_contradicting_axis,
)
from flexsid.sysid.model.sensor_models import (
    Butterworth,
    Element,
    FirstOrder,
    Instrument,
    SecondOrder,
    find_sensor_model,
)
from flexsid.sysid.preparation.resampling import Part, combine_pair, find_pairs

# Limits follow the dimension: pydantic applies annotations in order, options of a key first.
_Frequency = Annotated[float, Dimension("angular rate", "frequency"), Field(gt=0)]
_Delay = Annotated[float, Dimension("time"), Field(ge=0)]
_Lengths = Annotated[tuple[float, ...], Dimension("length")]
_Inertias = Annotated[tuple[float, ...], Dimension("inertia")]
_Forces = Annotated[tuple[float, ...], Dimension("force")]
_Temperatures = Annotated[tuple[float, ...], Dimension("temperature")]
_LARGEST_ORDER = 20  # of a filter: above, rounding decides its response in double precision
_ELEMENTS: dict[str, type[Element]] = {
    "first-order": FirstOrder,
    "second-order": SecondOrder,
    "butterworth": Butterworth,
}


@dataclass(frozen=True, slots=True, kw_only=True)
class AircraftPart:
    """Aircraft of the maneuver; ``definition`` is set if the mapping defines it.

    ``builtin`` marks an aircraft that is part of the workbench.
    """

    name: str
    builtin: bool = False
    definition: Aircraft | None = None


@table_of(Geometry)
class GeometryMapping(MappingTable):
    """``[aircraft.geometry]``: reference dimensions of the wing."""


@table_of(MassTable, optional=("z_cg_m",))
class MassMapping(MappingTable):
    """``[aircraft.mass]``: mass properties against fuel fraction."""

    inertia_tensor_xz: _Inertias | None = key(
        "element xz of the inertia tensor: minus the product of inertia", None
    )

    def build(self) -> MassTable:
        """Return the mass properties in SI."""
        columns = self.entries()
        columns["z_cg_m"] = columns["z_cg_m"] or (0.0,) * len(columns["fuel"])
        tensor = columns.pop("inertia_tensor_xz")
        if tensor is not None:
            if columns["product_of_inertia_kg_m2"] is not None:
                problem = "or inertia_tensor_xz must be given, but not both."
                raise InvalidValue(problem, "product_of_inertia")
            columns["product_of_inertia_kg_m2"] = tuple(-value for value in tensor)
        given = [column for column in columns.values() if isinstance(column, tuple)]
        mass = MassTable(**columns)
        if not mass.fuel or len({len(column) for column in given}) > 1:
            problem = "and the mass properties must have the same number of values."
            raise InvalidValue(problem, "fuel")
        _check_fuel(mass.fuel)
        for inertia in (mass.pitch_inertia_kg_m2, mass.roll_inertia_kg_m2, mass.yaw_inertia_kg_m2):
            if min(mass.mass_kg) <= 0 or (inertia is not None and min(inertia) <= 0):
                raise InvalidValue("and the inertia must be positive.", "mass")
        return mass


@table_of(Surface)
class SurfaceMapping(MappingTable):
    """``[[aircraft.surfaces]]``: a control surface, or a pair moved as one."""


@table_of(Sensor, optional=("point",))
class SensorMapping(MappingTable):
    """``[[aircraft.sensors]]``: kind, location and instrument of a sensor."""

    axis: Literal["x", "y", "z"] | None = key("axis; else from the name", None)

    def build(self) -> Sensor:
        """Return the sensor with its axis."""
        entries = self.entries()
        name, kind = entries["name"], entries["kind"]
        if len(entries["location_m"]) != 3:
            problem = "must be the three coordinates x aft, y right, z up."
            raise InvalidValue(problem, "location")
        try:
            model = find_sensor_model(kind)
        except BadInput as error:
            raise InvalidValue(f"is not known: {error.message}.", "kind") from error
        entries["point"] = entries["point"] or name
        entries["axis"] = self.axis or model.find_axis(name) or model.usual_axis
        sensor = Sensor(**entries)
        if (named := find_contradicting_axis(sensor)) is not None:
            problem = (
                f"is '{sensor.axis}', but a {kind} called '{name}' measures along "
                f"or about {named}; correct the axis, or give the sensor another name."
            )
            raise InvalidValue(problem, "axis")
        return sensor


@table_of(Combination)
class CombinationMapping(MappingTable):
    """``[[aircraft.combinations]]``: a weighted sum of channels."""

    terms: dict[Line, Number] = key("the weights of the channels by name")

    def build(self) -> Combination:
        """Return the sum."""
        return Combination(**self.entries() | {"terms": tuple(self.terms.items())})


class ElementMapping(MappingTable):
    """An element of an instrument."""

    type: Literal["first-order", "second-order", "butterworth"] = key("the kind of element")
    corner: _Frequency | None = key("corner frequency of a lag or filter", None)
    natural_frequency: _Frequency | None = key("of a second-order element", None)
    damping: Number | None = key("damping ratio of a second-order element", None, gt=0)
    order: Integer | None = key("order of a Butterworth filter", None, ge=1, le=_LARGEST_ORDER)

    def build(self) -> Element:
        """Return the element in SI."""
        given = {k: v for k, v in self.entries().items() if k != "type" and v is not None}
        element = _ELEMENTS[self.type]
        needed = [field.name for field in fields(element)]
        for name in set(needed) ^ set(given):
            problem = "is not a key" if name in given else "is missing"
            problem = f"{problem}; a {self.type} element has {' and '.join(needed)}."
            raise InvalidValue(problem, name)
        return element(**given)


_Element = Annotated[Element, FromTable(ElementMapping)]


@table_of(Instrument)
class InstrumentMapping(MappingTable):
    """``[aircraft.instruments.<name>]``: dynamics and delay between a quantity and its samples."""

    elements: tuple[_Element, ...] = key("filters in series", ())
    delay_s: _Delay = key("the transport delay", 0.0, alias="delay")


@table_of(DragPolar)
class PolarMapping(MappingTable):
    """``[aircraft.polar]``: a parabolic polar."""


@table_of(FlutterTable)
class FlutterMapping(MappingTable):
    """``[aircraft.flutter]``: predicted open-loop flutter speed against fuel fraction."""

    def build(self) -> FlutterTable:
        """Return the speeds in SI."""
        table = FlutterTable(**self.entries())
        if len(table.fuel) != len(table.speed_m_s) or not table.fuel:
            raise InvalidValue("and speed must have the same number of values.", "fuel")
        _check_fuel(table.fuel)
        if min(table.speed_m_s) <= 0:
            raise InvalidValue("must be positive.", "speed")
        return table


@table_of(ThrustTable)
class ThrustMapping(MappingTable):
    """``[aircraft.thrust]``: thrust of one engine, a row per rotation speed."""

    total_temperature_k: _Temperatures = key(
        "total temperatures, increasing", (288.15,), alias="total_temperature"
    )
    thrust_n: _Forces = key(
        "the thrust at each rotation speed and temperature, row by row", alias="thrust"
    )

    def build(self) -> ThrustTable:
        """Return the table in SI."""
        n_temperatures = len(self.total_temperature_k)
        rows = range(0, len(self.thrust_n), max(n_temperatures, 1))
        by_row = tuple(self.thrust_n[row : row + n_temperatures] for row in rows)
        table = ThrustTable(**self.entries() | {"thrust_n": by_row})
        n_speeds = len(table.engine_speed_rad_s)
        if len(self.thrust_n) != n_speeds * n_temperatures or n_speeds < 2:
            problem = (
                f"must have {n_speeds} x {n_temperatures} values, a row of temperatures for each "
                "of two engine speeds or more."
            )
            raise InvalidValue(problem, "thrust")
        if not (_increases(table.engine_speed_rad_s) and _increases(table.total_temperature_k)):
            raise InvalidValue("and total_temperature must increase.", "engine_speed")
        if not table.engines or len(set(table.engines)) < len(table.engines):
            raise InvalidValue("must name a channel for each engine, none twice.", "engines")
        return table


@table_of(
    Aircraft,
    without=("id",),
    optional=("name", "geometry", "mass", "surfaces", "sensors", "instruments"),
)
class AircraftMapping(MappingTable):
    """``[aircraft]``: the name of an aircraft, or its definition."""

    builtin: Text | None = key("name of an aircraft of the workbench", None)
    pairs: tuple[Part, ...] = key("parts to form of sensors and surfaces on the left and right", ())

    def build(self) -> AircraftPart:
        """Return the name, with the definition if the mapping has one."""
        entries = self.entries()
        builtin, pairs, name = entries.pop("builtin"), entries.pop("pairs"), entries["name"]
        more = self.model_fields_set - {"name", "builtin", "proposed"}
        if builtin is not None and (more or name is not None):
            raise InvalidValue("is given, so that other keys do not apply.", "builtin")
        if builtin is not None:
            return AircraftPart(name=builtin, builtin=True)
        if name is None:
            raise InvalidValue("is missing; expected the name of the aircraft.", "name")
        if not more:
            return AircraftPart(name=name)
        for table in ("geometry", "mass", "surfaces"):
            if not entries[table]:
                problem = "is missing; a definition has geometry, mass and at least one surface."
                raise InvalidValue(problem, table)
        aircraft = Aircraft(**entries)
        _check_names(aircraft)
        sums = _combine_pairs(pairs, aircraft.sensors)
        surfaces, parts = _combine_surfaces(pairs, aircraft.surfaces)
        definition = replace(
            aircraft,
            surfaces=(*aircraft.surfaces, *surfaces),
            combinations=(*sums, *parts, *aircraft.combinations),
        )
        return AircraftPart(name=name, definition=definition)


def _check_names(aircraft: Aircraft) -> None:
    """Reject a name that is used twice, and an instrument that is not defined."""
    everything = (*aircraft.surfaces, *aircraft.sensors, *aircraft.combinations)
    names = [item.name for item in everything]
    for name in names:
        if names.count(name) > 1:
            raise InvalidValue(f"use the name '{name}' twice.", "sensors")
    known = ", ".join(aircraft.instruments) or "none"
    for table, items in (("surfaces", aircraft.surfaces), ("sensors", aircraft.sensors)):
        for place, item in enumerate(items, start=1):
            for role in ("instrument", "actuator", "servo"):
                name = getattr(item, role, None)
                if name is not None and name not in aircraft.instruments:
                    problem = f"names '{name}', which is not an instrument; defined: {known}."
                    raise InvalidValue(problem, f"{table}[{place}].{role}")


def _check_fuel(fuel: tuple[float, ...]) -> None:
    if not (_increases(fuel) and fuel[0] >= 0.0 and fuel[-1] <= 1.0):
        raise InvalidValue("must increase, from 0 at the least to 1 at the most.", "fuel")


def _increases(values: tuple[float, ...]) -> bool:
    return all(earlier < later for earlier, later in pairwise(values))


def _combine_pairs(parts: tuple[Part, ...], sensors: tuple[Sensor, ...]) -> list[Combination]:
    """Return the symmetric or antisymmetric parts of pairs of sensors on the left and right."""
    known = {sensor.name: sensor for sensor in sensors}
    found: list[Combination] = []
    for part in parts:
        for left, right, both in find_pairs(known):
            one, other = known[left], known[right]
            if (one.kind, one.axis, one.instrument) == (other.kind, other.axis, other.instrument):
                sign = one.model.mirror_sign(one.axis)
                name, terms = combine_pair(left, right, both, sign, part)
                found.append(Combination(name=name, terms=terms))
    return found


def _combine_surfaces(
    parts: tuple[Part, ...], surfaces: tuple[Surface, ...]
) -> tuple[list[Surface], list[Combination]]:
    """Return parts of left and right surfaces as surfaces, and how they combine them.

    Sides with different instruments have no part; a part that is defined already stays as it is.
    The noise of half a sum or difference is that of one surface over the root of two.
    """
    known = {surface.name: surface for surface in surfaces}
    found: list[Surface] = []
    combined: list[Combination] = []
    for part in parts:
        for left, right, both in find_pairs(known):
            one, other = known[left], replace(known[right], name=left)
            name, terms = combine_pair(left, right, both, 1.0, part)
            if one == other:
                combined.append(Combination(name=name, terms=terms))
                if name not in known:
                    noise = None if one.noise_std_rad is None else one.noise_std_rad / sqrt(2.0)
                    found.append(replace(one, name=name, noise_std_rad=noise, symmetry=part))
    return found, combined
