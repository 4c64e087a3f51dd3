"""Frequency responses of the bare airframe from one closed-loop maneuver, against the truth."""

from __future__ import annotations

import numpy as np
import pytest
from true_responses import (
    compute_open_loop_ratios,
    compute_relative_errors,
    save_and_measure,
)

from flexsid.demo.flights import fly


@pytest.mark.parametrize(("ratio", "peak_deg", "limit"), [(0.65, 2.0, 0.006), (1.09, 1.2, 0.04)])
def test_without_noise_the_feedback_is_taken_out(store, ratio, peak_deg, limit):
    """The ratio at own harmonics, right in open loop only, is worse by more than five times."""
    flown = fly(airspeed_ratio=ratio, peak_deg=peak_deg, noise=False)
    measured = save_and_measure(store, flown)
    assert len(measured.outputs.names) >= 20
    found = np.median(np.abs(compute_relative_errors(measured.responses, ratio)))
    own = compute_open_loop_ratios(measured)
    assert found <= limit
    assert np.median(np.abs(compute_relative_errors(own, ratio))) > 5.0 * found


@pytest.mark.parametrize(("ratio", "peak_deg"), [(0.65, 2.0), (1.09, 1.2)])
def test_two_standard_errors_cover_the_truth_at_their_nominal_rate(store, ratio, peak_deg):
    """Both along the response (magnitude) and across it (phase)."""
    responses = save_and_measure(
        store, fly(airspeed_ratio=ratio, peak_deg=peak_deg, seed=8)
    ).responses
    error = compute_relative_errors(responses, ratio)
    spread = np.concatenate(
        [(r.std / np.abs(r.values))[:, :, 0].ravel() for r in responses.values()]
    )
    sigma = spread * np.abs(1.0 + error) / np.sqrt(2.0)
    inside = np.abs([np.real(error), np.imag(error)]) <= 2.0 * sigma
    assert 0.90 <= inside.mean() <= 0.98


def test_three_periods_without_the_first_are_as_good_as_one_with_trim(store):
    one, three = (
        save_and_measure(store, fly(airspeed_ratio=0.65, noise=False, n_periods=n)).responses
        for n in (1, 3)
    )
    good = np.median(np.abs(compute_relative_errors(one, 0.65)))
    assert good <= 1e-4
    assert np.median(np.abs(compute_relative_errors(three, 0.65))) <= 1.2 * good
