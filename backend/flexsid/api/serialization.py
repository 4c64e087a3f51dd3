"""JSON serialization of records, and parsing of ids and names in queries."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import nullcontext
from functools import cached_property, wraps
from inspect import Parameter, Signature, iscoroutinefunction
from typing import Annotated, Any, TypeVar, get_type_hints

import orjson
from fastapi import Path, Query, Response
from fastapi.routing import APIRoute

from flexsid.storage.repository import reading_once
from flexsid.text import LARGEST_ID

T = TypeVar("T")

MAX_ITEMS = 1000
"""Largest page of a list."""


class Json(Response):
    """Records, lists and figures as JSON; NaN is written as null.

    The records are serialized directly: validating a list of a thousand against response
    models takes five times as long. ``tests/api`` checks the responses against the declared
    models.
    """

    media_type = "application/json"

    def render(self, content: Any) -> bytes:
        """Serialize the content."""
        return dump_json(content)


class DescribedRoute(APIRoute):
    """A route whose response models describe it and are not used for its responses.

    Their schemas, a third of the time in which a server starts, are made with the description.
    """

    def __init__(self, path: str, endpoint: Callable[..., Any], **options: Any) -> None:
        self._declared: dict[str, Any] = {"path": path, "endpoint": endpoint, **options}
        plain = {
            code: {key: value for key, value in response.items() if key != "model"}
            for code, response in (options.get("responses") or {}).items()
        }
        options |= {"response_model": None, "responses": plain}
        super().__init__(path, endpoint, **options)

    @cached_property
    def described(self) -> APIRoute:
        """The same route with its response models."""
        return APIRoute(**self._declared)


class JsonRoute(DescribedRoute):
    """A route whose endpoint returns its response model, which is sent as ``Json``.

    A GET reads every record once.
    """

    def __init__(self, path: str, endpoint: Callable[..., Any], **options: Any) -> None:
        reads = set(options.get("methods") or ()) == {"GET"}

        @wraps(endpoint)
        def respond(**arguments: Any) -> Response:
            with reading_once() if reads else nullcontext():
                content = endpoint(**arguments)
            if isinstance(content, Response):
                return content
            code = options.get("status_code") or 200
            return Response(status_code=code) if content is None else Json(content, code)

        super().__init__(path, endpoint if iscoroutinefunction(endpoint) else respond, **options)


def dump_json(content: Any) -> bytes:
    """Serialize records, arrays and plain values as JSON."""
    options = orjson.OPT_SERIALIZE_NUMPY | orjson.OPT_NON_STR_KEYS | orjson.OPT_UTC_Z
    return orjson.dumps(content, option=options)


Identity = Annotated[int, Path(ge=1, le=LARGEST_ID, description="Id of the record.")]
Reference = Annotated[int | None, Query(ge=1, le=LARGEST_ID)]
RequiredReference = Annotated[int, Query(ge=1, le=LARGEST_ID)]
UploadId = Annotated[str, Path(min_length=1, max_length=64, description="Id of the upload.")]
Limit = Annotated[int, Query(ge=1, le=MAX_ITEMS, description="Maximum number of items.")]
After = Annotated[str | None, Query(description="`next` of the previous page.")]


def drop_none(**filters: Any) -> dict[str, Any]:
    """Return the filters that are given."""
    return {name: value for name, value in filters.items() if value is not None}


def read_query(filters: type[T]) -> Callable[..., T]:
    """Return a dependency with a query parameter for every key of a ``TypedDict``."""

    def read(**values: Any) -> Any:
        return values

    hints = get_type_hints(filters, include_extras=True)
    vars(read)["__signature__"] = Signature(
        [
            Parameter(name, Parameter.KEYWORD_ONLY, default=None, annotation=hint)
            for name, hint in hints.items()
        ]
    )
    return read


def describe_sort(fields: tuple[str, ...]) -> Any:
    """Return the description of the query parameter ``sort`` with these fields."""
    return Query(description=f"`-` for descending order, then one of {', '.join(fields)}.")
