"""Uncertainty of roots and flutter speeds due to the covariance of the derivatives."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float
from scipy.optimize import linear_sum_assignment

from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.stability.flutter import FlutterCrossing, RootLocus
from flexsid.sysid.stability.speeds import (
    Aeroelastic,
    Modal,
    StateFamily,
    build_state_family,
    compute_eigenvalue_slopes,
    decompose_states,
)

_SECOND_ORDER_RATIO = 0.35  # over first order: above it, standard errors are wrong by a tenth
_STRIDE = 5  # speeds between evaluations of the coupling of all roots, which changes slowly
_DRAWS = 1000  # of Monte Carlo
_STEP = 1e-4  # of the airspeed, for the slope of a root


@dataclass(frozen=True, slots=True)
class UncertainDerivatives:
    """Derivatives with a covariance; the others are fixed.

    ``rows`` and ``columns`` are their places in the table.
    """

    rows: np.ndarray
    columns: np.ndarray
    covariance: Float[np.ndarray, "n_theta n_theta"]

    def draw(
        self, table: DerivativeTable, count: int, seed: int
    ) -> Float[np.ndarray, "n_draws n_rows n_columns"]:
        """Draw tables from the covariance."""
        scale = np.sqrt(np.maximum(np.diag(self.covariance), 0.0))
        unit = np.where(scale > 0.0, scale, 1.0)
        values, vectors = np.linalg.eigh(self.covariance / np.outer(unit, unit))
        half = vectors * np.sqrt(np.maximum(values, 0.0))
        normal = np.random.default_rng(seed).standard_normal((count, scale.size))
        tables = np.tile(table.values, (count, 1, 1))
        tables[:, self.rows, self.columns] += normal @ half.T * unit
        return tables


@dataclass(frozen=True, slots=True)
class RootBands:
    """Standard errors of real and imaginary parts [rad/s] and of the damping ratio [1].

    ``by_draws`` marks speeds at which roots lie so close that draws replaced first order.
    """

    real_std: Float[np.ndarray, "n_v n_branches"]
    imag_std: Float[np.ndarray, "n_v n_branches"]
    damping_std: Float[np.ndarray, "n_v n_branches"]
    by_draws: Bool[np.ndarray, " n_v"]


def estimate_root_bands(
    aircraft: Aeroelastic,
    locus: RootLocus,
    uncertain: UncertainDerivatives,
    density: float | None = None,
) -> RootBands:
    """Estimate standard errors of all roots over airspeed.

    Notes
    -----
    By the derivative of a simple eigenvalue. Its second derivative is the coupling of the root
    with the others, over their distances; where it is not small, near a coalescence or where
    the first derivative vanishes, a thousand draws replace first order.
    """
    family = build_state_family(aircraft, locus.airspeed, density)
    modal = decompose_states(family)
    own = _match_columns(modal, locus)
    gradient = compute_eigenvalue_slopes(family, modal, uncertain.rows, uncertain.columns, own, own)
    real, imag, damping = _compute_deviations(gradient, locus.roots, uncertain.covariance)
    second_order = _compute_second_order(family, modal, own, uncertain)
    close = np.any(
        second_order > _SECOND_ORDER_RATIO * np.hypot(real, imag), axis=1, keepdims=True
    )[:, 0]
    if close.any():
        drawn = sample_root_bands(aircraft, locus, uncertain, density, only=close)
        for mine, other in ((real, drawn.real_std), (imag, drawn.imag_std)):
            mine[close] = other
        damping[close] = drawn.damping_std
    return RootBands(real, imag, damping, close)


def sample_root_bands(
    aircraft: Aeroelastic,
    locus: RootLocus,
    uncertain: UncertainDerivatives,
    density: float | None = None,
    *,
    only: Bool[np.ndarray, " n_v"] | None = None,
    count: int = _DRAWS,
    seed: int = 0,
) -> RootBands:
    """Estimate standard errors by Monte Carlo, at all speeds or some; roots matched by distance."""
    selected = np.ones(locus.airspeed.size, dtype=bool) if only is None else only
    at, roots = locus.airspeed[selected], locus.roots[selected]
    family = build_state_family(aircraft, at, density)
    tables = uncertain.draw(aircraft.derivatives, count, seed)
    n_x = family.A.shape[1]
    change = (tables - aircraft.derivatives.values)[:, :, :n_x]
    found = np.empty((count, *roots.shape), dtype=complex)
    for k in range(at.size):
        A = np.tile(family.A[k], (count, 1, 1))
        A[:, family.force_states] += family.scale[k] * change
        values = np.linalg.eigvals(A)
        for draw in range(count):
            cost = np.abs(roots[k][:, None] - values[draw])
            found[draw, k] = values[draw, linear_sum_assignment(cost)[1]]
    size = np.maximum(np.abs(found), 1e-12)
    return RootBands(
        np.real(found).std(axis=0),
        np.imag(found).std(axis=0),
        (-np.real(found) / size).std(axis=0),
        np.ones(at.size, dtype=bool),
    )


@dataclass(frozen=True, slots=True)
class CrossingError:
    """Standard errors of a crossing's airspeed [m/s] and frequency [rad/s], and the slope.

    ``gradient`` is the change of the airspeed with every uncertain derivative.
    """

    airspeed_std: float
    frequency_std: float
    gradient: Float[np.ndarray, " n_theta"]


def estimate_crossing_error(
    aircraft: Aeroelastic,
    crossing: FlutterCrossing,
    uncertain: UncertainDerivatives,
    density: float | None = None,
) -> CrossingError:
    """Estimate the first-order standard error of a flutter speed.

    Notes
    -----
    On the axis Re lambda(V, theta) = 0, so that dV = -Re(lambda_theta) / Re(lambda_V). A root
    that diverges where attitude integrates has no eigenvector of its own: the errors are NaN,
    as they are with a covariance that is not finite.
    """
    speed = crossing.airspeed
    near = speed * (1.0 + _STEP * np.array([-1.0, 0.0, 1.0]))
    family = build_state_family(aircraft, near, density)
    modal = decompose_states(family)
    target = 1j * crossing.frequency
    root = int(np.argmin(np.abs(modal.values[1] - target)))
    left, right = modal.left[1, :, root], modal.right[1, :, root]
    by_speed = left.conj() @ (family.A[2] - family.A[0]) @ right / (near[2] - near[0])
    by_theta = compute_eigenvalue_slopes(family, modal, uncertain.rows, uncertain.columns)[1, root]
    known = np.isfinite(uncertain.covariance).all() and np.isfinite(by_theta).all()
    if not (known and np.isfinite(by_speed) and np.real(by_speed)):
        return CrossingError(np.nan, np.nan, np.full(by_theta.shape, np.nan))
    gradient = -np.real(by_theta) / np.real(by_speed)
    frequency = np.imag(by_theta) + np.imag(by_speed) * gradient
    covariance = uncertain.covariance
    return CrossingError(
        float(np.sqrt(max(gradient @ covariance @ gradient, 0.0))),
        float(np.sqrt(max(frequency @ covariance @ frequency, 0.0))),
        gradient,
    )


def compute_frequency_slopes(
    aircraft: Aeroelastic, crossing: FlutterCrossing, density: float | None = None
) -> Float[np.ndarray, " n_modes"]:
    """Change of a crossing's airspeed with the squared frequency of every mode. [m/s per rad2/s2]

    Notes
    -----
    As ``estimate_crossing_error``: dV = -Re(lambda_k) / Re(lambda_V), with k = omega_i^2,
    which enters the state matrix as -k where eta_i accelerates itself.
    """
    speed = crossing.airspeed
    near = speed * (1.0 + _STEP * np.array([-1.0, 0.0, 1.0]))
    family = build_state_family(aircraft, near, density)
    modal = decompose_states(family)
    root = int(np.argmin(np.abs(modal.values[1] - 1j * crossing.frequency)))
    left, right = modal.left[1, :, root], modal.right[1, :, root]
    by_speed = left.conj() @ (family.A[2] - family.A[0]) @ right / (near[2] - near[0])
    n = len(aircraft.modes.numbers)
    eta, etadot = np.arange(2, 2 + n), np.arange(2 + n, 2 + 2 * n)
    by_stiffness = -left[etadot].conj() * right[eta]
    if not np.isfinite(by_speed) or not np.real(by_speed):
        return np.full(n, np.nan)
    return -np.real(by_stiffness) / np.real(by_speed)


def _match_columns(modal: Modal, locus: RootLocus) -> np.ndarray:
    """Columns of the eigenvalues of every speed nearest to the roots of a locus."""
    distance = np.abs(modal.values[:, None, :] - locus.roots[:, :, None])
    return np.argmin(distance, axis=2)


def _compute_deviations(
    gradient: np.ndarray, roots: np.ndarray, covariance: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    size = np.maximum(np.abs(roots), 1e-12)
    by_real, by_imag = np.real(gradient), np.imag(gradient)
    modulus = np.real(np.conj(roots)[:, :, None] * gradient) / size[:, :, None]
    damping = -by_real / size[:, :, None] + (np.real(roots) / size**2)[:, :, None] * modulus

    return (
        _compute_deviation(by_real, covariance),
        _compute_deviation(by_imag, covariance),
        _compute_deviation(damping, covariance),
    )


def _compute_deviation(slope: np.ndarray, covariance: np.ndarray) -> np.ndarray:
    flat = slope.reshape(-1, slope.shape[2])
    variance = np.sum((flat @ covariance) * flat, axis=1)
    return np.sqrt(np.maximum(variance, 0.0)).reshape(slope.shape[:2])


def _compute_size(slope: np.ndarray, covariance: np.ndarray) -> np.ndarray:
    """Standard deviation of a complex number."""
    return np.hypot(
        _compute_deviation(np.real(slope), covariance),
        _compute_deviation(np.imag(slope), covariance),
    )


def _compute_second_order(
    family: StateFamily, modal: Modal, own: np.ndarray, uncertain: UncertainDerivatives
) -> Float[np.ndarray, "n_v n_branches"]:
    """Standard deviation of every root's second-order change. [rad/s]

    From its nearest neighbour at every speed, from all roots at some speeds.
    """
    n_v, n_x = modal.values.shape
    some = np.unique(np.append(np.arange(0, n_v, _STRIDE), n_v - 1))
    few = replace(family, A=family.A[some], scale=family.scale[some])
    there = Modal(modal.values[some], modal.left[some], modal.right[some])
    square = np.zeros((some.size, own.shape[1]))
    for other in range(n_x):
        beside = np.full_like(own[some], other)
        square += _compute_coupling(few, there, own[some], beside, uncertain) ** 2
    at = np.arange(n_v)
    everywhere = np.stack([np.interp(at, some, column) for column in np.sqrt(square).T], axis=1)
    roots = np.take_along_axis(modal.values, own, axis=1)
    gap = np.abs(roots[:, :, None] - modal.values[:, None, :])
    np.put_along_axis(gap, own[:, :, None], np.inf, axis=2)
    near = np.argmin(gap, axis=2)
    return np.maximum(everywhere, _compute_coupling(family, modal, own, near, uncertain))


def _compute_coupling(
    family: StateFamily,
    modal: Modal,
    own: np.ndarray,
    other: np.ndarray,
    uncertain: UncertainDerivatives,
) -> np.ndarray:
    """Standard deviation of the second-order change of each root by coupling with one other."""
    places = (uncertain.rows, uncertain.columns)
    there = _compute_size(
        compute_eigenvalue_slopes(family, modal, *places, own, other), uncertain.covariance
    )
    back = _compute_size(
        compute_eigenvalue_slopes(family, modal, *places, other, own), uncertain.covariance
    )
    roots, others = (np.take_along_axis(modal.values, k, axis=1) for k in (own, other))
    distance = np.where(own == other, np.inf, np.abs(roots - others))
    return there * back / np.maximum(distance, 1e-12)
