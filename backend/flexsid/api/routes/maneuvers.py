"""Maneuvers: filtered list, details, and import from files."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated, Any

from fastapi import APIRouter, Depends, File, Form, Query, Response, UploadFile, status

from flexsid.api.context import TheContext, TheStore
from flexsid.api.requests import ChangeRequest
from flexsid.api.responses import ChangedRecords, ManeuverDetail, ManeuverList, extend_record
from flexsid.api.serialization import After, Identity, Json, Limit, split_ids
from flexsid.api.uploads import save_files
from flexsid.errors import BadInput
from flexsid.records.maneuver import Maneuver
from flexsid.records.run import Method, RunState
from flexsid.records.run_proposal import RunProposal
from flexsid.storage import bulk
from flexsid.storage.facets import Facets
from flexsid.storage.maneuver_list import SORT_FIELDS, ManeuverFilters
from flexsid.storage.repository import LARGEST_ID
from flexsid.storage.store import Store
from flexsid.workflow.importing.flight_import import read_upload, store_upload
from flexsid.workflow.runs.run_proposal import propose_run

router = APIRouter(prefix="/maneuvers", tags=["maneuvers"])

Frequency = Annotated[float | None, Query(ge=0.0, le=1e4, allow_inf_nan=False)]
_LARGEST_MAPPING = 1024**2


async def read_filters(
    aircraft_id: Annotated[int | None, Query(ge=1, le=LARGEST_ID)] = None,
    flight_id: Annotated[int | None, Query(ge=1, le=LARGEST_ID)] = None,
    fta: Annotated[
        int | None, Query(ge=0, le=10**9, description="Number of the flight-test aid.")
    ] = None,
    min_airspeed_ratio: Annotated[
        float | None, Query(allow_inf_nan=False, description="Least V/V_f.")
    ] = None,
    max_airspeed_ratio: Annotated[
        float | None, Query(allow_inf_nan=False, description="Largest V/V_f.")
    ] = None,
    min_fuel: Annotated[float | None, Query(allow_inf_nan=False)] = None,
    max_fuel: Annotated[float | None, Query(allow_inf_nan=False)] = None,
    search: Annotated[
        str | None,
        Query(max_length=200, description="Text contained in label, note, file or aircraft."),
    ] = None,
    method: Annotated[
        Method | None, Query(description="Only maneuvers with a run of this method.")
    ] = None,
    state: Annotated[
        RunState | None, Query(description="State of the newest run, of `method` or of any.")
    ] = None,
    ground: Annotated[
        bool, Query(description="Mini-GVT records on the runway instead of flown maneuvers.")
    ] = False,
    tag: Annotated[
        str | None, Query(max_length=64, description="Only maneuvers with this tag.")
    ] = None,
    deleted: Annotated[bool, Query(description="Deleted maneuvers instead.")] = False,
) -> ManeuverFilters:
    """Return the filters of the list of maneuvers and of its figures."""
    return {
        "aircraft_id": aircraft_id,
        "flight_id": flight_id,
        "fta": fta,
        "min_airspeed_ratio": min_airspeed_ratio,
        "max_airspeed_ratio": max_airspeed_ratio,
        "min_fuel": min_fuel,
        "max_fuel": max_fuel,
        "search": search,
        "method": method,
        "state": state,
        "ground": ground,
        "tag": tag,
        "deleted": deleted,
    }


Filters = Annotated[ManeuverFilters, Depends(read_filters)]


@router.get("", response_model=ManeuverList)
def list_maneuvers(
    store: TheStore,
    filters: Filters,
    sort: Annotated[
        str,
        Query(description=f"`-` for descending order, then one of {', '.join(SORT_FIELDS)}."),
    ] = "id",
    limit: Limit = 100,
    after: After = None,
) -> Json:
    """List maneuvers with their condition and the newest run of each method."""
    return Json(store.maneuver_page(sort=sort, limit=limit, after=after, **filters))


@router.get("/facets", response_model=Facets)
def list_maneuver_facets(store: TheStore, filters: Filters) -> Json:
    """Return the number of maneuvers, in total and for each value of each filter."""
    return Json(store.maneuver_facets(**filters))


@router.post("/changes", response_model=ChangedRecords)
def change_maneuvers(store: TheStore, body: ChangeRequest) -> Json:
    """Delete, restore, tag or untag many maneuvers; all of them, or none.

    The response lists the changed ids: the opposite action on them undoes the change.
    """
    return Json(ChangedRecords(ids=bulk.change_maneuvers(store, body.ids, body.action, body.tag)))


@router.get("/{maneuver_id}", response_model=ManeuverDetail)
def get_maneuver(store: TheStore, maneuver_id: Identity) -> Json:
    """Return one maneuver with its channels."""
    return Json(build_maneuver_detail(store, store.maneuvers.get(maneuver_id)))


@router.get("/{maneuver_id}/run-proposal", response_model=RunProposal)
def get_run_proposal(
    store: TheStore,
    maneuver_id: Identity,
    low_hz: Frequency = None,
    high_hz: Frequency = None,
    additional_maneuver_ids: Annotated[
        str | None, Query(description="Ids of maneuvers to be fitted together with this one.")
    ] = None,
) -> Json:
    """Propose modes, inputs, outputs and band of a run, with their requirements on the data.

    A run requested without a structure uses this proposal.
    """
    if (low_hz is None) != (high_hz is None):
        raise BadInput("give both low_hz and high_hz, or neither", code="bad-band")
    band = None if low_hz is None or high_hz is None else (low_hz, high_hz)
    further = (
        ()
        if additional_maneuver_ids is None
        else split_ids(additional_maneuver_ids, "additional_maneuver_ids")
    )
    return Json(propose_run(store, (maneuver_id, *further), band))


@router.post("", response_model=ManeuverDetail, status_code=status.HTTP_201_CREATED)
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
    return Json(build_maneuver_detail(context.store, stored), status.HTTP_201_CREATED, location)


@router.delete("/{maneuver_id}", status_code=status.HTTP_204_NO_CONTENT)
def delete_maneuver(store: TheStore, maneuver_id: Identity) -> Response:
    """Delete a maneuver with its runs; it can be restored."""
    bulk.change_maneuvers(store, [maneuver_id], bulk.Action.DELETE)
    return Response(status_code=status.HTTP_204_NO_CONTENT)


def build_maneuver_detail(store: Store, maneuver: Maneuver) -> ManeuverDetail:
    """Return a maneuver with its channels."""
    assert maneuver.id is not None
    more: dict[str, Any] = {
        "flight_number": store.flights.get(maneuver.flight_id).number,
        "aircraft_name": store.aircraft.get(maneuver.aircraft_id).name,
        "channels": store.channels.find(maneuver_id=maneuver.id),
        "tags": store.tags_of_maneuver(maneuver.id),
    }
    return extend_record(ManeuverDetail, maneuver, **more)


def _read_text(mapping: UploadFile) -> str:
    content = mapping.file.read(_LARGEST_MAPPING + 1)
    try:
        if len(content) <= _LARGEST_MAPPING:
            return content.decode("utf-8")
    except UnicodeDecodeError as error:
        raise BadInput("the mapping is not text; expected TOML", code="bad-mapping") from error
    raise BadInput("the mapping is larger than 1 MB; expected a short TOML", code="bad-mapping")
