"""Bode plots, spectra and plot matrices of a flown maneuver."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from flexsid.demo.campaign import add_aircraft, add_maneuver
from flexsid.demo.flights import fly
from flexsid.errors import BadInput
from flexsid.figures.bode import View, draw_bode
from flexsid.figures.estimates import draw_plot_matrix
from flexsid.figures.excitation import draw_spectrum
from flexsid.records.decision import Structure
from flexsid.records.maneuver import Flight
from flexsid.records.run import EstimationRun, Method, RunSettings
from flexsid.sysid.regression.joint_equation_error import reconstruct_with_out_of_band_modes
from flexsid.workflow.fits.equation_error_fit import fit_consistent_equation_error
from flexsid.workflow.runs.estimation import prepare
from flexsid.workflow.views.bode import compute_bode
from flexsid.workflow.views.maneuver import compute_spectrum
from flexsid.workflow.views.run import compute_plot_matrix


@pytest.fixture
def pair(store) -> tuple[int, int]:
    """The same maneuver, flown twice."""
    aircraft = add_aircraft(store)
    assert aircraft.id is not None
    flight = store.flights.add(Flight(aircraft_id=aircraft.id, number=5))
    first, second = (add_maneuver(store, fly(fta=503, seed=seed), flight.id).id for seed in (1, 2))
    assert first is not None
    assert second is not None
    return first, second


def test_average_of_two_flights_has_a_smaller_error(store, pair):
    both = compute_bode(store, pair[0], ("q",), ("bfs",), overlay=(pair[1],))
    assert [r.maneuver_id for r in both.measured] == list(pair)
    mean = compute_bode(store, pair[0], ("q",), ("bfs",), overlay=(pair[1],), average=True)
    (average,) = mean.measured
    assert average.maneuver_id is None
    assert mean.agreement["bfs"] > 1e-3
    single = both.measured[0].relative_std
    assert single is not None
    assert average.relative_std is not None
    assert np.median(average.relative_std / single) == pytest.approx(0.5**0.5, abs=0.12)


def test_periods_that_repeat_are_coherent(store, pair):
    flight = store.maneuvers.get(pair[0]).flight_id
    repeated = add_maneuver(store, fly(fta=503, seed=3, n_periods=3), flight).id or 0
    (response,) = compute_bode(store, repeated, ("q",), ("bfs",)).measured
    assert response.coherence is not None
    assert response.coherence.shape == response.frequency_hz.shape
    assert np.median(response.coherence) > 0.98
    assert compute_bode(store, pair[0], ("q",), ("bfs",)).measured[0].coherence is None
    spec = draw_bode(compute_bode(store, repeated, ("q",), ("bfs",)))
    assert spec["layout"]["yaxis3"]["title"]["text"] == "Coherence"


def test_regressors_are_those_of_the_default_run(store, pair):
    """Retained modes, of which the sensors reconstruct none, are part of the motion."""
    run = EstimationRun(
        maneuver_id=pair[0],
        method=Method.EE,
        structure=Structure(modes=(7, 9), fixed={}),
        settings=RunSettings(),
    )
    task, _, fit = fit_consistent_equation_error(prepare(store, run))
    assert task.retained
    shown = compute_plot_matrix(store, pair[0], modes=(7, 9))
    assert shown.names[:4] == ("alpha", "q", "eta7", "eta9")
    np.testing.assert_allclose(shown.samples[:, [0, 2, 3]], fit.motions[0].values[:, [0, 2, 3]])
    without, _ = reconstruct_with_out_of_band_modes(task.maneuvers[0])
    change = np.linalg.norm(shown.samples[:, 3] - without.values[:, 3])
    assert change > 0.02 * np.linalg.norm(shown.samples[:, 3])


def test_maneuver_without_known_harmonics_is_analysed_by_windows(store, pair):
    flown = store.maneuvers.get(pair[0])
    by_harmonics = compute_bode(store, pair[0], ("az_mfs",), ("wf1s",)).measured[0]
    store.maneuvers.replace(replace(flown, excitation=None))
    by_windows = compute_bode(store, pair[0], ("az_mfs",), ("wf1s",)).measured[0]
    assert by_windows.coherence is not None
    sure = by_windows.coherence > 0.95
    near = sure & (by_windows.frequency_hz > 1.0) & (by_windows.frequency_hz < 5.0)
    expected = np.interp(by_windows.frequency_hz, by_harmonics.frequency_hz, by_harmonics.magnitude)
    assert near.sum() > 3
    assert np.median(np.abs(by_windows.magnitude[near] / expected[near] - 1.0)) < 0.2


@pytest.mark.parametrize("view", ["bode", "nichols", "nyquist"])
def test_every_plane_can_be_drawn(store, pair, view: View):
    spec = draw_bode(compute_bode(store, pair[0], ("q", "az_ofs"), ("bfs", "wf4s")), view)
    assert len(spec["data"]) == 4 * (2 if view == "bode" else 1)


def test_harmonics_of_an_input_are_above_its_noise(store, pair):
    value = compute_spectrum(store, pair[0], ("q", "bfs"), full=True)
    assert value.noise is not None
    ratio = value.magnitude[:, 0] / value.noise[:, 0]
    assert np.median(ratio) > 5.0
    assert value.background_hz is not None
    assert value.background_hz[-1] == pytest.approx(500.0, rel=1e-3)
    assert value.band_hz is not None
    assert value.band_hz == pytest.approx((0.25, 5.4167), abs=1e-3)
    spec = draw_spectrum(value)
    assert spec["layout"]["shapes"][0]["x1"] == value.band_hz[1]


def test_regressors_of_equation_error_come_with_their_inflation(store, pair):
    value = compute_plot_matrix(store, pair[0], modes=(7,))
    assert value.names[:4] == ("alpha", "q", "eta7", "etadot7")
    assert value.inflation is not None
    assert (value.inflation >= 1.0 - 1e-9).all()
    assert value.condition < 10.0
    inputs = compute_plot_matrix(store, pair[0], domain="frequency")
    assert np.abs(inputs.correlation[0, 1]) < 0.1
    draw_plot_matrix(value)
    with pytest.raises(BadInput, match="no channel"):
        compute_plot_matrix(store, pair[0], ("nothing",))
