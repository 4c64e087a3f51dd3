"""One simulated maneuver: properties of its recorded channels."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from flexsid.demo.campaign import add_aircraft, add_maneuver
from flexsid.demo.flex28 import INPUTS, load_truth
from flexsid.demo.flights import SETTLE_S, TRIM_S, FlownManeuver, design_fta, fly
from flexsid.demo.truth_flight import FlownChannel
from flexsid.records.decision import Structure
from flexsid.records.maneuver import Flight, Role
from flexsid.records.run import EstimationRun, Method, OutOfBandModes, RunSettings
from flexsid.storage.store import Store
from flexsid.workflow.runs.estimation import prepare


def channel(flown: FlownManeuver, name: str) -> FlownChannel:
    return next(channel for channel in flown.channels if channel.name == name)


@pytest.fixture(scope="module")
def quiet() -> FlownManeuver:
    return fly(modes_in_truth=2, noise=False)


def test_same_seed_same_samples_other_seed_other_noise():
    first, again, other = (fly(fta=503, modes_in_truth=2, seed=seed) for seed in (1, 1, 2))
    for one, two, three in zip(first.channels, again.channels, other.channels, strict=True):
        np.testing.assert_array_equal(one.samples, two.samples)
        if one.role in (Role.INPUT, Role.OUTPUT):
            assert not np.array_equal(one.samples, three.samples), one.name


def test_trim_comes_first_and_rest_comes_last(quiet: FlownManeuver):
    """Two seconds of trim, and rest at the end."""
    for name in ("q", "az_oal", "s_bend2r", "theta", "bfs"):
        own = channel(quiet, name)
        trim = own.samples[: round(TRIM_S * own.rate_hz)].astype(float)
        assert np.ptp(trim) < 1e-5 * np.ptp(own.samples), name
        last = own.samples[-round(0.1 * own.rate_hz) :] - trim.mean()
        assert np.abs(last).max() < 2e-3 * np.ptp(own.samples), name
    assert quiet.maneuver.duration_s == TRIM_S + 24.0 + SETTLE_S


def test_sensors_read_trim_in_native_units(quiet: FlownManeuver):
    alpha = quiet.maneuver.condition.alpha_rad
    trim = {name: float(channel(quiet, name).samples[0]) for name in ("alpha", "az_egi", "ax_egi")}
    assert trim["alpha"] == pytest.approx(alpha, rel=1e-3)
    assert trim["az_egi"] == pytest.approx(-np.cos(alpha), rel=1e-3)
    assert trim["ax_egi"] == pytest.approx(np.sin(alpha), rel=1e-3)
    assert channel(quiet, "az_egi").unit == "g"
    assert channel(quiet, "s_bend1r").unit == "ustrain"


def test_noise_is_that_of_the_sensors(quiet: FlownManeuver):
    """At the analysis frequencies the noise of every channel is that of its data sheet."""
    noisy = fly(modes_in_truth=2, seed=3)
    expected = {"bfs": 0.00035, "q": 0.0012, "az_oal": 0.012, "alpha": 0.0008, "s_bend1r": 1.5}
    for name, std in expected.items():
        own = channel(noisy, name)
        noise = own.samples.astype(float) - channel(quiet, name).samples
        spectrum = np.abs(np.fft.rfft(noise)) ** 2 / (noise.size * own.rate_hz)
        frequency = np.fft.rfftfreq(noise.size, 1.0 / own.rate_hz)
        density = spectrum[(frequency > 0.2) & (frequency < 20.0)].mean()
        assert np.sqrt(density * 200.0) == pytest.approx(std, rel=0.12), name


def test_surfaces_follow_commands_within_the_actuators_limits():
    flown = fly(airspeed_ratio=1.09, peak_deg=1.2, noise=False)
    for name in INPUTS:
        surface = channel(flown, name)
        assert np.abs(np.diff(surface.samples)).max() * surface.rate_hz <= np.radians(120.0)
        assert np.abs(surface.samples).max() <= np.radians(20.0)
    assert 0.15 < (flown.maneuver.max_input_correlation or 0.0) < 0.5


def test_lateral_sensors_in_the_plane_of_symmetry_measure_zero(quiet: FlownManeuver):
    assert np.ptp(channel(quiet, "ay_egi").samples) < 1e-5
    left, right = channel(quiet, "ay_wll").samples, channel(quiet, "ay_wlr").samples
    assert np.abs(left + right).max() < 1e-3 * np.ptp(left)


def test_recorded_command_is_the_design(quiet: FlownManeuver):
    command = channel(quiet, "wf3s_command")
    excitation = quiet.maneuver.excitation
    assert excitation is not None
    assert excitation.harmonics == design_fta(506, 2.0).harmonics()
    first = round(TRIM_S * command.rate_hz)
    spectrum = np.abs(np.fft.rfft(command.samples[first : first + 4800].astype(float)))
    own = list(excitation.harmonics["wf3s"])
    assert np.delete(spectrum, own).max() < 1e-5 * spectrum[own].min()


def test_unsteady_forces_are_those_of_the_lattice_at_every_frequency(store: Store):
    """The simulation has rational functions; its response to the surfaces is that of C(k)."""
    aircraft = add_aircraft(store, unsteady=True)
    assert aircraft.id is not None
    flight = store.flights.add(Flight(aircraft_id=aircraft.id, number=1))
    flown = fly(modes_in_truth=2, noise=False, unsteady=True)
    maneuver = add_maneuver(store, flown, flight.id or 0)
    request = EstimationRun(
        maneuver_id=maneuver.id or 0,
        method=Method.OE,
        structure=Structure(modes=flown.truth.modes, fixed={}),
        settings=RunSettings(out_of_band_modes=OutOfBandModes.OMITTED),
    )
    data = prepare(store, request).maneuvers[0]
    model = replace(data.model, shape=load_truth(unsteady=True).shape_at(0.5, 2))
    measured = data.measured
    response = model.response(flown.truth, measured.omega)
    outputs = np.einsum("kyu,ku->ky", response, measured.inputs.values) * measured.instruments
    true = measured.outputs.values
    error = np.sqrt(np.mean(np.abs(outputs - true) ** 2, 0) / np.mean(np.abs(true) ** 2, 0))
    assert np.median(error) < 0.003
    assert error.max() < 0.005


def test_truth_is_returned_by_name(quiet: FlownManeuver):
    truth = quiet.truth.named()
    assert truth["CZ_alpha"] == pytest.approx(-4.651281)
    assert truth["CQ7_alpha"] == pytest.approx(0.2368546)
    assert truth["Cm_wf4s"] == pytest.approx(-0.2826665)
    assert len(truth) == 44
    assert load_truth().symmetric[:2] == quiet.truth.modes
