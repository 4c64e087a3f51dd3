"""Query parameters: requests read from them, and refusal of unknown, repeated and lenient ones."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Awaitable, Callable
from functools import cache
from http import HTTPStatus
from inspect import Parameter, Signature
from typing import Annotated, Any, TypeVar, get_args

from fastapi import HTTPException, Query, Request, params
from fastapi.dependencies.utils import get_flat_params
from fastapi.routing import APIRoute

from flexsid.api.errors import FieldError
from flexsid.api.serialization import Identity
from flexsid.errors import BadInput
from flexsid.request_models import build_request, derive_parameters
from flexsid.text import LONGEST_NOTE, check_line

T = TypeVar("T")

DESCRIPTION = (
    "A query parameter that a route does not have is refused with 422 and the code"
    " `unknown-parameter`, one that is given twice with `repeated-parameter`. With `.csv` or"
    " `.json` behind its address a GET returns one table of its response, all pages of a list,"
    " with all digits: `/runs/3.csv?table=parameters`."
)

# Requests of an OpenID provider, which may add parameters (RFC 6749, section 4.1.2).
_EXTENSIBLE = frozenset({"complete_openid_login"})

# By endpoint, since a route is not hashable; the look-up is slower than many responses.
_known: dict[Callable[..., Any], tuple[str, ...]] = {}
_integers: dict[Callable[..., Any], frozenset[str]] = {}

_NO_INTEGER = "Input should be a valid integer, unable to parse string as an integer"


async def refuse_unknown_parameters(request: Request) -> None:
    """Refuse query parameters that the route does not have, or that are repeated.

    Integers have one form, that by which the access of an account to a record is checked: the ids
    `01`, `1.0`, `+1` and `1_0` are refused.

    Raises
    ------
    BadInput
        With the parameter, and the parameters of the route.
    HTTPException
        405 if a word stands where an id is expected: `DELETE /runs/facets`.
    """
    word = any(str(value).replace("-", "").isalpha() for value in request.path_params.values())
    if word and any(getattr(route, "path", "") == request.url.path for route in request.app.routes):
        raise HTTPException(HTTPStatus.METHOD_NOT_ALLOWED)
    _check_integers(request)
    if not request.scope["query_string"]:
        return
    for name, value in request.query_params.multi_items():
        try:
            check_line(value, LONGEST_NOTE)
        except ValueError as error:
            if value.strip():
                raise BadInput(
                    f"{name}: {error}",
                    code="bad-text",
                    errors=[FieldError(field=name, message=str(error))],
                ) from error
    known = _list_parameters(request.scope["route"])
    given = Counter(name for name, _value in request.query_params.multi_items())
    unknown = [name for name in given if name not in known]
    if unknown and request.scope["route"].name not in _EXTENSIBLE:
        takes = f"expected {', '.join(known)}" if known else "expected none"
        raise BadInput(
            f"{request.url.path} has no query parameter {', '.join(map(repr, unknown))}; {takes}",
            code="unknown-parameter",
            errors=[FieldError(field=name, message=f"unknown; {takes}") for name in unknown],
        )
    repeated = [name for name, times in given.items() if times > 1]
    if repeated:
        more = "given more than once; separate several values by commas"
        raise BadInput(
            f"{', '.join(repeated)}: {more}",
            code="repeated-parameter",
            errors=[FieldError(field=name, message=more) for name in repeated],
        )


def check_integer(text: str) -> str:
    """Return the text of an integer.

    Raises
    ------
    ValueError
        If it is not in the one form of integers (see ``flexsid.text.read_id``).
    """
    if re.fullmatch("0|-?[1-9][0-9]{0,19}", text) is None:
        raise ValueError(_NO_INTEGER)
    return text


def _check_integers(request: Request) -> None:
    integers = _list_integers(request.scope["route"])
    given = [*request.path_params.items(), *request.query_params.multi_items()]
    for name, value in given:
        if name in integers:
            try:
                check_integer(str(value))
            except ValueError as error:
                found = [FieldError(field=name, message=str(error))]
                detail = f"{name}: {error}"
                raise BadInput(detail, code="invalid-request", errors=found) from error


def _list_integers(route: APIRoute) -> frozenset[str]:
    integers = _integers.get(route.endpoint)
    if integers is None:
        kinds = {
            each.alias: each.field_info.annotation for each in get_flat_params(route.dependant)
        }
        integers = frozenset(name for name, kind in kinds.items() if _is_integer(kind))
        _integers[route.endpoint] = integers
    return integers


def _is_integer(kind: Any) -> bool:
    """Whether a type is int, with or without a range or None."""
    return kind is int or any(_is_integer(part) for part in get_args(kind))


def _list_parameters(route: APIRoute) -> tuple[str, ...]:
    known = _known.get(route.endpoint)
    if known is None:
        found = get_flat_params(route.dependant)
        other = params.Path | params.Header
        known = tuple(each.alias for each in found if not isinstance(each.field_info, other))
        _known[route.endpoint] = known
    return known


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
