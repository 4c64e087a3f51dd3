"""Time skews of the measured surfaces against the motion that they cause.

Sensors have redundancy; surfaces have none. But the coefficients of the reconstructed motion
are sums over motion and surfaces with real derivatives (Eq. 23). A surface that was recorded
late by tau gives its rate a derivative of tau times its own, with one tau for all coefficients.
"""

from __future__ import annotations

from collections.abc import Sequence
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
from flexsid.sysid.preparation.redundancy import select_strong_frequencies
from flexsid.sysid.signals import FrequencyData

_STEPS = 8  # at most
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
    motion
        Reconstructed from sensors whose delays are undone.
    inputs, noise
        Surface deflections, known instruments undone [rad s], and the variance of their
        spectra, none by default. [rad2 s2]
    near
        Skews to begin with; none by default.

    Raises
    ------
    NotIdentifiable
        If there are fewer frequencies than derivatives, or a surface has no effect.

    Notes
    -----
    Errors of the motion are taken out of each regression as in equation error. Standard
    errors grow where the coefficients disagree (Birge, Phys. Rev. 40, 1932,
    doi:10.1103/PhysRev.40.207).
    """
    u = inputs.pick(model.inputs).values
    n_u = u.shape[1]
    if n_u == 0:
        raise NotIdentifiable("no surface was recorded", code="no-input")
    some = select_strong_frequencies(u)
    seen = ReconstructedMotion(
        motion.omega[some], motion.values[some], motion.covariance[some], motion.noise
    )
    top = _IN_BAND * seen.omega[-1]
    first = model.n_rigid
    rows = [*range(first), *(first + k for k, own in enumerate(model.modes.omega) if own < top)]
    errors = _gather_errors(model, seen, rows, None if noise is None else noise[some])
    coefficients = compute_aerodynamic_coefficients(model, seen)[:, rows]
    delay = np.zeros(n_u) if near is None else near.delay_s
    information, excess = np.eye(n_u), 1.0
    for _ in range(_STEPS):
        turned = u[some] * np.exp(1j * seen.omega[:, None] * delay)
        X = build_regressors(model, seen, FrequencyData(seen.omega, turned, model.inputs))
        X = np.concatenate([X, 1j * seen.omega[:, None] * turned], axis=1)
        step, information, excess = _solve_step(X, coefficients, errors, n_u)
        delay = delay + step
        if np.max(np.abs(step)) < _SMALL_S:
            break
    variance = np.diag(np.linalg.inv(information))
    return InputSkews(model.inputs, delay, np.sqrt(max(1.0, excess) * variance))


def _gather_errors(
    model: AeroelasticModel,
    motion: ReconstructedMotion,
    rows: Sequence[int],
    noise: Float[np.ndarray, "n_omega n_u"] | None,
) -> list[ErrorsInVariables]:
    """Errors of the regressors of every row: motion, inputs, and rates of the inputs."""
    motion_noise, n_u = MotionNoise(model, motion), len(model.inputs)
    p = len(model.variables)
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
    return errors


def _solve_step(
    X: Complex[np.ndarray, "n_omega p"],
    C: Complex[np.ndarray, "n_omega n_rows"],
    errors: Sequence[ErrorsInVariables],
    n_u: int,
) -> tuple[np.ndarray, np.ndarray, float]:
    """Further delay, its information, and the scatter of the rows over their errors."""
    labels = tuple(f"regressor {k + 1}" for k in range(X.shape[1]))
    found = [regress(X, z, labels, error) for z, error in zip(C.T, errors, strict=True)]
    theta = np.array([one.values[-2 * n_u : -n_u] for one in found])
    rate = np.array([one.values[-n_u:] for one in found])
    weight = np.array([np.linalg.inv(one.covariance[-n_u:, -n_u:]) for one in found])
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
    return step, information, chi_square / ((len(found) - 1) * n_u)
