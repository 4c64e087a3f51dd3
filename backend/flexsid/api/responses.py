"""Responses: figures and their data, and requests that are computed in the background."""

from __future__ import annotations

import io
from dataclasses import dataclass
from typing import Annotated, Any, Literal

from fastapi import Depends, Query, status
from fastapi.responses import Response
from starlette.requests import Request
from starlette.types import Message

from flexsid.api.context import Context
from flexsid.api.serialization import Json
from flexsid.display_units import DisplayUnits, FrequencyUnit, UnitSystem
from flexsid.figures.spec import PrintFormat, extract_curves, write_csv
from flexsid.jobs.kind import Kind, submit
from flexsid.storage.access import get_access, using_access
from flexsid.storage.jobs import job_list

# --- Query parameters of the display units of a response, and of the format of a printed figure


# Asynchronous, so that no thread of the pool is needed.
async def _read_units(
    units: Annotated[
        UnitSystem,
        Query(description="Display units: metric with deg and g, US customary, or SI with rad."),
    ] = UnitSystem.METRIC,
    frequency_unit: Annotated[
        FrequencyUnit, Query(description="Display unit of frequencies.")
    ] = FrequencyUnit.HERTZ,
) -> DisplayUnits:
    return DisplayUnits(units, frequency_unit)


TheUnits = Annotated[DisplayUnits, Depends(_read_units)]


async def _read_print_format(
    width_mm: Annotated[
        float | None,
        Query(ge=20.0, le=1000.0, allow_inf_nan=False, description="Width of the figure. [mm]"),
    ] = None,
    height_mm: Annotated[
        float | None,
        Query(ge=20.0, le=1000.0, allow_inf_nan=False, description="Height of the figure. [mm]"),
    ] = None,
    font_pt: Annotated[
        float | None,
        Query(ge=4.0, le=72.0, allow_inf_nan=False, description="Size of the font. [pt]"),
    ] = None,
    figure_title: Annotated[
        str | None, Query(max_length=200, description="Title above the figure.")
    ] = None,
) -> PrintFormat:
    return PrintFormat(width_mm, height_mm, font_pt, figure_title)


ThePrintFormat = Annotated[PrintFormat, Depends(_read_print_format)]


# --- Figure responses: the Plotly specification, or its data as CSV or MAT ------------------------

Form = Annotated[
    Literal["json", "csv", "mat"],
    Query(alias="format", description="Plotly figure, or its data as CSV or MAT."),
]


FILES: dict[int | str, dict[str, Any]] = {
    200: {
        "content": {
            media: {"schema": {"type": "string", "format": "binary"}}
            for media in ("text/csv", "application/octet-stream")
        }
    }
}
"""Media types of a figure response besides JSON, for the OpenAPI description."""

CSV_FILE: dict[int | str, dict[str, Any]] = {
    200: {"content": {"text/csv": {"schema": {"type": "string", "format": "binary"}}}}
}
"""Media type of a table besides JSON."""


def respond_with_figure(spec: dict[str, Any], form: Form) -> Response:
    """Return the response of a figure, or of its data as a file."""
    if form == "csv":
        content = write_csv(spec).encode()
        return make_file_response(content, "text/csv; charset=utf-8")
    if form == "mat":
        return make_file_response(_write_matlab(spec), "application/octet-stream")
    return Json(spec)


NOTEBOOK_TYPE = "application/x-ipynb+json"
NOTEBOOK: dict[int | str, dict[str, Any]] = {
    200: {"content": {NOTEBOOK_TYPE: {"schema": {"type": "object"}}}}
}
"""Description of a response that is a notebook."""


def make_file_response(content: bytes, media_type: str) -> Response:
    """Return a file to download."""
    # Without a file name: the page names the download.
    disposition = {"Content-Disposition": "attachment"}
    return Response(content, media_type=media_type, headers=disposition)


def get_address(request: Request) -> str:
    """Return the address of this server for its clients: the configured one, or as requested."""
    url: str | None = request.app.state.settings.url
    return (url or str(request.base_url)).rstrip("/")


def _write_matlab(spec: dict[str, Any]) -> bytes:
    """Return a MATLAB 5 file with one struct per curve in ``curves``."""
    from scipy import io as files  # slow to import, and needed for MAT only

    structs = [
        {"name": curve.name, "x_axis": curve.axes[0], "y_axis": curve.axes[1], **curve.columns}
        for curve in extract_curves(spec)
    ]
    out: Any = io.BytesIO()  # the stubs of savemat do not accept BytesIO
    files.savemat(out, {"curves": structs}, do_compression=True)
    return out.getvalue()


# --- Responses to requests that are computed in the background ------------------------------------


def submit_job(
    context: Context, kind: Kind[Any, Any], request: object, author: str, title: str = ""
) -> Json:
    """Queue a job, or find that of an equal request; ``Location`` is its address."""
    job = submit(context.store, kind, request, author, title)
    assert job.id is not None
    context.dispatcher.wake()
    location = {"Location": f"/api/v1/jobs/{job.id}"}
    return Json(job_list.get(context.store, job.id), status.HTTP_202_ACCEPTED, location)


@dataclass(frozen=True, slots=True)
class KnownJob:
    """The newest job of an equal request; null if there is none."""

    job: job_list.JobItem | None


# --- GET requests from the application to its own routes ------------------------------------------

_IDENTITY = (b"host", b"cookie", b"authorization", b"x-forwarded-user", b"x-flexsid-proxy-secret")


async def get_internally(request: Request, path: str, query: str) -> tuple[int, bytes]:
    """Return status and body of ``GET path?query``, called with the host of a request."""
    copied = ("asgi", "http_version", "scheme", "server", "client", "state")
    scope = {
        **{key: request.scope[key] for key in copied if key in request.scope},
        "type": "http",
        "method": "GET",
        "path": path,
        "raw_path": path.encode(),
        "root_path": "",
        "query_string": query.encode(),
        # The same account asks.
        "headers": [pair for pair in request.scope["headers"] if pair[0] in _IDENTITY],
    }
    status, parts = 500, list[bytes]()

    async def receive() -> Message:
        return {"type": "http.request", "body": b"", "more_body": False}

    async def send(message: Message) -> None:
        nonlocal status
        if message["type"] == "http.response.start":
            status = message["status"]
        elif message["type"] == "http.response.body":
            parts.append(message.get("body", b""))

    with using_access(get_access()):  # the other route sets that of its own permission
        await request.app(scope, receive, send)
    return status, b"".join(parts)
