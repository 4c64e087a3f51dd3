"""How many modes a condition needs: reduced models of every order against the full one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float
from scipy.optimize import linear_sum_assignment

from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.model.reduction import residualize, static_recovery, truncate

BAND = 0.10
"""Within this share of the full model's a derivative counts as unbiased (Fig. 13)."""

POLE_BAND = 0.05
_SMALL = 0.05


@dataclass(frozen=True, slots=True, eq=False)
class ReducedModel:
    """A model that keeps the first modes of the full one.

    ``worst`` names the derivative of the rigid body that is farthest off, ``bias`` its
    relative error; ``pole_error`` is the largest relative distance of a pole in the band from
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
        they are to be kept (by frequency).
    derivatives
        Of the full model.
    omega
        Lines of the band that matters; poles up to its end are compared. [rad/s]

    Notes
    -----
    Source: Sec. VI.B and Fig. 13. The derivatives judged are those of C_Z and C_m in alpha,
    q and the inputs; those below a twentieth of the largest of their kind are left out, as
    a ratio tells nothing of them. That poles must be right as well is ours: beyond flutter
    unbiased rigid-body derivatives alone would let the wrong root be unstable.
    """
    numbers = derivatives.modes
    poles = oscillations(model, derivatives)
    full_response = model.response(derivatives, omega) if model.outputs else None
    highest = float(np.max(omega))
    steps = []
    for count in range(len(numbers) + 1):
        keep = numbers[:count]
        kept = residualize(derivatives, model.modes, model.condition, keep)
        cut = truncate(derivatives, keep)
        smaller = model.with_modes(count)
        reduced_poles = oscillations(smaller, kept)
        worst, bias = _bias(derivatives, kept)
        error = None
        if full_response is not None:
            reduced = reduced_response(model, derivatives, keep, omega)
            error = _relative(reduced - full_response, full_response)
        steps.append(
            ReducedModel(
                modes=keep,
                residualized=kept,
                truncated=cut,
                poles=reduced_poles,
                truncated_poles=oscillations(smaller, cut),
                worst=worst,
                bias=bias,
                pole_error=_pole_error(poles, reduced_poles, highest),
                response_error=error,
            )
        )
    enough = [step.sufficient for step in steps]
    needed = len(enough) - 1
    while needed > 0 and enough[needed - 1]:
        needed -= 1
    return OrderStudy(derivatives, poles, tuple(steps), needed)


def oscillations(
    model: AeroelasticModel, derivatives: DerivativeTable
) -> Complex[np.ndarray, " n_poles"]:
    """Poles above the real axis, by frequency. [rad/s]"""
    roots = np.linalg.eigvals(model.state_space(derivatives).A)
    above = roots[np.imag(roots) > 0].astype(complex)
    return above[np.argsort(np.abs(above))]


def reduced_response(
    model: AeroelasticModel,
    derivatives: DerivativeTable,
    keep: tuple[int, ...],
    omega: Float[np.ndarray, " n_omega"],
) -> Complex[np.ndarray, "n_omega n_y n_u"]:
    """Responses of a residualised model, whose sensors see the modes left out move statically.

    Parameters
    ----------
    model, derivatives
        The full model.
    keep
        Numbers of its first modes.
    omega
        Lines. [rad/s]
    """
    n, k, n_u = len(derivatives.modes), len(keep), len(model.inputs)
    kept = residualize(derivatives, model.modes, model.condition, keep)
    motion = model.with_modes(k).motion(kept, omega)
    _, static = static_recovery(derivatives, model.modes, model.condition, keep)
    rate = model.condition.rate_factor
    s = 1j * omega[:, None, None]
    variables = np.concatenate(
        [
            motion[:, :1],
            rate * motion[:, 1:2],
            motion[:, 2:],
            rate * s * motion[:, 2:],
            np.broadcast_to(np.eye(n_u), (omega.size, n_u, n_u)),
        ],
        axis=1,
    )
    whole = np.zeros((omega.size, 2 + n, n_u), dtype=complex)
    places = [0, 1, *(2 + derivatives.modes.index(number) for number in keep)]
    whole[:, places] = motion
    whole[:, [row for row in range(2 + n) if row not in places]] = static @ variables
    return model.sensors.response(omega) @ whole


def _bias(full: DerivativeTable, kept: DerivativeTable) -> tuple[str, float]:
    """The rigid-body derivative that is farthest off, relative to its own value."""
    true, found = full.named(), kept.named()
    worst, bias = "", 0.0
    for row in ("CZ", "Cm"):
        inputs = [f"{row}_{name}" for name in full.inputs]
        for group in ([f"{row}_alpha"], [f"{row}_q"], inputs):
            largest = max((abs(true[name]) for name in group), default=0.0)
            for name in group:
                if abs(true[name]) <= _SMALL * largest:
                    continue
                error = abs(found[name] / true[name] - 1.0)
                if error > bias:
                    worst, bias = name, error
    return worst, bias


def _pole_error(
    full: Complex[np.ndarray, " n_full"], reduced: Complex[np.ndarray, " n_reduced"], highest: float
) -> float:
    """Largest relative distance of a full model's pole in the band from the reduced one's."""
    wanted = full[np.abs(full) <= highest]
    if wanted.size == 0:
        return 0.0
    if reduced.size < wanted.size:
        return float("inf")
    distance = np.abs(wanted[:, None] - reduced) / np.abs(wanted)[:, None]
    chosen = linear_sum_assignment(distance)
    return float(distance[chosen].max())


def _relative(error: Complex[np.ndarray, "..."], of: Complex[np.ndarray, "..."]) -> float:
    """Mean over the outputs and inputs of their relative rms errors."""
    scale = np.sqrt(np.mean(np.abs(of) ** 2, axis=0))
    size = np.sqrt(np.mean(np.abs(error) ** 2, axis=0))
    return float(np.mean(size[scale > 0] / scale[scale > 0]))
