"""Model adequacy of runs, from the fit to lists and comparisons."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import sqlalchemy as sa

from flexsid.demo.campaign import add_aircraft, add_maneuver
from flexsid.demo.flights import fly
from flexsid.jobs.dispatcher import execute_run
from flexsid.jobs.kinds import RUN
from flexsid.records.decision import Structure
from flexsid.records.maneuver import Flight
from flexsid.records.run import (
    AdequacyState,
    EstimationRun,
    Method,
    OutOfBandModes,
    RunSettings,
    Start,
)
from flexsid.storage.lists.run_list import store_summary
from flexsid.storage.store import Store
from flexsid.storage.tables import runs
from flexsid.sysid.simulation.turbulence import Turbulence
from flexsid.workflow.comparison.derivative_comparison import compare
from flexsid.workflow.runs.estimation import compute_run, prepare


def estimate(store: Store, method: Method, modes: tuple[int, ...]) -> EstimationRun:
    run = EstimationRun(
        maneuver_id=1,
        method=method,
        structure=Structure(modes=modes, fixed={}),
        settings=RunSettings(start=Start.PREDICTION, out_of_band_modes=OutOfBandModes.OMITTED),
    )
    done = execute_run(store, run, RUN, lambda _: None)
    assert done.result is not None
    assert done.id is not None
    return done


def test_a_correct_model_is_consistent_and_one_without_a_mode_suspect(flown_url: str):
    """The aircraft of the record has the modes 7 and 9."""
    store = Store.open(flown_url)
    correct, wrong = (estimate(store, Method.OE, modes) for modes in ((7, 9), (7,)))
    assert correct.result is not None
    assert wrong.result is not None
    assert correct.result.adequacy.state is AdequacyState.CONSISTENT
    assert not any(test.rejects for test in correct.result.adequacy.tests)
    adequacy = wrong.result.adequacy
    assert adequacy.state is AdequacyState.SUSPECT
    assert adequacy.tests[0].meaning in adequacy.reason
    assert adequacy.causes == (), "a further mode explains more than any fault of a channel"
    outputs = [one.output for one in adequacy.without_sensors]
    assert sorted(outputs) == sorted(wrong.result.blocks[0].outputs)
    for one in correct.result.adequacy.without_sensors:
        pairs = zip(correct.result.parameters, one.values, one.differences, strict=True)
        assert all(v is None or d is None or abs(d) < 5.0 for _, v, d in pairs)
    tested = {(test.hypothesis, test.subject) for test in adequacy.tests if test.rejects}
    assert ("further mode", "mode 9") in tested
    items = {item.id: item for item in store.run_page().items}
    assert items[correct.id or 0].adequacy is AdequacyState.CONSISTENT
    assert items[wrong.id or 0].adequacy is AdequacyState.SUSPECT
    sources = compare(store, [correct.id or 0, wrong.id or 0], []).sources
    assert [source.adequacy for source in sources] == ["consistent", "suspect"]
    for method in (Method.EE, Method.FRE):
        result = estimate(store, method, (7,)).result
        assert result is not None
        assert result.adequacy.state is AdequacyState.SUSPECT
        assert "residual power" in {test.hypothesis for test in result.adequacy.tests}
    store.close()


def fit_near_flutter_in_turbulence(store: Store, method: Method, *, with_commands: bool):
    aircraft = add_aircraft(store)
    flight = store.flights.add(Flight(aircraft_id=aircraft.id or 0, number=1))
    flown = fly(airspeed_ratio=0.95, seed=104, modes_in_truth=2, turbulence=Turbulence("light"))
    if not with_commands:
        left = tuple(c for c in flown.channels if not c.name.endswith("_command"))
        assert len(left) < len(flown.channels)
        flown = replace(flown, channels=left)
    run = EstimationRun(
        maneuver_id=add_maneuver(store, flown, flight.id or 0).id or 0,
        method=method,
        structure=Structure(modes=(7, 9), fixed={}),
        settings=RunSettings(out_of_band_modes=OutOfBandModes.OMITTED),
    )
    found = compute_run(prepare(store, run), lambda _: None)
    truth = flown.truth.named()
    deviation = found.estimate.values - np.array([truth[n] for n in found.estimate.names])
    assert np.mean(np.abs(deviation) < 2.0 * found.estimate.std_errors) > 0.9
    return found, deviation


@pytest.mark.parametrize("method", [Method.OE, Method.FRE])
def test_recorded_commands_remove_the_bias_of_turbulence_near_flutter(store: Store, method: Method):
    """Feedback correlates the surfaces with the turbulence, but not the commands."""
    found, deviation = fit_near_flutter_in_turbulence(store, method, with_commands=True)
    assert found.adequacy.state is AdequacyState.CONSISTENT
    assert not any("turbulence" in warning for warning in found.warnings)
    assert found.estimate.noise is not None
    assert "errors in variables" in found.estimate.noise.description
    at = found.estimate.names.index("Cm_alpha")
    assert abs(deviation[at]) < 0.05 * abs(found.estimate.values[at])


def test_without_commands_turbulence_near_flutter_is_reported_and_counted(store: Store):
    """The estimate is biased."""
    found, _ = fit_near_flutter_in_turbulence(store, Method.OE, with_commands=False)
    assert found.adequacy.state is AdequacyState.SUSPECT
    assert "turbulence" in found.adequacy.reason
    assert found.adequacy.reason in found.warnings


def test_equation_error_is_tested_and_runs_of_earlier_releases_are_not(flown_url: str):
    store = Store.open(flown_url)
    result = store.runs.get(1).result
    assert result is not None
    assert result.adequacy.state is AdequacyState.CONSISTENT
    with store.database.transaction() as connection:
        stored = connection.execute(sa.select(runs.c.result).where(runs.c.id == 1)).scalar_one()
        earlier = {name: value for name, value in stored.items() if name != "adequacy"}
        connection.execute(sa.update(runs).where(runs.c.id == 1).values(result=earlier))
    run = store.runs.get(1)
    with store.database.transaction() as connection:
        store_summary(connection, run)  # as the migration to summaries did
    result = run.result
    assert result is not None
    assert result.adequacy.state is AdequacyState.NOT_TESTED
    assert "release" in result.adequacy.reason
    (item,) = store.run_page().items
    assert item.adequacy is AdequacyState.NOT_TESTED
    store.close()


@pytest.mark.long
def test_the_fault_of_a_sensor_of_a_flexible_aircraft_is_named(store: Store) -> None:
    """A reversed accelerometer."""
    aircraft = add_aircraft(store)
    assert aircraft.id is not None
    flight = store.flights.add(Flight(aircraft_id=aircraft.id, number=51)).id
    assert flight is not None
    flown = fly(airspeed_ratio=0.65, fuel=0.5, fta=506, modes_in_truth=1, seed=3)
    channels = tuple(
        replace(one, samples=-one.samples) if one.name == "az_cf" else one for one in flown.channels
    )
    maneuver = add_maneuver(store, replace(flown, channels=channels), flight)
    assert maneuver.id is not None
    outputs = ("alpha", "q", "az_egi", "az_cf", "az_ofl", "az_ofr")
    request = EstimationRun(
        maneuver_id=maneuver.id,
        method=Method.OE,
        structure=Structure(modes=(7,), outputs=outputs, fixed={}),
        settings=RunSettings(start=Start.PREDICTION, out_of_band_modes=OutOfBandModes.OMITTED),
    )
    found = compute_run(prepare(store, request), lambda progress: None)
    assert found.adequacy.state is AdequacyState.SUSPECT
    assert found.adequacy.reason.startswith("The sign of az_cf is reversed."), found.adequacy.reason
    (cause,) = found.adequacy.causes
    assert cause.finding.correction is not None
    assert (cause.finding.channel, cause.finding.correction.scale) == ("az_cf", -1.0)
