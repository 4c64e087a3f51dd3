"""Inverses at all frequencies at once are those of LAPACK, also where pivots vanish."""

from __future__ import annotations

import numpy as np
import pytest

from flexsid.sysid.estimation.linear_algebra import Elimination


@pytest.mark.parametrize("n_r", range(2, 9))
@pytest.mark.parametrize("n_omega", [20, 200])
def test_inverses_are_those_of_lapack(n_r, n_omega):
    rng = np.random.default_rng(n_r)
    shape = (n_omega, n_r, n_r)
    K = rng.normal(size=shape) + 1j * rng.normal(size=shape)
    K[:10, 0, 0] *= 10.0 ** -np.arange(0.0, 20.0, 2.0)
    K[10] = np.eye(n_r)[::-1]
    found, expected = Elimination(n_omega, n_r).inverse(K), np.linalg.inv(K)
    error = np.abs(found - expected).max(axis=(1, 2)) / np.abs(expected).max(axis=(1, 2))
    assert np.all(error < 1e-12 * np.linalg.cond(K))
