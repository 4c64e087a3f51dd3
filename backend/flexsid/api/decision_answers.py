"""Answers about the review of model structures."""

from __future__ import annotations

from dataclasses import dataclass

from flexsid.api.errors import Problem
from flexsid.records.decision import (
    Decision,
    DecisionEvent,
    FrozenFigure,
    ReviewRules,
    StructureProposal,
)
from flexsid.records.model_structure import StructureVersion
from flexsid.workflow.model_structures.baselines import Baseline


@dataclass(frozen=True, slots=True, kw_only=True)
class DecisionItem(Decision):
    """A decision with the name of the structure that it proposes."""

    structure_name: str


@dataclass(frozen=True, slots=True, kw_only=True)
class DecisionList:
    """Decisions, newest first."""

    items: list[DecisionItem]


@dataclass(frozen=True, slots=True, kw_only=True)
class DecisionDetail(Decision):
    """A decision with its events, rules and what it proposes.

    ``newest_version`` is that of the proposed structure by now.
    """

    rules: ReviewRules
    events: list[DecisionEvent]
    structure: StructureVersion
    newest_version: int
    changes: StructureVersion | None
    figures: list[FrozenFigure]


@dataclass(frozen=True, slots=True, kw_only=True)
class StaleProposal(Problem):
    """Why a vote or revision was refused: ``current`` stands in the place of ``base`` by now."""

    base: StructureProposal
    current: StructureProposal
    sent: StructureProposal | None
    revision: int


@dataclass(frozen=True, slots=True, kw_only=True)
class RulesHistory:
    """Rules of review in force, and all of them, oldest first."""

    current: ReviewRules
    items: list[ReviewRules]


@dataclass(frozen=True, slots=True, kw_only=True)
class ManeuverBaseline:
    """The baseline of a maneuver; none where nothing was approved for its condition."""

    maneuver_id: int
    baseline: Baseline | None


@dataclass(frozen=True, slots=True, kw_only=True)
class BaselineList:
    """Baselines of a campaign, the one approved last first."""

    items: list[Baseline]


@dataclass(frozen=True, slots=True, kw_only=True)
class ManeuverBaselineList:
    """Baselines of maneuvers, in the order asked for."""

    items: list[ManeuverBaseline]
