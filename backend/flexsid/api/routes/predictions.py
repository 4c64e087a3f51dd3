"""Predictions: derivatives from sources other than flight."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query

from flexsid.api.answers import DerivativeValue, PredictionDetail, PredictionList, extend
from flexsid.api.context import TheStore
from flexsid.api.wire import Identity, Json, Reference
from flexsid.workflow.aircraft.derivative_predictions import prediction_at

router = APIRouter(prefix="/predictions", tags=["predictions"])


@router.get("", response_model=PredictionList)
def list_predictions(store: TheStore, aircraft_id: Reference = None) -> Json:
    """List predictions, of one aircraft or of all."""
    chosen = {} if aircraft_id is None else {"aircraft_id": aircraft_id}
    return Json(PredictionList(items=store.predictions.find(**chosen)))


@router.get("/{prediction_id}", response_model=PredictionDetail)
def get_prediction(
    store: TheStore,
    prediction_id: Identity,
    fuel: Annotated[
        float | None, Query(ge=0, le=1, description="Fuel fraction; by default the first.")
    ] = None,
) -> Json:
    """Return one prediction with its derivatives at a fuel fraction."""
    prediction = store.predictions.get(prediction_id)
    at_fuel = prediction.fuel[0] if fuel is None else fuel
    derivatives = [
        DerivativeValue(name=name, value=value, std_error=std_error)
        for name, (value, std_error) in prediction_at(store, prediction, at_fuel).items()
    ]
    return Json(extend(PredictionDetail, prediction, at_fuel=at_fuel, derivatives=derivatives))
