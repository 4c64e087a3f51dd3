"""Controllers: control laws of an aircraft."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated, Any

from fastapi import APIRouter, File, Form, Query, Response, UploadFile, status
from pydantic import ConfigDict, Field

from flexsid.api.context import TheStore
from flexsid.api.requests import LONGEST_TEXT, Id, Text, Title
from flexsid.api.serialization import Identity, Json
from flexsid.api.uploads import save_files
from flexsid.errors import BadInput, Conflict
from flexsid.importers import sandbox
from flexsid.records.controller import Controller
from flexsid.storage.repository import LARGEST_ID
from flexsid.workflow.flutter import controllers

router = APIRouter(prefix="/controllers", tags=["controllers"])

_STRICT: Any = ConfigDict(extra="forbid")
_LARGEST = 1_000_000  # bytes of a file


@dataclass(frozen=True, slots=True, kw_only=True)
class ControllerRequest:
    """A controller as JSON: ``reads``, ``drives``, and matrices or transfer functions."""

    aircraft_id: Id
    name: Title
    text: Annotated[str, Field(max_length=LONGEST_TEXT)]

    __pydantic_config__ = _STRICT


@dataclass(frozen=True, slots=True, kw_only=True)
class ControllerList:
    """Controllers, oldest first."""

    items: list[Controller]
    next: str | None = None


@router.get("", response_model=ControllerList)
def list_controllers(
    store: TheStore, aircraft_id: Annotated[int | None, Query(ge=1, le=LARGEST_ID)] = None
) -> Json:
    """List controllers, of one aircraft or all."""
    body = {} if aircraft_id is None else {"aircraft_id": aircraft_id}
    return Json(ControllerList(items=store.controllers.find(**body)))


@router.post("", response_model=Controller, status_code=status.HTTP_201_CREATED)
def create_controller(store: TheStore, body: ControllerRequest) -> Json:
    """Store a controller given as text."""
    controller = controllers.read_controller(body.text, body.aircraft_id, body.name)
    return _respond_created(controllers.add_controller(store, controller))


@router.post("/files", response_model=Controller, status_code=status.HTTP_201_CREATED)
def upload_controller(
    store: TheStore,
    file: Annotated[UploadFile, File(description="JSON, or MATLAB with A, B, C and D.")],
    aircraft_id: Annotated[int, Form(ge=1, le=LARGEST_ID)],
    name: Annotated[Title, Form()],
    reads: Annotated[
        Text, Form(description="For MATLAB: measured signals, separated by commas.")
    ] = "",
    drives: Annotated[
        Text, Form(description="For MATLAB: driven surfaces, separated by commas.")
    ] = "",
) -> Json:
    """Store a controller from a file."""
    if (file.filename or "").lower().endswith(".json"):
        text = file.file.read(_LARGEST + 1)
        if len(text) > _LARGEST:
            raise BadInput(f"the file is larger than {_LARGEST} bytes, the limit of a controller")
        controller = controllers.read_controller(text.decode(errors="replace"), aircraft_id, name)
    else:
        with TemporaryDirectory(prefix="flexsid-") as folder:
            sources = sandbox.read_all(*save_files(Path(folder), [file]))
        controller = controllers.read_matrices(
            sources, aircraft_id, name, _split_names(reads, "reads"), _split_names(drives, "drives")
        )
    return _respond_created(controllers.add_controller(store, controller))


@router.get("/{controller_id}", response_model=Controller)
def get_controller(store: TheStore, controller_id: Identity) -> Json:
    """Return one controller."""
    return Json(store.controllers.get(controller_id))


@router.delete("/{controller_id}", status_code=status.HTTP_204_NO_CONTENT)
def delete_controller(store: TheStore, controller_id: Identity) -> Response:
    """Delete a controller that no pre-flight simulation used."""
    used = store.preflight_simulations.find(controller_id=controller_id)
    if used:
        raise Conflict(
            f"controller {controller_id} is used by {len(used)} pre-flight simulations"
            " and cannot be deleted",
            code="controller-used",
        )
    store.controllers.delete(controller_id)
    return Response(status_code=status.HTTP_204_NO_CONTENT)


def _split_names(text: str, field: str) -> list[str]:
    names = [part.strip() for part in text.split(",") if part.strip()]
    if not names:
        raise BadInput(
            f"'{field}' is empty; give the signal names of the matrices, separated by commas"
        )
    return names


def _respond_created(controller: Controller) -> Json:
    location = {"Location": f"/api/v1/controllers/{controller.id}"}
    return Json(controller, status.HTTP_201_CREATED, location)
