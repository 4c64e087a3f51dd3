"""Maneuvers: filtered list, details, and import from files."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated

from fastapi import Depends, File, Form, Query, UploadFile

from flexsid.api.context import TheContext, TheStore
from flexsid.api.models.requests import ChangeRequest
from flexsid.api.models.response_models import extend_record
from flexsid.api.models.responses import ChangedRecords, ManeuverDetail
from flexsid.api.router import make_router
from flexsid.api.serialization import (
    After,
    Identity,
    Json,
    JsonRoute,
    Limit,
    describe_sort,
    read_query,
)
from flexsid.api.submission import add_job_routes
from flexsid.api.uploads import save_files
from flexsid.errors import BadInput
from flexsid.jobs.kinds import RECONSTRUCTION
from flexsid.records.maneuver import Maneuver
from flexsid.records.run import RunProposal
from flexsid.storage import bulk
from flexsid.storage.list_query import Facets
from flexsid.storage.maneuver_list import SORT_FIELDS, ManeuverFilters, ManeuverItem
from flexsid.storage.paging import Page
from flexsid.storage.store import Store
from flexsid.sysid.model.axes import ModelAxis
from flexsid.text import LARGEST_ID, split_ids
from flexsid.workflow.importing.flight_import import read_upload, store_upload
from flexsid.workflow.runs.run_proposal import propose_run
from flexsid.workflow.views.channels import select_default_channels

router = make_router("/maneuvers", tag="maneuvers", route_class=JsonRoute)

Frequency = Annotated[float | None, Query(ge=0.0, le=1e4, allow_inf_nan=False)]
_LARGEST_MAPPING = 1024**2

Filters = Annotated[ManeuverFilters, Depends(read_query(ManeuverFilters))]


@router.get("")
def list_maneuvers(
    store: TheStore,
    filters: Filters,
    sort: Annotated[str, describe_sort(SORT_FIELDS)] = "id",
    limit: Limit = 100,
    after: After = None,
) -> Page[ManeuverItem]:
    """List maneuvers with their condition and the newest run of each method."""
    return store.maneuver_page(sort=sort, limit=limit, after=after, **filters)


@router.get("/facets")
def list_maneuver_facets(store: TheStore, filters: Filters) -> Facets:
    """Return the number of maneuvers, in total and for each value of each filter."""
    return store.maneuver_facets(**filters)


@router.post("/changes")
def change_maneuvers(store: TheStore, body: ChangeRequest) -> ChangedRecords:
    """Delete, restore, tag or untag many maneuvers; all of them, or none.

    The response lists the changed ids: the opposite action on them undoes the change.
    """
    return ChangedRecords(ids=bulk.change_maneuvers(store, body.ids, body.action, body.tag))


@router.get("/{maneuver_id}")
def get_maneuver(store: TheStore, maneuver_id: Identity) -> ManeuverDetail:
    """Return one maneuver with its channels."""
    return build_maneuver_detail(store, store.maneuvers.get(maneuver_id))


@router.get("/{maneuver_id}/run-proposal")
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


# The figure of the reconstruction has its result.
add_job_routes(
    *(router, "/{maneuver_id}/reconstruction", RECONSTRUCTION, "reconstruction"),
    *(lambda store, query: store.maneuvers.get(query.maneuver_id).label, "maneuver_id"),
)


@router.post("", response_model=ManeuverDetail, status_code=201)
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


@router.delete("/{maneuver_id}", status_code=204)
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
