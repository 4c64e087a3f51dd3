"""From two flown maneuvers to a flutter speed, as an analyst asks for it."""

from __future__ import annotations

import re
import shutil
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from flexsid.demo.campaign import add_aircraft, add_maneuver
from flexsid.demo.flex28 import load_truth
from flexsid.demo.flights import fly
from flexsid.errors import BadInput, NotIdentifiable
from flexsid.figures.flutter import draw_equivalent_modes, draw_flutter_forecast, draw_flutter_map
from flexsid.figures.roots import draw_root_locus, draw_v_omega_zeta
from flexsid.records.decision import Structure
from flexsid.records.flutter import Along
from flexsid.records.maneuver import Flight
from flexsid.records.run import EstimationRun, Method, OutOfBandModes, RunSettings
from flexsid.storage.jobs import queue
from flexsid.storage.store import Store
from flexsid.sysid.model.derivatives import list_derivative_names
from flexsid.sysid.stability.derivative_fusion import IdentifiedModes
from flexsid.sysid.stability.flutter_prediction import FlutterPrediction
from flexsid.workflow.flutter import flutter_models
from flexsid.workflow.flutter.flutter_analysis import (
    FlutterQuery,
    UnmodelledModes,
    Variation,
    analyse_flutter,
    map_flutter_speed,
    summarise_flutter,
    trace_flutter_roots,
)
from flexsid.workflow.flutter.flutter_models import Group, fuse_runs
from flexsid.workflow.flutter.flutter_roots import describe_margin, is_safe
from flexsid.workflow.flutter.run_models import load_run_models
from flexsid.workflow.runs.estimation import compute_run, prepare, store_result

ESTIMATED = (7, 9, 11, 12)
PREDICTED = (15, 17, 18, 22)
FUEL = 0.5
# Flutter predictions add the other modes, from a prediction or by their static response.
OMITTING = RunSettings(out_of_band_modes=OutOfBandModes.OMITTED)


@pytest.fixture(scope="module")
def estimated_file(migrated_file: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Database with the runs of `runs`, estimated once for the module."""
    file = tmp_path_factory.mktemp("flutter") / "estimated.db"
    shutil.copy(migrated_file, file)
    store = Store.open(f"sqlite:///{file}")
    _estimate_at_two_airspeeds(store)
    store.close()
    return file


@pytest.fixture
def estimated(estimated_file: Path, tmp_path: Path) -> Iterator[Store]:
    """Store with a copy of the estimated runs."""
    file = shutil.copy(estimated_file, tmp_path / "estimated.db")
    store = Store.open(f"sqlite:///{file}")
    yield store
    store.close()


@pytest.fixture
def runs(estimated: Store) -> dict[str, tuple[int, ...]]:
    """Runs with predicted higher modes, and without them, at two airspeeds."""
    found: dict[str, tuple[int, ...]] = {"with": (), "without": ()}
    for run in estimated.runs.find():
        kind = "with" if len(run.structure.modes) > len(ESTIMATED) else "without"
        found[kind] += (run.id or 0,)
    return found


def _estimate_at_two_airspeeds(store: Store) -> None:
    aircraft = add_aircraft(store)
    flight = store.flights.add(Flight(aircraft_id=aircraft.id or 0, number=9))
    maneuvers = [
        add_maneuver(store, fly(airspeed_ratio=ratio, fuel=fuel, fta=506, seed=3), flight.id or 0)
        for ratio, fuel in ((0.65, 0.7), (0.80, FUEL))
    ]
    surfaces = ("bfs", "wf1s", "wf2s", "wf3s", "wf4s")
    free = list_derivative_names(ESTIMATED, surfaces)
    for maneuver in maneuvers:
        for structure in (
            Structure(modes=(*ESTIMATED, *PREDICTED), free=free, fixed={}),
            Structure(modes=ESTIMATED, fixed={}),
        ):
            request = EstimationRun(
                maneuver_id=maneuver.id or 0,
                method=Method.OE,
                structure=structure,
                settings=OMITTING,
            )
            run = store.runs.add(request)
            claimed = queue.claim(store, run.id)
            assert claimed is not None
            computed = compute_run(prepare(store, run), lambda progress: None)
            store_result(store, run.id or 0, claimed.attempt, computed)


def test_the_next_test_point_has_its_margin(estimated: Store, runs):
    every = (*runs["with"], *runs["without"])
    result = analyse_flutter(estimated, FlutterQuery(run_ids=every))
    truth = load_truth().flutter_speed_at(FUEL)
    assert result.fuel_fraction == pytest.approx(FUEL, abs=1e-4)
    assert result.airspeed_m_s == pytest.approx(truth, rel=0.01)
    assert result.low_m_s is not None
    assert result.high_m_s is not None
    assert result.low_m_s < truth < result.high_m_s
    assert result.sentence.startswith("Flutter of SW1B with the short period at")
    assert result.participation[0].name == "SW1B"
    assert (result.searched_from_m_s, result.searched_to_m_s) == pytest.approx(
        (0.35 * result.tested_m_s, 2.0 * result.tested_m_s)
    )
    assert f"Searched from 16.6 to {result.searched_to_m_s:.1f} m/s" in result.sentence
    assert [one.held_modes for one in result.structures] == [PREDICTED, ()]
    assert [one.preferred for one in result.structures] == [True, False]
    assert len(result.runs) == 2
    assert result.test_point_margin.startswith("Next point at 48.9 m/s: margin +2")
    beyond = analyse_flutter(estimated, FlutterQuery(run_ids=every, next_m_s=62.0))
    assert "lies beyond flutter" in beyond.test_point_margin
    assert [tracker.airspeed_m_s for tracker in result.trackers] == [None] * 3
    assert "three" in result.trackers[0].sentence
    assert result.equivalents == (), "two points are no line with an error"
    assert [one.mode for one in result.equivalent_points] == list(ESTIMATED) * 2
    first = result.equivalent_points[0]
    assert (first.frequency_hz or 0.0) == pytest.approx(3.87, rel=0.05)
    assert (first.frequency_std_hz or 1.0) < 0.05
    assert all(1.0 < (run.separation or 0.0) < 4.0 for run in result.runs)
    assert (result.margin or 0.0) == pytest.approx(truth / result.tested_m_s - 1.0, abs=0.02)
    early, late = result.progress
    assert (early.n_runs, late.n_runs) == (1, 2)
    assert late.airspeed_m_s == pytest.approx(result.airspeed_m_s)
    assert (late.low_m_s, late.high_m_s) == pytest.approx((result.low_m_s, result.high_m_s))
    assert (early.low_m_s or 0.0) < truth < (early.high_m_s or 0.0)


@pytest.mark.long
def test_a_maneuver_counts_once_however_many_runs_estimate_from_it(estimated: Store, runs):
    first = estimated.runs.get(runs["without"][0])
    again = estimated.runs.add(
        EstimationRun(
            maneuver_id=first.maneuver_id,
            method=Method.OE,
            structure=first.structure,
            settings=replace(OMITTING, max_iterations=40),
        )
    )
    claimed = queue.claim(estimated, again.id)
    assert claimed is not None
    computed = compute_run(prepare(estimated, again), lambda progress: None)
    store_result(estimated, again.id or 0, claimed.attempt, computed)
    alone, twice = (
        analyse_flutter(
            estimated,
            FlutterQuery(run_ids=ids, unmodelled_modes=UnmodelledModes.RESIDUALIZED),
        )
        for ids in ((first.id or 0,), (first.id or 0, again.id or 0))
    )
    assert twice.airspeed_m_s == pytest.approx(alone.airspeed_m_s, rel=1e-4)
    assert twice.airspeed_std_m_s == pytest.approx(alone.airspeed_std_m_s, rel=0.02)


def test_a_run_without_standard_errors_does_not_lose_the_prediction_of_the_others(
    estimated: Store, runs, monkeypatch: pytest.MonkeyPatch
):
    """As of a run that did not converge."""
    known, lost = runs["with"]

    def load(store, run_id, *arguments):
        parts = load_run_models(store, run_id, *arguments)
        if run_id != lost:
            return parts
        return tuple(replace(part, found=_lose_errors(part.found)) for part in parts)

    alone = analyse_flutter(estimated, FlutterQuery(run_ids=(known,)))
    monkeypatch.setattr(flutter_models, "load_run_models", load)
    both = analyse_flutter(estimated, FlutterQuery(run_ids=(known, lost)))
    assert (both.airspeed_m_s, both.low_m_s) == pytest.approx((alone.airspeed_m_s, alone.low_m_s))
    assert f"Run {lost} is excluded, since a derivative or its standard error" in both.sentence
    with pytest.raises(NotIdentifiable, match="not finite"):
        fuse_runs(estimated, FlutterQuery(run_ids=(lost,)))


def _lose_errors(found: IdentifiedModes) -> IdentifiedModes:
    uncertain = found.uncertain
    nothing = np.full_like(uncertain.covariance, np.nan)
    return replace(found, uncertain=replace(uncertain, covariance=nothing))


def test_runs_that_contradict_each_other_are_named_with_their_errors(
    estimated: Store, runs, monkeypatch: pytest.MonkeyPatch
):
    first, second = runs["with"]

    def load(store, run_id, *arguments):
        """A run whose derivatives are off by ten standard errors."""
        parts = load_run_models(store, run_id, *arguments)
        if run_id != second:
            return parts
        return tuple(replace(part, found=_shift_estimates(part.found)) for part in parts)

    monkeypatch.setattr(flutter_models, "load_run_models", load)
    found = analyse_flutter(estimated, FlutterQuery(run_ids=(first, second)))
    stated = re.search(
        r"The runs contradict each other: the errors of the derivatives are ([\d.]+) times its"
        r" standard errors in run \d",
        found.sentence,
    )
    assert stated is not None
    assert float(stated[1]) > 5.0
    assert "such runs have less weight" in found.sentence


def _shift_estimates(found: IdentifiedModes) -> IdentifiedModes:
    uncertain, table = found.uncertain, found.aircraft.derivatives
    values, std = table.values.copy(), np.sqrt(np.diag(uncertain.covariance))
    values[uncertain.rows, uncertain.columns] += 10.0 * std * (-1.0) ** np.arange(std.size)
    return replace(
        found, aircraft=replace(found.aircraft, derivatives=replace(table, values=values))
    )


def test_out_of_band_modes_are_included_from_a_prediction(estimated: Store, runs):
    truth = load_truth().flutter_speed_at(FUEL)
    included = analyse_flutter(estimated, FlutterQuery(run_ids=runs["without"]))
    assert included.airspeed_m_s == pytest.approx(truth, rel=0.005)
    assert "15, 17, 18, 22 with derivatives of Panel code, in a second fit" in included.sentence
    best, bare = included.structures
    assert (best.held_modes, best.source, best.unmodelled_modes) == (PREDICTED, "Panel code", ())
    assert (bare.held_modes, bare.source, bare.unmodelled_modes) == ((), None, PREDICTED)
    assert best.preferred
    assert best.airspeed_m_s is not None
    assert bare.airspeed_m_s is not None
    assert included.spread_m_s == pytest.approx(abs(bare.airspeed_m_s - best.airspeed_m_s))
    alone = analyse_flutter(
        estimated,
        FlutterQuery(run_ids=runs["without"], unmodelled_modes=UnmodelledModes.RESIDUALIZED),
    )
    assert alone.airspeed_m_s == bare.airspeed_m_s
    assert "15, 17, 18, 22 omitted" in alone.sentence
    assert abs(best.airspeed_m_s - truth) < abs(bare.airspeed_m_s - truth)
    fewer = alone.structures[1]
    assert fewer.modes == ESTIMATED[:-1], "a single structure is compared with one mode fewer"
    assert "One mode fewer" in fewer.sentence
    assert fewer.airspeed_m_s is not None
    assert alone.spread_m_s == pytest.approx(0.5 * abs(fewer.airspeed_m_s - bare.airspeed_m_s))
    assert (alone.low_m_s or np.nan) < truth < (alone.high_m_s or np.nan)


@pytest.mark.long
def test_out_of_band_modes_are_excluded_if_they_fit_the_data_worse(store: Store):
    aircraft = add_aircraft(store)
    flight = store.flights.add(Flight(aircraft_id=aircraft.id or 0, number=1))
    flown = fly(airspeed_ratio=0.80, fuel=FUEL, seed=1, modes_in_truth=4)
    maneuver = add_maneuver(store, flown, flight.id or 0)
    results = {
        method: analyse_flutter(
            store, FlutterQuery(run_ids=(_estimated(store, maneuver.id or 0, method),))
        )
        for method in (Method.OE, Method.EE)
    }
    truth = load_truth().flutter_speed_at(FUEL)
    for result in results.values():
        assert result.structures[0].held_modes == ()
        assert result.airspeed_m_s == pytest.approx(truth, rel=0.015)
        assert (result.low_m_s or np.nan) < truth < (result.high_m_s or np.nan)
    assert "further modes fit the data worse" in results[Method.OE].sentence
    assert "fit the data worse" not in results[Method.EE].sentence, "its sensors see them anyway"


def _estimated(
    store: Store,
    maneuver_id: int,
    method: Method,
    modes: tuple[int, ...] = ESTIMATED,
    modal_table_id: int | None = None,
    fixed: dict[str, float] | None = None,
) -> int:
    run = store.runs.add(
        EstimationRun(
            maneuver_id=maneuver_id,
            method=method,
            structure=Structure(modes=modes, fixed=fixed or {}),
            settings=OMITTING,
            modal_table_id=modal_table_id,
        )
    )
    claimed = queue.claim(store, run.id)
    assert claimed is not None
    store_result(
        store, run.id or 0, claimed.attempt, compute_run(prepare(store, run), lambda progress: None)
    )
    return run.id or 0


@pytest.mark.parametrize("backend", ["sqlite"])
def test_a_model_whose_unstable_root_no_data_excited_predicts_nothing(store: Store):
    """FTA 503 ends at 5.4 Hz, SW1T lies at 10.8 Hz: nothing contradicts its negative damping."""
    aircraft = add_aircraft(store)
    flight = store.flights.add(Flight(aircraft_id=aircraft.id or 0, number=1))
    maneuver = add_maneuver(store, fly(airspeed_ratio=0.65, fta=503, seed=1), flight.id or 0)
    run = _estimated(
        store, maneuver.id or 0, Method.EE, (7, 9), fixed={"CQ9_etadot9": 0.2, "CQ9_eta9": 0.0}
    )
    query = FlutterQuery(run_ids=(run,), unmodelled_modes=UnmodelledModes.RESIDUALIZED)
    result = analyse_flutter(store, query)
    assert result.airspeed_m_s is None
    assert result.low_m_s is None
    assert "SW1T (10.8 Hz in vacuo) lies outside the band of their data" in result.refusal
    assert result.sentence.startswith("No flutter speed is predicted.")
    assert "no flutter speed can be predicted" in result.test_point_margin
    assert not result.safe
    assert result.runs[0].airspeed_m_s is None
    assert result.refusal in result.runs[0].sentence
    assert all(step.airspeed_m_s is None for step in result.progress)
    models = fuse_runs(store, query)
    assert np.isnan(map_flutter_speed(store, models).airspeed_m_s).all()
    assert trace_flutter_roots(store, models).flutter is None
    one = _estimated(store, maneuver.id or 0, Method.OE, (7,))
    both = analyse_flutter(
        store, FlutterQuery(run_ids=(run, one), unmodelled_modes=UnmodelledModes.RESIDUALIZED)
    )
    assert both.structures[0].modes == (7,), "a model that flight allows is preferred"
    assert both.airspeed_m_s is not None


@pytest.mark.parametrize("backend", ["sqlite"])
def test_a_maneuver_beyond_flutter_in_closed_loop_retains_its_flutter_speed(store: Store):
    aircraft = add_aircraft(store)
    flight = store.flights.add(Flight(aircraft_id=aircraft.id or 0, number=1))
    flown = fly(airspeed_ratio=1.09, fuel=FUEL, peak_deg=1.2, seed=1)
    maneuver = add_maneuver(store, flown, flight.id or 0)
    run = _estimated(store, maneuver.id or 0, Method.OE)
    result = analyse_flutter(store, FlutterQuery(run_ids=(run,)))
    truth = load_truth().flutter_speed_at(FUEL)
    assert not result.refusal
    assert (result.low_m_s or np.nan) < truth < (result.high_m_s or np.nan) < result.tested_m_s
    assert f"run {run} was flown and identifies this open-loop root as unstable" in result.sentence
    assert not result.safe


@pytest.mark.long
@pytest.mark.parametrize("backend", ["sqlite"])
def test_frequencies_of_the_modal_table_that_are_wrong_are_within_the_interval(store: Store):
    """All modes 3 % too low, as a finite element model may be before it is updated."""
    aircraft = add_aircraft(store)
    flight = store.flights.add(Flight(aircraft_id=aircraft.id or 0, number=1))
    maneuver = add_maneuver(store, fly(airspeed_ratio=0.65, seed=(7, 65)), flight.id or 0)
    table = next(one for one in store.modal_tables.find() if one.name == "FEM")
    omega = np.asarray(store.arrays.get(table.arrays["omega"]))
    arrays = {**table.arrays, "omega": store.arrays.put(0.97 * omega)}
    arrays.pop("omega_std")  # of the updated model: this one states no errors
    off = store.modal_tables.add(replace(table, id=None, name="not updated", arrays=arrays))
    run = _estimated(store, maneuver.id or 0, Method.OE, modal_table_id=off.id)
    result = analyse_flutter(store, FlutterQuery(run_ids=(run,)))
    truth = load_truth().flutter_speed_at(maneuver.condition.fuel_fraction)
    assert result.airspeed_m_s is not None
    without = 1.96 * np.hypot(result.airspeed_std_m_s or np.nan, result.spread_m_s or np.nan)
    assert abs(result.airspeed_m_s - truth) > without, "else the case shows nothing"
    assert (result.low_m_s or np.nan) < truth < (result.high_m_s or np.nan)


def test_everything_is_drawn(estimated: Store, runs):
    models = fuse_runs(estimated, FlutterQuery(run_ids=runs["with"], fuel=0.3, altitude_m=1000.0))
    roots = trace_flutter_roots(estimated, models)
    assert {branch.name for branch in roots.branches} >= {"SP", "SW1B", "SW1T"}
    assert draw_v_omega_zeta(roots)["layout"]["yaxis2"]["title"]["text"] == "Damping ratio [%]"
    assert len(draw_root_locus(roots)["data"]) == len(roots.branches)
    results = summarise_flutter(estimated, models)
    assert draw_flutter_forecast(results)["data"]
    assert len(draw_equivalent_modes(results)["data"]) == 2 * len(ESTIMATED)
    assert {branch.name for branch in roots.branches if branch.held} == {"S15", "S17", "S18", "S22"}
    pressure = trace_flutter_roots(estimated, models, Along.DYNAMIC_PRESSURE)
    assert pressure.flutter == pytest.approx(
        0.5 * results.density_kg_m3 * (roots.flutter or 0.0) ** 2
    )
    at_57 = replace(models, query=replace(models.query, next_m_s=57.0))
    over = trace_flutter_roots(estimated, at_57, Along.FUEL)
    at_asked = int(np.argmin(np.abs(over.at - 0.3)))
    speed = int(np.argmin(np.abs(roots.airspeed_m_s - 57.0)))
    for branch in over.branches:
        same = next(one for one in roots.branches if one.name == branch.name)
        assert branch.imag[at_asked] == pytest.approx(same.imag[speed], rel=0.05)
    assert "57.0 m/s" in over.note
    for drawn in (pressure, over):
        assert draw_v_omega_zeta(drawn)["layout"]["meta"]["note"] == drawn.note
        assert draw_root_locus(drawn)["data"]
    table = map_flutter_speed(estimated, models)
    assert (np.diff(table.airspeed_m_s, axis=0) > 0.0).all(), "thinner air delays flutter"
    assert draw_flutter_map(table)["data"][0]["type"] == "heatmap"


@pytest.mark.long
@pytest.mark.parametrize("backend", ["sqlite"])
def test_a_drift_with_dynamic_pressure_helps_a_model_of_few_modes(store: Store):
    """Two modes hold what the six others do statically, which grows with dynamic pressure."""
    aircraft = add_aircraft(store)
    flight = store.flights.add(Flight(aircraft_id=aircraft.id or 0, number=9)).id or 0
    ids: list[int] = []
    for ratio in (0.56, 0.62, 0.68, 0.80):
        maneuver = add_maneuver(store, fly(airspeed_ratio=ratio, seed=3), flight)
        request = EstimationRun(
            maneuver_id=maneuver.id or 0,
            method=Method.OE,
            structure=Structure(modes=(7, 9), fixed={}),
            settings=RunSettings(),
        )
        run = store.runs.add(request)
        claimed = queue.claim(store, run.id)
        assert claimed is not None
        computed = compute_run(prepare(store, run), lambda progress: None)
        store_result(store, run.id or 0, claimed.attempt, computed)
        ids.append(run.id or 0)
    truth = load_truth().flutter_speed_at(FUEL)
    constant = analyse_flutter(store, FlutterQuery(run_ids=tuple(ids)))
    drifting = analyse_flutter(store, FlutterQuery(run_ids=tuple(ids), variation=Variation.LINEAR))
    assert constant.airspeed_m_s is not None
    assert drifting.airspeed_m_s is not None
    assert abs(drifting.airspeed_m_s - truth) < abs(constant.airspeed_m_s - truth)
    assert "vary with dynamic pressure" in drifting.sentence
    assert (drifting.low_m_s or np.nan) < truth < (drifting.high_m_s or np.nan)
    of_model = fuse_runs(store, FlutterQuery(run_ids=tuple(ids), variation=Variation.GLOBAL_MODEL))
    predicted = summarise_flutter(store, of_model)
    assert "of a global model and are evaluated at the flutter point" in predicted.sentence
    assert predicted.airspeed_m_s is not None
    assert (predicted.low_m_s or np.nan) < truth < (predicted.high_m_s or np.nan)
    assert np.isfinite(map_flutter_speed(store, of_model).airspeed_m_s).all()
    three = FlutterQuery(run_ids=tuple(ids)[:3], variation=Variation.GLOBAL_MODEL)
    assert "a global model needs 4 runs or more" in analyse_flutter(store, three).sentence
    two = analyse_flutter(store, FlutterQuery(run_ids=tuple(ids)[:2], variation=Variation.LINEAR))
    assert "a trend needs more points" in two.sentence


def test_reasons_against_the_next_test_point_are_reported(estimated: Store, runs):
    fused = fuse_runs(estimated, FlutterQuery(run_ids=runs["without"]))
    assert is_safe(fused, 48.0)
    best = fused.best
    locus = best.prediction.locus
    calm = replace(locus, roots=np.where(np.real(locus.roots) > 0.0, -1.0, locus.roots))
    wild = replace(locus, roots=locus.roots + 50.0)

    def describe(prediction: FlutterPrediction, *others: Group) -> tuple[str, bool]:
        changed = replace(best, prediction=prediction)
        changed_runs = replace(fused, best=changed, groups=[changed, *others])
        return describe_margin(changed_runs, 48.0), is_safe(changed_runs, 48.0)

    never = replace(best.prediction, crossing=None, locus=calm)
    assert describe(never)[1]
    assert "no instability is predicted up to" in describe(never)[0]
    for prediction, others, words in (
        (replace(best.prediction, crossing=None, locus=wild), [], "unstable already"),
        (never, fused.groups[1:], "another structure"),
        (replace(best.prediction, airspeed_std=np.nan), [], "uncertainty unknown"),
        (replace(best.prediction, locus=wild), [], "unstable there"),
    ):
        sentence, safe = describe(prediction, *others)
        assert words in sentence
        assert not safe
    assert "up to" in describe_margin(
        replace(
            fused, best=replace(best, prediction=never), groups=[replace(best, prediction=never)]
        ),
        500.0,
    )


def test_no_run_is_refused(store: Store):
    with pytest.raises(BadInput, match="at least one run"):
        analyse_flutter(store, FlutterQuery(run_ids=()))
