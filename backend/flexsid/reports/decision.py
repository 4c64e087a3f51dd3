"""The report of a decision: what was settled for which conditions, on what evidence, by whom."""

from __future__ import annotations

from collections.abc import Iterator

from flexsid import figures
from flexsid.records.decision import DecisionEvent, LinkedComparison, StructureReference
from flexsid.records.model_structure import StructureVersion
from flexsid.reports.content import (
    Drawing,
    Facts,
    Part,
    Report,
    ReportTable,
    Section,
    Words,
    drawn,
    listed,
    moment,
)
from flexsid.storage.store import Store
from flexsid.sysid.model.derivatives import derivative_names
from flexsid.workflow import views
from flexsid.workflow.comparison.derivative_comparison import coefficients, of_coefficient
from flexsid.workflow.model_structures.structure_difference import state_of
from flexsid.workflow.review.audit import AuditedDecision, audit_decision
from flexsid.workflow.review.audit_report import limits_text


def decision_report(store: Store, decision_id: int) -> Report:
    """Report a decision with its evidence and its whole history.

    Raises
    ------
    UnknownRecord
        If there is none of this id.
    """
    trail = audit_decision(store, decision_id)
    (audited,) = trail.decisions
    decision = audited.decision
    proposal = decision.proposal
    surfaces = tuple(surface.name for surface in trail.aircraft.surfaces)
    chosen = _version(audited, proposal.structure)
    return Report(
        title=proposal.title,
        subtitle=f"Decision {decision_id} of {trail.aircraft.name}: {decision.state.value}",
        name=f"flexsid-decision-{decision_id}",
        sections=(
            Section("Decision", (*_doubts(audited), Facts(_summary(audited)))),
            Section("Reasoning", (Words(proposal.reasoning),)),
            Section("Model structure", () if chosen is None else _structure(chosen, surfaces)),
            Section("Evidence", tuple(_evidence(store, audited))),
            Section("History", (_history(audited.events),)),
        ),
        provenance=(
            ("Check", trail.check),
            *((f"Event {event.number}", event.hash) for event in audited.events),
            ("Data of the last event", audited.events[-1].data_hash),
            ("Software", listed(f"{name} {value}" for name, value in trail.software.items())),
        ),
    )


def _version(audited: AuditedDecision, wanted: StructureReference) -> StructureVersion | None:
    for one in audited.structures:
        if (one.structure_id, one.version) == (wanted.id, wanted.version):
            return one
    return None


def _doubts(audited: AuditedDecision) -> tuple[Part, ...]:
    doubts = []
    if not audited.whole:
        doubts.append("The record of this decision was changed after it was written.")
    if audited.changed_since:
        doubts.append(f"Changed since the last event: {listed(audited.changed_since)}.")
    return tuple(Words(doubt, warns=True) for doubt in doubts)


def _summary(audited: AuditedDecision) -> tuple[tuple[str, str], ...]:
    decision = audited.decision
    votes = (f"{name}: {vote.value}" for name, vote in decision.votes.items())
    return (
        ("State", decision.state.value),
        ("Holds for", limits_text(decision.proposal.limits)),
        ("Axis", decision.axis),
        ("Proposed by", listed(decision.authors)),
        ("Votes", listed(votes, "none")),
        ("Revision", str(decision.revision)),
        ("Adopted", moment(decision.adopted_at)),
    )


def _structure(version: StructureVersion, surfaces: tuple[str, ...]) -> tuple[Part, ...]:
    structure = version.structure
    groups: dict[str, list[str]] = {}
    for name in derivative_names(structure.modes, structure.inputs or surfaces):
        groups.setdefault(state_of(structure, name), []).append(name)
    facts = (
        ("Name", f"{version.name}, version {version.version}"),
        ("Modes", listed(structure.modes, "none: rigid body")),
        ("Inputs", listed(structure.inputs, "all of the maneuver")),
        ("Outputs", listed(structure.outputs, "all suitable")),
        *((f"{state.capitalize()}", listed(names)) for state, names in groups.items()),
    )
    return (Facts(facts), *((Words(version.note),) if version.note else ()))


def _evidence(store: Store, audited: AuditedDecision) -> Iterator[Part]:
    if audited.runs:
        yield ReportTable(
            ("run", "maneuver", "method", "by", "outcome", "worst R²"),
            tuple(
                (
                    str(run.id),
                    run.maneuver_label,
                    run.method,
                    run.author or "–",
                    run.outcome or "–",
                    f"{min(run.r_squared.values()):.3f}" if run.r_squared else "–",
                )
                for run in audited.runs
            ),
            "Runs that the proposal rests on",
            numbers_from=5,
        )
    comparisons = audited.decision.proposal.comparisons
    for comparison in comparisons:
        yield _compared(store, comparison)
    if not comparisons:
        yield from _side_by_side(store, audited)
    for one in audited.figures:
        figure = one.figure
        caption = f"{figure.title}, as {figure.author} saw it on {moment(figure.created_at)}"
        yield Drawing(one.spec, caption)
    if not (audited.runs or audited.figures or audited.decision.proposal.comparisons):
        yield Words("None was linked.")


def _side_by_side(store: Store, audited: AuditedDecision) -> Iterator[Part]:
    """Derivatives of the runs, where the proposal linked no comparison of its own."""
    finished = [run.id for run in audited.runs if run.r_squared]
    if not finished:
        return
    compared = views.derivatives(store, finished)
    for name in coefficients(compared):
        yield drawn(
            f"Derivatives of {name} with ±2 standard errors, of the runs {listed(finished)}",
            lambda name=name: figures.derivatives(of_coefficient(compared, name)),
        )


def _compared(store: Store, linked: LinkedComparison) -> Part:
    what = linked.coefficient or "all coefficients"
    return drawn(
        f"Comparison of runs {listed(linked.run_ids)}, {what}",
        lambda: figures.derivatives(
            views.derivatives(store, linked.run_ids, linked.prediction_ids, linked.coefficient)
        ),
    )


def _history(events: list[DecisionEvent]) -> ReportTable:
    return ReportTable(
        ("", "when", "who", "what", "words"),
        tuple(
            (
                str(event.number),
                moment(event.created_at),
                event.author or "–",
                event.kind.value if event.vote is None else f"voted: {event.vote.value}",
                ": ".join(filter(None, (event.derivative, event.text))) or "–",
            )
            for event in events
        ),
        "What happened; names are as the analysts set them",
        numbers_from=5,
    )
