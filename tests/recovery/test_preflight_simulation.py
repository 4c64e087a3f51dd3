"""A user relies on: a pre-flight simulation of a design gives the estimates of its flight."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from lagging_flight import estimate_with_shape

from flexsid.demo.campaign import add_aircraft, add_maneuver
from flexsid.demo.flights import fly
from flexsid.demo.independent_surfaces import NAME
from flexsid.errors import BadInput
from flexsid.jobs.dispatcher import execute_run
from flexsid.jobs.kinds import RUN
from flexsid.records.decision import Structure
from flexsid.records.excitation import ExcitationDesign, PreflightSimulation
from flexsid.records.flutter import ControlLaw, Controller
from flexsid.records.job import NEW_JOB
from flexsid.records.maneuver import COMBINED, Flight
from flexsid.records.run import (
    AdequacyState,
    EstimationRun,
    Method,
    OutOfBandModes,
    RunSettings,
    RunState,
)
from flexsid.storage.jobs import queue
from flexsid.storage.recordings import read_channels
from flexsid.storage.store import Store
from flexsid.sysid.excitation.catalogue import CATALOGUE
from flexsid.sysid.excitation.designer import DesignSpecification, InputSpecification
from flexsid.sysid.model.derivatives import ModelAxis
from flexsid.sysid.simulation.airframe import SensorErrors
from flexsid.sysid.simulation.turbulence import DiscreteGust, Turbulence
from flexsid.workflow.excitation.excitation_designs import (
    DesignOrder,
    compute_design,
    find_flight_test_aid,
    specify_design,
)
from flexsid.workflow.excitation.predicted_accuracy import DesignQuery, predict_accuracy
from flexsid.workflow.excitation.preflight_simulation import (
    SimulationRequest,
    SimulationResult,
    list_simulations,
    simulate_design,
    store_simulation,
)
from flexsid.workflow.flutter.controllers import add_controller
from flexsid.workflow.runs.estimation import compute_run, prepare, store_result
from flexsid.workflow.runs.run_proposal import propose_run


def flown(store: Store, ratio: float) -> EstimationRun:
    aircraft = add_aircraft(store)
    flight = store.flights.add(Flight(aircraft_id=aircraft.id or 0, number=9))
    maneuver = add_maneuver(
        store, fly(airspeed_ratio=ratio, seed=4, modes_in_truth=2), flight.id or 0
    )
    run = EstimationRun(
        maneuver_id=maneuver.id or 0,
        method=Method.OE,
        structure=Structure(modes=(7, 9), fixed={}),
        settings=RunSettings(),
    )
    return execute_run(store, run, RUN, lambda progress: None)


def _simulate(
    store: Store,
    design: ExcitationDesign,
    run_id: int,
    controller_id: int | None,
    turbulence: Turbulence = Turbulence.NONE,
) -> PreflightSimulation:
    request = SimulationRequest(
        design_id=design.id or 0,
        run_id=run_id,
        level=1,
        controller_id=controller_id,
        turbulence=turbulence,
    )
    simulated = simulate_design(store, request, lambda progress: None)
    stored = store_simulation(
        store, replace(NEW_JOB, kind="preflight-simulation"), request, simulated
    )
    return store.preflight_simulations.get(stored["simulation_id"] or 0)


def _estimate(
    store: Store, design: ExcitationDesign, simulated: PreflightSimulation
) -> SimulationResult:
    claimed = queue.claim(store, simulated.run_id)
    assert claimed is not None
    run = store.runs.get(simulated.run_id)
    store_result(
        *(store, simulated.run_id, claimed.attempt),
        compute_run(prepare(store, run), lambda progress: None),
    )
    return list_simulations(store, design)[0]


def test_a_preflight_simulation_beyond_flutter_needs_the_controller_and_recovers_what_flew(
    store: Store,
):
    run = flown(store, 1.2)
    (controller,) = store.controllers.find()
    peak = float(np.deg2rad(1.0))
    specification = specify_design(506, 24.0, 100.0, 6, (peak, 2 * peak, 4 * peak), "quick")
    order = DesignOrder(name="FTA 506", specification=specification, fta=506)
    design = store.designs.add(compute_design(order, lambda progress: None))
    with pytest.raises(BadInput, match="needs a controller"):
        _simulate(store, design, run.id or 0, None)
    simulated = _simulate(store, design, run.id or 0, controller.id)
    (waiting,) = list_simulations(store, design)
    assert waiting.state is RunState.QUEUED
    assert waiting.derivatives == ()

    done = _estimate(store, design, simulated)
    assert done.correlation is not None
    assert 0.02 < done.correlation < 0.6
    z = [(row.estimate - row.flown) / (row.std_error or np.nan) for row in done.derivatives]
    assert len(z) == 44
    assert np.sqrt(np.mean(np.square(z))) < 2.0
    ratios = [(row.expected or np.nan) / (row.std_error or np.nan) for row in done.derivatives]
    assert 0.7 < np.median(ratios) < 1.4
    maneuver = store.maneuvers.get(simulated.maneuver_id)
    assert "Simulated" in maneuver.note
    assert store.flights.get(maneuver.flight_id).number == 0

    rough = _simulate(store, design, run.id or 0, controller.id, Turbulence.LIGHT)
    turbulent = store.maneuvers.get(rough.maneuver_id)
    assert "light turbulence" in turbulent.note
    assert turbulent.duration_s == maneuver.duration_s
    # Before the excitation the aircraft is at rest in still air only.
    for name, least in (("alpha", 1.5), ("az_cf", 1.5)):
        still, moving = (
            np.std(read_channels(store.database, one.id or 0, (name,))[name][1][:800])
            for one in (maneuver, turbulent)
        )
        assert moving > least * still, name


@pytest.mark.parametrize("ratio", [0.65, pytest.param(0.95, marks=pytest.mark.long)])
def test_expected_errors_include_the_requested_turbulence(store: Store, ratio: float):
    run = flown(store, ratio)
    (controller,) = store.controllers.find()
    design = add_design(store, 506)
    request = SimulationRequest(design_id=design.id or 0, run_id=run.id or 0)
    kept = [
        {row.name: row.std_error for row in simulate_design(store, one, print).expected or ()}
        for one in (
            request,
            replace(request, gust=DiscreteGust(peak_m_s=2.0, gradient_m=10.0, start_s=3.0)),
            replace(request, sensors=(SensorErrors(channels=("az_cf",), quantum=5.0),)),
        )
    ]
    for noisier in kept[1:]:
        assert np.max([noisier[name] / std for name, std in kept[0].items()]) > 1.2
    ratios = []
    for turbulence in (Turbulence.LIGHT, Turbulence.MODERATE):
        simulated = _simulate(store, design, run.id or 0, controller.id, turbulence)
        done = _estimate(store, design, simulated)
        assert done.adequacy is AdequacyState.CONSISTENT
        ratios += [(row.expected or np.nan) / (row.std_error or 0.0) for row in done.derivatives]
    assert len(ratios) == 88
    within = np.mean((np.array(ratios) > 0.8) & (np.array(ratios) < 1.25))
    assert within >= 0.9, within


@pytest.mark.long
def test_a_model_with_a_frequency_shape_is_simulated_by_its_rational_functions(store: Store):
    run = estimate_with_shape(store, 0.8, Method.OE)
    (controller,) = store.controllers.find()
    peak = float(np.deg2rad(1.0))
    specification = specify_design(506, 24.0, 100.0, 6, (peak, 2 * peak, 4 * peak), "quick")
    order = DesignOrder(name="FTA 506", specification=specification, fta=506)
    design = store.designs.add(compute_design(order, lambda progress: None))
    done = _estimate(store, design, _simulate(store, design, run.id or 0, controller.id))
    z = [(row.estimate - row.flown) / (row.std_error or np.nan) for row in done.derivatives]
    assert len(z) == 44
    assert np.sqrt(np.mean(np.square(z))) < 1.6
    # At 400 Hz every such simulation was suspect, with standard errors 1.7 times as large.
    assert done.adequacy is AdequacyState.CONSISTENT
    ratios = [(row.expected or np.nan) / (row.std_error or np.nan) for row in done.derivatives]
    assert 0.8 < np.median(ratios) < 1.25
    rough = _simulate(store, design, run.id or 0, controller.id, Turbulence.LIGHT)
    az = read_channels(store.database, rough.maneuver_id, ("az_cf",))["az_cf"][1]
    assert np.std(az[:800]) > 0.1


def test_excitation_enters_before_the_mixer_where_a_design_has_its_commands(store: Store):
    """Surfaces then move together, which the stored maneuver states."""
    run = flown(store, 0.65)
    (direct,) = store.controllers.find()
    mixer = ((-0.4,), (1.0,))
    law = ControlLaw(airspeed_m_s=40.0, A=(), B=(), C=(), D=((0.1,),))
    mixed = add_controller(
        store,
        Controller(
            aircraft_id=direct.aircraft_id, name="mixed", reads=("q",), drives=("wf1s", "wf4s"),
            laws=(law,), commands=("pitch",), mixer=mixer, rate_limit_rad_s=2.0,
        ),
    )  # fmt: skip
    specification = DesignSpecification(
        duration_s=24.0, rate_hz=100.0, peaks=(0.02, 0.04, 0.08), effort="quick",
        inputs=(InputSpecification(name="pitch", harmonics=tuple(range(6, 60))),),
    )  # fmt: skip
    order = DesignOrder(name="pitch", specification=specification)
    design = store.designs.add(compute_design(order, lambda progress: None))
    with pytest.raises(BadInput, match="has no input pitch"):
        _simulate(store, design, run.id or 0, direct.id)
    simulated = _simulate(store, design, run.id or 0, mixed.id)
    maneuver = store.maneuvers.get(simulated.maneuver_id)
    assert "before the mixer" in maneuver.note
    assert maneuver.excitation is not None
    assert set(maneuver.excitation.harmonics) == {"wf4s"}
    assert maneuver.max_input_correlation == pytest.approx(1.0, abs=0.02)
    commands = [
        read_channels(store.database, maneuver.id or 0, (name,))[name][1]
        for name in ("wf1s_command", "wf4s_command", "bfs_command")
    ]
    assert np.abs(commands[1]).max() > 0.01
    np.testing.assert_allclose(commands[0], -0.4 * commands[1], atol=1e-8)
    assert not commands[2].any()


def estimate_independent(store: Store, axis: ModelAxis) -> EstimationRun:
    """Estimate the maneuver of the demonstration whose ten sides move independently."""
    (aircraft,) = store.aircraft.find(name=NAME)
    flown = next(m for m in store.maneuvers.find(aircraft_id=aircraft.id) if m.axis == COMBINED)
    request = EstimationRun(
        maneuver_id=flown.id or 0,
        method=Method.OE,
        structure=propose_run(store, (flown.id or 0,), axis=axis).structure,
        settings=RunSettings(out_of_band_modes=OutOfBandModes.RETAINED),
    )
    return execute_run(store, request, RUN, lambda progress: None)


def add_design(store: Store, fta: int, duration_s: float = 24.0) -> ExcitationDesign:
    """Design a row of Table 1 at 1, 2 and 4 degrees."""
    peak = float(np.deg2rad(2.0))
    specification = specify_design(fta, duration_s, 100.0, 6, (0.5 * peak, peak, 2 * peak), "quick")
    order = DesignOrder(name=f"FTA {fta}", specification=specification, fta=fta)
    return store.designs.add(compute_design(order, lambda progress: None))


@pytest.mark.parametrize("axis", ["longitudinal", pytest.param("lateral", marks=pytest.mark.long)])
def test_a_design_of_independent_sides_is_simulated_for_each_axis(
    independent_store: Store, axis: ModelAxis
):
    """The maneuver of the run had the same amplitude, and its own harmonics of all ten sides."""
    store = independent_store
    run = estimate_independent(store, axis)
    design = add_design(store, 556)
    (controller,) = store.controllers.find()  # of both axes
    simulated = _simulate(store, design, run.id or 0, controller.id)
    maneuver = store.maneuvers.get(simulated.maneuver_id)
    assert maneuver.axis == axis
    done = _estimate(store, design, simulated)
    assert done.correlation is not None
    assert done.correlation < 0.6
    z = [(row.estimate - row.flown) / (row.std_error or np.nan) for row in done.derivatives]
    assert np.sqrt(np.mean(np.square(z))) < 1.5
    ratios = [(row.expected or np.nan) / (row.std_error or np.nan) for row in done.derivatives]
    assert 0.8 < np.median(ratios) < 1.25


SYMMETRIC, ANTISYMMETRIC, INDEPENDENT = (
    tuple(aid.number for aid in CATALOGUE.values() if aid.axis == axis)
    for axis in ("symmetric", "antisymmetric", "independent")
)


@pytest.mark.parametrize(
    ("axis", "rows"),
    [
        ("lateral", (539, 568)),
        pytest.param("longitudinal", SYMMETRIC + INDEPENDENT, marks=pytest.mark.long),
        pytest.param("lateral", ANTISYMMETRIC + INDEPENDENT, marks=pytest.mark.long),
    ],
)
def test_every_standard_design_has_a_predicted_accuracy_and_a_simulation(
    independent_store: Store, axis: ModelAxis, rows: tuple[int, ...]
):
    """Throttles, to which the model has no response, are omitted, and named."""
    store = independent_store
    run = estimate_independent(store, axis)
    (controller,) = store.controllers.find()
    aids = [find_flight_test_aid(number) for number in rows]
    designs = [add_design(store, aid.number, 24.0 * aid.periods) for aid in aids]
    for aid, design in zip(aids, designs, strict=True):
        query = DesignQuery(design_id=design.id or 0, run_id=run.id or 0, level=1)
        errors = predict_accuracy(store, query, lambda progress: None).errors
        assert errors.omitted == aid.input_names()[1]
        assert np.isfinite([row.std_error for row in errors.items]).all()
    simulated = _simulate(store, designs[-1], run.id or 0, controller.id)
    maneuver = store.maneuvers.get(simulated.maneuver_id)
    assert maneuver.note.endswith(", without throttle_l, without throttle_r")
    assert maneuver.duration_s > 96.0
