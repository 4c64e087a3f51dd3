"""Array shapes of ``flexsid.sysid`` are checked at run time, in the first calls of each test."""

from __future__ import annotations

import numpy as np
import pytest
from jaxtyping import TypeCheckError
from shape_checks import CHECKED_CALLS

from flexsid.sysid.spectra.response_estimators import transform_block


def test_a_wrong_shape_is_named_in_the_first_calls():
    with pytest.raises(TypeCheckError, match="n_samples"):
        transform_block(np.ones((4, 2)), np.ones(3))


def test_calls_after_them_are_not_checked():
    for _ in range(CHECKED_CALLS):
        transform_block(np.ones((4, 2)), np.ones(4))
    with pytest.raises(ValueError, match="broadcast"):
        transform_block(np.ones((4, 2)), np.ones(3))
