"""Global aerodynamic model: derivatives over the envelope from the estimates of all runs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from fastapi import Depends, Query, Response

from flexsid.api.authorization import TheAnalyst
from flexsid.api.context import TheStore
from flexsid.api.models.design_requests import (
    GlobalModelVersionRequest,
    SaveGlobalPredictionRequest,
)
from flexsid.api.models.responses import extend_record
from flexsid.api.parameters import query_as
from flexsid.api.router import make_router
from flexsid.api.serialization import (
    Identity,
    Json,
    JsonRoute,
    Reference,
    RequiredReference,
    drop_none,
)
from flexsid.jobs.kind import get_result
from flexsid.jobs.kinds import GLOBAL_MODEL
from flexsid.records.aircraft import DerivativePrediction
from flexsid.records.decision import Decision, DecisionState
from flexsid.records.global_model import (
    GlobalModelSummary,
    GlobalModelVersion,
    VersionDifferences,
)
from flexsid.storage.lists.list_query import Items
from flexsid.sysid.exchange.fmu import FmiVersion
from flexsid.workflow.global_model import versions
from flexsid.workflow.global_model.estimates import GlobalModelQuery
from flexsid.workflow.global_model.exports import write_dave_ml, write_global_fmu
from flexsid.workflow.global_model.versions import store_global_prediction

router = make_router("/global-models", tag="global model", route_class=JsonRoute)


@dataclass(frozen=True, slots=True, kw_only=True)
class ReviewedGlobalModel(GlobalModelVersion):
    """A version with its newest decision and the state of that; null if not proposed."""

    decision_id: int | None
    state: DecisionState | None


@dataclass(frozen=True, slots=True, kw_only=True)
class GlobalModelDetail(ReviewedGlobalModel):
    """A version with its model."""

    summary: GlobalModelSummary


TheGlobalModelQuery = Annotated[GlobalModelQuery, Depends(query_as(GlobalModelQuery))]


@router.get(
    "/dave-ml",
    response_class=Response,
    responses={200: {"content": {"application/xml": {"schema": {"type": "string"}}}}},
)
def get_global_model_dave_ml(store: TheStore, query: TheGlobalModelQuery) -> Response:
    """Return the stored global model as DAVE-ML, with standard errors and check cases."""
    content = write_dave_ml(get_result(store, GLOBAL_MODEL, query))
    name = {"Content-Disposition": 'attachment; filename="flexsid-global-model.dml"'}
    return Response(content, media_type="application/xml", headers=name)


@router.get("/versions")
def list_global_model_versions(
    store: TheStore, aircraft_id: Reference = None
) -> Items[ReviewedGlobalModel]:
    """List the stored versions of global models with the state of their review, newest first."""
    found = store.global_model_versions.find(**drop_none(aircraft_id=aircraft_id))
    newest = {one.proposal.global_model_id: one for one in store.decisions.find()}
    return Items(items=[_add_review(one, newest.get(one.id)) for one in reversed(found)])


@router.post("/versions", status_code=201)
def add_global_model_version(
    store: TheStore,
    query: TheGlobalModelQuery,
    body: GlobalModelVersionRequest,
    analyst: TheAnalyst,
) -> GlobalModelVersion:
    """Store a computed global model under the next version of its aircraft and axis.

    A decision proposes it for approval: `POST /decisions` with `global_model_id`.
    """
    result = get_result(store, GLOBAL_MODEL, query)
    return versions.add_version(
        store,
        result,
        prediction_id=query.prediction_id,
        label=body.label,
        note=body.note,
        author=analyst,
    )


@router.get("/versions/{global_model_id}", response_model=GlobalModelDetail)
def get_global_model_version(store: TheStore, global_model_id: Identity) -> Json:
    """Return one version of a global model with its derivatives, scores and outlying runs."""
    version = store.global_model_versions.get(global_model_id)
    summary = versions.load_result(store, version).summary
    reviewed = _add_review(version, versions.find_decision(store, version))
    return Json(extend_record(GlobalModelDetail, reviewed, summary=summary))


@router.get(
    "/versions/{global_model_id}/fmu",
    response_class=Response,
    responses={
        200: {"content": {"application/zip": {"schema": {"type": "string", "format": "binary"}}}}
    },
)
def get_global_model_fmu(
    store: TheStore,
    global_model_id: Identity,
    fmi_version: Annotated[FmiVersion, Query(description="Version of FMI.")] = FmiVersion.FMI_2,
) -> Response:
    """Return a version as an FMU with C sources: derivatives and errors over the conditions."""
    version = store.global_model_versions.get(global_model_id)
    content = write_global_fmu(versions.load_result(store, version), fmi_version)
    file = f"flexsid-global-model-{global_model_id}.fmu"
    name = {"Content-Disposition": f'attachment; filename="{file}"'}
    return Response(content, media_type="application/zip", headers=name)


@router.get("/versions/{global_model_id}/differences", response_model=VersionDifferences)
def compare_global_models(
    store: TheStore, global_model_id: Identity, base_global_model_id: RequiredReference
) -> Json:
    """Compare a version with another: runs, outlying runs, and derivatives at its centre."""
    before = store.global_model_versions.get(base_global_model_id)
    after = store.global_model_versions.get(global_model_id)
    return Json(versions.compare_versions(store, before, after))


def _add_review(version: GlobalModelVersion, decision: Decision | None) -> ReviewedGlobalModel:
    return extend_record(
        ReviewedGlobalModel,
        version,
        decision_id=None if decision is None else decision.id,
        state=None if decision is None else decision.state,
    )


@router.post("/predictions", status_code=201)
def save_global_prediction(
    store: TheStore, query: TheGlobalModelQuery, body: SaveGlobalPredictionRequest
) -> DerivativePrediction:
    """Store the derivatives of a computed global model at one condition as a prediction.

    Runs take priors from it, and pre-flight simulations, designs and comparisons its values.
    """
    result = get_result(store, GLOBAL_MODEL, query)
    return store_global_prediction(store, result, body.source, body.condition)
