"""Request models of the review of model structures, validated strictly."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from pydantic import ConfigDict, Field, StringConstraints

from flexsid.api.requests import Id, Line, Lines, Number, Title, Version
from flexsid.records.decision import (
    LimitedQuantity,
    LinkedComparison,
    ReviewRules,
    StructureProposal,
    StructureReference,
    Vote,
)
from flexsid.text import LONGEST_NAME, LONGEST_NOTE

_STRICT = ConfigDict(extra="forbid")

# Stored permanently, therefore not blank.
RequiredText = Annotated[
    str, StringConstraints(strip_whitespace=True, min_length=1, max_length=LONGEST_NOTE), Lines
]
RequiredLine = Annotated[
    str, StringConstraints(strip_whitespace=True, min_length=1, max_length=LONGEST_NAME), Line
]
Ids = Annotated[tuple[Id, ...], Field(max_length=200)]


@dataclass(frozen=True, slots=True, kw_only=True)
class ReferenceRequest:
    """One version of one model structure."""

    id: Id
    version: Version

    __pydantic_config__ = _STRICT

    def to_record(self) -> StructureReference:
        """Return the record to be stored."""
        return StructureReference(id=self.id, version=self.version)


@dataclass(frozen=True, slots=True, kw_only=True)
class ComparisonRequest:
    """Runs and predictions to compare, for one coefficient or all."""

    run_ids: Annotated[tuple[Id, ...], Field(min_length=1, max_length=200)]
    prediction_ids: Ids = ()
    coefficient: Annotated[str, Field(min_length=1, max_length=16), Line] | None = None

    __pydantic_config__ = _STRICT


@dataclass(frozen=True, slots=True, kw_only=True)
class ProposalRequest:
    """A proposed model structure for a range of conditions, with its reasoning and evidence.

    ``limits`` are closed intervals; without limits it is proposed for all conditions.
    """

    title: RequiredLine
    structure: ReferenceRequest
    reasoning: RequiredText
    changes: ReferenceRequest | None = None
    limits: dict[LimitedQuantity, tuple[Number, Number]] | None = None
    run_ids: Ids = ()
    comparisons: Annotated[tuple[ComparisonRequest, ...], Field(max_length=50)] = ()
    figure_ids: Annotated[tuple[Id, ...], Field(max_length=50)] = ()

    __pydantic_config__ = _STRICT

    def to_record(self) -> StructureProposal:
        """Return the record to be stored."""
        return StructureProposal(
            title=self.title,
            structure=self.structure.to_record(),
            changes=None if self.changes is None else self.changes.to_record(),
            limits=dict(self.limits or {}),
            reasoning=self.reasoning,
            run_ids=tuple(dict.fromkeys(self.run_ids)),
            comparisons=tuple(
                LinkedComparison(
                    run_ids=one.run_ids,
                    prediction_ids=one.prediction_ids,
                    coefficient=one.coefficient,
                )
                for one in self.comparisons
            ),
            figure_ids=tuple(dict.fromkeys(self.figure_ids)),
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class RevisionRequest:
    """A proposal that replaces ``revision``."""

    revision: Version
    proposal: ProposalRequest

    __pydantic_config__ = _STRICT


@dataclass(frozen=True, slots=True, kw_only=True)
class CommentRequest:
    """A comment on a decision, or on one derivative."""

    text: RequiredText
    derivative: Annotated[str, Field(min_length=1, max_length=64), Line] | None = None

    __pydantic_config__ = _STRICT


@dataclass(frozen=True, slots=True, kw_only=True)
class VoteRequest:
    """A vote on ``revision``, with its reason."""

    revision: Version
    vote: Vote
    text: RequiredText

    __pydantic_config__ = _STRICT


@dataclass(frozen=True, slots=True, kw_only=True)
class WithdrawalRequest:
    """The reason for withdrawing ``revision``."""

    revision: Version
    text: RequiredText

    __pydantic_config__ = _STRICT


@dataclass(frozen=True, slots=True, kw_only=True)
class RulesRequest:
    """Review rules that replace ``version``, with the reason for the change."""

    quorum: Annotated[int, Field(strict=True, ge=1, le=50)]
    own_allowed: Annotated[bool, Field(strict=True)]
    version: Annotated[int, Field(strict=True, ge=0, le=2**31 - 2)]
    reason: RequiredText

    __pydantic_config__ = _STRICT

    def to_record(self, aircraft_id: int, author: str) -> ReviewRules:
        """Return the requested rules, with the version that they replace."""
        return ReviewRules(
            aircraft_id=aircraft_id,
            quorum=self.quorum,
            own_allowed=self.own_allowed,
            version=self.version,
            reason=self.reason,
            author=author,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class FreezeRequest:
    """A figure of ``GET /figures/{kind}?{query}``, to be stored in its current state."""

    kind: Annotated[str, Field(pattern=r"^[a-z]+(-[a-z]+)*$", max_length=64)]
    query: Annotated[str, Field(pattern=r"^[!-~]*$", max_length=2000)]
    title: Title

    __pydantic_config__ = _STRICT
