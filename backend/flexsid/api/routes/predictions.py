"""Predicted derivatives, from sources other than flight test."""

from __future__ import annotations

from typing import Annotated

from fastapi import Query, status

from flexsid.api.analyst import TheAnalyst
from flexsid.api.context import TheContext, TheStore
from flexsid.api.models.prediction_requests import ComputePredictionRequest
from flexsid.api.models.response_models import extend_record
from flexsid.api.models.responses import PredictionDetail
from flexsid.api.router import make_router
from flexsid.api.serialization import Identity, Json, JsonRoute, Reference, drop_none
from flexsid.api.submission import submit_job
from flexsid.jobs.kinds import PREDICTION
from flexsid.records.aircraft import DerivativePrediction, DerivativeValue
from flexsid.storage.job_list import JobItem
from flexsid.storage.paging import Page
from flexsid.workflow.aircraft.derivative_predictions import interpolate_prediction
from flexsid.workflow.modal_data.computed_predictions import check_prediction

router = make_router("/predictions", tag="predictions", route_class=JsonRoute)


@router.get("")
def list_predictions(store: TheStore, aircraft_id: Reference = None) -> Page[DerivativePrediction]:
    """List predictions, of one aircraft or of all."""
    return Page(items=store.predictions.find(**drop_none(aircraft_id=aircraft_id)))


@router.post("", response_model=JobItem, status_code=status.HTTP_202_ACCEPTED)
def compute_prediction(
    context: TheContext, body: ComputePredictionRequest, analyst: TheAnalyst
) -> Json:
    """Compute derivatives from a planform by a doublet lattice, as a job."""
    request = body.to_request()
    check_prediction(context.store, request)
    return submit_job(context, PREDICTION, request, analyst, request.source)


@router.get("/{prediction_id}")
def get_prediction(
    store: TheStore,
    prediction_id: Identity,
    fuel: Annotated[
        float | None, Query(ge=0, le=1, description="Fuel fraction; by default the first.")
    ] = None,
) -> PredictionDetail:
    """Return one prediction with its derivatives at a fuel fraction."""
    prediction = store.predictions.get(prediction_id)
    at_fuel = prediction.fuel[0] if fuel is None else fuel
    derivatives = [
        DerivativeValue(name=name, value=value, std_error=std_error)
        for name, (value, std_error) in interpolate_prediction(store, prediction, at_fuel).items()
    ]
    return extend_record(PredictionDetail, prediction, at_fuel=at_fuel, derivatives=derivatives)
