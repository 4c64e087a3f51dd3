"""Audit trail as Markdown, with all hashes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from datetime import datetime

from flexsid.records.decision import (
    DecisionEvent,
    EventKind,
    Limits,
    ReviewRules,
    StructureProposal,
    StructureReference,
)
from flexsid.records.model_structure import Structure, StructureVersion
from flexsid.sysid.model.derivatives import list_derivative_names
from flexsid.workflow.model_structures.structure_difference import (
    describe_derivative_state,
    list_structure_differences,
)
from flexsid.workflow.review.audit import AuditedDecision, AuditedRun, AuditTrail

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
    return "\n".join(_write_trail(trail)) + "\n"


def describe_limits(limits: Limits) -> str:
    """Describe the range of flight conditions."""
    parts = []
    for quantity, (low, high) in limits.items():
        name, unit = _UNITS[quantity.value]
        parts.append(f"{name} {low:g} to {high:g} {unit}".rstrip())
    return ", ".join(parts) or "all conditions"


def _write_trail(trail: AuditTrail) -> Iterator[str]:
    surfaces = tuple(surface.name for surface in trail.aircraft.surfaces)
    yield f"# Decisions on the model structure of {_text(trail.aircraft.name)}"
    yield ""
    yield f"Exported {_time(trail.exported_at)} by flexsid {trail.software['flexsid']}"
    yield f"(source {trail.software['source']}). {trail.check}"
    yield ""
    yield "## Rules of review"
    yield ""
    for rules in trail.rules:
        yield f"- {_format_rules(rules)}"
    yield ""
    yield "## Baselines, the latest first"
    yield ""
    for baseline in trail.baselines:
        stored = baseline.structure
        yield (
            f"- {describe_limits(baseline.limits)}: {_text(stored.name)}, version"
            f" {stored.version} of model structure {stored.structure_id}"
            f" (decision {baseline.decision_id}, approved by"
            f" {_text(', '.join(baseline.approved_by))})"
        )
    if not trail.baselines:
        yield "None."
    for audited in trail.decisions:
        yield ""
        yield from _write_decision(audited, surfaces)


def _write_decision(audited: AuditedDecision, surfaces: Sequence[str]) -> Iterator[str]:
    decision = audited.decision
    yield f"## Decision {decision.id}: {_text(decision.proposal.title)}"
    yield ""
    yield f"State: **{decision.state.value}**, revision {decision.revision}."
    if decision.superseded_by is not None:
        yield f"Superseded by decision {decision.superseded_by}."
    intact = "are intact: every hash is valid, and none is missing"
    state = intact if audited.whole else "**were modified after they were written**"
    yield f"The {len(audited.events)} events {state}."
    if audited.changed_since:
        yield f"Changed since the last event: {', '.join(audited.changed_since)}."
    previous: StructureProposal | None = None
    for event in audited.events:
        yield ""
        yield from _write_event(event, previous, audited.structures, surfaces)
        previous = event.proposal or previous
    yield ""
    yield "### Structures"
    for version in audited.structures:
        yield ""
        yield from _write_structure(version, surfaces)
    if audited.runs:
        yield ""
        yield "### Runs"
    for run in audited.runs:
        yield ""
        yield from _write_run(run)
    if audited.figures:
        yield ""
        yield "### Frozen figures"
        yield ""
    for one in audited.figures:
        figure = one.figure
        yield (
            f"- Figure {figure.id}: {_text(figure.title)}, `{figure.kind}?{figure.query}`, frozen "
            f"{_time(figure.created_at)} by {_text(figure.author)}, SHA-256 `{figure.array}`"
        )


def _write_event(
    event: DecisionEvent,
    previous: StructureProposal | None,
    structures: Sequence[StructureVersion],
    surfaces: Sequence[str],
) -> Iterator[str]:
    done = _DONE.get(event.kind) or _VOTED[event.vote or ""]
    about = f" on {event.derivative}" if event.derivative else ""
    name = f"{_text(event.author)} ({'verified' if event.author_verified else 'unverified'})"
    yield f"### {event.number}. {_time(event.created_at)}: {name} {done}{about}"
    yield ""
    yield from (f"> {_text(line)}" for line in event.text.splitlines() or [""])
    yield ""
    if event.proposal is not None:
        yield from _write_proposal(event.proposal, previous, structures, surfaces)
    if event.rules is not None:
        yield f"- Rules in force: {_format_rules(event.rules)}"
    if event.by_decision_id is not None:
        yield f"- By decision {event.by_decision_id}"
    yield f"- Revision {event.revision}"
    yield f"- Data `{event.data_hash}`:"
    yield from (f"  - {name} `{value}`" for name, value in event.data.items())
    versions = ", ".join(f"{name} {value}" for name, value in event.software.items())
    yield f"- Software: {versions}"
    yield f"- Event `{event.hash}` after `{event.previous_hash or 'none'}`"


def _write_proposal(
    proposal: StructureProposal,
    previous: StructureProposal | None,
    structures: Sequence[StructureVersion],
    surfaces: Sequence[str],
) -> Iterator[str]:
    found = {(one.structure_id, one.version): one for one in structures}

    def format_reference(reference: StructureReference) -> str:
        stored = found.get((reference.id, reference.version))
        name = "" if stored is None else f" ({_text(stored.name)})"
        return f"model structure {reference.id}, version {reference.version}{name}"

    yield f"- Title: {_text(proposal.title)}"
    yield f"- Proposes {format_reference(proposal.structure)}"
    yield f"- For {describe_limits(proposal.limits)}"
    before = proposal.changes or (None if previous is None else previous.structure)
    if before is not None and before != proposal.structure:
        yield f"- Changes to {format_reference(before)}:"
        one = found.get((before.id, before.version))
        other = found.get((proposal.structure.id, proposal.structure.version))
        if one is not None and other is not None:
            for what, was, now in list_structure_differences(
                one.structure, other.structure, surfaces
            ):
                yield f"  - {what}: {was} → {now}"
    if proposal.run_ids:
        yield f"- Runs: {', '.join(map(str, proposal.run_ids))}"
    for comparison in proposal.comparisons:
        predictions = ", ".join(map(str, comparison.prediction_ids)) or "none"
        yield (
            f"- Comparison of runs {', '.join(map(str, comparison.run_ids))}, predictions "
            f"{predictions}, {comparison.coefficient or 'all coefficients'}"
        )
    if proposal.figure_ids:
        yield f"- Frozen figures: {', '.join(map(str, proposal.figure_ids))}"


def _write_structure(version: StructureVersion, surfaces: Sequence[str]) -> Iterator[str]:
    structure = version.structure
    yield (
        f"#### Model structure {version.structure_id}, version {version.version}: "
        f"{_text(version.name)}"
    )
    yield ""
    yield f"By {_text(version.author) or 'unknown'}, {_time(version.created_at)}."
    if version.note:
        yield f"{_text(version.note)}"
    yield ""
    yield f"- Axis {structure.axis}; modes {', '.join(map(str, structure.modes)) or 'none'}"
    yield f"- Inputs {', '.join(structure.inputs) or 'all of the maneuver'}"
    yield f"- Outputs {', '.join(structure.outputs) or 'all suitable'}"
    yield from _write_states(structure, surfaces)
    for what, values in (("delays", structure.delays), ("instruments", structure.instruments)):
        if values:
            yield f"- {what}: {', '.join(f'{name} {value}' for name, value in values.items())}"


def _write_states(structure: Structure, surfaces: Sequence[str]) -> Iterator[str]:
    groups: dict[str, list[str]] = {}
    for name in list_derivative_names(structure.modes, structure.inputs or tuple(surfaces)):
        groups.setdefault(describe_derivative_state(structure, name), []).append(name)
    for state, names in groups.items():
        yield f"- {state}: {', '.join(names)}"
    extra = [
        *structure.extra_parameters,
        *(["a delay of every output"] if structure.free_delays else []),
    ]
    if extra:
        yield f"- further free parameters: {', '.join(extra)}"


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
    yield ""
    yield "| parameter | value | σ |"
    yield "| --- | --- | --- |"
    for one in run.parameters:
        sigma = "–" if one.std_error is None else f"{one.std_error:.3g}"
        yield f"| {one.name} | {one.value:.5g} | {sigma} |"


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
