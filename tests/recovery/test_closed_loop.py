"""A user relies on: where a controller loses an identified aircraft, and the margins before."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from lagging_flight import estimate_with_shape

from flexsid.demo.campaign import add_aircraft, add_maneuver
from flexsid.demo.flex28 import load_truth
from flexsid.demo.flights import fly
from flexsid.errors import BadInput
from flexsid.figures.closed_loop import draw_closed_loop_margins, draw_closed_loop_roots
from flexsid.jobs.dispatcher import execute_run
from flexsid.jobs.kinds import RUN
from flexsid.records.decision import Structure
from flexsid.records.flutter import ControlLaw, Controller
from flexsid.records.maneuver import Flight
from flexsid.records.run import EstimationRun, Method, OutOfBandModes, RunSettings
from flexsid.storage.store import Store
from flexsid.workflow.flutter.closed_loop import analyse_closed_loop
from flexsid.workflow.flutter.controllers import add_controller
from flexsid.workflow.flutter.flutter_models import FlutterQuery, fuse_runs
from flexsid.workflow.flutter.run_models import UnmodelledModes


def flown(store: Store, ratio: float) -> int:
    aircraft = add_aircraft(store)
    flight = store.flights.add(Flight(aircraft_id=aircraft.id or 0, number=9))
    maneuver = add_maneuver(store, fly(airspeed_ratio=ratio, seed=4), flight.id or 0)
    run = EstimationRun(
        maneuver_id=maneuver.id or 0,
        method=Method.OE,
        structure=Structure(modes=(7, 9, 11, 12), fixed={}),
        settings=RunSettings(out_of_band_modes=OutOfBandModes.OMITTED),
    )
    return execute_run(store, run, RUN, lambda progress: None).id or 0


def test_the_controller_of_flex28_loses_it_where_the_truth_does(store: Store):
    """The true closed loop is stable up to 1.262 of the open-loop flutter speed at half fuel."""
    query = FlutterQuery(run_ids=(flown(store, 0.95),))
    (controller,) = store.controllers.find()
    models = fuse_runs(store, query)
    result = analyse_closed_loop(store, models, controller.id or 0)
    assert [one.failure for one in result.derived_runs] == [None], "modes of the prediction"
    true = load_truth().flutter_speed_at(0.5)
    assert result.lost_m_s == pytest.approx(1.262 * true, rel=0.02)
    assert result.low_m_s is not None
    assert result.lost_m_s is not None
    assert result.spread_m_s > 0.0, "the run alone puts it elsewhere"
    assert result.low_m_s < 1.262 * true < (result.high_m_s or 0.0)
    assert result.low_m_s <= result.lost_m_s <= (result.high_m_s or 0.0)
    assert f"{result.lost_m_s:.1f} m/s" in result.sentence
    outer = next(margin for margin in result.margins if margin.surface == "wf4s")
    held = result.airspeed_m_s < result.lost_m_s
    assert np.isfinite(outer.disk[held]).all()
    assert np.isnan(outer.disk[~held]).all()
    assert outer.disk[0] > outer.disk[held][-1] > 0.0
    unstable = [np.real(root).max() > 0.01 for root in result.open_roots]
    assert any(unstable[k] for k in np.flatnonzero(held))
    for draw in (draw_closed_loop_margins, draw_closed_loop_roots):
        assert draw(result)["data"]

    weak = add_controller(
        store,
        Controller(
            aircraft_id=controller.aircraft_id,
            name="none at all",
            reads=("q",),
            drives=("wf4s",),
            laws=(ControlLaw(airspeed_m_s=0.0, A=(), B=(), C=((),), D=((1e-9,),)),),
        ),
    )
    alone = analyse_closed_loop(store, models, weak.id or 0)
    assert alone.lost_m_s == pytest.approx(true, rel=0.03)
    stranger = add_controller(
        store,
        Controller(
            aircraft_id=controller.aircraft_id,
            name="reads what nobody has",
            reads=("nowhere",),
            drives=("wf4s",),
            laws=(ControlLaw(airspeed_m_s=0.0, A=(), B=(), C=((),), D=((1.0,),)),),
        ),
    )
    with pytest.raises(BadInput, match="nowhere"):
        analyse_closed_loop(store, models, stranger.id or 0)


@pytest.mark.long
def test_a_loop_with_lagging_forces_is_lost_where_the_truth_loses_it(store: Store):
    """A run with a frequency shape against the states of the true lags in the same loop."""
    run = estimate_with_shape(store, 0.95, Method.OE)
    query = FlutterQuery(run_ids=(run.id or 0,), unmodelled_modes=UnmodelledModes.RESIDUALIZED)
    (controller,) = store.controllers.find()
    models = fuse_runs(store, query)
    result = analyse_closed_loop(store, models, controller.id or 0)
    assert result.lost_m_s is not None
    assert result.low_m_s is not None

    drawn = draw_closed_loop_roots(result)
    # The lags, to 70 times 2V/chord, leave the scale to the motion.
    assert drawn["layout"]["xaxis"]["range"][0] > -100.0

    truth = load_truth(unsteady=True)
    best = models.best.found
    true = replace(
        best,
        aircraft=replace(
            best.aircraft, derivatives=truth.derivatives_at(0.5, 2), shape=truth.shape_at(0.5, 2)
        ),
    )
    known = replace(models, groups=[replace(models.best, found=true)])
    lost = analyse_closed_loop(store, known, controller.id or 0).lost_m_s
    assert lost is not None
    assert result.lost_m_s == pytest.approx(lost, rel=0.02)
    assert result.low_m_s < lost < (result.high_m_s or 0.0)
