"""Quantity: a number with its unit, and whether samples are plausible in it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import GetCoreSchemaHandler, model_validator
from pydantic_core import CoreSchema, core_schema

from flexsid import units
from flexsid.errors import BadInput
from flexsid.importers.source import Sources
from flexsid.importers.table import (
    InvalidValue,
    MappingTable,
    Number,
    Numbers,
    Text,
    Unit,
    check_unit,
    key,
    refuse,
)
from flexsid.records.maneuver import Role

# --- Quantity: a number with its unit, given in the mapping or by a field of the file -------------


class Quantity(MappingTable):
    """A number with its unit, or several: literal, or in a field of the file."""

    value: Number | None = key("one number", None)
    values: Numbers | None = key("several numbers", None)
    field: Text | None = key("path of the numbers in the file", None)
    unit: Unit = key("unit of the numbers; plain numbers need none", "1")

    @property
    def numbers(self) -> tuple[float, ...]:
        """The literal numbers, in ``unit``."""
        return (self.values or ()) if self.value is None else (self.value,)

    @property
    def given(self) -> str:
        """Path of the key that gives the numbers."""
        return self.path(*self._list_given())

    def _list_given(self) -> list[str]:
        return [key for key in ("value", "values", "field") if getattr(self, key) is not None]

    @model_validator(mode="after")
    def _check(self) -> Self:
        given = self._list_given()
        if not given:
            raise InvalidValue("is missing; expected a number, or values or field.", "value")
        if len(given) > 1:
            raise InvalidValue(f"cannot be given besides {given[0]}.", given[1])
        return self


def scalar(quantity: Quantity, sources: Sources) -> float:
    """Return one number in SI, literal or the only number of a field."""
    if quantity.field is not None:
        value = float(units.to_si(sources.scalar(quantity.field), quantity.unit))
        return units.check_size(value, units.dimension(quantity.unit))
    if len(quantity.numbers) != 1:
        raise refuse(quantity.given, f"must be one number, found {len(quantity.numbers)}.")
    return float(units.to_si(quantity.numbers[0], quantity.unit))


class Dimension:
    """Annotation of a quantity with its dimension.

    A key of type ``float`` or ``tuple[float, ...]`` holds literal numbers and is converted to SI;
    a frequency in Hz, where allowed besides an angular rate, to rad/s.
    """

    def __init__(self, *names: str) -> None:
        self._names = names

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        convert = {Quantity: self._check, float: self._convert_one}.get(source, self._convert)
        schema = handler.generate_schema(Quantity)
        return core_schema.no_info_after_validator_function(convert, schema)

    def _check(self, quantity: Quantity) -> Quantity:
        if "unit" not in quantity.model_fields_set and "number" not in self._names:
            problem = f"is missing; expected a unit of {' or '.join(self._names)}."
            raise InvalidValue(problem, "unit")
        unit = check_unit(quantity.unit, self._names, "unit")
        try:
            for value in units.to_si(quantity.numbers, unit).tolist():
                units.check_size(value, units.dimension(unit))
        except BadInput as error:
            key = quantity.given.rpartition(".")[2]
            raise InvalidValue(f"holds {error.message}", key) from error
        return quantity

    def _convert(self, quantity: Quantity) -> tuple[float, ...]:
        unit = self._check(quantity).unit
        if quantity.field is not None:
            raise InvalidValue("cannot be a field of the file here; write value.", "field")
        scale = 1.0 if units.dimension(unit) == self._names[0] else 2.0 * pi
        return tuple((scale * units.to_si(quantity.numbers, unit)).tolist())

    def _convert_one(self, quantity: Quantity) -> float:
        values = self._convert(quantity)
        if len(values) != 1:
            raise InvalidValue(f"must be one number, found {len(values)}.")
        return values[0]


Length = Annotated[float, Dimension("length")]
Time = Annotated[float, Dimension("time")]


# --- Plausibility of units: warnings where the samples are too large or too small for their unit

TOO_LARGE = "too-large"
TOO_SMALL = "too-small"
OTHER_AXIS = "other-axis"
WarningCode = Literal["too-large", "too-small", "other-axis"]

_LARGEST = {
    "angle": 6.4,  # a turn
    "angular rate": 12.0,
    "acceleration": 196.2,  # 20 g: no aircraft, and most accelerometers, go further
    "speed": 1000.0,
    "pressure": 3e5,
    "strain": 0.02,
    "temperature": 2000.0,
    "density": 2.0,
    "length": 1e5,
}
"""Largest plausible magnitude by dimension. [SI]"""

_LARGEST_OF = {
    **dict.fromkeys(("alpha", "beta", "theta", "gamma"), 1.6),  # vertical attitude or flow
    "phi": 3.2,  # inverted
}
"""Largest plausible magnitude of some angles by name. [rad]"""

_LARGEST_DEFLECTION = 1.2
"""Largest plausible deflection, peak to peak: above a check of full travel. [rad]"""

_LARGEST_SETTING = 1.05
"""Largest plausible deflection from neutral: 60 deg. [rad]"""

_SMALLEST_DEFLECTION = 2e-3
"""Smallest plausible excitation, peak to peak: above freeplay and noise. [rad]"""

_SMALLEST = {"angle": 3.5e-3, "angular rate": 8.7e-3, "acceleration": 0.2}
"""Smallest plausible response, peak to peak, of the largest output of a dimension during an
excitation: 0.2 deg, 0.5 deg/s, 0.02 g. Less is noise, or a unit too small by 57 or 10."""

_LARGEST_MEAN = 60.0
"""Largest plausible mean, 6 g: 1 g recorded in m/s2 and read as g exceeds it. [m/s2]"""


_PULSE_WIDTHS = (700.0, 2300.0)
"""Range of the pulse widths that servos take. [us]"""

_LEAST_SWEEP = 10.0
"""Least change of the pulse widths of a surface that moves. [us]"""


def may_be_pulse_widths(samples: np.ndarray) -> bool:
    """Return whether samples may be pulse widths (PWM), which are no deflections of a surface."""
    if samples.size == 0 or samples.dtype.kind not in "iuf":
        return False
    lowest, highest = float(samples.min()), float(samples.max())
    low, high = _PULSE_WIDTHS
    return low <= lowest and highest <= high and highest - lowest >= _LEAST_SWEEP


@dataclass(frozen=True, slots=True)
class UnitWarning:
    """A warning that the samples are too large or too small for their unit.

    ``confirmed = ["..."]`` in the mapping of the channel confirms the unit; ``instead`` lists
    units in which the samples would be plausible.
    """

    code: str
    channel: str
    unit: str
    largest: float
    instead: tuple[str, ...]

    @property
    def message(self) -> str:
        """The warning as text."""
        size = "large" if self.code == TOO_LARGE else "small"
        other = f" Is it {' or '.join(self.instead)}?" if self.instead else ""
        return (
            f"Channel '{self.channel}' varies by {self.largest:.4g} {self.unit}, which is very "
            f'{size}.{other} If {self.unit} is right, write confirmed = ["{self.code}"].'
        )


def find_unit_warning(name: str, unit: str, role: Role, samples: np.ndarray) -> UnitWarning | None:
    """Compare the magnitude of samples with plausible values of flight-test measurements.

    Parameters
    ----------
    name
        Name of the channel.
    unit
        Unit of the samples.
    role
        Surface deflections, measured or commanded, have narrower limits.
    samples
        As recorded, finite.
    """
    if samples.size == 0:
        return None
    lowest, highest = float(samples.min()), float(samples.max())
    mean = float(samples.mean(dtype=np.float64))
    dimension = units.dimension(unit)
    deflection = dimension == "angle" and role in (Role.INPUT, Role.COMMAND)
    largest = _LARGEST_SETTING if deflection else _LARGEST.get(dimension, np.inf)
    if dimension == "angle":
        largest = min(largest, _LARGEST_OF.get(name, np.inf))

    def find_code(symbol: str) -> str | None:
        low, high, middle = map(float, units.to_si([lowest, highest, mean], symbol))
        if max(abs(low), abs(high)) > largest:
            return TOO_LARGE
        if dimension == "acceleration" and abs(middle) > _LARGEST_MEAN:
            return TOO_LARGE
        if deflection and high - low > _LARGEST_DEFLECTION:
            return TOO_LARGE
        moves = deflection and role is Role.INPUT and low < high
        return TOO_SMALL if moves and high - low < _SMALLEST_DEFLECTION else None

    code = find_code(unit)
    if code is None or lowest == highest:
        return None
    size = highest - lowest if deflection else max(abs(lowest), abs(highest))
    others = [symbol for symbol in _list_units(dimension) if symbol != unit]
    instead = tuple(symbol for symbol in others if find_code(symbol) is None)
    return UnitWarning(code, name, unit, size, instead)


def _list_units(dimension: str) -> list[str]:
    return [symbol for symbol in units.SYMBOLS if units.dimension(symbol) == dimension]


def find_small_outputs(channels: Sequence[tuple[str, str, Role, np.ndarray]]) -> list[UnitWarning]:
    """Return warnings on outputs that are too small while a surface is excited.

    Parameters
    ----------
    channels
        Name, unit, role and samples of each.

    Notes
    -----
    One sensor may be at rest (a roll rate in a symmetric maneuver), but not all of a dimension:
    all are warned of together, if even the largest response is below ``_SMALLEST``.
    """
    if not any(role is Role.INPUT and np.ptp(samples) > 0 for _, _, role, samples in channels):
        return []
    found: list[UnitWarning] = []
    for dimension, smallest in _SMALLEST.items():
        moves = [
            (name, unit, float(np.ptp(samples)))
            for name, unit, role, samples in channels
            if role is Role.OUTPUT and units.dimension(unit) == dimension and samples.size
        ]
        sizes = [moved * units.lookup(unit).factor for _, unit, moved in moves]
        if not 0.0 < max(sizes, default=0.0) < smallest:
            continue
        for name, unit, moved in moves:
            larger = tuple(
                symbol
                for symbol in _list_units(dimension)
                if moved * units.lookup(symbol).factor >= smallest
            )
            if moved > 0.0:
                found.append(UnitWarning(TOO_SMALL, name, unit, moved, larger))
    return found
