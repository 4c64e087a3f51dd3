"""Tests of equal estimates at several amplitudes, and patterns of their changes.

What changes with the amplitude of an excitation is not linear: a gap, a joint that slips, a surface
that stalls.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from jaxtyping import Float
from scipy import special

SIGNIFICANCE = 0.05
"""Probability that equal linear models are rejected, of all tests together."""

SAME_LEVEL = 0.1
"""Amplitudes that differ by less, relative to the larger one, are repeats of one level."""

_LEAST_VARIANCE = 1e-9  # of the sum of both variances: a smaller difference is rounding


# --- Levels: estimates at one amplitude, repeats of it averaged -----------------------------------


@dataclass(frozen=True, slots=True, eq=False)
class LevelEstimates:
    """Estimates of several quantities at several levels, the smallest amplitude first.

    ``covariance`` is that between level i and level j, of quantity k at i and quantity l at j.
    """

    amplitudes: Float[np.ndarray, " n_levels"]
    values: Float[np.ndarray, "n_levels n"]
    covariance: Float[np.ndarray, "n_levels n_levels n n"]

    def select(self, index: Sequence[int]) -> LevelEstimates:
        """Return those of some quantities."""
        at = list(index)
        return LevelEstimates(
            self.amplitudes, self.values[:, at], self.covariance[:, :, at][:, :, :, at]
        )

    def transform(self, weights: Float[np.ndarray, "n_new n_levels"]) -> _Combination:
        """Return linear combinations of the levels, with their joint covariance."""
        values = weights @ self.values
        joint = np.einsum("ai,bj,ijkl->akbl", weights, weights, self.covariance)
        return _Combination(values, joint.reshape(values.size, values.size))


@dataclass(frozen=True, slots=True, eq=False)
class _Combination:
    """Combinations of levels (n_new, n), and the covariance of all, by combination first."""

    values: Float[np.ndarray, "n_new n"]
    covariance: Float[np.ndarray, "m m"]


def find_levels(amplitudes: Float[np.ndarray, " n"]) -> list[list[int]]:
    """Group amplitudes into levels, the smallest first.

    A level begins with the smallest amplitude that is larger by ``SAME_LEVEL`` than the first of
    the level before.
    """
    groups: list[list[int]] = []
    for index in np.argsort(amplitudes, kind="stable").tolist():
        if groups and amplitudes[groups[-1][0]] > (1.0 - SAME_LEVEL) * amplitudes[index]:
            groups[-1].append(index)
        else:
            groups.append([index])
    return groups


def average_repeats(estimates: LevelEstimates) -> LevelEstimates:
    """Average the repeats of every level, each estimate weighted by its inverse variance.

    Notes
    -----
    The mean of each quantity has its own weights, so that it is efficient but for errors that
    repeats share, which no weights reduce.
    """
    groups = find_levels(estimates.amplitudes)
    n_all, n = estimates.values.shape
    variances = np.einsum("iikk->ik", estimates.covariance)
    weights = np.zeros((len(groups), n_all, n))
    for level, members in enumerate(groups):
        own = 1.0 / variances[members]
        weights[level, members] = own / own.sum(axis=0)
    return LevelEstimates(
        np.array([estimates.amplitudes[members].mean() for members in groups]),
        np.einsum("aik,ik->ak", weights, estimates.values),
        np.einsum("aik,bjl,ijkl->abkl", weights, weights, estimates.covariance),
    )


# --- Test of equal values at all levels, and the change at the largest one ------------------------


@dataclass(frozen=True, slots=True)
class EqualityTest:
    """Test of equal values at all levels.

    ``chi_square`` has ``degrees_of_freedom`` if the values are equal; ``p`` is the probability of a
    larger one.
    """

    chi_square: float
    degrees_of_freedom: int
    p: float


def compare_levels(estimates: LevelEstimates) -> EqualityTest:
    """Test whether several quantities together have the same values at all levels.

    Raises
    ------
    ValueError
        If there is one level only, or a value or variance is not finite.

    Notes
    -----
    Wald's test of the differences d of all levels from the first one, d^T Cov(d)^-1 d, which is
    the same for any choice of the differences. It is chi-square with the rank of Cov(d).
    Source: Wald (1943), Tests of statistical hypotheses concerning several parameters when the
    number of observations is large, doi:10.1090/S0002-9947-1943-0012401-3.
    """
    n_levels = estimates.values.shape[0]
    if n_levels < 2:
        raise ValueError("a comparison of levels needs two levels; found one")
    contrasts = np.hstack([-np.ones((n_levels - 1, 1)), np.eye(n_levels - 1)])
    difference = estimates.transform(contrasts)
    if not (np.isfinite(difference.values).all() and np.isfinite(difference.covariance).all()):
        raise ValueError("a comparison of levels needs finite values with standard errors")
    d, covariance = difference.values.ravel(), difference.covariance
    scale = np.sqrt(np.maximum(np.diag(covariance), _find_floor(estimates, contrasts)))
    values, vectors = np.linalg.eigh(covariance / np.outer(scale, scale))
    resolved = values > _LEAST_VARIANCE
    along = vectors[:, resolved].T @ (d / scale)
    chi_square = float(np.sum(along**2 / values[resolved]))
    freedom = int(np.count_nonzero(resolved))
    return EqualityTest(chi_square, freedom, float(special.chdtrc(freedom, chi_square)))


def _find_floor(estimates: LevelEstimates, contrasts: np.ndarray) -> np.ndarray:
    """Find the variances of differences below which they are rounding."""
    variances = np.einsum("iikk->ik", estimates.covariance)
    return _LEAST_VARIANCE * (np.abs(contrasts) @ variances).ravel()


@dataclass(frozen=True, slots=True)
class LevelChange:
    """Change of a quantity from the smaller levels to the largest one, with its standard error.

    ``reference`` is the mean of the smaller levels.
    """

    reference: float
    value: float
    std_error: float


def estimate_change(estimates: LevelEstimates) -> LevelChange:
    """Estimate the change of one quantity from the smaller levels to the largest one.

    Notes
    -----
    The mean of the smaller levels is weighted by their inverse variances.
    """
    variances = np.einsum("iikk->ik", estimates.covariance)[:, 0]
    weights = 1.0 / variances[:-1]
    weights = weights / weights.sum()
    reference = float(weights @ estimates.values[:-1, 0])
    change = estimates.transform(np.append(-weights, 1.0)[None])
    variance = max(float(change.covariance[0, 0]), _LEAST_VARIANCE * float(variances[-1]))
    return LevelChange(reference, float(change.values[0, 0]), variance**0.5)


# --- Patterns of a change: freeplay, hardening and softening of a mode, a saturating surface ------


class Pattern(StrEnum):
    """What a change with amplitude is like."""

    FREEPLAY = "freeplay"
    HARDENING = "hardening stiffness"
    STIFFENING = "freeplay or hardening stiffness"
    SOFTENING = "softening stiffness"
    SATURATION = "saturation"
    DEAD_BAND = "dead band"


def classify_frequency(estimates: LevelEstimates) -> Pattern | None:
    """Classify the change of a frequency with amplitude; None if it does not rise or fall.

    Notes
    -----
    The frequency squared is proportional to the equivalent stiffness of the describing function:
    N(d/A) of a gap d, 1 - 2/pi (asin x + x sqrt(1 - x^2)) with x = d/A, rises to one;
    1 + b A^2 of a cubic spring rises ever faster. Both have two parameters, so that three levels
    can exclude one of them: where the chi-square of just one is below its 5 % point, this is the
    pattern. The response of the mode is taken as proportional to the excitation.
    Source: Gelb and Vander Velde (1968), Multiple-Input Describing Functions and Nonlinear System
    Design, McGraw-Hill, tables B.1.
    """
    change = estimate_change(estimates)
    if abs(change.value) < 2.0 * change.std_error:
        return None
    if change.value < 0.0:
        return Pattern.SOFTENING
    n_levels = estimates.values.shape[0]
    if n_levels < 3:
        return Pattern.STIFFENING
    limit = float(special.chdtri(n_levels - 2, SIGNIFICANCE))
    relative = estimates.amplitudes / estimates.amplitudes[0]

    def fits(shape: Callable[[float], np.ndarray], bounds: tuple[float, float]) -> bool:
        from scipy import optimize  # not loaded by whoever reads a result

        best = optimize.minimize_scalar(
            lambda x: _fit_shape(estimates, np.sqrt(shape(x))), bounds=bounds, method="bounded"
        )
        return float(best.fun) <= limit

    is_gap = fits(lambda x: _describe_gap(x / relative), (0.0, 1.0 - 1e-6))
    is_cubic = fits(lambda log_b: 1.0 + np.exp(log_b) * relative**2, (-20.0, 5.0))
    if is_gap == is_cubic:
        return Pattern.STIFFENING
    return Pattern.FREEPLAY if is_gap else Pattern.HARDENING


def _describe_gap(x: Float[np.ndarray, " n"]) -> Float[np.ndarray, " n"]:
    """Describing function of a gap of half width x of the amplitude, relative to the stiffness."""
    return 1.0 - 2.0 / np.pi * (np.arcsin(x) + x * np.sqrt(1.0 - x**2))


def _fit_shape(estimates: LevelEstimates, shape: Float[np.ndarray, " n_levels"]) -> float:
    """Fit a multiple of a shape to one quantity; return the chi-square of what is left."""
    factor = np.linalg.cholesky(estimates.covariance[:, :, 0, 0])
    whitened, along = np.linalg.solve(factor, np.stack([estimates.values[:, 0], shape], axis=1)).T
    return float(whitened @ whitened - (along @ whitened) ** 2 / (along @ along))


@dataclass(frozen=True, slots=True)
class EffectivenessChange:
    """Factor on all control derivatives of an input at the largest level, and its standard error.

    ``p`` is that of the factor one; ``p_common`` the probability of what is left of the changes
    with one factor of all.
    """

    factor: float
    std_error: float
    p: float
    p_common: float


def estimate_effectiveness(estimates: LevelEstimates) -> EffectivenessChange:
    """Estimate a common factor on the control derivatives of an input at the largest level.

    Notes
    -----
    Generalised least squares of the change d of all derivatives on their mean m at the smaller
    levels, d = (f - 1) m, with the covariance of d; m is taken as known, which is right to first
    order where f is about one.
    """
    n_levels, n = estimates.values.shape
    changes = [estimate_change(estimates.select([k])) for k in range(n)]
    reference = np.array([one.reference for one in changes])
    variances = np.einsum("iikk->ik", estimates.covariance)
    weights = np.zeros((n, n_levels, n))
    own = 1.0 / variances[:-1]
    weights[np.arange(n), :-1, np.arange(n)] = -(own / own.sum(axis=0)).T
    weights[np.arange(n), -1, np.arange(n)] = 1.0
    covariance = np.einsum("aik,bjl,ijkl->ab", weights, weights, estimates.covariance)
    d = np.array([one.value for one in changes])
    factor = np.linalg.cholesky(covariance)
    along, changed = np.linalg.solve(factor, np.stack([reference, d], axis=1)).T
    information = float(along @ along)
    slope = float(along @ changed) / information
    chi_square = float(np.sum((changed - slope * along) ** 2))
    return EffectivenessChange(
        factor=1.0 + slope,
        std_error=information**-0.5,
        p=float(special.chdtrc(1, slope**2 * information)),
        p_common=float(special.chdtrc(n - 1, chi_square)) if n > 1 else 1.0,
    )
