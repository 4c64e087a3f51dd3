"""Model structures, and decisions on them with their review."""

from __future__ import annotations

from dataclasses import dataclass, field
from datetime import datetime
from enum import StrEnum
from itertools import chain
from typing import Annotated, get_args

from flexsid.allowed import (
    Allowed,
    Delay,
    Id,
    ModeNumber,
    Name,
    Names,
    Number,
    RequiredName,
    RequiredText,
    Version,
)
from flexsid.sysid.model.derivatives import ModelAxis
from flexsid.text import check_line

# --- Decision: a model structure or global model proposed for conditions, with its review ---------


class LimitedQuantity(StrEnum):
    """Quantity of a range of conditions."""

    DYNAMIC_PRESSURE = "dynamic_pressure_pa"
    FUEL = "fuel_fraction"
    AIRSPEED = "airspeed_m_s"
    AIRSPEED_RATIO = "airspeed_ratio"  # V/V_f
    ALPHA = "alpha_rad"


Limits = dict[LimitedQuantity, tuple[Number, Number]]
"""Closed intervals; a quantity that is not named is not limited."""


@dataclass(frozen=True, slots=True, kw_only=True)
class StructureReference:
    """One version of one model structure."""

    id: Id
    version: Version


@dataclass(frozen=True, slots=True, kw_only=True)
class LinkedComparison:
    """Runs and predictions that were compared; ``coefficient`` where only one was."""

    run_ids: Annotated[tuple[Id, ...], Allowed(min_length=1, max_length=200)]
    prediction_ids: Annotated[tuple[Id, ...], Allowed(max_length=200)] = ()
    coefficient: Annotated[str | None, Allowed(min_length=1, max_length=16, check=check_line)] = (
        None
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class ModelProposal:
    """Proposed model structure or global model, and its evidence.

    ``changes`` is the version that ``structure`` changes, where it is not new. The runs of a
    global model are evidence of its proposal.
    """

    title: RequiredName
    structure: StructureReference | None = None
    changes: StructureReference | None = None
    global_model_id: Id | None = None
    limits: Limits
    reasoning: RequiredText
    run_ids: Annotated[tuple[Id, ...], Allowed(max_length=200)] = ()
    comparisons: Annotated[tuple[LinkedComparison, ...], Allowed(max_length=50)] = ()
    figure_ids: Annotated[tuple[Id, ...], Allowed(max_length=50)] = ()

    @property
    def all_run_ids(self) -> tuple[int, ...]:
        """Linked runs and those of comparisons, each once."""
        compared = chain.from_iterable(one.run_ids for one in self.comparisons)
        return tuple(dict.fromkeys((*self.run_ids, *compared)))


class Vote(StrEnum):
    """Vote on a proposal."""

    APPROVE = "approve"
    REQUEST_CHANGES = "request-changes"
    REJECT = "reject"


class DecisionState(StrEnum):
    """Where a decision stands; the first two can still be voted on."""

    OPEN = "open"
    CHANGES_REQUESTED = "changes-requested"
    APPROVED = "approved"
    REJECTED = "rejected"
    WITHDRAWN = "withdrawn"
    SUPERSEDED = "superseded"


class EventKind(StrEnum):
    """Kind of event of a decision."""

    PROPOSED = "proposed"
    REVISED = "revised"
    COMMENTED = "commented"
    VOTED = "voted"
    WITHDRAWN = "withdrawn"
    ADOPTED = "adopted"  # the quorum was reached: the campaign's baseline from here on
    DECLINED = "declined"  # the quorum rejected it
    SUPERSEDED = "superseded"  # later baselines hold the whole of its range
    NARROWED = "narrowed"  # a later baseline holds a part of its range


@dataclass(frozen=True, slots=True, kw_only=True)
class ReviewRules:
    """How many must approve, and whether one's own proposal may be judged; one per change."""

    aircraft_id: int
    quorum: int = 1
    own_allowed: bool = False
    version: int = 0
    reason: str = ""
    author: str = ""
    created_at: datetime | None = None
    id: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class DecisionEvent:
    """One entry of the record of a decision; written once and never changed.

    ``author`` is the name that was set, which nobody verified. ``data`` names all
    that the event rests on by hash, ``data_hash`` is the hash of that. ``sealed`` is the
    event as JSON, ``previous_hash`` included, and ``hash`` the SHA-256 of that text, so
    that no entry can be changed or taken out unnoticed.
    """

    decision_id: int
    number: int
    kind: EventKind
    author: str
    author_verified: bool = False
    text: str
    revision: int
    derivative: str | None = None
    vote: Vote | None = None
    proposal: ModelProposal | None = None
    rules: ReviewRules | None = None
    by_decision_id: int | None = None
    data: dict[str, str]
    data_hash: str
    software: dict[str, str]
    previous_hash: str
    sealed: str = ""
    hash: str = ""
    created_at: datetime | None = None
    id: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Decision:
    """Where a decision stands after its events; ``version`` counts them.

    ``authors`` have made a revision of the proposal; ``votes`` are those that stand
    on the newest one.
    """

    aircraft_id: int
    axis: str
    proposal: ModelProposal
    state: DecisionState
    revision: int
    authors: tuple[str, ...]
    votes: dict[str, Vote] = field(default_factory=dict[str, Vote])
    superseded_by: int | None = None
    version: int
    created_at: datetime | None = None
    changed_at: datetime | None = None
    adopted_at: datetime | None = None
    id: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class FrozenFigure:
    """A figure frozen as evidence; ``array`` is its JSON."""

    kind: str
    query: str
    title: str
    array: str
    author: str
    created_at: datetime | None = None
    id: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class SeenEvents:
    """Last event of a decision or model structure seen by an analyst."""

    analyst: str
    subject: str  # "decision 3", "structure 2"
    seen: int
    id: int | None = None


# --- ModelStructure: which inputs, outputs, modes and derivatives a model has ---------------------


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
