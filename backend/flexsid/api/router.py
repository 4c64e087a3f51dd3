"""Routers of the interface, whose routes all have its prefix, its errors and its authorization."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from fastapi import APIRouter, Depends
from fastapi.routing import APIRoute

from flexsid.api.authorization import authorize
from flexsid.api.errors import Problem
from flexsid.api.parameters import refuse_unknown_parameters
from flexsid.api.serialization import DescribedRoute

PREFIX = "/api/v1"
"""Begin of all addresses of the interface."""


def make_router(
    prefix: str = "",
    *,
    tag: str | None,
    route_class: type[DescribedRoute] = DescribedRoute,
    responses: Mapping[int | str, dict[str, Any]] | None = None,
) -> APIRouter:
    """Make the router of the routes below a prefix.

    Parameters
    ----------
    prefix
        Begin of their addresses, after that of the interface.
    tag
        Group of the documentation; None where each route states its own.
    route_class, responses
        As of FastAPI.
    """
    return APIRouter(
        prefix=f"{PREFIX}{prefix}",
        tags=[] if tag is None else [tag],
        route_class=route_class,
        responses={"4XX": {"model": Problem}, **(responses or {})},
        dependencies=[Depends(authorize), Depends(refuse_unknown_parameters)],
        generate_unique_id_function=make_operation_id,
    )


def make_operation_id(route: APIRoute) -> str:
    """Name the operation of a route as its function."""
    return route.name
