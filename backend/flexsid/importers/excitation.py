"""The ``[excitation]`` part of a mapping: the harmonics of each input."""

from __future__ import annotations

from collections.abc import Sequence

from flexsid.importers.mapping import ExcitationMapping, OrderMapping
from flexsid.importers.quantity import scalar
from flexsid.importers.source import Sources
from flexsid.importers.table import refuse
from flexsid.records.maneuver import Excitation

_MAX_HARMONICS = 10_000


def extract_excitation(
    part: ExcitationMapping, sources: Sources, inputs: Sequence[str]
) -> Excitation:
    """Return the harmonics of every input.

    Raises
    ------
    BadInput
        If a harmonic is assigned to a channel that is no input, or to two inputs.
    """
    harmonics = _interleave(part, sources) if part.harmonics is None else part.harmonics
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


def _interleave(part: ExcitationMapping, sources: Sources) -> dict[str, tuple[int, ...]]:
    assert part.order is not None
    assert part.first is not None
    assert part.per_input is not None
    if isinstance(part.order, OrderMapping):
        labels = sources.texts(part.order.field)
        names = tuple(part.order.name.replace("{label}", label) for label in labels)
    else:
        names = part.order
    first = round(scalar(part.first, sources))
    count = round(scalar(part.per_input, sources))
    stride = 1 if part.stride is None else round(scalar(part.stride, sources))
    if not names or min(first, stride) < 1 or not 1 <= count * len(names) <= _MAX_HARMONICS:
        problem = "per_input and stride must be at least 1, with order not empty."
        raise refuse("excitation.first", problem)
    step = stride * len(names)
    return {
        name: tuple(range(first + stride * index, first + stride * index + step * count, step))
        for index, name in enumerate(names)
    }
