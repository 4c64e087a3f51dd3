"""Time skews of the measured surfaces against the motion that they cause.

Sensors have redundancy; surfaces have none. But the coefficients of the reconstructed motion
are sums over motion and surfaces with real derivatives (Eq. 23). A surface that was recorded
late by tau gives its rate a derivative of tau times its own, with one tau for all coefficients.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float

from flexsid.errors import NotIdentifiable
from flexsid.sysid.estimation.equation_error import (
    MotionNoise,
    build_regressors,
    compute_aerodynamic_coefficients,
)
from flexsid.sysid.estimation.reconstruction import ReconstructedMotion
from flexsid.sysid.estimation.regression import ErrorsInVariables, regress
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.derivatives import coefficients
from flexsid.sysid.preparation.redundancy import select_strong_frequencies
from flexsid.sysid.signals import FrequencyData

_STEPS = 8
_SMALL_S = 2e-6  # smaller steps of a delay end the iteration [s]
_LARGEST_CONDITION = 1e10  # of the scaled information: above it, delays are not identifiable
_IN_BAND = 1.3  # of the highest frequency: modes further above respond by their stiffness only


@dataclass(frozen=True, slots=True)
class InputSkews:
    """Delay of every input beyond the reference of the motion, with standard errors. [s]"""

    names: tuple[str, ...]
    delay_s: Float[np.ndarray, " n_u"]
    delay_std: Float[np.ndarray, " n_u"]


def estimate_input_skews(
    model: AeroelasticModel,
    motion: ReconstructedMotion,
    inputs: FrequencyData,
    noise: Float[np.ndarray, "n_omega n_u"] | None = None,
    near: InputSkews | None = None,
) -> InputSkews:
    """Estimate the delays on which the derivatives of all coefficients agree.

    Parameters
    ----------
    model
        Condition, modes and inputs.
    motion
        Reconstructed from sensors whose delays are undone.
    inputs
        Surface deflections, known instruments undone. [rad s]
    noise
        Variance of the inputs' spectra, none by default. [rad2 s2]
    near
        Skews to begin with; none by default.

    Raises
    ------
    NotIdentifiable
        If there are fewer frequencies than derivatives, or a surface has no effect.

    Notes
    -----
    Errors of the motion are taken out of each regression as in equation error. Standard
    errors grow where the coefficients disagree (Birge, Phys. Rev. 40, 1932).
    """
    u = inputs.pick(model.inputs).values
    n_u = u.shape[1]
    if n_u == 0:
        raise NotIdentifiable("no surface was recorded", code="no-input")
    some = select_strong_frequencies(u)
    seen = ReconstructedMotion(
        motion.omega[some], motion.values[some], motion.covariance[some], motion.noise
    )
    equations = _Equations.of(model, seen, None if noise is None else noise[some])
    delay = np.zeros(n_u) if near is None else near.delay_s
    information, excess = np.eye(n_u), 1.0
    for _ in range(_STEPS):
        turned = u[some] * np.exp(1j * seen.omega[:, None] * delay)
        step, information, excess = equations.step(FrequencyData(seen.omega, turned, model.inputs))
        delay = delay + step
        if np.max(np.abs(step)) < _SMALL_S:
            break
    variance = np.diag(np.linalg.inv(information))
    return InputSkews(model.inputs, delay, np.sqrt(max(1.0, excess) * variance))


@dataclass(frozen=True, slots=True)
class _Equations:
    """Coefficients (n_omega, n_rows) of the rows in use, each with the errors of its regressors."""

    model: AeroelasticModel
    motion: ReconstructedMotion
    C: Complex[np.ndarray, "n_omega n_rows"]
    rows: tuple[int, ...]
    errors: tuple[ErrorsInVariables, ...]

    @classmethod
    def of(
        cls,
        model: AeroelasticModel,
        motion: ReconstructedMotion,
        noise: Float[np.ndarray, "n_omega n_u"] | None,
    ) -> _Equations:
        top = _IN_BAND * motion.omega[-1]
        rows = (0, 1, *(2 + k for k, own in enumerate(model.modes.omega) if own < top))
        motion_noise = MotionNoise(model, motion)
        n_u = len(model.inputs)
        p = 2 + 2 * len(model.modes.numbers) + n_u
        of_inputs = np.zeros((motion.omega.size, p + n_u))
        if noise is not None:
            of_inputs[:, p - n_u : p] = noise
            of_inputs[:, p:] = noise * motion.omega[:, None] ** 2
        errors = []
        for row in rows:
            known = motion_noise.compute_row_errors(row, np.zeros(p), np.arange(p))
            spread = of_inputs[:, :, None] * np.eye(p + n_u)
            spread[:, :p, :p] += known.regressors
            cross = np.zeros((motion.omega.size, p + n_u))
            cross[:, :p] = known.cross
            errors.append(ErrorsInVariables(spread, cross, known.dependent))
        return cls(
            model, motion, compute_aerodynamic_coefficients(model, motion), rows, tuple(errors)
        )

    def step(self, inputs: FrequencyData) -> tuple[np.ndarray, np.ndarray, float]:
        """Further delay, its information, and the scatter of the rows over their errors."""
        n_u = len(inputs.names)
        X = build_regressors(self.model, self.motion, inputs)
        X = np.concatenate([X, 1j * inputs.omega[:, None] * inputs.values], axis=1)
        names = coefficients(self.model.modes.numbers)
        gains, rates, weights = [], [], []
        for row, error in zip(self.rows, self.errors, strict=True):
            labels = tuple(f"{names[row]}_{k}" for k in range(X.shape[1]))
            found = regress(X, self.C[:, row], labels, error)
            gains.append(found.values[-2 * n_u : -n_u])
            rates.append(found.values[-n_u:])
            weights.append(np.linalg.inv(found.covariance[-n_u:, -n_u:]))
        theta, rate, weight = np.array(gains), np.array(rates), np.array(weights)
        information = np.einsum("ru,ruv,rv->uv", theta, weight, theta)
        size = np.sqrt(np.diag(information))
        if (
            not np.all(size > 0)
            or np.linalg.cond(information / np.outer(size, size)) > _LARGEST_CONDITION
        ):
            raise NotIdentifiable(
                "the delays of the surfaces are not identifiable from the coefficients",
                code="no-redundancy",
            )
        step = np.linalg.solve(information, np.einsum("ru,ruv,rv->u", theta, weight, rate))
        apart = rate - theta * step
        chi_square = float(np.einsum("ru,ruv,rv->", apart, weight, apart))
        return step, information, chi_square / ((len(self.rows) - 1) * n_u)
