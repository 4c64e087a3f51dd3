"""Audit: the whole story of the decisions of a campaign, in one value to be handed on."""

from __future__ import annotations

import json
from dataclasses import dataclass
from datetime import UTC, datetime
from itertools import chain
from typing import Any

from flexsid.errors import UnknownRecord
from flexsid.records.aircraft import Aircraft
from flexsid.records.decision import (
    Decision,
    DecisionEvent,
    DecisionState,
    FrozenFigure,
    ReviewRules,
)
from flexsid.records.model_structure import StructureVersion
from flexsid.records.run import EstimationRun, ParameterEstimate
from flexsid.storage.store import Store
from flexsid.workflow.model_structures.baselines import Baseline, list_baselines
from flexsid.workflow.review.decision_review import after_event, rules_of
from flexsid.workflow.review.evidence import GONE, chain_is_whole, data_of, software

CHECK = (
    "Every event is kept as text (sealed) with the SHA-256 of that text (hash), and the text holds "
    "the hash of the event before (previous_hash), so none can be changed unseen. Names are as the "
    "analysts set them; nobody verified them."
)


@dataclass(frozen=True, slots=True, kw_only=True)
class AuditedRun:
    """What a linked run was and gave, in short."""

    id: int
    maneuver_id: int
    maneuver_label: str
    method: str
    author: str
    created_at: datetime | None
    structure_id: int | None
    structure_version: int | None
    outcome: str | None
    r_squared: dict[str, float]
    parameters: tuple[ParameterEstimate, ...]
    versions: dict[str, str] | None


@dataclass(frozen=True, slots=True, kw_only=True)
class AuditedFigure:
    """A frozen figure with what it shows."""

    figure: FrozenFigure
    spec: dict[str, Any]


@dataclass(frozen=True, slots=True, kw_only=True)
class AuditedDecision:
    """A decision with its events and all that they point to.

    ``whole`` tells that no event was changed or taken out and that the events lead to
    where the decision stands; ``changed_since`` names what it rests on that is not any
    more what it was at the last event (or is gone).
    """

    decision: Decision
    events: list[DecisionEvent]
    whole: bool
    changed_since: list[str]
    structures: list[StructureVersion]
    runs: list[AuditedRun]
    figures: list[AuditedFigure]


@dataclass(frozen=True, slots=True, kw_only=True)
class AuditTrail:
    """Decisions of a campaign with its rules and baselines, as they stood at ``exported_at``."""

    aircraft: Aircraft
    exported_at: datetime
    software: dict[str, str]
    check: str
    rules: list[ReviewRules]
    baselines: list[Baseline]
    decisions: list[AuditedDecision]


def audit_campaign(store: Store, aircraft_id: int) -> AuditTrail:
    """Gather the story of every decision of a campaign."""
    return _trail(store, aircraft_id, store.decisions.find(aircraft_id=aircraft_id))


def audit_decision(store: Store, decision_id: int) -> AuditTrail:
    """Gather the story of one decision."""
    decision = store.decisions.get(decision_id)
    return _trail(store, decision.aircraft_id, [decision])


def replay(decision: Decision, events: list[DecisionEvent]) -> Decision:
    """Return where the events alone lead; of the record only what never changes is used."""
    proposal = events[0].proposal
    assert proposal is not None
    state = Decision(
        aircraft_id=decision.aircraft_id,
        axis=decision.axis,
        proposal=proposal,
        state=DecisionState.OPEN,
        revision=1,
        authors=(),
        version=0,
        created_at=decision.created_at,
        id=decision.id,
    )
    for event in events:
        state = after_event(state, event)
    return state


def _trail(store: Store, aircraft_id: int, decisions: list[Decision]) -> AuditTrail:
    return AuditTrail(
        aircraft=store.aircraft.get(aircraft_id),
        exported_at=datetime.now(UTC),
        software=software(),
        check=CHECK,
        rules=store.review_rules.find(aircraft_id=aircraft_id) or [rules_of(store, aircraft_id)],
        baselines=list_baselines(store, aircraft_id),
        decisions=[_audited(store, decision) for decision in decisions],
    )


def _audited(store: Store, decision: Decision) -> AuditedDecision:
    events = store.decision_events.find(decision_id=decision.id)
    proposals = [event.proposal for event in events if event.proposal is not None]
    structures = dict.fromkeys(
        reference.id
        for one in proposals
        for reference in (one.structure, one.changes)
        if reference is not None
    )
    runs = dict.fromkeys(
        run_id
        for one in proposals
        for run_id in (*one.run_ids, *chain.from_iterable(c.run_ids for c in one.comparisons))
    )
    figures = dict.fromkeys(chain.from_iterable(one.figure_ids for one in proposals))
    now, then = data_of(store, decision.proposal), events[-1].data
    return AuditedDecision(
        decision=decision,
        events=events,
        whole=chain_is_whole(events) and replay(decision, events) == decision,
        changed_since=[
            f"{name} ({GONE if now.get(name) == GONE else 'changed'})"
            for name in then
            if now.get(name) != then[name]
        ],
        structures=list(
            chain.from_iterable(
                store.structure_versions.find(structure_id=number) for number in structures
            )
        ),
        runs=[found for number in runs if (found := _run(store, number)) is not None],
        figures=[
            AuditedFigure(figure=figure, spec=figure_spec(store, figure))
            for figure in map(store.frozen_figures.get, figures)
        ],
    )


def figure_spec(store: Store, figure: FrozenFigure) -> dict[str, Any]:
    """Return what a frozen figure shows."""
    return json.loads(store.arrays.get(figure.array).tobytes())


def _run(store: Store, run_id: int) -> AuditedRun | None:
    try:
        run: EstimationRun = store.runs.get(run_id)
        label = store.maneuvers.get(run.maneuver_id).label
    except UnknownRecord:
        return None
    result = run.result
    assert run.id is not None
    return AuditedRun(
        id=run.id,
        maneuver_id=run.maneuver_id,
        maneuver_label=label,
        method=run.method.value,
        author=run.author,
        created_at=run.created_at,
        structure_id=run.structure_id,
        structure_version=run.structure_version,
        outcome=None if result is None else result.fit.outcome,
        r_squared={} if result is None else result.fit.r_squared,
        parameters=() if result is None else result.parameters,
        versions=run.versions,
    )
