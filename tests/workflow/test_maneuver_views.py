"""Views of a maneuver."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from flexsid.errors import BadInput
from flexsid.figures.estimates import draw_plot_matrix
from flexsid.figures.excitation import draw_spectrum
from flexsid.figures.time_histories import draw_time_history
from flexsid.records.aircraft import Combination
from flexsid.records.maneuver import Channel, Excitation, Maneuver, Role
from flexsid.workflow.views.maneuver import compute_spectrum, read_time_history
from flexsid.workflow.views.run import compute_plot_matrix

RATE_HZ = 100.0
TRIM_S = 2.0
PERIOD_S = 10.0


@pytest.fixture
def flown(store, aircraft, add_maneuver) -> Maneuver:
    """Two inputs at 3 and 5 / 10 s, at rest before and after; an accelerometer pair at 50 Hz."""
    time_s = 100.0 + np.arange(1400) / RATE_HZ
    running = (time_s >= 100.0 + TRIM_S) & (time_s < 100.0 + TRIM_S + PERIOD_S - 1e-9)
    cycle = 2 * np.pi * (time_s - 100.0 - TRIM_S) / PERIOD_S
    first = np.where(running, np.sin(3 * cycle), 0.0)
    second = np.where(running, np.sin(5 * cycle), 0.0)
    maneuver = add_maneuver(
        excitation=Excitation(
            period_s=PERIOD_S,
            harmonics={"wf4s": (5,), "wf1s": (3,)},
            start_s=100.0 + TRIM_S,
        ),
        start_s=100.0,
        duration_s=14.0,
    )

    def add_channel(name: str, unit: str, role: Role, samples: np.ndarray, rate_hz: float) -> None:
        store.channels.add(
            Channel(
                name=name,
                unit=unit,
                role=role,
                rate_hz=rate_hz,
                start_s=100.0,
                n_samples=samples.size,
                array=store.arrays.put(samples, unit),
                maneuver_id=maneuver.id,
            )
        )

    add_channel("wf1s", "deg", Role.INPUT, first, RATE_HZ)
    add_channel("wf4s", "deg", Role.INPUT, first + second, RATE_HZ)
    add_channel("az_ofl", "g", Role.OUTPUT, second[::2] + 1.0, RATE_HZ / 2)
    add_channel("az_ofr", "g", Role.OUTPUT, 3.0 * second[::2] + 1.0, RATE_HZ / 2)
    both = Combination(name="az_ofs", terms=(("az_ofl", 0.5), ("az_ofr", 0.5)))
    store.aircraft.replace(replace(aircraft, combinations=(both,)))
    return maneuver


def test_channels_are_in_si_on_the_clock_of_the_recorder(store, flown):
    value = read_time_history(store, flown.id, ("wf1s", "az_ofl"), 101.0, 103.0)
    surface, accelerometer = value.traces
    assert surface.unit == "rad"
    assert surface.time_s[0] == pytest.approx(101.0)
    assert surface.time_s[-1] == pytest.approx(102.99)
    assert surface.values.size == 200
    assert accelerometer.values[0] == pytest.approx(9.80665)
    assert value.excitation_s == pytest.approx((102.0, 112.0))


def test_symmetric_combinations_are_channels_too(store, flown):
    (trace,) = read_time_history(store, flown.id, ("az_ofs",)).traces
    assert trace.unit == "m/s2"
    assert np.ptp(trace.values) == pytest.approx(2 * 2.0 * 9.80665, rel=1e-2)


def test_inputs_are_the_default_channels(store, flown):
    names = [trace.name for trace in read_time_history(store, flown.id).traces]
    assert names == ["bfs", "wf1s", "wf4s"], "in the order of the recorder"


def test_only_the_excitation_decides_correlation(store, flown):
    value = compute_plot_matrix(store, flown.id, ("wf1s", "wf4s", "az_ofs"))
    assert value.samples.shape == (500, 3), "on the slowest clock, without trim"
    assert value.correlation[0, 1] == pytest.approx(0.5**0.5, rel=1e-6)
    assert value.correlation[0, 2] == pytest.approx(0.0, abs=1e-9)


def test_spectrum_is_at_the_assigned_harmonics(store, flown):
    value = compute_spectrum(store, flown.id, ("wf1s", "wf4s"))
    assert value.frequency_hz == pytest.approx([0.3, 0.5])
    assert value.assigned_inputs == ("wf1s", "wf4s")
    amplitude = np.deg2rad(1.0) * PERIOD_S / 2  # |transform| of a unit sine over its record
    assert value.magnitude == pytest.approx(amplitude * np.array([[1, 1], [0, 1]]), abs=1e-4)


def test_frequencies_above_nyquist_are_nan(store, add_maneuver):
    fast = add_maneuver(excitation=Excitation(period_s=1.0, harmonics={"bfs": (2, 150)}))
    value = compute_spectrum(store, fast.id, ("q",))
    assert np.isfinite(value.magnitude[0, 0])
    assert np.isnan(value.magnitude[1, 0])


def test_error_of_a_wrong_request_lists_the_options(store, flown):
    with pytest.raises(BadInput, match="it has bfs, q, wf1s, wf4s, az_ofl, az_ofr, az_ofs"):
        read_time_history(store, flown.id, ("beta",))
    with pytest.raises(BadInput, match="start must come first"):
        read_time_history(store, flown.id, (), 5.0, 5.0)
    with pytest.raises(BadInput, match="select 10 to"):
        read_time_history(store, flown.id, points=1)


def test_unknown_excitation_has_no_assigned_inputs(store, add_maneuver):
    value = compute_spectrum(store, add_maneuver(excitation=None).id)
    assert set(value.assigned_inputs) == {""}
    assert value.frequency_hz[0] == pytest.approx(2.0)
    assert value.frequency_hz[-1] <= 80.0


def test_views_can_be_drawn(store, flown):
    names = ("wf1s", "wf4s", "az_ofs")
    draw_time_history(read_time_history(store, flown.id, names))
    draw_plot_matrix(compute_plot_matrix(store, flown.id, names))
    draw_spectrum(compute_spectrum(store, flown.id, names))
