"""Predicted derivatives, from sources other than flight test."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query

from flexsid.api.context import TheStore
from flexsid.api.responses import DerivativeValue, PredictionDetail, PredictionList, extend_record
from flexsid.api.serialization import Identity, Json, Reference
from flexsid.workflow.aircraft.derivative_predictions import interpolate_prediction

router = APIRouter(prefix="/predictions", tags=["predictions"])


@router.get("", response_model=PredictionList)
def list_predictions(store: TheStore, aircraft_id: Reference = None) -> Json:
    """List predictions, of one aircraft or of all."""
    filters = {} if aircraft_id is None else {"aircraft_id": aircraft_id}
    return Json(PredictionList(items=store.predictions.find(**filters)))


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
        for name, (value, std_error) in interpolate_prediction(store, prediction, at_fuel).items()
    ]
    return Json(
        extend_record(PredictionDetail, prediction, at_fuel=at_fuel, derivatives=derivatives)
    )
