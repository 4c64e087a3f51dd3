"""Figures as Plotly specifications; colours and fonts are set by the frontend.

Of all routes, only figures, reports and the glossary are in display units; everything else is SI.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any

from fastapi import Query
from fastapi.responses import Response

from flexsid.api.context import TheContext, TheStore
from flexsid.api.display import ThePrintFormat, TheUnits
from flexsid.api.export import FILES, Form, respond_with_figure
from flexsid.api.router import make_router
from flexsid.display_units import show_in
from flexsid.figure_table import FIGURES, FigureKind, draw_figure
from flexsid.figures.bode import draw_bode
from flexsid.figures.print_format import set_print_format
from flexsid.figures.spec import empty
from flexsid.text import LARGEST_ID
from flexsid.workflow.live.live_bode import build_live_bode

router = make_router("/figures", tag="figures", responses=FILES)


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


@router.get("/live-bode", response_model=Figure)
def draw_live_bode(
    context: TheContext,
    stream_id: Annotated[int, Query(ge=1, le=LARGEST_ID)],
    output: Annotated[str, Query(min_length=1, max_length=200)],
    input: Annotated[str, Query(min_length=1, max_length=200)],
    units: TheUnits,
    print_format: ThePrintFormat,
    form: Form = "json",
) -> Response:
    """Draw the frequency response of a running stream from the record so far.

    Markers with ±2 standard errors, at the frequencies that the record resolves, and the model of
    the latest estimate.
    """
    context.store.live_streams.get(stream_id)
    responses = context.streams.find_responses(stream_id)
    with show_in(units):
        if responses is None:
            spec = empty("No estimate yet: the first one needs a few seconds of a maneuver")
        else:
            spec = draw_bode(build_live_bode(responses, output, input))
    return respond_with_figure(set_print_format(spec, print_format), form)


for _kind in FIGURES.values():
    _add_route(_kind)
