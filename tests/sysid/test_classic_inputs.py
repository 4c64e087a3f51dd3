"""A user relies on: classic inputs move one surface at a time, each as its name states."""

from __future__ import annotations

import numpy as np

from flexsid.sysid.excitation.checks import design_classic_input, pulse_lengths

PEAKS = {"bfs": 2.0, "wf1s": 1.0}


def test_surfaces_move_in_turn_and_rest_afterwards():
    history = design_classic_input("doublet", PEAKS, 10.0, 50.0, 12.0, (0.5, 5.0), pulse_s=0.5)
    assert history.values.shape == (600, 2)
    first, second = history.values.T
    np.testing.assert_array_equal(first[:25], 2.0)
    np.testing.assert_array_equal(first[25:50], -2.0)
    assert not first[50:].any()
    np.testing.assert_array_equal(second[250:275], 1.0)
    assert not second[:250].any()
    assert not second[500:].any()


def test_3_2_1_1_has_seven_units_in_alternate_directions():
    history = design_classic_input(
        "3-2-1-1", {"bfs": 1.0}, 10.0, 10.0, 10.0, (0.5, 5.0), pulse_s=0.2
    )
    np.testing.assert_array_equal(
        history.values[:14, 0], np.repeat([1, 1, 1, -1, -1, 1, -1], 2).astype(float)
    )


def test_a_sweep_goes_through_its_band():
    history = design_classic_input("sweep", {"bfs": 1.0}, 20.0, 100.0, 20.0, (1.0, 5.0))
    spectrum = np.abs(np.fft.rfft(history.values[:, 0])) ** 2
    hz = np.fft.rfftfreq(2000, 0.01)
    inside = (hz > 0.8) & (hz < 5.2)
    assert spectrum[inside].sum() > 0.97 * spectrum.sum()
    rising = np.diff(np.flatnonzero(np.diff(np.sign(history.values[:, 0])) > 0))
    assert rising[0] > 4 * rising[-1]


def test_pulses_to_choose_from_fit_their_turn():
    lengths = pulse_lengths("3-2-1-1", 24.0, 5, 100.0)
    assert lengths[0] >= 0.02
    assert 7 * lengths[-1] <= 24.0 / 5
