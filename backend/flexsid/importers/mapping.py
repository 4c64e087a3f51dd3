"""Mapping: the TOML file that defines names, units and roles of recorded columns.

Each class is a table of the file, each attribute a key of it (the aircraft is in ``aircraft``).
``examples/README.md`` of the project explains the format.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from datetime import date
from fnmatch import fnmatchcase
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Field, StrictBool, field_validator, model_validator

from flexsid.errors import BadInput
from flexsid.importers.aircraft import AircraftMapping, AircraftPart
from flexsid.importers.quantity import Dimension, Length, Quantity, Time, WarningCode
from flexsid.importers.record_table import table_of
from flexsid.importers.source import Sources
from flexsid.importers.table import (
    BY_FORM,
    LIST,
    TABLE,
    TEXT,
    WHOLE_NUMBER,
    FromTable,
    Integer,
    Integers,
    InvalidValue,
    LengthUnit,
    Line,
    MappingTable,
    Name,
    Note,
    Number,
    Text,
    Texts,
    TimeUnit,
    Unit,
    key,
    read_table,
    refuse,
)
from flexsid.records.aircraft import Aircraft
from flexsid.records.maneuver import Cut, Flight, Role
from flexsid.records.modal_data import ModalKind
from flexsid.sysid.preparation.resampling import BetweenSamples

_KNOWN = Path(__file__).parent / "known"
_LARGEST_MAPPING = 1024 * 1024


_Angle = Annotated[Quantity, Dimension("angle")]
_Length = Annotated[Quantity, Dimension("length")]
_Number = Annotated[Quantity, Dimension("number")]
_RotationSpeed = Annotated[Quantity, Dimension("angular rate")]
_Inertia = Annotated[Quantity, Dimension("inertia")]


@table_of(Flight, without=("aircraft_id", "id"))
class FlightMapping(MappingTable):
    """``[flight]``: the flight of the recording."""

    flown_on: date | None = key("day of the flight, such as 2024-05-31", None, alias="date")

    @field_validator("flown_on", mode="before")
    @classmethod
    def _read_date(cls, day: object) -> date:
        try:
            return date.fromisoformat(str(day))
        except ValueError as error:
            raise InvalidValue(f"must have the form 2024-05-31, found '{day}'.") from error

    def build(self) -> Flight:
        """Return the flight, of an aircraft that is not known yet."""
        return Flight(aircraft_id=0, **self.entries())


class ConditionMapping(MappingTable):
    """``[maneuver.condition]``: the flight condition; recorded channels are averaged."""

    airspeed: Annotated[Quantity, Dimension("speed")] = key("the true airspeed")
    density: Annotated[Quantity, Dimension("density")] | None = key("air density", None)
    altitude: _Length | None = key("altitude of the standard atmosphere", None)
    fuel_fraction: _Number | None = key("fuel fraction", None)
    alpha: _Angle | None = key("angle of attack", None)
    gamma: _Angle | None = key("flight path angle", None)
    thrust: Annotated[Quantity, Dimension("force")] | None = key("thrust of all engines", None)
    mass: Annotated[Quantity, Dimension("mass")] | None = key("mass", None)
    pitch_inertia: _Inertia | None = key("inertia in pitch", None)
    roll_inertia: _Inertia | None = key("inertia in roll", None)
    yaw_inertia: _Inertia | None = key("inertia in yaw", None)
    product_of_inertia: _Inertia | None = key("integral of x z dm in body axes", None)
    x_cg: _Length | None = key("centre of gravity, positive aft", None)
    z_cg: _Length | None = key("centre of gravity, positive up", None)
    total_temperature: Annotated[Quantity, Dimension("temperature")] | None = key(
        "total temperature of the air", None
    )
    airspeed_std: _Number | None = key("standard deviation of airspeed, relative to it", None)
    density_std: _Number | None = key("standard deviation of density, relative to it", None)
    engines: dict[Line, _RotationSpeed] = key("rotation speeds by channel of the thrust table", {})

    def build(self) -> dict[str, Quantity]:
        """Return the quantities by name; each engine has its own."""
        if (self.density is None) == (self.altitude is None):
            raise InvalidValue("or altitude must be given, but not both.", "density")
        return {n: v for n, v in self if isinstance(v, Quantity)} | self.engines


class FtaMapping(MappingTable):
    """``fta`` of the maneuver, by the value of a field of the file."""

    field: Text = key("the field that determines the flight test aid")
    values: dict[float, Integer] = key("the flight test aid by the value of the field")


_Fta = Annotated[Annotated[Integer, WHOLE_NUMBER] | Annotated[FtaMapping, TABLE], BY_FORM]


@table_of(Cut, optional=("start_s", "stop_s"))
class ManeuverMapping(MappingTable):
    """``[maneuver]``: name, time and flight condition of a maneuver."""

    label: Name = key("name; {file} stands for that of the file", "{file}")
    condition: Annotated[Mapping[str, Quantity], FromTable(ConditionMapping)] = key(
        "the flight condition"
    )
    fta: _Fta | None = key("flight test aid", None)
    axis: Literal["longitudinal", "lateral", "combined", "ground"] | None = key(
        "kind of motion; combined: independent surfaces excite both axes", None
    )

    @property
    def window_s(self) -> tuple[float | None, float | None]:
        """Start and stop in the record; None for its ends. [s]"""
        entries = self.entries()
        return entries["start_s"], entries["stop_s"]

    def build_cut(self, start_s: float, stop_s: float, label: str, fta: int | None) -> Cut:
        """Return the window that the maneuver has in a record."""
        note = self.entries()["note"]
        return Cut(label=label, start_s=start_s, stop_s=stop_s, fta=fta, axis=self.axis, note=note)


class OrderMapping(MappingTable):
    """``order`` of the excitation: the names of the inputs, from a field of the file."""

    field: Text = key("the field that lists the inputs")
    name: Name = key("name of an input; {label} stands for that of the file", "{label}")


_Order = Annotated[Annotated[Texts, LIST] | Annotated[OrderMapping, TABLE], BY_FORM]


class ExcitationMapping(MappingTable):
    """``[excitation]``: the harmonics of each input, listed or interleaved (Eq. 4)."""

    period: Annotated[Quantity, Dimension("time")] = key("the period of the lowest harmonic")
    start_s: Time = key("start of the first period", 0.0, alias="start")
    n_periods: Integer = key("number of periods", 1)
    harmonics: dict[Line, Integers] | None = key("harmonics by input", None)
    order: _Order | None = key("inputs in the order of their harmonics", None)
    first: _Number | None = key("lowest harmonic", None)
    per_input: _Number | None = key("number of harmonics of each input", None)
    stride: _Number | None = key("2 where every second harmonic is excited; else 1", None)

    @model_validator(mode="after")
    def _check(self) -> Self:
        for name in ("order", "first", "per_input", "stride"):
            if self.harmonics is not None and getattr(self, name) is not None:
                raise InvalidValue("does not apply with 'harmonics'.", name)
            if self.harmonics is None and name != "stride" and getattr(self, name) is None:
                problem = "is missing; give harmonics, or order, first and per_input."
                raise InvalidValue(problem, name)
        return self


class TimeMapping(MappingTable):
    """``[time]``: a time base, given by a column or by a rate and the time of the first sample."""

    column: Text | None = key("column of the time stamps", None)
    unit: TimeUnit = key("unit of the time stamps", "s")
    rate: Annotated[Quantity, Dimension("frequency")] | None = key("sampling rate", None)
    start_s: Time = key("time of the first sample, with rate", 0.0, alias="start")
    offset_s: Time = key("added, to align the clocks of several recorders", 0.0, alias="offset")
    uneven: Literal["interpolate"] | None = key(
        "interpolate: samples at uneven intervals become uniform; else they are refused", None
    )
    confirmed: tuple[Literal["unusual-rate"], ...] = key("warnings that are confirmed", ())

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.rate is None and self.column is None and not self._is_of_files():
            raise InvalidValue("is missing; expected the column of time, or rate.", "column")
        used = self.model_fields_set
        if self.rate is None and "start_s" in used:
            raise InvalidValue("does not apply with 'column'.", "start")
        for name in ("column", "unit", "uneven"):
            if self.rate is not None and name in used:
                raise InvalidValue("does not apply with 'rate'.", name)
        return self

    def _is_of_files(self) -> bool:
        """Return whether this only has options of the clocks that files assign to channels."""
        return self.uneven is not None and "offset_s" not in self.model_fields_set


class ClockMapping(TimeMapping):
    """``[[clocks]]``: a further time base."""

    name: Name = key("the name of the clock")


_FieldOrColumn = Annotated[Annotated[Text, TEXT] | Annotated[Integer, WHOLE_NUMBER], BY_FORM]
_Labels = Annotated[Annotated[Text, TEXT] | Annotated[Texts, LIST], BY_FORM]
_Units = Annotated[Annotated[Unit, TEXT] | Annotated[dict[Line, Unit], TABLE], BY_FORM]


_Point = Annotated[tuple[Number, ...], Field(min_length=2, max_length=2)]
_Calibration = Annotated[tuple[_Point, ...], Field(min_length=2)]


class OtherSideMapping(MappingTable):
    """``other_side`` of a channel: the column of the other wing, of which the mean is taken."""

    column: Text = key("a field")
    unit: Unit = key("the unit")
    sign: Number = key("-1 if the recorder has the opposite sign", 1.0)

    @model_validator(mode="after")
    def _check(self) -> Self:
        if abs(self.sign) != 1.0:
            raise InvalidValue("must be 1 or -1; a scale factor belongs in the unit.", "sign")
        return self


class ChannelMapping(MappingTable):
    """``[[channels]]``: one channel, or the columns of one array."""

    column: _FieldOrColumn | None = key("a field; with array a column number from 1", None)
    array: Text | None = key("field that holds a matrix", None)
    labels: _Labels | None = key("names of all columns of array: a field, or a list", None)
    name: Name | None = key("name of the channel; {label} stands for that of the column", None)
    unit: _Units = key("the unit, or units by label or pattern")
    role: Role = key("the role: input, output, command or condition")
    sign: Number = key("-1 if the recorder has the opposite sign", 1.0)
    calibration: _Calibration | None = key("recorded numbers, each with its value in unit", None)
    other_side: OtherSideMapping | None = key("the other side, to take the mean of both", None)
    sensor: Text | None = key("the sensor of the aircraft that measured it", None)
    clock: Text | None = key("one of [[clocks]]", None)
    between_samples: BetweenSamples | None = key(
        "what the signal is between its samples; held: each until the next", None
    )
    confirmed: tuple[WarningCode, ...] = key("codes of the warnings that are confirmed", ())

    @property
    def template(self) -> str:
        """Name of the channel, where ``{label}`` stands for that of the column."""
        return self.name or ("{label}" if self.labels is not None else str(self.column))

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.labels is not None:
            if self.array is None:
                raise InvalidValue("is missing; labels name the columns of an array.", "array")
            if self.column is not None:
                raise InvalidValue("does not apply with 'labels'.", "column")
        elif self.array is None and not isinstance(self.column, str):
            raise InvalidValue("must be the name of a column.", "column")
        elif self.array is not None and not (isinstance(self.column, int) and self.column >= 1):
            raise InvalidValue("must be the number of a column of 'array', from 1.", "column")
        if self.other_side is not None and self.array is not None:
            raise InvalidValue("does not apply with 'array'.", "other_side")
        if abs(self.sign) != 1.0:
            raise InvalidValue("must be 1 or -1; a scale factor belongs in the unit.", "sign")
        recorded = [point[0] for point in self.calibration or ()]
        if any(after <= before for before, after in pairwise(recorded)):
            problem = "must have recorded numbers that increase, such as [[1000, -25], [2000, 25]]."
            raise InvalidValue(problem, "calibration")
        return self

    def find_unit(self, label: str) -> str:
        """Return the unit of a column: of the first pattern that fits its name.

        Raises
        ------
        BadInput
            If no pattern fits.
        """
        if isinstance(self.unit, str):
            return self.unit
        for pattern, unit in self.unit.items():
            if fnmatchcase(label, pattern):
                return unit
        raise refuse(self.path("unit"), f"gives no unit for '{label[:80]}'.")


_Column = Annotated[Integer, Field(ge=1)]
_Columns = Annotated[tuple[_Column, ...], Field(min_length=3, max_length=3)]
_Locations = Annotated[tuple[float, ...], Dimension("length"), Field(min_length=3, max_length=3)]


class ShapeMapping(MappingTable):
    """``[modal_tables.shape]``: the mode shapes, one array per mode and a row per node."""

    field: Text = key("the field of a shape; {number} stands for that of the mode")
    node_column: _Column = key("column of the node numbers, from 1", 1)
    translation_columns: _Columns = key("the columns of translations in x, y and z")
    rotation_columns: _Columns = key("the columns of rotations about x, y and z")
    unit: LengthUnit = key("the unit of translations")
    coordinates: Text = key("the field of the node coordinates")
    coordinate_columns: _Columns = key("the columns of x, y and z")
    coordinate_unit: LengthUnit = key("the unit of coordinates")
    origin_m: _Locations = key("added to coordinates", (0.0, 0.0, 0.0), alias="origin")
    points: dict[Line, Integer] = key("the node of each sensor point")


class StrainMapping(MappingTable):
    """``[modal_tables.strain]``: strain of the modes at gauges, a row per mode, per unit eta."""

    field: Text = key("the field of the strains; {fuel} stands for the number of the fuel weight")
    gauges: Texts = key("the gauges of the columns")
    unit: Unit = key("the unit of the strains, such as ustrain")


def _list_fuel(value: object) -> object:
    return [value] if isinstance(value, (int, float)) else value


_Fuel = Annotated[
    tuple[Annotated[float, Field(ge=0.0, le=1.0)], ...],
    BeforeValidator(_list_fuel),
    Field(min_length=1),
]


class ModalTableMapping(MappingTable):
    """``[[modal_tables]]``: names, frequencies, damping, generalised masses and shapes of modes.

    ``fuel`` is one fuel fraction, or a list of several. A field then has a row for each, or its
    name has {fuel}, the number of the fuel weight from 1.
    """

    name: Name = key("the name of the table")
    kind: ModalKind = key("the kind of modal data")
    fuel: _Fuel = key("fuel fraction, or a list of them", (0.0,))
    numbers: Integers = key("the numbers of the modes")
    names: Texts = key("the names of the modes")
    symmetric: tuple[StrictBool, ...] = key("true for each symmetric mode")
    frequency: Annotated[Quantity, Dimension("angular rate", "frequency")] | None = key(
        "frequencies in vacuo", None
    )
    damping: _Number | None = key("damping ratios", None)
    mass: _Inertia | None = key("generalised masses", None)
    frequency_std: Annotated[Quantity, Dimension("angular rate", "frequency")] | None = key(
        "standard deviations of the frequencies", None
    )
    damping_std: _Number | None = key("standard deviations of the damping ratios", None)
    shape_std: _Number | None = key(
        "standard deviations of the shapes, relative to their rms; 0 of exact ones", None
    )
    first: _Column = key("place of the first of these modes in a field", 1)
    shape: ShapeMapping | None = key("mode shapes", None)
    strain: StrainMapping | None = key("strain of the modes at gauges", None)
    origin: Note = key("where the modes are from", "")

    @model_validator(mode="after")
    def _check(self) -> Self:
        if not self.numbers or len(set(self.numbers)) != len(self.numbers):
            raise InvalidValue("must name every mode once.", "numbers")
        if not len(self.names) == len(self.symmetric) == len(self.numbers):
            raise InvalidValue("and symmetric must have one entry per mode.", "names")
        if self.frequency is None and self.damping is None:
            raise InvalidValue("or damping must be given.", "frequency")
        if list(self.fuel) != sorted(set(self.fuel)):
            raise InvalidValue("must list fuel fractions in rising order.", "fuel")
        if self.shape is not None and (self.frequency is None or self.mass is None):
            problem = "and frequency must be given: a shape needs its scale."
            raise InvalidValue(problem, "mass")
        return self


class TermMapping(MappingTable):
    """``[[predictions.terms]]``: one array, a row per coefficient and a column per variable.

    Of several fuel weights the array has a layer for each, or its name has {fuel}.
    """

    field: Text = key("the field that holds the array")
    coefficients: Texts = key("the coefficients of the rows")
    variables: Texts = key("the variables of the columns; an empty one skips its column")
    reference_length_m: Length | None = key(
        "length L of a source with rates q L / V; else half the chord",
        None,
        alias="reference_length",
        gt=0,
    )
    factor: Number = key("factor on all values", 1.0)

    @model_validator(mode="after")
    def _check(self) -> Self:
        rates = all(name.startswith(("q", "etadot")) or not name for name in self.variables)
        if self.reference_length_m is not None and not rates:
            raise InvalidValue("applies only to the rates q and etadot.", "reference_length")
        return self


class PredictionMapping(MappingTable):
    """``[[predictions]]``: the derivatives of one source."""

    source: Name = key("the source of the derivatives")
    kind: Literal["panel code", "wind tunnel", "simulation", "flight"] = key(
        "kind of source", "panel code"
    )
    fuel: _Fuel = key("fuel fraction, or a list of them", (0.0,))
    terms: tuple[TermMapping, ...] = key("the arrays of the derivatives", min_length=1)
    note: Note = key("free text", "")


Repair = Literal["midnight", "gps-week", "exchanged-stamps", "repeated-stamps", "single-nan"]


class MappingFile(MappingTable):
    """A mapping file."""

    repair: tuple[Repair, ...] = key("damage of the record that is repaired, and noted", ())
    aircraft: Annotated[AircraftPart, FromTable(AircraftMapping)] | None = key("aircraft", None)
    flight: Annotated[Flight, FromTable(FlightMapping)] | None = key(
        "flight of the recording", None
    )
    maneuver: ManeuverMapping | None = key("maneuver; if omitted, the flight is stored", None)
    excitation: ExcitationMapping | None = key("harmonics of each input", None)
    time: TimeMapping | None = key("time base of the channels", None)
    clocks: tuple[ClockMapping, ...] = key("further time bases", ())
    channels: tuple[ChannelMapping, ...] = key("channels of the recording", ())
    modal_tables: tuple[ModalTableMapping, ...] = key("modal tables from arrays", ())
    predictions: tuple[PredictionMapping, ...] = key("derivatives from arrays", ())

    @model_validator(mode="after")
    def _check(self) -> Self:
        for name in ("maneuver", "time", "clocks"):
            if getattr(self, name) and not self.channels:
                raise InvalidValue(f"is missing, but '{name}' is given.", "channels")
        if not (self.channels or self.modal_tables or self.predictions):
            problem = "modal_tables or predictions must be given; there is nothing to import."
            raise InvalidValue(f"or {problem}", "channels")
        if self.channels and self.flight is None:
            problem = "is missing; a recording belongs to a flight with a number."
            raise InvalidValue(problem, "flight")
        if self.excitation is not None and self.maneuver is None:
            raise InvalidValue("is missing, but 'excitation' is given.", "maneuver")
        names = [clock.name for clock in self.clocks]
        for place, name in enumerate(names, start=1):
            if name in names[: place - 1]:
                raise InvalidValue(f"'{name}' is used twice.", f"clocks[{place}].name")
        return self


class AircraftFile(MappingTable):
    """A file that defines an aircraft, as a mapping does."""

    aircraft: Annotated[AircraftPart, FromTable(AircraftMapping)] = key("aircraft")


def parse_mapping(text: str) -> MappingFile:
    """Parse and check a mapping.

    Raises
    ------
    BadInput
        Naming the key that is missing, misspelt or of the wrong kind.
    """
    return read_table(MappingFile, _load_toml(text))


def parse_aircraft(text: str) -> Aircraft:
    """Parse and check the definition of an aircraft: the ``[aircraft]`` part of a mapping.

    Raises
    ------
    BadInput
        Naming the key that is missing, misspelt or of the wrong kind.
    """
    definition = read_table(AircraftFile, _load_toml(text)).aircraft.definition
    if definition is None:
        raise refuse(
            "aircraft", "names an aircraft; a definition has geometry, mass and surfaces besides."
        )
    return definition


def _load_toml(text: str) -> dict[str, Any]:
    if len(text) > _LARGEST_MAPPING:
        raise BadInput(
            "The mapping is larger than 1 MB; expected a smaller TOML file.", code="bad-mapping"
        )
    try:
        return tomllib.loads(text)
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        raise BadInput(f"The mapping is not valid TOML: {error}.", code="bad-mapping") from error


def find_known_mapping(sources: Sources) -> str | None:
    """Return the built-in mapping for files of a known layout.

    Returns
    -------
    str or None
        Text of the mapping; None for files of unknown layout.
    """
    simulated = ("t_s", "outputs", "inputs", "multisine_command", "output_names", "input_names")
    if all(sources.has(field) for field in simulated):
        return (_KNOWN / "flex28-record.toml").read_text(encoding="utf-8")
    return None
