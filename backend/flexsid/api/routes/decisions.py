"""Decisions: proposals, comments, votes, review rules, baselines and notifications."""

from __future__ import annotations

from functools import partial
from typing import Annotated, Any, Literal

import anyio.to_thread
import numpy as np
import orjson
from fastapi import Query, Request, Response

from flexsid.api.authorization import NamedAnalyst
from flexsid.api.context import TheStore
from flexsid.api.errors import Problem
from flexsid.api.models.decisions import (
    CommentRequest,
    DecisionDetail,
    DecisionItem,
    FreezeRequest,
    ManeuverBaseline,
    ProposalRequest,
    RevisionRequest,
    RulesHistory,
    RulesRequest,
    StaleProposal,
    VoteRequest,
    WithdrawalRequest,
)
from flexsid.api.models.responses import extend_record
from flexsid.api.responses import get_internally
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
from flexsid.errors import BadInput
from flexsid.jobs.kinds import find_stored_flutter, find_stored_predictions, read_condition_sheet
from flexsid.records.decision import (
    Decision,
    DecisionState,
    FrozenFigure,
    ModelProposal,
    ReviewRules,
    StructureReference,
    Vote,
)
from flexsid.storage.lists.list_query import Items
from flexsid.storage.signatures import SignaturePlace, sign_content
from flexsid.storage.store import Store
from flexsid.text import split_ids
from flexsid.workflow.model_structures.baselines import Baseline, find_baseline, list_baselines
from flexsid.workflow.model_structures.model_structures import get_version
from flexsid.workflow.review import decision_review, notifications
from flexsid.workflow.review.audit import AuditTrail, audit_campaign, audit_decision, write_markdown
from flexsid.workflow.review.frozen_sheet import list_frozen_sheets
from flexsid.workflow.review.vote_evidence import VoteEvidence, collect_vote_evidence

# --- Decisions on model structures and global models: proposals, comments, votes and audit trail

decisions_router = make_router("/decisions", tag="decisions", route_class=JsonRoute)

Form = Annotated[
    Literal["json", "markdown"], Query(alias="format", description="JSON, or Markdown to read.")
]
_STALE: dict[int | str, dict[str, Any]] = {409: {"model": StaleProposal | Problem}}
_TRAIL: dict[int | str, dict[str, Any]] = {
    200: {"content": {"text/markdown": {"schema": {"type": "string"}}}}
}


@decisions_router.get("")
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


@decisions_router.post("", response_model=DecisionDetail, status_code=201)
def propose_decision(store: TheStore, body: ProposalRequest, analyst: NamedAnalyst) -> Json:
    """Propose a model structure or a change of one for conditions, or a global model."""
    stored = decision_review.propose(store, body.to_record(), analyst)
    location = {"Location": f"/api/v1/decisions/{stored.id}"}
    return Json(_build_detail(store, stored), 201, location)


@decisions_router.get("/audit", response_model=AuditTrail, responses=_TRAIL)
def get_campaign_audit(
    store: TheStore, aircraft_id: RequiredReference, form: Form = "json"
) -> Response:
    """Return the audit trail of all decisions of a campaign."""
    name = f"flexsid-decisions-{aircraft_id}"
    return _respond_with_trail(store, audit_campaign(store, aircraft_id), form, name)


@decisions_router.get("/{decision_id}")
def get_decision(store: TheStore, decision_id: Identity) -> DecisionDetail:
    """Return one decision with its comments, votes and history."""
    return _build_detail(store, store.decisions.get(decision_id))


@decisions_router.get("/{decision_id}/evidence")
def get_vote_evidence(store: TheStore, decision_id: Identity) -> VoteEvidence:
    """Return the evidence for a vote: fits, warnings, and comparison with the baseline."""
    return _collect_evidence(store, decision_id)


def _collect_evidence(store: Store, decision_id: int) -> VoteEvidence:
    decision = store.decisions.get(decision_id)
    return collect_vote_evidence(
        store,
        decision.proposal,
        partial(find_stored_flutter, store),
        decision,
        partial(find_stored_predictions, store),
    )


@decisions_router.post("/{decision_id}/revisions", status_code=201, responses=_STALE)
def revise_decision(
    store: TheStore, decision_id: Identity, body: RevisionRequest, analyst: NamedAnalyst
) -> DecisionDetail:
    """Replace an open proposal; the votes are reset."""
    stored = decision_review.revise(
        store, decision_id, body.revision, body.proposal.to_record(), analyst
    )
    return _build_detail(store, stored)


@decisions_router.post("/{decision_id}/comments", status_code=201)
def comment_decision(
    store: TheStore, decision_id: Identity, body: CommentRequest, analyst: NamedAnalyst
) -> DecisionDetail:
    """Comment on a decision, or on one derivative."""
    stored = decision_review.comment(store, decision_id, body.text, analyst, body.derivative)
    return _build_detail(store, stored)


@decisions_router.post("/{decision_id}/votes", status_code=201, responses=_STALE)
def vote_on_decision(
    store: TheStore, decision_id: Identity, body: VoteRequest, analyst: NamedAnalyst
) -> DecisionDetail:
    """Vote on a proposal: approve, reject or request changes; decided by the quorum.

    An approval despite warnings of the evidence states its reason in `despite`. The decision
    freezes the sheets of the conditions of its runs: `sheets` of the decision.
    """
    approves = body.vote is Vote.APPROVE
    stored = decision_review.cast_vote(
        store,
        decision_id,
        body.revision,
        body.vote,
        body.text,
        analyst,
        warnings=_collect_evidence(store, decision_id).warnings if approves else (),
        despite=body.despite,
        read_sheet=partial(read_condition_sheet, store),
    )
    return _build_detail(store, stored)


@decisions_router.post("/{decision_id}/withdrawal", status_code=201, responses=_STALE)
def withdraw_decision(
    store: TheStore, decision_id: Identity, body: WithdrawalRequest, analyst: NamedAnalyst
) -> DecisionDetail:
    """Withdraw a proposal; its author only."""
    stored = decision_review.withdraw(store, decision_id, body.revision, body.text, analyst)
    return _build_detail(store, stored)


@decisions_router.get("/{decision_id}/audit", response_model=AuditTrail, responses=_TRAIL)
def get_decision_audit(store: TheStore, decision_id: Identity, form: Form = "json") -> Response:
    """Return the audit trail of one decision."""
    name = f"flexsid-decision-{decision_id}"
    return _respond_with_trail(store, audit_decision(store, decision_id), form, name)


def _build_detail(store: Store, decision: Decision) -> DecisionDetail:
    proposal = decision.proposal
    changes, structure, model = proposal.changes, proposal.structure, proposal.global_model_id
    events = store.decision_events.find(decision_id=decision.id)
    return extend_record(
        DecisionDetail,
        decision,
        rules=decision_review.get_rules(store, decision.aircraft_id),
        events=events,
        structure=None
        if structure is None
        else get_version(store, structure.id, structure.version),
        global_model=None if model is None else store.global_model_versions.get(model),
        newest_version=_find_newest_version(store, decision),
        changes=None if changes is None else get_version(store, changes.id, changes.version),
        figures=[store.frozen_figures.get(number) for number in proposal.figure_ids],
        sheets=list_frozen_sheets(store, events),
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


# --- Review rules, baselines, frozen figures and notifications ------------------------------------

review_router = make_router(tag="review", route_class=JsonRoute)

_MAX_MANEUVERS = 200
_MAX_RUNS = 200
Version = Annotated[
    int | None, Query(ge=1, le=2**31 - 1, description="Version; the newest by default.")
]
_UNIT = "application/json"


@review_router.get("/review-rules/{aircraft_id}")
def get_review_rules(store: TheStore, aircraft_id: Identity) -> RulesHistory:
    """Return the review rules of a campaign, current and earlier ones."""
    current = decision_review.get_rules(store, aircraft_id)
    return RulesHistory(current=current, items=store.review_rules.find(aircraft_id=aircraft_id))


@review_router.put("/review-rules/{aircraft_id}")
def change_review_rules(
    store: TheStore, aircraft_id: Identity, body: RulesRequest, analyst: NamedAnalyst
) -> ReviewRules:
    """Change the review rules of a campaign; earlier ones remain readable."""
    return decision_review.change_rules(
        store, body.make_record(ReviewRules, aircraft_id=aircraft_id, author=analyst)
    )


@review_router.get("/baselines")
def list_campaign_baselines(store: TheStore, aircraft_id: RequiredReference) -> Items[Baseline]:
    """List the approved model structures of a campaign, most recently approved first."""
    store.aircraft.get(aircraft_id)
    return Items(items=list_baselines(store, aircraft_id))


@review_router.get("/maneuver-baselines")
def list_maneuver_baselines(
    store: TheStore,
    maneuver_ids: Annotated[str, Query(description="Ids of maneuvers, separated by commas.")],
) -> Items[ManeuverBaseline]:
    """Return the approved model structure that runs of each maneuver use by default."""
    ids = split_ids(maneuver_ids, "maneuver_ids")
    if not 1 <= len(ids) <= _MAX_MANEUVERS:
        raise BadInput(f"maneuver_ids has {len(ids)} ids; expected 1 to {_MAX_MANEUVERS}")
    items = [
        ManeuverBaseline(
            maneuver_id=number, baseline=find_baseline(store, store.maneuvers.get(number))
        )
        for number in ids
    ]
    return Items(items=items)


@review_router.get("/proposal-evidence")
def get_proposal_evidence(
    store: TheStore,
    structure_id: RequiredReference,
    run_ids: Annotated[str, Query(description="Ids of runs, separated by commas.")],
    structure_version: Version = None,
) -> VoteEvidence:
    """Return the evidence that a proposal with these runs would have, before it is made."""
    ids = split_ids(run_ids, "run_ids")
    if not 1 <= len(ids) <= _MAX_RUNS:
        raise BadInput(f"run_ids has {len(ids)} ids; expected 1 to {_MAX_RUNS}")
    version = get_version(store, structure_id, structure_version).version
    proposal = ModelProposal(
        title="",
        structure=StructureReference(id=structure_id, version=version),
        limits={},
        reasoning="",
        run_ids=tuple(ids),
    )
    return collect_vote_evidence(store, proposal, partial(find_stored_flutter, store))


@review_router.post("/frozen-figures", response_model=FrozenFigure, status_code=201)
async def freeze_figure(
    request: Request, store: TheStore, body: FreezeRequest, analyst: NamedAnalyst
) -> Response:
    """Store a figure in its current state, independent of later changes of the data."""
    code, content = await get_internally(request, f"/api/v1/figures/{body.kind}", body.query)
    if code != 200:
        return Response(content, code, media_type="application/problem+json")
    stored = await anyio.to_thread.run_sync(partial(_store_figure, store, body, analyst, content))
    return Json(stored, 201)


def _store_figure(store: Store, body: FreezeRequest, analyst: str, content: bytes) -> FrozenFigure:
    try:
        spec = orjson.loads(content)
    except orjson.JSONDecodeError:
        spec = None
    if not isinstance(spec, dict) or "data" not in spec:
        raise BadInput(f"the response of '{body.kind}' is not a figure; omit format")
    with store.transaction():
        array = store.arrays.put(np.frombuffer(content, dtype=np.uint8), _UNIT)
        return store.frozen_figures.add(body.make_record(FrozenFigure, array=array, author=analyst))


@review_router.get("/frozen-figures/{figure_id}")
def get_frozen_figure(store: TheStore, figure_id: Identity) -> FrozenFigure:
    """Return kind, query, title and author of a frozen figure; `GET /figures/frozen` draws it."""
    return store.frozen_figures.get(figure_id)


@review_router.get("/notifications")
def get_notifications(store: TheStore, analyst: NamedAnalyst) -> notifications.Notifications:
    """Return the decisions awaiting an analyst, and the changes since their last visit."""
    return notifications.list_notifications(store, analyst)


@review_router.post("/notifications/seen", status_code=204)
def mark_notifications_seen(store: TheStore, analyst: NamedAnalyst) -> None:
    """Mark all notifications of an analyst as seen."""
    notifications.mark_all_seen(store, analyst)


@review_router.post("/decisions/{decision_id}/seen", status_code=204)
def mark_decision_seen(store: TheStore, decision_id: Identity, analyst: NamedAnalyst) -> None:
    """Mark a decision as seen by an analyst."""
    decision = store.decisions.get(decision_id)
    notifications.mark_seen(store, analyst, f"decision {decision_id}", decision.version)


@review_router.post("/model-structures/{structure_id}/seen", status_code=204)
def mark_structure_seen(store: TheStore, structure_id: Identity, analyst: NamedAnalyst) -> None:
    """Mark the newest version of a model structure as seen by an analyst."""
    structure = store.model_structures.get(structure_id)
    notifications.mark_seen(store, analyst, f"structure {structure_id}", structure.version)
