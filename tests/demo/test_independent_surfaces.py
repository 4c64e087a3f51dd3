"""FLEX-28 with independent surfaces: both axes of flexible flight in the demonstration."""

from __future__ import annotations

import numpy as np
import pytest

from flexsid.demo.flex28 import load_truth
from flexsid.demo.independent_surfaces import (
    CARDS,
    NAME,
    add_independent,
    build_plant,
    compute_true_derivatives,
    describe_independent,
)
from flexsid.jobs.dispatcher import execute_run
from flexsid.jobs.kinds import RUN
from flexsid.records.maneuver import Excitation
from flexsid.records.run import EstimationRun, Method, OutOfBandModes, RunSettings
from flexsid.storage.store import Store
from flexsid.units import factor
from flexsid.workflow.aircraft.axes import list_harmonics, list_moved_surfaces
from flexsid.workflow.aircraft.flight_condition import complete_condition
from flexsid.workflow.quality.maneuver_quality import QualityRequest, assess_maneuver
from flexsid.workflow.runs.run_proposal import attach_proposal_basis, propose_run

pytestmark = pytest.mark.parametrize("backend", ["sqlite"])

# Of the independent simulation that made the derivatives: half fuel, 126.5 ft/s. [1/s]
ROOTS = (0.0129, -9.3505, -0.221 + 1.958j, -3.865 + 45.934j, -3.620 + 68.347j)


def test_the_antisymmetric_motion_has_the_published_roots(backend: str) -> None:
    truth, aircraft = load_truth(), describe_independent()
    speed = 126.5 * factor("ft/s", "speed")
    flight = truth.condition_at(speed, 0.5)
    measured = {"airspeed": speed, "density": flight.density, "alpha": flight.alpha}
    at = complete_condition(aircraft, {**measured, "fuel_fraction": 0.5})
    roots = np.linalg.eigvals(build_plant(aircraft, truth, at, 0.5).A)
    for known in ROOTS:
        assert np.abs(roots - known).min() < 0.002 * abs(known) + 0.0002


SINGLES = ("bfl", "wf1l", "bfr", "wf1r")


@pytest.mark.parametrize(
    ("axis", "harmonics", "moved"),
    [
        ("lateral", {"bfa": (6,), "wf1a": (7,)}, ("bfa", "wf1a")),
        ("longitudinal", {"bfs": (6,), "wf1s": (7,)}, ("bfs", "wf1s")),
        ("lateral", None, ("bfa", "wf1a")),
        ("lateral", {"bfl": (6,), "bfr": (7,), "wf1a": (8,)}, ("bfl", "wf1a", "bfr")),
        ("combined", {"bfl": (6,), "bfr": (7,)}, SINGLES),
    ],
)
def test_sides_that_only_move_together_or_against_each_other_are_one_input(
    backend: str, axis: str, harmonics: dict[str, tuple[int, ...]] | None, moved: tuple[str, ...]
) -> None:
    aircraft = describe_independent()
    excitation = (
        None
        if harmonics is None
        else Excitation(period_s=24.0, harmonics=harmonics, start_s=2.0, n_periods=1)
    )
    assert list_moved_surfaces(aircraft, axis, excitation, SINGLES) == moved
    if axis != "combined" and harmonics is not None:
        assert list_harmonics(aircraft, excitation, "wf1r") == harmonics[moved[1]]


def test_default_runs_hold_the_truth_in_both_axes(independent_store: Store) -> None:
    store = independent_store
    (aircraft,) = store.aircraft.find(name=NAME)
    assert add_independent(store) == aircraft
    maneuvers = store.maneuvers.find(aircraft_id=aircraft.id)
    assert [one.fta for one in maneuvers] == [card.fta for card in CARDS]
    # Left and right surfaces that move against each other are one input, and one command.
    assert maneuvers[0].max_input_correlation is not None
    assert maneuvers[0].max_input_correlation < 0.15
    found = [assess_maneuver(store, QualityRequest(maneuver_id=one.id or 0)) for one in maneuvers]
    assert [one.verdict for one in found] == ["good", "unchecked", "good", "unchecked"]
    for quality in found:
        assert [one.severity for one in quality.report.warnings] in ([], ["good"])
        assert all(abs((one.gain or 0.0) - 1.0) < 0.05 for one in quality.report.surfaces)
    errors = []
    for place, axis, method in (
        (0, "lateral", Method.EE),
        (1, "lateral", Method.OE),
        (1, "longitudinal", Method.OE),
    ):
        maneuver = maneuvers[place]
        assert maneuver.id is not None
        structure = propose_run(store, [maneuver.id], axis=axis).structure
        run = EstimationRun(
            maneuver_id=maneuver.id,
            method=method,
            structure=structure,
            settings=RunSettings(out_of_band_modes=OutOfBandModes.RETAINED),
        )
        run = execute_run(store, attach_proposal_basis(store, run), RUN, lambda progress: None)
        assert run.result is not None
        fuel = maneuver.condition.fuel_fraction
        assert fuel is not None
        true = load_truth().derivatives_at(fuel, 8) if axis == "longitudinal" else None
        named = (true or compute_true_derivatives(fuel)).named()
        errors += [
            (one.value - named[one.name]) / one.std_error
            for one in run.result.parameters
            if one.name in named and one.std_error
        ]
    assert len(errors) == 60 + 60 + 44
    # 95 % of 164 derivatives, whose errors are correlated in groups of ten.
    assert np.mean(np.abs(errors) < 2.0) > 0.88
