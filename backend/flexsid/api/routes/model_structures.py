"""Model structures that runs can share."""

from __future__ import annotations

from fastapi import APIRouter, status

from flexsid.api.answers import ModelStructureList
from flexsid.api.context import TheStore
from flexsid.api.requests import ModelStructureRequest
from flexsid.api.wire import Identity, Json, Reference
from flexsid.records.model_structure import ModelStructure

router = APIRouter(prefix="/model-structures", tags=["model-structures"])


@router.get("", response_model=ModelStructureList)
def list_model_structures(store: TheStore, aircraft_id: Reference = None) -> Json:
    """List model structures, of one aircraft or of all."""
    chosen = {} if aircraft_id is None else {"aircraft_id": aircraft_id}
    return Json(ModelStructureList(items=store.model_structures.find(**chosen)))


@router.get("/{structure_id}", response_model=ModelStructure)
def get_model_structure(store: TheStore, structure_id: Identity) -> Json:
    """Return one model structure."""
    return Json(store.model_structures.get(structure_id))


@router.post("", response_model=ModelStructure, status_code=status.HTTP_201_CREATED)
def add_model_structure(store: TheStore, wanted: ModelStructureRequest) -> Json:
    """Keep a model structure under a name."""
    kept = store.model_structures.add(
        ModelStructure(
            aircraft_id=wanted.aircraft_id,
            name=wanted.name,
            structure=wanted.structure.record(),
            note=wanted.note,
        )
    )
    location = {"Location": f"/api/v1/model-structures/{kept.id}"}
    return Json(kept, status.HTTP_201_CREATED, location)
