"""Transfer functions of known systems from imported records, by usual orders and bands."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from equivalent_systems import SYSTEMS, add_noise, fit, simulate

from flexsid.storage.store import Store

pytestmark = pytest.mark.parametrize("backend", ["sqlite"])


@pytest.mark.parametrize("system", ["pitch rate", "pitch angle"])
def test_a_record_that_begins_and_ends_in_motion_gives_the_system(
    store: Store, tmp_path: Path, system: str
) -> None:
    """Without noise its ends were the largest error: 5 % of the damping ratio."""
    name, known = "part of a multisine", SYSTEMS[system]
    found = fit(store, tmp_path, known, name, simulate(known, name), system)
    for key, error, _ in known.pair(found):
        assert abs(error) < 0.002 * abs(getattr(known, key)), key
    assert found.is_close
    assert found.gain_unit == ("(rad/s)/(rad s)" if system == "pitch rate" else "rad/(rad s2)")


@pytest.mark.parametrize(
    ("draws", "least"), [(5, 0.75), pytest.param(100, 0.91, marks=pytest.mark.long)]
)
@pytest.mark.parametrize("excitation", ["six harmonics", "3-2-1-1"])
def test_two_standard_errors_hold_the_system(
    store: Store, tmp_path: Path, excitation: str, draws: int, least: float
) -> None:
    """Also where an input has fewer harmonics than the scatter of neighbours needs."""
    known = SYSTEMS["pitch rate"]
    clean = simulate(known, excitation)
    ratios = []
    for seed in range(draws):
        columns = add_noise(clean, 0.1, 0.0, np.random.default_rng(seed))
        found = fit(store, tmp_path, known, excitation, columns, f"seed {seed}")
        ratios += [error / std for _, error, std in known.pair(found)]
        assert found.is_close, "noise is no mismatch"
    assert np.mean(np.abs(ratios) < 2.0) > least, np.round(ratios, 1)
    assert draws < 20 or np.mean(np.abs(ratios) < 2.0) < 0.985
