"""Quantity: a number with its unit, given in the mapping or by a field of the file."""

from __future__ import annotations

from math import pi
from typing import Annotated, Any, Self

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
