"""Amplitudes of the inputs that make a design tell most within its limits."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from jaxtyping import Bool, Float
from scipy import optimize

from flexsid.errors import BadInput, FlexsidError
from flexsid.sysid.estimation.expectation import Expectation

_SHARPNESS = (10.0, 60.0)  # of the smooth maximum over relative variances, in turn
_LEAST = 1e-4  # of the largest power an input may have: none is switched off
_ROUNDS = 6  # until powers that are allowed and true peaks agree
_GAP = 0.05  # of the criterion, a logarithm of variances, that may be left
_CLOSE = 0.01  # of its limit, where a peak counts as there


class NotAllocated(FlexsidError):
    """The optimiser found no amplitudes that it can vouch for."""

    code = "not-allocated"


def allocate_minimax(
    expectation: Expectation,
    limits: Float[np.ndarray, " n_limited"],
    targets: Bool[np.ndarray, " n_theta"] | None = None,
) -> Float[np.ndarray, " n_u"]:
    """Gains of the inputs that make the worst relative standard error smallest.

    Parameters
    ----------
    expectation
        At the flat amplitudes.
    limits
        Largest of every limited quantity, infinite where there is none.
    targets
        Which parameters count; all by default.

    Raises
    ------
    BadInput
        If a parameter that counts is zero, or no limit holds the amplitudes.
    NotAllocated
        If the optimiser fails.

    Notes
    -----
    In the powers, squared gains, information is linear. For white noise variances are then
    convex and there is one optimum; noise of other spectra bends that little. Peaks are
    limited through powers by their ratio to the root mean square, measured again after
    each round until the true peaks are within.
    """
    counts = np.ones(expectation.theta.size, dtype=bool) if targets is None else targets
    reference = expectation.theta**2
    if not counts.any() or np.any(reference[counts] == 0.0):
        raise BadInput(
            "a derivative that is zero has no relative standard error; leave it out, and let"
            " at least one count"
        )

    def criterion(sharpness: float) -> Callable[[np.ndarray], tuple[float, np.ndarray]]:
        def worst(x: np.ndarray) -> tuple[float, np.ndarray]:
            inverse, middle = expectation.parts(x)
            C = inverse @ middle @ inverse
            variances = np.diag(C)[counts]
            logs = np.log(variances / reference[counts])
            weights = np.exp(sharpness * (logs - logs.max()))
            value = logs.max() + np.log(weights.sum()) / sharpness
            shares = weights / weights.sum() / variances
            slopes = [
                shares @ (within - 2.0 * across)[counts]
                for within, across in (
                    (
                        np.sum((inverse @ scatter) * inverse, axis=1),
                        np.sum((inverse @ part) * C, axis=1),
                    )
                    for part, scatter in zip(
                        expectation.information, expectation.scatter, strict=True
                    )
                )
            ]
            return float(value), np.array(slopes)

        return worst

    return _optimum(expectation, limits, [criterion(sharpness) for sharpness in _SHARPNESS])


def allocate_d_optimal(
    expectation: Expectation, limits: Float[np.ndarray, " n_limited"]
) -> Float[np.ndarray, " n_u"]:
    """Gains that make the volume of the confidence ellipsoid smallest; see above."""

    def volume(x: np.ndarray) -> tuple[float, np.ndarray]:
        inverse, middle = expectation.parts(x)
        value = np.linalg.slogdet(middle)[1] + 2.0 * np.linalg.slogdet(inverse)[1]
        slopes = [
            np.trace(np.linalg.solve(middle, scatter)) - 2.0 * np.sum(inverse * part)
            for part, scatter in zip(expectation.information, expectation.scatter, strict=True)
        ]
        return float(value), np.array(slopes)

    return _optimum(expectation, limits, [volume])


def _optimum(
    expectation: Expectation,
    limits: Float[np.ndarray, " n_limited"],
    criteria: list[Callable[[np.ndarray], tuple[float, np.ndarray]]],
) -> Float[np.ndarray, " n_u"]:
    limited = np.flatnonzero(np.isfinite(limits))
    peaks = expectation.peaks()[limited]
    limited, peaks = limited[peaks > 0.0], peaks[peaks > 0.0]
    wave = expectation.waves[:, :, limited]
    used = np.mean(wave**2, axis=1)  # (n_u, n_limited)
    if not np.all(used.sum(axis=1) > 0.0):
        raise BadInput(
            "nothing limits the amplitudes of every input; give a limit on deflection",
            code="no-limit",
        )
    # The largest power any one limit leaves an input that moves alone.
    alone = np.maximum(np.max(np.abs(wave), axis=1) ** 2, 1e-300)
    top = np.min(np.where(used > 0.0, limits[limited] ** 2 / alone, np.inf), axis=1)
    allowed = (limits[limited] / peaks) ** 2 * used.sum(axis=0)
    x, reached = np.ones(len(expectation.inputs)), np.ones(limited.size)
    for _ in range(_ROUNDS):
        x = np.minimum(x * float(np.min(allowed / (x @ used))), top)
        for criterion in criteria:
            x = _minimum(criterion, x, top, used / allowed)
        reached = expectation.peaks(np.sqrt(x))[limited] / limits[limited]
        full = (x @ used) / allowed > 1.0 - _CLOSE
        if reached.max() <= 1.0 + _CLOSE and (not full.any() or reached[full].max() > 1.0 - _CLOSE):
            break
        allowed = np.where(full | (reached > 1.0), allowed / reached**2, allowed)
    return np.sqrt(x) / max(1.0, float(reached.max()))


def _minimum(
    criterion: Callable[[np.ndarray], tuple[float, np.ndarray]],
    start: Float[np.ndarray, " n_u"],
    top: Float[np.ndarray, " n_u"],
    used: Float[np.ndarray, "n_u n_limited"],
) -> Float[np.ndarray, " n_u"]:
    bounds = [(_LEAST * value, value) for value in top]
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
    # What the solver says of itself is not enough: of a convex function no point within the
    # limits is lower than its tangent there, which bounds what is still to be gained.
    slope = criterion(x)[1]
    lowest = optimize.linprog(slope, A_ub=used.T, b_ub=np.ones(used.shape[1]), bounds=bounds)
    gap = float(slope @ x) - float(lowest.fun) if lowest.fun is not None else np.inf
    if not gap < _GAP:
        raise NotAllocated(
            f"no best amplitudes were found: after {found.nit} steps of the optimiser"
            f" ({found.message}) variances might still fall by {100.0 * gap:.2g} %; free fewer"
            " derivatives, or change the limits"
        )
    return x
