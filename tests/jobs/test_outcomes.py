"""The result of every kind of job is stored once, whatever attempts were lost before."""

from __future__ import annotations

import pickle
import re
from collections.abc import Callable, Iterator
from dataclasses import fields, make_dataclass, replace
from pathlib import Path
from typing import Any, get_type_hints

import numpy as np
import pytest
import sqlalchemy as sa

from flexsid.demo.flex28 import load_truth
from flexsid.demo.sources import build_measured_responses
from flexsid.errors import Conflict
from flexsid.importers.responses import AveragingOptions, ResponseOptions
from flexsid.jobs import kinds
from flexsid.jobs.dispatcher import execute_run
from flexsid.jobs.kind import Kind, build_job, save_result, submit
from flexsid.records.decision import Structure
from flexsid.records.job import Job
from flexsid.records.run import EstimationRun, Method, RunSettings, RunState
from flexsid.records.search import SearchSettings, StructureSearch
from flexsid.storage.database import sqlite_file
from flexsid.storage.jobs import queue
from flexsid.storage.store import Store
from flexsid.storage.tables import metadata
from flexsid.workflow.excitation.amplitude_optimisation import AmplitudeQuery
from flexsid.workflow.excitation.excitation_designs import (
    DesignOrder,
    compute_design,
    specify_design,
)
from flexsid.workflow.excitation.optimal_designs import Objective, OptimalDesignQuery
from flexsid.workflow.excitation.predicted_accuracy import DesignQuery
from flexsid.workflow.excitation.preflight_simulation import SimulationRequest
from flexsid.workflow.flutter.closed_loop import ClosedLoopQuery
from flexsid.workflow.flutter.flutter_models import FlutterQuery
from flexsid.workflow.flutter.predicted_flutter import PredictedFlutterQuery
from flexsid.workflow.global_model.estimates import GlobalModelQuery
from flexsid.workflow.importing.uploads import ImportRequest, add_upload
from flexsid.workflow.maintenance.database import BackupRequest, check_database
from flexsid.workflow.maintenance.printed_reports import ReportRequest, describe_document
from flexsid.workflow.measurements.grey_box_fits import GreyBoxQuery
from flexsid.workflow.measurements.output_only_modes import OutputOnlyQuery
from flexsid.workflow.measurements.reconstruction import ReconstructionQuery
from flexsid.workflow.measurements.transfer_functions import TransferFunctionQuery
from flexsid.workflow.modal_data.computed_predictions import PlanformPanel, PredictionRequest
from flexsid.workflow.modal_data.ground_vibration_test import ModeSearch, ResponseEstimation
from flexsid.workflow.modal_data.orthogonality import OrthogonalityComputation, OrthogonalityQuery
from flexsid.workflow.quality.maneuver_quality import QualityRequest
from flexsid.workflow.structure_determination.searches import add_search
from flexsid.workflow.validation.cross_prediction import CrossPredictionQuery
from flexsid.workflow.validation.cross_validation import CrossValidationQuery
from flexsid.workflow.validation.posterior_check import PosteriorQuery

_STRUCTURE = Structure(modes=(7, 9), fixed={})
# The attempts, log and lease of a job change whether its result is stored or not.
_OF_THE_QUEUE = {"jobs", "job_events", "leases"}
_SHORT = ("import", "quality-assessment", "mode-identification", "response-estimation")
MAPPING = """
[aircraft]
name = "FLEX-28"
[flight]
number = 7
[time]
column = "t_s"
[[channels]]
column = "q"
unit = "deg/s"
role = "output"
"""


@pytest.fixture
def flown(flown_url: str) -> Iterator[Store]:
    opened = Store.open(flown_url)
    yield opened
    opened.close()


def _add_run(store: Store) -> Job:
    run = EstimationRun(
        maneuver_id=1, method=Method.EE, structure=_STRUCTURE, settings=RunSettings()
    )
    return store.jobs.get(queue.add(store, run).id or 0)


def _add_search(store: Store) -> Job:
    search = StructureSearch(
        aircraft_id=1,
        maneuver_ids=(1,),
        method=Method.EE,
        structure=_STRUCTURE,
        settings=SearchSettings(resamplings=0),
    )
    return store.jobs.get(add_search(store, search).job_id or 0)


def _order_design() -> DesignOrder:
    peak = float(np.deg2rad(1.0))
    specification = specify_design(503, 24.0, 100.0, 6, (peak, 2 * peak, 4 * peak), "quick")
    return DesignOrder(name="FTA 503", specification=specification, fta=503)


def _query_design(store: Store) -> DesignQuery:
    """A design for a run of output error, both stored now."""
    run = EstimationRun(
        maneuver_id=1, method=Method.OE, structure=_STRUCTURE, settings=RunSettings()
    )
    estimated = execute_run(store, run, kinds.RUN, lambda progress: None)
    design = store.designs.add(compute_design(_order_design(), lambda progress: None))
    return DesignQuery(design_id=design.id or 0, run_id=estimated.id or 0, level=1)


def _check_posterior(store: Store) -> Job:
    run_id = _query_design(store).run_id or 0
    return submit(store, kinds.POSTERIOR, PosteriorQuery(run_id=run_id))


def _simulate(store: Store) -> Job:
    query = _query_design(store)
    request = SimulationRequest(design_id=query.design_id, run_id=query.run_id, level=1)
    return submit(store, kinds.SIMULATION, request)


def _optimise_amplitudes(store: Store) -> Job:
    query = _query_design(store)
    request = AmplitudeQuery(design_id=query.design_id, run_id=query.run_id, level=1)
    return submit(store, kinds.AMPLITUDES, request)


def _optimise_design(store: Store) -> Job:
    query = _query_design(store)
    request = OptimalDesignQuery(
        design_id=query.design_id,
        run_id=query.run_id,
        objective=Objective.DERIVATIVES,
        derivatives=("Cm_alpha",),
    )
    return submit(store, kinds.OPTIMAL_DESIGN, request)


def _print_report(store: Store, folder: Path) -> Job:
    row = describe_document("<h1>Run 1</h1>")
    store.arrays.put_many([row])
    request = ReportRequest(name="run-1", document=row["hash"])
    return submit(store, kinds.REPORT, request)


def _identify_modes(store: Store) -> Job:
    responses = build_measured_responses(load_truth(), 1, store.arrays.put)
    number = store.measured_responses.add(responses).id or 0
    request = ModeSearch(responses_id=number, low_hz=2.0, high_hz=6.0, order=8)
    return submit(store, kinds.MODES, request)


def _estimate_responses(store: Store, folder: Path) -> Job:
    file = folder / "run.csv"
    force = np.random.default_rng(1).normal(size=400)
    rows = (f"{k / 50:.2f},{f:.6f},{2 * f:.6f}\n" for k, f in enumerate(force))
    file.write_text("time [s],force 1+z [N],1+z [m/s2]\n" + "".join(rows))
    request = ResponseEstimation(
        upload_id=add_upload(store, [file], [file.name]).id,
        aircraft_id=1,
        options=ResponseOptions(name="GVT"),
        averaging=AveragingOptions(averages=8),
    )
    return submit(store, kinds.RESPONSES, request)


_OWN_MODEL = """
from flexsid.sysid import GreyBox, GreyBoxParameter as Parameter
def pitch(p, condition):
    A = [[0.0, 1.0], [-p["stiffness"], -p["damping"]]]
    return A, [[p["lag"]], [p["moment"]]], [[0.0, 1.0]], [[0.0]]
MODEL = GreyBox(title="Pitch", matrices=pitch, inputs={"wf4s": "rad"}, outputs={"q": "rad/s"},
    parameters=[Parameter("stiffness", 150.0), Parameter("damping", 15.0),
                Parameter("lag", 0.0), Parameter("moment", -10.0)])
"""


def _compute_orthogonality(store: Store, folder: Path) -> Job:
    file = folder / "mass.npz"
    np.savez(file, mass=np.eye(399))
    request = OrthogonalityComputation(
        upload_id=add_upload(store, [file], [file.name]).id,
        query=OrthogonalityQuery(modal_table_id=1, mass="mass"),
    )
    return submit(store, kinds.ORTHOGONALITY, request)


def _predict_derivatives(store: Store) -> Job:
    panel = PlanformPanel(
        left=(0.0, 0.0, 0.0),
        left_chord=1.0,
        right=(0.5, 4.0, 0.0),
        right_chord=0.5,
        chordwise=2,
        spanwise=3,
    )
    request = PredictionRequest(aircraft_id=1, source="lattice", panels=(panel,))
    return submit(store, kinds.PREDICTION, request)


def _import_files(store: Store, folder: Path) -> Job:
    file = folder / "record.csv"
    file.write_text("t_s,q\n" + "".join(f"{k / 50:.2f},{k % 7}\n" for k in range(100)))
    upload = add_upload(store, [file], [file.name])
    return submit(store, kinds.IMPORT, ImportRequest(upload_id=upload.id, mapping=MAPPING))


def _fit_global_model(store: Store) -> Job:
    """Equation error of one maneuver in four bands."""
    runs = [
        EstimationRun(
            maneuver_id=1,
            method=Method.EE,
            structure=_STRUCTURE,
            settings=RunSettings(band_hz=(0.3, highest)),
        )
        for highest in (10.0, 11.0, 12.0, 13.0)
    ]
    stored = [execute_run(store, run, kinds.RUN, lambda progress: None) for run in runs]
    return submit(
        store, kinds.GLOBAL_MODEL, GlobalModelQuery(run_ids=tuple(run.id or 0 for run in stored))
    )


_FLUTTER = FlutterQuery(run_ids=(1,))
_REQUESTS: dict[str, Callable[[Store, Path], Job]] = {
    kinds.RUN.name: lambda store, folder: _add_run(store),
    kinds.SEARCH.name: lambda store, folder: _add_search(store),
    kinds.DESIGN.name: lambda store, folder: submit(store, kinds.DESIGN, _order_design()),
    kinds.SIMULATION.name: lambda store, folder: _simulate(store),
    kinds.FLUTTER.name: lambda store, folder: submit(store, kinds.FLUTTER, _FLUTTER),
    kinds.CLOSED_LOOP.name: lambda store, folder: submit(
        store, kinds.CLOSED_LOOP, ClosedLoopQuery(flutter=_FLUTTER, controller_id=1)
    ),
    kinds.CROSS_PREDICTION.name: lambda store, folder: submit(
        store, kinds.CROSS_PREDICTION, CrossPredictionQuery(run_ids=(1,))
    ),
    kinds.CROSS_VALIDATION.name: lambda store, folder: submit(
        store, kinds.CROSS_VALIDATION, CrossValidationQuery(run_id=1, folds=2)
    ),
    kinds.TRANSFER_FUNCTION.name: lambda store, folder: submit(
        store,
        kinds.TRANSFER_FUNCTION,
        TransferFunctionQuery(maneuver_id=1, input="wf4s", output="q"),
    ),
    kinds.OUTPUT_ONLY_MODES.name: lambda store, folder: submit(
        store, kinds.OUTPUT_ONLY_MODES, OutputOnlyQuery(maneuver_id=1, low_hz=3.0, high_hz=12.0)
    ),
    kinds.GREY_BOX.name: lambda store, folder: submit(
        store,
        kinds.GREY_BOX,
        GreyBoxQuery(maneuver_id=1, model="own.py", source=_OWN_MODEL, low_hz=0.5, high_hz=3.0),
    ),
    kinds.POSTERIOR.name: lambda store, folder: _check_posterior(store),
    kinds.PREDICTED_ACCURACY.name: lambda store, folder: submit(
        store, kinds.PREDICTED_ACCURACY, _query_design(store)
    ),
    kinds.INPUT_COMPARISON.name: lambda store, folder: submit(
        store, kinds.INPUT_COMPARISON, _query_design(store)
    ),
    kinds.AMPLITUDES.name: lambda store, folder: _optimise_amplitudes(store),
    kinds.OPTIMAL_DESIGN.name: lambda store, folder: _optimise_design(store),
    kinds.RECONSTRUCTION.name: lambda store, folder: submit(
        store, kinds.RECONSTRUCTION, ReconstructionQuery(maneuver_id=1, modes=(7, 9))
    ),
    kinds.RESPONSES.name: _estimate_responses,
    kinds.ORTHOGONALITY.name: _compute_orthogonality,
    kinds.MODES.name: lambda store, folder: _identify_modes(store),
    kinds.QUALITY.name: lambda store, folder: submit(
        store, kinds.QUALITY, QualityRequest(maneuver_id=1)
    ),
    kinds.PREDICTION.name: lambda store, folder: _predict_derivatives(store),
    kinds.IMPORT.name: _import_files,
    kinds.REPORT.name: _print_report,
    kinds.BACKUP.name: lambda store, folder: submit(store, kinds.BACKUP, BackupRequest()),
    kinds.PREDICTED_FLUTTER.name: lambda store, folder: submit(
        store, kinds.PREDICTED_FLUTTER, PredictedFlutterQuery(prediction_id=1)
    ),
    kinds.GLOBAL_MODEL.name: lambda store, folder: _fit_global_model(store),
}


def test_a_result_of_an_earlier_form_is_not_that_of_a_request(flown: Store) -> None:
    """Such a result lacks a field, so that it cannot be read."""
    query = TransferFunctionQuery(maneuver_id=1, input="wf4s", output="q")
    kind = kinds.TRANSFER_FUNCTION
    earlier = replace(kind, result=make_dataclass("Earlier", [("n_zeros", int)]))
    request_hash = build_job(flown, kind, query).request_hash
    assert request_hash == build_job(flown, kind, query).request_hash
    assert request_hash != build_job(flown, earlier, query).request_hash


def test_every_kind_that_saves_records_is_tested() -> None:
    own = {name for name, kind in kinds.KINDS.items() if kind.save is not save_result}
    assert own <= _REQUESTS.keys()


@pytest.mark.parametrize("kind", kinds.KINDS.values(), ids=lambda one: one.name)
def test_a_page_has_only_values_of_request_and_result(kind: Kind[Any, Any]) -> None:
    for name in re.findall(r"{([^}:]*)", kind.page):
        owner, _, rest = name.rpartition(".")
        if name == "id" or owner == "result":
            continue  # of results, ids of stored records
        within = get_type_hints(kind.request)[owner] if owner else kind.request
        assert rest in {one.name for one in fields(within)}, name


@pytest.mark.parametrize(
    "name",
    [pytest.param(n, marks=() if n in _SHORT else pytest.mark.long) for n in sorted(_REQUESTS)],
)
def test_a_result_is_stored_once_by_the_last_attempt(
    flown: Store, tmp_path: Path, name: str
) -> None:
    kind = kinds.KINDS[name]
    if kind is kinds.BACKUP and sqlite_file(flown.database.url) is None:
        pytest.skip("the server backs up databases of SQLite only")
    requested = _REQUESTS[name](flown, tmp_path)
    first = queue.claim(flown, requested.id)
    assert first is not None
    request = kind.read_request(first)
    task = pickle.loads(pickle.dumps(kind.prepare(flown, first, request)))
    queue.requeue_orphans(flown)  # the server was killed
    second = queue.claim(flown, requested.id)
    assert second is not None
    outcome = pickle.loads(pickle.dumps(kind.compute(task, lambda progress: None)))
    before = _count_rows(flown)
    with pytest.raises(queue.StaleAttempt):
        kind.save(flown, first, request, outcome)
    assert _count_rows(flown) == before, "the result of the lost attempt"
    kind.save(flown, second, request, outcome)
    after = _count_rows(flown)
    with pytest.raises(Conflict):
        kind.save(flown, second, request, outcome)
    assert _count_rows(flown) == after, "the same result twice"
    ended = flown.jobs.get(requested.id or 0)
    assert (ended.state, ended.attempt) == (RunState.SUCCEEDED, 2)
    if kind.result is not None:
        assert isinstance(kind.read_result(ended), kind.result)
    # Records and arrays belong together; the server of the tests has no checksums of pages.
    assert {one.code for one in check_database(flown)} <= {"no-checksums"}


def _count_rows(store: Store) -> dict[str, int]:
    with store.database.reading() as connection:
        return {
            name: connection.scalar(sa.select(sa.func.count()).select_from(table)) or 0
            for name, table in metadata.tables.items()
            if name not in _OF_THE_QUEUE
        }
