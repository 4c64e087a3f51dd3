"""Modal tables: import, frequencies, damping and shapes over fuel; correlation of sources."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Annotated, Literal

import numpy as np
from fastapi import Depends, Query
from fastapi.responses import StreamingResponse
from pydantic import Field

from flexsid.api.authorization import TheAnalyst
from flexsid.api.context import TheStore
from flexsid.api.models.requests import Id, Request, Title
from flexsid.api.models.responses import ModalTableDetail, ModeList, ModeShape, extend_record
from flexsid.api.parameters import query_as
from flexsid.api.router import make_router
from flexsid.api.serialization import (
    Identity,
    Json,
    JsonRoute,
    Reference,
    UploadId,
    drop_none,
)
from flexsid.errors import BadInput
from flexsid.figures.mode_shapes import draw_shape_picture
from flexsid.importers.modal_data import (
    MassOptions,
    ModalDataOptions,
    ModalFiles,
    extract_mass_table,
    extract_modal_data,
    inspect_modal_data,
)
from flexsid.importers.modal_files import FORMS, write_archive, write_modes
from flexsid.records.aircraft import Aircraft
from flexsid.records.flutter import FlutterSummary, SummaryRoots
from flexsid.records.modal_data import (
    Correlation,
    ModalKind,
    ModalTable,
    ModeCorrection,
    ModelOrder,
    Observability,
)
from flexsid.request_models import body_of
from flexsid.storage.lists.list_query import Page
from flexsid.workflow.aircraft.derivative_predictions import set_mass_table
from flexsid.workflow.flutter.flutter_summary import (
    SummaryQuery,
    add_warning,
    read_summary_roots,
    save_flutter_summary,
)
from flexsid.workflow.importing.uploads import open_upload
from flexsid.workflow.modal_data.modal_import import store_modal_data
from flexsid.workflow.modal_data.modal_tables import (
    FREQUENCY_STD,
    apply_corrections,
    compute_frequency_std,
    gather_modes,
    gather_modes_over_fuel,
    open_modes,
    read_nodes,
)
from flexsid.workflow.modal_data.model_updating import update_modal_table
from flexsid.workflow.views import model_order
from flexsid.workflow.views.modal_assurance import compute_observability, correlate
from flexsid.workflow.views.modes import list_modes_at, read_shape

# --- Modal tables: frequencies, damping and shapes over fuel; correlation of sources --------------

modal_tables_router = make_router("/modal-tables", tag="modal-tables", route_class=JsonRoute)


Fuel = Annotated[float, Query(ge=0.0, le=1.0, description="Fuel fraction.")]
BinaryForm = Literal["mat", "op4-binary"]
Form = Literal["uff", "uff-single", "csv", "mat", "op4", "op4-binary"]
Mode = Annotated[int, Query(ge=0, le=10**9, description="Number of the mode.")]


TheOrderQuery = Annotated[model_order.OrderQuery, Depends(query_as(model_order.OrderQuery))]


@body_of(ModeCorrection, without=("modal_table_id", "author", "created_at", "id"))
class CorrectionRequest(Request):
    """A corrected name and symmetry of a mode, with the reason."""


class UpdateRequest(Request):
    """Name of an updated modal table, tests (GVT modal tables) and runs that it is updated from."""

    name: Title
    test_ids: Annotated[tuple[Id, ...], Field(max_length=20)] = ()
    run_ids: Annotated[tuple[Id, ...], Field(max_length=20)] = ()


@modal_tables_router.get("")
def list_modal_tables(
    store: TheStore, aircraft_id: Reference = None, kind: ModalKind | None = None
) -> Page[ModalTable]:
    """List modal tables, in all versions."""
    found = store.modal_tables.find(**drop_none(aircraft_id=aircraft_id, kind=kind))
    return Page(items=[apply_corrections(store, table) for table in found])


@modal_tables_router.get("/order")
def get_model_order(store: TheStore, query: TheOrderQuery) -> ModelOrder:
    """Reduce the predicted model at a condition, and return the number of modes needed."""
    return model_order.study_model_order(store, query)


@modal_tables_router.get("/{modal_table_id}")
def get_modal_table(store: TheStore, modal_table_id: Identity) -> ModalTableDetail:
    """Return one modal table with frequencies and damping, in the order of its source."""
    table = apply_corrections(store, store.modal_tables.get(modal_table_id))
    numbers = {
        name: store.arrays.get(table.arrays[name]).tolist() if name in table.arrays else None
        for name in ("omega", "zeta")
    }
    frequency_std = (
        compute_frequency_std(open_modes(store, table)) if numbers["omega"] is not None else {}
    )
    return extend_record(
        ModalTableDetail,
        table,
        frequency_std=max(frequency_std.values(), default=FREQUENCY_STD[table.kind]),
        **numbers,
    )


@modal_tables_router.get("/{modal_table_id}/modes")
def list_modes(store: TheStore, modal_table_id: Identity, fuel: Fuel = 0.5) -> ModeList:
    """List the modes at a fuel fraction, tracked over fuel by their shapes."""
    items = list(list_modes_at(store, modal_table_id, fuel))
    return ModeList(modal_table_id=modal_table_id, fuel=fuel, items=items)


@modal_tables_router.get("/{modal_table_id}/shape", response_model=ModeShape)
def get_shape(
    store: TheStore,
    modal_table_id: Identity,
    number: Mode,
    fuel: Fuel = 0.5,
    every_node: Annotated[bool, Query(description="All nodes, instead of a thinned set.")] = False,
) -> Json:
    """Return one mode shape at a fuel fraction, on a thinned set of nodes, with the sensors."""
    shape = read_shape(store, modal_table_id, number, fuel, every_node)
    compact = replace(
        shape,
        nodes_m=shape.nodes_m.astype(np.float32),
        displacement_m=shape.displacement_m.astype(np.float32),
        quadrature_m=None if shape.quadrature_m is None else shape.quadrature_m.astype(np.float32),
        lines=np.ascontiguousarray(shape.lines, dtype=np.int32),
    )
    return Json(compact)


@modal_tables_router.get("/{modal_table_id}/correlation")
def get_correlation(
    store: TheStore,
    modal_table_id: Identity,
    other_id: Annotated[int, Query(ge=1)],
    fuel: Fuel = 0.5,
    other_fuel: Annotated[float | None, Query(ge=0.0, le=1.0)] = None,
) -> Correlation:
    """Correlate two modal tables: MAC pairs, frequency and damping differences, COMAC by point."""
    at_other = fuel if other_fuel is None else other_fuel
    return correlate(store, modal_table_id, fuel, other_id, at_other)


@modal_tables_router.get("/{modal_table_id}/observability")
def get_observability(
    store: TheStore,
    modal_table_id: Identity,
    fuel: Fuel = 0.5,
    symmetry: Literal["symmetric", "antisymmetric", "all"] = "symmetric",
    up_to_hz: Annotated[float, Query(gt=0.0, le=10_000.0)] = 20.0,
) -> Observability:
    """Return the observability of the modes by sensor, and the best further accelerometers."""
    symmetric = None if symmetry == "all" else symmetry == "symmetric"
    return compute_observability(store, modal_table_id, fuel, symmetric, up_to_hz)


@modal_tables_router.get(
    "/{modal_table_id}/file",
    response_class=StreamingResponse,
    responses={200: {"content": {kind: {} for kind in FORMS.values()}}},
)
def download_modes(
    store: TheStore,
    modal_table_id: Identity,
    form: Form = "uff",
    fuel: Fuel = 0.5,
) -> StreamingResponse:
    """Return the modes at one fuel fraction as a universal, CSV, MATLAB or matrix file, in SI."""
    modes = gather_modes(store, modal_table_id, fuel)
    name = f"modes-{modal_table_id}-fuel-{fuel:g}.{form.partition('-')[0]}"
    return _send(write_modes(modes, form), FORMS[form], name)


@modal_tables_router.get(
    "/{modal_table_id}/archive",
    response_class=StreamingResponse,
    responses={200: {"content": {"application/zip": {}}}},
)
def download_archive(
    store: TheStore, modal_table_id: Identity, form: BinaryForm = "mat"
) -> StreamingResponse:
    """Return the modes at every fuel fraction of the table, one file each, in a ZIP archive.

    Text of all fuel fractions takes too long for a response: get those one at a time.
    """
    table = store.modal_tables.get(modal_table_id)
    read_nodes(store, table)  # refused before the response begins
    suffix = form.partition("-")[0]
    files = (
        (
            f"modes-{modal_table_id}-fuel-{fuel:g}.{suffix}",
            write_modes(modes, form),
        )
        for fuel, modes in zip(
            table.fuel, gather_modes_over_fuel(store, modal_table_id, table.fuel), strict=True
        )
    )
    return _send(write_archive(files), "application/zip", f"modes-{modal_table_id}-{form}.zip")


@modal_tables_router.get(
    "/{modal_table_id}/picture",
    response_class=StreamingResponse,
    responses={200: {"content": {"image/svg+xml": {}}}},
)
def draw_picture(
    store: TheStore,
    modal_table_id: Identity,
    number: Mode,
    fuel: Fuel = 0.5,
    moving: Annotated[bool, Query(description="Animated through one cycle.")] = False,
    scale: Annotated[float, Query(gt=0.0, le=1.0, description="Share of the span.")] = 0.1,
    azimuth: Annotated[float, Query(ge=-7.0, le=7.0, description="rad")] = -2.2,
    elevation: Annotated[float, Query(ge=-1.6, le=1.6, description="rad")] = 0.42,
) -> StreamingResponse:
    """Return one mode shape as a picture in lines (SVG), still or animated."""
    shape = read_shape(store, modal_table_id, number, fuel)
    parts = draw_shape_picture(
        shape, scale=scale, azimuth=azimuth, elevation=elevation, moving=moving
    )
    return _send(parts, "image/svg+xml", f"mode-{modal_table_id}-{number}.svg")


def _send(content: Iterable[str | bytes], kind: str, name: str) -> StreamingResponse:
    return StreamingResponse(
        content,
        media_type=kind,
        headers={"Content-Disposition": f'attachment; filename="{name}"'},
    )


@modal_tables_router.post("/{modal_table_id}/corrections", status_code=201)
def correct_mode(
    store: TheStore, analyst: TheAnalyst, modal_table_id: Identity, body: CorrectionRequest
) -> ModeCorrection:
    """Correct the name and symmetry of a mode, with a reason."""
    table = store.modal_tables.get(modal_table_id)
    given = body.make_record(ModeCorrection, modal_table_id=modal_table_id, author=analyst)
    if given.number not in table.numbers:
        raise BadInput(f"table '{table.name}' has no mode {given.number}", code="unknown-mode")
    if not given.reason.strip():
        raise BadInput("the reason is empty; give the reason of the correction", code="no-reason")
    return store.mode_corrections.add(replace(given, reason=given.reason.strip()))


@modal_tables_router.post("/{modal_table_id}/updates", status_code=201)
def save_updated_table(
    store: TheStore, modal_table_id: Identity, body: UpdateRequest
) -> ModalTable:
    """Store a new modal table with frequencies and damping from tests and flights."""
    return update_modal_table(store, modal_table_id, body.name, body.test_ids, body.run_ids)


@modal_tables_router.delete("/{modal_table_id}", status_code=204)
def delete_modal_table(store: TheStore, modal_table_id: Identity) -> None:
    """Delete a modal table; refused if runs refer to it."""
    store.modal_tables.delete(modal_table_id)


# --- Modal data and flutter summaries from uploaded files -----------------------------------------

modal_files_router = make_router(tag="modal-data", route_class=JsonRoute)


@body_of(ModalDataOptions)
class ModalDataRequest(Request):
    """Units, axes and fuel fractions of uploaded modal data; see ``ModalDataOptions``."""

    aircraft_id: Id


@body_of(MassOptions)
class MassRequest(Request):
    """Units, axes and fuel fractions of mass properties of uploaded printouts (GPWG)."""

    aircraft_id: Id


class FlutterSummaryRequest(Request):
    """Name of a flutter summary, and unit of its velocities."""

    aircraft_id: Id
    name: Title
    speed_unit: Literal["m/s", "ft/s", "in/s", "kt", "km/h"]


@modal_files_router.get("/uploads/{upload_id}/modal-data")
def inspect_modal_files(store: TheStore, upload_id: UploadId) -> ModalFiles:
    """Return the modes in the files of an upload, and the information missing for an import."""
    return inspect_modal_data(open_upload(store, upload_id))


@modal_files_router.post("/uploads/{upload_id}/modal-data", status_code=201)
def import_modal_data(store: TheStore, upload_id: UploadId, body: ModalDataRequest) -> ModalTable:
    """Import the modes of uploaded files as a modal table, as a new version of its name."""
    aircraft = store.aircraft.get(body.aircraft_id)
    raw = extract_modal_data(open_upload(store, upload_id), body.make_record(ModalDataOptions))
    return store_modal_data(store, aircraft, raw)


@modal_files_router.post("/uploads/{upload_id}/mass-properties")
def import_mass_properties(store: TheStore, upload_id: UploadId, body: MassRequest) -> Aircraft:
    """Set the mass properties of an aircraft at the fuel weights of uploaded printouts."""
    options = body.make_record(MassOptions)
    table = extract_mass_table(open_upload(store, upload_id), options)
    return set_mass_table(store, body.aircraft_id, table)


@modal_files_router.post("/uploads/{upload_id}/flutter-summary", status_code=201)
def import_flutter_summary(
    store: TheStore, upload_id: UploadId, body: FlutterSummaryRequest
) -> FlutterSummary:
    """Import the flutter summary of an uploaded printout, with its flutter speeds."""
    aircraft = store.aircraft.get(body.aircraft_id)
    sources = open_upload(store, upload_id)
    return save_flutter_summary(store, aircraft, sources, body.name, body.speed_unit)


@modal_files_router.get("/flutter-summaries")
def list_flutter_summaries(store: TheStore, aircraft_id: Reference = None) -> Page[FlutterSummary]:
    """List the flutter summaries of one aircraft, or of all."""
    found = [
        add_warning(summary)
        for summary in store.flutter_summaries.find(**drop_none(aircraft_id=aircraft_id))
    ]
    return Page(items=found)


@modal_files_router.get("/flutter-summaries/{summary_id}")
def get_flutter_summary(store: TheStore, summary_id: Identity) -> FlutterSummary:
    """Return one flutter summary."""
    return add_warning(store.flutter_summaries.get(summary_id))


@modal_files_router.get("/flutter-summaries/{summary_id}/roots")
def get_summary_roots(
    store: TheStore, query: Annotated[SummaryQuery, Depends(query_as(SummaryQuery, "summary_id"))]
) -> SummaryRoots:
    """Return the roots of one analysis, and where they become unstable at a damping g."""
    return read_summary_roots(store, query)
