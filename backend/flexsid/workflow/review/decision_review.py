"""Review of decisions: proposals, votes, comments, and the state after each event.

The state of a decision follows from its events. Every change uses ``append``, which writes the
event and the new state in one transaction.
"""

from __future__ import annotations

import logging
from collections.abc import Mapping, Sequence
from dataclasses import replace
from datetime import UTC, datetime
from types import MappingProxyType

import sqlalchemy as sa

from flexsid.errors import BadInput, Conflict
from flexsid.records.decision import (
    Decision,
    DecisionEvent,
    DecisionState,
    EventKind,
    ModelProposal,
    ReviewRules,
    Vote,
)
from flexsid.storage.access import get_access
from flexsid.storage.audit_recording import hash_value, seal
from flexsid.storage.store import Store
from flexsid.storage.tables import decision_events, job_events
from flexsid.sysid.model.derivatives import RIGID_BODIES, list_derivative_names
from flexsid.workflow.model_structures.baselines import is_covered, is_overlapping, list_approved
from flexsid.workflow.model_structures.model_structures import (
    StaleEdit,
    get_version,
    hash_run,
    refuse_altered,
)
from flexsid.workflow.review.evidence import hash_evidence, list_software_versions
from flexsid.workflow.review.frozen_sheet import ReadSheet, freeze_sheets

_log = logging.getLogger(__name__)

OPEN = (DecisionState.OPEN, DecisionState.CHANGES_REQUESTED)


class OwnProposal(Conflict):
    """The rules of the campaign do not allow votes on own proposals."""

    code = "own-proposal"


def get_rules(store: Store, aircraft_id: int) -> ReviewRules:
    """Return the rules of a campaign; by default one approval, not by the proposer."""
    store.aircraft.get(aircraft_id)
    found = store.review_rules.find(aircraft_id=aircraft_id)
    return found[-1] if found else ReviewRules(aircraft_id=aircraft_id)


def change_rules(store: Store, rules: ReviewRules) -> ReviewRules:
    """Store new review rules after those of ``rules.version``; all versions are retained.

    Raises
    ------
    StaleEdit
        If the rules were changed meanwhile.
    """
    with store.transaction():
        store.aircraft.get(rules.aircraft_id)
        current = get_rules(store, rules.aircraft_id)
        if current.version != rules.version:
            raise StaleEdit(
                f"{current.author} has changed the rules to version {current.version}; review "
                "them and save again",
                current=current,
                sent=rules,
            )
        return store.review_rules.add(replace(rules, version=rules.version + 1))


def propose(store: Store, proposal: ModelProposal, author: str) -> Decision:
    """Open a decision.

    Raises
    ------
    BadInput
        If the proposal is inconsistent; see ``check_proposal``.
    """
    with store.transaction():
        proposal = _add_runs_of_model(store, proposal)
        aircraft_id, axis = check_proposal(store, proposal)
        decision = store.decisions.add(
            Decision(
                aircraft_id=aircraft_id,
                axis=axis,
                proposal=proposal,
                state=DecisionState.OPEN,
                revision=1,
                authors=(author,),
                version=0,
            )
        )
        return append(
            store, decision, EventKind.PROPOSED, author, proposal.reasoning, proposal=proposal
        )


def revise(
    store: Store, decision_id: int, revision: int, proposal: ModelProposal, author: str
) -> Decision:
    """Replace a proposal; votes are reset.

    Raises
    ------
    StaleEdit
        If ``revision`` is not the latest.
    """
    with store.transaction():
        proposal = _add_runs_of_model(store, proposal)
        decision = _get_open(store, decision_id, revision, proposal)
        aircraft_id, axis = check_proposal(store, proposal)
        if (aircraft_id, axis) != (decision.aircraft_id, decision.axis):
            raise BadInput(
                "aircraft and axis of a decision are fixed; make a new proposal for others",
                code="wrong-aircraft",
            )
        if not _is_alike(proposal, decision.proposal):
            raise BadInput(
                "a decision is on model structures or on global models; make a new proposal",
                code="other-subject",
            )
        return append(
            store, decision, EventKind.REVISED, author, proposal.reasoning, proposal=proposal
        )


def comment(
    store: Store, decision_id: int, text: str, author: str, derivative: str | None = None
) -> Decision:
    """Comment on a decision or one of its derivatives, in any state."""
    with store.transaction():
        decision = store.decisions.get(decision_id)
        if derivative is not None:
            _check_derivative(store, decision, derivative)
        return append(store, decision, EventKind.COMMENTED, author, text, derivative=derivative)


class UnexplainedWarnings(Conflict):
    """The evidence has warnings, and an approval does not state why it is given despite them."""

    code = "open-warnings"


def cast_vote(
    store: Store,
    decision_id: int,
    revision: int,
    vote: Vote,
    text: str,
    author: str,
    *,
    warnings: Sequence[str] = (),
    despite: str = "",
    read_sheet: ReadSheet | None = None,
) -> Decision:
    """Approve, reject or request changes; the decision is made when the quorum is reached.

    Parameters
    ----------
    store
        Database.
    decision_id, revision
        The decision, and the revision that was read.
    vote, text, author
        The vote, its reason, and whose it is.
    warnings, despite
        Warnings of the evidence, and why the proposal is approved despite them: both are stored
        with an approval.
    read_sheet
        Returns the sheet of a condition: those of the runs are frozen with the decision.

    Raises
    ------
    OwnProposal
        If the rules do not allow votes on own proposals.
    UnexplainedWarnings
        If an approval says nothing of the warnings.
    StaleEdit
        If the proposal was revised since it was read.
    """
    with store.transaction():
        decision = _get_open(store, decision_id, revision)
        rules = get_rules(store, decision.aircraft_id)
        if not rules.own_allowed and author.casefold() in _fold(decision.authors):
            raise OwnProposal(
                f"{author} has proposed this, and the rules of the campaign do not allow votes on "
                "own proposals; ask a colleague, or revise or withdraw it"
            )
        if vote is Vote.APPROVE and warnings:
            text = f"{text}\n\n{_state_reason(warnings, despite)}"
        decision = append(store, decision, EventKind.VOTED, author, text, vote=vote, rules=rules)
        verdict = decide(decision, rules)
        if verdict is None:
            return decision
        names = ", ".join(decision.votes)
        text = f"by {names}; quorum {rules.quorum}"
        frozen = {} if read_sheet is None else freeze_sheets(store, decision, author, read_sheet)
        decided = append(store, decision, verdict, author, text, rules=rules, frozen=frozen)
        if verdict is EventKind.ADOPTED:
            _supersede(store, decided, author)
        return decided


def _state_reason(warnings: Sequence[str], despite: str) -> str:
    listed = "\n".join(f"- {warning}" for warning in warnings)
    if not despite.strip():
        raise UnexplainedWarnings(
            f"state in `despite` why the proposal is approved despite the open warnings:\n{listed}"
        )
    return f"Despite the open warnings\n{listed}\n\n{despite}"


def withdraw(store: Store, decision_id: int, revision: int, text: str, author: str) -> Decision:
    """Withdraw a proposal; only its authors can."""
    with store.transaction():
        decision = _get_open(store, decision_id, revision)
        if author.casefold() not in _fold(decision.authors):
            raise Conflict(
                f"only {', '.join(decision.authors)} can withdraw this; reject it instead",
                code="not-your-proposal",
            )
        return append(store, decision, EventKind.WITHDRAWN, author, text)


def decide(decision: Decision, rules: ReviewRules) -> EventKind | None:
    """Return the outcome of the current votes; None if undecided.

    Approval needs as many votes as the quorum and no other votes; rejection needs as many votes
    as the quorum.
    """
    votes = list(decision.votes.values())
    if votes.count(Vote.REJECT) >= rules.quorum:
        return EventKind.DECLINED
    if votes.count(Vote.APPROVE) == len(votes) >= rules.quorum:
        return EventKind.ADOPTED
    return None


def append(
    store: Store,
    decision: Decision,
    kind: EventKind,
    author: str,
    text: str,
    *,
    derivative: str | None = None,
    vote: Vote | None = None,
    proposal: ModelProposal | None = None,
    rules: ReviewRules | None = None,
    by_decision_id: int | None = None,
    frozen: Mapping[str, str] = MappingProxyType({}),
) -> Decision:
    """Write an event and the new state of the decision; ``frozen`` is sealed with the evidence."""
    before = store.decision_events.find(decision_id=decision.id)
    data = hash_evidence(store, proposal or decision.proposal) | dict(frozen)
    access = get_access()
    event = seal(
        DecisionEvent(
            decision_id=decision.id or 0,
            number=len(before) + 1,
            kind=kind,
            author=author,
            author_verified=access is not None and access.author == author,
            text=text,
            revision=decision.revision + (kind is EventKind.REVISED),
            derivative=derivative,
            vote=vote,
            proposal=proposal,
            rules=rules,
            by_decision_id=by_decision_id,
            data=data,
            data_hash=hash_value(data),
            software=list_software_versions(),
            previous_hash=before[-1].hash if before else "",
            created_at=datetime.now(UTC),
        )
    )
    late = find_clock_error(store)
    if late is not None:
        _log.warning(late)
    store.decision_events.add(event)
    after = apply_event(decision, event)
    if not store.decisions.advance(after):
        raise StaleEdit(f"decision {decision.id} has changed meanwhile; reload it")
    return after


def apply_event(decision: Decision, event: DecisionEvent) -> Decision:
    """Return the state of a decision after an event."""
    moved = replace(decision, version=event.number, changed_at=event.created_at)
    match event.kind:
        case EventKind.PROPOSED | EventKind.REVISED:
            assert event.proposal is not None
            known = event.author.casefold() in _fold(decision.authors)
            return replace(
                moved,
                proposal=event.proposal,
                revision=event.revision,
                state=DecisionState.OPEN,
                votes={},
                authors=decision.authors if known else (*decision.authors, event.author),
            )
        case EventKind.VOTED:
            assert event.vote is not None
            votes = {
                name: vote
                for name, vote in decision.votes.items()
                if name.casefold() != event.author.casefold()
            } | {event.author: event.vote}
            asked = Vote.REQUEST_CHANGES in votes.values()
            state = DecisionState.CHANGES_REQUESTED if asked else DecisionState.OPEN
            return replace(moved, votes=votes, state=state)
        case EventKind.ADOPTED:
            return replace(moved, state=DecisionState.APPROVED, adopted_at=event.created_at)
        case EventKind.DECLINED:
            return replace(moved, state=DecisionState.REJECTED)
        case EventKind.WITHDRAWN:
            return replace(moved, state=DecisionState.WITHDRAWN)
        case EventKind.SUPERSEDED:
            return replace(
                moved, state=DecisionState.SUPERSEDED, superseded_by=event.by_decision_id
            )
        case EventKind.COMMENTED | EventKind.NARROWED:
            return moved


def _supersede(store: Store, decided: Decision, author: str) -> None:
    """Mark earlier baselines of the same axis as superseded or narrowed."""
    baselines = [
        one
        for one in list_approved(store, decided.aircraft_id)
        if one.axis == decided.axis and _is_alike(one.proposal, decided.proposal)
    ]
    # The rules were read with the aircraft locked, so this one was adopted after all others.
    assert baselines[0].id == decided.id
    for place, earlier in enumerate(baselines[1:], start=1):
        if not is_overlapping(earlier.proposal.limits, decided.proposal.limits):
            continue
        later = [one.proposal.limits for one in baselines[:place]]
        whole = is_covered(earlier.proposal.limits, later)
        append(
            store,
            store.decisions.get(earlier.id or 0),
            EventKind.SUPERSEDED if whole else EventKind.NARROWED,
            author,
            f"by decision {decided.id}, '{decided.proposal.title}'",
            by_decision_id=decided.id,
        )


def _get_open(
    store: Store, decision_id: int, revision: int, sent: ModelProposal | None = None
) -> Decision:
    decision = store.decisions.get(decision_id)
    if decision.state not in OPEN:
        raise Conflict(
            f"decision {decision_id} is {decision.state.value}; add a comment, or make "
            "a new proposal",
            code="decision-closed",
            state=decision.state.value,
        )
    if revision == decision.revision:
        return decision
    events = store.decision_events.find(decision_id=decision_id)
    proposals = {e.revision: e.proposal for e in events if e.proposal is not None}
    if revision not in proposals:
        raise Conflict(f"decision {decision_id} has no revision {revision}", code="unknown-version")
    raise StaleEdit(
        f"you read revision {revision} of '{decision.proposal.title}', but "
        f"{decision.authors[-1]} has made revision {decision.revision}; compare both first",
        base=proposals[revision],
        current=decision.proposal,
        sent=sent,
        revision=decision.revision,
    )


def _is_alike(one: ModelProposal, other: ModelProposal) -> bool:
    """Whether both propose a model structure, or both a global model."""
    return (one.structure is None) == (other.structure is None)


def _add_runs_of_model(store: Store, proposal: ModelProposal) -> ModelProposal:
    """Add the runs of a proposed global model to the evidence."""
    if proposal.global_model_id is None:
        return proposal
    version = store.global_model_versions.get(proposal.global_model_id)
    runs = dict.fromkeys((*(run.run_id for run in version.runs), *proposal.run_ids))
    return replace(proposal, run_ids=tuple(runs))


def _check_derivative(store: Store, decision: Decision, name: str) -> None:
    reference = decision.proposal.structure
    if reference is None:
        raise BadInput(
            "comments on single derivatives are for model structures; comment on the global model",
            code="unknown-derivative",
            name=name,
        )
    structure = get_version(store, reference.id, reference.version).structure
    surfaces = tuple(s.name for s in store.aircraft.get(decision.aircraft_id).surfaces)
    known = list_derivative_names(
        structure.modes, structure.inputs or surfaces, RIGID_BODIES[structure.axis]
    )
    if name not in known:
        raise BadInput(
            f"'{name}' is not a derivative of the proposed model structure",
            code="unknown-derivative",
            name=name,
        )


def _fold(names: tuple[str, ...]) -> set[str]:
    return {name.casefold() for name in names}


def check_proposal(store: Store, proposal: ModelProposal) -> tuple[int, str]:
    """Check a proposal; return its aircraft and axis.

    Raises
    ------
    UnknownRecord
        If a structure, global model, run, prediction or figure does not exist.
    BadInput
        If not one model is proposed, records belong to different aircraft, a run has no result,
        or limits are reversed.
    Conflict
        If a run of the global model was estimated again since.
    """
    aircraft_id, axis = _check_model(store, proposal)
    for quantity, (low, high) in proposal.limits.items():
        if not low < high:
            raise BadInput(
                f"the limits of {quantity.value} are {low:g} and {high:g}; the first must lie "
                "below the second",
                code="bad-limits",
                quantity=quantity.value,
            )
    for run_id in proposal.all_run_ids:
        _check_run(store, run_id, aircraft_id)
    for comparison in proposal.comparisons:
        if not comparison.run_ids:
            raise BadInput("a comparison needs at least one run", code="no-run")
        for prediction_id in comparison.prediction_ids:
            other = store.predictions.get(prediction_id).aircraft_id
            _check_aircraft(f"prediction {prediction_id}", other, aircraft_id)
    for figure_id in proposal.figure_ids:
        store.frozen_figures.get(figure_id)
    return aircraft_id, axis


def _check_model(store: Store, proposal: ModelProposal) -> tuple[int, str]:
    """Check the proposed model structure or global model; return its aircraft and axis."""
    if (proposal.structure is None) == (proposal.global_model_id is None):
        raise BadInput(
            "propose one model: either structure or global_model_id", code="no-single-model"
        )
    if proposal.global_model_id is not None:
        if proposal.changes is not None or proposal.limits:
            raise BadInput(
                "a global model is proposed for the envelope of its runs; give neither changes nor"
                " limits",
                code="not-with-global-model",
            )
        version = store.global_model_versions.get(proposal.global_model_id)
        for run in version.runs:
            if hash_run(store.runs.get(run.run_id)) != run.hash:
                raise Conflict(
                    f"run {run.run_id} has changed since {version.name} was stored; fit the global"
                    " model again",
                    code="result-altered",
                    run_id=run.run_id,
                )
        return version.aircraft_id, version.axis
    assert proposal.structure is not None
    proposed = get_version(store, proposal.structure.id, proposal.structure.version)
    aircraft_id = store.model_structures.get(proposal.structure.id).aircraft_id
    if proposal.changes is not None:
        before = get_version(store, proposal.changes.id, proposal.changes.version)
        other = store.model_structures.get(proposal.changes.id).aircraft_id
        _check_aircraft(f"model structure {proposal.changes.id}", other, aircraft_id)
        if before.structure == proposed.structure:
            raise BadInput(
                "the proposed model structure is identical to the one it changes; modify it first",
                code="no-change",
            )
    return aircraft_id, proposed.structure.axis


def _check_run(store: Store, run_id: int, aircraft_id: int) -> None:
    run = store.runs.get(run_id)
    _check_aircraft(f"run {run_id}", store.maneuvers.get(run.maneuver_id).aircraft_id, aircraft_id)
    refuse_altered(run)
    if run.deleted_at is not None:
        raise Conflict(
            f"run {run_id} was deleted; restore it before using it as evidence", code="deleted"
        )
    if run.result is None:
        raise BadInput(
            f"run {run_id} is {run.state.value} and has no result; link runs that succeeded",
            code="run-without-result",
            run_id=run_id,
        )


def _check_aircraft(what: str, other: int, aircraft_id: int) -> None:
    if other != aircraft_id:
        raise BadInput(
            f"{what} belongs to another aircraft than the proposed model",
            code="wrong-aircraft",
        )


_TOLERANCE_S = 5.0  # largest difference of synchronised clocks


def find_clock_error(store: Store) -> str | None:
    """Describe the error of a clock behind the last event; None without error.

    No decision depends on times, but new events would have times before earlier ones.
    """
    newest = (
        sa.select(table.c[moment]).order_by(table.c.id.desc()).limit(1)
        for table, moment in ((decision_events, "created_at"), (job_events, "at"))
    )
    with store.database.reading() as connection:
        known = [last for query in newest if (last := connection.scalar(query)) is not None]
    now = datetime.now(UTC)
    behind_s = (max(known, default=now) - now).total_seconds()
    if behind_s <= _TOLERANCE_S:
        return None
    return (
        f"The clock of this computer is {behind_s:.0f} s behind the last stored event"
        f" ({max(known):%Y-%m-%d %H:%M:%S} UTC): new events would have times before"
        " earlier ones. Set the clock on every server."
    )
