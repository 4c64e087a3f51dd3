"""Model structures shared by runs; each edit is a new version."""

from __future__ import annotations

import re
from typing import Annotated

from fastapi import Header, Path

from flexsid.api.analyst import TheAnalyst
from flexsid.api.context import TheStore
from flexsid.api.errors import Problem
from flexsid.api.models.responses import StaleStructure
from flexsid.api.models.run_requests import ModelStructureRequest, StructureEditRequest
from flexsid.api.router import make_router
from flexsid.api.serialization import Identity, Json, JsonRoute, Reference, drop_none
from flexsid.errors import BadInput
from flexsid.records.model_structure import ModelStructure, StructureVersion
from flexsid.storage.paging import Items, Page
from flexsid.workflow.model_structures import model_structures

router = make_router("/model-structures", tag="model-structures", route_class=JsonRoute)

Version = Annotated[int, Path(ge=1, le=2**31 - 1, description="Version of the record.")]
IfMatch = Annotated[str | None, Header(description='Version that was edited, e.g. `"3"`.')]


@router.get("")
def list_model_structures(store: TheStore, aircraft_id: Reference = None) -> Page[ModelStructure]:
    """List the newest versions of the model structures of one aircraft, or of all."""
    return Page(items=store.model_structures.find(**drop_none(aircraft_id=aircraft_id)))


@router.get("/{structure_id}", response_model=ModelStructure)
def get_model_structure(store: TheStore, structure_id: Identity) -> Json:
    """Return the newest version of one model structure; its number is the ``ETag``."""
    return _respond_with_etag(store.model_structures.get(structure_id))


@router.get("/{structure_id}/versions")
def list_structure_versions(store: TheStore, structure_id: Identity) -> Items[StructureVersion]:
    """List every version of one model structure, oldest first."""
    store.model_structures.get(structure_id)
    found = store.structure_versions.find(structure_id=structure_id)
    return Items(items=found)


@router.get("/{structure_id}/versions/{version}")
def get_structure_version(
    store: TheStore, structure_id: Identity, version: Version
) -> StructureVersion:
    """Return one version of one model structure."""
    return model_structures.get_version(store, structure_id, version)


@router.post("", response_model=ModelStructure, status_code=201)
def add_model_structure(store: TheStore, body: ModelStructureRequest, analyst: TheAnalyst) -> Json:
    """Store a model structure under a name."""
    structure = body.structure.to_record()
    record = body.make_record(ModelStructure, structure=structure, author=analyst)
    return _respond_with_etag(model_structures.add_structure(store, record), 201)


@router.put(
    "/{structure_id}",
    response_model=ModelStructure,
    responses={409: {"model": StaleStructure | Problem}},
)
def edit_model_structure(
    store: TheStore,
    structure_id: Identity,
    body: StructureEditRequest,
    analyst: TheAnalyst,
    if_match: IfMatch = None,
) -> Json:
    """Store a new version; refused (409, with both versions) if the edited one is outdated."""
    edited = model_structures.edit_structure(
        store,
        structure_id,
        read_edited_version(body.version, if_match),
        name=body.name,
        structure=body.structure.to_record(),
        note=body.note,
        author=analyst,
    )
    return _respond_with_etag(edited)


def read_edited_version(in_body: int | None, if_match: str | None) -> int:
    """Return the edited version, from the body or the header ``If-Match``.

    Raises
    ------
    BadInput
        If neither is given, or both are given and differ.
    """
    found = None
    if if_match is not None:
        match = re.fullmatch(r'(?:W/)?"?([0-9]{1,9})"?', if_match.strip())
        if match is None:
            raise BadInput(
                f'If-Match is {if_match!r}; expected the version that was edited, e.g. "3"',
                code="bad-version",
            )
        found = int(match[1])
    versions = {version for version in (in_body, found) if version is not None}
    if len(versions) != 1:
        raise BadInput(
            "the edited version is missing or ambiguous; give it as version or as If-Match",
            code="bad-version",
        )
    return versions.pop()


def _respond_with_etag(record: ModelStructure, code: int = 200) -> Json:
    headers = {"ETag": f'"{record.version}"'}
    if code == 201:
        headers["Location"] = f"/api/v1/model-structures/{record.id}"
    return Json(record, code, headers)
