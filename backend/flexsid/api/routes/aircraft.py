"""Aircraft: geometry, mass, sensors, thrust table, and predicted derivatives."""

from __future__ import annotations

from typing import Annotated

from fastapi import Query, status
from pydantic import Field

from flexsid.api.authorization import TheAnalyst
from flexsid.api.context import TheContext, TheStore
from flexsid.api.models.design_requests import ComputePredictionRequest
from flexsid.api.models.requests import LONGEST_TEXT, Line, MappingText, Name, Request
from flexsid.api.models.responses import PredictionDetail, extend_record
from flexsid.api.responses import submit_job
from flexsid.api.router import make_router
from flexsid.api.serialization import Identity, Json, JsonRoute, Reference, drop_none
from flexsid.jobs.kinds import PREDICTION, list_compared_levels
from flexsid.records.aircraft import Aircraft, DerivativePrediction, DerivativeValue
from flexsid.records.search import CampaignDashboard
from flexsid.records.validation import RepeatedLevels
from flexsid.storage.jobs.job_list import JobItem
from flexsid.storage.lists.list_query import Items, Page
from flexsid.workflow.aircraft import derivative_predictions
from flexsid.workflow.aircraft.derivative_predictions import interpolate_prediction
from flexsid.workflow.aircraft.flight_condition import parse_thrust_table, set_thrust_table
from flexsid.workflow.modal_data.computed_predictions import check_prediction
from flexsid.workflow.views.dashboard import read_dashboard

# --- Aircraft: geometry, mass, sensors, thrust table ----------------------------------------------

aircraft_router = make_router("/aircraft", tag="aircraft", route_class=JsonRoute)

_Name = Annotated[str, Field(min_length=1, max_length=100), Line]


class ThrustRequest(Request):
    """Thrust table of one engine as CSV text, and the channels of the rotation speeds.

    The first row has a label and total temperatures, every other row a rotation speed and the
    thrust at each temperature. Without temperatures the table has two columns.
    """

    engines: Annotated[list[_Name], Field(min_length=1, max_length=16)]
    text: Annotated[str, Field(max_length=LONGEST_TEXT)]
    speed_unit: Name = "rpm"
    temperature_unit: Name = "K"
    thrust_unit: Name = "N"
    source: Annotated[str, Field(max_length=500), Line] = ""


class AircraftRequest(Request):
    """Definition of an aircraft as TOML text: the ``[aircraft]`` part of a mapping."""

    text: MappingText


@aircraft_router.get("")
def list_aircraft(store: TheStore) -> Page[Aircraft]:
    """List all aircraft."""
    return Page(items=store.aircraft.find())


@aircraft_router.post("", response_model=Aircraft, status_code=201)
def add_aircraft(store: TheStore, body: AircraftRequest) -> Json:
    """Add an aircraft before its first flight; modal data and predictions can then be imported."""
    added = derivative_predictions.add_aircraft(store, body.text)
    return Json(added, 201, {"Location": f"/api/v1/aircraft/{added.id}"})


@aircraft_router.get("/{aircraft_id}")
def get_aircraft(store: TheStore, aircraft_id: Identity) -> Aircraft:
    """Return one aircraft."""
    return store.aircraft.get(aircraft_id)


@aircraft_router.get("/{aircraft_id}/dashboard")
def get_dashboard(store: TheStore, aircraft_id: Identity) -> CampaignDashboard:
    """Return coverage of the envelope, identified derivatives and open warnings of a campaign."""
    return read_dashboard(store, aircraft_id)


@aircraft_router.get("/{aircraft_id}/repeated-levels")
def list_repeated_levels(store: TheStore, aircraft_id: Identity) -> Items[RepeatedLevels]:
    """List maneuvers of one condition with one multisine at several amplitudes.

    With the runs that can be compared, and their stored amplitude comparison.
    """
    return Items(items=list_compared_levels(store, aircraft_id))


@aircraft_router.put("/{aircraft_id}")
def replace_aircraft(store: TheStore, aircraft_id: Identity, body: AircraftRequest) -> Aircraft:
    """Correct the definition of an aircraft; surfaces and sensors of recordings must remain."""
    return derivative_predictions.replace_aircraft(store, aircraft_id, body.text)


@aircraft_router.put("/{aircraft_id}/thrust")
def set_thrust(store: TheStore, aircraft_id: Identity, body: ThrustRequest) -> Aircraft:
    """Set the thrust table of an aircraft, from which the thrust of new maneuvers is computed."""
    table = parse_thrust_table(
        body.text,
        tuple(body.engines),
        (body.speed_unit, body.temperature_unit, body.thrust_unit),
        body.source,
    )
    return set_thrust_table(store, aircraft_id, table)


@aircraft_router.delete("/{aircraft_id}/thrust")
def remove_thrust(store: TheStore, aircraft_id: Identity) -> Aircraft:
    """Delete the thrust table of an aircraft; the thrust of existing maneuvers is unchanged."""
    return set_thrust_table(store, aircraft_id, None)


# --- Predicted derivatives, from sources other than flight test -----------------------------------

predictions_router = make_router("/predictions", tag="predictions", route_class=JsonRoute)


@predictions_router.get("")
def list_predictions(store: TheStore, aircraft_id: Reference = None) -> Page[DerivativePrediction]:
    """List predictions, of one aircraft or of all."""
    return Page(items=store.predictions.find(**drop_none(aircraft_id=aircraft_id)))


@predictions_router.post("", response_model=JobItem, status_code=status.HTTP_202_ACCEPTED)
def compute_prediction(
    context: TheContext, body: ComputePredictionRequest, analyst: TheAnalyst
) -> Json:
    """Compute derivatives from a planform by a doublet lattice, as a job."""
    request = body.to_request()
    check_prediction(context.store, request)
    return submit_job(context, PREDICTION, request, analyst, request.source)


@predictions_router.get("/{prediction_id}")
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
