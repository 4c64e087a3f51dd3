"""Audit trail of the decisions of a campaign."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Sequence
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
    EventKind,
    FrozenFigure,
    Limits,
    ModelProposal,
    ReviewRules,
    StructureReference,
    StructureVersion,
)
from flexsid.records.global_model import GlobalModelVersion
from flexsid.records.run import EstimationRun, ParameterEstimate
from flexsid.storage.audit_recording import is_chain_intact
from flexsid.storage.store import Store
from flexsid.sysid.model.derivatives import RIGID_BODIES, list_derivative_names
from flexsid.workflow.model_structures.baselines import Baseline, list_baselines
from flexsid.workflow.model_structures.model_structures import (
    describe_derivative_state,
    list_structure_differences,
)
from flexsid.workflow.review.decision_review import apply_event, get_rules
from flexsid.workflow.review.evidence import GONE, hash_evidence, list_software_versions
from flexsid.workflow.review.frozen_sheet import hash_frozen_sheets

CHECK = (
    "Every event is stored as text (sealed) with the SHA-256 of that text (hash), and the text has "
    "the hash of the event before (previous_hash), so every change is detectable. Verified names "
    "are those of accounts; others are as entered by the analysts."
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
    global_models: list[GlobalModelVersion]
    runs: list[AuditedRun]
    figures: list[AuditedFigure]


@dataclass(frozen=True, slots=True, kw_only=True)
class AuditTrail:
    """Decisions of a campaign with its rules and baselines, as they stood at ``exported_at``.

    ``signature`` is that of the site, written into the file.
    """

    aircraft: Aircraft
    exported_at: datetime
    software: dict[str, str]
    check: str
    rules: list[ReviewRules]
    baselines: list[Baseline]
    decisions: list[AuditedDecision]
    signature: str | None = None


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
    runs = dict.fromkeys(chain.from_iterable(one.all_run_ids for one in proposals))
    figures = dict.fromkeys(chain.from_iterable(one.figure_ids for one in proposals))
    then = events[-1].data if events else {}
    now = hash_evidence(store, decision.proposal) | hash_frozen_sheets(store, then)
    return AuditedDecision(
        decision=decision,
        events=events,
        whole=bool(events) and is_chain_intact(events) and replay(decision, events) == decision,
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
        global_models=[
            store.global_model_versions.get(number)
            for number in dict.fromkeys(one.global_model_id for one in proposals)
            if number is not None
        ],
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


_UNITS = {
    "dynamic_pressure_pa": ("dynamic pressure", "Pa"),
    "fuel_fraction": ("fuel fraction", ""),
    "airspeed_m_s": ("airspeed", "m/s"),
    "airspeed_ratio": ("V/V_f", ""),
    "alpha_rad": ("angle of attack", "rad"),
}
_DONE = {
    EventKind.PROPOSED: "proposed",
    EventKind.REVISED: "revised the proposal",
    EventKind.COMMENTED: "commented",
    EventKind.WITHDRAWN: "withdrew the proposal",
    EventKind.ADOPTED: "made it the baseline with the last approval",
    EventKind.DECLINED: "ended it with the last rejection",
    EventKind.SUPERSEDED: "superseded it with a later baseline",
    EventKind.NARROWED: "took a part of its range over with a later baseline",
}
_VOTED = {
    "approve": "approved",
    "request-changes": "asked for changes",
    "reject": "rejected",
}


def write_markdown(trail: AuditTrail) -> str:
    """Write an audit trail as Markdown."""
    return "\n\n".join(_write_trail(trail)) + "\n"


def describe_limits(limits: Limits) -> str:
    """Describe the range of flight conditions."""
    parts = []
    for quantity, (low, high) in limits.items():
        name, unit = _UNITS[quantity.value]
        parts.append(f"{name} {low:g} to {high:g} {unit}".rstrip())
    return ", ".join(parts) or "all conditions"


def _write_trail(trail: AuditTrail) -> Iterator[str]:
    """Write the blocks of a trail, which blank lines separate."""
    surfaces = tuple(surface.name for surface in trail.aircraft.surfaces)
    yield f"# Decisions on the models of {_text(trail.aircraft.name)}"
    yield (
        f"Exported {_time(trail.exported_at)} by flexsid {trail.software['flexsid']}\n"
        f"(source {trail.software['source']}). {trail.check}"
    )
    yield "## Rules of review"
    yield _itemise(_format_rules(rules) for rules in trail.rules)
    yield "## Baselines, the latest first"
    baselines = _itemise(
        f"{describe_limits(one.limits)}: {_text(one.structure.name)}, version"
        f" {one.structure.version} of model structure {one.structure.structure_id}"
        f" (decision {one.decision_id}, approved by {_text(', '.join(one.approved_by))})"
        for one in trail.baselines
    )
    yield baselines or "None."
    for audited in trail.decisions:
        yield from _write_decision(audited, surfaces)


def _write_decision(audited: AuditedDecision, surfaces: Sequence[str]) -> Iterator[str]:
    decision = audited.decision
    yield f"## Decision {decision.id}: {_text(decision.proposal.title)}"
    intact = "are intact: every hash is valid, and none is missing"
    state = intact if audited.whole else "**were modified after they were written**"
    lines = [f"State: **{decision.state.value}**, revision {decision.revision}."]
    if decision.superseded_by is not None:
        lines.append(f"Superseded by decision {decision.superseded_by}.")
    lines.append(f"The {len(audited.events)} events {state}.")
    if audited.changed_since:
        lines.append(f"Changed since the last event: {', '.join(audited.changed_since)}.")
    yield "\n".join(lines)
    previous: ModelProposal | None = None
    for event in audited.events:
        yield from _write_event(event, previous, audited.structures, surfaces)
        previous = event.proposal or previous
    if audited.structures:
        yield "### Structures"
    for version in audited.structures:
        yield from _write_structure(version, surfaces)
    if audited.global_models:
        yield "### Global models"
        yield _itemise(
            f"{_text(one.name)}, by {_text(one.author)}, {_time(one.created_at)}, of "
            f"{len(one.runs)} runs, SHA-256 `{one.result}`: {_text(one.sentence)}"
            for one in audited.global_models
        )
    if audited.runs:
        yield "### Runs"
    for run in audited.runs:
        yield from _write_run(run)
    if audited.figures:
        yield "### Frozen figures"
        yield _itemise(
            f"Figure {one.id}: {_text(one.title)}, `{one.kind}?{one.query}`, frozen "
            f"{_time(one.created_at)} by {_text(one.author)}, SHA-256 `{one.array}`"
            for one in (audited_figure.figure for audited_figure in audited.figures)
        )


def _write_event(
    event: DecisionEvent,
    previous: ModelProposal | None,
    structures: Sequence[StructureVersion],
    surfaces: Sequence[str],
) -> Iterator[str]:
    done = _DONE.get(event.kind) or _VOTED[event.vote or ""]
    about = f" on {event.derivative}" if event.derivative else ""
    name = f"{_text(event.author)} ({'verified' if event.author_verified else 'unverified'})"
    yield f"### {event.number}. {_time(event.created_at)}: {name} {done}{about}"
    yield "\n".join(f"> {_text(line)}" for line in event.text.splitlines() or [""])
    items: list[str] = []
    if event.proposal is not None:
        items += _list_proposal(event.proposal, previous, structures, surfaces)
    if event.rules is not None:
        items.append(f"Rules in force: {_format_rules(event.rules)}")
    if event.by_decision_id is not None:
        items.append(f"By decision {event.by_decision_id}")
    versions = ", ".join(f"{name} {value}" for name, value in event.software.items())
    data = "".join(f"\n  - {name} `{value}`" for name, value in event.data.items())
    yield _itemise(
        (
            *items,
            f"Revision {event.revision}",
            f"Data `{event.data_hash}`:{data}",
            f"Software: {versions}",
            f"Event `{event.hash}` after `{event.previous_hash or 'none'}`",
        )
    )


def _list_proposal(
    proposal: ModelProposal,
    previous: ModelProposal | None,
    structures: Sequence[StructureVersion],
    surfaces: Sequence[str],
) -> Iterator[str]:
    found = {StructureReference(id=s.structure_id, version=s.version): s for s in structures}

    def format_reference(reference: StructureReference) -> str:
        stored = found.get(reference)
        name = "" if stored is None else f" ({_text(stored.name)})"
        return f"model structure {reference.id}, version {reference.version}{name}"

    yield f"Title: {_text(proposal.title)}"
    if proposal.structure is None:
        yield f"Proposes global model {proposal.global_model_id} for the envelope of its runs"
    else:
        yield f"Proposes {format_reference(proposal.structure)}"
        yield f"For {describe_limits(proposal.limits)}"
    before = proposal.changes or (None if previous is None else previous.structure)
    if before is not None and proposal.structure is not None and proposal.structure != before:
        one, other = found.get(before), found.get(proposal.structure)
        changes = ""
        if one is not None and other is not None:
            changes = "".join(
                f"\n  - {what}: {was} → {now}"
                for what, was, now in list_structure_differences(
                    one.structure, other.structure, surfaces
                )
            )
        yield f"Changes to {format_reference(before)}:{changes}"
    if proposal.run_ids:
        yield f"Runs: {_join(proposal.run_ids)}"
    for comparison in proposal.comparisons:
        yield (
            f"Comparison of runs {_join(comparison.run_ids)}, predictions "
            f"{_join(comparison.prediction_ids)}, {comparison.coefficient or 'all coefficients'}"
        )
    if proposal.figure_ids:
        yield f"Frozen figures: {_join(proposal.figure_ids)}"


def _write_structure(version: StructureVersion, surfaces: Sequence[str]) -> Iterator[str]:
    structure = version.structure
    yield (
        f"#### Model structure {version.structure_id}, version {version.version}: "
        f"{_text(version.name)}"
    )
    note = f"\n{_text(version.note)}" if version.note else ""
    yield f"By {_text(version.author) or 'unknown'}, {_time(version.created_at)}.{note}"
    states: dict[str, list[str]] = {}
    for name in list_derivative_names(
        structure.modes, structure.inputs or tuple(surfaces), RIGID_BODIES[structure.axis]
    ):
        states.setdefault(describe_derivative_state(structure, name), []).append(name)
    output_delays = ["a delay of every output"] if structure.free_delays else []
    further = {
        "further free parameters": [*structure.extra_parameters, *output_delays],
        "delays": [f"{name} {value}" for name, value in structure.delays.items()],
        "instruments": [f"{name} {value}" for name, value in structure.instruments.items()],
    }
    yield _itemise(
        (
            f"Axis {structure.axis}; modes {_join(structure.modes)}",
            f"Inputs {', '.join(structure.inputs) or 'all of the maneuver'}",
            f"Outputs {', '.join(structure.outputs) or 'all suitable'}",
            *(f"{what}: {', '.join(names)}" for what, names in (states | further).items() if names),
        )
    )


def _write_run(run: AuditedRun) -> Iterator[str]:
    structure = (
        f"model structure {run.structure_id}, version {run.structure_version}"
        if run.structure_id is not None
        else "its own model structure"
    )
    yield (
        f"#### Run {run.id}: {run.method} of {_text(run.maneuver_label)} (maneuver "
        f"{run.maneuver_id}), {run.outcome or 'without result'}, with {structure}"
    )
    rows = ["| parameter | value | σ |", "| --- | --- | --- |"]
    for one in run.parameters:
        sigma = "–" if one.std_error is None else f"{one.std_error:.3g}"
        rows.append(f"| {one.name} | {one.value:.5g} | {sigma} |")
    yield "\n".join(rows)


def _itemise(items: Iterable[str]) -> str:
    return "\n".join(f"- {item}" for item in items)


def _join(numbers: Iterable[int]) -> str:
    return ", ".join(map(str, numbers)) or "none"


def _format_rules(rules: ReviewRules) -> str:
    own = "own proposals allowed" if rules.own_allowed else "no votes on own proposals"
    text = f"version {rules.version}: quorum {rules.quorum}, {own}"
    if rules.created_at is None:
        return text
    return f"{text}; {_text(rules.author)}, {_time(rules.created_at)}: {_text(rules.reason)}"


def _time(at: datetime | None) -> str:
    return "–" if at is None else at.strftime("%Y-%m-%d %H:%M:%S UTC")


def _text(text: str) -> str:
    """Escape Markdown and HTML in user text."""
    for mark in "\\`*_[]<>#|":
        text = text.replace(mark, f"\\{mark}")
    return " ".join(text.split())
