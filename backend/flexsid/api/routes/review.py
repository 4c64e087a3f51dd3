"""Review rules, baselines, frozen figures and notifications."""

from __future__ import annotations

from functools import partial
from typing import Annotated

import anyio.to_thread
import numpy as np
import orjson
from fastapi import Query, Request, Response

from flexsid.api.analyst import NamedAnalyst
from flexsid.api.context import TheStore
from flexsid.api.models.decision_requests import FreezeRequest, RulesRequest
from flexsid.api.models.decision_responses import (
    ManeuverBaseline,
    RulesHistory,
)
from flexsid.api.router import make_router
from flexsid.api.serialization import Identity, Json, JsonRoute, RequiredReference
from flexsid.api.subrequests import get_internally
from flexsid.errors import BadInput
from flexsid.jobs.stored_results import find_stored_flutter
from flexsid.records.decision import (
    FrozenFigure,
    ModelProposal,
    ReviewRules,
    StructureReference,
)
from flexsid.storage.paging import Items
from flexsid.storage.store import Store
from flexsid.text import split_ids
from flexsid.workflow.model_structures.baselines import Baseline, find_baseline, list_baselines
from flexsid.workflow.model_structures.model_structures import get_version
from flexsid.workflow.review import decision_review, notifications
from flexsid.workflow.review.vote_evidence import VoteEvidence, collect_vote_evidence

router = make_router(tag="review", route_class=JsonRoute)

_MAX_MANEUVERS = 200
_MAX_RUNS = 200
Version = Annotated[
    int | None, Query(ge=1, le=2**31 - 1, description="Version; the newest by default.")
]
_UNIT = "application/json"


@router.get("/review-rules/{aircraft_id}")
def get_review_rules(store: TheStore, aircraft_id: Identity) -> RulesHistory:
    """Return the review rules of a campaign, current and earlier ones."""
    current = decision_review.get_rules(store, aircraft_id)
    return RulesHistory(current=current, items=store.review_rules.find(aircraft_id=aircraft_id))


@router.put("/review-rules/{aircraft_id}")
def change_review_rules(
    store: TheStore, aircraft_id: Identity, body: RulesRequest, analyst: NamedAnalyst
) -> ReviewRules:
    """Change the review rules of a campaign; earlier ones remain readable."""
    return decision_review.change_rules(
        store, body.make_record(ReviewRules, aircraft_id=aircraft_id, author=analyst)
    )


@router.get("/baselines")
def list_campaign_baselines(store: TheStore, aircraft_id: RequiredReference) -> Items[Baseline]:
    """List the approved model structures of a campaign, most recently approved first."""
    store.aircraft.get(aircraft_id)
    return Items(items=list_baselines(store, aircraft_id))


@router.get("/maneuver-baselines")
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


@router.get("/proposal-evidence")
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


@router.post("/frozen-figures", response_model=FrozenFigure, status_code=201)
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


@router.get("/frozen-figures/{figure_id}")
def get_frozen_figure(store: TheStore, figure_id: Identity) -> FrozenFigure:
    """Return kind, query, title and author of a frozen figure; `GET /figures/frozen` draws it."""
    return store.frozen_figures.get(figure_id)


@router.get("/notifications")
def get_notifications(store: TheStore, analyst: NamedAnalyst) -> notifications.Notifications:
    """Return the decisions awaiting an analyst, and the changes since their last visit."""
    return notifications.list_notifications(store, analyst)


@router.post("/notifications/seen", status_code=204)
def mark_notifications_seen(store: TheStore, analyst: NamedAnalyst) -> None:
    """Mark all notifications of an analyst as seen."""
    notifications.mark_all_seen(store, analyst)


@router.post("/decisions/{decision_id}/seen", status_code=204)
def mark_decision_seen(store: TheStore, decision_id: Identity, analyst: NamedAnalyst) -> None:
    """Mark a decision as seen by an analyst."""
    decision = store.decisions.get(decision_id)
    notifications.mark_seen(store, analyst, f"decision {decision_id}", decision.version)


@router.post("/model-structures/{structure_id}/seen", status_code=204)
def mark_structure_seen(store: TheStore, structure_id: Identity, analyst: NamedAnalyst) -> None:
    """Mark the newest version of a model structure as seen by an analyst."""
    structure = store.model_structures.get(structure_id)
    notifications.mark_seen(store, analyst, f"structure {structure_id}", structure.version)
