"""The filters are those of the textbook."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import signal

from flexsid.sysid.model.sensor_models import Butterworth


@pytest.mark.parametrize("order", [1, 2, 3, 4, 7])
def test_butterworth_is_that_of_scipy(order: int) -> None:
    ours = Butterworth(order=order, corner=37.0).polynomials()
    theirs = signal.butter(order, 37.0, analog=True)
    np.testing.assert_allclose(ours[0], theirs[0], rtol=1e-12)
    np.testing.assert_allclose(ours[1], theirs[1], rtol=1e-12)
