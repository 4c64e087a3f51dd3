"""ModelStructure: which inputs, outputs, modes and derivatives a model has."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime


@dataclass(frozen=True, slots=True, kw_only=True)
class Structure:
    """The content of a model structure; a run keeps its own copy.

    Empty ``inputs`` or ``outputs`` stand for all that the maneuver has; ``free``
    of None frees every derivative of the chosen modes and inputs; what is not
    free is held at ``fixed``, else at the start source's value.
    """

    modes: tuple[int, ...] = ()
    inputs: tuple[str, ...] = ()
    outputs: tuple[str, ...] = ()
    free: tuple[str, ...] | None = None
    fixed: dict[str, float]
    free_delays: bool = False
    also_free: tuple[str, ...] = ()
    axis: str = "longitudinal"


@dataclass(frozen=True, slots=True, kw_only=True)
class ModelStructure:
    """A named structure that runs can share."""

    aircraft_id: int
    name: str
    structure: Structure
    note: str = ""
    created_at: datetime | None = None
    id: int | None = None
