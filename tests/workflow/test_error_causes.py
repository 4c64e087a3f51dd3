"""On which frequencies an estimate rests."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from flexsid.errors import BadInput
from flexsid.records.run import EstimationRun
from flexsid.storage.store import Store
from flexsid.workflow.comparison.error_causes import read_noise_shares

# By parameter: errors by the noise at three frequencies, then by that of one prior mean.
COMPONENTS = ((0.3, 0.0, 0.4, 9.0), (0.0, 0.0, 0.0, 1.0))


@pytest.fixture
def run(add_result: Callable[..., EstimationRun]) -> EstimationRun:
    return add_result({"Cm_q": (-12.0, 9.0), "CZ_q": (1.0, 1.0)}, components=COMPONENTS)


def test_shares_of_noise_are_those_of_the_variance_without_priors(
    store: Store, run: EstimationRun
) -> None:
    found = read_noise_shares(store, run, "Cm_q", 1)
    assert found is not None
    assert np.all(np.diff(found.frequency_hz) > 0.0)
    np.testing.assert_allclose(found.shares, [0.36, 0.0, 0.64], atol=1e-6)


def test_a_value_without_noise_or_of_another_maneuver_has_no_shares(
    store: Store, run: EstimationRun
) -> None:
    assert read_noise_shares(store, run, "CZ_q", 1) is None
    assert read_noise_shares(store, run, "Cm_q", 2) is None


def test_a_parameter_that_was_not_estimated_is_named(store: Store, run: EstimationRun) -> None:
    with pytest.raises(BadInput, match=r"run 1 did not estimate 'Cm_eta7'; expected one of Cm_q"):
        read_noise_shares(store, run, "Cm_eta7", 1)
