"""Figures as plotly specs: numbers from the workflow, drawn by figures, themed by the page."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated, Any

from fastapi import APIRouter, Query
from fastapi.responses import Response

from flexsid import figures
from flexsid.api.context import TheStore
from flexsid.api.export import FILES, Form, sent
from flexsid.api.routes.comparisons import TheTrend
from flexsid.api.routes.designs import Level
from flexsid.api.routes.flutter import TheQuestion
from flexsid.api.routes.maneuvers import Filters
from flexsid.api.wire import split_ids, split_names
from flexsid.records.flutter import Along
from flexsid.storage.repository import LARGEST_ID
from flexsid.workflow import (
    closed_loop,
    cutting,
    excitation,
    flutter,
    ground_tests,
    reconstruction,
    searching,
    views,
)
from flexsid.workflow.audit import figure_spec
from flexsid.workflow.foresight import expected_response

router = APIRouter(prefix="/figures", tags=["figures"], responses=FILES)

_Id = Annotated[int, Query(ge=1, le=LARGEST_ID)]
_Ids = Annotated[str | None, Query(description="Ids separated by commas.")]
_Names = Annotated[str | None, Query(description="Names separated by commas.")]
_Seconds = Annotated[float | None, Query(allow_inf_nan=False)]
_Block = Annotated[str | None, Query(description="Block of lines; the run's first by default.")]


@dataclass(frozen=True, slots=True, kw_only=True)
class Figure:
    """What plotly draws; colours of the page, fonts and height are left to the page."""

    data: list[dict[str, Any]]
    layout: dict[str, Any]


@router.get("/envelope", response_model=Figure)
def draw_envelope(store: TheStore, filters: Filters, form: Form = "json") -> Response:
    """Draw where the maneuvers of a list were flown."""
    return sent(figures.envelope(views.envelope(store, **filters)), form)


@router.get("/time-history", response_model=Figure)
def draw_time_history(
    store: TheStore,
    maneuver_id: _Id,
    channels: _Names = None,
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
    flight_id: _Id,
    channels: _Names = None,
    start_s: _Seconds = None,
    stop_s: _Seconds = None,
    points: Annotated[int, Query(ge=100, le=20_000)] = 2000,
    form: Form = "json",
) -> Response:
    """Draw channels of a whole flight against time; the commands by default."""
    chosen = split_names(channels) or ()
    value = cutting.flight_history(store, flight_id, chosen, start_s, stop_s, points)
    return sent(figures.time_history(value), form)


@router.get("/spectrum", response_model=Figure)
def draw_spectrum(
    store: TheStore,
    maneuver_id: _Id,
    channels: _Names = None,
    full: Annotated[bool, Query(description="The whole spectrum behind the lines.")] = False,
    form: Form = "json",
) -> Response:
    """Draw Fourier magnitudes at the excited lines, coloured by owner; inputs by default."""
    chosen = split_names(channels) or ()
    return sent(figures.spectrum(views.spectrum(store, maneuver_id, chosen, full=full)), form)


@router.get("/signal-to-noise", response_model=Figure)
def draw_signal_to_noise(
    store: TheStore, maneuver_id: _Id, channels: _Names = None, form: Form = "json"
) -> Response:
    """Draw signal over noise per channel and line; all inputs and outputs by default."""
    chosen = split_names(channels) or ()
    return sent(figures.signal_to_noise(views.signal_to_noise(store, maneuver_id, chosen)), form)


@router.get("/plot-matrix", response_model=Figure)
def draw_plot_matrix(
    store: TheStore,
    maneuver_id: _Id,
    channels: _Names = None,
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
    maneuver_id: _Id,
    output: Annotated[str, Query(description="Outputs separated by commas.")],
    inputs: _Names = None,
    run_id: _Ids = None,
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
    maneuver_id: _Id,
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


@router.get("/ground-test", response_model=Figure)
def draw_ground_test(store: TheStore, flight_id: _Id, form: Form = "json") -> Response:
    """Draw spectra on the runway before and after a flight."""
    return sent(figures.ground_test(ground_tests.ground_spectra(store, flight_id)), form)


@router.get("/fit", response_model=Figure)
def draw_fit(
    store: TheStore, run_id: _Id, output: _Names = None, block: _Block = None, form: Form = "json"
) -> Response:
    """Draw fitted over measured lines."""
    return sent(figures.fit(views.fit(store, run_id, split_names(output) or (), block)), form)


@router.get("/residual", response_model=Figure)
def draw_residual(
    store: TheStore, run_id: _Id, block: _Block = None, form: Form = "json"
) -> Response:
    """Draw what the model left over, per output and frequency."""
    return sent(figures.residual(views.residual(store, run_id, block)), form)


@router.get("/parameter-correlation", response_model=Figure)
def draw_parameter_correlation(store: TheStore, run_id: _Id, form: Form = "json") -> Response:
    """Draw how the estimates depend on each other."""
    return sent(figures.parameter_correlation(views.parameter_correlation(store, run_id)), form)


@router.get("/poles", response_model=Figure)
def draw_poles(
    store: TheStore,
    run_id: Annotated[str, Query(description="Ids of runs, separated by commas.")],
    form: Form = "json",
) -> Response:
    """Draw the poles of identified models beside those of the first one's modes in vacuo."""
    return sent(figures.poles(views.poles(store, split_ids(run_id, "run_id"))), form)


@router.get("/iterations", response_model=Figure)
def draw_iterations(store: TheStore, run_id: _Id, form: Form = "json") -> Response:
    """Draw how the cost fell."""
    return sent(figures.iterations(views.iterations(store, run_id)), form)


@router.get("/time-check", response_model=Figure)
def draw_time_check(
    store: TheStore,
    run_id: _Id,
    outputs: _Names = None,
    maneuver_id: Annotated[int | None, Query(ge=1, le=LARGEST_ID)] = None,
    points: Annotated[int, Query(ge=100, le=20_000)] = views.POINTS,
    form: Form = "json",
) -> Response:
    """Draw recorded outputs and what the identified model makes of the recorded inputs."""
    chosen = split_names(outputs) or ()
    return sent(
        figures.time_check(views.time_check(store, run_id, chosen, maneuver_id, points)), form
    )


@router.get("/derivatives", response_model=Figure)
def draw_derivatives(
    store: TheStore,
    run_ids: Annotated[str, Query(description="Ids separated by commas.")],
    prediction_ids: _Ids = None,
    coefficient: Annotated[str | None, Query(description="CZ, Cm, CQ7 ...")] = None,
    form: Form = "json",
) -> Response:
    """Draw derivatives by method and prediction with ±2 standard errors."""
    value = views.derivatives(
        store,
        split_ids(run_ids, "run_ids"),
        split_ids(prediction_ids, "prediction_ids"),
        coefficient,
    )
    return sent(figures.derivatives(value), form)


@router.get("/forest", response_model=Figure)
def draw_forest(
    store: TheStore,
    run_ids: Annotated[str, Query(description="Ids separated by commas.")],
    name: Annotated[str, Query(max_length=64, description="Derivative, e.g. Cm_alpha.")],
    prediction_ids: _Ids = None,
    form: Form = "json",
) -> Response:
    """Draw what each run and prediction says about one derivative, over their mean."""
    value = views.derivatives(
        store, split_ids(run_ids, "run_ids"), split_ids(prediction_ids, "prediction_ids")
    )
    return sent(figures.forest(value, name), form)


@router.get("/trend", response_model=Figure)
def draw_trend(store: TheStore, asked: TheTrend, form: Form = "json") -> Response:
    """Draw one derivative over the conditions that were flown, with weighted fits."""
    return sent(figures.trend(asked), form)


TheAxis = Annotated[Along, Query(description="What roots are followed along.")]


@router.get("/v-omega-zeta", response_model=Figure)
def draw_v_omega_zeta(
    store: TheStore, question: TheQuestion, along: TheAxis = Along.AIRSPEED, form: Form = "json"
) -> Response:
    """Draw frequency and damping of the identified roots with ±2 standard errors."""
    return sent(figures.v_omega_zeta(flutter.flutter_roots(store, question, along)), form)


@router.get("/root-locus", response_model=Figure)
def draw_root_locus(
    store: TheStore, question: TheQuestion, along: TheAxis = Along.AIRSPEED, form: Form = "json"
) -> Response:
    """Draw the identified roots in the s-plane."""
    return sent(figures.root_locus(flutter.flutter_roots(store, question, along)), form)


@router.get("/equivalent-modes", response_model=Figure)
def draw_equivalent_modes(store: TheStore, question: TheQuestion, form: Form = "json") -> Response:
    """Draw equivalent frequency and damping of every run over dynamic pressure (Eq. 25)."""
    return sent(figures.equivalent_modes(flutter.flutter(store, question)), form)


@router.get("/flutter-forecast", response_model=Figure)
def draw_flutter_forecast(store: TheStore, question: TheQuestion, form: Form = "json") -> Response:
    """Draw the flutter speed each run predicts, classical trackers beside it."""
    return sent(figures.flutter_forecast(flutter.flutter(store, question)), form)


@router.get("/flutter-map", response_model=Figure)
def draw_flutter_map(store: TheStore, question: TheQuestion, form: Form = "json") -> Response:
    """Draw the flutter speed over fuel and altitude."""
    return sent(figures.flutter_map(flutter.flutter_map(store, question)), form)


@router.get("/closed-loop-margins", response_model=Figure)
def draw_closed_loop_margins(
    store: TheStore, question: TheQuestion, controller_id: _Id, form: Form = "json"
) -> Response:
    """Draw margins of every surface's loop over airspeed."""
    value = closed_loop.closed_loop(store, question, controller_id)
    return sent(figures.closed_loop_margins(value), form)


@router.get("/closed-loop-roots", response_model=Figure)
def draw_closed_loop_roots(
    store: TheStore, question: TheQuestion, controller_id: _Id, form: Form = "json"
) -> Response:
    """Draw roots with and without a controller."""
    value = closed_loop.closed_loop(store, question, controller_id)
    return sent(figures.closed_loop_roots(value), form)


_Group = Annotated[str | None, Query(description="Coefficient (EE) or method; the first.")]


@router.get("/search-path", response_model=Figure)
def draw_search_path(
    store: TheStore, search_id: _Id, group: _Group = None, form: Form = "json"
) -> Response:
    """Draw the criteria after every step of a search for structure."""
    return sent(figures.search_path(searching.group_of(store, search_id, group)), form)


@router.get("/search-stability", response_model=Figure)
def draw_search_stability(
    store: TheStore, search_id: _Id, group: _Group = None, form: Form = "json"
) -> Response:
    """Draw how often each term is chosen when the lines are drawn anew."""
    return sent(figures.search_stability(searching.group_of(store, search_id, group)), form)


@router.get("/design-history", response_model=Figure)
def draw_design_history(
    store: TheStore, design_id: _Id, level: Level = 0, form: Form = "json"
) -> Response:
    """Draw one period of a designed excitation."""
    value = excitation.designed(store.designs.get(design_id), level)
    return sent(figures.design_history(value), form)


@router.get("/design-spectrum", response_model=Figure)
def draw_design_spectrum(
    store: TheStore, design_id: _Id, level: Level = 0, form: Form = "json"
) -> Response:
    """Draw the lines of a designed excitation by the input that owns them."""
    value = excitation.designed(store.designs.get(design_id), level)
    return sent(figures.design_spectrum(value), form)


@router.get("/design-worth", response_model=Figure)
def draw_design_worth(
    store: TheStore, design_id: _Id, run_id: _Id, level: Level = 0, form: Form = "json"
) -> Response:
    """Draw what each line of a design is worth for the parameters of a run."""
    design = store.designs.get(design_id)
    return sent(figures.design_worth(expected_response(store, design, run_id, level)), form)


@router.get("/design-signal", response_model=Figure)
def draw_design_signal(
    store: TheStore, design_id: _Id, run_id: _Id, level: Level = 0, form: Form = "json"
) -> Response:
    """Draw each output's expected signal over noise at each line of a design."""
    design = store.designs.get(design_id)
    return sent(figures.design_signal(expected_response(store, design, run_id, level)), form)


@router.get("/loops", response_model=Figure)
def draw_loops(store: TheStore, maneuver_id: _Id, form: Form = "json") -> Response:
    """Draw each surface's loop as flown, with its margins."""
    return sent(figures.loops(views.loops(store, maneuver_id)), form)


@router.get("/frozen", response_model=Figure)
def draw_frozen(store: TheStore, figure_id: _Id, form: Form = "json") -> Response:
    """Draw a figure as it was when it was frozen for a decision."""
    return sent(figure_spec(store, store.frozen_figures.get(figure_id)), form)
