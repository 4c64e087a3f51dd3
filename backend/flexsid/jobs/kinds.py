"""All kinds of jobs. A worker imports this module, and with it the numerical libraries."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from flexsid.errors import FlexsidError, UnknownRecord
from flexsid.jobs.kind import (
    Analysis,
    Kind,
    Kinds,
    SnapshotTask,
    get_result,
    in_snapshot,
    save_records,
)
from flexsid.records.condition_sheet import ConditionSheet
from flexsid.records.flutter import (
    ClosedLoop,
    Flutter,
    FlutterResult,
    PredictedFlutterResult,
)
from flexsid.records.global_model import GlobalModelResult
from flexsid.records.grey_box import GreyBoxFit
from flexsid.records.job import Job
from flexsid.records.modal_data import ModeIdentification, Orthogonality
from flexsid.records.quality import CompatibilityReport
from flexsid.records.run import RunState
from flexsid.records.validation import (
    AerodynamicsComparison,
    AmplitudeComparison,
    CrossPredictionMatrix,
    CrossValidation,
    PosteriorCheck,
    RepeatedLevels,
)
from flexsid.records.views import (
    OutputOnlyResult,
    Reconstruction,
    TransferFunctionResult,
)
from flexsid.storage.copies import backup
from flexsid.storage.copies.snapshot import take_snapshot
from flexsid.storage.jobs import queue
from flexsid.storage.jobs.batches import find_derived_runs
from flexsid.storage.lists.run_list import ESTIMATION
from flexsid.storage.store import Store
from flexsid.workflow.excitation import (
    amplitude_optimisation,
    classic_inputs,
    excitation_designs,
    optimal_designs,
    predicted_accuracy,
    preflight_simulation,
)
from flexsid.workflow.flutter import closed_loop, flutter_analysis, flutter_models
from flexsid.workflow.flutter import predicted_flutter as of_prediction
from flexsid.workflow.flutter.flutter_models import FlutterQuery
from flexsid.workflow.global_model import computation, estimates
from flexsid.workflow.importing import parsed_files, uploads
from flexsid.workflow.maintenance import database, printed_reports
from flexsid.workflow.measurements import (
    grey_box_fits,
    output_only_modes,
    reconstruction,
    transfer_functions,
)
from flexsid.workflow.measurements.sensor_responses import gather_sensors
from flexsid.workflow.modal_data import computed_predictions, ground_vibration_test, orthogonality
from flexsid.workflow.modal_data.ground_vibration_test import (
    ResponseEstimation,
    ResponseTask,
    estimate_responses,
    store_estimated_responses,
)
from flexsid.workflow.quality import compatibility, maneuver_quality
from flexsid.workflow.review.condition_sheet import (
    build_condition_sheet,
    find_condition,
    load_simulated,
)
from flexsid.workflow.review.frozen_sheet import read_frozen_sheet
from flexsid.workflow.runs import estimation
from flexsid.workflow.runs.run_identity import list_run_contents
from flexsid.workflow.structure_determination import searches
from flexsid.workflow.validation import (
    aerodynamics_comparison,
    amplitude_comparison,
    cross_prediction,
    cross_validation,
    posterior_check,
    repeated_levels,
)
from flexsid.workflow.validation.cross_prediction import CrossPredictionQuery

# --- All kinds of jobs. A worker imports this module, and with it the numerical libraries ---------


@dataclass(frozen=True, slots=True, kw_only=True)
class EstimationRequest:
    """Empty: the request of an estimation is its run, which has the id of the job."""


def _send_fused_runs(store: Store, job: Job, query: Any) -> SnapshotTask:
    run_ids = (*query.run_ids, *find_derived_runs(store, query.run_ids))
    return SnapshotTask(take_snapshot(store, run_ids=run_ids), query)


def _send_predicted_maneuvers(
    store: Store, job: Job, query: cross_prediction.CrossPredictionQuery
) -> SnapshotTask:
    maneuver_ids = cross_prediction.list_maneuver_ids(store, query)
    return SnapshotTask(take_snapshot(store, maneuver_ids, query.run_ids), query)


def _identify_reconstruction(
    store: Store, query: reconstruction.ReconstructionQuery
) -> tuple[object, ...]:
    maneuver = store.maneuvers.get(query.maneuver_id)
    gather_sensors(store, maneuver, query.axis)  # refused at once, not as a job
    return list_run_contents(store, (), (query.maneuver_id,))


def _identify_transfer_function(
    store: Store, query: transfer_functions.TransferFunctionQuery
) -> tuple[object, ...]:
    transfer_functions.check_transfer_function(store, query)
    return list_run_contents(store, (), (query.maneuver_id,))


def _identify_output_only(
    store: Store, query: output_only_modes.OutputOnlyQuery
) -> tuple[object, ...]:
    output_only_modes.check_output_only(store, query)
    return list_run_contents(store, (), (query.maneuver_id,))


def _identify_grey_box(store: Store, query: grey_box_fits.GreyBoxQuery) -> tuple[object, ...]:
    code = grey_box_fits.identify_grey_box(store, query)
    return (*code, *list_run_contents(store, (), (query.maneuver_id,)))


RUN = Kind(
    name=ESTIMATION,
    label="Estimation",
    request=EstimationRequest,
    prepare=lambda store, job, request: estimation.prepare(store, store.runs.get(job.id or 0)),
    compute=estimation.compute_run,
    save=lambda store, job, request, outcome: estimation.store_result(
        store, job.id or 0, job.attempt, outcome, job.worker or ""
    ),
)
SEARCH = Kind(
    name=queue.SEARCH,
    label="Model structure search",
    request=searches.StructureSearchRequest,
    prepare=lambda store, job, request: searches.prepare_search(
        store, store.searches.get(request.search_id)
    ),
    compute=searches.compute_search,
    save=save_records(searches.store_search_result),
    page="/model-structures?id={search_id}#search",
)
DESIGN = Kind(
    name="excitation-design",
    label="Excitation design",
    request=excitation_designs.DesignOrder,
    prepare=lambda store, job, request: request,
    compute=excitation_designs.compute_design,
    save=save_records(
        lambda store, job, order, outcome: {"design_id": store.designs.add(outcome).id}
    ),
    page="/excitation/{result.design_id}",
)
SIMULATION = Kind(
    name="preflight-simulation",
    label="Pre-flight simulation",
    request=preflight_simulation.SimulationRequest,
    compute=in_snapshot(preflight_simulation.simulate_design),
    save=save_records(preflight_simulation.store_simulation),
    page="/excitation/{design_id}",
)
FLUTTER = Analysis(
    name="flutter-prediction",
    label="Flutter prediction",
    usual_s=22.0,
    request=flutter_models.FlutterQuery,
    prepare=_send_fused_runs,
    compute=in_snapshot(flutter_analysis.compute_flutter),
    save=save_records(flutter_analysis.store_flutter),
    result=FlutterResult,
    identify=flutter_models.identify_query,
    path="/flutter",
    tag="flutter",
    noun="flutter",
    shows="flutter",
    about="flutter speed of these runs, with its confidence interval.",
    page=(
        "/flutter?runs={run_ids}&fuel={fuel:percent}&altitude={altitude_m}"
        "&unmodelled_modes={unmodelled_modes}&variation={variation}&next={next_m_s}"
    ),
)
PREDICTED_FLUTTER = Analysis(
    name="predicted-flutter",
    label="Flutter of a prediction",
    request=of_prediction.PredictedFlutterQuery,
    prepare=lambda store, job, query: of_prediction.prepare_predicted_flutter(store, query),
    compute=of_prediction.compute_predicted_flutter,
    result=PredictedFlutterResult,
    identify=of_prediction.identify_predicted_flutter,
    path="/flutter/predicted",
    tag="flutter",
    shows="flutter",
    about="flutter speed of a prediction alone, by p-k and by rational functions.",
    page="/flutter?prediction={prediction_id}",
    command="predicted-flutter",
)
CLOSED_LOOP = Analysis(
    name="closed-loop",
    label="Closed-loop stability",
    request=closed_loop.ClosedLoopQuery,
    prepare=_send_fused_runs,
    compute=in_snapshot(closed_loop.compute_closed_loop),
    save=save_records(closed_loop.store_closed_loop),
    result=ClosedLoop,
    identify=closed_loop.identify_closed_loop,
    path="/closed-loop",
    tag="closed-loop",
    page=(
        "/flutter?tab=closed-loop&runs={flutter.run_ids}&fuel={flutter.fuel:percent}"
        "&altitude={flutter.altitude_m}&unmodelled_modes={flutter.unmodelled_modes}"
        "&variation={flutter.variation}&controller={controller_id}"
    ),
)
GLOBAL_MODEL = Analysis(
    name="global-model",
    label="Global model",
    request=estimates.GlobalModelQuery,
    prepare=lambda store, job, query: estimates.prepare_global_model(store, query),
    compute=computation.compute_global_model,
    result=GlobalModelResult,
    identify=estimates.identify_global_model,
    path="/global-models",
    tag="global model",
    shows="summary",
    about="""
    global model of these runs: derivatives, scores and outlying runs.

    The figures ``global-slice`` and ``global-coverage`` have its values over the envelope.
    """,
    page="/global-model?runs={run_ids}&variables={variables}&prediction={prediction_id}",
)
CROSS_PREDICTION = Analysis(
    name="cross-prediction",
    label="Cross-prediction",
    request=cross_prediction.CrossPredictionQuery,
    prepare=_send_predicted_maneuvers,
    compute=in_snapshot(cross_prediction.compute_cross_predictions),
    result=CrossPredictionMatrix,
    identify=cross_prediction.identify_cross_prediction,
    path="/cross-predictions",
    tag="validation",
    noun="cross_predictions",
    about="fit of the outputs of maneuvers, predicted by the models of runs.",
    page="/compare?tab=validation&runs={run_ids}&maneuvers={maneuver_ids}",
)
CROSS_VALIDATION = Analysis(
    name="cross-validation",
    label="Cross-validation",
    usual_s=21.0,
    request=cross_validation.CrossValidationQuery,
    compute=in_snapshot(cross_validation.cross_validate),
    result=CrossValidation,
    identify=cross_validation.identify_cross_validation,
    path="/cross-validations",
    tag="validation",
    shows="summary",
    about="""
    fit of held-out data of a run, predicted by refits to the others.

    The figures ``held-out`` and ``held-out-residual`` have the spectra.
    """,
    page="/compare?tab=validation&runs={run_id}&partition={partition}&folds={folds}",
)
AERODYNAMICS = Analysis(
    name="aerodynamics-comparison",
    label="Comparison of aerodynamics",
    request=aerodynamics_comparison.AerodynamicsQuery,
    compute=in_snapshot(aerodynamics_comparison.compare_aerodynamics),
    result=AerodynamicsComparison,
    identify=aerodynamics_comparison.identify_aerodynamics,
    path="/aerodynamics-comparisons",
    tag="validation",
    about="verdict between quasi-steady and shaped derivatives for a run.",
    page="/runs/{run_id}?tab=checks#aerodynamics",
)
POSTERIOR = Analysis(
    name="posterior-check",
    label="Posterior check",
    request=posterior_check.PosteriorQuery,
    compute=in_snapshot(posterior_check.check_posterior),
    result=PosteriorCheck,
    identify=posterior_check.identify_posterior,
    path="/posterior-checks",
    tag="validation",
    about="posterior of an output-error run, against its standard errors.",
    page="/runs/{run_id}?tab=checks#posterior",
    command="posterior",
)
AMPLITUDE_COMPARISON = Analysis(
    name="amplitude-comparison",
    label="Comparison of amplitudes",
    request=amplitude_comparison.AmplitudeComparisonQuery,
    compute=in_snapshot(amplitude_comparison.compare_amplitudes),
    result=AmplitudeComparison,
    identify=amplitude_comparison.identify_amplitude_comparison,
    path="/amplitude-comparisons",
    tag="validation",
    about="tests of equal linear models at several amplitudes, by output-error runs.",
    page="/compare?tab=trends&runs={run_ids}#amplitudes",
)
PREDICTED_ACCURACY = Analysis(
    name="predicted-accuracy",
    label="Predicted accuracy",
    request=predicted_accuracy.DesignQuery,
    compute=in_snapshot(predicted_accuracy.predict_accuracy),
    result=predicted_accuracy.PredictedAccuracy,
    identify=predicted_accuracy.identify_design_query,
    path="/designs/{design_id}/predicted-accuracy",
    tag="designs",
    page="/excitation/{design_id}",
)
INPUT_COMPARISON = Analysis(
    name="input-comparison",
    label="Comparison with classic inputs",
    request=predicted_accuracy.DesignQuery,
    compute=in_snapshot(classic_inputs.compare_inputs),
    result=classic_inputs.InputComparison,
    identify=predicted_accuracy.identify_design_query,
    path="/designs/{design_id}/classic-inputs",
    tag="designs",
    about="comparison with doublets, 3-2-1-1s and sweeps of equal limits.",
    page="/excitation/{design_id}",
)
AMPLITUDES = Analysis(
    name="amplitude-optimisation",
    label="Amplitude optimisation",
    usual_s=27.0,
    request=amplitude_optimisation.AmplitudeQuery,
    compute=in_snapshot(amplitude_optimisation.optimise_amplitudes),
    result=amplitude_optimisation.OptimisedAmplitudes,
    identify=predicted_accuracy.identify_design_query,
    path="/designs/{design_id}/amplitudes",
    tag="designs",
    noun="amplitudes",
    about="""
    amplitudes of minimax relative standard error, and D-optimal ones.

    Limits: largest deflection of any surface [rad], its rate [rad/s] and load factor [g],
    feedback included; if omitted, those of the design. ``levels`` are amplitudes by airspeed
    within them.
    """,
    page="/excitation/{design_id}",
)
OPTIMAL_DESIGN = Analysis(
    name="optimal-design",
    label="Optimal design",
    request=optimal_designs.OptimalDesignQuery,
    compute=in_snapshot(optimal_designs.compute_optimal_design),
    save=save_records(optimal_designs.store_optimal_design),
    result=optimal_designs.OptimalDesign,
    identify=optimal_designs.identify_optimal_design,
    path="/designs/{design_id}/optimal-design",
    tag="designs",
    about="""
    gain of the design that is optimal for an objective within limits.

    Objectives: ``flutter`` speed, ``derivatives`` by name, ``damping`` of a mode, and
    ``structures``, the distance of the run's model structure from the smaller one of another
    run. Limits: deflection [rad], rate [rad/s] and load factor [g]; if omitted, those of the
    design.
    """,
    page="/excitation/{design_id}",
    example={"objective": "flutter", "derivatives": "Cm_alpha,Cm_q", "mode": "7"},
)
RECONSTRUCTION = Analysis(
    name="motion-reconstruction",
    label="Motion reconstruction",
    request=reconstruction.ReconstructionQuery,
    compute=in_snapshot(reconstruction.reconstruct),
    result=Reconstruction,
    identify=_identify_reconstruction,
    path="/maneuvers/{maneuver_id}/reconstruction",
    tag="maneuvers",
    noun="reconstruction",
    page="/maneuvers/{maneuver_id}?tab=reconstruction&modes={modes}",
)
TRANSFER_FUNCTION = Analysis(
    name="transfer-function",
    label="Transfer function",
    request=transfer_functions.TransferFunctionQuery,
    compute=in_snapshot(
        lambda store, query, report: transfer_functions.estimate_transfer_function(store, query)
    ),
    result=TransferFunctionResult,
    identify=_identify_transfer_function,
    path="/transfer-functions",
    tag="maneuvers",
    describe=lambda store, query: (
        f"{query.output} over {query.input}, {store.maneuvers.get(query.maneuver_id).label}"
    ),
    shows="function",
    about="""
    transfer function of an output over an input, with standard errors.

    By default the orders are those usual for the output: a short period for pitch rate and
    pitch angle, a roll mode for roll rate and bank angle.
    """,
    page=(
        "/maneuvers/{maneuver_id}?tab=bode&from_input={input}&to_output={output}&zeros={zeros}"
        "&poles={poles}&integrators={integrators}&no_delay={delay:not}&low={low_hz}"
        "&high={high_hz}#transfer-function"
    ),
    command="transfer-function",
)
OUTPUT_ONLY_MODES = Analysis(
    name="output-only-modes",
    label="Output-only modes",
    request=output_only_modes.OutputOnlyQuery,
    compute=in_snapshot(
        lambda store, query, report: output_only_modes.identify_modes_of_outputs(store, query)
    ),
    result=OutputOnlyResult,
    identify=_identify_output_only,
    path="/output-only-modes",
    tag="maneuvers",
    about="modes of a record from its outputs alone, with standard errors.",
    page=(
        "/maneuvers/{maneuver_id}?tab=bode&from={start_s}&to={stop_s}&low={low_hz}&high={high_hz}"
        "#output-only"
    ),
    command="output-only",
)
GREY_BOX = Kind(
    name="grey-box-fit",
    label="Grey-box fit",
    request=grey_box_fits.GreyBoxQuery,
    compute=in_snapshot(grey_box_fits.compute_grey_box),
    result=GreyBoxFit,
    identify=_identify_grey_box,
    page="/maneuvers/{maneuver_id}?tab=grey-box&fit={id}",
)
RESPONSES = Kind(
    name="response-estimation",
    label="Frequency responses",
    request=ResponseEstimation,
    prepare=lambda store, job, request: ResponseTask(
        uploads.open_upload(store, request.upload_id), request
    ),
    compute=estimate_responses,
    save=save_records(store_estimated_responses),
    page="/modal-data?tab=gvt&responses={result.responses_id}",
)
MODES = Analysis(
    name="mode-identification",
    label="Mode identification",
    usual_s=36.0,
    request=ground_vibration_test.ModeSearch,
    prepare=lambda store, job, search: ground_vibration_test.prepare_mode_search(store, search),
    compute=ground_vibration_test.find_modes,
    result=ModeIdentification,
    identify=ground_vibration_test.identify_mode_search,
    path="/measured-responses/{responses_id}/modes",
    tag="vibration-tests",
    noun="modes",
    page=(
        "/modal-data?tab=gvt&responses={responses_id}&from_hz={low_hz}&to_hz={high_hz}&order={order}"
        "&poles={poles}"
    ),
)
ORTHOGONALITY = Kind(
    name="orthogonality",
    label="Orthogonality",
    request=orthogonality.OrthogonalityComputation,
    prepare=lambda store, job, request: orthogonality.prepare_orthogonality(
        store, uploads.open_upload(store, request.upload_id), request.query
    ),
    compute=orthogonality.compute_orthogonality,
    result=Orthogonality,
    identify=lambda store, request: orthogonality.list_compared_tables(store, request.query),
    page="/modal-data?tab=files&orthogonality={id}",
)
QUALITY = Kind(
    name="quality-assessment",
    label="Quality assessment",
    request=maneuver_quality.QualityRequest,
    compute=in_snapshot(maneuver_quality.assess_maneuver),
    save=save_records(
        lambda store, job, request, outcome: {
            "verdict": maneuver_quality.store_quality(store, outcome).verdict.value
        }
    ),
    priority=-1,  # analysts wait for the others
    page="/maneuvers/{maneuver_id}?tab=quality",
)
COMPATIBILITY = Analysis(
    name="compatibility",
    label="Compatibility of sensors",
    request=compatibility.CompatibilityQuery,
    compute=in_snapshot(compatibility.compute_compatibility),
    result=CompatibilityReport,
    identify=compatibility.identify_compatibility,
    path="/compatibility",
    tag="quality",
    about="""
    comparison of the sensors of maneuvers by kinematics.

    It needs the locations of the sensors, and neither aerodynamics nor a modal table. Each
    fault has its correction, for ``/conditioning``, and the faults that the data do not
    separate from it.
    """,
    page="/maneuvers/{maneuver_ids}?tab=quality#compatibility",
)
PREDICTION = Kind(
    name="derivative-prediction",
    label="Derivative prediction",
    request=computed_predictions.PredictionRequest,
    prepare=lambda store, job, request: computed_predictions.prepare_prediction(store, request),
    compute=computed_predictions.compute_prediction,
    save=save_records(computed_predictions.store_computed_prediction),
    page="/aircraft#predictions",
)
IMPORT = Kind(
    name=parsed_files.IMPORT_KIND,
    label="Import",
    request=uploads.ImportRequest,
    prepare=lambda store, job, request: uploads.prepare_import(store, request),
    compute=uploads.compute_import,
    save=save_records(uploads.store_import),
    page="/import?upload={upload_id}",
)
REPORT = Kind(
    name="report",
    label="Report",
    request=printed_reports.ReportRequest,
    prepare=printed_reports.prepare_printing,
    compute=printed_reports.print_report,
    save=save_records(printed_reports.store_printed_report),
    result=printed_reports.PrintedReport,
    identify=lambda store, request: (),  # the document is named by its content
    page="/api/v1/reports/files/{id}",
)
BACKUP = Kind(
    name=backup.BACKUP,
    label="Backup",
    request=database.BackupRequest,
    prepare=database.prepare_backup,
    compute=database.compute_backup,
    result=database.BackupFile,
    page="/api/v1/backups/{id}",
)

# All values above, so that a kind is added in one place.
KINDS: Kinds = {one.name: one for one in tuple(globals().values()) if isinstance(one, Kind)}
ANALYSES = tuple(one for one in KINDS.values() if isinstance(one, Analysis))


def load_kinds() -> Kinds:
    """Return all kinds by name; a worker receives this function and imports this module."""
    return KINDS


# --- Stored results of jobs that other records refer to -------------------------------------------


def find_stored_flutter(store: Store, run_ids: tuple[int, ...]) -> Flutter | None:
    """Return the stored flutter prediction of runs at its default condition; None without one."""
    try:
        return get_result(store, FLUTTER, FlutterQuery(run_ids=run_ids)).flutter
    except FlexsidError:  # not computed, not ready, failed, or runs that no prediction can use
        return None


def find_stored_predictions(
    store: Store, run_ids: tuple[int, ...], maneuver_ids: tuple[int, ...]
) -> CrossPredictionMatrix | None:
    """Return the stored prediction of maneuvers by the models of runs; None without one."""
    query = CrossPredictionQuery(run_ids=run_ids, maneuver_ids=maneuver_ids)
    try:
        return get_result(store, CROSS_PREDICTION, query)
    except FlexsidError:
        return None


def list_compared_levels(store: Store, aircraft_id: int) -> list[RepeatedLevels]:
    """List the repeated levels of a campaign, with the stored comparison of each."""

    def find_comparison(run_ids: tuple[int, ...]) -> AmplitudeComparison | None:
        try:
            query = amplitude_comparison.AmplitudeComparisonQuery(run_ids=run_ids)
            return get_result(store, AMPLITUDE_COMPARISON, query)
        except FlexsidError:
            return None

    return [
        replace(one, comparison=find_comparison(one.run_ids))
        for one in repeated_levels.list_repeated_levels(store, aircraft_id)
    ]


def read_grey_box(store: Store, job_id: int) -> GreyBoxFit:
    """Return the fit of a grey-box model that a job has computed.

    Raises
    ------
    UnknownRecord
        If the job has computed none.
    """
    job = store.jobs.get(job_id)
    if job.kind != GREY_BOX.name or job.state is not RunState.SUCCEEDED:
        raise UnknownRecord(f"job {job_id} has computed no fit of a grey-box model")
    return GREY_BOX.read_result(job)


def read_condition_sheet(
    store: Store, condition_id: int, truth: bool = False, figure_id: int | None = None
) -> ConditionSheet:
    """Return the sheet of the condition of a maneuver, from stored results.

    ``truth`` adds the true derivatives of an aircraft that is simulated. With ``figure_id`` it is
    the sheet as it was frozen with a decision.
    """
    if figure_id is not None:
        return read_frozen_sheet(store, figure_id)
    return build_condition_sheet(
        store,
        condition_id,
        partial(find_stored_flutter, store),
        partial(find_stored_predictions, store),
        simulated=load_simulated().get(find_condition(store, condition_id).aircraft_name),
        shows_truth=truth,
    )
