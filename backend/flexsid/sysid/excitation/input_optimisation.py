"""Optimal inputs: amplitudes and powers of harmonics within limits."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float
from scipy import linalg, optimize

from flexsid.errors import BadInput, FlexsidError, NotIdentifiable
from flexsid.sysid.excitation.fisher_information import FisherInformation

# --- Amplitude optimisation: input amplitudes of least parameter variance within limits -----------

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


# --- Optimal inputs: the powers of harmonics that are best for one objective within limits --------

_ITERATIONS = 2000
_CHECKED = 50  # iterations between two checks of the distance to the optimum
_POWER_GAP = 0.01  # distance to the optimum at which the iteration ends, in log variance
_LARGEST_GAP = 0.05  # largest accepted distance: 5 % of a variance
_LEAST_SHARE = 1e-5  # of the mean: no harmonic is switched off, as another could not find it again

Criterion = Callable[
    [Float[np.ndarray, "n_theta n_theta"]], tuple[float, Float[np.ndarray, "n_theta n_directions"]]
]
"""Logarithm of what is to be small for a covariance, and directions v: its derivative with respect
to the information matrix M is -sum of v v^T."""


@dataclass(frozen=True, slots=True)
class Candidate:
    """What each harmonic contributes by one set of parameter values, and the query for them.

    ``factors`` F give the information F^T F of a harmonic of unit power.
    """

    factors: Float[np.ndarray, "n_harmonics n_rows n_theta"]
    prior: Float[np.ndarray, "n_theta n_theta"]
    criterion: Criterion


def build_variance_criterion(slopes: Float[np.ndarray, "n_theta n_values"]) -> Criterion:
    """Build the criterion of the summed variance of values with these slopes.

    Notes
    -----
    L-optimality, log tr(W^T C W): of one value, such as a flutter speed, c-optimality. The
    derivative of C with respect to the information is -C (.) C.
    """

    def evaluate(C: np.ndarray) -> tuple[float, np.ndarray]:
        through = C @ slopes
        total = float(np.sum(through * slopes))
        return float(np.log(total)), through / np.sqrt(total)

    return evaluate


def build_discrimination_criterion(
    values: Float[np.ndarray, " n_terms"], terms: Bool[np.ndarray, " n_theta"]
) -> Criterion:
    """Build the criterion of the power of the test that these terms are zero.

    Notes
    -----
    Ds-optimality for known values b: the noncentrality of the likelihood ratio is b^T C_bb^-1 b,
    with C_bb the covariance of the terms, all other parameters estimated (Atkinson, Donev, Tobias,
    Optimum Experimental Designs, 2007, Sec. 20). Its negative logarithm is minimised.
    """

    def evaluate(C: np.ndarray) -> tuple[float, np.ndarray]:
        weighted = linalg.solve(C[np.ix_(terms, terms)], values, assume_a="pos")
        size = float(values @ weighted)
        return -float(np.log(size)), (C[:, terms] @ weighted / np.sqrt(size))[:, None]

    return evaluate


def optimise_powers(
    candidates: Sequence[Candidate],
    usage: Float[np.ndarray, "n_limits n_harmonics"],
) -> Float[np.ndarray, " n_harmonics"]:
    """Compute the powers of harmonics that minimise the mean criterion of all candidates.

    Parameters
    ----------
    candidates
        One for each set of parameter values that the prior knowledge makes possible.
    usage
        Share of every limit that unit power of a harmonic uses: ``usage @ powers <= 1``.

    Raises
    ------
    BadInput
        If a harmonic is bounded by no limit.
    NotIdentifiable
        If the harmonics do not determine the parameters.
    OptimisationFailed
        If the powers remain further from the optimum than ``_LARGEST_GAP``.

    Notes
    -----
    The criteria are convex in the powers. At the optimum d_k = (multipliers @ usage)_k for every
    harmonic in use, with d_k the decrease of the criterion per power. Powers are multiplied by the
    root of the ratio of both sides, multipliers by the root of the share of their limit in use. The
    distance to the optimum is bounded by a linear program: a convex function is nowhere below its
    tangent. Source: Silvey, Titterington and Torsney 1978, Communications in Statistics A7.
    """
    if not np.all(usage.max(axis=0) > 0.0):
        raise BadInput(
            "the limits do not bound every harmonic; limit the deflection", code="no-limit"
        )
    powers = 1.0 / usage.max(axis=0)
    powers /= np.max(usage @ powers)
    multipliers = np.full(usage.shape[0], 1.0 / usage.shape[0])
    gap = np.inf
    for turn in range(_ITERATIONS):
        decrease = _compute_decrease(candidates, powers)
        if turn % _CHECKED == _CHECKED - 1:
            lowest = optimize.linprog(-decrease, A_ub=usage, b_ub=np.ones(usage.shape[0]))
            gap = float(-lowest.fun - decrease @ powers) if lowest.fun is not None else np.inf
            if gap < _POWER_GAP:
                break
        multipliers *= np.sqrt(np.maximum(usage @ powers, 1e-12))
        multipliers = np.maximum(multipliers / multipliers.sum(), 1e-12)
        powers = powers * np.sqrt(decrease / np.maximum(multipliers @ usage, 1e-300))
        powers = np.maximum(powers, _LEAST_SHARE * powers.mean())
        powers /= np.max(usage @ powers)
    if not gap < _LARGEST_GAP:
        raise OptimisationFailed(
            f"the powers are not optimal: the variance may still decrease by {100.0 * gap:.2g} %"
            " of itself; free fewer derivatives, or change the limits"
        )
    return powers


def _compute_decrease(
    candidates: Sequence[Candidate], powers: Float[np.ndarray, " n_harmonics"]
) -> Float[np.ndarray, " n_harmonics"]:
    """Compute the decrease of the mean criterion with the power of every harmonic."""
    total = np.zeros(powers.size)
    for one in candidates:
        rows = (one.factors * np.sqrt(powers)[:, None, None]).reshape(-1, one.prior.shape[0])
        _, directions = one.criterion(_invert(rows.T @ rows + one.prior))
        total += np.sum((one.factors @ directions) ** 2, axis=(1, 2))
    return total / len(candidates)


def _invert(information: Float[np.ndarray, "n n"]) -> Float[np.ndarray, "n n"]:
    scale = np.sqrt(np.maximum(np.diag(information), 1e-300))
    try:
        factor = linalg.cho_factor(information / np.outer(scale, scale))
    except linalg.LinAlgError as error:
        raise NotIdentifiable(
            "the harmonics do not determine all free derivatives; excite more inputs, or free fewer"
        ) from error
    return linalg.cho_solve(factor, np.eye(scale.size)) / np.outer(scale, scale)
