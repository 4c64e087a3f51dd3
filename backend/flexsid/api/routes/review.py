"""What stands around decisions: rules, baselines, frozen figures, notifications."""

from __future__ import annotations

from functools import partial
from typing import Annotated

import anyio.to_thread
import numpy as np
import orjson
from fastapi import APIRouter, Query, Request, Response, status

from flexsid.api.analyst import NamedAnalyst
from flexsid.api.asking import ask
from flexsid.api.context import TheStore
from flexsid.api.decision_answers import (
    BaselineList,
    ManeuverBaseline,
    ManeuverBaselineList,
    RulesHistory,
)
from flexsid.api.decision_requests import FreezeRequest, RulesRequest
from flexsid.api.wire import Identity, Json, split_ids
from flexsid.errors import BadInput
from flexsid.records.decision import FrozenFigure, ReviewRules
from flexsid.storage.repository import LARGEST_ID
from flexsid.storage.store import Store
from flexsid.workflow.model_structures.baselines import baseline_of, list_baselines
from flexsid.workflow.review import decision_review, notifications

router = APIRouter(tags=["review"])

_MOST_MANEUVERS = 200
_UNIT = "application/json"


@router.get("/review-rules/{aircraft_id}", response_model=RulesHistory)
def get_review_rules(store: TheStore, aircraft_id: Identity) -> Json:
    """Return the rules of review of a campaign, and what they were."""
    current = decision_review.rules_of(store, aircraft_id)
    return Json(
        RulesHistory(current=current, items=store.review_rules.find(aircraft_id=aircraft_id))
    )


@router.put("/review-rules/{aircraft_id}", response_model=ReviewRules)
def change_review_rules(
    store: TheStore, aircraft_id: Identity, wanted: RulesRequest, analyst: NamedAnalyst
) -> Json:
    """Change the rules of review of a campaign; the ones before stay readable."""
    return Json(decision_review.change_rules(store, wanted.record(aircraft_id, analyst)))


@router.get("/baselines", response_model=BaselineList)
def list_campaign_baselines(
    store: TheStore, aircraft_id: Annotated[int, Query(ge=1, le=LARGEST_ID)]
) -> Json:
    """List the approved structures of a campaign, the one approved last first."""
    store.aircraft.get(aircraft_id)
    return Json(BaselineList(items=list_baselines(store, aircraft_id)))


@router.get("/maneuver-baselines", response_model=ManeuverBaselineList)
def list_maneuver_baselines(
    store: TheStore,
    maneuver_ids: Annotated[str, Query(description="Ids of maneuvers, separated by commas.")],
) -> Json:
    """Tell for each maneuver which approved structure its runs take by default."""
    ids = split_ids(maneuver_ids, "maneuver_ids")
    if not 1 <= len(ids) <= _MOST_MANEUVERS:
        raise BadInput(f"maneuver_ids: name one to {_MOST_MANEUVERS} maneuvers")
    items = [
        ManeuverBaseline(
            maneuver_id=number, baseline=baseline_of(store, store.maneuvers.get(number))
        )
        for number in ids
    ]
    return Json(ManeuverBaselineList(items=items))


@router.post("/frozen-figures", response_model=FrozenFigure, status_code=status.HTTP_201_CREATED)
async def freeze_figure(
    request: Request, store: TheStore, wanted: FreezeRequest, analyst: NamedAnalyst
) -> Response:
    """Keep a figure as it is now, whatever becomes of the data behind it."""
    answer, content = await ask(request, f"/api/v1/figures/{wanted.kind}", wanted.query)
    if answer != status.HTTP_200_OK:
        return Response(content, answer, media_type="application/problem+json")
    kept = await anyio.to_thread.run_sync(partial(_freeze, store, wanted, analyst, content))
    return Json(kept, status.HTTP_201_CREATED)


def _freeze(store: Store, wanted: FreezeRequest, analyst: str, content: bytes) -> FrozenFigure:
    try:
        spec = orjson.loads(content)
    except orjson.JSONDecodeError:
        spec = None
    if not isinstance(spec, dict) or "data" not in spec:
        raise BadInput(f"figure '{wanted.kind}' was not drawn as a figure; leave format out")
    with store.transaction():
        array = store.arrays.put(np.frombuffer(content, dtype=np.uint8), _UNIT)
        return store.frozen_figures.add(
            FrozenFigure(
                kind=wanted.kind,
                query=wanted.query,
                title=wanted.title,
                array=array,
                author=analyst,
            )
        )


@router.get("/frozen-figures/{figure_id}", response_model=FrozenFigure)
def get_frozen_figure(store: TheStore, figure_id: Identity) -> Json:
    """Return what is known of a frozen figure; ``figures/frozen`` shows it."""
    return Json(store.frozen_figures.get(figure_id))


@router.get("/notifications", response_model=notifications.Notifications)
def get_notifications(store: TheStore, analyst: NamedAnalyst) -> Json:
    """Tell an analyst what waits for them, and what changed since they looked."""
    return Json(notifications.notifications(store, analyst))


@router.post("/notifications/seen", status_code=status.HTTP_204_NO_CONTENT)
def mark_notifications_seen(store: TheStore, analyst: NamedAnalyst) -> Response:
    """Note that an analyst has seen everything there is now."""
    notifications.mark_all_seen(store, analyst)
    return Response(status_code=status.HTTP_204_NO_CONTENT)


@router.post("/decisions/{decision_id}/seen", status_code=status.HTTP_204_NO_CONTENT)
def mark_decision_seen(store: TheStore, decision_id: Identity, analyst: NamedAnalyst) -> Response:
    """Note that an analyst has seen a decision as it stands."""
    decision = store.decisions.get(decision_id)
    notifications.mark_seen(store, analyst, f"decision {decision_id}", decision.version)
    return Response(status_code=status.HTTP_204_NO_CONTENT)


@router.post("/model-structures/{structure_id}/seen", status_code=status.HTTP_204_NO_CONTENT)
def mark_structure_seen(store: TheStore, structure_id: Identity, analyst: NamedAnalyst) -> Response:
    """Note that an analyst has seen the newest version of a model structure."""
    structure = store.model_structures.get(structure_id)
    notifications.mark_seen(store, analyst, f"structure {structure_id}", structure.version)
    return Response(status_code=status.HTTP_204_NO_CONTENT)
