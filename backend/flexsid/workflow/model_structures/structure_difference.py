"""What differs between two model structures, in words."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from flexsid.records.model_structure import Structure
from flexsid.sysid.model.derivatives import derivative_names


def state_of(structure: Structure, name: str) -> str:
    """Say what a derivative is: free, absent, or fixed to something."""
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


def differences(
    before: Structure, after: Structure, surfaces: Sequence[str]
) -> list[tuple[str, str, str]]:
    """List what differs, as (what, before, after); ``surfaces`` stand for unnamed inputs."""
    known = [derivative_names(one.modes, one.inputs or tuple(surfaces)) for one in (before, after)]
    rows = [
        (
            name,
            state_of(before, name) if name in known[0] else "not in the model",
            state_of(after, name) if name in known[1] else "not in the model",
        )
        for name in dict.fromkeys((*known[1], *known[0]))
    ]
    rows += [
        (what, _listed(one), _listed(other))
        for what, one, other in (
            ("modes", before.modes, after.modes),
            ("inputs", before.inputs or ("all",), after.inputs or ("all",)),
            ("outputs", before.outputs or ("all",), after.outputs or ("all",)),
            ("also free", before.also_free, after.also_free),
            ("time delays", (before.free_delays,), (after.free_delays,)),
            ("delays", before.delays.items(), after.delays.items()),
            ("instruments", before.instruments.items(), after.instruments.items()),
        )
    ]
    return [row for row in rows if row[1] != row[2]]


def _listed(values: Iterable[object]) -> str:
    return ", ".join(str(value) for value in values) or "none"
