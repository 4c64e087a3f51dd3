"""Errors as RFC 9457 problems with a stable ``code``."""

from __future__ import annotations

import errno
import logging
from collections.abc import Sequence
from dataclasses import dataclass, is_dataclass
from http import HTTPStatus
from typing import Any

from fastapi import FastAPI, Request, Response
from fastapi.exceptions import RequestValidationError
from fastapi.routing import APIRoute
from starlette.exceptions import HTTPException

from flexsid.api.serialization import dump_json
from flexsid.errors import (
    BadInput,
    Cancelled,
    Conflict,
    ContentTooLarge,
    FlexsidError,
    NotIdentifiable,
    StorageFull,
    UnknownRecord,
)
from flexsid.extensions import ExtensionFailed
from flexsid.jobs.health import NotReady
from flexsid.storage.access import AccountUploadsFull, Forbidden
from flexsid.storage.files import DatabaseUnavailable
from flexsid.storage.migrate import DatabaseTooNew
from flexsid.workflow.accounts.sessions import NotLoggedIn, TooManyAttempts, WrongPassword

_log = logging.getLogger(__name__)

_STATUS: tuple[tuple[type[FlexsidError], HTTPStatus], ...] = (
    (NotLoggedIn, HTTPStatus.UNAUTHORIZED),
    (WrongPassword, HTTPStatus.UNAUTHORIZED),
    (TooManyAttempts, HTTPStatus.TOO_MANY_REQUESTS),
    (Forbidden, HTTPStatus.FORBIDDEN),
    (UnknownRecord, HTTPStatus.NOT_FOUND),
    (Conflict, HTTPStatus.CONFLICT),
    (Cancelled, HTTPStatus.CONFLICT),
    (ContentTooLarge, HTTPStatus.REQUEST_ENTITY_TOO_LARGE),
    (AccountUploadsFull, HTTPStatus.REQUEST_ENTITY_TOO_LARGE),
    (StorageFull, HTTPStatus.INSUFFICIENT_STORAGE),
    (BadInput, HTTPStatus.UNPROCESSABLE_ENTITY),
    (NotIdentifiable, HTTPStatus.UNPROCESSABLE_ENTITY),
    (DatabaseUnavailable, HTTPStatus.SERVICE_UNAVAILABLE),
    (NotReady, HTTPStatus.SERVICE_UNAVAILABLE),
    (DatabaseTooNew, HTTPStatus.SERVICE_UNAVAILABLE),
    (ExtensionFailed, HTTPStatus.INTERNAL_SERVER_ERROR),
)
_CODES = {400: "bad-request", 404: "not-found", 405: "method-not-allowed", 413: "too-large"}


@dataclass(frozen=True, slots=True, kw_only=True)
class FieldError:
    """An error in one field of a request."""

    field: str
    message: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Problem:
    """Why a request failed (RFC 9457); ``code`` is stable, ``detail`` is for the reader."""

    type: str
    title: str
    status: int
    detail: str
    code: str
    errors: tuple[FieldError, ...] | None = None


def make_problem(status: int, code: str, detail: str, **context: Any) -> Response:
    """Make the response of a problem."""
    body = {
        **context,
        "type": "about:blank",
        "title": HTTPStatus(status).phrase,
        "status": status,
        "detail": detail,
        "code": code,
    }
    return Response(dump_json(body), status_code=status, media_type="application/problem+json")


def add_error_handlers(app: FastAPI) -> None:
    """Return every error of the application as a problem."""
    app.add_exception_handler(FlexsidError, _handle_flexsid_error)
    app.add_exception_handler(RequestValidationError, _handle_bad_request)
    app.add_exception_handler(HTTPException, _handle_http_error)
    app.add_exception_handler(Exception, _handle_unexpected_error)


async def _handle_flexsid_error(_request: Request, error: Exception) -> Response:
    assert isinstance(error, FlexsidError)
    status = next((s for kind, s in _STATUS if isinstance(error, kind)), None)
    if status is None:
        # The message is meant for the analyst: the request cannot be processed.
        _log.warning("an error class without an HTTP status", exc_info=error)
        status = HTTPStatus.UNPROCESSABLE_ENTITY
    context = {name: _to_json_value(value) for name, value in error.context.items()}
    response = make_problem(status, error.code, error.message, **context)
    if isinstance(error, TooManyAttempts):
        response.headers["Retry-After"] = str(error.wait_s)
    if isinstance(error, NotLoggedIn):
        response.headers["WWW-Authenticate"] = "Bearer"
    return response


async def _handle_bad_request(_request: Request, error: Exception) -> Response:
    assert isinstance(error, RequestValidationError)
    errors = [
        FieldError(field=_name_field(found["loc"]), message=found["msg"])
        for found in error.errors()
    ]
    detail = "; ".join(f"{e.field}: {e.message}" for e in errors)
    return make_problem(422, "invalid-request", detail, errors=errors)


async def _handle_http_error(request: Request, error: Exception) -> Response:
    assert isinstance(error, HTTPException)
    detail = str(error.detail)
    if error.status_code == HTTPStatus.NOT_FOUND:
        detail = f"no resource at {request.url.path}"
    if error.status_code == HTTPStatus.METHOD_NOT_ALLOWED:
        detail = f"{request.method} is not allowed at {request.url.path}"
    code = _CODES.get(error.status_code, "http-error")
    response = make_problem(error.status_code, code, detail)
    response.headers.update(error.headers or {})
    if error.status_code == HTTPStatus.METHOD_NOT_ALLOWED:
        response.headers["Allow"] = ", ".join(_find_methods(request))
    return response


def _find_methods(request: Request) -> list[str]:
    """Return all methods of a path; a route has only its own."""
    here = request.url.path
    routes = [route for route in request.app.routes if isinstance(route, APIRoute)]
    matching = [route.path for route in routes if route.path_regex.match(here)]
    path = here if here in matching else next(iter(matching), None)
    found = {method for one in routes if one.path == path for method in one.methods or ()}
    return sorted(found) or ["GET"]


async def _handle_unexpected_error(_request: Request, error: Exception) -> Response:
    if isinstance(error, OSError) and error.errno in (errno.ENOSPC, errno.EDQUOT):
        detail = "the disk of the server is full; ask who operates it"
        return make_problem(507, StorageFull.code, detail)
    # The traceback is logged by the server and not sent.
    return make_problem(500, "internal-error", "internal error; the server log has the details")


def _name_field(location: Sequence[str | int]) -> str:
    """Return the name of a field, without the part of the request that contains it."""
    named = location[1:] if location and location[0] in ("body", "query", "path") else location
    return ".".join(str(part) for part in named) or "body"


def _to_json_value(value: object) -> Any:
    whole = is_dataclass(value) or isinstance(value, str | int | float | bool | list | dict | None)
    return value if whole else str(value)
