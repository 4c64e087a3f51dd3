"""Errors as RFC 9457 problems with a stable ``code``."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass, is_dataclass
from http import HTTPStatus
from typing import Any

from fastapi import FastAPI, Request, Response
from fastapi.exceptions import RequestValidationError
from starlette.exceptions import HTTPException
from starlette.routing import compile_path

from flexsid.api.wire import dump
from flexsid.errors import (
    BadInput,
    Cancelled,
    Conflict,
    FlexsidError,
    NotIdentifiable,
    UnknownRecord,
)
from flexsid.storage.files import DatabaseUnavailable
from flexsid.storage.migrate import DatabaseTooNew

_log = logging.getLogger(__name__)

_STATUS: tuple[tuple[type[FlexsidError], HTTPStatus], ...] = (
    (UnknownRecord, HTTPStatus.NOT_FOUND),
    (Conflict, HTTPStatus.CONFLICT),
    (Cancelled, HTTPStatus.CONFLICT),
    (BadInput, HTTPStatus.UNPROCESSABLE_ENTITY),
    (NotIdentifiable, HTTPStatus.UNPROCESSABLE_ENTITY),
    (DatabaseUnavailable, HTTPStatus.SERVICE_UNAVAILABLE),
    (DatabaseTooNew, HTTPStatus.SERVICE_UNAVAILABLE),
)
_CODES = {400: "bad-request", 404: "not-found", 405: "method-not-allowed", 413: "too-large"}


@dataclass(frozen=True, slots=True, kw_only=True)
class FieldError:
    """What is wrong with one field of a request."""

    field: str
    message: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Problem:
    """Why a request was not carried out; ``code`` is stable, ``detail`` is for people."""

    type: str
    title: str
    status: int
    detail: str
    code: str
    errors: tuple[FieldError, ...] | None = None


def problem(status: int, code: str, detail: str, **context: Any) -> Response:
    """Make the answer that describes a problem."""
    body = {
        **context,
        "type": "about:blank",
        "title": HTTPStatus(status).phrase,
        "status": status,
        "detail": detail,
        "code": code,
    }
    return Response(dump(body), status_code=status, media_type="application/problem+json")


def add_error_handlers(app: FastAPI) -> None:
    """Let every error of the application leave as a problem."""
    app.add_exception_handler(FlexsidError, _flexsid_error)
    app.add_exception_handler(RequestValidationError, _bad_request)
    app.add_exception_handler(HTTPException, _http_error)
    app.add_exception_handler(Exception, _unexpected)


async def _flexsid_error(_request: Request, error: Exception) -> Response:
    assert isinstance(error, FlexsidError)
    status = next((s for kind, s in _STATUS if isinstance(error, kind)), None)
    if status is None:
        # Words for the analyst: what was asked cannot be done, whatever it is called.
        _log.warning("an error without a status of its own", exc_info=error)
        status = HTTPStatus.UNPROCESSABLE_ENTITY
    context = {name: _plain(value) for name, value in error.context.items()}
    return problem(status, error.code, error.message, **context)


async def _bad_request(_request: Request, error: Exception) -> Response:
    assert isinstance(error, RequestValidationError)
    errors = [
        FieldError(field=_field(found["loc"]), message=found["msg"]) for found in error.errors()
    ]
    detail = "; ".join(f"{e.field}: {e.message}" for e in errors)
    return problem(422, "invalid-request", detail, errors=errors)


async def _http_error(request: Request, error: Exception) -> Response:
    assert isinstance(error, HTTPException)
    detail = str(error.detail)
    if error.status_code == HTTPStatus.NOT_FOUND:
        detail = f"there is nothing at {request.url.path}"
    if error.status_code == HTTPStatus.METHOD_NOT_ALLOWED:
        detail = f"{request.method} is not possible at {request.url.path}"
    code = _CODES.get(error.status_code, "http-error")
    answer = problem(error.status_code, code, detail)
    answer.headers.update(error.headers or {})
    if error.status_code == HTTPStatus.METHOD_NOT_ALLOWED:
        answer.headers["Allow"] = ", ".join(_methods_at(request))
    return answer


def _methods_at(request: Request) -> list[str]:
    """What is possible at a path; a route knows only its own method."""
    described: dict[str, dict[str, Any]] = request.app.openapi()["paths"]
    here = request.url.path
    found = described.get(here) or next(
        (methods for path, methods in described.items() if compile_path(path)[0].match(here)),
        {"get": None},
    )
    return [method.upper() for method in found]


async def _unexpected(_request: Request, _error: Exception) -> Response:
    # The server logs the trace; the analyst is not shown it.
    return problem(
        500, "internal-error", "an error of the software; the log of the server has the details"
    )


def _field(location: Sequence[str | int]) -> str:
    """Name a field as the client does, without the part of the request it stands in."""
    named = location[1:] if location and location[0] in ("body", "query", "path") else location
    return ".".join(str(part) for part in named) or "body"


def _plain(value: object) -> Any:
    whole = is_dataclass(value) or isinstance(value, str | int | float | bool | list | dict | None)
    return value if whole else str(value)
