"""Modal tables: frequencies, damping and shapes over fuel; correlation of sources."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated, Any, Literal

import numpy as np
from fastapi import APIRouter, Depends, Query, Response, status
from fastapi.responses import StreamingResponse
from pydantic import ConfigDict, Field

from flexsid.api.analyst import TheAnalyst
from flexsid.api.context import TheStore
from flexsid.api.requests import Text, Title
from flexsid.api.responses import (
    ModalTableDetail,
    ModalTableList,
    ModeList,
    ModeShape,
    extend_record,
)
from flexsid.api.serialization import Identity, Json, Reference
from flexsid.errors import BadInput
from flexsid.importers.modal_files import write_csv, write_universal
from flexsid.records.modal_table import ModalKind, ModeCorrection
from flexsid.records.modal_views import Correlation, ModelOrder, Observability
from flexsid.storage.repository import LARGEST_ID
from flexsid.workflow.modal_data.modal_export import gather_modes
from flexsid.workflow.modal_data.mode_corrections import apply_corrections
from flexsid.workflow.views import model_order
from flexsid.workflow.views.correlation import correlate
from flexsid.workflow.views.fuel import list_modes_at
from flexsid.workflow.views.observability import compute_observability
from flexsid.workflow.views.shape import read_shape

router = APIRouter(prefix="/modal-tables", tags=["modal-tables"])

_STRICT: Any = ConfigDict(extra="forbid")

Fuel = Annotated[float, Query(ge=0.0, le=1.0, description="Fuel fraction.")]
Mode = Annotated[int, Query(ge=0, le=10**9, description="Number of the mode.")]


def _read_order_query(
    aircraft_id: Annotated[int, Query(ge=1, le=LARGEST_ID)],
    airspeed_m_s: Annotated[float, Query(ge=1.0, le=1000.0)],
    fuel: Fuel = 0.5,
    altitude_m: Annotated[float, Query(ge=-1000.0, le=11_000.0)] = 0.0,
    modal_table_id: Reference = None,
    prediction_id: Reference = None,
    low_hz: Annotated[float, Query(ge=0.01, le=100.0)] = model_order.BAND_HZ[0],
    high_hz: Annotated[float, Query(gt=0.01, le=1000.0)] = model_order.BAND_HZ[1],
) -> model_order.OrderQuery:
    if high_hz <= low_hz:
        raise BadInput(
            f"the band is {low_hz:g} to {high_hz:g} Hz; expected low_hz below high_hz",
            code="bad-band",
        )
    return model_order.OrderQuery(
        aircraft_id=aircraft_id,
        airspeed_m_s=airspeed_m_s,
        fuel=fuel,
        altitude_m=altitude_m,
        modal_table_id=modal_table_id,
        prediction_id=prediction_id,
        band_hz=(low_hz, high_hz),
    )


TheOrderQuery = Annotated[model_order.OrderQuery, Depends(_read_order_query)]


@dataclass(frozen=True, slots=True, kw_only=True)
class CorrectionRequest:
    """A corrected name and symmetry of a mode, with the reason."""

    number: Annotated[int, Field(strict=True, ge=0, le=10**9)]
    name: Title
    symmetric: Annotated[bool, Field(strict=True)]
    reason: Text

    __pydantic_config__ = _STRICT


@router.get("", response_model=ModalTableList)
def list_modal_tables(
    store: TheStore, aircraft_id: Reference = None, kind: ModalKind | None = None
) -> Json:
    """List modal tables, in all versions."""
    values: dict[str, Any] = {"aircraft_id": aircraft_id, "kind": kind}
    filters = {name: value for name, value in values.items() if value is not None}
    tables = [apply_corrections(store, table) for table in store.modal_tables.find(**filters)]
    return Json(ModalTableList(items=tables))


@router.get("/order", response_model=ModelOrder)
def get_model_order(store: TheStore, query: TheOrderQuery) -> Json:
    """Reduce the predicted model at a condition, and return the number of modes needed."""
    return Json(model_order.study_model_order(store, query))


@router.get("/{modal_table_id}", response_model=ModalTableDetail)
def get_modal_table(store: TheStore, modal_table_id: Identity) -> Json:
    """Return one modal table with frequencies and damping, in the order of its source."""
    table = apply_corrections(store, store.modal_tables.get(modal_table_id))
    numbers = {
        name: store.arrays.get(table.arrays[name]).tolist() if name in table.arrays else None
        for name in ("omega", "zeta")
    }
    return Json(extend_record(ModalTableDetail, table, **numbers))


@router.get("/{modal_table_id}/modes", response_model=ModeList)
def list_modes(store: TheStore, modal_table_id: Identity, fuel: Fuel = 0.5) -> Json:
    """List the modes at a fuel fraction, tracked over fuel by their shapes."""
    items = list(list_modes_at(store, modal_table_id, fuel))
    return Json(ModeList(modal_table_id=modal_table_id, fuel=fuel, items=items))


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
        lines=np.ascontiguousarray(shape.lines, dtype=np.int32),
    )
    return Json(compact)


@router.get("/{modal_table_id}/correlation", response_model=Correlation)
def get_correlation(
    store: TheStore,
    modal_table_id: Identity,
    other_id: Annotated[int, Query(ge=1)],
    fuel: Fuel = 0.5,
    other_fuel: Annotated[float | None, Query(ge=0.0, le=1.0)] = None,
) -> Json:
    """Correlate two modal tables: MAC pairs, frequency and damping differences, COMAC by point."""
    at_other = fuel if other_fuel is None else other_fuel
    return Json(correlate(store, modal_table_id, fuel, other_id, at_other))


@router.get("/{modal_table_id}/observability", response_model=Observability)
def get_observability(
    store: TheStore,
    modal_table_id: Identity,
    fuel: Fuel = 0.5,
    symmetry: Literal["symmetric", "antisymmetric", "all"] = "symmetric",
    up_to_hz: Annotated[float, Query(gt=0.0, le=10_000.0)] = 20.0,
) -> Json:
    """Return the observability of the modes by sensor, and the best further accelerometers."""
    symmetric = None if symmetry == "all" else symmetry == "symmetric"
    return Json(compute_observability(store, modal_table_id, fuel, symmetric, up_to_hz))


@router.get(
    "/{modal_table_id}/file",
    response_class=StreamingResponse,
    responses={200: {"content": {"text/csv": {}, "text/plain": {}}}},
)
def download_modes(
    store: TheStore,
    modal_table_id: Identity,
    form: Literal["uff", "csv"] = "uff",
    fuel: Fuel = 0.5,
) -> StreamingResponse:
    """Return the modes at one fuel fraction as a universal file or CSV, in SI units."""
    modes = gather_modes(store, modal_table_id, fuel)
    text = write_universal(modes) if form == "uff" else write_csv(modes)
    name = f"modes-{modal_table_id}-fuel-{fuel:g}.{form}"
    return StreamingResponse(
        text,
        media_type="text/csv" if form == "csv" else "text/plain",
        headers={"Content-Disposition": f'attachment; filename="{name}"'},
    )


@router.post(
    "/{modal_table_id}/corrections",
    response_model=ModeCorrection,
    status_code=status.HTTP_201_CREATED,
)
def correct_mode(
    store: TheStore, analyst: TheAnalyst, modal_table_id: Identity, body: CorrectionRequest
) -> Json:
    """Correct the name and symmetry of a mode, with a reason."""
    table = store.modal_tables.get(modal_table_id)
    if body.number not in table.numbers:
        raise BadInput(f"table '{table.name}' has no mode {body.number}", code="unknown-mode")
    if not body.reason.strip():
        raise BadInput("the reason is empty; give the reason of the correction", code="no-reason")
    correction = ModeCorrection(
        modal_table_id=modal_table_id,
        number=body.number,
        name=body.name,
        symmetric=body.symmetric,
        reason=body.reason.strip(),
        author=analyst,
    )
    return Json(store.mode_corrections.add(correction), status.HTTP_201_CREATED)


@router.delete("/{modal_table_id}", status_code=status.HTTP_204_NO_CONTENT)
def delete_modal_table(store: TheStore, modal_table_id: Identity) -> Response:
    """Delete a modal table; refused if runs refer to it."""
    store.modal_tables.delete(modal_table_id)
    return Response(status_code=status.HTTP_204_NO_CONTENT)
