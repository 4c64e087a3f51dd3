"""Quantity: a number with its unit, given in the mapping or by a field of the file."""

from __future__ import annotations

from dataclasses import dataclass

from flexsid import units
from flexsid.errors import BadInput
from flexsid.importers.source import Sources


def refuse(path: str, problem: str) -> BadInput:
    """Build the error for one key of a mapping."""
    return BadInput(f"Mapping: '{path}' {problem}", code="bad-mapping", key=path)


@dataclass(frozen=True, slots=True, kw_only=True)
class MappedQuantity:
    """One number, or several, with a unit: literal, or the name of a field of the file."""

    unit: str
    values: tuple[float, ...] = ()
    field: str | None = None
    path: str = ""


def scalar(quantity: MappedQuantity, sources: Sources) -> float:
    """Return one number in SI, literal or the only number of a field."""
    if quantity.field is not None:
        value = float(units.to_si(sources.scalar(quantity.field), quantity.unit))
        return units.check_size(value, units.dimension(quantity.unit))
    if len(quantity.values) != 1:
        raise refuse(quantity.path, f"must be one number, found {len(quantity.values)}.")
    return float(units.to_si(quantity.values[0], quantity.unit))
