"""Rational functions of a frequency shape: states of the wake for time histories and poles."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from flexsid.sysid.model.condition import FlightCondition
from flexsid.sysid.model.frequency_shape import FrequencyShape

LAGS = np.array([0.1, 0.3, 0.8, 2.0, 5.0, 12.0, 30.0, 70.0])
"""Poles of the lags over 2V/cbar. Four represent the circulation; the fast ones the k^2 part that a
doublet lattice has above k = 1. On FLEX-28U the fit is within 0.07 % rms, worst entry 1.6 %."""

_FIT_POINTS = 81  # reduced frequencies of the fit


@dataclass(frozen=True, slots=True, eq=False)
class LaggedForces:
    """Forces and states of a model with lags.

    ``loads`` are the variables of every row, on states and inputs, zero on the attitude;
    ``lag_rates`` the rows of the lag states in the state matrix, on states and inputs. States are
    the motions of the rigid body, its attitude, eta, etadot and the lags.
    """

    states: tuple[str, ...]
    loads: Float[np.ndarray, "n_rows n_w n_z"]
    lag_rates: Float[np.ndarray, "n_lags n_z"]


def fit_rational_functions(
    shape: FrequencyShape,
) -> tuple[Float[np.ndarray, "n_rows n_w"], Float[np.ndarray, "n_l n_rows n_w"]]:
    """Fit s(k) = D - sum_l B_l g_l/(ik + g_l) with fixed lags by least squares.

    Returns
    -------
    D, B
        Direct part, and that of each lag.

    Notes
    -----
    Roger, AGARD-CP-228 (1977), with p/(p + g) = 1 - g/(p + g), so that the lags are driven by the
    variables and not by their rates; without terms in p and p^2 the state matrix is linear in
    every derivative, and inputs need no rates.
    """
    k = np.union1d(shape.k, np.linspace(0.0, shape.k[-1], _FIT_POINTS))
    values = shape.at(k).reshape(k.size, -1)
    p = 1j * k[:, None]
    basis = np.concatenate([np.ones((k.size, 1)), -LAGS / (p + LAGS)], axis=1)
    found = np.linalg.lstsq(
        np.concatenate([np.real(basis), np.imag(basis)]),
        np.concatenate([np.real(values), np.imag(values)]),
        rcond=None,
    )[0]
    found = found.reshape(-1, *shape.factors.shape[1:])
    return found[0], found[1:]


def build_lagged_forces(shape: FrequencyShape, condition: FlightCondition) -> LaggedForces:
    """Build the lag states of a model at one condition.

    Notes
    -----
    w = g/(p + g) v has the rate g (v - w) 2V/cbar. Columns of etadot need no lags of their own:
    g/(p + g) p eta = g (eta - w).
    """
    direct, lagged = fit_rational_functions(shape)
    body, rate_factor = shape.body, condition.rate_factor
    first, n, n_u, n_l = body.size, len(shape.modes), len(shape.inputs), LAGS.size
    factors = body.column_factors(condition, n, n_u)
    n_motion = first + 1 + 2 * n
    eta = first + 1 + np.arange(n)
    etadot = eta + n
    sources = [*body.name_motions(shape.modes), *shape.inputs]
    n_x = n_motion + len(sources) * n_l
    places = np.array([*range(first), *eta, *range(n_x, n_x + n_u)])
    lag_states = n_motion + np.arange(len(sources) * n_l).reshape(-1, n_l)
    loads = np.zeros((*direct.shape, n_x + n_u))
    columns = [*range(first + n), *range(first + 2 * n, first + 2 * n + n_u)]
    for source, column in enumerate(columns):
        loads[:, column, places[source]] = factors[column] * direct[:, column]
        loads[:, column, lag_states[source]] = -factors[column] * lagged[:, :, column].T
    for mode in range(n):
        column = first + n + mode
        by_lag = (LAGS[:, None] * lagged[:, :, column]).T
        loads[:, column, etadot[mode]] = factors[column] * direct[:, column]
        loads[:, column, eta[mode]] = -by_lag.sum(axis=1)
        loads[:, column, lag_states[first + mode]] = by_lag
    rates = np.zeros((lag_states.size, n_x + n_u))
    every = np.arange(lag_states.size)
    speed = np.tile(LAGS, len(sources)) / rate_factor
    rates[every, lag_states.ravel()] = -speed
    rates[every, np.repeat(places, n_l)] = speed
    names = (
        *(*body.motions, body.attitude),
        *(f"eta{m}" for m in shape.modes),
        *(f"etadot{m}" for m in shape.modes),
        *(f"lag{number}_{source}" for source in sources for number in range(1, n_l + 1)),
    )
    return LaggedForces(names, loads, rates)
