"""Modal tables: frequencies and damping against fuel."""

from __future__ import annotations

from typing import Any

from fastapi import APIRouter

from flexsid.api.answers import ModalTableDetail, ModalTableList, extend
from flexsid.api.context import TheStore
from flexsid.api.wire import Identity, Json, Reference
from flexsid.records.modal_table import ModalKind

router = APIRouter(prefix="/modal-tables", tags=["modal-tables"])


@router.get("", response_model=ModalTableList)
def list_modal_tables(
    store: TheStore, aircraft_id: Reference = None, kind: ModalKind | None = None
) -> Json:
    """List modal tables."""
    chosen: dict[str, Any] = {"aircraft_id": aircraft_id, "kind": kind}
    wanted = {name: value for name, value in chosen.items() if value is not None}
    return Json(ModalTableList(items=store.modal_tables.find(**wanted)))


@router.get("/{modal_table_id}", response_model=ModalTableDetail)
def get_modal_table(store: TheStore, modal_table_id: Identity) -> Json:
    """Return one modal table with its numbers."""
    table = store.modal_tables.get(modal_table_id)
    numbers = {
        name: store.arrays.get(table.arrays[name]).tolist() if name in table.arrays else None
        for name in ("omega", "zeta")
    }
    return Json(extend(ModalTableDetail, table, **numbers))
