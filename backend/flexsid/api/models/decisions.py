"""Models of requests and responses of the review of models."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated

from pydantic import Field, StringConstraints

from flexsid.api.errors import Problem
from flexsid.api.models.requests import Id, Line, Lines, Number, Request, Text, Title, Version
from flexsid.records.decision import (
    Decision,
    DecisionEvent,
    FrozenFigure,
    LimitedQuantity,
    LinkedComparison,
    ModelProposal,
    ReviewRules,
    StructureReference,
    StructureVersion,
    Vote,
)
from flexsid.records.global_model import GlobalModelVersion
from flexsid.records.note import NoteSubject
from flexsid.request_models import body_of
from flexsid.text import LONGEST_NOTE
from flexsid.workflow.model_structures.baselines import Baseline

# --- Request models of the review of models, validated strictly -----------------------------------

# Stored permanently, therefore not blank.
RequiredText = Annotated[
    str, StringConstraints(strip_whitespace=True, min_length=1, max_length=LONGEST_NOTE), Lines
]


@body_of(StructureReference)
class ReferenceRequest(Request):
    """One version of one model structure."""


@body_of(LinkedComparison)
class ComparisonRequest(Request):
    """Runs and predictions to compare, for one coefficient or all."""


@body_of(ModelProposal, without=("limits",))
class ProposalRequest(Request):
    """A proposed model structure or global model, with its reasoning and evidence.

    ``limits`` are closed intervals; without limits a structure is proposed for all conditions.
    A global model is proposed for the envelope of its runs, which are its evidence.
    """

    limits: dict[LimitedQuantity, tuple[Number, Number]] | None = None

    def to_record(self) -> ModelProposal:
        """Return the proposal to be stored."""
        proposal = self.make_record(ModelProposal, limits=self.limits or {})
        return replace(
            proposal,
            run_ids=tuple(dict.fromkeys(proposal.run_ids)),
            figure_ids=tuple(dict.fromkeys(proposal.figure_ids)),
        )


class RevisionRequest(Request):
    """A proposal that replaces ``revision``."""

    revision: Version
    proposal: ProposalRequest


class CommentRequest(Request):
    """A comment on a decision, or on one derivative."""

    text: RequiredText
    derivative: Annotated[str, Field(min_length=1, max_length=64), Line] | None = None


class VoteRequest(Request):
    """A vote on ``revision``, with its reason.

    ``despite`` is the reason for an approval where the evidence has warnings.
    """

    revision: Version
    vote: Vote
    text: RequiredText
    despite: Text = ""


class WithdrawalRequest(Request):
    """The reason for withdrawing ``revision``."""

    revision: Version
    text: RequiredText


class RulesRequest(Request):
    """Review rules that replace ``version``, with the reason for the change."""

    quorum: Annotated[int, Field(strict=True, ge=1, le=50)]
    own_allowed: Annotated[bool, Field(strict=True)]
    version: Annotated[int, Field(strict=True, ge=0, le=2**31 - 2)]
    reason: RequiredText


class NoteRequest(Request):
    """A note in Markdown.

    ``key`` is the id of the maneuver or run, the number of the mode or the name of the derivative;
    the latter two need ``aircraft_id``.
    """

    subject: NoteSubject
    key: Annotated[str, Field(min_length=1, max_length=64), Line]
    text: RequiredText
    aircraft_id: Id | None = None


class NoteEditRequest(Request):
    """The text that replaces ``revision`` of a note."""

    revision: Version
    text: RequiredText


class FreezeRequest(Request):
    """A figure of ``GET /figures/{kind}?{query}``, to be stored in its current state."""

    kind: Annotated[str, Field(pattern=r"^[a-z]+(-[a-z]+)*$", max_length=64)]
    query: Annotated[str, Field(pattern=r"^[!-~]*$", max_length=2000)]
    title: Title


# --- Response models of the review of models ------------------------------------------------------


@dataclass(frozen=True, slots=True, kw_only=True)
class DecisionItem(Decision):
    """A decision with the name of the proposed model structure or global model."""

    model_name: str


@dataclass(frozen=True, slots=True, kw_only=True)
class DecisionDetail(Decision):
    """A decision with its events, rules, proposed model and figures.

    ``newest_version`` is the newest version of the proposed structure, or global model; ``sheets``
    are those of the flight conditions of its runs, frozen when the decision was made.
    """

    rules: ReviewRules
    events: list[DecisionEvent]
    structure: StructureVersion | None
    global_model: GlobalModelVersion | None
    newest_version: int
    changes: StructureVersion | None
    figures: list[FrozenFigure]
    sheets: list[FrozenFigure]


@dataclass(frozen=True, slots=True, kw_only=True)
class StaleProposal(Problem):
    """Why a vote or revision was refused: ``current`` has replaced ``base``."""

    base: ModelProposal
    current: ModelProposal
    sent: ModelProposal | None
    revision: int


@dataclass(frozen=True, slots=True, kw_only=True)
class RulesHistory:
    """Review rules in force, and all earlier ones, oldest first."""

    current: ReviewRules
    items: list[ReviewRules]


@dataclass(frozen=True, slots=True, kw_only=True)
class ManeuverBaseline:
    """The baseline of a maneuver; none if no structure was approved for its condition."""

    maneuver_id: int
    baseline: Baseline | None
