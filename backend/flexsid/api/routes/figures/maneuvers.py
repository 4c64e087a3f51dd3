"""Figures of recorded data: maneuvers, whole flights and ground tests."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

from fastapi import APIRouter, Query
from fastapi.responses import Response

from flexsid import figures
from flexsid.api.context import TheStore
from flexsid.api.export import Form, respond_with_figure
from flexsid.api.routes.figures.figure import Figure, Id, Ids, Names
from flexsid.api.routes.maneuvers import Filters
from flexsid.api.serialization import split_ids, split_names
from flexsid.workflow import views
from flexsid.workflow.importing import maneuver_cutting
from flexsid.workflow.measurements import reconstruction
from flexsid.workflow.quality import ground_records

router = APIRouter()
_Seconds = Annotated[float | None, Query(allow_inf_nan=False)]


@router.get("/envelope", response_model=Figure)
def draw_envelope(store: TheStore, filters: Filters, form: Form = "json") -> Response:
    """Draw the flight conditions of the filtered maneuvers."""
    return respond_with_figure(figures.envelope(views.envelope(store, **filters)), form)


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
    """Draw channels over time, decimated for the screen; by default the inputs.

    CSV and MAT files contain every sample of the window.
    """
    selected = split_names(channels) or ()
    value = views.time_history(store, maneuver_id, selected, start_s, stop_s, points)
    if form != "json":
        longest = max((trace.time_s.size for trace in value.traces), default=points)
        value = replace(value, points=longest)
    return respond_with_figure(figures.time_history(value), form)


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
    """Draw channels of a whole flight over time; by default the commands."""
    selected = split_names(channels) or ()
    value = maneuver_cutting.read_flight_history(
        store, flight_id, selected, start_s, stop_s, points
    )
    return respond_with_figure(figures.time_history(value), form)


@router.get("/spectrum", response_model=Figure)
def draw_spectrum(
    store: TheStore,
    maneuver_id: Id,
    channels: Names = None,
    full: Annotated[bool, Query(description="With the full spectrum.")] = False,
    form: Form = "json",
) -> Response:
    """Draw Fourier magnitudes at the harmonics, coloured by input; by default of the inputs."""
    selected = split_names(channels) or ()
    return respond_with_figure(
        figures.spectrum(views.spectrum(store, maneuver_id, selected, full=full)), form
    )


@router.get("/signal-to-noise", response_model=Figure)
def draw_signal_to_noise(
    store: TheStore, maneuver_id: Id, channels: Names = None, form: Form = "json"
) -> Response:
    """Draw the signal-to-noise ratio by channel and harmonic; by default of inputs and outputs."""
    selected = split_names(channels) or ()
    return respond_with_figure(
        figures.signal_to_noise(views.signal_to_noise(store, maneuver_id, selected)), form
    )


@router.get("/plot-matrix", response_model=Figure)
def draw_plot_matrix(
    store: TheStore,
    maneuver_id: Id,
    channels: Names = None,
    domain: views.Domain = "time",
    modes: Annotated[
        str | None, Query(description="Mode numbers: draws the equation-error regressors instead.")
    ] = None,
    form: Form = "json",
) -> Response:
    """Draw a scatter plot matrix of channels with their correlation; by default of the inputs."""
    selected = split_names(channels) or ()
    value = views.plot_matrix(store, maneuver_id, selected, domain, split_ids(modes, "modes"))
    return respond_with_figure(figures.plot_matrix(value), form)


@router.get("/bode", response_model=Figure)
def draw_bode(
    store: TheStore,
    maneuver_id: Id,
    output: Annotated[str, Query(description="Outputs separated by commas.")],
    inputs: Names = None,
    run_id: Ids = None,
    overlay: Annotated[str | None, Query(description="Ids of maneuvers to overlay.")] = None,
    average: Annotated[
        bool, Query(description="Average the frequency response over all maneuvers.")
    ] = False,
    rigid: Annotated[
        bool, Query(description="Also models without modes in the sensor equations.")
    ] = False,
    windowed: Annotated[
        bool, Query(description="From averaged windows, as if no harmonics were known.")
    ] = False,
    view: figures.View = "bode",
    form: Form = "json",
) -> Response:
    """Draw measured frequency responses and those of identified models."""
    value = views.bode(
        store,
        maneuver_id,
        split_names(output) or (),
        split_names(inputs) or (),
        split_ids(run_id, "run_id"),
        split_ids(overlay, "overlay"),
        average=average,
        rigid=rigid,
        windowed=windowed,
    )
    return respond_with_figure(figures.bode(value, view), form)


@router.get("/reconstruction", response_model=Figure)
def draw_reconstruction(
    store: TheStore,
    maneuver_id: Id,
    quantities: Annotated[
        str | None,
        Query(description="alpha, q, CZ, Cm, CQ7, eta7, etaddot7 ..., separated by commas."),
    ] = None,
    modes: Annotated[
        str | None, Query(description="Mode numbers; by default those that are excited.")
    ] = None,
    domain: views.Domain = "time",
    form: Form = "json",
) -> Response:
    """Draw reconstructed motion and coefficients with ±2 standard errors.

    In the time domain by the smoother (Fig. 16a), in the frequency domain by least squares at each
    harmonic, with rank and condition number.
    """
    value = reconstruction.reconstruct(
        store, maneuver_id, split_names(quantities) or (), split_ids(modes, "modes")
    )
    draw = figures.reconstruction if domain == "time" else figures.reconstruction_lines
    return respond_with_figure(draw(value), form)


@router.get("/loops", response_model=Figure)
def draw_loops(store: TheStore, maneuver_id: Id, form: Form = "json") -> Response:
    """Draw the measured loop gain of each surface, with its stability margins."""
    return respond_with_figure(figures.loops(views.loops(store, maneuver_id)), form)


@router.get("/ground-test", response_model=Figure)
def draw_ground_test(store: TheStore, flight_id: Id, form: Form = "json") -> Response:
    """Draw mini-GVT spectra before and after a flight."""
    return respond_with_figure(
        figures.ground_test(ground_records.read_ground_spectra(store, flight_id)), form
    )
