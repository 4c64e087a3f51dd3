"""Response models of the review of models."""

from __future__ import annotations

from dataclasses import dataclass

from flexsid.api.errors import Problem
from flexsid.records.decision import (
    Decision,
    DecisionEvent,
    FrozenFigure,
    ModelProposal,
    ReviewRules,
)
from flexsid.records.global_model import GlobalModelVersion
from flexsid.records.model_structure import StructureVersion
from flexsid.workflow.model_structures.baselines import Baseline


@dataclass(frozen=True, slots=True, kw_only=True)
class DecisionItem(Decision):
    """A decision with the name of the proposed model structure or global model."""

    model_name: str


@dataclass(frozen=True, slots=True, kw_only=True)
class DecisionDetail(Decision):
    """A decision with its events, rules, proposed model and figures.

    ``newest_version`` is the newest version of the proposed structure, or global model.
    """

    rules: ReviewRules
    events: list[DecisionEvent]
    structure: StructureVersion | None
    global_model: GlobalModelVersion | None
    newest_version: int
    changes: StructureVersion | None
    figures: list[FrozenFigure]


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
