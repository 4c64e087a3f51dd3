"""ModelStructure: which inputs, outputs, modes and derivatives a model has."""

from __future__ import annotations

from dataclasses import dataclass, field
from datetime import datetime
from enum import StrEnum
from typing import Annotated, get_args

from flexsid.allowed import Allowed, Delay, Id, ModeNumber, Name, Names, Number
from flexsid.sysid.model.axes import ModelAxis


class HeldBy(StrEnum):
    """Kind of source whose value a derivative is held at."""

    PREDICTION = "prediction"
    RUN = "run"


@dataclass(frozen=True, slots=True, kw_only=True)
class FixedTo:
    """A source by kind and id; a prediction is read at the fuel of the maneuver."""

    source: HeldBy
    id: Id


@dataclass(frozen=True, slots=True, kw_only=True)
class Structure:
    """The content of a model structure; a run has its own copy.

    Empty ``inputs`` or ``outputs`` stand for all that the maneuver has. Each
    derivative of the selected modes and inputs is in one state:

    - absent, where ``absent`` names it: the model does not have it, it is zero;
    - fixed to a number (``fixed``), to a prediction or an earlier run
      (``fixed_to``), or, where ``free`` leaves it out, to the start of the run;
    - free otherwise; ``free`` of None frees all that is neither absent nor fixed.

    ``delays`` [s] of outputs and inputs add to those of their instruments, and
    ``instruments`` puts another of the aircraft's instruments (None: none at all)
    behind a channel; a combination stands for its sensors.
    """

    modes: Annotated[tuple[ModeNumber, ...], Allowed(max_length=20)] = ()
    inputs: Names = ()
    outputs: Names = ()
    free: Names | None = None
    fixed: Annotated[dict[Name, Number], Allowed(max_length=500)] = field(
        default_factory=dict[str, float]
    )
    free_delays: bool = False
    extra_parameters: Names = ()
    axis: Annotated[str, Allowed(choices=get_args(ModelAxis))] = "longitudinal"
    absent: Names = ()
    fixed_to: Annotated[dict[Name, FixedTo], Allowed(max_length=500)] = field(
        default_factory=dict[str, FixedTo]
    )
    delays: Annotated[dict[Name, Delay], Allowed(max_length=500)] = field(
        default_factory=dict[str, float]
    )
    instruments: Annotated[dict[Name, Name | None], Allowed(max_length=500)] = field(
        default_factory=dict[str, str | None]
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class ModelStructure:
    """A named structure that runs can share, as its newest version has it."""

    aircraft_id: int
    name: str
    structure: Structure
    note: str = ""
    author: str = ""
    version: int = 1
    created_at: datetime | None = None
    changed_at: datetime | None = None
    id: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class StructureVersion:
    """One version of a model structure; it is written once and never changed."""

    structure_id: int
    version: int
    name: str
    structure: Structure
    note: str
    author: str
    created_at: datetime | None = None
    id: int | None = None
