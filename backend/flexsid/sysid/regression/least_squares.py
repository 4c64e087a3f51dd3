"""Complex least squares with real parameters, also with known noise of the regressors."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy
from jaxtyping import Complex, Float

from flexsid.errors import NotIdentifiable
from flexsid.sysid.estimation import noise
from flexsid.sysid.estimation.estimate import scale_rows
from flexsid.sysid.estimation.linear_algebra import invert_triangular

_LARGEST_CONDITION = 1e10  # of the scaled regressors: collinear above
_ITERATIONS = 20
_CONVERGED = 1e-7  # change over the largest derivative, both in equal units
_MARGIN = 1.5  # at least 1/3 of the weakest direction of the normal matrix remains
_LEAST_SIGNAL = 0.02  # share of signal in a direction that standard errors assume at least
_EXCESS_TOLERANCE = 1e-3  # of the degrees of freedom
_LEAST_VARIANCE = 1e-12  # of the largest variance: weights stay finite


@dataclass(frozen=True, slots=True)
class ErrorsInVariables:
    """Errors-in-variables covariance at every frequency, real parts: theta is real.

    Of the regressors, of the dependent variable, and E[x z*] between the two;
    ``relative_std`` is the relative standard deviation of these covariances where they were
    estimated. ``systematic`` are errors common to all frequencies, one standard deviation of
    each cause: of the regressors and, in the last column, of the dependent variable.
    """

    regressors: Float[np.ndarray, "n_omega p p"]
    cross: Float[np.ndarray, "n_omega p"]
    dependent: Float[np.ndarray, " n_omega"]
    relative_std: float = 0.0
    systematic: Complex[np.ndarray, "n_omega n_causes p_1"] | None = None

    def equation_variance(self, theta: Float[np.ndarray, " p"]) -> Float[np.ndarray, " n_omega"]:
        """Variance of z - X theta due to these errors at every frequency."""
        n_omega = self.dependent.size
        quadratic = self.regressors.reshape(n_omega, -1) @ np.outer(theta, theta).ravel()
        return quadratic - 2.0 * (self.cross @ theta) + self.dependent


@dataclass(frozen=True, slots=True)
class WeightedFit:
    """Values, the variance of the equation at every frequency, and the fraction of bias removed."""

    values: Float[np.ndarray, " p"]
    variance: Float[np.ndarray, " n_omega"]
    fraction_removed: float


@dataclass(frozen=True, slots=True)
class NormalInverse:
    """Inverse of the normal matrix without noise, and the bias due to noise.

    The inverse is ``directions`` diag(1 / ``signal``) ``directions``^T, where the columns of
    ``directions`` make the weighted regressors orthonormal. ``unresolved_covariance`` is the
    covariance along directions in which noise exceeds the signal: part of the bias remains
    there, because the dependent variable contains the same noise. Its bound is the weighted
    sum of squares of the dependent variable.
    """

    directions: Float[np.ndarray, "p p"]
    signal: Float[np.ndarray, " p"]
    bias: Float[np.ndarray, " p"]
    unresolved_covariance: Float[np.ndarray, "p p"]


@dataclass(frozen=True, slots=True)
class Regression:
    """Values, their covariance for white residuals, and the one for the observed residuals.

    ``variance`` is that of the equation at every frequency, ``inverse`` the inverse of the
    normal matrix Re X^H X / variance without noise: an error e of the equation changes the
    values by inverse Re X^H (e / variance). ``components`` are the parts of the standard
    deviations due to the error at every frequency.
    """

    values: Float[np.ndarray, " p"]
    covariance: Float[np.ndarray, "p p"]
    corrected_covariance: Float[np.ndarray, "p p"]
    variance: Float[np.ndarray, " n_omega"]
    inverse: Float[np.ndarray, "p p"]
    components: Float[np.ndarray, "p n_omega"]


def regress(
    X: Complex[np.ndarray, "n_omega p"],
    z: Complex[np.ndarray, " n_omega"],
    names: tuple[str, ...],
    errors: ErrorsInVariables | None = None,
) -> Regression:
    """Fit z = X theta with real theta by least squares.

    Parameters
    ----------
    X, z
        Regressors and dependent variable, one row per frequency.
    names
        Of the parameters, for messages.
    errors
        Covariance of the errors of X and z. With it, frequencies are weighted by the
        variance of the equation, and the bias due to the errors is removed.

    Raises
    ------
    NotIdentifiable
        If there are too few frequencies, a regressor is zero, or some are collinear.

    Notes
    -----
    With M complex data points and p real parameters the residual variance is
    s^2 = nu^H nu / (M - p/2) and Cov = 1/2 s^2 [Re X^H X]^-1. The form without the
    factor 1/2, often printed, is twice too large.
    """
    n_frequencies, p = X.shape
    if p >= 2 * n_frequencies:
        raise NotIdentifiable(
            f"{p} derivatives of one coefficient are free ({names[0]}...) but the band has only "
            f"{n_frequencies} frequencies; free fewer derivatives or widen the band",
            parameters=p,
            frequencies=n_frequencies,
        )
    scale = np.linalg.norm(X, axis=0)
    if not scale.all():
        quiet = names[int(np.argmin(scale))]
        raise NotIdentifiable(
            f"the variable of {quiet} is zero in this maneuver; hold {quiet} fixed", name=quiet
        )
    stacked, target = _as_real(X) / scale, _as_real(z)
    q, r = np.linalg.qr(stacked)
    if np.linalg.cond(r) > _LARGEST_CONDITION:
        raise NotIdentifiable(
            f"the regressors of {names[0].split('_')[0]} are collinear; hold some of "
            f"{', '.join(names)} fixed",
            code="collinear",
        )
    theta = scipy.linalg.solve_triangular(r, q.T @ target) / scale
    if errors is not None:
        fit, inverse = compensate_bias(X, z, theta, errors)
        return _add_covariance(X, z, fit, inverse, errors)
    directions = invert_triangular(r) / scale[:, None]
    fit = WeightedFit(theta, np.ones(n_frequencies), 0.0)
    inverse = NormalInverse(directions, np.ones(p), np.zeros(p), np.zeros((p, p)))
    return _add_covariance(X, z, fit, inverse)


def _as_real(values: np.ndarray) -> np.ndarray:
    """Stack real parts above imaginary parts."""
    return np.concatenate([np.real(values), np.imag(values)])


def compensate_bias(
    X: Complex[np.ndarray, "n_omega p"],
    z: Complex[np.ndarray, " n_omega"],
    theta: Float[np.ndarray, " p"],
    errors: ErrorsInVariables,
) -> tuple[WeightedFit, NormalInverse]:
    """Weight the frequencies by the known errors and remove their bias, iteratively.

    Notes
    -----
    Corrected least squares for errors in variables, with weights W = 1 / variance:
    [Re X^H W X - f sum W C_xx] theta = Re X^H W z - f sum W C_xz. The fraction f is 1 unless
    noise exceeds 1/``_MARGIN`` of a direction of the normal matrix, which would then be
    nearly singular. Standard errors include the remaining bias and the relative standard
    deviation of the noise covariance.
    """
    n_frequencies, p = X.shape
    variance, fraction = np.ones(n_frequencies), 1.0
    shares, directions, bias = np.zeros(p), np.eye(p), np.zeros(p)
    stacked, target = _as_real(X), _as_real(z)
    spread = errors.regressors.reshape(n_frequencies, -1)
    for _ in range(_ITERATIONS):
        variance = _compute_equation_variance(X, z, theta, errors)
        weight = 1.0 / variance
        root = np.sqrt(np.concatenate([weight, weight]))
        weighted = stacked * root[:, None]
        noise_normal = (weight @ spread).reshape(p, p)
        noise_moment = weight @ errors.cross
        scale = np.linalg.norm(weighted, axis=0)
        q, r = np.linalg.qr(weighted / scale)
        inverse = invert_triangular(r)
        among = inverse.T @ (noise_normal / np.outer(scale, scale)) @ inverse
        shares, axes = np.linalg.eigh(0.5 * (among + among.T))
        directions = inverse @ axes
        fraction = min(1.0, 1.0 / max(_MARGIN * shares[-1], np.finfo(float).tiny))
        right = axes.T @ (q.T @ (root * target)) - fraction * (
            directions.T @ (noise_moment / scale)
        )
        update = directions @ (right / (1.0 - fraction * shares)) / scale
        moved = np.max(np.abs(update - theta) * scale) / np.max(np.abs(theta) * scale)
        theta = update
        directions /= scale[:, None]
        bias = noise_normal @ theta - noise_moment
        if moved < _CONVERGED:
            break
    relative_std = np.hypot(errors.relative_std, 1.0 / np.sqrt(n_frequencies))
    signal = np.maximum(1.0 - shares * (1.0 + 2.0 * relative_std), _LEAST_SIGNAL)
    left = directions * (1.0 - 1.0 / np.maximum(_MARGIN * shares, 1.0))
    unresolved = np.sum(np.abs(z) ** 2 / variance) * (left @ left.T)
    bias = (directions / signal) @ (directions.T @ bias)
    inverse_normal = NormalInverse(directions, signal, bias, unresolved)
    return WeightedFit(theta, variance, fraction), inverse_normal


def _compute_equation_variance(
    X: Complex[np.ndarray, "n_omega p"],
    z: Complex[np.ndarray, " n_omega"],
    theta: Float[np.ndarray, " p"],
    errors: ErrorsInVariables,
) -> Float[np.ndarray, " n_omega"]:
    """Compute the variance of the equation: known errors plus a white part (input noise)."""
    known = errors.equation_variance(theta)
    known = np.maximum(known, _LEAST_VARIANCE * known.max())
    return known + estimate_excess_variance(
        known, np.abs(z - X @ theta) ** 2, X.shape[0] - 0.5 * X.shape[1]
    )


def estimate_excess_variance(
    known: Float[np.ndarray, " n_omega"], found: Float[np.ndarray, " n_omega"], freedom: float
) -> float:
    """Estimate the common variance in excess of the known ones from squared residuals.

    Notes
    -----
    Source: Mandel and Paule (1970): with it the weighted sum of squared residuals equals
    its degrees of freedom. A difference of means would be dominated by the few frequencies
    where the motion has the largest error, a hundred thousand times that of the others.
    """
    rest = 0.0
    for _ in range(_ITERATIONS):  # Newton from below on a convex, falling sum
        weight = 1.0 / (known + rest)
        excess = float(found @ weight) - freedom
        slope = float(found @ weight**2)
        if excess <= _EXCESS_TOLERANCE * freedom or slope == 0.0:
            break
        rest += excess / slope
    return rest


def _add_covariance(
    X: Complex[np.ndarray, "n_omega p"],
    z: Complex[np.ndarray, " n_omega"],
    fit: WeightedFit,
    inverse: NormalInverse,
    errors: ErrorsInVariables | None = None,
) -> Regression:
    n_frequencies, p = X.shape
    theta, variance = fit.values, fit.variance
    nu = (z - X @ theta) / np.sqrt(variance)
    freedom = n_frequencies - 0.5 * p
    level = float(np.sum(np.abs(nu) ** 2)) / freedom
    one_group = np.zeros(n_frequencies, dtype=int)
    density = np.real(noise.smooth_density(nu[:, None], one_group, 1).expand_blocks()[:, 0, 0])
    density *= n_frequencies / freedom
    directions = inverse.directions / inverse.signal
    root = np.sqrt(np.maximum(density, 0.0) / variance)
    scattered = _as_real(X * root[:, None]) @ inverse.directions
    corrected = 0.5 * directions @ (scattered.T @ scattered) @ directions.T
    scores = np.real(X.conj() * (z - X @ theta)[:, None])
    if errors is not None:
        # Errors of X are part of the residual, too: without this mean a score has a bias.
        scores += fit.fraction_removed * (errors.regressors @ theta - errors.cross)
    components = directions @ (inverse.directions.T @ (scores / variance[:, None]).T)
    components = scale_rows(components, np.diag(corrected))
    if errors is not None:
        corrected += errors.relative_std**2 * np.outer(inverse.bias, inverse.bias)
        corrected += inverse.unresolved_covariance
        if errors.systematic is not None:
            common = errors.systematic @ np.append(-theta, 1.0)
            moved = directions @ (
                inverse.directions.T @ np.real((X.conj() / variance[:, None]).T @ common)
            )
            corrected += moved @ moved.T
    plain = 0.5 * level * (directions @ inverse.directions.T)
    return Regression(
        theta,
        0.5 * (plain + plain.T),
        0.5 * (corrected + corrected.T),
        variance * level,
        directions @ inverse.directions.T * level,
        components,
    )
