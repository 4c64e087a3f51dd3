"""Records that a recorder clips or rounds are recognised; those of a surface that stops are not."""

from __future__ import annotations

import numpy as np
import pytest

from flexsid.sysid.preparation.recorder_range import (
    compute_clipped_share,
    find_rounding_step,
    smooth_rounded,
)

TIME = np.arange(8000) / 400.0
MOTION = np.sin(2.0 * np.pi * 0.4 * TIME) + 0.3 * np.sin(2.0 * np.pi * 1.1 * TIME)


def test_steps_of_rounding_are_those_of_the_recorder():
    assert find_rounding_step(0.1 * np.rint(MOTION / 0.1)) == pytest.approx(0.1)
    assert find_rounding_step(0.01 * np.rint(MOTION / 0.01)) is None, "1 % of the range is fine"
    assert find_rounding_step(MOTION) is None
    assert find_rounding_step(np.zeros(100)) is None


def test_a_smoothed_signal_is_nearer_to_the_motion_and_within_half_a_step():
    rounded = 0.1 * np.rint(MOTION / 0.1)
    smooth = smooth_rounded(rounded, 0.1)
    assert np.abs(smooth - rounded).max() <= 0.05 + 1e-12
    assert np.std(smooth - MOTION) < 0.5 * np.std(rounded - MOTION)


def test_abrupt_stops_are_clipped_samples_and_gradual_ones_are_not():
    pulses = 0.5 * np.sign(np.sin(2.0 * np.pi * 0.5 * TIME + 0.1)) + 0.02 * MOTION
    high = pulses > 0.0
    clipped = np.where(high, pulses[high].min(), pulses)
    assert compute_clipped_share(clipped) == pytest.approx(high.mean(), abs=0.06)
    assert compute_clipped_share(np.clip(MOTION, -0.8, 0.8)) == 0.0
