"""Controllers: the laws that close the loops of an aircraft."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated, Any

from fastapi import APIRouter, File, Form, Query, Response, UploadFile, status
from pydantic import ConfigDict, Field

from flexsid.api.context import TheStore
from flexsid.api.received import receive
from flexsid.api.requests import LONGEST_TEXT, Id, Text, Title
from flexsid.api.wire import Identity, Json
from flexsid.errors import BadInput, Conflict
from flexsid.importers import confined
from flexsid.records.controller import Controller
from flexsid.storage.repository import LARGEST_ID
from flexsid.workflow.flutter import controllers

router = APIRouter(prefix="/controllers", tags=["controllers"])

_STRICT: Any = ConfigDict(extra="forbid")
_LARGEST = 1_000_000  # bytes of a file


@dataclass(frozen=True, slots=True, kw_only=True)
class ControllerRequest:
    """A controller as JSON text: ``reads``, ``drives``, and matrices or transfer functions."""

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
    wanted = {} if aircraft_id is None else {"aircraft_id": aircraft_id}
    return Json(ControllerList(items=store.controllers.find(**wanted)))


@router.post("", response_model=Controller, status_code=status.HTTP_201_CREATED)
def create_controller(store: TheStore, wanted: ControllerRequest) -> Json:
    """Keep a controller given as text."""
    read = controllers.read_controller(wanted.text, wanted.aircraft_id, wanted.name)
    return _kept(controllers.add_controller(store, read))


@router.post("/files", response_model=Controller, status_code=status.HTTP_201_CREATED)
def upload_controller(
    store: TheStore,
    file: Annotated[UploadFile, File(description="JSON, or MATLAB with A, B, C and D.")],
    aircraft_id: Annotated[int, Form(ge=1, le=LARGEST_ID)],
    name: Annotated[Title, Form()],
    reads: Annotated[Text, Form(description="For MATLAB: signals read, by commas.")] = "",
    drives: Annotated[Text, Form(description="For MATLAB: surfaces driven, by commas.")] = "",
) -> Json:
    """Keep a controller of a file."""
    if (file.filename or "").lower().endswith(".json"):
        text = file.file.read(_LARGEST + 1)
        if len(text) > _LARGEST:
            raise BadInput(f"the file is larger than a controller may be, {_LARGEST} bytes")
        read = controllers.read_controller(text.decode(errors="replace"), aircraft_id, name)
    else:
        with TemporaryDirectory(prefix="flexsid-") as folder:
            sources = confined.read_all(*receive(Path(folder), [file]))
        read = controllers.controller_of_matrices(
            sources, aircraft_id, name, _split(reads, "reads"), _split(drives, "drives")
        )
    return _kept(controllers.add_controller(store, read))


@router.get("/{controller_id}", response_model=Controller)
def get_controller(store: TheStore, controller_id: Identity) -> Json:
    """Return one controller."""
    return Json(store.controllers.get(controller_id))


@router.delete("/{controller_id}", status_code=status.HTTP_204_NO_CONTENT)
def delete_controller(store: TheStore, controller_id: Identity) -> Response:
    """Forget a controller that no rehearsal was flown with."""
    used = store.rehearsals.find(controller_id=controller_id)
    if used:
        raise Conflict(
            f"{len(used)} rehearsals were flown with controller {controller_id}; it stays",
            code="controller-used",
        )
    store.controllers.delete(controller_id)
    return Response(status_code=status.HTTP_204_NO_CONTENT)


def _split(text: str, field: str) -> list[str]:
    names = [part.strip() for part in text.split(",") if part.strip()]
    if not names:
        raise BadInput(f"say which names belong to the matrices: '{field}', by commas")
    return names


def _kept(kept: Controller) -> Json:
    location = {"Location": f"/api/v1/controllers/{kept.id}"}
    return Json(kept, status.HTTP_201_CREATED, location)
