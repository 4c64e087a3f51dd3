"""Frequency shape of derivatives in unsteady flow: C_rv(k) = c_rv s_rv(k), with real c_rv.

A doublet lattice predicts how air forces lag the motion better than how large they are. The
shape s is its prediction C_rv(k) over Re C_rv(k_ref), so that the derivatives c that are estimated
are those at the reference frequency; a quasi-steady model is s = 1.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Complex, Float
from scipy.interpolate import CubicSpline

from flexsid.errors import BadInput
from flexsid.sysid.model.derivatives import coefficients, list_derivative_names, variables
from flexsid.sysid.model.longitudinal import LONGITUDINAL
from flexsid.sysid.model.rigid_body import RigidBody

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
        return np.asarray(CubicSpline(self.k, self.factors, axis=0)(k))

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
        reference = float(np.real(CubicSpline(k, values)(reference_k)))
        if abs(reference) <= smallest_ratio * np.abs(values).max():
            unshaped.append(name)
            continue
        factors[:, column] = values / reference
    shape = (k.size, len(coefficients(modes, body)), len(variables(modes, inputs, body)))
    by_place = factors.reshape(shape)
    return FrequencyShape(modes, inputs, k, by_place, reference_k, tuple(unshaped), body)
