"""Differences between two model structures."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from flexsid.records.model_structure import Structure
from flexsid.sysid.model.derivatives import list_derivative_names


def describe_derivative_state(structure: Structure, name: str) -> str:
    """Describe the state of a derivative: free, absent, or fixed to a value or source."""
    if name in structure.absent:
        return "absent"
    if name in structure.fixed:
        return f"fixed to {structure.fixed[name]:g}"
    if name in structure.fixed_to:
        source = structure.fixed_to[name]
        return f"fixed to {source.source.value} {source.id}"
    if structure.free is None or name in structure.free:
        return "free"
    return "fixed to the start of the run"


def list_structure_differences(
    before: Structure, after: Structure, surfaces: Sequence[str]
) -> list[tuple[str, str, str]]:
    """List differences as (item, before, after); ``surfaces`` are the inputs by default."""
    known = [
        list_derivative_names(one.modes, one.inputs or tuple(surfaces)) for one in (before, after)
    ]
    rows = [
        (
            name,
            describe_derivative_state(before, name) if name in known[0] else "not in the model",
            describe_derivative_state(after, name) if name in known[1] else "not in the model",
        )
        for name in dict.fromkeys((*known[1], *known[0]))
    ]
    rows += [
        (what, _join_values(one), _join_values(other))
        for what, one, other in (
            ("modes", before.modes, after.modes),
            ("inputs", before.inputs or ("all",), after.inputs or ("all",)),
            ("outputs", before.outputs or ("all",), after.outputs or ("all",)),
            ("also free", before.extra_parameters, after.extra_parameters),
            ("time delays", (before.free_delays,), (after.free_delays,)),
            ("delays", before.delays.items(), after.delays.items()),
            ("instruments", before.instruments.items(), after.instruments.items()),
        )
    ]
    return [row for row in rows if row[1] != row[2]]


def _join_values(values: Iterable[object]) -> str:
    return ", ".join(str(value) for value in values) or "none"
