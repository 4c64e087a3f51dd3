"""All kinds of jobs. A worker imports this module, and with it the numerical libraries."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Generic, TypeVar

from flexsid.jobs.kind import Kind, Kinds, save_records
from flexsid.jobs.messages import Report
from flexsid.records.excitation import ExcitationDesign
from flexsid.records.flutter import ClosedLoop, FlutterResult, PredictedFlutterResult
from flexsid.records.global_model import GlobalModelResult
from flexsid.records.job import Job
from flexsid.records.modal_data import ModeIdentification
from flexsid.records.quality import ManeuverQuality
from flexsid.records.transfer_function import TransferFunctionResult
from flexsid.records.validation import (
    AerodynamicsComparison,
    CrossPredictionMatrix,
    CrossValidation,
    PosteriorCheck,
)
from flexsid.records.views import Reconstruction
from flexsid.storage import backup, queue
from flexsid.storage.derived_runs import find_derived_runs
from flexsid.storage.runs import ESTIMATION
from flexsid.storage.snapshot import open_snapshot, take_snapshot
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
from flexsid.workflow.global_model import computation, estimates
from flexsid.workflow.importing import flight_import, parsed_files, remembered_columns, uploads
from flexsid.workflow.measurements import reconstruction, transfer_functions
from flexsid.workflow.measurements.sensor_responses import gather_sensors
from flexsid.workflow.modal_data import computed_predictions, ground_vibration_test
from flexsid.workflow.quality import maneuver_quality
from flexsid.workflow.review import database_backup, printed_reports
from flexsid.workflow.runs import estimation
from flexsid.workflow.runs.derived_runs import DerivedFit, renumber, store_derived_fits
from flexsid.workflow.runs.run_identity import list_run_contents
from flexsid.workflow.structure_determination import searches
from flexsid.workflow.validation import (
    aerodynamics_comparison,
    cross_prediction,
    cross_validation,
    posterior_check,
)

Result = TypeVar("Result")


@dataclass(frozen=True, slots=True, kw_only=True)
class EstimationRequest:
    """Empty: the request of an estimation is its run, which has the id of the job."""


@dataclass(frozen=True, slots=True, kw_only=True)
class StructureSearchRequest:
    """The search, which is stored with its result."""

    search_id: int


@dataclass(frozen=True, slots=True, kw_only=True)
class QualityRequest:
    """Maneuver whose data quality is to be assessed."""

    maneuver_id: int


@dataclass(frozen=True, slots=True)
class SnapshotTask:
    """Request with all records that its computation needs."""

    snapshot: bytes
    request: Any


@dataclass(frozen=True, slots=True)
class Derived(Generic[Result]):
    """A result that rests on refits, and those of them that are not stored yet."""

    result: Result
    fits: tuple[DerivedFit, ...]


def _in_snapshot(
    compute: Callable[[Store, Any, Report], Any],
) -> Callable[[SnapshotTask, Report], Any]:
    """Return the computation of a task from that of its request in a store."""
    return lambda task, report: compute(open_snapshot(task.snapshot), task.request, report)


def _of_design(
    compute: Callable[[Store, ExcitationDesign, Any, Report], Any],
) -> Callable[[SnapshotTask, Report], Any]:
    """Return the computation of a task from that of its request with its design."""
    return _in_snapshot(
        lambda store, query, report: compute(
            store, store.designs.get(query.design_id), query, report
        )
    )


def _send_run(store: Store, job: Job, query: Any) -> SnapshotTask:
    return SnapshotTask(take_snapshot(store, run_ids=(query.run_id,)), query)


def _send_maneuver(store: Store, job: Job, query: Any) -> SnapshotTask:
    return SnapshotTask(take_snapshot(store, maneuver_ids=(query.maneuver_id,)), query)


def _send_design(store: Store, job: Job, query: Any) -> SnapshotTask:
    runs = (query.run_id, getattr(query, "other_run_id", None))
    run_ids = tuple(number for number in runs if number is not None)
    return SnapshotTask(take_snapshot(store, (), run_ids, (query.design_id,)), query)


def _send_flutter_runs(store: Store, run_ids: tuple[int, ...], query: object) -> SnapshotTask:
    snapshot = take_snapshot(store, run_ids=(*run_ids, *find_derived_runs(store, run_ids)))
    return SnapshotTask(snapshot, query)


def _compute_flutter(
    store: Store, query: flutter_models.FlutterQuery, report: Report
) -> Derived[FlutterResult]:
    models = flutter_models.fuse_runs(store, query, report)
    return Derived(flutter_analysis.compute_flutter(store, models, report), models.new_fits)


def _store_flutter(
    store: Store, job: Job, outcome: Derived[FlutterResult], worker: str
) -> FlutterResult:
    stored = store_derived_fits(store, outcome.fits, job, worker)
    flutter = outcome.result.flutter
    flutter = replace(flutter, derived_runs=renumber(flutter.derived_runs, stored))
    return replace(outcome.result, flutter=flutter)


def _compute_closed_loop(
    store: Store, query: closed_loop.ClosedLoopQuery, report: Report
) -> Derived[ClosedLoop]:
    models = flutter_models.fuse_runs(store, query.flutter, report)
    found = closed_loop.analyse_closed_loop(store, models, query.controller_id, report)
    return Derived(found, models.new_fits)


def _store_closed_loop(
    store: Store, job: Job, outcome: Derived[ClosedLoop], worker: str
) -> ClosedLoop:
    stored = store_derived_fits(store, outcome.fits, job, worker)
    return replace(outcome.result, derived_runs=renumber(outcome.result.derived_runs, stored))


def _identify_closed_loop(store: Store, query: closed_loop.ClosedLoopQuery) -> tuple[object, ...]:
    closed_loop.refuse_shaped_runs(store, query.flutter.run_ids)
    controller = store.controllers.get(query.controller_id)
    return *flutter_models.identify_query(store, query.flutter), controller


def _store_simulation(
    store: Store, job: Job, outcome: preflight_simulation.SimulatedManeuver, worker: str
) -> dict[str, int | None]:
    request = SIMULATION.read_request(job)
    stored = preflight_simulation.store_simulation(store, request, outcome, job.author)
    return {"simulation_id": stored.id, "run_id": stored.run_id}


def _store_optimal_design(
    store: Store, job: Job, outcome: optimal_designs.FoundDesign, worker: str
) -> optimal_designs.OptimalDesign:
    return replace(outcome.gain, optimal_design_id=store.designs.add(outcome.design).id or 0)


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


def _assess_quality(store: Store, request: QualityRequest, report: Report) -> ManeuverQuality:
    maneuver = store.maneuvers.get(request.maneuver_id)
    content = maneuver_quality.compute_content_hash(store, maneuver)
    return maneuver_quality.assess_maneuver(store, maneuver, content)


def _store_import(
    store: Store, job: Job, outcome: parsed_files.ParsedUpload, worker: str
) -> dict[str, int | None]:
    request = IMPORT.read_request(job)
    stored = flight_import.store_upload(
        store, outcome, request.aircraft_id, confirmed=request.confirmed
    )
    return {
        "maneuver_id": None if stored.maneuver is None else stored.maneuver.id,
        "flight_id": None if stored.flight is None else stored.flight.id,
        "n_channels": len(outcome.channels),
    }


RUN = Kind(
    name=ESTIMATION,
    label="Estimation",
    request=EstimationRequest,
    prepare=lambda store, job, request: estimation.prepare(store, store.runs.get(job.id or 0)),
    compute=estimation.compute_run,
    save=lambda store, job, outcome, worker: estimation.store_result(
        store, job.id or 0, job.attempt, outcome, worker
    ),
)
SEARCH = Kind(
    name=queue.SEARCH,
    label="Model structure search",
    request=StructureSearchRequest,
    prepare=lambda store, job, request: searches.prepare_search(
        store, store.searches.get(request.search_id)
    ),
    compute=searches.compute_search,
    save=lambda store, job, outcome, worker: searches.store_search_result(
        store, SEARCH.read_request(job).search_id, job.attempt, outcome, worker
    ),
)
DESIGN = Kind(
    name="excitation-design",
    label="Excitation design",
    request=excitation_designs.DesignOrder,
    prepare=lambda store, job, request: request,
    compute=excitation_designs.compute_design,
    save=save_records(
        lambda store, job, outcome, worker: {"design_id": store.designs.add(outcome).id}
    ),
)
SIMULATION = Kind(
    name="preflight-simulation",
    label="Pre-flight simulation",
    request=preflight_simulation.SimulationRequest,
    prepare=_send_design,
    compute=_of_design(preflight_simulation.simulate_design),
    save=save_records(_store_simulation),
)
FLUTTER = Kind(
    name="flutter-prediction",
    label="Flutter prediction",
    request=flutter_models.FlutterQuery,
    prepare=lambda store, job, query: _send_flutter_runs(store, query.run_ids, query),
    compute=_in_snapshot(_compute_flutter),
    save=save_records(_store_flutter),
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
    prepare=lambda store, job, query: _send_flutter_runs(store, query.flutter.run_ids, query),
    compute=_in_snapshot(_compute_closed_loop),
    save=save_records(_store_closed_loop),
    result=ClosedLoop,
    identify=_identify_closed_loop,
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
    prepare=lambda store, job, query: SnapshotTask(
        take_snapshot(store, cross_prediction.list_maneuver_ids(store, query), query.run_ids), query
    ),
    compute=_in_snapshot(cross_prediction.compute_cross_predictions),
    result=CrossPredictionMatrix,
    identify=cross_prediction.identify_cross_prediction,
)
CROSS_VALIDATION = Kind(
    name="cross-validation",
    label="Cross-validation",
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
    compute=_of_design(
        lambda store, design, query, report: predicted_accuracy.predict_accuracy(
            store, design, query.run_id, query.level
        )
    ),
    result=predicted_accuracy.PredictedAccuracy,
    identify=predicted_accuracy.identify_design_query,
)
INPUT_COMPARISON = Kind(
    name="input-comparison",
    label="Comparison with classic inputs",
    request=predicted_accuracy.DesignQuery,
    prepare=_send_design,
    compute=_of_design(
        lambda store, design, query, report: classic_inputs.compare_inputs(
            store, design, query.run_id, query.level
        )
    ),
    result=classic_inputs.InputComparison,
    identify=predicted_accuracy.identify_design_query,
)
AMPLITUDES = Kind(
    name="amplitude-optimisation",
    label="Amplitude optimisation",
    request=amplitude_optimisation.AmplitudeQuery,
    prepare=_send_design,
    compute=_of_design(
        lambda store, design, query, report: amplitude_optimisation.optimise_amplitudes(
            store, design, query.run_id, query.level, query.deflection, query.load_factor
        )
    ),
    result=amplitude_optimisation.OptimisedAmplitudes,
    identify=predicted_accuracy.identify_design_query,
)
OPTIMAL_DESIGN = Kind(
    name="optimal-design",
    label="Optimal design",
    request=optimal_designs.OptimalDesignQuery,
    prepare=_send_design,
    compute=_of_design(optimal_designs.compute_optimal_design),
    save=save_records(_store_optimal_design),
    result=optimal_designs.OptimalDesign,
    identify=optimal_designs.identify_optimal_design,
)
RECONSTRUCTION = Kind(
    name="motion-reconstruction",
    label="Motion reconstruction",
    request=reconstruction.ReconstructionQuery,
    prepare=_send_maneuver,
    compute=_in_snapshot(lambda store, query, report: reconstruction.reconstruct(store, query)),
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
MODES = Kind(
    name="mode-identification",
    label="Mode identification",
    request=ground_vibration_test.ModeSearch,
    prepare=lambda store, job, search: ground_vibration_test.prepare_mode_search(store, search),
    compute=lambda task, report: ground_vibration_test.find_modes(task),
    result=ModeIdentification,
    identify=ground_vibration_test.identify_mode_search,
)
QUALITY = Kind(
    name="quality-assessment",
    label="Quality assessment",
    request=QualityRequest,
    prepare=_send_maneuver,
    compute=_in_snapshot(_assess_quality),
    save=save_records(
        lambda store, job, outcome, worker: {
            "verdict": maneuver_quality.store_quality(store, outcome).verdict.value
        }
    ),
    priority=-1,  # analysts wait for the others
)
PREDICTION = Kind(
    name="derivative-prediction",
    label="Derivative prediction",
    request=computed_predictions.PredictionRequest,
    prepare=lambda store, job, request: computed_predictions.prepare_prediction(store, request),
    compute=computed_predictions.compute_prediction,
    save=save_records(
        lambda store, job, outcome, worker: {
            "prediction_id": computed_predictions.store_computed_prediction(store, outcome).id
        }
    ),
)
IMPORT = Kind(
    name=remembered_columns.IMPORT_KIND,
    label="Import",
    request=uploads.ImportRequest,
    prepare=lambda store, job, request: uploads.prepare_import(store, request),
    compute=lambda task, report: uploads.compute_import(task),
    save=save_records(_store_import),
)
REPORT = Kind(
    name="report",
    label="Report",
    request=printed_reports.ReportRequest,
    prepare=printed_reports.prepare_printing,
    compute=printed_reports.print_report,
    save=save_records(
        lambda store, job, outcome, worker: printed_reports.store_printed_report(
            store, REPORT.read_request(job), outcome
        )
    ),
    result=printed_reports.PrintedReport,
    identify=lambda store, request: (),  # the document is named by its content
)
BACKUP = Kind(
    name=backup.BACKUP,
    label="Backup",
    request=database_backup.BackupRequest,
    prepare=database_backup.prepare_backup,
    compute=database_backup.compute_backup,
    result=database_backup.BackupFile,
)

# All values above, so that a kind is added in one place.
KINDS: Kinds = {one.name: one for one in tuple(globals().values()) if isinstance(one, Kind)}


def load_kinds() -> Kinds:
    """Return all kinds by name; a worker receives this function and imports this module."""
    return KINDS
