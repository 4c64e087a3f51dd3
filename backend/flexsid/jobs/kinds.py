"""All kinds of jobs. A worker imports this module, and with it the numerical libraries."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Generic, TypeVar

from flexsid.jobs.kind import Kind, Kinds, save_result
from flexsid.jobs.worker import Report
from flexsid.records.excitation import ExcitationDesign
from flexsid.records.flutter import ClosedLoop, FlutterResult, PredictedFlutterResult
from flexsid.records.global_model import GlobalModelResult
from flexsid.records.job import Job
from flexsid.records.modal_data import ModeIdentification
from flexsid.records.quality import ManeuverQuality
from flexsid.records.validation import (
    AerodynamicsComparison,
    CrossPredictionMatrix,
    CrossValidation,
    PosteriorCheck,
)
from flexsid.records.views import Reconstruction
from flexsid.storage import backup as copies
from flexsid.storage import queue
from flexsid.storage.derived_runs import find_derived_runs
from flexsid.storage.runs import ESTIMATION
from flexsid.storage.snapshot import open_snapshot, take_snapshot
from flexsid.storage.store import Store
from flexsid.workflow.excitation.amplitude_optimisation import (
    AmplitudeQuery,
    OptimisedAmplitudes,
    optimise_amplitudes,
)
from flexsid.workflow.excitation.classic_inputs import InputComparison, compare_inputs
from flexsid.workflow.excitation.excitation_designs import DesignOrder, compute_design
from flexsid.workflow.excitation.optimal_designs import (
    FoundDesign,
    OptimalDesign,
    OptimalDesignQuery,
    compute_optimal_design,
    identify_optimal_design,
)
from flexsid.workflow.excitation.predicted_accuracy import (
    DesignQuery,
    PredictedAccuracy,
    identify_design_query,
    predict_accuracy,
)
from flexsid.workflow.excitation.preflight_simulation import (
    SimulatedManeuver,
    SimulationRequest,
    simulate_design,
    store_simulation,
)
from flexsid.workflow.flutter.closed_loop import (
    ClosedLoopQuery,
    analyse_closed_loop,
    refuse_shaped_runs,
)
from flexsid.workflow.flutter.flutter_analysis import FlutterQuery, compute_flutter
from flexsid.workflow.flutter.flutter_models import fuse_runs, identify_query
from flexsid.workflow.flutter.predicted_flutter import (
    PredictedFlutterQuery,
    compute_predicted_flutter,
    identify_predicted_flutter,
    prepare_predicted_flutter,
)
from flexsid.workflow.global_model.computation import compute_global_model
from flexsid.workflow.global_model.estimates import (
    GlobalModelQuery,
    identify_global_model,
    prepare_global_model,
)
from flexsid.workflow.importing.flight_import import store_upload
from flexsid.workflow.importing.parsed_files import ParsedUpload
from flexsid.workflow.importing.remembered_columns import IMPORT_KIND
from flexsid.workflow.importing.uploads import ImportRequest, compute_import, prepare_import
from flexsid.workflow.measurements.reconstruction import ReconstructionQuery, reconstruct
from flexsid.workflow.measurements.sensor_responses import gather_sensors
from flexsid.workflow.modal_data.computed_predictions import (
    ComputedPrediction,
    PredictionRequest,
    compute_prediction,
    prepare_prediction,
    store_computed_prediction,
)
from flexsid.workflow.modal_data.ground_vibration_test import (
    ModeSearch,
    find_modes,
    identify_mode_search,
    prepare_mode_search,
)
from flexsid.workflow.quality.maneuver_quality import (
    assess_maneuver,
    compute_content_hash,
    store_quality,
)
from flexsid.workflow.review.database_backup import (
    BackupFile,
    BackupRequest,
    compute_backup,
    prepare_backup,
)
from flexsid.workflow.review.printed_reports import (
    PrintedReport,
    PrintingTask,
    ReportRequest,
    prepare_printing,
    print_report,
    store_printed_report,
)
from flexsid.workflow.runs import estimation
from flexsid.workflow.runs.derived_runs import DerivedFit, renumber, store_derived_fits
from flexsid.workflow.runs.run_identity import list_run_contents
from flexsid.workflow.structure_determination import searches
from flexsid.workflow.validation.aerodynamics_comparison import (
    AerodynamicsQuery,
    compare_aerodynamics,
    identify_aerodynamics,
)
from flexsid.workflow.validation.cross_prediction import (
    CrossPredictionQuery,
    compute_cross_predictions,
    identify_cross_prediction,
    list_maneuver_ids,
)
from flexsid.workflow.validation.cross_validation import (
    CrossValidationQuery,
    cross_validate,
    identify_cross_validation,
)
from flexsid.workflow.validation.posterior_check import (
    PosteriorQuery,
    check_posterior,
    identify_posterior,
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
    design: ExcitationDesign | None = None

    def open(self) -> Store:
        """Return the store of the records."""
        return open_snapshot(self.snapshot)

    def open_design(self) -> tuple[Store, ExcitationDesign, int, int]:
        """Return store, design, run and amplitude level of a design query."""
        assert self.design is not None
        return self.open(), self.design, self.request.run_id, self.request.level


def _id(job: Job) -> int:
    assert job.id is not None
    return job.id


@dataclass(frozen=True, slots=True)
class Derived(Generic[Result]):
    """A result that rests on refits, and those of them that are not stored yet."""

    result: Result
    fits: tuple[DerivedFit, ...]


def _prepare_prediction(store: Store, run_ids: tuple[int, ...], request: object) -> SnapshotTask:
    snapshot = take_snapshot(store, run_ids=(*run_ids, *find_derived_runs(store, run_ids)))
    return SnapshotTask(snapshot, request)


def _compute_flutter(task: SnapshotTask, report: Report) -> Derived[FlutterResult]:
    store = task.open()
    models = fuse_runs(store, task.request, report)
    return Derived(compute_flutter(store, models, report), models.new_fits)


def _compute_closed_loop(task: SnapshotTask, report: Report) -> Derived[ClosedLoop]:
    store, query = task.open(), task.request
    models = fuse_runs(store, query.flutter, report)
    found = analyse_closed_loop(store, models, query.controller_id, report)
    return Derived(found, models.new_fits)


def _save_flutter(store: Store, job: Job, outcome: Derived[FlutterResult], worker: str) -> None:
    with store.transaction():
        stored = store_derived_fits(store, outcome.fits, job, worker)
        flutter = outcome.result.flutter
        flutter = replace(flutter, derived_runs=renumber(flutter.derived_runs, stored))
        save_result(store, job, replace(outcome.result, flutter=flutter), worker)


def _save_closed_loop(store: Store, job: Job, outcome: Derived[ClosedLoop], worker: str) -> None:
    with store.transaction():
        stored = store_derived_fits(store, outcome.fits, job, worker)
        derived_runs = renumber(outcome.result.derived_runs, stored)
        save_result(store, job, replace(outcome.result, derived_runs=derived_runs), worker)


def _compute_simulation(task: SnapshotTask, report: Report) -> SimulatedManeuver:
    assert task.design is not None
    return simulate_design(task.open(), task.design, task.request, report)


def _save_simulation(store: Store, job: Job, outcome: SimulatedManeuver, worker: str) -> None:
    with store.transaction():
        stored = store_simulation(store, SIMULATION.read_request(job), outcome, job.author)
        save_result(store, job, {"simulation_id": stored.id, "run_id": stored.run_id}, worker)


def _save_design(store: Store, job: Job, outcome: ExcitationDesign, worker: str) -> None:
    with store.transaction():
        save_result(store, job, {"design_id": store.designs.add(outcome).id}, worker)


def _prepare_optimal_design(store: Store, job: Job, query: OptimalDesignQuery) -> SnapshotTask:
    other = () if query.other_run_id is None else (query.other_run_id,)
    snapshot = take_snapshot(store, run_ids=(query.run_id, *other))
    return SnapshotTask(snapshot, query, store.designs.get(query.design_id))


def _compute_optimal_design(task: SnapshotTask, report: Report) -> FoundDesign:
    assert task.design is not None
    return compute_optimal_design(task.open(), task.design, task.request, report)


def _save_optimal_design(store: Store, job: Job, outcome: FoundDesign, worker: str) -> None:
    with store.transaction():
        stored = store.designs.add(outcome.design)
        save_result(store, job, replace(outcome.gain, optimal_design_id=stored.id or 0), worker)


def _prepare_design_query(
    store: Store, job: Job, query: DesignQuery | SimulationRequest
) -> SnapshotTask:
    snapshot = take_snapshot(store, run_ids=(query.run_id,))
    return SnapshotTask(snapshot, query, store.designs.get(query.design_id))


def _identify_closed_loop(store: Store, query: ClosedLoopQuery) -> tuple[object, ...]:
    refuse_shaped_runs(store, query.flutter.run_ids)
    return *identify_query(store, query.flutter), store.controllers.get(query.controller_id)


def _identify_reconstruction(store: Store, query: ReconstructionQuery) -> tuple[object, ...]:
    maneuver = store.maneuvers.get(query.maneuver_id)
    gather_sensors(store, maneuver, query.axis)  # refused at once, not as a job
    return list_run_contents(store, (), (query.maneuver_id,))


def _compute_quality(task: SnapshotTask, report: Report) -> ManeuverQuality:
    store = task.open()
    maneuver = store.maneuvers.get(task.request.maneuver_id)
    return assess_maneuver(store, maneuver, compute_content_hash(store, maneuver))


def _save_quality(store: Store, job: Job, outcome: ManeuverQuality, worker: str) -> None:
    with store.transaction():
        stored = store_quality(store, outcome)
        save_result(store, job, {"verdict": stored.verdict.value}, worker)


def _save_prediction(store: Store, job: Job, outcome: ComputedPrediction, worker: str) -> None:
    with store.transaction():
        stored = store_computed_prediction(store, outcome)
        save_result(store, job, {"prediction_id": stored.id}, worker)


def _save_import(store: Store, job: Job, outcome: ParsedUpload, worker: str) -> None:
    request = IMPORT.read_request(job)
    with store.transaction():
        stored = store_upload(store, outcome, request.aircraft_id, confirmed=request.confirmed)
        result = {
            "maneuver_id": None if stored.maneuver is None else stored.maneuver.id,
            "flight_id": None if stored.flight is None else stored.flight.id,
            "n_channels": len(outcome.channels),
        }
        save_result(store, job, result, worker)


def _prepare_report(store: Store, job: Job, request: ReportRequest) -> PrintingTask:
    assert job.created_at is not None
    return prepare_printing(store, request, job.created_at)


def _save_report(store: Store, job: Job, outcome: bytes, worker: str) -> None:
    with store.transaction():
        stored = store_printed_report(store, REPORT.read_request(job), outcome)
        save_result(store, job, stored, worker)


RUN = Kind(
    name=ESTIMATION,
    label="Estimation",
    request=EstimationRequest,
    prepare=lambda store, job, request: estimation.prepare(store, store.runs.get(_id(job))),
    compute=estimation.compute_run,
    save=lambda store, job, outcome, worker: estimation.store_result(
        store, _id(job), job.attempt, outcome, worker
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
    request=DesignOrder,
    prepare=lambda store, job, request: request,
    compute=compute_design,
    save=_save_design,
)
SIMULATION = Kind(
    name="preflight-simulation",
    label="Pre-flight simulation",
    request=SimulationRequest,
    prepare=_prepare_design_query,
    compute=_compute_simulation,
    save=_save_simulation,
)
FLUTTER = Kind(
    name="flutter-prediction",
    label="Flutter prediction",
    request=FlutterQuery,
    prepare=lambda store, job, query: _prepare_prediction(store, query.run_ids, query),
    compute=_compute_flutter,
    save=_save_flutter,
    result=FlutterResult,
    identify=identify_query,
)
PREDICTED_FLUTTER = Kind(
    name="predicted-flutter",
    label="Flutter of a prediction",
    request=PredictedFlutterQuery,
    prepare=lambda store, job, query: prepare_predicted_flutter(store, query),
    compute=compute_predicted_flutter,
    result=PredictedFlutterResult,
    identify=identify_predicted_flutter,
)
CLOSED_LOOP = Kind(
    name="closed-loop",
    label="Closed-loop stability",
    request=ClosedLoopQuery,
    prepare=lambda store, job, query: _prepare_prediction(store, query.flutter.run_ids, query),
    compute=_compute_closed_loop,
    save=_save_closed_loop,
    result=ClosedLoop,
    identify=_identify_closed_loop,
)
GLOBAL_MODEL = Kind(
    name="global-model",
    label="Global model",
    request=GlobalModelQuery,
    prepare=lambda store, job, query: prepare_global_model(store, query),
    compute=compute_global_model,
    result=GlobalModelResult,
    identify=identify_global_model,
)
CROSS_PREDICTION = Kind(
    name="cross-prediction",
    label="Cross-prediction",
    request=CrossPredictionQuery,
    prepare=lambda store, job, query: SnapshotTask(
        take_snapshot(store, list_maneuver_ids(store, query), query.run_ids), query
    ),
    compute=lambda task, report: compute_cross_predictions(task.open(), task.request, report),
    result=CrossPredictionMatrix,
    identify=identify_cross_prediction,
)
CROSS_VALIDATION = Kind(
    name="cross-validation",
    label="Cross-validation",
    request=CrossValidationQuery,
    prepare=lambda store, job, query: SnapshotTask(
        take_snapshot(store, run_ids=(query.run_id,)), query
    ),
    compute=lambda task, report: cross_validate(task.open(), task.request, report),
    result=CrossValidation,
    identify=identify_cross_validation,
)
AERODYNAMICS = Kind(
    name="aerodynamics-comparison",
    label="Comparison of aerodynamics",
    request=AerodynamicsQuery,
    prepare=lambda store, job, query: SnapshotTask(
        take_snapshot(store, run_ids=(query.run_id,)), query
    ),
    compute=lambda task, report: compare_aerodynamics(task.open(), task.request, report),
    result=AerodynamicsComparison,
    identify=identify_aerodynamics,
)
POSTERIOR = Kind(
    name="posterior-check",
    label="Posterior check",
    request=PosteriorQuery,
    prepare=lambda store, job, query: SnapshotTask(
        take_snapshot(store, run_ids=(query.run_id,)), query
    ),
    compute=lambda task, report: check_posterior(task.open(), task.request, report),
    result=PosteriorCheck,
    identify=identify_posterior,
)
PREDICTED_ACCURACY = Kind(
    name="predicted-accuracy",
    label="Predicted accuracy",
    request=DesignQuery,
    prepare=_prepare_design_query,
    compute=lambda task, report: predict_accuracy(*task.open_design()),
    result=PredictedAccuracy,
    identify=identify_design_query,
)
INPUT_COMPARISON = Kind(
    name="input-comparison",
    label="Comparison with classic inputs",
    request=DesignQuery,
    prepare=_prepare_design_query,
    compute=lambda task, report: compare_inputs(*task.open_design()),
    result=InputComparison,
    identify=identify_design_query,
)
AMPLITUDES = Kind(
    name="amplitude-optimisation",
    label="Amplitude optimisation",
    request=AmplitudeQuery,
    prepare=_prepare_design_query,
    compute=lambda task, report: optimise_amplitudes(
        *task.open_design(),
        deflection=task.request.deflection,
        load_factor=task.request.load_factor,
    ),
    result=OptimisedAmplitudes,
    identify=identify_design_query,
)
OPTIMAL_DESIGN = Kind(
    name="optimal-design",
    label="Optimal design",
    request=OptimalDesignQuery,
    prepare=_prepare_optimal_design,
    compute=_compute_optimal_design,
    save=_save_optimal_design,
    result=OptimalDesign,
    identify=identify_optimal_design,
)
RECONSTRUCTION = Kind(
    name="motion-reconstruction",
    label="Motion reconstruction",
    request=ReconstructionQuery,
    prepare=lambda store, job, query: SnapshotTask(
        take_snapshot(store, maneuver_ids=(query.maneuver_id,)), query
    ),
    compute=lambda task, report: reconstruct(task.open(), task.request),
    result=Reconstruction,
    identify=_identify_reconstruction,
)
MODES = Kind(
    name="mode-identification",
    label="Mode identification",
    request=ModeSearch,
    prepare=lambda store, job, search: prepare_mode_search(store, search),
    compute=lambda task, report: find_modes(task),
    result=ModeIdentification,
    identify=identify_mode_search,
)
QUALITY = Kind(
    name="quality-assessment",
    label="Quality assessment",
    request=QualityRequest,
    prepare=lambda store, job, request: SnapshotTask(
        take_snapshot(store, maneuver_ids=(request.maneuver_id,)), request
    ),
    compute=_compute_quality,
    save=_save_quality,
    priority=-1,  # analysts wait for the others
)

PREDICTION = Kind(
    name="derivative-prediction",
    label="Derivative prediction",
    request=PredictionRequest,
    prepare=lambda store, job, request: prepare_prediction(store, request),
    compute=compute_prediction,
    save=_save_prediction,
)
IMPORT = Kind(
    name=IMPORT_KIND,
    label="Import",
    request=ImportRequest,
    prepare=lambda store, job, request: prepare_import(store, request),
    compute=lambda task, report: compute_import(task),
    save=_save_import,
)
REPORT = Kind(
    name="report",
    label="Report",
    request=ReportRequest,
    prepare=_prepare_report,
    compute=print_report,
    save=_save_report,
    result=PrintedReport,
    identify=lambda store, request: (),  # the document is named by its content
)
BACKUP = Kind(
    name=copies.BACKUP,
    label="Backup",
    request=BackupRequest,
    prepare=lambda store, job, request: prepare_backup(store, job),
    compute=compute_backup,
    result=BackupFile,
)

KINDS: Kinds = {
    kind.name: kind
    for kind in (
        RUN,
        SEARCH,
        DESIGN,
        SIMULATION,
        FLUTTER,
        PREDICTED_FLUTTER,
        CLOSED_LOOP,
        GLOBAL_MODEL,
        CROSS_PREDICTION,
        CROSS_VALIDATION,
        AERODYNAMICS,
        POSTERIOR,
        PREDICTED_ACCURACY,
        INPUT_COMPARISON,
        AMPLITUDES,
        OPTIMAL_DESIGN,
        RECONSTRUCTION,
        MODES,
        QUALITY,
        PREDICTION,
        IMPORT,
        REPORT,
        BACKUP,
    )
}


def load_kinds() -> Kinds:
    """Return all kinds by name; a worker receives this function and imports this module."""
    return KINDS
