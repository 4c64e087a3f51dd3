"""Requests read from path and query, as their class declares them."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from functools import cache
from inspect import Parameter, Signature
from typing import Annotated, Any, TypeVar

from fastapi import Query

from flexsid.api.serialization import Identity
from flexsid.request_models import build_request, derive_parameters

T = TypeVar("T")


@cache
def query_as(request: type[T], *path: str) -> Callable[..., Awaitable[T]]:
    """Return a dependency that reads a request from the query, and its named ids from the path."""
    model = derive_parameters(request, path)

    async def read(parameters: Any, **ids: int) -> Any:
        return build_request(request, {**dict(parameters), **ids})

    positions = Parameter.KEYWORD_ONLY
    vars(read)["__signature__"] = Signature(
        [
            Parameter("parameters", positions, annotation=Annotated[model, Query()]),
            *(Parameter(name, positions, annotation=Identity) for name in path),
        ]
    )
    return read
