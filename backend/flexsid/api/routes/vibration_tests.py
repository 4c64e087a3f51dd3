"""Ground vibration tests: measured frequency responses, modal identification, orthogonality."""

from __future__ import annotations

from typing import Annotated, Literal

from fastapi import APIRouter, Depends, Query
from pydantic import Field

from flexsid.api.context import TheStore
from flexsid.api.requests import Id, Line, Request, Title
from flexsid.api.serialization import Identity, JsonRoute, Reference, UploadId, drop_none
from flexsid.api.submission import add_job_routes
from flexsid.figure_table import ModeSearchParameters
from flexsid.importers.responses import ResponseOptions, extract_responses
from flexsid.jobs.kind import get_result
from flexsid.jobs.kinds import MODES
from flexsid.records.modal_data import FoundModes, MeasuredResponses, ModalTable, Orthogonality
from flexsid.storage.paging import Page
from flexsid.text import LONGEST_FIELD
from flexsid.workflow.importing.uploads import open_upload
from flexsid.workflow.modal_data import ground_vibration_test
from flexsid.workflow.modal_data.orthogonality import OrthogonalityQuery, compute_orthogonality

router = APIRouter(tags=["vibration-tests"], route_class=JsonRoute)

_Metre = Annotated[float, Field(strict=True, ge=-1e6, le=1e6)]
_Fraction = Annotated[float, Field(strict=True, ge=0.0, le=1.0)]
_Hz = Annotated[float | None, Field(strict=True, gt=0.0, le=100_000.0)]
_Index = Annotated[int, Field(strict=True, ge=0, le=1000)]
_Order = Annotated[int, Field(strict=True, ge=4, le=80)]


class ResponsesRequest(Request):
    """Units, axes and fuel fraction of measured frequency responses; see ``ResponseOptions``."""

    aircraft_id: Id
    name: Title
    response_unit: Literal["m/s2", "g", "in/s2", "ft/s2", "m/s", "in/s", "m", "mm", "in", "ft"]
    force_unit: Literal["N", "lbf"]
    fuel: _Fraction = 0.0
    length_unit: Literal["m", "mm", "in", "ft"] | None = None
    axes: Annotated[str, Field(max_length=60), Line] = "aft right up"
    origin: tuple[_Metre, _Metre, _Metre] = (0.0, 0.0, 0.0)


class IdentifiedModesRequest(Request):
    """Identified modes to store, and the name of their modal table."""

    name: Title
    low_hz: _Hz = None
    high_hz: _Hz = None
    order: _Order = 40
    selected: Annotated[tuple[_Index, ...], Field(max_length=500)] | None = None
    template_id: Id | None = None


_Matrix = Annotated[str, Field(min_length=1, max_length=LONGEST_FIELD), Line]


class OrthogonalityRequest(Request):
    """Matrices of the files, and modal tables of the shapes; see ``OrthogonalityQuery``."""

    modal_table_id: Id
    mass: _Matrix
    fuel: _Fraction = 0.5
    other_id: Id | None = None
    other_fuel: _Fraction | None = None
    stiffness: _Matrix | None = None
    length_unit: Literal["m", "mm", "in", "ft"] | None = None
    axes: Annotated[str, Field(max_length=60), Line] = "aft right up"


async def _read_mode_search(
    responses_id: Identity, parameters: Annotated[ModeSearchParameters, Query()]
) -> ground_vibration_test.ModeSearch:
    return ground_vibration_test.ModeSearch(responses_id=responses_id, **dict(parameters))


TheModeSearch = Annotated[ground_vibration_test.ModeSearch, Depends(_read_mode_search)]


@router.post("/uploads/{upload_id}/responses", status_code=201)
def import_responses(
    store: TheStore, upload_id: UploadId, body: ResponsesRequest
) -> MeasuredResponses:
    """Import the frequency responses of uploaded files."""
    aircraft = store.aircraft.get(body.aircraft_id)
    options = body.make_record(ResponseOptions)
    raw = extract_responses(open_upload(store, upload_id), options)
    return ground_vibration_test.store_responses(store, aircraft, raw)


@router.get("/measured-responses")
def list_measured_responses(
    store: TheStore, aircraft_id: Reference = None
) -> Page[MeasuredResponses]:
    """List the measured frequency responses of one aircraft, or of all."""
    return Page(items=store.measured_responses.find(**drop_none(aircraft_id=aircraft_id)))


@router.get("/measured-responses/{responses_id}")
def get_measured_responses(store: TheStore, responses_id: Identity) -> MeasuredResponses:
    """Return one set of measured frequency responses."""
    return store.measured_responses.get(responses_id)


add_job_routes(
    *(router, "/measured-responses/{responses_id}/modes", MODES, "modes", _read_mode_search),
    lambda store, search: store.measured_responses.get(search.responses_id).name,
)


@router.get("/measured-responses/{responses_id}/modes")
def get_identified_modes(store: TheStore, search: TheModeSearch) -> FoundModes:
    """Return the stored modes identified from responses, with standard deviations."""
    return get_result(store, MODES, search).found


@router.post("/measured-responses/{responses_id}/modes", status_code=201)
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


@router.post("/uploads/{upload_id}/orthogonality")
def check_orthogonality(
    store: TheStore, upload_id: UploadId, body: OrthogonalityRequest
) -> Orthogonality:
    """Return the orthogonality of mode shapes, or of two sources, over a mass matrix of files."""
    sources = open_upload(store, upload_id)
    return compute_orthogonality(store, sources, body.make_record(OrthogonalityQuery))
