"""Flights and maneuvers: filtered list, details, cutting, import, and transfer functions."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated, Any

from fastapi import Depends, File, Form, Query, Response, UploadFile

from flexsid.api.context import TheContext, TheStore, save_files
from flexsid.api.models.requests import ChangeRequest, CutRequest
from flexsid.api.models.responses import (
    ChangedRecords,
    ChannelSamples,
    ManeuverDetail,
    extend_record,
)
from flexsid.api.responses import make_file_response
from flexsid.api.router import make_router
from flexsid.api.serialization import (
    After,
    Identity,
    Json,
    JsonRoute,
    Limit,
    Reference,
    describe_sort,
    drop_none,
    read_query,
)
from flexsid.errors import BadInput
from flexsid.records.maneuver import Cut, Flight, FlightChannel, Maneuver, ManeuverProposal
from flexsid.records.run import RunProposal
from flexsid.storage import bulk
from flexsid.storage.lists.list_query import Facets, Items, Page
from flexsid.storage.lists.maneuver_list import SORT_FIELDS, ManeuverFilters, ManeuverItem
from flexsid.storage.store import Store
from flexsid.sysid.model.derivatives import ModelAxis
from flexsid.text import LARGEST_ID, split_ids, split_names
from flexsid.workflow.importing import maneuver_cutting
from flexsid.workflow.importing.flight_import import read_upload, store_upload
from flexsid.workflow.runs.run_proposal import propose_run
from flexsid.workflow.views.maneuver import (
    read_samples,
    select_default_channels,
)
from flexsid.workflow.views.sample_files import MEDIA_TYPES, SampleForm, write_samples

# --- Maneuvers: filtered list, details, and import from files -------------------------------------

maneuvers_router = make_router("/maneuvers", tag="maneuvers", route_class=JsonRoute)

Frequency = Annotated[float | None, Query(ge=0.0, le=1e4, allow_inf_nan=False)]
Time = Annotated[float | None, Query(ge=-1e9, le=1e9, allow_inf_nan=False, description="[s]")]
_LARGEST_MAPPING = 1024**2

Filters = Annotated[ManeuverFilters, Depends(read_query(ManeuverFilters))]


@maneuvers_router.get("")
def list_maneuvers(
    store: TheStore,
    filters: Filters,
    sort: Annotated[str, describe_sort(SORT_FIELDS)] = "id",
    limit: Limit = 100,
    after: After = None,
) -> Page[ManeuverItem]:
    """List maneuvers with their condition and the newest run of each method."""
    return store.maneuver_page(sort=sort, limit=limit, after=after, **filters)


@maneuvers_router.get("/facets")
def list_maneuver_facets(store: TheStore, filters: Filters) -> Facets:
    """Return the number of maneuvers, in total and for each value of each filter."""
    return store.maneuver_facets(**filters)


@maneuvers_router.post("/changes")
def change_maneuvers(store: TheStore, body: ChangeRequest) -> ChangedRecords:
    """Delete, restore, tag or untag many maneuvers; all of them, or none.

    The response lists the changed ids: the opposite action on them undoes the change.
    """
    return ChangedRecords(ids=bulk.change_maneuvers(store, body.ids, body.action, body.tag))


@maneuvers_router.get("/{maneuver_id}")
def get_maneuver(store: TheStore, maneuver_id: Identity) -> ManeuverDetail:
    """Return one maneuver with its channels."""
    return build_maneuver_detail(store, store.maneuvers.get(maneuver_id))


@maneuvers_router.get("/{maneuver_id}/run-proposal")
def get_run_proposal(
    store: TheStore,
    maneuver_id: Identity,
    low_hz: Frequency = None,
    high_hz: Frequency = None,
    additional_maneuver_ids: Annotated[
        str | None, Query(description="Ids of maneuvers to be fitted together with this one.")
    ] = None,
    axis: Annotated[
        ModelAxis | None,
        Query(description="Axis of the model, of a maneuver that excites both; else its own."),
    ] = None,
) -> RunProposal:
    """Propose modes, inputs, outputs and band of a run, with their requirements on the data.

    A run requested without a structure uses this proposal.
    """
    if (low_hz is None) != (high_hz is None):
        raise BadInput("give both low_hz and high_hz, or neither", code="bad-band")
    band = None if low_hz is None or high_hz is None else (low_hz, high_hz)
    further = split_ids(additional_maneuver_ids, "additional_maneuver_ids")
    return propose_run(store, (maneuver_id, *further), band, axis)


_SAMPLE_FILES: dict[int | str, dict[str, Any]] = {
    200: {
        "content": {
            media.partition(";")[0]: {"schema": {"type": "string", "format": "binary"}}
            for form, media in MEDIA_TYPES.items()
            if form is not SampleForm.JSON
        }
    }
}


@maneuvers_router.get(
    "/{maneuver_id}/samples", response_model=list[ChannelSamples], responses=_SAMPLE_FILES
)
def get_samples(
    store: TheStore,
    maneuver_id: Identity,
    channels: Annotated[str, Query(description="Names of channels or combinations.")],
    start_s: Time = None,
    stop_s: Time = None,
    form: Annotated[
        SampleForm,
        Query(
            alias="format",
            description="JSON, CSV of channels with the same times, MAT for Simulink, or NetCDF.",
        ),
    ] = SampleForm.JSON,
) -> Response:
    """Return samples as runs use them: in SI units, with the corrections of the maneuver."""
    if (start_s is None) != (stop_s is None):
        raise BadInput("give both start_s and stop_s, or neither", code="bad-interval")
    interval = None if start_s is None or stop_s is None else (start_s, stop_s)
    traces = read_samples(store, maneuver_id, split_names(channels) or (), interval)
    content = write_samples(traces, form, store.maneuvers.get(maneuver_id).label)
    if form is SampleForm.JSON:
        return Response(content, media_type=MEDIA_TYPES[form])
    return make_file_response(content, MEDIA_TYPES[form])


@maneuvers_router.post("", response_model=ManeuverDetail, status_code=201)
def upload_maneuver(
    context: TheContext,
    files: Annotated[list[UploadFile], File(description="Recorder files and tables.")],
    mapping: Annotated[
        UploadFile | None,
        File(description="TOML with channels, units and roles; not needed for known formats."),
    ] = None,
    aircraft_id: Annotated[
        int | None, Form(ge=1, le=LARGEST_ID, description="If the mapping names no aircraft.")
    ] = None,
    confirmed: Annotated[
        bool, Form(description="The guesses of the mapping are confirmed.")
    ] = False,
) -> Json:
    """Import a maneuver from files, completely or not at all."""
    with TemporaryDirectory(prefix="flexsid-") as folder:
        paths, names = save_files(Path(folder), files)
        upload = read_upload(paths, None if mapping is None else _read_text(mapping), names)
        if upload.mapping.maneuver is None:
            raise BadInput("the mapping describes no maneuver", code="bad-mapping", key="maneuver")
        stored = store_upload(
            context.store,
            upload,
            aircraft_id,
            add_builtin_aircraft=context.add_builtin_aircraft,
            confirmed=confirmed,
        ).maneuver
    assert stored is not None
    location = {"Location": f"/api/v1/maneuvers/{stored.id}"}
    return Json(build_maneuver_detail(context.store, stored), 201, location)


@maneuvers_router.delete("/{maneuver_id}", status_code=204)
def delete_maneuver(store: TheStore, maneuver_id: Identity) -> None:
    """Delete a maneuver with its runs; it can be restored."""
    bulk.change_maneuvers(store, [maneuver_id], bulk.Action.DELETE)


def build_maneuver_detail(store: Store, maneuver: Maneuver) -> ManeuverDetail:
    """Return a maneuver with its channels."""
    assert maneuver.id is not None
    aircraft = store.aircraft.get(maneuver.aircraft_id)
    channels = store.channels.find(maneuver_id=maneuver.id)
    roles = {channel.name: channel.role for channel in channels}
    return extend_record(
        ManeuverDetail,
        maneuver,
        flight_number=store.flights.get(maneuver.flight_id).number,
        aircraft_name=aircraft.name,
        channels=channels,
        default_channels=select_default_channels(
            aircraft, maneuver.axis, maneuver.excitation, roles
        ),
        tags=store.tags_of_maneuver(maneuver.id),
    )


def _read_text(mapping: UploadFile) -> str:
    content = mapping.file.read(_LARGEST_MAPPING + 1)
    try:
        if len(content) <= _LARGEST_MAPPING:
            return content.decode("utf-8")
    except UnicodeDecodeError as error:
        raise BadInput("the mapping is not text; expected TOML", code="bad-mapping") from error
    raise BadInput("the mapping is larger than 1 MB; expected a short TOML", code="bad-mapping")


# --- Flights of an aircraft, and maneuvers cut from their recordings ------------------------------

flights_router = make_router("/flights", tag="flights", route_class=JsonRoute)


@flights_router.get("")
def list_flights(store: TheStore, aircraft_id: Reference = None) -> Page[Flight]:
    """List flights, of one aircraft or of all."""
    return Page(items=store.flights.find(**drop_none(aircraft_id=aircraft_id)))


@flights_router.get("/{flight_id}")
def get_flight(store: TheStore, flight_id: Identity) -> Flight:
    """Return one flight."""
    return store.flights.get(flight_id)


@flights_router.get("/{flight_id}/channels")
def list_flight_channels(store: TheStore, flight_id: Identity) -> Items[FlightChannel]:
    """List the channels of the recording of a flight."""
    store.flights.get(flight_id)
    return Items(items=store.flight_channels.find(flight_id=flight_id))


@flights_router.get("/{flight_id}/maneuver-proposals")
def find_maneuvers(store: TheStore, flight_id: Identity) -> Items[ManeuverProposal]:
    """Detect maneuvers in the recording of a flight; nothing is stored."""
    return Items(items=list(maneuver_cutting.find_maneuvers(store, flight_id)))


@flights_router.post("/{flight_id}/maneuvers", response_model=ManeuverDetail, status_code=201)
def cut_maneuver(store: TheStore, flight_id: Identity, body: CutRequest) -> Json:
    """Cut a maneuver from a window of the recording, which is not changed."""
    stored = maneuver_cutting.cut_maneuver(store, flight_id, body.make_record(Cut))
    location = {"Location": f"/api/v1/maneuvers/{stored.id}"}
    return Json(build_maneuver_detail(store, stored), 201, location)
