"""Modal tables: frequencies, damping and shapes over fuel; correlation of sources."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Annotated, Literal

import numpy as np
from fastapi import Depends, Query
from fastapi.responses import StreamingResponse
from pydantic import Field

from flexsid.api.analyst import TheAnalyst
from flexsid.api.context import TheStore
from flexsid.api.models.requests import Id, Request, Title
from flexsid.api.models.response_models import extend_record
from flexsid.api.models.responses import (
    ModalTableDetail,
    ModeList,
    ModeShape,
)
from flexsid.api.parameters import query_as
from flexsid.api.router import make_router
from flexsid.api.serialization import (
    Identity,
    Json,
    JsonRoute,
    Reference,
    drop_none,
)
from flexsid.errors import BadInput
from flexsid.figures.shape_picture import draw_shape_picture
from flexsid.importers.modal_files import FORMS, write_archive, write_modes
from flexsid.records.modal_data import (
    Correlation,
    ModalKind,
    ModalTable,
    ModeCorrection,
    ModelOrder,
    Observability,
)
from flexsid.request_models import body_of
from flexsid.storage.paging import Page
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
from flexsid.workflow.views.fuel import list_modes_at
from flexsid.workflow.views.modal_assurance import correlate
from flexsid.workflow.views.observability import compute_observability
from flexsid.workflow.views.shape import read_shape

router = make_router("/modal-tables", tag="modal-tables", route_class=JsonRoute)


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


@router.get("")
def list_modal_tables(
    store: TheStore, aircraft_id: Reference = None, kind: ModalKind | None = None
) -> Page[ModalTable]:
    """List modal tables, in all versions."""
    found = store.modal_tables.find(**drop_none(aircraft_id=aircraft_id, kind=kind))
    return Page(items=[apply_corrections(store, table) for table in found])


@router.get("/order")
def get_model_order(store: TheStore, query: TheOrderQuery) -> ModelOrder:
    """Reduce the predicted model at a condition, and return the number of modes needed."""
    return model_order.study_model_order(store, query)


@router.get("/{modal_table_id}")
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


@router.get("/{modal_table_id}/modes")
def list_modes(store: TheStore, modal_table_id: Identity, fuel: Fuel = 0.5) -> ModeList:
    """List the modes at a fuel fraction, tracked over fuel by their shapes."""
    items = list(list_modes_at(store, modal_table_id, fuel))
    return ModeList(modal_table_id=modal_table_id, fuel=fuel, items=items)


@router.get("/{modal_table_id}/shape", response_model=ModeShape)
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


@router.get("/{modal_table_id}/correlation")
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


@router.get("/{modal_table_id}/observability")
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


@router.get(
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


@router.get(
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


@router.get(
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


@router.post("/{modal_table_id}/corrections", status_code=201)
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


@router.post("/{modal_table_id}/updates", status_code=201)
def save_updated_table(
    store: TheStore, modal_table_id: Identity, body: UpdateRequest
) -> ModalTable:
    """Store a new modal table with frequencies and damping from tests and flights."""
    return update_modal_table(store, modal_table_id, body.name, body.test_ids, body.run_ids)


@router.delete("/{modal_table_id}", status_code=204)
def delete_modal_table(store: TheStore, modal_table_id: Identity) -> None:
    """Delete a modal table; refused if runs refer to it."""
    store.modal_tables.delete(modal_table_id)
