"""Decisions on the model structure: propose, discuss, decide, and hand the story on."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from fastapi import APIRouter, Query, Response, status

from flexsid.api.analyst import NamedAnalyst
from flexsid.api.answers import extend
from flexsid.api.context import TheStore
from flexsid.api.decision_answers import (
    DecisionDetail,
    DecisionItem,
    DecisionList,
    StaleProposal,
)
from flexsid.api.decision_requests import (
    CommentRequest,
    ProposalRequest,
    RevisionRequest,
    VoteRequest,
    WithdrawalRequest,
)
from flexsid.api.errors import Problem
from flexsid.api.wire import Identity, Json, Reference
from flexsid.records.decision import Decision, DecisionState
from flexsid.storage.store import Store
from flexsid.workflow.model_structures.model_structures import get_version
from flexsid.workflow.review import decision_review
from flexsid.workflow.review.audit import AuditTrail, audit_campaign, audit_decision
from flexsid.workflow.review.audit_report import audit_markdown

router = APIRouter(prefix="/decisions", tags=["decisions"])

Form = Annotated[
    Literal["json", "markdown"], Query(alias="format", description="For programs or for people.")
]
_STALE: dict[int | str, dict[str, Any]] = {409: {"model": StaleProposal | Problem}}
_TRAIL: dict[int | str, dict[str, Any]] = {
    200: {"content": {"text/markdown": {"schema": {"type": "string"}}}}
}


@router.get("", response_model=DecisionList)
def list_decisions(
    store: TheStore, aircraft_id: Reference = None, state: DecisionState | None = None
) -> Json:
    """List decisions, newest first."""
    wanted = {"aircraft_id": aircraft_id, "state": state}
    found = store.decisions.find(**{k: v for k, v in wanted.items() if v is not None})
    items = [
        extend(DecisionItem, one, structure_name=_structure(store, one).name)
        for one in reversed(found)
    ]
    return Json(DecisionList(items=items))


@router.post("", response_model=DecisionDetail, status_code=status.HTTP_201_CREATED)
def propose_decision(store: TheStore, wanted: ProposalRequest, analyst: NamedAnalyst) -> Json:
    """Propose a model structure, or a change to one, for a range of conditions."""
    kept = decision_review.propose(store, wanted.record(), analyst)
    location = {"Location": f"/api/v1/decisions/{kept.id}"}
    return Json(_detail(store, kept), status.HTTP_201_CREATED, location)


@router.get("/audit", response_model=AuditTrail, responses=_TRAIL)
def get_campaign_audit(
    store: TheStore,
    aircraft_id: Annotated[int, Query(ge=1, le=2**63 - 1)],
    form: Form = "json",
) -> Response:
    """Return the whole story of the decisions of a campaign."""
    return _sent(audit_campaign(store, aircraft_id), form, f"flexsid-decisions-{aircraft_id}")


@router.get("/{decision_id}", response_model=DecisionDetail)
def get_decision(store: TheStore, decision_id: Identity) -> Json:
    """Return one decision with all that was said of it."""
    return Json(_detail(store, store.decisions.get(decision_id)))


@router.post(
    "/{decision_id}/revisions",
    response_model=DecisionDetail,
    status_code=status.HTTP_201_CREATED,
    responses=_STALE,
)
def revise_decision(
    store: TheStore, decision_id: Identity, wanted: RevisionRequest, analyst: NamedAnalyst
) -> Json:
    """Put another proposal in the place of one that is open; votes begin anew."""
    kept = decision_review.revise(
        store, decision_id, wanted.revision, wanted.proposal.record(), analyst
    )
    return Json(_detail(store, kept), status.HTTP_201_CREATED)


@router.post(
    "/{decision_id}/comments", response_model=DecisionDetail, status_code=status.HTTP_201_CREATED
)
def comment_decision(
    store: TheStore, decision_id: Identity, wanted: CommentRequest, analyst: NamedAnalyst
) -> Json:
    """Say something of a decision as a whole, or of one derivative."""
    kept = decision_review.comment(store, decision_id, wanted.text, analyst, wanted.derivative)
    return Json(_detail(store, kept), status.HTTP_201_CREATED)


@router.post(
    "/{decision_id}/votes",
    response_model=DecisionDetail,
    status_code=status.HTTP_201_CREATED,
    responses=_STALE,
)
def vote_on_decision(
    store: TheStore, decision_id: Identity, wanted: VoteRequest, analyst: NamedAnalyst
) -> Json:
    """Approve, reject or ask for changes; the quorum decides."""
    kept = decision_review.cast_vote(
        store, decision_id, wanted.revision, wanted.vote, wanted.text, analyst
    )
    return Json(_detail(store, kept), status.HTTP_201_CREATED)


@router.post(
    "/{decision_id}/withdrawal",
    response_model=DecisionDetail,
    status_code=status.HTTP_201_CREATED,
    responses=_STALE,
)
def withdraw_decision(
    store: TheStore, decision_id: Identity, wanted: WithdrawalRequest, analyst: NamedAnalyst
) -> Json:
    """Take a proposal of one's own back."""
    kept = decision_review.withdraw(store, decision_id, wanted.revision, wanted.text, analyst)
    return Json(_detail(store, kept), status.HTTP_201_CREATED)


@router.get("/{decision_id}/audit", response_model=AuditTrail, responses=_TRAIL)
def get_decision_audit(store: TheStore, decision_id: Identity, form: Form = "json") -> Response:
    """Return the whole story of one decision."""
    return _sent(audit_decision(store, decision_id), form, f"flexsid-decision-{decision_id}")


def _detail(store: Store, decision: Decision) -> DecisionDetail:
    proposal = decision.proposal
    changes = proposal.changes
    return extend(
        DecisionDetail,
        decision,
        rules=decision_review.rules_of(store, decision.aircraft_id),
        events=store.decision_events.find(decision_id=decision.id),
        structure=_structure(store, decision),
        newest_version=store.model_structures.get(proposal.structure.id).version,
        changes=None if changes is None else get_version(store, changes.id, changes.version),
        figures=[store.frozen_figures.get(number) for number in proposal.figure_ids],
    )


def _structure(store: Store, decision: Decision) -> Any:
    reference = decision.proposal.structure
    return get_version(store, reference.id, reference.version)


def _sent(trail: AuditTrail, form: str, name: str) -> Response:
    ending = "md" if form == "markdown" else "json"
    headers = {"Content-Disposition": f'attachment; filename="{name}.{ending}"'}
    if form == "markdown":
        return Response(audit_markdown(trail), media_type="text/markdown", headers=headers)
    return Json(trail, headers=headers)
