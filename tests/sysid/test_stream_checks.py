"""A user relies on: defects of a stream are found as it arrives, and only short gaps are filled."""

from __future__ import annotations

import numpy as np

from flexsid.sysid.preparation.spikes_and_dropouts import LONGEST_REPAIR, StreamChecks

RATE_HZ, BLOCK = 200.0, 10


def check(samples: np.ndarray, noisy: np.ndarray | None = None):
    """Send samples through in blocks; return what comes out, spikes and frozen blocks."""
    n_channels = samples.shape[1]
    noisy = np.ones(n_channels, dtype=bool) if noisy is None else noisy
    checks = StreamChecks(RATE_HZ, n_channels, noisy)
    out, spikes, frozen = [], np.zeros(n_channels, dtype=int), np.zeros(n_channels, dtype=int)
    for first in range(0, len(samples), BLOCK):
        checks.append(samples[first : first + BLOCK])
        while checks.ready >= BLOCK:
            found = checks.take(BLOCK, moving=True)
            out.append(found.samples)
            spikes += found.spikes
            frozen += found.frozen
    return np.concatenate(out), spikes, frozen


def noisy_motion(n: int = 2000) -> np.ndarray:
    time = np.arange(n) / RATE_HZ
    motion = np.stack([np.sin(2 * np.pi * 3.0 * time), np.cos(2 * np.pi * 9.0 * time)], axis=1)
    return motion + 0.01 * np.random.default_rng(1).normal(size=motion.shape)


def test_clean_samples_pass_unchanged():
    clean = noisy_motion()
    out, spikes, frozen = check(clean)
    assert len(out) > 1800
    assert np.array_equal(out, clean[: len(out)])
    assert not spikes.any()
    assert not frozen.any()


def test_spikes_and_gaps_of_two_samples_are_interpolated_longer_gaps_are_not():
    clean = noisy_motion()
    bad = clean.copy()
    bad[[500, 900], 0] += [5.0, -3.0]
    bad[700 : 700 + LONGEST_REPAIR, 1] = np.nan
    bad[1200 : 1201 + LONGEST_REPAIR, 1] = np.nan
    out, spikes, frozen = check(bad)
    assert spikes.tolist() == [2, 0]
    assert not frozen.any()
    missing = np.isnan(out)
    assert not missing[:, 0].any()
    assert np.flatnonzero(missing[:, 1]).tolist() == [1200, 1201, 1202]
    assert np.nanmax(np.abs(out - clean[: len(out)])) < 0.1


def test_a_frozen_channel_is_missing_from_its_first_equal_sample_on():
    frozen = noisy_motion()
    frozen[1000:1400, 0] = frozen[1000, 0]
    frozen[:, 1] = 0.0  # a command at rest, which is not noisy
    out, _, blocks = check(frozen, np.array([True, False]))
    assert np.flatnonzero(np.isnan(out[:, 0])).tolist() == list(range(1000, 1400))
    assert blocks[0] == 40
    assert not np.isnan(out[:, 1]).any()
