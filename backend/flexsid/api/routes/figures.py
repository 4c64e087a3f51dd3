"""Figures as Plotly specifications, and the glossary.

Of all routes, only figures, reports and the glossary are in display units; everything else is SI.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any

from fastapi import Query
from fastapi.responses import Response

from flexsid.api.context import TheContext, TheStore
from flexsid.api.models.responses import AxisNames, DisplayUnit, GlossaryEntry, extend_record
from flexsid.api.responses import FILES, Form, ThePrintFormat, TheUnits, respond_with_figure
from flexsid.api.router import make_router
from flexsid.api.serialization import JsonRoute
from flexsid.display_units import list_display_units, show_in
from flexsid.figure_table import FIGURES, FigureKind, draw_figure
from flexsid.figures.bode import draw_bode
from flexsid.figures.spec import empty, set_print_format
from flexsid.nomenclature import GLOSSARY, TERMS, explain
from flexsid.storage.lists.list_query import Page
from flexsid.sysid.model.derivatives import RIGID_BODIES
from flexsid.text import LARGEST_ID, split_names
from flexsid.workflow.live.live_estimator import build_live_bode

# --- Figures as Plotly specifications; colours and fonts are set by the frontend ------------------

figures_router = make_router("/figures", tag="figures", responses=FILES)


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
    figures_router.add_api_route(
        f"/{kind.name}",
        respond,
        name=f"draw_{kind.name.replace('-', '_')}",
        description=kind.description,
        response_model=Figure,
    )


@figures_router.get("/live-bode", response_model=Figure)
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


# --- The glossary ---------------------------------------------------------------------------------

nomenclature_router = make_router("/nomenclature", tag="nomenclature", route_class=JsonRoute)


@nomenclature_router.get("")
def list_nomenclature(
    units: TheUnits,
    names: Annotated[
        str | None,
        Query(
            max_length=4_000,
            description="Channels, derivatives, symbols or terms, by commas; all if omitted.",
        ),
    ] = None,
) -> Page[GlossaryEntry]:
    """List all quantities and terms with unit and meaning, or those of the given names."""
    requested = split_names(names)
    symbols = (*GLOSSARY, *TERMS) if requested is None else tuple(map(explain, requested))
    with show_in(units):
        return Page(items=[extend_record(GlossaryEntry, symbol) for symbol in symbols])


@nomenclature_router.get("/units")
def list_units(units: TheUnits) -> Page[DisplayUnit]:
    """List the SI units, and Hz, with their display unit: displayed = factor * SI value."""
    with show_in(units):
        shown = list_display_units()
    return Page(
        items=[
            DisplayUnit(unit=unit, display_unit=name, factor=factor)
            for unit, (name, factor) in shown.items()
        ]
    )


@nomenclature_router.get("/axes")
def list_axes() -> Page[AxisNames]:
    """List the axes of models, with the coefficients and motions that name derivatives."""
    return Page(items=[extend_record(AxisNames, body) for body in RIGID_BODIES.values()])
