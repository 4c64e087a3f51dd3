"""Tests on the ground: vibration tests, modal identification, orthogonality, mini-GVT records."""

from __future__ import annotations

from typing import Annotated

from fastapi import Depends, Query, status
from pydantic import Field

from flexsid.api.authorization import TheAnalyst
from flexsid.api.context import TheContext, TheStore
from flexsid.api.models.requests import Id, Request, Title
from flexsid.api.models.responses import MeasuredFunction
from flexsid.api.parameters import query_as
from flexsid.api.responses import submit_job
from flexsid.api.router import make_router
from flexsid.api.serialization import Identity, Json, JsonRoute, Reference, UploadId, drop_none
from flexsid.errors import UnknownRecord
from flexsid.importers.responses import AveragingOptions, ResponseOptions, extract_responses
from flexsid.jobs.kind import get_result
from flexsid.jobs.kinds import MODES, ORTHOGONALITY, RESPONSES
from flexsid.records.modal_data import (
    FoundModes,
    MeasuredResponses,
    ModalTable,
    Orthogonality,
)
from flexsid.records.quality import GroundTest
from flexsid.records.run import RunState
from flexsid.request_models import body_of
from flexsid.storage.access import storing_in_campaign
from flexsid.storage.jobs.job_list import JobItem
from flexsid.storage.lists.list_query import Items, Page
from flexsid.workflow.importing.uploads import find_folder, open_upload
from flexsid.workflow.modal_data import ground_vibration_test, orthogonality
from flexsid.workflow.modal_data.ground_vibration_test import ResponseEstimation, check_estimation
from flexsid.workflow.quality import ground_records

# --- Ground tests: mini-GVT records before and after each flight ----------------------------------

ground_tests_router = make_router("/ground-tests", tag="flights", route_class=JsonRoute)


@ground_tests_router.get("")
def list_ground_tests(store: TheStore, aircraft_id: Reference = None) -> Items[GroundTest]:
    """Compare the mini-GVT records before and after every flight that has both."""
    return Items(items=ground_records.compare_all_ground_records(store, aircraft_id))


@ground_tests_router.get("/{flight_id}")
def get_ground_test(store: TheStore, flight_id: Identity) -> GroundTest:
    """Compare the mini-GVT records before and after one flight."""
    return ground_records.compare_ground_records(store, flight_id)


# --- Ground vibration tests: measured frequency responses, modal identification, orthogonality

vibration_tests_router = make_router(tag="vibration-tests", route_class=JsonRoute)

_Metre = Annotated[float, Field(strict=True, ge=-1e6, le=1e6)]
_Fraction = Annotated[float, Field(strict=True, ge=0.0, le=1.0)]
_Hz = Annotated[float | None, Field(strict=True, gt=0.0, le=100_000.0)]
_Index = Annotated[int, Field(strict=True, ge=0, le=1000)]
_Order = Annotated[int, Field(strict=True, ge=4, le=80)]
DofName = Annotated[str, Query(max_length=20, description="Node and direction, such as 12+z.")]


@body_of(ResponseOptions)
class ResponsesRequest(Request):
    """Units, axes and fuel fraction of measured frequency responses; see ``ResponseOptions``.

    Units are required where the files do not state them.
    """

    aircraft_id: Id


@body_of(AveragingOptions)
class EstimatedResponsesRequest(ResponsesRequest):
    """Estimator of frequency responses from time data; see ``AveragingOptions``."""


class IdentifiedModesRequest(Request):
    """Identified modes to store, and the name of their modal table."""

    name: Title
    low_hz: _Hz = None
    high_hz: _Hz = None
    order: _Order = 40
    poles: Annotated[tuple[Id, ...], Field(max_length=200)] = ()
    selected: Annotated[tuple[_Index, ...], Field(max_length=500)] | None = None
    template_id: Id | None = None


@body_of(orthogonality.OrthogonalityQuery)
class OrthogonalityRequest(Request):
    """Matrices of the files, and modal tables of the shapes; see ``OrthogonalityQuery``."""


TheModeSearch = Annotated[
    ground_vibration_test.ModeSearch,
    Depends(query_as(ground_vibration_test.ModeSearch, "responses_id")),
]


@vibration_tests_router.post("/uploads/{upload_id}/responses", status_code=201)
def import_responses(
    store: TheStore, upload_id: UploadId, body: ResponsesRequest
) -> MeasuredResponses:
    """Import the frequency responses of uploaded files."""
    aircraft = store.aircraft.get(body.aircraft_id)
    raw = extract_responses(open_upload(store, upload_id), body.make_record(ResponseOptions))
    return ground_vibration_test.store_responses(store, aircraft, raw)


@vibration_tests_router.post(
    "/uploads/{upload_id}/response-estimates",
    response_model=JobItem,
    status_code=status.HTTP_202_ACCEPTED,
)
def estimate_responses(
    context: TheContext, upload_id: UploadId, body: EstimatedResponsesRequest, analyst: TheAnalyst
) -> Json:
    """Queue the estimation of frequency responses from uploaded time data.

    The result of the job is the id of the measured responses.
    """
    request = ResponseEstimation(
        upload_id=upload_id,
        aircraft_id=body.aircraft_id,
        options=body.make_record(ResponseOptions),
        averaging=body.make_record(AveragingOptions),
    )
    check_estimation(context.store, open_upload(context.store, upload_id), request)
    with storing_in_campaign(body.aircraft_id):
        return submit_job(context, RESPONSES, request, analyst, request.options.name)


@vibration_tests_router.get(
    "/measured-responses/{responses_id}/function", response_model=MeasuredFunction
)
def get_response_function(
    store: TheStore, responses_id: Identity, response_dof: DofName, reference_dof: DofName
) -> Json:
    """Return one frequency response in SI, with coherence and standard deviation if estimated."""
    return Json(
        ground_vibration_test.read_function(store, responses_id, response_dof, reference_dof)
    )


@vibration_tests_router.get("/measured-responses")
def list_measured_responses(
    store: TheStore, aircraft_id: Reference = None
) -> Page[MeasuredResponses]:
    """List the measured frequency responses of one aircraft, or of all."""
    return Page(items=store.measured_responses.find(**drop_none(aircraft_id=aircraft_id)))


@vibration_tests_router.get("/measured-responses/{responses_id}")
def get_measured_responses(store: TheStore, responses_id: Identity) -> MeasuredResponses:
    """Return one set of measured frequency responses."""
    return store.measured_responses.get(responses_id)


@vibration_tests_router.get("/measured-responses/{responses_id}/modes")
def get_identified_modes(store: TheStore, search: TheModeSearch) -> FoundModes:
    """Return the stored modes identified from responses, with standard deviations."""
    return get_result(store, MODES, search).found


@vibration_tests_router.post("/measured-responses/{responses_id}/modes", status_code=201)
def save_identified_modes(
    store: TheStore, responses_id: Identity, body: IdentifiedModesRequest
) -> ModalTable:
    """Store identified modes as a GVT modal table, with the mode names of another table (MAC).

    Their identification is requested before.
    """
    search = body.make_record(ground_vibration_test.ModeSearch, responses_id=responses_id)
    identified = get_result(store, MODES, search)
    return ground_vibration_test.store_found_modes(
        store, identified, body.name, body.selected, body.template_id
    )


@vibration_tests_router.post(
    "/uploads/{upload_id}/orthogonality",
    response_model=JobItem,
    status_code=status.HTTP_202_ACCEPTED,
)
def request_orthogonality(
    context: TheContext, upload_id: UploadId, body: OrthogonalityRequest, analyst: TheAnalyst
) -> Json:
    """Queue the orthogonality of mode shapes, or of two sources, over a mass matrix of files."""
    request = orthogonality.OrthogonalityComputation(
        upload_id=upload_id, query=body.make_record(orthogonality.OrthogonalityQuery)
    )
    find_folder(context.store, upload_id)
    tables = orthogonality.list_compared_tables(context.store, request.query)
    title = f"{' and '.join(table.name for table in tables)}, matrix {request.query.mass}"
    with storing_in_campaign(tables[0].aircraft_id):
        return submit_job(context, ORTHOGONALITY, request, analyst, title)


@vibration_tests_router.get("/orthogonality/{job_id}")
def get_orthogonality(store: TheStore, job_id: Identity) -> Orthogonality:
    """Return the orthogonality that a job has computed."""
    job = store.jobs.get(job_id)
    if job.kind != ORTHOGONALITY.name or job.state is not RunState.SUCCEEDED:
        raise UnknownRecord(f"job {job_id} has computed no orthogonality")
    return ORTHOGONALITY.read_result(job)
