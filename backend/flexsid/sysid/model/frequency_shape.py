"""Frequency shape of derivatives in unsteady flow, and rational functions for its states.

A doublet lattice predicts how air forces lag the motion better than how large they are. The
shape s is its prediction C_rv(k) over Re C_rv(k_ref), so that the derivatives c that are estimated
are those at the reference frequency; a quasi-steady model is s = 1.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy
from jaxtyping import Complex, Float

from flexsid.errors import BadInput
from flexsid.sysid.model.condition import FlightCondition
from flexsid.sysid.model.derivatives import coefficients, list_derivative_names, variables
from flexsid.sysid.model.longitudinal import LONGITUDINAL
from flexsid.sysid.model.rigid_body import RigidBody

# --- Frequency shape of derivatives in unsteady flow: C_rv(k) = c_rv s_rv(k), with real c_rv ------

SMALLEST_RATIO = 0.02
"""Re C(k_ref) over the largest |C(k)|, below which a derivative has no shape.

A factor on a derivative that is nearly zero at k_ref would move its rest of the table freely."""


@dataclass(frozen=True, slots=True, eq=False)
class FrequencyShape:
    """Factors on all derivatives of a model by reduced frequency k = omega cbar/2V.

    ``factors`` are one at ``reference_k`` but for their imaginary part. ``unshaped`` names the
    derivatives whose factor is one at all k: they have no prediction, or one near zero.
    """

    modes: tuple[int, ...]
    inputs: tuple[str, ...]
    k: Float[np.ndarray, " n_k"]
    factors: Complex[np.ndarray, "n_k n_rows n_w"]
    reference_k: float
    unshaped: tuple[str, ...] = ()
    body: RigidBody = LONGITUDINAL

    def at(self, k: Float[np.ndarray, " n"]) -> Complex[np.ndarray, "n n_rows n_w"]:
        """Interpolate the factors by cubic splines.

        Raises
        ------
        BadInput
            Beyond the highest k of the shape.
        """
        highest = float(np.max(k, initial=0.0))
        if highest > self.k[-1] * (1.0 + 1e-12):
            raise BadInput(
                f"the data reach the reduced frequency {highest:.3g}, the frequency shape only "
                f"{self.k[-1]:.3g}; compute the prediction to a higher one or shorten the band",
                code="frequency-out-of-range",
            )
        return np.asarray(scipy.interpolate.CubicSpline(self.k, self.factors, axis=0)(k))

    def select(self, modes: tuple[int, ...], inputs: tuple[str, ...]) -> FrequencyShape:
        """Return the shape of some modes and inputs; others than known ones are unshaped."""
        if (modes, inputs) == (self.modes, self.inputs):
            return self
        names = list_derivative_names(self.modes, self.inputs, self.body)
        known = dict(zip(names, self.factors.reshape(self.k.size, -1).T, strict=True))
        own = list_derivative_names(modes, inputs, self.body)
        unshaped = tuple(name for name in own if name not in known or name in self.unshaped)
        one = np.ones(self.k.size, dtype=complex)
        factors = np.stack([known.get(name, one) for name in own], axis=1)
        n_rows = len(coefficients(modes, self.body))
        by_place = factors.reshape(self.k.size, n_rows, -1)
        return FrequencyShape(
            modes, inputs, self.k, by_place, self.reference_k, unshaped, self.body
        )

    def add_gust(self, name: str) -> FrequencyShape:
        """Return the shape with a gust as the last input: of the derivatives in the flow angle."""
        rows, angle = coefficients(self.modes, self.body), self.body.motions[0]
        unshaped = tuple(f"{row}_{name}" for row in rows if f"{row}_{angle}" in self.unshaped)
        return replace(
            self,
            inputs=(*self.inputs, name),
            factors=np.concatenate([self.factors, self.factors[:, :, :1]], axis=2),
            unshaped=(*self.unshaped, *unshaped),
        )


def build_frequency_shape(
    modes: tuple[int, ...],
    inputs: tuple[str, ...],
    k: Float[np.ndarray, " n_k"],
    predicted: dict[str, Complex[np.ndarray, " n_k"]],
    reference_k: float,
    body: RigidBody = LONGITUDINAL,
    smallest_ratio: float = SMALLEST_RATIO,
) -> FrequencyShape:
    """Build the shape of a model's derivatives from predicted C_rv(k).

    Parameters
    ----------
    modes, inputs
        Of the model.
    k
        Reduced frequencies omega cbar/2V of the prediction, rising from 0. [1]
    predicted
        Complex derivatives by name, such as ``CQ7_etadot9``. Each column is the response to a
        real normal wash.
    reference_k
        At which the estimated derivatives are those of the prediction.
    body
        Axis of the model.
    smallest_ratio
        Of |Re C_rv(k_ref)| to the largest |C_rv(k)|, up to which a derivative is unshaped; 0 where
        the derivatives are those of the prediction itself, and are not estimated.

    Raises
    ------
    BadInput
        If the frequencies do not rise from 0, the reference is outside, or a value is no number.

    Notes
    -----
    s_rv(k) = C_rv(k) / Re C_rv(k_ref), the reference by a cubic spline; s_rv = 1 without a
    prediction, or where |Re C_rv(k_ref)| is at most ``smallest_ratio`` of the largest |C_rv(k)|.
    """
    if k.size < 2 or k[0] != 0.0 or not (np.diff(k) > 0.0).all():
        raise BadInput("reduced frequencies must rise from 0", code="bad-frequency")
    if not 0.0 <= reference_k <= k[-1]:
        raise BadInput(
            f"the reference k = {reference_k:g} is outside 0 to {k[-1]:.3g}",
            code="frequency-out-of-range",
        )
    names = list_derivative_names(modes, inputs, body)
    factors = np.ones((k.size, len(names)), dtype=complex)
    unshaped = []
    for column, name in enumerate(names):
        values = predicted.get(name)
        if values is None:
            unshaped.append(name)
            continue
        if not np.isfinite(values).all():
            raise BadInput(f"the predicted {name} is not a number", code="not-finite", name=name)
        reference = float(np.real(scipy.interpolate.CubicSpline(k, values)(reference_k)))
        if abs(reference) <= smallest_ratio * np.abs(values).max():
            unshaped.append(name)
            continue
        factors[:, column] = values / reference
    shape = (k.size, len(coefficients(modes, body)), len(variables(modes, inputs, body)))
    by_place = factors.reshape(shape)
    return FrequencyShape(modes, inputs, k, by_place, reference_k, tuple(unshaped), body)


# --- Rational functions of a frequency shape: states of the wake for time histories and poles -----

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
