"""The table of figures: the parameters of each, the numbers they select, and the drawing."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import isfinite, nan
from typing import Annotated, Any, get_type_hints

from pydantic import AfterValidator, Field, ValidationInfo, create_model

from flexsid.errors import BadInput
from flexsid.figures.bode import AxisScale, MagnitudeScale, View, draw_bode, draw_fit
from flexsid.figures.closed_loop import (
    draw_closed_loop_margins,
    draw_closed_loop_roots,
    draw_control_loop,
    draw_loops,
)
from flexsid.figures.condition_sheet import draw_adequacy, draw_condition_derivatives
from flexsid.figures.derivatives import draw_derivatives, draw_forest, draw_trend
from flexsid.figures.estimates import (
    draw_cross_predictions,
    draw_iterations,
    draw_parameter_correlation,
    draw_plot_matrix,
    draw_residual,
    draw_residual_correlation,
    draw_search_path,
    draw_search_stability,
)
from flexsid.figures.excitation import (
    draw_design_history,
    draw_design_information,
    draw_design_signal,
    draw_design_spectrum,
    draw_signal_to_noise,
    draw_spectrum,
)
from flexsid.figures.flutter import (
    draw_equivalent_modes,
    draw_flutter_forecast,
    draw_flutter_map,
    draw_flutter_summary,
)
from flexsid.figures.global_model import (
    draw_coverage,
    draw_derivative_coverage,
    draw_envelope,
    draw_slice,
)
from flexsid.figures.grey_box import draw_grey_box
from flexsid.figures.modal_data import (
    draw_assurance,
    draw_ground_test,
    draw_measured_response,
    draw_model_order,
    draw_modes_against_fuel,
    draw_output_only,
    draw_reduced_responses,
    draw_stabilisation,
)
from flexsid.figures.mode_shapes import draw_lattice
from flexsid.figures.roots import draw_poles, draw_root_locus, draw_v_omega_zeta
from flexsid.figures.spec import Spec
from flexsid.figures.time_histories import (
    Arrangement,
    draw_live_history,
    draw_reconstruction,
    draw_surface_histories,
    draw_time_check,
    draw_time_comparison,
    draw_time_history,
)
from flexsid.jobs.kind import get_result
from flexsid.jobs.kinds import (
    CLOSED_LOOP,
    CROSS_PREDICTION,
    CROSS_VALIDATION,
    FLUTTER,
    GLOBAL_MODEL,
    MODES,
    OUTPUT_ONLY_MODES,
    PREDICTED_ACCURACY,
    PREDICTED_FLUTTER,
    RECONSTRUCTION,
    TRANSFER_FUNCTION,
    read_condition_sheet,
    read_grey_box,
)
from flexsid.records.decision import LimitedQuantity
from flexsid.records.excitation import DEFAULT_LEVEL
from flexsid.records.flutter import (
    Along,
    ClosedLoop,
    Flutter,
    FlutterMap,
    FlutterRoots,
    SummaryDiagram,
)
from flexsid.records.global_model import DerivativeSlice, EnvelopeCoverage
from flexsid.records.modal_data import ModelOrder, ReducedResponses, Stabilisation
from flexsid.records.validation import Against, CrossPredictionMatrix
from flexsid.records.views import (
    Bode,
    DesignedExcitation,
    ExpectedResponse,
    FitPlot,
    LatticeQuantity,
    OutputOnlyResult,
    Reconstruction,
    Residuals,
)
from flexsid.request_models import QueryParameters, derive_parameters, parameters_of
from flexsid.storage.lists.maneuver_list import ManeuverFilters
from flexsid.storage.repository import reading_once
from flexsid.storage.store import Store
from flexsid.sysid.model.derivatives import ModelAxis
from flexsid.text import LARGEST_ID, split_ids, split_names
from flexsid.workflow.comparison.trends import fit_derivative_trend
from flexsid.workflow.excitation.excitation_designs import sample_design
from flexsid.workflow.excitation.predicted_accuracy import DesignQuery
from flexsid.workflow.flutter.closed_loop import ClosedLoopQuery
from flexsid.workflow.flutter.controllers import describe_loop
from flexsid.workflow.flutter.flutter_models import FlutterQuery
from flexsid.workflow.flutter.flutter_summary import (
    SummaryQuery,
    query_beside_summary,
    read_summary_roots,
)
from flexsid.workflow.flutter.predicted_flutter import PredictedFlutterQuery, query_beside_flight
from flexsid.workflow.global_model.estimates import GlobalModelQuery
from flexsid.workflow.global_model.versions import compute_coverage, slice_derivative
from flexsid.workflow.importing.maneuver_cutting import read_flight_history
from flexsid.workflow.live.live_estimator import read_live_history
from flexsid.workflow.measurements.output_only_modes import OutputOnlyQuery
from flexsid.workflow.measurements.reconstruction import ReconstructionQuery, select_quantities
from flexsid.workflow.measurements.transfer_functions import TransferFunctionQuery
from flexsid.workflow.modal_data.ground_vibration_test import ModeSearch, read_function
from flexsid.workflow.quality.ground_records import read_ground_spectra
from flexsid.workflow.review.audit import read_figure
from flexsid.workflow.structure_determination.searches import get_group
from flexsid.workflow.validation.cross_prediction import (
    CrossPredictionQuery,
    compute_held_out_residuals,
    compute_prediction_residuals,
    correlate_residuals,
    read_held_out_fit,
    read_prediction,
)
from flexsid.workflow.validation.cross_validation import CrossValidationQuery
from flexsid.workflow.views.bode import compute_bode, estimate_loops
from flexsid.workflow.views.dashboard import read_derivative_coverage
from flexsid.workflow.views.maneuver import (
    POINTS,
    compute_spectrum,
    estimate_signal_to_noise,
    read_envelope,
    read_time_history,
)
from flexsid.workflow.views.modal_assurance import compute_assurance
from flexsid.workflow.views.model_order import (
    OrderQuery,
    compute_reduced_responses,
    study_model_order,
)
from flexsid.workflow.views.modes import trace_modes, view_lattice
from flexsid.workflow.views.run import (
    Domain,
    compare_derivatives,
    compute_parameter_correlation,
    compute_plot_matrix,
    compute_residuals,
    read_adequacy,
    read_fit,
    read_iterations,
    read_poles,
)
from flexsid.workflow.views.time_comparison import (
    check_in_time,
    compare_in_time,
    read_surface_histories,
)

_MOST_COUNTS = 10


def _read_ids(text: str | None, info: ValidationInfo) -> tuple[int, ...]:
    return split_ids(text, info.field_name or "ids")


def _read_names(text: str | None) -> tuple[str, ...]:
    return split_names(text) or ()


def _read_counts(text: str) -> tuple[int, ...]:
    counts = [int(part) for part in _read_names(text) if part.isascii() and part.isdigit()]
    return tuple(counts[:_MOST_COUNTS])


def _read_condition(text: str | None) -> tuple[float, ...]:
    found = _read_names(text)
    try:
        numbers = tuple(map(float, found))
    except ValueError:
        numbers = (nan,)
    if not all(map(isfinite, numbers)):
        raise BadInput(
            f"condition: '{text}'; expected numbers in SI, separated by commas",
            code="bad-condition",
        )
    return numbers


_NAMES = AfterValidator(_read_names)
_IDS = AfterValidator(_read_ids)
_RUN_ID = AfterValidator(lambda text: split_ids(text, "run_id"))

_Id = Annotated[int, Field(ge=1, le=LARGEST_ID)]
_Reference = Annotated[int | None, Field(ge=1, le=LARGEST_ID)]
_Ids = Annotated[str | None, _IDS, Field(description="Ids separated by commas.")]
_RunIds = Annotated[str, _IDS, Field(description="Ids separated by commas.")]
_Names = Annotated[str | None, _NAMES, Field(description="Names separated by commas.")]
_Derivative = Annotated[str, Field(max_length=64, description="Derivative, e.g. Cm_alpha.")]
_Fuel = Annotated[float, Field(ge=0.0, le=1.0, description="Fuel fraction.")]
_Number = Annotated[float | None, Field(allow_inf_nan=False)]
_Points = Annotated[int, Field(ge=100, le=20_000)]
_Text = str | None


class TrendParameters(QueryParameters):
    """One derivative of runs and predictions, and the flight condition of its trend."""

    run_ids: _RunIds = Field(description="Ids of runs, separated by commas.")
    name: _Derivative
    against: Against = Against.DYNAMIC_PRESSURE
    prediction_ids: _Ids = Field(None, description="Ids of predictions, separated by commas.")
    degree: int = Field(1, ge=0, le=3, description="Degree of the weighted polynomial.")


_FILTERS: dict[str, Any] = {
    name: (hint, None)
    for name, hint in get_type_hints(ManeuverFilters, include_extras=True).items()
}
_Filters: type[QueryParameters] = create_model("_Filters", __base__=QueryParameters, **_FILTERS)


class _CoverageParameters(QueryParameters):
    aircraft_id: _Id
    coefficient: _Text = Field(
        None, max_length=64, description="CZ, Cm, CQ7 ...; by default all coefficients."
    )


class _Maneuver(QueryParameters):
    maneuver_id: _Id


class _Channels(_Maneuver):
    channels: _Names = None


class _TimeHistory(_Channels):
    start_s: _Number = None
    stop_s: _Number = None
    points: int = POINTS


class _Flight(QueryParameters):
    flight_id: _Id


class _FlightHistory(_Flight):
    names: _Names = Field(None, alias="channels")
    start_s: _Number = None
    stop_s: _Number = None
    points: _Points = 2000


class _SurfaceHistories(_Maneuver):
    start_s: _Number = None
    stop_s: _Number = None
    points: _Points = 1000


class _Spectrum(_Channels):
    full: bool = Field(False, description="With the full spectrum.")


class _PlotMatrix(_Channels):
    domain: Domain = "time"
    modes: _Ids = Field(
        None, description="Mode numbers: draws the equation-error regressors of the default run."
    )


class _Bode(_Maneuver):
    outputs: Annotated[str, _NAMES] = Field(
        alias="output", description="Outputs separated by commas."
    )
    inputs: _Names = None
    run_ids: Annotated[_Text, _RUN_ID] = Field(
        None, alias="run_id", description="Ids separated by commas."
    )
    overlay: _Ids = Field(None, description="Ids of maneuvers to overlay.")
    average: bool = Field(False, description="Average the frequency response over all maneuvers.")
    rigid: bool = Field(False, description="Also models without modes in the sensor equations.")
    windowed: bool = Field(
        False, description="From averaged windows, as if no harmonics were known."
    )
    selected: _Text = Field(
        None,
        max_length=64,
        description="Parameter of the runs: also the frequencies on which its estimates rest.",
    )
    view: View = "bode"
    frequency_scale: AxisScale = Field("log", description="Scale of the frequencies.")
    magnitude_scale: MagnitudeScale = Field("dB", description="Scale of the magnitudes.")


class _Reconstruction(_Maneuver):
    names: _Names = Field(
        None,
        alias="quantities",
        description="alpha, q, CZ, Cm, CQ7, eta7, etaddot7 ..., separated by commas.",
    )
    modes: _Ids = Field(None, description="Mode numbers; by default those that are excited.")
    axis: ModelAxis | None = Field(
        None, description="Half of a combined maneuver; by default the longitudinal one."
    )
    domain: Domain = "time"


@parameters_of(OutputOnlyQuery)
class _OutputOnly(QueryParameters):
    pass


class _GreyBox(QueryParameters):
    job_id: Annotated[_Id, Field(description="Id of the job that computed the fit.")]


@parameters_of(TransferFunctionQuery)
class _TransferFunction(QueryParameters):
    view: View = "bode"


class _Run(QueryParameters):
    run_id: _Id


class _RunWithSelection(_Run):
    selected: _Text = Field(None, max_length=64, description="Derivative or sensor to emphasise.")


class _Correlation(_RunWithSelection):
    grouped: bool = Field(False, description="The lower triangle, with a tick per coefficient.")


class _ConditionDerivatives(QueryParameters):
    condition_id: _Id
    truth: bool = Field(False, description="With the true values of a simulated aircraft.")
    figure_id: _Id | None = Field(None, description="Sheet that was frozen with a decision.")
    selected: _Text = Field(None, max_length=64, description="Derivative to emphasise.")


class _Block(_Run):
    block: _Text = Field(None, description="Set of data points; by default the first of the run.")


class _FitParameters(_Block):
    outputs: _Names = Field(None, alias="output")


class _Poles(QueryParameters):
    run_ids: Annotated[str, _RUN_ID] = Field(
        alias="run_id", description="Ids of runs, separated by commas."
    )


class _TimeCheck(_Run):
    outputs: _Names = None
    maneuver_id: _Reference = None
    points: _Points = POINTS


class _TimeComparison(QueryParameters):
    run_ids: _RunIds = Field(description="Ids of succeeded runs, separated by commas.")
    output: _Text = Field(None, max_length=64, description="By default the first of the first run.")
    maneuver_ids: _Ids = Field(
        None,
        description="Maneuvers under whose inputs every run is simulated, separated by commas; by "
        "default each run under those of its own.",
    )
    points: _Points = POINTS
    arrangement: Arrangement = "rows"


class _PredictedResiduals(_Run):
    maneuver_id: _Reference = Field(None, description="By default that of the run.")


class _PredictedOutputs(_PredictedResiduals):
    outputs: _Names = None


@parameters_of(CrossValidationQuery)
class _HeldOutResiduals(QueryParameters):
    maneuver_id: _Reference = Field(None, description="Of a joint run; by default the first.")


class _HeldOutFit(_HeldOutResiduals):
    outputs: _Names = None


class _Compared(QueryParameters):
    run_ids: _RunIds
    prediction_ids: _Ids = None


class _Derivatives(_Compared):
    coefficient: _Text = Field(
        None, description="CZ, Cm, CQ7 ..., or `first`: that of the first derivative."
    )


class _Forest(_Compared):
    name: _Derivative


@parameters_of(FlutterQuery)
class _RootsParameters(QueryParameters):
    along: Along = Field(Along.AIRSPEED, description="Variable over which the roots are tracked.")
    prediction_id: _Reference = Field(
        None, description="Prediction whose flutter analysis at this loading is drawn beside."
    )


class _ControlLoop(QueryParameters):
    controller_id: _Id
    design_id: _Reference = Field(None, description="Design whose excitation is shown.")


@parameters_of(GlobalModelQuery)
class _GlobalSlice(QueryParameters):
    name: _Derivative
    along: LimitedQuantity | None = Field(
        None, description="Variable of the abscissa; by default the first."
    )
    condition: Annotated[_Text, AfterValidator(_read_condition)] = Field(
        None,
        description="Value of every variable in SI, separated by commas, where the others are "
        "held; by default the mean of the runs.",
    )


class _Search(QueryParameters):
    search_id: _Id
    name: _Text = Field(
        None, alias="group", description="Coefficient (EE) or method; by default the first."
    )


class _Design(QueryParameters):
    design_id: _Id
    level: int = Field(DEFAULT_LEVEL, ge=0, le=2, description="Amplitude: 0 low, 1 medium, 2 high.")


class _DesignForRun(_Design):
    run_id: _Id


class _Frozen(QueryParameters):
    figure_id: _Id


class _StreamParameters(QueryParameters):
    stream_id: _Id


@parameters_of(SummaryQuery)
class _SummaryFigure(QueryParameters):
    prediction_id: _Reference = Field(
        None,
        description="Prediction whose stored flutter analysis at the same air density, airspeeds "
        "and fuel is drawn beside.",
    )


class _Lattice(QueryParameters):
    prediction_id: _Id
    quantity: LatticeQuantity = LatticeQuantity.LAYOUT
    column: str | None = Field(
        None,
        max_length=64,
        description="Variable of a pressure, such as alpha, eta7 or wf1s, or number of a mode; "
        "the first by default.",
    )


class _ModalTable(QueryParameters):
    modal_table_id: _Id


class _Mac(_ModalTable):
    fuel: _Fuel = 0.5
    other_id: _Reference = None
    other_fuel: float | None = Field(None, ge=0.0, le=1.0)


@parameters_of(OrderQuery)
class _ModelOrder(QueryParameters):
    derivatives: Annotated[str, _NAMES] = Field(
        "CZ_alpha,Cm_alpha,CZ_q,Cm_q",
        max_length=2000,
        description="Derivatives to draw, separated by commas.",
    )


@parameters_of(OrderQuery)
class _ReducedResponses(QueryParameters):
    output: str = Field(max_length=64)
    surface: str = Field(max_length=64)
    counts: Annotated[str, AfterValidator(_read_counts)] = Field(
        "0,1,2,3,4", description="Numbers of retained modes, separated by commas."
    )


class _MeasuredResponse(QueryParameters):
    responses_id: _Id
    response_dof: str = Field(max_length=20, description="Degree of freedom, such as 12+z.")
    reference_dof: str = Field(max_length=20, description="Degree of freedom, such as 61+z.")


_GlobalModel = derive_parameters(GlobalModelQuery)
_ClosedLoop = derive_parameters(ClosedLoopQuery)
_Flutter = derive_parameters(FlutterQuery)
_PredictedFlutter = derive_parameters(PredictedFlutterQuery)
_CrossPrediction = derive_parameters(CrossPredictionQuery)
_ModeSearch = derive_parameters(ModeSearch)


@dataclass(frozen=True, slots=True)
class FigureKind:
    """A figure: its parameters, the numbers they select, and how these are drawn.

    ``numbers`` is called with the store and the parameters by name, ``draw`` with the numbers
    and those parameters that are named in ``drawing``.
    """

    name: str
    parameters: type[QueryParameters]
    numbers: Callable[..., Any]
    draw: Callable[..., Spec]
    description: str
    drawing: tuple[str, ...] = ()


def draw_figure(store: Store, figure: str, /, **arguments: Any) -> Spec:
    """Return a figure of the table as a Plotly specification.

    QueryParameters
    ----------
    store
        Database.
    figure
        Its name in ``FIGURES``.
    **arguments
        Its parameters, with lists as tuples.
    """
    kind = FIGURES[figure]
    drawing = {key: arguments.pop(key) for key in kind.drawing if key in arguments}
    with reading_once():
        return kind.draw(kind.numbers(store, **arguments), **drawing)


def _get_flutter(store: Store, **query: Any) -> Flutter:
    return get_result(store, FLUTTER, FlutterQuery(**query)).flutter


def _get_flutter_map(store: Store, **query: Any) -> FlutterMap:
    return get_result(store, FLUTTER, FlutterQuery(**query)).map


def _get_roots(
    store: Store, along: Along = Along.AIRSPEED, prediction_id: int | None = None, **query: Any
) -> FlutterRoots:
    result = get_result(store, FLUTTER, FlutterQuery(**query))
    roots = result.roots[along]
    if prediction_id is None or along is Along.FUEL:
        return roots
    request = query_beside_flight(prediction_id, result.flutter)
    predicted = get_result(store, PREDICTED_FLUTTER, request)
    return replace(roots, predicted=predicted.roots.branches)


def _get_predicted_roots(store: Store, **query: Any) -> FlutterRoots:
    return get_result(store, PREDICTED_FLUTTER, PredictedFlutterQuery(**query)).roots


def _get_summary_diagram(
    store: Store, prediction_id: int | None = None, **query: Any
) -> SummaryDiagram:
    request = SummaryQuery(**query)
    roots = read_summary_roots(store, request)
    if prediction_id is None:
        return SummaryDiagram(roots=roots, predicted=None)
    if roots.compared is None:
        raise BadInput(
            f"analysis '{roots.analysis.title}' has no single air density at which a prediction "
            "can be compared",
            code="no-density",
        )
    beside = query_beside_summary(prediction_id, request.fuel, roots.compared)
    return SummaryDiagram(roots=roots, predicted=get_result(store, PREDICTED_FLUTTER, beside).roots)


def _get_closed_loop(store: Store, controller_id: int, **query: Any) -> ClosedLoop:
    request = ClosedLoopQuery(flutter=FlutterQuery(**query), controller_id=controller_id)
    return get_result(store, CLOSED_LOOP, request)


def _slice_global_model(
    store: Store,
    name: str,
    along: LimitedQuantity | None,
    condition: tuple[float, ...],
    **query: Any,
) -> DerivativeSlice:
    found = get_result(store, GLOBAL_MODEL, GlobalModelQuery(**query))
    return slice_derivative(found, name, along, condition)


def _compute_coverage(store: Store, **query: Any) -> EnvelopeCoverage:
    return compute_coverage(get_result(store, GLOBAL_MODEL, GlobalModelQuery(**query)))


def _get_cross_predictions(store: Store, **query: Any) -> CrossPredictionMatrix:
    return get_result(store, CROSS_PREDICTION, CrossPredictionQuery(**query))


def _read_held_out_fit(
    store: Store, outputs: tuple[str, ...] = (), maneuver_id: int | None = None, **query: Any
) -> FitPlot:
    found = get_result(store, CROSS_VALIDATION, CrossValidationQuery(**query))
    return read_held_out_fit(store, found, maneuver_id, outputs)


def _compute_held_out_residuals(
    store: Store, maneuver_id: int | None = None, **query: Any
) -> Residuals:
    found = get_result(store, CROSS_VALIDATION, CrossValidationQuery(**query))
    return compute_held_out_residuals(found, maneuver_id)


def _sample_design(store: Store, design_id: int, level: int) -> DesignedExcitation:
    return sample_design(store.designs.get(design_id), level)


def _predict_response(store: Store, design_id: int, run_id: int, level: int) -> ExpectedResponse:
    query = DesignQuery(design_id=design_id, run_id=run_id, level=level)
    return get_result(store, PREDICTED_ACCURACY, query).response


def _study_model_order(store: Store, **query: Any) -> ModelOrder:
    return study_model_order(store, OrderQuery(**query))


def _reduce_responses(
    store: Store, output: str, surface: str, counts: tuple[int, ...], **query: Any
) -> ReducedResponses:
    return compute_reduced_responses(store, OrderQuery(**query), output, surface, counts)


def _get_diagram(store: Store, **search: Any) -> Stabilisation:
    return get_result(store, MODES, ModeSearch(**search)).diagram


def _get_reconstruction(store: Store, names: tuple[str, ...] = (), **query: Any) -> Reconstruction:
    found = get_result(store, RECONSTRUCTION, ReconstructionQuery(**query))
    return select_quantities(found, names)


def _get_transfer_function(store: Store, **query: Any) -> Bode:
    found = get_result(store, TRANSFER_FUNCTION, TransferFunctionQuery(**query))
    return Bode(
        maneuver_id=query["maneuver_id"],
        inputs=(query["input"],),
        measured=(found.measured,),
        models=(found.modelled,),
        modes=(),
    )


def _get_output_only(store: Store, **query: Any) -> OutputOnlyResult:
    return get_result(store, OUTPUT_ONLY_MODES, OutputOnlyQuery(**query))


def _read_frozen_figure(store: Store, figure_id: int) -> Spec:
    return read_figure(store, store.frozen_figures.get(figure_id))


# fmt: off
_KINDS = (
    FigureKind("envelope", _Filters, read_envelope, draw_envelope,
        "Draw the flight conditions of the filtered maneuvers."),
    FigureKind("derivative-coverage", _CoverageParameters, read_derivative_coverage,
        draw_derivative_coverage,
        "Draw the relative standard errors of all derivatives over the envelope of a campaign.",
        drawing=("coefficient",)),
    FigureKind("time-history", _TimeHistory, read_time_history, draw_time_history,
        "Draw channels over time, decimated for the screen; by default the inputs.\n\n"
        "CSV and MAT files contain every sample of the window."),
    FigureKind("lattice", _Lattice, view_lattice, draw_lattice,
        "Draw the boxes of a computed prediction, by default surfaces and sensors (Fig. 3).\n\n"
        "Or pressures, modes as splined to the boxes, aspect ratios, and boxes per wavelength."),
    FigureKind("surface-histories", _SurfaceHistories, read_surface_histories,
        draw_surface_histories,
        "Draw measured surfaces over time, with their commands through the servos (Fig. 4).\n\n"
        "Left and right ones share a row. Commands have no feedback."),
    FigureKind("flight-history", _FlightHistory, read_flight_history, draw_time_history,
        "Draw channels of a whole flight over time; by default the commands."),
    FigureKind("spectrum", _Spectrum, compute_spectrum, draw_spectrum,
        "Draw Fourier magnitudes at the harmonics, coloured by input; by default of the inputs."),
    FigureKind("signal-to-noise", _Channels, estimate_signal_to_noise, draw_signal_to_noise,
        "Draw signal-to-noise ratios by channel and harmonic; by default of inputs and outputs."),
    FigureKind("plot-matrix", _PlotMatrix, compute_plot_matrix, draw_plot_matrix,
        "Draw a scatter plot matrix of channels with their correlation; by default of the inputs."),
    FigureKind("bode", _Bode, compute_bode, draw_bode,
        "Draw measured frequency responses and those of identified models.",
        drawing=("view", "frequency_scale", "magnitude_scale")),
    FigureKind("reconstruction", _Reconstruction, _get_reconstruction, draw_reconstruction,
        "Draw reconstructed motion and coefficients with ±2 standard errors.\n\n"
        "In the time domain by the smoother (Fig. 16a), in the frequency domain by least "
        "squares at each harmonic, with rank and condition number.",
        drawing=("domain",)),
    FigureKind("transfer-function", _TransferFunction, _get_transfer_function, draw_bode,
        "Draw the measured response of an output to an input, and its transfer function.",
        drawing=("view",)),
    FigureKind("output-only-modes", _OutputOnly, _get_output_only, draw_output_only,
        "Draw the spectral density of the outputs with the model of modes from outputs alone."),
    FigureKind("grey-box-fit", _GreyBox, read_grey_box, draw_grey_box,
        "Draw the amplitudes of the outputs of a maneuver with those of a grey-box model."),
    FigureKind("loops", _Maneuver, estimate_loops, draw_loops,
        "Draw the measured loop gain of each surface, with its stability margins."),
    FigureKind("ground-test", _Flight, read_ground_spectra, draw_ground_test,
        "Draw mini-GVT spectra before and after a flight."),
    FigureKind("fit", _FitParameters, read_fit, draw_fit,
        "Draw the fitted model and the measured data points."),
    FigureKind("residual", _Block, compute_residuals, draw_residual,
        "Draw the residuals by output and frequency."),
    FigureKind("parameter-correlation", _Correlation, compute_parameter_correlation,
        draw_parameter_correlation,
        "Draw the correlation matrix of the estimates.",
        drawing=("selected", "grouped")),
    FigureKind("adequacy", _RunWithSelection, read_adequacy, draw_adequacy,
        "Draw the p-values of all tests for remaining model error, by hypothesis.",
        drawing=("selected",)),
    FigureKind("condition-derivatives", _ConditionDerivatives, read_condition_sheet,
        draw_condition_derivatives,
        "Draw the derivatives of a flight condition, normalised: by method, repeats, predictions.",
        drawing=("selected",)),
    FigureKind("poles", _Poles, read_poles, draw_poles,
        "Draw the poles of identified models, and the in-vacuo modes of the first."),
    FigureKind("iterations", _Run, read_iterations, draw_iterations,
        "Draw the cost over the iterations."),
    FigureKind("time-check", _TimeCheck, check_in_time, draw_time_check,
        "Draw recorded outputs and the response of the identified model to the recorded inputs."),
    FigureKind("time-comparison", _TimeComparison, compare_in_time, draw_time_comparison,
        "Draw one output of several maneuvers and the responses of models, with their fit in %.",
        drawing=("arrangement",)),
    FigureKind("cross-prediction", _CrossPrediction, _get_cross_predictions,
        draw_cross_predictions,
        "Draw R² of the outputs of maneuvers that are predicted by the models of runs."),
    FigureKind("prediction", _PredictedOutputs, read_prediction, draw_fit,
        "Draw outputs of a maneuver that the model of a run predicts from the measured inputs."),
    FigureKind("prediction-residual", _PredictedResiduals, compute_prediction_residuals,
        draw_residual,
        "Draw the residuals of the predicted outputs of a maneuver by output and frequency."),
    FigureKind("residual-correlation", _PredictedOutputs, correlate_residuals,
        draw_residual_correlation,
        "Draw auto- and cross-correlation of residuals over the lag, with bounds of 95 %."),
    FigureKind("held-out", _HeldOutFit, _read_held_out_fit, draw_fit,
        "Draw measured outputs and their prediction by refits to other data."),
    FigureKind("held-out-residual", _HeldOutResiduals, _compute_held_out_residuals,
        draw_residual,
        "Draw the residuals at held-out data by output and frequency."),
    FigureKind("derivatives", _Derivatives, compare_derivatives, draw_derivatives,
        "Draw derivatives by method and prediction with ±2 standard errors."),
    FigureKind("forest", _Forest, compare_derivatives, draw_forest,
        "Draw the estimates and predictions of one derivative, with their mean (forest plot).",
        drawing=("name",)),
    FigureKind("trend", TrendParameters, fit_derivative_trend, draw_trend,
        "Draw one derivative over the flight conditions, with weighted fits."),
    FigureKind("v-omega-zeta", _RootsParameters, _get_roots, draw_v_omega_zeta,
        "Draw frequency and damping of the identified roots with ±2 standard errors."),
    FigureKind("root-locus", _RootsParameters, _get_roots, draw_root_locus,
        "Draw the identified roots in the s-plane."),
    FigureKind("predicted-v-omega-zeta", _PredictedFlutter, _get_predicted_roots,
        draw_v_omega_zeta,
        "Draw frequency and damping of the roots of a prediction, with ±2 standard errors."),
    FigureKind("predicted-root-locus", _PredictedFlutter, _get_predicted_roots,
        draw_root_locus,
        "Draw the roots of a prediction in the s-plane."),
    FigureKind("flutter-summary", _SummaryFigure, _get_summary_diagram, draw_flutter_summary,
        "Draw damping g and frequency of the roots of a flutter summary over airspeed (V-g, V-f)."),
    FigureKind("equivalent-modes", _Flutter, _get_flutter, draw_equivalent_modes,
        "Draw equivalent frequency and damping of every run over dynamic pressure (Eq. 25)."),
    FigureKind("flutter-forecast", _Flutter, _get_flutter, draw_flutter_forecast,
        "Draw the predicted flutter speed by run, and by classical flutter prediction methods."),
    FigureKind("flutter-map", _Flutter, _get_flutter_map, draw_flutter_map,
        "Draw the flutter speed over fuel and altitude."),
    FigureKind("live-history", _StreamParameters, read_live_history, draw_live_history,
        "Draw flutter speed and damping ratios as they were known during a stream."),
    FigureKind("global-slice", _GlobalSlice, _slice_global_model, draw_slice,
        "Draw one derivative of a global model along one variable with ±2 standard errors."),
    FigureKind("global-coverage", _GlobalModel, _compute_coverage, draw_coverage,
        "Draw the relative standard error of a global model over the envelope, and its runs."),
    FigureKind("closed-loop-margins", _ClosedLoop, _get_closed_loop, draw_closed_loop_margins,
        "Draw the stability margins of the loop of every surface over airspeed."),
    FigureKind("closed-loop-roots", _ClosedLoop, _get_closed_loop, draw_closed_loop_roots,
        "Draw the roots with and without the controller."),
    FigureKind("control-loop", _ControlLoop, describe_loop, draw_control_loop,
        "Draw the block diagram of a controller's loop, and where an excitation enters it."),
    FigureKind("search-path", _Search, get_group, draw_search_path,
        "Draw the criteria after every step of a search."),
    FigureKind("search-stability", _Search, get_group, draw_search_stability,
        "Draw the frequency of selection of each term in bootstrap samples."),
    FigureKind("design-history", _Design, _sample_design, draw_design_history,
        "Draw one period of an excitation design."),
    FigureKind("design-spectrum", _Design, _sample_design, draw_design_spectrum,
        "Draw the amplitudes of the harmonics of an excitation design, by input."),
    FigureKind("design-information", _DesignForRun, _predict_response, draw_design_information,
        "Draw the information of each harmonic of a design on the parameters of a run."),
    FigureKind("design-signal", _DesignForRun, _predict_response, draw_design_signal,
        "Draw the expected signal-to-noise ratio by output and harmonic of a design."),
    FigureKind("frozen", _Frozen, _read_frozen_figure, dict,
        "Draw a frozen figure in its stored state."),
    FigureKind("modes-against-fuel", _ModalTable, trace_modes, draw_modes_against_fuel,
        "Draw frequency and damping of the modes of a table over fuel, with crossings."),
    FigureKind("mac", _Mac, compute_assurance, draw_assurance,
        "Draw the MAC of the modes of a table with itself, or of another fuel or table."),
    FigureKind("model-order", _ModelOrder, _study_model_order, draw_model_order,
        "Draw derivatives over the number of retained modes, with a band of ±10 %.",
        drawing=("derivatives",)),
    FigureKind("reduced-responses", _ReducedResponses, _reduce_responses, draw_reduced_responses,
        "Draw one frequency response of full and reduced models, and with rigid-body sensors."),
    FigureKind("stabilisation", _ModeSearch, _get_diagram, draw_stabilisation,
        "Draw the stabilisation diagram: poles by model order, and the mean measured response."),
    FigureKind("measured-response", _MeasuredResponse, read_function, draw_measured_response,
        "Draw a measured frequency response: magnitude, phase, and coherence if estimated."),
)
# fmt: on

FIGURES = {kind.name: kind for kind in _KINDS}
"""All figures by name; a new figure is one more value in this table."""
