"""Audit trail of the decisions of a campaign."""

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
from flexsid.workflow.review.decision_review import apply_event, get_rules
from flexsid.workflow.review.evidence import (
    GONE,
    hash_evidence,
    is_chain_intact,
    list_software_versions,
)

CHECK = (
    "Every event is stored as text (sealed) with the SHA-256 of that text (hash), and the text has "
    "the hash of the event before (previous_hash), so every change is detectable. Names are as "
    "entered by the analysts and are not verified."
)


@dataclass(frozen=True, slots=True, kw_only=True)
class AuditedRun:
    """Summary of a linked run."""

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
    """A frozen figure with its content."""

    figure: FrozenFigure
    spec: dict[str, Any]


@dataclass(frozen=True, slots=True, kw_only=True)
class AuditedDecision:
    """A decision with its events and linked records.

    ``whole`` is true if no event was changed or removed and the events reproduce the state of
    the decision; ``changed_since`` lists evidence changed or deleted since the last event.
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
    """Collect the audit trail of all decisions of a campaign."""
    return _collect(store, aircraft_id, store.decisions.find(aircraft_id=aircraft_id))


def audit_decision(store: Store, decision_id: int) -> AuditTrail:
    """Collect the audit trail of one decision."""
    decision = store.decisions.get(decision_id)
    return _collect(store, decision.aircraft_id, [decision])


def replay(decision: Decision, events: list[DecisionEvent]) -> Decision:
    """Reconstruct the state of a decision from its events and constant fields."""
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
        state = apply_event(state, event)
    return state


def _collect(store: Store, aircraft_id: int, decisions: list[Decision]) -> AuditTrail:
    return AuditTrail(
        aircraft=store.aircraft.get(aircraft_id),
        exported_at=datetime.now(UTC),
        software=list_software_versions(),
        check=CHECK,
        rules=store.review_rules.find(aircraft_id=aircraft_id) or [get_rules(store, aircraft_id)],
        baselines=list_baselines(store, aircraft_id),
        decisions=[_audit(store, decision) for decision in decisions],
    )


def _audit(store: Store, decision: Decision) -> AuditedDecision:
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
    now, then = hash_evidence(store, decision.proposal), events[-1].data
    return AuditedDecision(
        decision=decision,
        events=events,
        whole=is_chain_intact(events) and replay(decision, events) == decision,
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
        runs=[found for number in runs if (found := _summarise_run(store, number)) is not None],
        figures=[
            AuditedFigure(figure=figure, spec=read_figure(store, figure))
            for figure in map(store.frozen_figures.get, figures)
        ],
    )


def read_figure(store: Store, figure: FrozenFigure) -> dict[str, Any]:
    """Read the content of a frozen figure."""
    return json.loads(store.arrays.get(figure.array).tobytes())


def _summarise_run(store: Store, run_id: int) -> AuditedRun | None:
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
