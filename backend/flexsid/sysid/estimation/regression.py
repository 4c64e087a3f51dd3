"""Complex least squares with real parameters, also when the regressors carry known noise."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float
from scipy import linalg

from flexsid.errors import NotIdentifiable
from flexsid.sysid.estimation import noise

_WORST_CONDITION = 1e10
_ITERATIONS = 20
_STILL = 1e-7  # of the largest derivative, in equal units: no change worth a round
_MARGIN = 1.5  # the compensated normal matrix keeps at least 1/3 of its weakest direction
_LEAST = 0.02  # of a direction that error bars count as motion where all may be noise


@dataclass(frozen=True, slots=True)
class Disturbance:
    """Covariance of the errors at every line, real parts: theta is real.

    Of the regressors, of the dependent variable, and E[x z*] between the two; ``doubt`` is
    the relative standard deviation of all this where it was itself estimated.
    ``systematic`` are errors that all lines share, one standard deviation of each cause:
    of the regressors and, in the last column, of the dependent variable.
    """

    regressors: Float[np.ndarray, "n_omega p p"]
    cross: Float[np.ndarray, "n_omega p"]
    dependent: Float[np.ndarray, " n_omega"]
    doubt: float = 0.0
    systematic: Complex[np.ndarray, "n_omega n_causes p_1"] | None = None

    def equation_variance(self, theta: Float[np.ndarray, " p"]) -> Float[np.ndarray, " n_omega"]:
        """Variance that these errors give to z - X theta at every line."""
        n_omega = self.dependent.size
        quadratic = self.regressors.reshape(n_omega, -1) @ np.outer(theta, theta).ravel()
        return quadratic - 2.0 * (self.cross @ theta) + self.dependent


@dataclass(frozen=True, slots=True)
class Weighing:
    """Values, the variance of the equation at every line, and the share of the bias taken out."""

    values: Float[np.ndarray, " p"]
    variance: Float[np.ndarray, " n_omega"]
    keep: float


@dataclass(frozen=True, slots=True)
class Certainty:
    """Inverse of the normal matrix of the motion alone, and how far its noise pulled the values.

    The inverse is ``directions`` diag(1 / ``motion``) ``directions``^T, where the columns of
    ``directions`` make the weighted regressors orthonormal. ``untold`` is the covariance of
    what noise may have put along directions in which it is more than the motion: part of its
    bias stays in there, for the dependent variable holds the same noise, and the fit explains
    that. It explains no more than there is.
    """

    directions: Float[np.ndarray, "p p"]
    motion: Float[np.ndarray, " p"]
    pulled: Float[np.ndarray, " p"]
    untold: Float[np.ndarray, "p p"]


@dataclass(frozen=True, slots=True)
class Regression:
    """Values, their covariance for white residuals, and for the residuals as they are."""

    values: Float[np.ndarray, " p"]
    covariance: Float[np.ndarray, "p p"]
    corrected_covariance: Float[np.ndarray, "p p"]


def regress(
    X: Complex[np.ndarray, "n_omega p"],
    z: Complex[np.ndarray, " n_omega"],
    names: tuple[str, ...],
    disturbance: Disturbance | None = None,
) -> Regression:
    """Fit z = X theta with real theta.

    Parameters
    ----------
    X, z
        Regressors and dependent variable, one row per line.
    names
        Of the parameters, for messages.
    disturbance
        Errors of X and z. With it, lines are weighted by the variance that the
        errors give to the equation, and the bias they cause is taken out.

    Raises
    ------
    NotIdentifiable
        If there are too few lines, a regressor is still, or some are collinear.

    Notes
    -----
    With M complex lines and p real parameters the residual variance is
    nu^H nu / (M - p/2) and Cov = 1/2 s^2 [Re X^H X]^-1. The form without the
    half, often printed, is twice too large.
    """
    n_lines, p = X.shape
    if p >= 2 * n_lines:
        raise NotIdentifiable(
            f"{p} derivatives of one coefficient are free ({names[0]}...) but there are only "
            f"{n_lines} lines; free fewer or use more lines",
            parameters=p,
            lines=n_lines,
        )
    scale = np.linalg.norm(X, axis=0)
    if not scale.all():
        quiet = names[int(np.argmin(scale))]
        raise NotIdentifiable(
            f"the variable of {quiet} does not move in this maneuver; hold it fixed", name=quiet
        )
    stacked, target = _as_real(X) / scale, _as_real(z)
    q, r = np.linalg.qr(stacked)
    if np.linalg.cond(r) > _WORST_CONDITION:
        raise NotIdentifiable(
            f"the regressors of {names[0].split('_')[0]} are collinear; hold some of "
            f"{', '.join(names)} fixed",
            code="collinear",
        )
    theta = linalg.solve_triangular(r, q.T @ target) / scale
    if disturbance is not None:
        weighing, certainty = compensate(X, z, theta, disturbance)
        return _with_covariance(X, z, weighing, certainty, disturbance)
    inverse = inverse_of_triangular(r) / scale[:, None]
    plain = Weighing(theta, np.ones(n_lines), 0.0)
    certain = Certainty(inverse, np.ones(p), np.zeros(p), np.zeros((p, p)))
    return _with_covariance(X, z, plain, certain)


def inverse_of_triangular(r: Float[np.ndarray, "p p"]) -> Float[np.ndarray, "p p"]:
    """R^-1 of an upper triangle.

    Notes
    -----
    (A^T A)^-1 = R^-1 R^-T with A = Q R keeps the digits that forming A^T A loses: its
    condition number is the square of that of A.
    Source: Golub and Van Loan, Matrix Computations, 4th ed., sec. 5.3.
    """
    return linalg.solve_triangular(r, np.eye(len(r)))


def _as_real(values: np.ndarray) -> np.ndarray:
    """Real parts above imaginary parts."""
    return np.concatenate([np.real(values), np.imag(values)])


def compensate(
    X: Complex[np.ndarray, "n_omega p"],
    z: Complex[np.ndarray, " n_omega"],
    theta: Float[np.ndarray, " p"],
    disturbance: Disturbance,
) -> tuple[Weighing, Certainty]:
    """Weight the lines by the known errors and take their bias out, from a first guess on.

    Notes
    -----
    Where noise makes most of a direction of the normal matrix, only a part is taken out,
    or the direction would be divided by next to nothing. Error bars then do count what
    is left, and that the share of noise is known as well as lines and sensors tell it.
    """
    n_lines, p = X.shape
    variance, keep = np.ones(n_lines), 1.0
    shares, directions, pulled = np.zeros(p), np.eye(p), np.zeros(p)
    stacked, target = _as_real(X), _as_real(z)
    spread = disturbance.regressors.reshape(n_lines, -1)
    for _ in range(_ITERATIONS):
        variance = _line_variance(X, z, theta, disturbance)
        weight = 1.0 / variance
        root = np.sqrt(np.concatenate([weight, weight]))
        weighted = stacked * root[:, None]
        bias = (weight @ spread).reshape(p, p)
        pull = weight @ disturbance.cross
        scale = np.linalg.norm(weighted, axis=0)
        q, r = np.linalg.qr(weighted / scale)
        inverse = inverse_of_triangular(r)
        among = inverse.T @ (bias / np.outer(scale, scale)) @ inverse
        shares, axes = np.linalg.eigh(0.5 * (among + among.T))
        directions = inverse @ axes
        keep = min(1.0, 1.0 / max(_MARGIN * shares[-1], np.finfo(float).tiny))
        right = axes.T @ (q.T @ (root * target)) - keep * (directions.T @ (pull / scale))
        update = directions @ (right / (1.0 - keep * shares)) / scale
        moved = np.max(np.abs(update - theta) * scale) / np.max(np.abs(theta) * scale)
        theta = update
        directions /= scale[:, None]
        pulled = bias @ theta - pull
        if moved < _STILL:
            break
    doubt = np.hypot(disturbance.doubt, 1.0 / np.sqrt(n_lines))
    motion = np.maximum(1.0 - shares * (1.0 + 2.0 * doubt), _LEAST)
    left = directions * (1.0 - 1.0 / np.maximum(_MARGIN * shares, 1.0))
    untold = np.sum(np.abs(z) ** 2 / variance) * (left @ left.T)
    pulled = (directions / motion) @ (directions.T @ pulled)
    return Weighing(theta, variance, keep), Certainty(directions, motion, pulled, untold)


def _line_variance(
    X: Complex[np.ndarray, "n_omega p"],
    z: Complex[np.ndarray, " n_omega"],
    theta: Float[np.ndarray, " p"],
    disturbance: Disturbance,
) -> Float[np.ndarray, " n_omega"]:
    """Variance of the equation: known errors, and a white rest (noise on the inputs)."""
    known = disturbance.equation_variance(theta)
    known = np.maximum(known, 1e-12 * known.max())
    return known + excess_variance(known, np.abs(z - X @ theta) ** 2, X.shape[0] - 0.5 * X.shape[1])


def excess_variance(
    known: Float[np.ndarray, " n_omega"], found: Float[np.ndarray, " n_omega"], freedom: float
) -> float:
    """Variance beyond the known one, alike of all, that squared residuals ask for.

    Notes
    -----
    As Mandel and Paule (1970): with it the weighted residuals are as large as their
    freedom. A difference of means would be that of the few lines where the motion is
    least known, a hundred thousand times the rest of the others.
    """
    rest = 0.0
    for _ in range(_ITERATIONS):  # Newton from below on a convex, falling sum
        weight = 1.0 / (known + rest)
        excess = float(found @ weight) - freedom
        slope = float(found @ weight**2)
        if excess <= 1e-3 * freedom or slope == 0.0:
            break
        rest += excess / slope
    return rest


def _with_covariance(
    X: Complex[np.ndarray, "n_omega p"],
    z: Complex[np.ndarray, " n_omega"],
    weighing: Weighing,
    certainty: Certainty,
    disturbance: Disturbance | None = None,
) -> Regression:
    n_lines, p = X.shape
    theta, variance = weighing.values, weighing.variance
    nu = (z - X @ theta) / np.sqrt(variance)
    freedom = n_lines - 0.5 * p
    level = float(np.sum(np.abs(nu) ** 2)) / freedom
    one_group = np.zeros(n_lines, dtype=int)
    density = np.real(noise.smoothed_density(nu[:, None], one_group, 1).of_lines()[:, 0, 0])
    density *= n_lines / freedom
    directions = certainty.directions / certainty.motion
    root = np.sqrt(np.maximum(density, 0.0) / variance)
    scattered = _as_real(X * root[:, None]) @ certainty.directions
    corrected = 0.5 * directions @ (scattered.T @ scattered) @ directions.T
    if disturbance is not None:
        corrected += disturbance.doubt**2 * np.outer(certainty.pulled, certainty.pulled)
        corrected += certainty.untold
        if disturbance.systematic is not None:
            errors = disturbance.systematic @ np.append(-theta, 1.0)
            moved = directions @ (
                certainty.directions.T @ np.real((X.conj() / variance[:, None]).T @ errors)
            )
            corrected += moved @ moved.T
    plain = 0.5 * level * (directions @ certainty.directions.T)
    return Regression(theta, 0.5 * (plain + plain.T), 0.5 * (corrected + corrected.T))
