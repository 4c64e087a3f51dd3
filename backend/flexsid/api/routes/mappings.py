"""Stored mappings, for further files of the same recorder."""

from __future__ import annotations

from flexsid.api.context import TheStore
from flexsid.api.models.requests import MappingRequest
from flexsid.api.router import make_router
from flexsid.api.serialization import Identity, Json, JsonRoute
from flexsid.importers.mapping import parse_mapping
from flexsid.records.maneuver import StoredMapping
from flexsid.storage.paging import Items

router = make_router("/mappings", tag="mappings", route_class=JsonRoute)


@router.get("")
def list_mappings(store: TheStore) -> Items[StoredMapping]:
    """List stored mappings."""
    return Items(items=store.mappings.find())


@router.get("/{mapping_id}")
def get_mapping(store: TheStore, mapping_id: Identity) -> StoredMapping:
    """Return one mapping."""
    return store.mappings.get(mapping_id)


@router.post("", response_model=StoredMapping, status_code=201)
def add_mapping(store: TheStore, body: MappingRequest) -> Json:
    """Store a mapping under a name; a mapping of the same name is replaced."""
    mapping = body.make_record(StoredMapping)
    parse_mapping(mapping.text)
    with store.transaction():
        for same in store.mappings.find(name=mapping.name):
            assert same.id is not None
            store.mappings.delete(same.id)
        stored = store.mappings.add(mapping)
    return Json(stored, 201, {"Location": f"/api/v1/mappings/{stored.id}"})


@router.delete("/{mapping_id}", status_code=204)
def delete_mapping(store: TheStore, mapping_id: Identity) -> None:
    """Delete a mapping; data imported with it are unchanged."""
    store.mappings.delete(mapping_id)
