"""The ``[aircraft]`` part of a mapping: a name, or a whole definition."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from itertools import pairwise
from math import sqrt
from typing import Annotated, Literal

from pydantic import Field

from flexsid.errors import BadInput
from flexsid.importers.quantity import Dimension
from flexsid.importers.table import (
    FromTable,
    Integer,
    InvalidValue,
    Line,
    MappingTable,
    Name,
    Note,
    Number,
    Numbers,
    Text,
    Texts,
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
    SurfaceSymmetry,
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
_Area = Annotated[float, Dimension("area"), Field(gt=0)]
_Length = Annotated[float, Dimension("length"), Field(gt=0)]
_Frequency = Annotated[float, Dimension("angular rate", "frequency"), Field(gt=0)]
_Noise = Annotated[float, Dimension("angle"), Field(gt=0)]
_Delay = Annotated[float, Dimension("time"), Field(ge=0)]
_Lengths = Annotated[tuple[float, ...], Dimension("length")]
_Masses = Annotated[tuple[float, ...], Dimension("mass")]
_Inertias = Annotated[tuple[float, ...], Dimension("inertia")]
_Speeds = Annotated[tuple[float, ...], Dimension("speed")]
_Forces = Annotated[tuple[float, ...], Dimension("force")]
_AngularRates = Annotated[tuple[float, ...], Dimension("angular rate")]
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


class GeometryMapping(MappingTable):
    """``[aircraft.geometry]``: reference dimensions of the wing."""

    area_m2: _Area = key("the reference area", alias="area")
    chord_m: _Length = key("the reference chord", alias="chord")
    span_m: _Length = key("the reference span", alias="span")


class MassMapping(MappingTable):
    """``[aircraft.mass]``: mass properties against fuel fraction."""

    fuel: Numbers = key("the fuel fractions, increasing")
    mass_kg: _Masses = key("the mass at each fuel fraction", alias="mass")
    pitch_inertia_kg_m2: _Inertias = key("the pitching moment of inertia", alias="pitch_inertia")
    x_cg_m: _Lengths = key("the centre of gravity, positive aft", alias="x_cg")
    z_cg_m: _Lengths | None = key("centre of gravity, positive up; else zero", None, alias="z_cg")
    roll_inertia_kg_m2: _Inertias | None = key("inertia in roll", None, alias="roll_inertia")
    yaw_inertia_kg_m2: _Inertias | None = key("inertia in yaw", None, alias="yaw_inertia")
    product_of_inertia_kg_m2: _Inertias | None = key(
        "the integral of x z dm in body axes", None, alias="product_of_inertia"
    )
    inertia_tensor_xz: _Inertias | None = key(
        "element xz of the inertia tensor: minus the product of inertia", None
    )
    mass_std: Number = key("standard deviation of the mass, relative to it", 0.02, ge=0, le=1)
    inertia_std: Number = key(
        "standard deviation of the moments of inertia, relative to them", 0.02, ge=0, le=1
    )

    def build(self) -> MassTable:
        """Return the mass properties in SI."""
        columns = self.entries()
        columns["z_cg_m"] = self.z_cg_m or (0.0,) * len(self.fuel)
        tensor = columns.pop("inertia_tensor_xz")
        if tensor is not None:
            if self.product_of_inertia_kg_m2 is not None:
                problem = "or inertia_tensor_xz must be given, but not both."
                raise InvalidValue(problem, "product_of_inertia")
            columns["product_of_inertia_kg_m2"] = tuple(-value for value in tensor)
        given = [column for column in columns.values() if isinstance(column, tuple)]
        if not self.fuel or len({len(column) for column in given}) > 1:
            problem = "and the mass properties must have the same number of values."
            raise InvalidValue(problem, "fuel")
        _check_fuel(self.fuel)
        for inertia in (self.pitch_inertia_kg_m2, self.roll_inertia_kg_m2, self.yaw_inertia_kg_m2):
            if min(self.mass_kg) <= 0 or (inertia is not None and min(inertia) <= 0):
                raise InvalidValue("and the inertia must be positive.", "mass")
        return MassTable(**columns)


class SurfaceMapping(MappingTable):
    """``[[aircraft.surfaces]]``: a control surface, or a pair moved as one."""

    name: Name = key("the name of the surface")
    instrument: Text | None = key("instrument from deflection to recording", None)
    actuator: Text | None = key("instrument from recording to deflection", None)
    servo: Text | None = key("instrument from command to deflection", None)
    noise_std_rad: _Noise | None = key("standard deviation of noise", None, alias="noise_std")
    symmetry: SurfaceSymmetry | None = key("symmetry; else from the name", None)


class SensorMapping(MappingTable):
    """``[[aircraft.sensors]]``: kind, location and instrument of a sensor."""

    name: Name = key("the name of the sensor")
    kind: Line = key("the type of sensor")
    point: Text | None = key("row of the modal table; else the name", None)
    axis: Literal["x", "y", "z"] | None = key("axis; else from the name", None)
    location: _Lengths = key("coordinates: x aft, y right, z up", (0.0, 0.0, 0.0))
    instrument: Text | None = key("instrument from quantity to recording", None)
    noise_std: Number | None = key("standard deviation of the noise, in SI", None, gt=0)

    def build(self) -> Sensor:
        """Return the sensor with its axis."""
        if len(self.location) != 3:
            problem = "must be the three coordinates x aft, y right, z up."
            raise InvalidValue(problem, "location")
        try:
            model = find_sensor_model(self.kind)
        except BadInput as error:
            raise InvalidValue(f"is not known: {error.message}.", "kind") from error
        sensor = Sensor(
            name=self.name,
            kind=self.kind,
            point=self.point or self.name,
            axis=self.axis or model.find_axis(self.name) or model.usual_axis,
            location_m=(self.location[0], self.location[1], self.location[2]),
            instrument=self.instrument,
            noise_std=self.noise_std,
        )
        if (named := find_contradicting_axis(sensor)) is not None:
            problem = (
                f"is '{sensor.axis}', but a {self.kind} called '{self.name}' measures along "
                f"or about {named}; correct the axis, or give the sensor another name."
            )
            raise InvalidValue(problem, "axis")
        return sensor


class CombinationMapping(MappingTable):
    """``[[aircraft.combinations]]``: a weighted sum of channels."""

    name: Name = key("the name of the sum")
    terms: dict[Line, Number] = key("the weights of the channels by name")

    def build(self) -> Combination:
        """Return the sum."""
        return Combination(name=self.name, terms=tuple(self.terms.items()))


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


class InstrumentMapping(MappingTable):
    """``[aircraft.instruments.<name>]``: dynamics and delay between a quantity and its samples."""

    elements: tuple[_Element, ...] = key("filters in series", ())
    delay_s: _Delay = key("the transport delay", 0.0, alias="delay")


class PolarMapping(MappingTable):
    """``[aircraft.polar]``: a parabolic polar."""

    cd_min: Number = key("the least drag coefficient", gt=0)
    oswald: Number = key("the Oswald efficiency", gt=0)
    aspect_ratio: Number = key("the aspect ratio", gt=0)
    lift_slope: Number = key("the lift-curve slope, per rad", gt=0)


class FlutterMapping(MappingTable):
    """``[aircraft.flutter]``: predicted open-loop flutter speed against fuel fraction."""

    fuel: Numbers = key("the fuel fractions")
    speed_m_s: _Speeds = key("the flutter speed at each fuel fraction", alias="speed")

    def build(self) -> FlutterTable:
        """Return the speeds in SI."""
        if len(self.fuel) != len(self.speed_m_s) or not self.fuel:
            raise InvalidValue("and speed must have the same number of values.", "fuel")
        _check_fuel(self.fuel)
        if min(self.speed_m_s) <= 0:
            raise InvalidValue("must be positive.", "speed")
        return FlutterTable(**self.entries())


class ThrustMapping(MappingTable):
    """``[aircraft.thrust]``: thrust of one engine, a row per rotation speed."""

    engines: Texts = key("the channels of the rotation speeds, one per engine")
    engine_speed: _AngularRates = key("the rotation speeds, increasing")
    total_temperature: _Temperatures = key("total temperatures, increasing", (288.15,))
    thrust: _Forces = key("the thrust at each rotation speed and temperature, row by row")
    source: Note = key("where the table is from", "")

    def build(self) -> ThrustTable:
        """Return the table in SI."""
        n_speeds, n_temperatures = len(self.engine_speed), len(self.total_temperature)
        if len(self.thrust) != n_speeds * n_temperatures or n_speeds < 2:
            problem = (
                f"must have {n_speeds} x {n_temperatures} values, a row of temperatures for each "
                "of two engine speeds or more."
            )
            raise InvalidValue(problem, "thrust")
        if not (_increases(self.engine_speed) and _increases(self.total_temperature)):
            raise InvalidValue("and total_temperature must increase.", "engine_speed")
        if not self.engines or len(set(self.engines)) < len(self.engines):
            raise InvalidValue("must name a channel for each engine, none twice.", "engines")
        rows = range(0, len(self.thrust), n_temperatures)
        return ThrustTable(
            engines=self.engines,
            engine_speed_rad_s=self.engine_speed,
            total_temperature_k=self.total_temperature,
            thrust_n=tuple(self.thrust[row : row + n_temperatures] for row in rows),
            source=self.source,
        )


_Surface = Annotated[Surface, FromTable(SurfaceMapping)]
_Sensor = Annotated[Sensor, FromTable(SensorMapping)]
_Combination = Annotated[Combination, FromTable(CombinationMapping)]
_Instrument = Annotated[Instrument, FromTable(InstrumentMapping)]


class AircraftMapping(MappingTable):
    """``[aircraft]``: the name of an aircraft, or its definition."""

    name: Name | None = key("name in the database", None)
    builtin: Text | None = key("name of an aircraft of the workbench", None)
    description: Note = key("free text", "")
    geometry: Annotated[Geometry, FromTable(GeometryMapping)] | None = key(
        "reference dimensions", None
    )
    mass: Annotated[MassTable, FromTable(MassMapping)] | None = key("mass properties", None)
    surfaces: tuple[_Surface, ...] = key("control surfaces, at least one", ())
    sensors: tuple[_Sensor, ...] = key("sensors", ())
    pairs: tuple[Part, ...] = key("parts to form of sensors and surfaces on the left and right", ())
    combinations: tuple[_Combination, ...] = key("weighted sums of channels", ())
    instruments: dict[Line, _Instrument] = key("instruments by name", {})
    polar: Annotated[DragPolar, FromTable(PolarMapping)] | None = key("parabolic polar", None)
    flutter: Annotated[FlutterTable, FromTable(FlutterMapping)] | None = key("flutter speed", None)
    thrust: Annotated[ThrustTable, FromTable(ThrustMapping)] | None = key(
        "thrust of one engine", None
    )

    def build(self) -> AircraftPart:
        """Return the name, with the definition if the mapping has one."""
        more = self.model_fields_set - {"name", "builtin", "proposed"}
        if self.builtin is not None and (more or self.name is not None):
            raise InvalidValue("is given, so that other keys do not apply.", "builtin")
        if self.builtin is not None:
            return AircraftPart(name=self.builtin, builtin=True)
        if self.name is None:
            raise InvalidValue("is missing; expected the name of the aircraft.", "name")
        if not more:
            return AircraftPart(name=self.name)
        for name in ("geometry", "mass", "surfaces"):
            if not getattr(self, name):
                problem = "is missing; a definition has geometry, mass and at least one surface."
                raise InvalidValue(problem, name)
        self._check_names()
        pairs = _combine_pairs(self.pairs, self.sensors)
        surfaces, parts = _combine_surfaces(self.pairs, self.surfaces)
        entries = {k: v for k, v in self.entries().items() if k not in ("builtin", "pairs")}
        entries["surfaces"] = (*self.surfaces, *surfaces)
        entries["combinations"] = (*pairs, *parts, *self.combinations)
        definition = Aircraft(**entries)
        return AircraftPart(name=self.name, definition=definition)

    def _check_names(self) -> None:
        """Reject a name that is used twice, and an instrument that is not defined."""
        names = [item.name for item in (*self.surfaces, *self.sensors, *self.combinations)]
        for name in names:
            if names.count(name) > 1:
                raise InvalidValue(f"use the name '{name}' twice.", "sensors")
        known = ", ".join(self.instruments) or "none"
        for table, items in (("surfaces", self.surfaces), ("sensors", self.sensors)):
            for place, item in enumerate(items, start=1):
                for role in ("instrument", "actuator", "servo"):
                    name = getattr(item, role, None)
                    if name is not None and name not in self.instruments:
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
