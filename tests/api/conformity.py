"""Responses in tests conform to the OpenAPI description: no server checks what it sends."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import httpx
import jsonschema
from fastapi import FastAPI
from jsonschema.exceptions import best_match
from starlette.routing import compile_path


@cache
def check_against(app: FastAPI) -> Callable[[httpx.Response], None]:
    """Return a hook of a client that fails at a response which is not as described."""
    described = app.openapi()
    known = {"components": described["components"]}
    operations = [
        (method.upper(), compile_path(path)[0], operation["responses"])
        for path, methods in described["paths"].items()
        for method, operation in methods.items()
    ]

    @cache
    def find_schema(method: str, path: str, status: str) -> jsonschema.Draft202012Validator | None:
        responses = next((r for m, at, r in operations if m == method and at.match(path)), {})
        content = responses.get(status, {}).get("content", {}).get("application/json", {})
        schema = content.get("schema")
        return schema and jsonschema.Draft202012Validator({**known, **schema})

    def check(response: httpx.Response) -> None:
        if not (response.is_success and response.headers.get("content-type") == "application/json"):
            return
        request = response.request
        validator = find_schema(request.method, request.url.path, str(response.status_code))
        if validator is None:
            return
        response.read()
        error = best_match(validator.iter_errors(response.json()))
        assert error is None, f"{request.method} {request.url}: {error.json_path}: {error.message}"

    return check
