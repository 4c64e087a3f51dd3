"""Stored mappings, for further files of the same recorder."""

from __future__ import annotations

from fastapi import APIRouter, Response, status

from flexsid.api.context import TheStore
from flexsid.api.requests import MappingRequest
from flexsid.api.responses import MappingList
from flexsid.api.serialization import Identity, Json
from flexsid.importers.mapping import parse_mapping
from flexsid.records.mapping import StoredMapping

router = APIRouter(prefix="/mappings", tags=["mappings"])


@router.get("", response_model=MappingList)
def list_mappings(store: TheStore) -> Json:
    """List stored mappings."""
    return Json(MappingList(items=store.mappings.find()))


@router.get("/{mapping_id}", response_model=StoredMapping)
def get_mapping(store: TheStore, mapping_id: Identity) -> Json:
    """Return one mapping."""
    return Json(store.mappings.get(mapping_id))


@router.post("", response_model=StoredMapping, status_code=status.HTTP_201_CREATED)
def add_mapping(store: TheStore, body: MappingRequest) -> Json:
    """Store a mapping under a name; a mapping of the same name is replaced."""
    parse_mapping(body.text)
    with store.transaction():
        for same in store.mappings.find(name=body.name):
            assert same.id is not None
            store.mappings.delete(same.id)
        stored = store.mappings.add(StoredMapping(name=body.name, text=body.text, note=body.note))
    return Json(stored, status.HTTP_201_CREATED, {"Location": f"/api/v1/mappings/{stored.id}"})


@router.delete("/{mapping_id}", status_code=status.HTTP_204_NO_CONTENT)
def delete_mapping(store: TheStore, mapping_id: Identity) -> Response:
    """Delete a mapping; data imported with it are unchanged."""
    store.mappings.delete(mapping_id)
    return Response(status_code=status.HTTP_204_NO_CONTENT)
