"""Figures of what was recorded: maneuvers, whole flights, the ground before and after."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

from fastapi import APIRouter, Query
from fastapi.responses import Response

from flexsid import figures
from flexsid.api.context import TheStore
from flexsid.api.export import Form, sent
from flexsid.api.routes.figures.answer import Figure, Id, Ids, Names
from flexsid.api.routes.maneuvers import Filters
from flexsid.api.wire import split_ids, split_names
from flexsid.workflow import views
from flexsid.workflow.importing import maneuver_cutting
from flexsid.workflow.measurements import reconstruction
from flexsid.workflow.quality import ground_records

router = APIRouter()
_Seconds = Annotated[float | None, Query(allow_inf_nan=False)]


@router.get("/envelope", response_model=Figure)
def draw_envelope(store: TheStore, filters: Filters, form: Form = "json") -> Response:
    """Draw where the maneuvers of a list were flown."""
    return sent(figures.envelope(views.envelope(store, **filters)), form)


@router.get("/time-history", response_model=Figure)
def draw_time_history(
    store: TheStore,
    maneuver_id: Id,
    channels: Names = None,
    start_s: _Seconds = None,
    stop_s: _Seconds = None,
    points: int = views.POINTS,
    form: Form = "json",
) -> Response:
    """Draw channels against time, thinned to what a screen shows; inputs by default.

    Files hold every sample of the window.
    """
    chosen = split_names(channels) or ()
    value = views.time_history(store, maneuver_id, chosen, start_s, stop_s, points)
    if form != "json":
        longest = max((trace.time_s.size for trace in value.traces), default=points)
        value = replace(value, points=longest)
    return sent(figures.time_history(value), form)


@router.get("/flight-history", response_model=Figure)
def draw_flight_history(
    store: TheStore,
    flight_id: Id,
    channels: Names = None,
    start_s: _Seconds = None,
    stop_s: _Seconds = None,
    points: Annotated[int, Query(ge=100, le=20_000)] = 2000,
    form: Form = "json",
) -> Response:
    """Draw channels of a whole flight against time; the commands by default."""
    chosen = split_names(channels) or ()
    value = maneuver_cutting.flight_history(store, flight_id, chosen, start_s, stop_s, points)
    return sent(figures.time_history(value), form)


@router.get("/spectrum", response_model=Figure)
def draw_spectrum(
    store: TheStore,
    maneuver_id: Id,
    channels: Names = None,
    full: Annotated[bool, Query(description="The whole spectrum behind the lines.")] = False,
    form: Form = "json",
) -> Response:
    """Draw Fourier magnitudes at the excited lines, coloured by owner; inputs by default."""
    chosen = split_names(channels) or ()
    return sent(figures.spectrum(views.spectrum(store, maneuver_id, chosen, full=full)), form)


@router.get("/signal-to-noise", response_model=Figure)
def draw_signal_to_noise(
    store: TheStore, maneuver_id: Id, channels: Names = None, form: Form = "json"
) -> Response:
    """Draw signal over noise per channel and line; all inputs and outputs by default."""
    chosen = split_names(channels) or ()
    return sent(figures.signal_to_noise(views.signal_to_noise(store, maneuver_id, chosen)), form)


@router.get("/plot-matrix", response_model=Figure)
def draw_plot_matrix(
    store: TheStore,
    maneuver_id: Id,
    channels: Names = None,
    domain: views.Domain = "time",
    modes: Annotated[
        str | None, Query(description="Regressors of equation error with these modes instead.")
    ] = None,
    form: Form = "json",
) -> Response:
    """Draw channels against each other with their correlation; inputs by default."""
    chosen = split_names(channels) or ()
    value = views.plot_matrix(store, maneuver_id, chosen, domain, split_ids(modes, "modes"))
    return sent(figures.plot_matrix(value), form)


@router.get("/bode", response_model=Figure)
def draw_bode(
    store: TheStore,
    maneuver_id: Id,
    output: Annotated[str, Query(description="Outputs separated by commas.")],
    inputs: Names = None,
    run_id: Ids = None,
    beside: Annotated[
        str | None, Query(description="Ids of further maneuvers, laid over this one.")
    ] = None,
    average: Annotated[bool, Query(description="All maneuvers as one response.")] = False,
    rigid: Annotated[bool, Query(description="Models also with sensors blind to modes.")] = False,
    windowed: Annotated[
        bool, Query(description="From averaged windows, as where no lines are known.")
    ] = False,
    view: figures.View = "bode",
    form: Form = "json",
) -> Response:
    """Draw frequency responses, with the models of runs over them."""
    value = views.bode(
        store,
        maneuver_id,
        split_names(output) or (),
        split_names(inputs) or (),
        split_ids(run_id, "run_id"),
        split_ids(beside, "beside"),
        average=average,
        rigid=rigid,
        windowed=windowed,
    )
    return sent(figures.bode(value, view), form)


@router.get("/reconstruction", response_model=Figure)
def draw_reconstruction(
    store: TheStore,
    maneuver_id: Id,
    quantities: Annotated[
        str | None, Query(description="alpha, q, CZ, Cm, CQ7, eta7, etaddot7 ... by commas.")
    ] = None,
    modes: Annotated[
        str | None, Query(description="Mode numbers; by default as many as move.")
    ] = None,
    domain: views.Domain = "time",
    form: Form = "json",
) -> Response:
    """Draw motion and coefficients that all sensors together tell, with ±2 standard errors.

    In time from the smoother (Fig. 16a), in frequency line by line with rank and condition.
    """
    value = reconstruction.reconstruct(
        store, maneuver_id, split_names(quantities) or (), split_ids(modes, "modes")
    )
    drawn = figures.reconstruction if domain == "time" else figures.reconstruction_lines
    return sent(drawn(value), form)


@router.get("/loops", response_model=Figure)
def draw_loops(store: TheStore, maneuver_id: Id, form: Form = "json") -> Response:
    """Draw each surface's loop as flown, with its margins."""
    return sent(figures.loops(views.loops(store, maneuver_id)), form)


@router.get("/ground-test", response_model=Figure)
def draw_ground_test(store: TheStore, flight_id: Id, form: Form = "json") -> Response:
    """Draw spectra on the runway before and after a flight."""
    return sent(figures.ground_test(ground_records.ground_spectra(store, flight_id)), form)
