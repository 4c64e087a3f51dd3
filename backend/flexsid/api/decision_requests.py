"""What a client asks of the review of model structures, strictly read."""

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

# Said for good: never nothing but blanks.
Said = Annotated[
    str, StringConstraints(strip_whitespace=True, min_length=1, max_length=LONGEST_NOTE), Lines
]
Subject = Annotated[
    str, StringConstraints(strip_whitespace=True, min_length=1, max_length=LONGEST_NAME), Line
]
Ids = Annotated[tuple[Id, ...], Field(max_length=200)]


@dataclass(frozen=True, slots=True, kw_only=True)
class ReferenceRequest:
    """One version of one model structure."""

    id: Id
    version: Version

    __pydantic_config__ = _STRICT

    def record(self) -> StructureReference:
        """Return what is kept."""
        return StructureReference(id=self.id, version=self.version)


@dataclass(frozen=True, slots=True, kw_only=True)
class ComparisonRequest:
    """Runs and predictions to be compared, of one coefficient or all."""

    run_ids: Annotated[tuple[Id, ...], Field(min_length=1, max_length=200)]
    prediction_ids: Ids = ()
    coefficient: Annotated[str, Field(min_length=1, max_length=16), Line] | None = None

    __pydantic_config__ = _STRICT


@dataclass(frozen=True, slots=True, kw_only=True)
class ProposalRequest:
    """A model structure for a range of conditions, and what speaks for it.

    ``limits`` are closed intervals; without any it is proposed for all conditions.
    """

    title: Subject
    structure: ReferenceRequest
    reasoning: Said
    changes: ReferenceRequest | None = None
    limits: dict[LimitedQuantity, tuple[Number, Number]] | None = None
    run_ids: Ids = ()
    comparisons: Annotated[tuple[ComparisonRequest, ...], Field(max_length=50)] = ()
    figure_ids: Annotated[tuple[Id, ...], Field(max_length=50)] = ()

    __pydantic_config__ = _STRICT

    def record(self) -> StructureProposal:
        """Return what is kept."""
        return StructureProposal(
            title=self.title,
            structure=self.structure.record(),
            changes=None if self.changes is None else self.changes.record(),
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
    """Another proposal in the place of ``revision``."""

    revision: Version
    proposal: ProposalRequest

    __pydantic_config__ = _STRICT


@dataclass(frozen=True, slots=True, kw_only=True)
class CommentRequest:
    """What is said of a decision as a whole, or of one derivative."""

    text: Said
    derivative: Annotated[str, Field(min_length=1, max_length=64), Line] | None = None

    __pydantic_config__ = _STRICT


@dataclass(frozen=True, slots=True, kw_only=True)
class VoteRequest:
    """A vote on ``revision``, and why."""

    revision: Version
    vote: Vote
    text: Said

    __pydantic_config__ = _STRICT


@dataclass(frozen=True, slots=True, kw_only=True)
class WithdrawalRequest:
    """Why ``revision`` is taken back."""

    revision: Version
    text: Said

    __pydantic_config__ = _STRICT


@dataclass(frozen=True, slots=True, kw_only=True)
class RulesRequest:
    """Rules of review on top of ``version``, and why they change."""

    quorum: Annotated[int, Field(strict=True, ge=1, le=50)]
    own_allowed: Annotated[bool, Field(strict=True)]
    version: Annotated[int, Field(strict=True, ge=0, le=2**31 - 2)]
    reason: Said

    __pydantic_config__ = _STRICT

    def record(self, aircraft_id: int, author: str) -> ReviewRules:
        """Return the rules that are wanted, with the version they were read in."""
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
    """A figure of ``GET /figures/{kind}?{query}``, to be kept as it is now."""

    kind: Annotated[str, Field(pattern=r"^[a-z]+(-[a-z]+)*$", max_length=64)]
    query: Annotated[str, Field(pattern=r"^[!-~]*$", max_length=2000)]
    title: Title

    __pydantic_config__ = _STRICT
