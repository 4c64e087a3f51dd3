"""Report of a decision: proposed model, conditions, evidence, votes and history."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from flexsid.jobs.kinds import find_stored_flutter
from flexsid.records.decision import (
    DecisionEvent,
    LinkedComparison,
    StructureReference,
    StructureVersion,
)
from flexsid.records.global_model import GlobalModelVersion
from flexsid.reports.content import (
    Drawing,
    Facts,
    Part,
    Report,
    ReportTable,
    Section,
    Words,
    draw,
    estimate,
    listed,
    moment,
    number,
    shown,
)
from flexsid.storage.store import Store
from flexsid.sysid.model.derivatives import list_derivative_names
from flexsid.workflow.aircraft.axes import find_body
from flexsid.workflow.comparison.derivative_comparison import compare, list_coefficients
from flexsid.workflow.model_structures.model_structures import describe_derivative_state
from flexsid.workflow.review.audit import AuditedDecision, audit_decision, describe_limits
from flexsid.workflow.review.vote_evidence import (
    FlutterEvidence,
    ReferenceComparison,
    collect_vote_evidence,
)


def decision_report(store: Store, decision_id: int) -> Report:
    """Report a decision with its evidence and history.

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
    return Report(
        title=proposal.title,
        subtitle=f"Decision {decision_id} of {trail.aircraft.name}: {decision.state.value}",
        name=f"flexsid-decision-{decision_id}",
        sections=(
            Section("Decision", (*_list_warnings(audited), Facts(_summarise(audited)))),
            Section("Reasoning", (Words(proposal.reasoning),)),
            _describe_model(audited, surfaces),
            Section("Evidence", tuple(_report_evidence(store, audited))),
            Section("History", (_tabulate_events(audited.events),)),
        ),
        provenance=(
            ("Check", trail.check),
            *((f"Event {event.number}", event.hash) for event in audited.events),
            ("Data of the last event", audited.events[-1].data_hash),
            ("Software", listed(f"{name} {value}" for name, value in trail.software.items())),
        ),
    )


def _describe_model(audited: AuditedDecision, surfaces: tuple[str, ...]) -> Section:
    """Describe the proposed model structure or global model."""
    proposal = audited.decision.proposal
    for model in audited.global_models:
        if model.id == proposal.global_model_id:
            return Section("Global model", _describe_global_model(model))
    for version in audited.structures:
        if StructureReference(id=version.structure_id, version=version.version) == (
            proposal.structure
        ):
            return Section("Model structure", _describe_structure(version, surfaces))
    return Section("Model structure", ())


def _describe_global_model(model: GlobalModelVersion) -> tuple[Part, ...]:
    outlying = [run.run_id for run in model.runs if run.is_outlying]
    facts = (
        ("Name", model.name),
        ("Variables", listed(one.value for one in model.variables)),
        ("Runs", listed(run.run_id for run in model.runs)),
        ("Outlying runs, excluded", listed(outlying, "none")),
        ("SHA-256 of the model", model.result),
    )
    return (Facts(facts), Words(model.sentence), *((Words(model.note),) if model.note else ()))


def _list_warnings(audited: AuditedDecision) -> tuple[Part, ...]:
    warnings = []
    if not audited.whole:
        warnings.append("The record of this decision was modified after it was written.")
    if audited.changed_since:
        warnings.append(f"Changed since the last event: {listed(audited.changed_since)}.")
    return tuple(Words(warning, warns=True) for warning in warnings)


def _summarise(audited: AuditedDecision) -> tuple[tuple[str, str], ...]:
    decision = audited.decision
    votes = (f"{name}: {vote.value}" for name, vote in decision.votes.items())
    return (
        ("State", decision.state.value),
        (
            "Valid for",
            describe_limits(decision.proposal.limits)
            if decision.proposal.structure is not None
            else "the envelope of its runs",
        ),
        ("Axis", decision.axis),
        ("Proposed by", listed(decision.authors)),
        ("Votes", listed(votes, "none")),
        ("Revision", str(decision.revision)),
        ("Adopted", moment(decision.adopted_at)),
    )


def _describe_structure(version: StructureVersion, surfaces: tuple[str, ...]) -> tuple[Part, ...]:
    structure = version.structure
    groups: dict[str, list[str]] = {}
    for name in list_derivative_names(
        structure.modes, structure.inputs or surfaces, find_body(structure.axis)
    ):
        groups.setdefault(describe_derivative_state(structure, name), []).append(name)
    facts = (
        ("Name", f"{version.name}, version {version.version}"),
        ("Modes", listed(structure.modes, "none: rigid body")),
        ("Inputs", listed(structure.inputs, "all of the maneuver")),
        ("Outputs", listed(structure.outputs, "all suitable")),
        *((f"{state.capitalize()}", listed(names)) for state, names in groups.items()),
    )
    return (Facts(facts), *((Words(version.note),) if version.note else ()))


def _report_evidence(store: Store, audited: AuditedDecision) -> Iterator[Part]:
    decision = audited.decision
    evidence = collect_vote_evidence(
        store, decision.proposal, partial(find_stored_flutter, store), decision
    )
    for warning in evidence.warnings:
        yield Words(warning, warns=True)
    if evidence.runs:
        authors = {run.id: run.author for run in audited.runs}
        yield ReportTable(
            ("run", "maneuver", "method", "by", "outcome", "adequacy", "lowest R²"),
            tuple(
                (
                    str(run.run_id),
                    run.maneuver_label,
                    run.method,
                    authors.get(run.run_id) or "–",
                    run.outcome,
                    run.adequacy.value,
                    number(run.lowest_r_squared, 3),
                )
                for run in evidence.runs
            ),
            "Runs of the proposal",
            numbers_from=6,
        )
    if evidence.searches:
        yield ReportTable(
            (
                *("search", "maneuvers", "method", "terms", "proposed", "adequacy, all terms"),
                "held-out log likelihood over all terms",
            ),
            tuple(
                (
                    str(one.search_id),
                    listed(one.maneuver_labels),
                    one.method,
                    f"{one.n_terms} of {one.n_candidate_terms}",
                    "yes" if one.is_proposed else "no",
                    one.adequacy.value,
                    number(one.likelihood_difference, 3),
                )
                for one in evidence.searches
            ),
            "Searches of the model structure",
            numbers_from=6,
        )
    if evidence.reference is not None:
        yield from _report_reference(evidence.reference, evidence.flutter)
    comparisons = audited.decision.proposal.comparisons
    for comparison in comparisons:
        yield _draw_comparison(store, comparison)
    if not comparisons:
        yield from _draw_derivatives(store, audited)
    for one in audited.figures:
        figure = one.figure
        caption = f"{figure.title}, frozen by {figure.author} on {moment(figure.created_at)}"
        yield Drawing(one.spec, caption)
    if not (audited.runs or audited.figures or audited.decision.proposal.comparisons):
        yield Words("No evidence is linked.")


def _report_reference(reference: ReferenceComparison, flutter: FlutterEvidence) -> Iterator[Part]:
    """Report the comparison with the baseline of the time of the report."""
    named = f"{reference.name}, version {reference.structure.version}"
    what = "the structure that it changes" if reference.decision_id is None else "the baseline"
    yield Words(
        f"Compared with {what}, {named}: {len(reference.terms)} terms differ, and"
        f" {len(reference.derivatives)} of {reference.n_derivatives} derivatives moved by more than"
        " 2 standard errors of the difference."
    )
    if reference.terms:
        yield ReportTable(
            ("term", "before", "proposed"),
            tuple((one.what, one.before, one.after) for one in reference.terms),
            "Terms that differ",
            numbers_from=3,
        )
    if reference.derivatives:
        yield ReportTable(
            ("derivative", "runs", "before", "proposed", "difference [σ]"),
            tuple(
                (
                    one.name,
                    f"{one.baseline_run_id}, {one.run_id}",
                    _format_interval(one.baseline_value, one.baseline_std_error),
                    _format_interval(one.value, one.std_error),
                    f"{one.difference_sigma:.1f}",
                )
                for one in reference.derivatives
            ),
            "Derivatives ±2σ that moved by more than 2 standard errors",
            numbers_from=2,
        )
    if reference.flutter_change_m_s is not None:
        yield Words(
            f"Flutter speed {shown(flutter.airspeed_m_s, 'm/s', 3)}, before"
            f" {shown(reference.flutter.airspeed_m_s, 'm/s', 3)}: a change of"
            f" {shown(reference.flutter_change_m_s, 'm/s', 2)}."
        )


def _format_interval(value: float, std_error: float | None) -> str:
    return " ± ".join(estimate(value, None if std_error is None else 2.0 * std_error))


def _draw_derivatives(store: Store, audited: AuditedDecision) -> Iterator[Part]:
    """Draw derivatives of the runs, if the proposal has no comparison."""
    finished = [run.id for run in audited.runs if run.r_squared]
    if not finished:
        return
    for name in list_coefficients(compare(store, finished, ())):
        yield draw(
            f"Derivatives of {name} with ±2 standard errors, of the runs {listed(finished)}",
            store,
            "derivatives",
            run_ids=finished,
            coefficient=name,
        )


def _draw_comparison(store: Store, linked: LinkedComparison) -> Part:
    what = linked.coefficient or "all coefficients"
    return draw(
        f"Comparison of runs {listed(linked.run_ids)}, {what}",
        store,
        "derivatives",
        run_ids=linked.run_ids,
        prediction_ids=linked.prediction_ids,
        coefficient=linked.coefficient,
    )


def _tabulate_events(events: list[DecisionEvent]) -> ReportTable:
    return ReportTable(
        ("", "time", "analyst", "event", "text"),
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
        "Events; names are as entered by the analysts",
        numbers_from=5,
    )
