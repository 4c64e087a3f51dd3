"""All kinds of jobs. A worker imports this module, and with it the numerical libraries."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

from flexsid.errors import FlexsidError
from flexsid.jobs.kind import Kind, Kinds, get_result, save_records
from flexsid.records.condition_sheet import ConditionSheet
from flexsid.records.flutter import ClosedLoop, Flutter, FlutterResult, PredictedFlutterResult
from flexsid.records.global_model import GlobalModelResult
from flexsid.records.job import Job
from flexsid.records.modal_data import ModeIdentification, Orthogonality
from flexsid.records.quality import CompatibilityReport
from flexsid.records.run import ReportProgress
from flexsid.records.validation import (
    AerodynamicsComparison,
    CrossPredictionMatrix,
    CrossValidation,
    PosteriorCheck,
)
from flexsid.records.views import OutputOnlyResult, Reconstruction, TransferFunctionResult
from flexsid.storage.copies import backup
from flexsid.storage.copies.snapshot import open_snapshot, take_snapshot
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
from flexsid.workflow.measurements import output_only_modes, reconstruction, transfer_functions
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
    cross_prediction,
    cross_validation,
    posterior_check,
)
from flexsid.workflow.validation.cross_prediction import CrossPredictionQuery

# --- All kinds of jobs. A worker imports this module, and with it the numerical libraries ---------


@dataclass(frozen=True, slots=True, kw_only=True)
class EstimationRequest:
    """Empty: the request of an estimation is its run, which has the id of the job."""


@dataclass(frozen=True, slots=True)
class SnapshotTask:
    """Request with all records that its computation needs."""

    snapshot: bytes
    request: Any


def _in_snapshot(
    compute: Callable[[Store, Any, ReportProgress], Any],
) -> Callable[[SnapshotTask, ReportProgress], Any]:
    """Return the computation of a task from that of its request in a store."""
    return lambda task, report: compute(open_snapshot(task.snapshot), task.request, report)


def _send_run(store: Store, job: Job, query: Any) -> SnapshotTask:
    return SnapshotTask(take_snapshot(store, run_ids=(query.run_id,)), query)


def _send_fused_runs(store: Store, job: Job, query: Any) -> SnapshotTask:
    run_ids = (*query.run_ids, *find_derived_runs(store, query.run_ids))
    return SnapshotTask(take_snapshot(store, run_ids=run_ids), query)


def _send_predicted_maneuvers(
    store: Store, job: Job, query: cross_prediction.CrossPredictionQuery
) -> SnapshotTask:
    maneuver_ids = cross_prediction.list_maneuver_ids(store, query)
    return SnapshotTask(take_snapshot(store, maneuver_ids, query.run_ids), query)


def _send_maneuver(store: Store, job: Job, query: Any) -> SnapshotTask:
    return SnapshotTask(take_snapshot(store, maneuver_ids=(query.maneuver_id,)), query)


def _send_maneuvers(
    store: Store, job: Job, query: compatibility.CompatibilityQuery
) -> SnapshotTask:
    return SnapshotTask(take_snapshot(store, maneuver_ids=query.maneuver_ids), query)


def _send_design(store: Store, job: Job, query: Any) -> SnapshotTask:
    runs = (query.run_id, getattr(query, "other_run_id", None))
    run_ids = tuple(number for number in runs if number is not None)
    return SnapshotTask(take_snapshot(store, (), run_ids, (query.design_id,)), query)


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
)
SIMULATION = Kind(
    name="preflight-simulation",
    label="Pre-flight simulation",
    request=preflight_simulation.SimulationRequest,
    prepare=_send_design,
    compute=_in_snapshot(preflight_simulation.simulate_design),
    save=save_records(preflight_simulation.store_simulation),
)
FLUTTER = Kind(
    name="flutter-prediction",
    label="Flutter prediction",
    usual_s=22.0,
    request=flutter_models.FlutterQuery,
    prepare=_send_fused_runs,
    compute=_in_snapshot(flutter_analysis.compute_flutter),
    save=save_records(flutter_analysis.store_flutter),
    result=FlutterResult,
    identify=flutter_models.identify_query,
)
PREDICTED_FLUTTER = Kind(
    name="predicted-flutter",
    label="Flutter of a prediction",
    request=of_prediction.PredictedFlutterQuery,
    prepare=lambda store, job, query: of_prediction.prepare_predicted_flutter(store, query),
    compute=of_prediction.compute_predicted_flutter,
    result=PredictedFlutterResult,
    identify=of_prediction.identify_predicted_flutter,
)
CLOSED_LOOP = Kind(
    name="closed-loop",
    label="Closed-loop stability",
    request=closed_loop.ClosedLoopQuery,
    prepare=_send_fused_runs,
    compute=_in_snapshot(closed_loop.compute_closed_loop),
    save=save_records(closed_loop.store_closed_loop),
    result=ClosedLoop,
    identify=closed_loop.identify_closed_loop,
)
GLOBAL_MODEL = Kind(
    name="global-model",
    label="Global model",
    request=estimates.GlobalModelQuery,
    prepare=lambda store, job, query: estimates.prepare_global_model(store, query),
    compute=computation.compute_global_model,
    result=GlobalModelResult,
    identify=estimates.identify_global_model,
)
CROSS_PREDICTION = Kind(
    name="cross-prediction",
    label="Cross-prediction",
    request=cross_prediction.CrossPredictionQuery,
    prepare=_send_predicted_maneuvers,
    compute=_in_snapshot(cross_prediction.compute_cross_predictions),
    result=CrossPredictionMatrix,
    identify=cross_prediction.identify_cross_prediction,
)
CROSS_VALIDATION = Kind(
    name="cross-validation",
    label="Cross-validation",
    usual_s=21.0,
    request=cross_validation.CrossValidationQuery,
    prepare=_send_run,
    compute=_in_snapshot(cross_validation.cross_validate),
    result=CrossValidation,
    identify=cross_validation.identify_cross_validation,
)
AERODYNAMICS = Kind(
    name="aerodynamics-comparison",
    label="Comparison of aerodynamics",
    request=aerodynamics_comparison.AerodynamicsQuery,
    prepare=_send_run,
    compute=_in_snapshot(aerodynamics_comparison.compare_aerodynamics),
    result=AerodynamicsComparison,
    identify=aerodynamics_comparison.identify_aerodynamics,
)
POSTERIOR = Kind(
    name="posterior-check",
    label="Posterior check",
    request=posterior_check.PosteriorQuery,
    prepare=_send_run,
    compute=_in_snapshot(posterior_check.check_posterior),
    result=PosteriorCheck,
    identify=posterior_check.identify_posterior,
)
PREDICTED_ACCURACY = Kind(
    name="predicted-accuracy",
    label="Predicted accuracy",
    request=predicted_accuracy.DesignQuery,
    prepare=_send_design,
    compute=_in_snapshot(predicted_accuracy.predict_accuracy),
    result=predicted_accuracy.PredictedAccuracy,
    identify=predicted_accuracy.identify_design_query,
)
INPUT_COMPARISON = Kind(
    name="input-comparison",
    label="Comparison with classic inputs",
    request=predicted_accuracy.DesignQuery,
    prepare=_send_design,
    compute=_in_snapshot(classic_inputs.compare_inputs),
    result=classic_inputs.InputComparison,
    identify=predicted_accuracy.identify_design_query,
)
AMPLITUDES = Kind(
    name="amplitude-optimisation",
    label="Amplitude optimisation",
    usual_s=27.0,
    request=amplitude_optimisation.AmplitudeQuery,
    prepare=_send_design,
    compute=_in_snapshot(amplitude_optimisation.optimise_amplitudes),
    result=amplitude_optimisation.OptimisedAmplitudes,
    identify=predicted_accuracy.identify_design_query,
)
OPTIMAL_DESIGN = Kind(
    name="optimal-design",
    label="Optimal design",
    request=optimal_designs.OptimalDesignQuery,
    prepare=_send_design,
    compute=_in_snapshot(optimal_designs.compute_optimal_design),
    save=save_records(optimal_designs.store_optimal_design),
    result=optimal_designs.OptimalDesign,
    identify=optimal_designs.identify_optimal_design,
)
RECONSTRUCTION = Kind(
    name="motion-reconstruction",
    label="Motion reconstruction",
    request=reconstruction.ReconstructionQuery,
    prepare=_send_maneuver,
    compute=_in_snapshot(reconstruction.reconstruct),
    result=Reconstruction,
    identify=_identify_reconstruction,
)
TRANSFER_FUNCTION = Kind(
    name="transfer-function",
    label="Transfer function",
    request=transfer_functions.TransferFunctionQuery,
    prepare=_send_maneuver,
    compute=_in_snapshot(
        lambda store, query, report: transfer_functions.estimate_transfer_function(store, query)
    ),
    result=TransferFunctionResult,
    identify=_identify_transfer_function,
)
OUTPUT_ONLY_MODES = Kind(
    name="output-only-modes",
    label="Output-only modes",
    request=output_only_modes.OutputOnlyQuery,
    prepare=_send_maneuver,
    compute=_in_snapshot(
        lambda store, query, report: output_only_modes.identify_modes_of_outputs(store, query)
    ),
    result=OutputOnlyResult,
    identify=_identify_output_only,
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
)
MODES = Kind(
    name="mode-identification",
    label="Mode identification",
    usual_s=36.0,
    request=ground_vibration_test.ModeSearch,
    prepare=lambda store, job, search: ground_vibration_test.prepare_mode_search(store, search),
    compute=ground_vibration_test.find_modes,
    result=ModeIdentification,
    identify=ground_vibration_test.identify_mode_search,
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
)
QUALITY = Kind(
    name="quality-assessment",
    label="Quality assessment",
    request=maneuver_quality.QualityRequest,
    prepare=_send_maneuver,
    compute=_in_snapshot(maneuver_quality.assess_maneuver),
    save=save_records(
        lambda store, job, request, outcome: {
            "verdict": maneuver_quality.store_quality(store, outcome).verdict.value
        }
    ),
    priority=-1,  # analysts wait for the others
)
COMPATIBILITY = Kind(
    name="compatibility",
    label="Compatibility of sensors",
    request=compatibility.CompatibilityQuery,
    prepare=_send_maneuvers,
    compute=_in_snapshot(compatibility.compute_compatibility),
    result=CompatibilityReport,
    identify=compatibility.identify_compatibility,
)
PREDICTION = Kind(
    name="derivative-prediction",
    label="Derivative prediction",
    request=computed_predictions.PredictionRequest,
    prepare=lambda store, job, request: computed_predictions.prepare_prediction(store, request),
    compute=computed_predictions.compute_prediction,
    save=save_records(computed_predictions.store_computed_prediction),
)
IMPORT = Kind(
    name=parsed_files.IMPORT_KIND,
    label="Import",
    request=uploads.ImportRequest,
    prepare=lambda store, job, request: uploads.prepare_import(store, request),
    compute=uploads.compute_import,
    save=save_records(uploads.store_import),
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
)
BACKUP = Kind(
    name=backup.BACKUP,
    label="Backup",
    request=database.BackupRequest,
    prepare=database.prepare_backup,
    compute=database.compute_backup,
    result=database.BackupFile,
)

# All values above, so that a kind is added in one place.
KINDS: Kinds = {one.name: one for one in tuple(globals().values()) if isinstance(one, Kind)}


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
