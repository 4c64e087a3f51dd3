"""Controllers, and closed-loop stability of identified models."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated

from fastapi import Depends, File, Form, Response, UploadFile, status
from pydantic import BeforeValidator, Field

from flexsid.api.context import TheStore, save_files
from flexsid.api.models.requests import LONGEST_TEXT, Id, Request, Text, Title
from flexsid.api.models.responses import extend_record, response_of
from flexsid.api.parameters import check_integer, query_as
from flexsid.api.router import make_router
from flexsid.api.serialization import Identity, Json, Reference, drop_none
from flexsid.errors import BadInput, Conflict
from flexsid.importers import sandbox
from flexsid.jobs.kind import get_result
from flexsid.jobs.kinds import CLOSED_LOOP
from flexsid.records import finite_or_none
from flexsid.records.flutter import ClosedLoop, Controller, LoopMargin
from flexsid.storage.lists.list_query import Page
from flexsid.text import LARGEST_ID
from flexsid.workflow.flutter import controllers
from flexsid.workflow.flutter.closed_loop import ClosedLoopQuery

# --- Closed-loop stability of identified models with a controller ---------------------------------

closed_loop_router = make_router("/closed-loop", tag="closed-loop")


@response_of(LoopMargin, array=float | None)
class MarginRow:
    """Stability margins of the loop of one surface at one airspeed.

    A margin is null if the loop is unstable or has no crossover. ``gain_std`` is the standard
    deviation of the natural logarithm of the gain margin.
    """

    airspeed_m_s: float


@response_of(
    ClosedLoop,
    without=("airspeed_m_s", "growth", "growth_std", "closed_roots", "open_roots"),
)
class ClosedLoopStability:
    """Airspeed at which the closed loop becomes unstable, and stability margins over airspeed."""

    margins: list[MarginRow]


_MARGINS = tuple(one.name for one in fields(LoopMargin) if one.name != "surface")
TheClosedLoopQuery = Annotated[ClosedLoopQuery, Depends(query_as(ClosedLoopQuery))]


@closed_loop_router.get("", response_model=ClosedLoopStability)
def get_closed_loop(store: TheStore, query: TheClosedLoopQuery) -> Json:
    """Return the stored stability limit and margins of the runs with a controller."""
    found = get_result(store, CLOSED_LOOP, query)
    return Json(
        extend_record(
            ClosedLoopStability,
            found,
            margins=[
                extend_record(
                    *(MarginRow, margin),
                    airspeed_m_s=float(airspeed),
                    **{name: finite_or_none(getattr(margin, name)[k]) for name in _MARGINS},
                )
                for margin in found.margins
                for k, airspeed in enumerate(found.airspeed_m_s)
            ],
        )
    )


# --- Controllers: control laws of an aircraft -----------------------------------------------------

controllers_router = make_router("/controllers", tag="controllers")

_LARGEST = 1_000_000  # bytes of a file


class ControllerRequest(Request):
    """A controller as JSON: ``reads``, ``drives``, and matrices or transfer functions."""

    aircraft_id: Id
    name: Title
    text: Annotated[str, Field(max_length=LONGEST_TEXT)]


@controllers_router.get("", response_model=Page[Controller])
def list_controllers(store: TheStore, aircraft_id: Reference = None) -> Json:
    """List controllers, of one aircraft or all."""
    return Json(Page(items=store.controllers.find(**drop_none(aircraft_id=aircraft_id))))


@controllers_router.post("", response_model=Controller, status_code=status.HTTP_201_CREATED)
def create_controller(store: TheStore, body: ControllerRequest) -> Json:
    """Store a controller given as text."""
    controller = controllers.read_controller(body.text, body.aircraft_id, body.name)
    return _respond_created(controllers.add_controller(store, controller))


@controllers_router.post("/files", response_model=Controller, status_code=status.HTTP_201_CREATED)
def upload_controller(
    store: TheStore,
    file: Annotated[UploadFile, File(description="JSON, or MATLAB with A, B, C and D.")],
    aircraft_id: Annotated[int, BeforeValidator(check_integer), Form(ge=1, le=LARGEST_ID)],
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
            sources = sandbox.read_all(*save_files(Path(folder), [file]), store.quotas.expansion)
        controller = controllers.read_matrices(
            sources, aircraft_id, name, _split_names(reads, "reads"), _split_names(drives, "drives")
        )
    return _respond_created(controllers.add_controller(store, controller))


@controllers_router.get("/{controller_id}", response_model=Controller)
def get_controller(store: TheStore, controller_id: Identity) -> Json:
    """Return one controller."""
    return Json(store.controllers.get(controller_id))


@controllers_router.delete("/{controller_id}", status_code=status.HTTP_204_NO_CONTENT)
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
