"""Predictions computed from a planform: job, storage, and runs with their frequency shape."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from flexsid.cli.models import read_planform
from flexsid.demo.campaign import add_aircraft, add_maneuver
from flexsid.demo.flex28 import load_truth
from flexsid.demo.flights import fly
from flexsid.demo.independent_surfaces import compute_true_derivatives, describe_independent
from flexsid.demo.sources import build_modal_tables
from flexsid.errors import BadInput, Conflict, FlexsidError
from flexsid.jobs.dispatcher import execute_request, execute_run
from flexsid.jobs.kind import find_job, get_result
from flexsid.jobs.kinds import PREDICTED_FLUTTER, PREDICTION, RUN
from flexsid.records.aircraft import DerivativePrediction
from flexsid.records.decision import Structure
from flexsid.records.maneuver import Flight
from flexsid.records.run import (
    Aerodynamics,
    EstimationRun,
    Method,
    OutOfBandModes,
    RunSettings,
    RunState,
)
from flexsid.storage.store import Store
from flexsid.sysid.model.longitudinal import LONGITUDINAL
from flexsid.workflow.aircraft.derivative_predictions import (
    interpolate_prediction,
    load_frequency_shape,
)
from flexsid.workflow.flutter.flutter_models import FlutterQuery, fuse_runs
from flexsid.workflow.flutter.predicted_flutter import PredictedFlutterQuery
from flexsid.workflow.flutter.run_models import UnmodelledModes
from flexsid.workflow.modal_data.computed_predictions import (
    PlanformSurface,
    PredictionRequest,
    check_prediction,
    prepare_prediction,
)
from flexsid.workflow.runs.estimation import prepare

PLANFORM = Path(__file__).parents[2] / "examples" / "flex28" / "planform.toml"


def request(store: Store) -> PredictionRequest:
    """The planform of the examples with fewer boxes and two modes."""
    aircraft = add_aircraft(store)
    whole = read_planform(PLANFORM)
    panels = tuple(replace(p, chordwise=4, spanwise=min(p.spanwise, 12)) for p in whole.panels)
    return replace(whole, aircraft_id=aircraft.id or 0, panels=panels, modes=(7, 9), highest_k=1.5)


def compute(store: Store) -> DerivativePrediction:
    job = execute_request(store, PREDICTION, request(store), lambda progress: None)
    assert job.error is None
    return store.predictions.get((job.result or {})["prediction_id"])


def test_a_planform_gives_a_prediction_beside_imported_ones(store: Store):
    found = compute(store)
    assert found.unsteady is not None
    assert found.kind == "doublet lattice"
    # Half of four divisions would move the hinge lines from 0.75 to 0.5 of the chord.
    assert found.unsteady.coarse_coefficients is None
    assert "Mach 0.1" in found.note
    values = np.asarray(store.arrays.get(found.values))
    errors = np.asarray(store.arrays.get(found.std_errors or ""))
    assert (errors > 0.05 * np.abs(values)).all()
    truth = load_truth().derivatives_at(0.5, 2).named()
    half = dict(zip(found.names, values[found.fuel.index(0.5)], strict=True))
    # The lattice at k = 0.15 with half the boxes against that of the demonstration at k = 0.
    for name in ("CZ_alpha", "Cm_alpha", "CZ_q", "Cm_q", "CZ_wf3s", "CQ7_alpha"):
        assert half[name] == pytest.approx(truth[name], rel=0.25), name
    shape = load_frequency_shape(store, found, 0.5, (7, 9), ("wf3s",), LONGITUDINAL)
    assert shape.reference_k == 0.15
    assert np.allclose(np.real(shape.at(np.array([0.15]))), 1.0)
    with pytest.raises(Conflict, match="another name"):
        check_prediction(store, request(store))


def test_flutter_of_a_prediction_alone_agrees_with_rational_functions(store: Store):
    prediction = compute(store)
    query = PredictedFlutterQuery(prediction_id=prediction.id or 0, fuel=0.5)
    execute_request(store, PREDICTED_FLUTTER, query, lambda progress: None)
    found = get_result(store, PREDICTED_FLUTTER, query)
    flutter = found.flutter
    assert flutter.airspeed_m_s is not None
    # FLEX-28U with 320 boxes: 204.3 ft/s at another density; k = 0.15.
    assert flutter.airspeed_m_s == pytest.approx(62.3 * np.sqrt(1.0556 / 1.225), rel=0.06)
    assert flutter.reduced_frequency == pytest.approx(0.15, rel=0.1)
    assert flutter.rational_airspeed_m_s == pytest.approx(flutter.airspeed_m_s, rel=0.003)
    assert flutter.airspeed_std_m_s is not None
    assert flutter.airspeed_std_m_s > 0.01 * flutter.airspeed_m_s
    assert {branch.name for branch in found.roots.branches} >= {"SW1B"}
    quasi_steady = next(p for p in store.predictions.find() if p.unsteady is None)
    query = PredictedFlutterQuery(prediction_id=quasi_steady.id or 0, fuel=0.5)
    execute_request(store, PREDICTED_FLUTTER, query, lambda progress: None)
    imported = get_result(store, PREDICTED_FLUTTER, query).flutter
    assert imported.rational_airspeed_m_s is None
    with pytest.raises(BadInput, match=r"fuel is 50\.0; expected 0 to 1"):
        find_job(store, PREDICTED_FLUTTER, replace(query, fuel=50.0))


def test_the_interval_of_flutter_contains_the_spread_between_meshes(store: Store):
    aircraft = add_aircraft(store, unsteady=True)
    lattice = store.predictions.find(source="Doublet lattice")[0]
    assert lattice.unsteady is not None
    fine = np.asarray(store.arrays.get(lattice.unsteady.coefficients))
    more_lag = 1.0 - 0.2j * np.array(lattice.unsteady.k)[None, :, None]
    coarse = store.arrays.put(fine * more_lag)
    meshes = replace(lattice.unsteady, coarse_coefficients=coarse)
    both = store.predictions.add(replace(lattice, id=None, source="Two meshes", unsteady=meshes))
    flight = store.flights.add(Flight(aircraft_id=aircraft.id or 0, number=1))
    flown = fly(airspeed_ratio=0.8, modes_in_truth=2, unsteady=True)
    maneuver = add_maneuver(store, flown, flight.id or 0)
    asked = EstimationRun(
        maneuver_id=maneuver.id or 0,
        method=Method.OE,
        structure=Structure(modes=(7, 9), fixed={}),
        settings=RunSettings(
            aerodynamics=Aerodynamics.SHAPED, out_of_band_modes=OutOfBandModes.OMITTED
        ),
        prediction_id=both.id,
    )
    run = execute_run(store, asked, RUN, lambda progress: None)
    unmodelled = UnmodelledModes.RESIDUALIZED
    query = FlutterQuery(run_ids=(run.id or 0,), unmodelled_modes=unmodelled)
    models = fuse_runs(store, query)
    assert models.best is models.groups[0]
    (refit,) = (group for group in models.groups[1:] if group.parts[0].coarse_mesh)
    (fewer,) = (group for group in models.groups[1:] if not group.parts[0].coarse_mesh)
    assert refit.parts[0].fitted.settings.aerodynamics is Aerodynamics.SHAPED_COARSE_MESH
    speed, by_mesh, by_modes = (
        group.prediction.crossing.airspeed
        for group in (models.best, refit, fewer)
        if group.prediction.crossing is not None
    )
    assert abs(by_mesh - speed) > 0.001 * speed
    # The change by the last mode bounds that of further ones at two standard deviations.
    expected = np.hypot(by_mesh - speed, 0.5 * (by_modes - speed))
    assert models.best.prediction.spread == pytest.approx(expected, rel=1e-6)
    assert "the mesh" in refit.prediction.sentence
    settings = replace(asked.settings, aerodynamics=Aerodynamics.SHAPED_COARSE_MESH)
    with pytest.raises(BadInput) as refused:
        prepare(store, replace(asked, prediction_id=lattice.id, settings=settings))
    assert refused.value.code == "no-coarse-mesh"


def test_impossible_planforms_are_refused_by_name(store: Store):
    good = request(store)
    surface = PlanformSurface(name="rudder", span=(1.0, 2.0))
    for bad, code in (
        (replace(good, panels=()), "no-panels"),
        (replace(good, surfaces=(surface,)), "unknown-input"),
        (
            replace(good, surfaces=(replace(surface, name="wf1s", span=(8.0, 9.0)),)),
            "empty-surface",
        ),
        (replace(good, mach=0.95), "bad-mach"),
        (replace(good, reference_k=2.0), "bad-frequency"),
        (replace(good, panels=(replace(good.panels[0], left_chord=np.nan),)), "bad-panel"),
        (replace(good, panels=(replace(good.panels[0], spanwise=0),)), "bad-panel"),
    ):
        with pytest.raises(BadInput) as refused:
            check_prediction(store, bad)
        assert refused.value.code == code


def test_a_run_estimates_derivatives_with_the_shape_of_the_prediction(store: Store):
    prediction = compute(store)
    aircraft = store.aircraft.find()[0]
    flight = store.flights.find(aircraft_id=aircraft.id) or [
        store.flights.add(Flight(aircraft_id=aircraft.id or 0, number=1))
    ]
    flown = fly(airspeed_ratio=0.65, fuel=0.5, fta=503, modes_in_truth=2, seed=5)
    maneuver = add_maneuver(store, flown, flight[0].id or 0)
    asked = EstimationRun(
        maneuver_id=maneuver.id or 0,
        method=Method.EE,
        structure=Structure(modes=(7, 9), fixed={}),
        settings=RunSettings(
            aerodynamics=Aerodynamics.SHAPED, out_of_band_modes=OutOfBandModes.OMITTED
        ),
    )
    task = prepare(store, asked)
    assert task.prediction_id == prediction.id
    assert task.model.shape is not None
    assert task.model.shape.unshaped == ()
    done = execute_run(store, asked, RUN, lambda progress: None)
    assert done.state is RunState.SUCCEEDED, done.error
    imported = next(p for p in store.predictions.find() if p.unsteady is None)
    with pytest.raises(BadInput) as refused:
        prepare(store, replace(asked, prediction_id=imported.id))
    assert refused.value.code == "no-frequency-shape"


def test_a_planform_gives_derivatives_of_lateral_motion_and_their_flutter(store: Store):
    aircraft = store.aircraft.add(describe_independent())
    for table in build_modal_tables(load_truth(), aircraft.id or 0, store.arrays.put):
        store.modal_tables.add(table)
    whole = read_planform(PLANFORM)
    lateral = replace(
        whole,
        aircraft_id=aircraft.id or 0,
        axis="lateral",
        panels=tuple(replace(p, spanwise=min(p.spanwise, 12)) for p in whole.panels),
        surfaces=tuple(replace(one, name=f"{one.name[:-1]}a") for one in whole.surfaces),
        reference_k=0.0,
        highest_k=1.5,
    )
    job = execute_request(store, PREDICTION, replace(lateral, modes=(8, 10)), lambda progress: None)
    assert job.error is None
    found = store.predictions.get((job.result or {})["prediction_id"])
    predicted = interpolate_prediction(store, found, 0.5)
    # Trim lift and suction are not zero but unknown.
    lacking = {"Cl_beta", "Cl_r", "Cn_p", "CY_p"}
    assert set(found.names) - set(predicted) == lacking
    assert all(name in found.note for name in lacking)
    # Of a lattice of another origin, which has twice the strips.
    truth = compute_true_derivatives(0.5).named()
    for name in (
        *("Cl_p", "CY_beta", "Cl_eta10", "Cl_bfa", "Cl_wf2a", "Cl_wf4a"),
        *("CQ8_beta", "CQ8_etadot8", "CQ8_wf4a", "CQ10_p", "CQ10_eta10", "CQ10_etadot10"),
    ):
        assert predicted[name][0] == pytest.approx(truth[name], rel=0.08), name
    assert predicted["Cl_p"][1] == pytest.approx(0.15 * abs(truth["Cl_p"]), rel=0.1)

    query = PredictedFlutterQuery(prediction_id=found.id or 0, fuel=0.5)
    execute_request(store, PREDICTED_FLUTTER, query, lambda progress: None)
    result = get_result(store, PREDICTED_FLUTTER, query)
    flutter = result.flutter
    assert flutter.airspeed_m_s is not None
    assert flutter.sentence.startswith("Flutter of AW1T with ")
    assert "Without CY_p, Cl_beta, Cl_r, Cn_p" in result.roots.note
    assert flutter.rational_airspeed_m_s == pytest.approx(flutter.airspeed_m_s, rel=0.003)
    other = replace(query, axis="longitudinal")
    refused = execute_request(store, PREDICTED_FLUTTER, other, lambda progress: None).error
    assert refused is not None
    assert "no longitudinal derivatives" in refused["message"]

    check_prediction(store, replace(lateral, source="other"))
    changes: tuple[tuple[dict[str, Any], str], ...] = (
        ({"surfaces": whole.surfaces}, "'bfs'"),
        ({"surfaces": (replace(whole.surfaces[0], name="bfl"),)}, "moves on one side"),
        ({"axis": "combined"}, "longitudinal or lateral"),
    )
    for change, words in changes:
        with pytest.raises(FlexsidError, match=words):
            check_prediction(store, replace(lateral, source="other", **change))
    with pytest.raises(BadInput, match="antisymmetric modes, which are 8, 10"):
        prepare_prediction(store, replace(lateral, source="other", modes=(7,)))
