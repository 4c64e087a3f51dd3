"""Quantity: a number with its unit, written in the mapping or kept in the file."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexsid import units
from flexsid.errors import BadInput
from flexsid.importers.source import Sources


def refuse(path: str, problem: str) -> BadInput:
    """Build the error for one key of a mapping."""
    return BadInput(f"Mapping: '{path}' {problem}", code="bad-mapping", key=path)


@dataclass(frozen=True, slots=True, kw_only=True)
class Quantity:
    """One number, or several, with a unit: written down, or named as a field of the file."""

    unit: str
    values: tuple[float, ...] = ()
    field: str | None = None
    path: str = ""


def resolve(quantity: Quantity, sources: Sources, window: slice | None) -> float:
    """Give one number in SI; a recorded channel is averaged over the maneuver.

    Parameters
    ----------
    quantity
        Written down or a field of the file.
    sources
        Files of the import.
    window
        Samples of the maneuver, to average a channel; None where one number is expected.
    """
    if quantity.field is None:
        if len(quantity.values) != 1:
            raise refuse(quantity.path, f"must be one number, found {len(quantity.values)}.")
        return float(units.to_si(quantity.values[0], quantity.unit))
    values = sources.numbers(quantity.field)
    if values.size == 1 or window is None:
        return float(units.to_si(sources.scalar(quantity.field), quantity.unit))
    source, _ = sources.find(quantity.field)
    samples = values.reshape(-1)[window]
    if samples.size == 0:
        raise refuse(quantity.path, f"has no sample of '{quantity.field}' inside the maneuver.")
    source.check_finite(samples, quantity.field)
    return float(units.to_si(samples.mean(dtype=np.float64), quantity.unit))
