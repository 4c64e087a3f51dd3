"""Figures as Plotly specifications; colours and fonts are set by the frontend.

Of all routes, only figures, reports and the glossary are in display units; everything else is SI.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any

from fastapi import APIRouter, Query
from fastapi.responses import Response

from flexsid.api.context import TheStore
from flexsid.api.display_units import TheUnits
from flexsid.api.export import FILES, Form, respond_with_figure
from flexsid.api.print_format import ThePrintFormat
from flexsid.display_units import show_in
from flexsid.figure_table import FIGURES, FigureKind, draw_figure
from flexsid.figures.print_format import set_print_format

router = APIRouter(prefix="/figures", tags=["figures"], responses=FILES)


@dataclass(frozen=True, slots=True, kw_only=True)
class Figure:
    """A Plotly figure; theme, fonts and height are set by the frontend."""

    data: list[dict[str, Any]]
    layout: dict[str, Any]


def _add_route(kind: FigureKind) -> None:
    def respond(
        store: TheStore,
        parameters: Any,
        units: TheUnits,
        print_format: ThePrintFormat,
        form: Form = "json",
    ) -> Response:
        with show_in(units):
            spec = draw_figure(store, kind.name, **dict(parameters))
        return respond_with_figure(set_print_format(spec, print_format), form)

    respond.__annotations__["parameters"] = Annotated[kind.parameters, Query()]
    router.add_api_route(
        f"/{kind.name}",
        respond,
        name=f"draw_{kind.name.replace('-', '_')}",
        description=kind.description,
        response_model=Figure,
    )


for _kind in FIGURES.values():
    _add_route(_kind)
