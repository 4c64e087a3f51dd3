"""Decisions on model structures and global models: proposals, comments, votes and audit trail."""

from __future__ import annotations

from functools import partial
from typing import Annotated, Any, Literal

from fastapi import Query, Response

from flexsid.api.analyst import NamedAnalyst
from flexsid.api.context import TheStore
from flexsid.api.errors import Problem
from flexsid.api.models.decision_requests import (
    CommentRequest,
    ProposalRequest,
    RevisionRequest,
    VoteRequest,
    WithdrawalRequest,
)
from flexsid.api.models.decision_responses import DecisionDetail, DecisionItem, StaleProposal
from flexsid.api.models.response_models import extend_record
from flexsid.api.router import make_router
from flexsid.api.serialization import (
    Identity,
    Json,
    JsonRoute,
    Reference,
    RequiredReference,
    drop_none,
    dump_json,
)
from flexsid.jobs.stored_results import find_stored_flutter, find_stored_predictions
from flexsid.records.decision import Decision, DecisionState
from flexsid.storage.paging import Items
from flexsid.storage.signatures import SignaturePlace, sign_content
from flexsid.storage.store import Store
from flexsid.workflow.model_structures.model_structures import get_version
from flexsid.workflow.review import decision_review
from flexsid.workflow.review.audit import AuditTrail, audit_campaign, audit_decision, write_markdown
from flexsid.workflow.review.vote_evidence import VoteEvidence, collect_vote_evidence

router = make_router("/decisions", tag="decisions", route_class=JsonRoute)

Form = Annotated[
    Literal["json", "markdown"], Query(alias="format", description="JSON, or Markdown to read.")
]
_STALE: dict[int | str, dict[str, Any]] = {409: {"model": StaleProposal | Problem}}
_TRAIL: dict[int | str, dict[str, Any]] = {
    200: {"content": {"text/markdown": {"schema": {"type": "string"}}}}
}


@router.get("")
def list_decisions(
    store: TheStore, aircraft_id: Reference = None, state: DecisionState | None = None
) -> Items[DecisionItem]:
    """List decisions, newest first."""
    found = store.decisions.find(**drop_none(aircraft_id=aircraft_id, state=state))
    items = [
        extend_record(DecisionItem, one, model_name=_name_model(store, one))
        for one in reversed(found)
    ]
    return Items(items=items)


@router.post("", response_model=DecisionDetail, status_code=201)
def propose_decision(store: TheStore, body: ProposalRequest, analyst: NamedAnalyst) -> Json:
    """Propose a model structure or a change of one for conditions, or a global model."""
    stored = decision_review.propose(store, body.to_record(), analyst)
    location = {"Location": f"/api/v1/decisions/{stored.id}"}
    return Json(_build_detail(store, stored), 201, location)


@router.get("/audit", response_model=AuditTrail, responses=_TRAIL)
def get_campaign_audit(
    store: TheStore, aircraft_id: RequiredReference, form: Form = "json"
) -> Response:
    """Return the audit trail of all decisions of a campaign."""
    name = f"flexsid-decisions-{aircraft_id}"
    return _respond_with_trail(store, audit_campaign(store, aircraft_id), form, name)


@router.get("/{decision_id}")
def get_decision(store: TheStore, decision_id: Identity) -> DecisionDetail:
    """Return one decision with its comments, votes and history."""
    return _build_detail(store, store.decisions.get(decision_id))


@router.get("/{decision_id}/evidence")
def get_vote_evidence(store: TheStore, decision_id: Identity) -> VoteEvidence:
    """Return the evidence for a vote: fits, warnings, and comparison with the baseline."""
    decision = store.decisions.get(decision_id)
    return collect_vote_evidence(
        store,
        decision.proposal,
        partial(find_stored_flutter, store),
        decision,
        partial(find_stored_predictions, store),
    )


@router.post("/{decision_id}/revisions", status_code=201, responses=_STALE)
def revise_decision(
    store: TheStore, decision_id: Identity, body: RevisionRequest, analyst: NamedAnalyst
) -> DecisionDetail:
    """Replace an open proposal; the votes are reset."""
    stored = decision_review.revise(
        store, decision_id, body.revision, body.proposal.to_record(), analyst
    )
    return _build_detail(store, stored)


@router.post("/{decision_id}/comments", status_code=201)
def comment_decision(
    store: TheStore, decision_id: Identity, body: CommentRequest, analyst: NamedAnalyst
) -> DecisionDetail:
    """Comment on a decision, or on one derivative."""
    stored = decision_review.comment(store, decision_id, body.text, analyst, body.derivative)
    return _build_detail(store, stored)


@router.post("/{decision_id}/votes", status_code=201, responses=_STALE)
def vote_on_decision(
    store: TheStore, decision_id: Identity, body: VoteRequest, analyst: NamedAnalyst
) -> DecisionDetail:
    """Vote on a proposal: approve, reject or request changes; decided by the quorum."""
    stored = decision_review.cast_vote(
        store, decision_id, body.revision, body.vote, body.text, analyst
    )
    return _build_detail(store, stored)


@router.post("/{decision_id}/withdrawal", status_code=201, responses=_STALE)
def withdraw_decision(
    store: TheStore, decision_id: Identity, body: WithdrawalRequest, analyst: NamedAnalyst
) -> DecisionDetail:
    """Withdraw a proposal; its author only."""
    stored = decision_review.withdraw(store, decision_id, body.revision, body.text, analyst)
    return _build_detail(store, stored)


@router.get("/{decision_id}/audit", response_model=AuditTrail, responses=_TRAIL)
def get_decision_audit(store: TheStore, decision_id: Identity, form: Form = "json") -> Response:
    """Return the audit trail of one decision."""
    name = f"flexsid-decision-{decision_id}"
    return _respond_with_trail(store, audit_decision(store, decision_id), form, name)


def _build_detail(store: Store, decision: Decision) -> DecisionDetail:
    proposal = decision.proposal
    changes, structure, model = proposal.changes, proposal.structure, proposal.global_model_id
    return extend_record(
        DecisionDetail,
        decision,
        rules=decision_review.get_rules(store, decision.aircraft_id),
        events=store.decision_events.find(decision_id=decision.id),
        structure=None
        if structure is None
        else get_version(store, structure.id, structure.version),
        global_model=None if model is None else store.global_model_versions.get(model),
        newest_version=_find_newest_version(store, decision),
        changes=None if changes is None else get_version(store, changes.id, changes.version),
        figures=[store.frozen_figures.get(number) for number in proposal.figure_ids],
    )


def _name_model(store: Store, decision: Decision) -> str:
    """Return the name of the proposed model structure or global model."""
    reference = decision.proposal.structure
    if reference is not None:
        return get_version(store, reference.id, reference.version).name
    return store.global_model_versions.get(decision.proposal.global_model_id or 0).name


def _find_newest_version(store: Store, decision: Decision) -> int:
    reference = decision.proposal.structure
    if reference is not None:
        return store.model_structures.get(reference.id).version
    known = store.global_model_versions.find(aircraft_id=decision.aircraft_id, axis=decision.axis)
    return max(one.version for one in known)


def _respond_with_trail(store: Store, trail: AuditTrail, form: str, name: str) -> Response:
    ending = "md" if form == "markdown" else "json"
    headers = {"Content-Disposition": f'attachment; filename="{name}.{ending}"'}
    if form == "markdown":
        text = sign_content(store.database, write_markdown(trail).encode(), SignaturePlace.COMMENT)
        return Response(text, media_type="text/markdown", headers=headers)
    content = sign_content(store.database, dump_json(trail), SignaturePlace.JSON)
    return Response(content, media_type=Json.media_type, headers=headers)
