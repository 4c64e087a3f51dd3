"""Amplitude optimisation: input amplitudes of least parameter variance within limits."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from jaxtyping import Bool, Float
from scipy import optimize

from flexsid.errors import BadInput, FlexsidError
from flexsid.sysid.estimation.fisher_information import FisherInformation

_SHARPNESS = (10.0, 60.0)  # of the smooth maximum over relative variances, in sequence
_LEAST_POWER = 1e-4  # of the largest power an input may have: no input is switched off
_ROUNDS = 6  # iterations of allowed powers and true peaks
_GAP = 0.05  # largest accepted distance to the optimum, in log variance: 5 % of a variance
_CLOSE = 0.01  # relative distance within which a peak is at its limit


class OptimisationFailed(FlexsidError):
    """The optimiser reached no amplitudes that are proven close to the optimum."""

    code = "not-optimised"


def optimise_amplitudes_minimax(
    fisher_information: FisherInformation,
    limits: Float[np.ndarray, " n_limited"],
    targets: Bool[np.ndarray, " n_theta"] | None = None,
) -> Float[np.ndarray, " n_u"]:
    """Compute the input gains that minimise the largest relative standard error.

    Parameters
    ----------
    fisher_information
        At gains of one.
    limits
        Largest allowed value of every limited quantity, infinite where there is no limit.
    targets
        Parameters that the criterion includes; all reported ones by default.

    Raises
    ------
    BadInput
        If an included parameter is zero, or no limit bounds the amplitudes.
    OptimisationFailed
        If the optimiser fails.

    Notes
    -----
    The information is linear in the powers, the squared gains: the variances are convex in them,
    and there is one optimum.
    Peaks are limited through powers by their ratio to the root mean square, which is computed
    again after each round until the true peaks are within the limits.
    """
    counts = fisher_information.reported if targets is None else targets
    reference = fisher_information.theta**2
    if not counts.any() or np.any(reference[counts] == 0.0):
        raise BadInput(
            "a derivative that is zero has no relative standard error; exclude it, and include at"
            " least one derivative"
        )

    def criterion(sharpness: float) -> Callable[[np.ndarray], tuple[float, np.ndarray]]:
        def worst(x: np.ndarray) -> tuple[float, np.ndarray]:
            C = fisher_information.invert(x)
            variances = np.diag(C)[counts]
            logs = np.log(variances / reference[counts])
            weights = np.exp(sharpness * (logs - logs.max()))
            value = logs.max() + np.log(weights.sum()) / sharpness
            shares = weights / weights.sum() / variances
            slopes = [
                -shares @ np.sum((C @ part) * C, axis=1)[counts]
                for part in fisher_information.information
            ]
            return float(value), np.array(slopes)

        return worst

    return _optimise(fisher_information, limits, [criterion(sharpness) for sharpness in _SHARPNESS])


def optimise_amplitudes_d_optimal(
    fisher_information: FisherInformation, limits: Float[np.ndarray, " n_limited"]
) -> Float[np.ndarray, " n_u"]:
    """Compute the input gains that minimise the volume of the confidence ellipsoid.

    Nuisance parameters are marginalised: the volume is that of the reported parameters.
    """
    own = np.ix_(fisher_information.reported, fisher_information.reported)

    def volume(x: np.ndarray) -> tuple[float, np.ndarray]:
        C = fisher_information.invert(x)
        inner = np.zeros_like(C)
        inner[own] = np.linalg.inv(C[own])
        across = C @ inner @ C
        slopes = [-np.sum(across * part) for part in fisher_information.information]
        return float(np.linalg.slogdet(C[own])[1]), np.array(slopes)

    return _optimise(fisher_information, limits, [volume])


def _optimise(
    fisher_information: FisherInformation,
    limits: Float[np.ndarray, " n_limited"],
    criteria: list[Callable[[np.ndarray], tuple[float, np.ndarray]]],
) -> Float[np.ndarray, " n_u"]:
    limited = np.flatnonzero(np.isfinite(limits))
    peaks = fisher_information.peaks()[limited]
    limited, peaks = limited[peaks > 0.0], peaks[peaks > 0.0]
    wave = fisher_information.waves[:, :, limited]
    used = np.mean(wave**2, axis=1)  # (n_u, n_limited)
    if not np.all(used.sum(axis=1) > 0.0):
        raise BadInput(
            "the limits do not bound the amplitude of every input; give a limit on deflection",
            code="no-limit",
        )
    # Largest power of each input alone within every limit.
    alone = np.maximum(np.max(np.abs(wave), axis=1) ** 2, 1e-300)
    top = np.min(np.where(used > 0.0, limits[limited] ** 2 / alone, np.inf), axis=1)
    allowed = (limits[limited] / peaks) ** 2 * used.sum(axis=0)
    x, reached = np.ones(len(fisher_information.inputs)), np.ones(limited.size)
    for _ in range(_ROUNDS):
        x = np.minimum(x * float(np.min(allowed / (x @ used))), top)
        for criterion in criteria:
            x = _minimise(criterion, x, top, used / allowed)
        reached = fisher_information.peaks(np.sqrt(x))[limited] / limits[limited]
        full = (x @ used) / allowed > 1.0 - _CLOSE
        if reached.max() <= 1.0 + _CLOSE and (not full.any() or reached[full].max() > 1.0 - _CLOSE):
            break
        allowed = np.where(full | (reached > 1.0), allowed / reached**2, allowed)
    return np.sqrt(x) / max(1.0, float(reached.max()))


def _minimise(
    criterion: Callable[[np.ndarray], tuple[float, np.ndarray]],
    start: Float[np.ndarray, " n_u"],
    top: Float[np.ndarray, " n_u"],
    used: Float[np.ndarray, "n_u n_limited"],
) -> Float[np.ndarray, " n_u"]:
    bounds = [(_LEAST_POWER * value, value) for value in top]
    found = optimize.minimize(
        criterion,
        start,
        jac=True,
        method="SLSQP",
        bounds=bounds,
        constraints=[optimize.LinearConstraint(used.T, -np.inf, 1.0)],
        options={"maxiter": 300, "ftol": 1e-10},
    )
    x = found.x / max(1.0, float(np.max(found.x @ used)))
    # The status of the solver is not sufficient: a convex function is nowhere below its
    # tangent, which bounds the remaining decrease.
    slope = criterion(x)[1]
    lowest = optimize.linprog(slope, A_ub=used.T, b_ub=np.ones(used.shape[1]), bounds=bounds)
    gap = float(slope @ x) - float(lowest.fun) if lowest.fun is not None else np.inf
    if not gap < _GAP:
        raise OptimisationFailed(
            f"the amplitudes are not optimal: after {found.nit} steps of the optimiser"
            f" ({found.message}) variances may still decrease by {100.0 * gap:.2g} %; free fewer"
            " derivatives, or change the limits"
        )
    return x
