"""Model order: reduced models with every number of modes compared with the full one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float
from scipy.optimize import linear_sum_assignment

from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.model.reduction import compute_static_recovery, residualize, truncate

BAND = 0.10
"""Within this share of the full model's a derivative counts as unbiased (Fig. 13)."""

POLE_BAND = 0.05
"""Within this relative distance of the full model's a pole counts as unbiased."""
_SMALL_SHARE = 0.05  # of the largest of its kind: smaller derivatives are not compared


@dataclass(frozen=True, slots=True, eq=False)
class ReducedModel:
    """A model with the first modes of the full one.

    ``worst`` is the rigid-body derivative with the largest relative error
    ``bias``; ``pole_error`` is the largest relative distance of a pole in the band from
    the full model's, ``response_error`` the relative rms error of the responses there (None
    without sensors).
    """

    modes: tuple[int, ...]
    residualized: DerivativeTable
    truncated: DerivativeTable
    poles: Complex[np.ndarray, " n_poles"]
    truncated_poles: Complex[np.ndarray, " n_poles"]
    worst: str
    bias: float
    pole_error: float
    response_error: float | None

    @property
    def sufficient(self) -> bool:
        """Whether derivatives and poles are those of the full model, within the bands."""
        return self.bias <= BAND and self.pole_error <= POLE_BAND


@dataclass(frozen=True, slots=True, eq=False)
class OrderStudy:
    """Reduced models with 0, 1, 2 ... modes; the last is the full model.

    ``needed`` is the least number of modes from which on all are sufficient.
    """

    full: DerivativeTable
    poles: Complex[np.ndarray, " n_poles"]
    steps: tuple[ReducedModel, ...]
    needed: int


def study_order(
    model: AeroelasticModel,
    derivatives: DerivativeTable,
    omega: Float[np.ndarray, " n_omega"],
) -> OrderStudy:
    """Reduce a model to every order and compare.

    Parameters
    ----------
    model
        Condition, structure and sensors of the full model, modes in the order in which
        they are retained (by frequency).
    derivatives
        Of the full model.
    omega
        Frequencies of the band of interest; poles up to its end are compared. [rad/s]

    Notes
    -----
    Source: Sec. VI.B and Fig. 13. The derivatives judged are those of C_Z and C_m in alpha,
    q and the inputs; those below a twentieth of the largest of their kind are omitted, as
    their ratio is not significant. Departure: poles are compared as well, since beyond
    flutter a model with unbiased rigid-body derivatives can have the wrong unstable root.
    """
    numbers = derivatives.modes
    poles = compute_oscillatory_poles(model, derivatives)
    full_response = model.response(derivatives, omega) if model.outputs else None
    highest = float(np.max(omega))
    steps = []
    for count in range(len(numbers) + 1):
        retained = numbers[:count]
        residualized = residualize(derivatives, model.modes, model.condition, retained)
        cut = truncate(derivatives, retained)
        smaller = model.with_modes(count)
        reduced_poles = compute_oscillatory_poles(smaller, residualized)
        worst, bias = _compute_bias(derivatives, residualized)
        error = None
        if full_response is not None:
            reduced = compute_reduced_response(model, derivatives, retained, omega)
            error = _compute_relative_error(reduced, full_response)
        steps.append(
            ReducedModel(
                modes=retained,
                residualized=residualized,
                truncated=cut,
                poles=reduced_poles,
                truncated_poles=compute_oscillatory_poles(smaller, cut),
                worst=worst,
                bias=bias,
                pole_error=_compute_pole_error(poles, reduced_poles, highest),
                response_error=error,
            )
        )
    insufficient = [k for k, step in enumerate(steps[:-1]) if not step.sufficient]
    needed = insufficient[-1] + 1 if insufficient else 0
    return OrderStudy(derivatives, poles, tuple(steps), needed)


def compute_oscillatory_poles(
    model: AeroelasticModel, derivatives: DerivativeTable
) -> Complex[np.ndarray, " n_poles"]:
    """Compute the poles above the real axis, by frequency. [rad/s]"""
    roots = np.linalg.eigvals(model.state_space(derivatives).A)
    above = roots[np.imag(roots) > 0].astype(complex)
    return above[np.argsort(np.abs(above))]


def compute_reduced_response(
    model: AeroelasticModel,
    derivatives: DerivativeTable,
    retained: tuple[int, ...],
    omega: Float[np.ndarray, " n_omega"],
) -> Complex[np.ndarray, "n_omega n_y n_u"]:
    """Compute responses of a residualised model, omitted modes static in the sensors.

    Model and derivatives are the full ones; ``retained`` are the numbers of its first modes.
    """
    n, k, n_u = len(derivatives.modes), len(retained), len(model.inputs)
    residualized = residualize(derivatives, model.modes, model.condition, retained)
    motion = model.with_modes(k).motion(residualized, omega)
    _, static = compute_static_recovery(derivatives, model.modes, model.condition, retained)
    first = model.n_rigid
    rates = 1j * omega[:, None, None] * motion[:, first:]
    inputs = np.broadcast_to(np.eye(n_u), (omega.size, n_u, n_u))
    factors = model.with_modes(k).column_factors()[:, None]
    variables = factors * np.concatenate([motion, rates, inputs], axis=1)
    whole = np.zeros((omega.size, first + n, n_u), dtype=complex)
    places = [*range(first), *(first + derivatives.modes.index(number) for number in retained)]
    whole[:, places] = motion
    whole[:, [row for row in range(first + n) if row not in places]] = static @ variables
    return model.sensors.response(omega) @ whole


def _compute_bias(full: DerivativeTable, residualized: DerivativeTable) -> tuple[str, float]:
    """The rigid-body derivative with the largest relative error."""
    true, found = full.named(), residualized.named()
    worst, bias = "", 0.0
    for row in full.body.coefficients:
        inputs = [f"{row}_{name}" for name in full.inputs]
        for group in (*([f"{row}_{motion}"] for motion in full.body.motions), inputs):
            largest = max((abs(true[name]) for name in group), default=0.0)
            for name in group:
                if abs(true[name]) <= _SMALL_SHARE * largest:
                    continue
                error = abs(found[name] / true[name] - 1.0)
                if error > bias:
                    worst, bias = name, error
    return worst, bias


def _compute_pole_error(
    full: Complex[np.ndarray, " n_full"], reduced: Complex[np.ndarray, " n_reduced"], highest: float
) -> float:
    """Largest relative distance of a full model's pole in the band from the reduced one's."""
    inside = full[np.abs(full) <= highest]
    if reduced.size < inside.size:
        return float("inf")
    distance = np.abs(inside[:, None] - reduced) / np.abs(inside)[:, None]
    return float(distance[linear_sum_assignment(distance)].max(initial=0.0))


def _compute_relative_error(
    one: Complex[np.ndarray, "..."], of: Complex[np.ndarray, "..."]
) -> float:
    """Mean over the outputs and inputs of their relative rms errors."""
    scale = np.sqrt(np.mean(np.abs(of) ** 2, axis=0))
    size = np.sqrt(np.mean(np.abs(one - of) ** 2, axis=0))
    return float(np.mean(size[scale > 0] / scale[scale > 0]))
