"""Only what a route has: a mistyped parameter would be a filter that does not filter."""

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

DESCRIBED = (
    "A query parameter that a route does not have is refused with 422 and the code"
    " `unknown-parameter`, one that is given twice with `repeated-parameter`."
)

# A route cannot be a key; finding its parameters takes longer than many an answer.
_known: dict[Callable[..., Any], tuple[str, ...]] = {}


async def only_known(request: Request) -> None:
    """Refuse query parameters that the route does not read.

    Raises
    ------
    BadInput
        Naming the parameter, and those that the route has.
    HTTPException
        405 where a word was taken for an id: `DELETE /runs/facets` is no run that is deleted.
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
    known = _parameters(request.scope["route"])
    given = Counter(name for name, _value in request.query_params.multi_items())
    unknown = [name for name in given if name not in known]
    if unknown:
        takes = f"it takes {', '.join(known)}" if known else "it takes none"
        raise BadInput(
            f"{request.url.path} has no query parameter {', '.join(map(repr, unknown))}; {takes}",
            code="unknown-parameter",
            errors=[FieldError(field=name, message=f"unknown; {takes}") for name in unknown],
        )
    repeated = [name for name, times in given.items() if times > 1]
    if repeated:
        more = "given more than once; several values are separated by commas"
        raise BadInput(
            f"{', '.join(repeated)}: {more}",
            code="repeated-parameter",
            errors=[FieldError(field=name, message=more) for name in repeated],
        )


def _parameters(route: APIRoute) -> tuple[str, ...]:
    known = _known.get(route.endpoint)
    if known is None:
        found = get_flat_params(route.dependant)
        known = tuple(each.alias for each in found if isinstance(each.field_info, params.Query))
        _known[route.endpoint] = known
    return known
