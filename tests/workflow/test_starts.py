"""Start values of a fit, and restarts without convergence."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from flexsid.jobs.dispatcher import execute_run
from flexsid.jobs.kinds import RUN
from flexsid.records.decision import Structure
from flexsid.records.run import (
    AdequacyState,
    EstimationRun,
    Method,
    OutOfBandModes,
    Progress,
    RunSettings,
    Start,
)
from flexsid.storage.store import Store
from flexsid.sysid.estimation import experiment
from flexsid.workflow.fits import equation_error_fit
from flexsid.workflow.fits.estimation_task import get_first_start
from flexsid.workflow.flutter.run_models import UnmodelledModes, load_run_models
from flexsid.workflow.runs.derived_runs import DerivedRuns
from flexsid.workflow.runs.estimation import compute_run, prepare
from flexsid.workflow.runs.exports import export_run
from flexsid.workflow.views.run import compute_parameter_correlation


def test_equation_error_is_a_start_only_where_the_prediction_does_not_suffice(
    flown_url: str, monkeypatch
):
    store = Store.open(flown_url)
    run = EstimationRun(
        maneuver_id=1,
        method=Method.OE,
        structure=Structure(modes=(7, 9), fixed={}),
        settings=RunSettings(out_of_band_modes=OutOfBandModes.OMITTED),
    )
    task = prepare(store, run)
    store.close()
    estimate, calls = equation_error_fit.estimate_starting_values, []
    monkeypatch.setattr(
        equation_error_fit,
        "estimate_starting_values",
        lambda *arguments: calls.append(1) or estimate(*arguments),
    )
    found = compute_run(task, lambda progress: None)
    assert found.adequacy.state is AdequacyState.CONSISTENT
    assert (calls, {found.start}) == ([], set(task.starts))
    table = get_first_start(task)
    at_rest = replace(table, values=np.zeros_like(table.values))  # no iteration converges from here
    again = compute_run(replace(task, starts={"zero": at_rest}), lambda progress: None)
    assert (calls, again.start) == ([1], equation_error_fit.EQUATION_ERROR)
    change = (again.estimate.values - found.estimate.values) / found.estimate.std_errors
    assert np.abs(change).max() < 0.05


def test_unconverged_fit_is_restarted_from_perturbed_values(flown_url: str):
    store = Store.open(flown_url)
    run = EstimationRun(
        maneuver_id=1,
        method=Method.OE,
        structure=Structure(modes=(7, 9), fixed={}),
        settings=RunSettings(start=Start.PREDICTION, max_iterations=1),
    )
    messages: list[str] = []
    computed = compute_run(prepare(store, run), lambda progress: messages.append(progress.message))
    store.close()
    assert any("perturbed" in message for message in messages)
    assert computed.estimate.outcome.value == "iteration limit"
    assert np.isfinite(computed.estimate.values).all()


def test_unconverged_fit_has_no_standard_errors(flown_url: str):
    store = Store.open(flown_url)
    run = EstimationRun(
        maneuver_id=1,
        method=Method.OE,
        structure=Structure(modes=(7, 9), fixed={}),
        settings=RunSettings(start=Start.PREDICTION, max_iterations=1),
    )
    done = execute_run(store, run, RUN, lambda _: None)
    result = done.result
    assert result is not None
    assert done.id is not None
    assert result.fit.outcome == "iteration limit"
    assert {one.std_error for one in result.parameters} == {None}
    assert {one.no_error for one in result.parameters} == {"not converged"}
    assert {pole.damping_std for pole in result.poles} == {None}
    assert any("have no standard errors" in text for text in result.fit.warnings)
    assert np.isnan(compute_parameter_correlation(store, done.id).correlation).all()
    assert export_run(store, done.id).run.result == result
    store.close()


def test_a_parameter_at_its_limit_is_no_estimate(flown_url: str, monkeypatch):
    """The limit is set below the true delay of the sensor."""
    monkeypatch.setitem(experiment._LIMITS, "delay", (-1e-6, 1e-6))
    store = Store.open(flown_url)
    run = EstimationRun(
        maneuver_id=1,
        method=Method.OE,
        structure=Structure(modes=(7, 9), fixed={}, extra_parameters=("delay_q",)),
        settings=RunSettings(start=Start.PREDICTION),
    )
    done = execute_run(store, run, RUN, lambda _: None)
    result = done.result
    assert result is not None
    assert result.fit.outcome == "converged"
    delay = next(one for one in result.parameters if one.name == "delay_q")
    assert (delay.std_error, delay.no_error) == (None, "at its limit")
    assert {one.no_error for one in result.parameters if one is not delay} == {None}
    assert all(pole.damping_std for pole in result.poles if pole.imag > 0)
    assert any(text.startswith("delay_q = ") for text in result.fit.warnings)
    store.close()


def test_estimates_dominated_by_the_prior_raise_a_warning(flown_url: str):
    store = Store.open(flown_url)
    priors = {"Cm_q": (-12.0, 1e-4), "Cm_alpha": (-1.0, 1e3)}
    run = EstimationRun(
        maneuver_id=1,
        method=Method.EE,
        structure=Structure(modes=(7, 9), fixed={}),
        settings=RunSettings(priors=priors),
    )
    found = compute_run(prepare(store, run), lambda progress: None).warnings
    (text,) = [one for one in found if "prior" in one]
    assert "Cm_q" in text
    assert "Cm_alpha" not in text
    store.close()


def test_flutter_prediction_knows_the_priors_of_the_analyst(flown_url: str):
    """Runs that share a prior count it once."""
    store = Store.open(flown_url)
    request = EstimationRun(
        maneuver_id=1,
        method=Method.OE,
        structure=Structure(modes=(7,), fixed={}),
        settings=RunSettings(
            priors={"Cm_q": (-12.0, 2.0)}, out_of_band_modes=OutOfBandModes.OMITTED
        ),
    )
    run = execute_run(store, request, RUN, lambda _: None)
    derived = DerivedRuns(store, lambda _: None)
    (model,) = load_run_models(
        store, run.id or 0, UnmodelledModes.RESIDUALIZED, derived, Progress()
    )
    store.close()
    uncertain, prior = model.found.uncertain, model.found.prior
    assert prior is not None
    (place,) = np.flatnonzero(np.diag(prior.precision))
    assert (uncertain.rows[place], uncertain.columns[place]) == (1, 1)
    assert (prior.mean[place], prior.precision[place, place]) == (-12.0, 0.25)
    assert (1, 1) in model.found.places, "it is a result nevertheless"
