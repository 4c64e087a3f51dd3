"""Estimate with a modal table whose shapes are wrong, as those of every aircraft are.

The table states by how much (``shape_std``), or a run estimates it; the flight is that of the true
shapes.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from flexsid.demo.campaign import add_aircraft, add_maneuver
from flexsid.demo.flex28 import load_truth
from flexsid.demo.flights import fly
from flexsid.records.aircraft import Aircraft
from flexsid.records.decision import Structure
from flexsid.records.maneuver import Flight
from flexsid.records.modal_data import ModalKind, ModalTable
from flexsid.records.run import EstimationRun, Method, RunSettings
from flexsid.storage.arrays import describe_array
from flexsid.storage.store import Store
from flexsid.sysid.estimation.end_states import has_end_states
from flexsid.workflow.fits.computation import ComputedRun
from flexsid.workflow.fits.equation_error_fit import collect_starting_points
from flexsid.workflow.fits.estimation_task import EstimationTask, build_experiments
from flexsid.workflow.runs.estimation import compute_run, prepare

ERROR = 0.05  # relative to the root mean square of the shape
OUTPUTS = (
    "alpha", "q", "theta", "az_egi", "az_cf", "az_ca", "az_mfs", "az_mas", "az_ofs", "az_oas"
)  # fmt: skip


def add_wrong_table(store: Store, aircraft: Aircraft, stated: float | None) -> ModalTable:
    """Add the FEM of the aircraft with wrong shapes, and what it states of them."""
    tables = store.modal_tables.find(aircraft_id=aircraft.id)
    fem = next(table for table in tables if table.kind is ModalKind.FEM)
    rng = np.random.default_rng(4)
    arrays = {name: own for name, own in fem.arrays.items() if name != "shape_std"}
    with store.transaction():
        for name in ("shape", "strain"):
            true = np.asarray(store.arrays.get(arrays[name]), dtype=float)
            size = np.sqrt(np.mean(true**2, axis=2, keepdims=True))
            error = ERROR * rng.standard_normal(true.shape[1:])
            (arrays[name],) = store.arrays.put_many([describe_array(true + size * error)])
        if stated is not None:
            std = describe_array(np.full(true.shape[:2], stated))
            (arrays["shape_std"],) = store.arrays.put_many([std])
        return store.modal_tables.add(replace(fem, id=None, name="wrong shapes", arrays=arrays))


def prepare_run(
    store: Store, method: Method, stated: float | None, band_hz: tuple[float, float] | None = None
) -> EstimationTask:
    """Prepare a run of a flight with the wrong table, in a band where no harmonics are known."""
    aircraft = add_aircraft(store)
    assert aircraft.id is not None
    flight = store.flights.add(Flight(aircraft_id=aircraft.id, number=50)).id
    assert flight is not None
    flown = fly(airspeed_ratio=0.65, fuel=0.5, fta=506, modes_in_truth=4, seed=11)
    maneuver = add_maneuver(store, flown, flight)
    assert maneuver.id is not None
    if band_hz is not None:
        store.maneuvers.replace(replace(maneuver, excitation=None))
    request = EstimationRun(
        maneuver_id=maneuver.id,
        method=method,
        structure=Structure(modes=(7, 9), outputs=OUTPUTS, fixed={}),
        settings=RunSettings(band_hz=band_hz),
        modal_table_id=add_wrong_table(store, aircraft, stated).id,
    )
    return prepare(store, request)


def estimate(store: Store, method: Method, stated: float | None) -> tuple[np.ndarray, ComputedRun]:
    """Return the errors of all derivatives in standard errors, and their run."""
    run = compute_run(prepare_run(store, method, stated), lambda progress: None)
    truth = load_truth().derivatives_at(0.5, 4).named()
    true = np.array([truth[name] for name in run.estimate.names])
    return (run.estimate.values - true) / run.estimate.std_errors, run


@pytest.mark.long
def test_shapes_that_are_taken_as_exact_bias_an_estimate(store: Store) -> None:
    z, _ = estimate(store, Method.OE, 0.0)
    assert np.mean(np.abs(z) < 2.0) < 0.7


@pytest.mark.parametrize(
    ("method", "stated"),
    [
        (Method.FRE, ERROR),
        pytest.param(Method.OE, None, marks=pytest.mark.long),
        (Method.EE, None),
    ],
    ids=["stated", "estimated", "equation error"],
)
def test_errors_of_mode_shapes_are_part_of_every_standard_error(
    store: Store, method: Method, stated: float | None
) -> None:
    z, run = estimate(store, method, stated)
    assert np.mean(np.abs(z) < 2.0) > 0.88
    assert np.sqrt(np.mean(z**2)) < 1.5
    assert "a mode is missing" not in run.adequacy.reason
    assert max(one.mode_shapes for one in run.shares.values()) > 0.2
    # They are no results, and no derivatives of retained modes.
    assert run.retained is not None
    assert not [name for name in run.retained.estimate.names if "error" in name]
    if stated is None:
        assert run.shape_spread == pytest.approx(ERROR, rel=0.5)
    else:
        assert run.shape_spread is None


def test_a_record_in_motion_is_estimated_with_them(store: Store) -> None:
    task = prepare_run(store, Method.OE, None, (0.5, 6.0))
    assert all(one.measured.free_ends for one in task.maneuvers)
    candidates = collect_starting_points(task, lambda progress: None)
    experiments = [one for one in build_experiments(task) if one.free_ends]
    assert all(has_end_states(one, experiments) for one in candidates.values())


def test_equation_error_estimates_a_record_in_motion_with_them(store: Store) -> None:
    task = prepare_run(store, Method.EE, ERROR, (0.5, 4.0))
    assert all(one.measured.free_ends for one in task.maneuvers)
    found = compute_run(task, lambda progress: None)
    assert np.isfinite(found.estimate.std_errors).all()
