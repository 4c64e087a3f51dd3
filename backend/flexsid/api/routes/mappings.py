"""Mappings that are kept, for the next files of the same recorder."""

from __future__ import annotations

from fastapi import APIRouter, Response, status

from flexsid.api.answers import MappingList
from flexsid.api.context import TheStore
from flexsid.api.requests import MappingRequest
from flexsid.api.wire import Identity, Json
from flexsid.importers.mapping import parse_mapping
from flexsid.records.mapping import StoredMapping

router = APIRouter(prefix="/mappings", tags=["mappings"])


@router.get("", response_model=MappingList)
def list_mappings(store: TheStore) -> Json:
    """List the kept mappings."""
    return Json(MappingList(items=store.mappings.find()))


@router.get("/{mapping_id}", response_model=StoredMapping)
def get_mapping(store: TheStore, mapping_id: Identity) -> Json:
    """Return one mapping."""
    return Json(store.mappings.get(mapping_id))


@router.post("", response_model=StoredMapping, status_code=status.HTTP_201_CREATED)
def add_mapping(store: TheStore, wanted: MappingRequest) -> Json:
    """Keep a mapping under a name; one of the same name is replaced."""
    parse_mapping(wanted.text)
    with store.transaction():
        for same in store.mappings.find(name=wanted.name):
            assert same.id is not None
            store.mappings.delete(same.id)
        kept = store.mappings.add(
            StoredMapping(name=wanted.name, text=wanted.text, note=wanted.note)
        )
    return Json(kept, status.HTTP_201_CREATED, {"Location": f"/api/v1/mappings/{kept.id}"})


@router.delete("/{mapping_id}", status_code=status.HTTP_204_NO_CONTENT)
def delete_mapping(store: TheStore, mapping_id: Identity) -> Response:
    """Forget a mapping; what was imported through it stays."""
    store.mappings.delete(mapping_id)
    return Response(status_code=status.HTTP_204_NO_CONTENT)
