"""The ``[excitation]`` part of a mapping: the harmonics of each input."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from flexsid.importers.quantity import MappedQuantity, refuse, scalar
from flexsid.importers.source import Sources
from flexsid.importers.table import MappingTable
from flexsid.records.maneuver import Excitation

_MAX_HARMONICS = 10_000


@dataclass(frozen=True, slots=True, kw_only=True)
class Interleaving:
    """Consecutive harmonics interleaved between the inputs, from ``first`` upward."""

    order: str | tuple[str, ...]
    name: str
    first: MappedQuantity
    per_input: MappedQuantity


@dataclass(frozen=True, slots=True, kw_only=True)
class ExcitationPart:
    """Harmonics per input, listed or interleaved (Eq. 4)."""

    period: MappedQuantity
    start_s: float
    n_periods: int
    harmonics: tuple[tuple[str, tuple[int, ...]], ...] | Interleaving


def read_excitation(table: MappingTable) -> ExcitationPart:
    """Read ``harmonics`` by input, or ``order`` with ``first`` and ``per_input``."""
    harmonics: tuple[tuple[str, tuple[int, ...]], ...] | Interleaving
    if "harmonics" in table:
        rows = table.table("harmonics")
        harmonics = tuple((name, rows.integers(name)) for name in rows.names())
    else:
        harmonics = _interleaving(table)
    part = ExcitationPart(
        period=table.quantity("period", "time"),
        start_s=table.si_scalar("start", "time") if "start" in table else 0.0,
        n_periods=table.integer("n_periods", 1),
        harmonics=harmonics,
    )
    table.close()
    return part


def _interleaving(table: MappingTable) -> Interleaving:
    order: str | tuple[str, ...]
    name = "{label}"
    if table.is_table("order"):
        labels = table.table("order")
        order = labels.text("field")
        name = labels.label("name", "{label}")
        labels.close()
    else:
        order = table.texts("order")
    return Interleaving(
        order=order,
        name=name,
        first=table.quantity("first", "number"),
        per_input=table.quantity("per_input", "number"),
    )


def extract_excitation(part: ExcitationPart, sources: Sources, inputs: Sequence[str]) -> Excitation:
    """Return the harmonics of every input.

    Raises
    ------
    BadInput
        If a harmonic is assigned to a channel that is no input, or to two inputs.
    """
    if isinstance(part.harmonics, Interleaving):
        harmonics = _interleave(part.harmonics, sources)
    else:
        harmonics = dict(part.harmonics)
    assigned: dict[int, str] = {}
    for name, numbers in harmonics.items():
        if name not in inputs:
            raise refuse(
                "excitation",
                f"excites '{name}', which is not an input; inputs: {', '.join(inputs)}.",
            )
        for number in numbers:
            if number < 1:
                raise refuse(
                    "excitation", f"assigns harmonic {number} to {name}; expected 1 or more."
                )
            if number in assigned:
                both = f"{assigned[number]} and {name}"
                raise refuse(
                    "excitation", f"assigns harmonic {number} to {both}; expected one input."
                )
            assigned[number] = name
    period_s = scalar(part.period, sources)
    if period_s <= 0 or part.n_periods < 1:
        raise refuse("excitation.period", "and n_periods must be positive.")
    return Excitation(
        period_s=period_s, harmonics=harmonics, start_s=part.start_s, n_periods=part.n_periods
    )


def _interleave(plan: Interleaving, sources: Sources) -> dict[str, tuple[int, ...]]:
    labels = sources.texts(plan.order) if isinstance(plan.order, str) else plan.order
    names = tuple(plan.name.replace("{label}", label) for label in labels)
    first = round(scalar(plan.first, sources))
    count = round(scalar(plan.per_input, sources))
    if not names or first < 1 or not 1 <= count * len(names) <= _MAX_HARMONICS:
        raise refuse("excitation.first", "and per_input must be at least 1, with order not empty.")
    step = len(names)
    return {
        name: tuple(range(first + place, first + place + step * count, step))
        for place, name in enumerate(names)
    }
