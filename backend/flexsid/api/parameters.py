"""Refusal of unknown and repeated query parameters."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from http import HTTPStatus
from typing import Any

from fastapi import HTTPException, Request, params
from fastapi.dependencies.utils import get_flat_params
from fastapi.routing import APIRoute

from flexsid.api.errors import FieldError
from flexsid.errors import BadInput
from flexsid.text import LONGEST_NOTE, check_line

DESCRIPTION = (
    "A query parameter that a route does not have is refused with 422 and the code"
    " `unknown-parameter`, one that is given twice with `repeated-parameter`."
)

# Requests of an OpenID provider, which may add parameters (RFC 6749, section 4.1.2).
_EXTENSIBLE = frozenset({"complete_openid_login"})

# By endpoint, since a route is not hashable; the look-up is slower than many responses.
_known: dict[Callable[..., Any], tuple[str, ...]] = {}


async def refuse_unknown_parameters(request: Request) -> None:
    """Refuse query parameters that the route does not have, or that are repeated.

    Raises
    ------
    BadInput
        With the parameter, and the parameters of the route.
    HTTPException
        405 if a word stands where an id is expected: `DELETE /runs/facets`.
    """
    word = any(str(value).replace("-", "").isalpha() for value in request.path_params.values())
    if word and request.url.path in request.app.openapi()["paths"]:
        raise HTTPException(HTTPStatus.METHOD_NOT_ALLOWED)
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


def _list_parameters(route: APIRoute) -> tuple[str, ...]:
    known = _known.get(route.endpoint)
    if known is None:
        found = get_flat_params(route.dependant)
        other = params.Path | params.Header
        known = tuple(each.alias for each in found if not isinstance(each.field_info, other))
        _known[route.endpoint] = known
    return known
