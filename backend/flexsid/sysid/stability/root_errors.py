"""Uncertainty of roots and flutter speeds due to the covariance of the derivatives."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.optimize import linear_sum_assignment

from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.stability.poles import (
    Aeroelastic,
    Modal,
    StateFamily,
    build_state_family,
    compute_eigenvalue_slopes,
    compute_polar_slopes,
    decompose_states,
)
from flexsid.sysid.stability.root_tracking import SLOW_MOTIONS, FlutterCrossing, RootLocus
from flexsid.sysid.stability.shaped_roots import (
    ShapedRoots,
    build_shaped_system,
    compute_shaped_slopes,
)

_SECOND_ORDER_RATIO = 0.35  # over first order: above it, standard errors are wrong by a tenth
_STRIDE = 5  # speeds between evaluations of the coupling of all roots, which changes slowly
_MONTE_CARLO_SAMPLES = 1000  # standard errors from samples scatter by 2 %
_STEP = 1e-4  # of the airspeed, for the slope of a root
_CROSSING_SAMPLES = 400  # a bound of 95 % scatters by 7 % of its distance
_CROSSING_STEP = 1.02  # ratio of airspeeds of the first search: a narrower hump is no danger
_BISECTIONS = 5  # of their distance: to 0.06 % of the airspeed


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
    ) -> Float[np.ndarray, "n_resamplings n_rows n_columns"]:
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

    ``by_monte_carlo`` marks speeds at which roots lie so close that draws replaced first order.
    """

    real_std: Float[np.ndarray, "n_v n_branches"]
    imag_std: Float[np.ndarray, "n_v n_branches"]
    damping_std: Float[np.ndarray, "n_v n_branches"]
    by_monte_carlo: Bool[np.ndarray, " n_v"]


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
    if aircraft.shape is not None:
        return _estimate_shaped_bands(aircraft, locus, uncertain, density)
    family = build_state_family(aircraft, locus.airspeed, density)
    modal = decompose_states(family.A)
    own = np.argmin(np.abs(modal.values[:, None, :] - locus.roots[:, :, None]), axis=2)
    slopes = compute_eigenvalue_slopes(family, modal, uncertain.rows, uncertain.columns, own, own)
    real, imag, damping = (
        _compute_deviation(part, uncertain.covariance)
        for part in (np.real(slopes), np.imag(slopes), compute_polar_slopes(locus.roots, slopes)[1])
    )
    second_order = _compute_second_order(family, modal, own, uncertain)
    close = np.asarray((second_order > _SECOND_ORDER_RATIO * np.hypot(real, imag)).any(axis=1))
    if close.any():
        there = replace(locus, airspeed=locus.airspeed[close], roots=locus.roots[close])
        drawn = sample_root_bands(aircraft, there, uncertain, density)
        real[close], imag[close] = drawn.real_std, drawn.imag_std
        damping[close] = drawn.damping_std
    return RootBands(real, imag, damping, close)


def _estimate_shaped_bands(
    aircraft: Aeroelastic,
    locus: RootLocus,
    uncertain: UncertainDerivatives,
    density: float | None,
) -> RootBands:
    """Estimate first-order standard errors of the roots of a frequency shape."""
    parts = [np.empty(locus.roots.shape) for _ in range(3)]
    system = build_shaped_system(aircraft)
    air = aircraft.condition.density if density is None else density
    for branch, roots in enumerate(locus.roots.T):
        found = ShapedRoots(system, locus.airspeed, roots, air)
        slopes = compute_shaped_slopes(found, aircraft, uncertain.rows, uncertain.columns)[0]
        every = (np.real(slopes), np.imag(slopes), compute_polar_slopes(roots, slopes)[1])
        for part, slope in zip(parts, every, strict=True):
            part[:, branch] = _compute_deviation(slope, uncertain.covariance)
    real, imag, damping = parts
    return RootBands(real, imag, damping, np.zeros(locus.airspeed.size, dtype=bool))


def _place_shaped_roots(
    aircraft: Aeroelastic, airspeed: np.ndarray, roots: np.ndarray, density: float | None
) -> ShapedRoots:
    air = aircraft.condition.density if density is None else density
    return ShapedRoots(build_shaped_system(aircraft), airspeed, roots, air)


def sample_root_bands(
    aircraft: Aeroelastic,
    locus: RootLocus,
    uncertain: UncertainDerivatives,
    density: float | None = None,
) -> RootBands:
    """Estimate standard errors by Monte Carlo; roots matched by distance."""
    family = build_state_family(aircraft, locus.airspeed, density)
    tables = uncertain.draw(aircraft.derivatives, _MONTE_CARLO_SAMPLES, seed=0)
    change = (tables - aircraft.derivatives.values)[:, :, : family.variable_states.size]
    found = np.empty((_MONTE_CARLO_SAMPLES, *locus.roots.shape), dtype=complex)
    for k, roots in enumerate(locus.roots):
        A = np.tile(family.A[k], (_MONTE_CARLO_SAMPLES, 1, 1))
        A[:, :, family.variable_states] += family.forced @ (family.scale[k] * change)
        for draw, values in enumerate(np.linalg.eigvals(A)):
            cost = np.abs(roots[:, None] - values)
            found[draw, k] = values[linear_sum_assignment(cost)[1]]
    size = np.maximum(np.abs(found), 1e-12)
    return RootBands(
        np.real(found).std(axis=0),
        np.imag(found).std(axis=0),
        (-np.real(found) / size).std(axis=0),
        np.ones(locus.airspeed.size, dtype=bool),
    )


def estimate_crossing_error(
    aircraft: Aeroelastic,
    crossing: FlutterCrossing,
    uncertain: UncertainDerivatives,
    density: float | None = None,
) -> float:
    """Estimate the first-order standard error of a crossing's airspeed. [m/s]

    Notes
    -----
    On the axis Re lambda(V, theta) = 0, so that dV = -Re(lambda_theta) / Re(lambda_V). A root
    that diverges where attitude integrates has no eigenvector of its own: the error is NaN,
    as it is with a covariance that is not finite.
    """
    slopes = compute_crossing_slopes(aircraft, crossing, uncertain.rows, uncertain.columns, density)
    if not (np.isfinite(uncertain.covariance).all() and np.isfinite(slopes).all()):
        return float("nan")
    return float(np.sqrt(max(slopes @ uncertain.covariance @ slopes, 0.0)))


@dataclass(frozen=True, slots=True)
class ModalErrors:
    """Covariance of the relative errors of a modal table, and what they change.

    The errors are those of omega, of all modes, followed by those of 2 zeta omega: with them
    omega^2 is less by twice the error, 2 zeta omega by the error. ``gains`` are the changes of the
    derivatives with them.
    """

    covariance: Float[np.ndarray, "n_errors n_errors"]
    gains: Float[np.ndarray, "n_theta n_errors"]

    def draw(self, rng: np.random.Generator, count: int) -> Float[np.ndarray, "count n_errors"]:
        """Draw errors; no structure has less than no damping."""
        values, vectors = np.linalg.eigh(self.covariance)
        half = vectors * np.sqrt(np.maximum(values, 0.0))
        drawn = rng.standard_normal((count, values.size)) @ half.T
        drawn[:, values.size // 2 :] = np.minimum(drawn[:, values.size // 2 :], 1.0)
        return drawn


def compute_modal_factors(aircraft: Aeroelastic) -> Float[np.ndarray, " n_errors"]:
    """Compute the decreases of omega^2 [rad2/s2] and 2 zeta omega [rad/s] with relative errors."""
    modes = aircraft.modes
    return np.concatenate([2.0 * modes.omega**2, 2.0 * modes.zeta * modes.omega])


def estimate_growth_rates(
    aircraft: Aeroelastic,
    airspeed: Float[np.ndarray, " n_v"],
    uncertain: UncertainDerivatives,
    modal_errors: ModalErrors,
    density: float | None = None,
) -> tuple[Float[np.ndarray, "n_v n_roots"], Float[np.ndarray, "n_v n_roots"]]:
    """Compute the real parts of all fast roots and their first-order standard errors. [rad/s]

    Slow roots, of phugoid and spiral, are minus infinity.
    """
    family = build_state_family(aircraft, airspeed, density)
    modal = decompose_states(family.A)
    slopes = np.real(compute_eigenvalue_slopes(family, modal, uncertain.rows, uncertain.columns))
    n = aircraft.modes.omega.size
    etadot = modal.left[:, -n:].conj()
    of_table = np.concatenate(
        [etadot * modal.right[:, -2 * n : -n], etadot * modal.right[:, -n:]], axis=1
    )
    of_table = np.real(of_table).transpose(0, 2, 1) * compute_modal_factors(aircraft)
    of_table = of_table + slopes @ modal_errors.gains
    std = np.hypot(
        _compute_deviation(slopes, uncertain.covariance),
        _compute_deviation(of_table, modal_errors.covariance),
    )
    is_slow = np.isin(_find_leading(family, modal), _list_slow(aircraft))
    return np.where(is_slow, -np.inf, np.real(modal.values)), std


def _find_leading(family: StateFamily, modal: Modal) -> Int[np.ndarray, "n_v n_roots"]:
    """Find the motion with the largest participation in each root."""
    return np.argmax(family.membership @ np.abs(modal.left * modal.right), axis=1)


def _list_slow(aircraft: Aeroelastic) -> list[int]:
    return [k for k, name in enumerate(aircraft.motions) if name in SLOW_MOTIONS]


def sample_crossings(
    aircraft: Aeroelastic,
    band: tuple[float, float],
    uncertain: UncertainDerivatives,
    modal_errors: ModalErrors,
    density: float | None = None,
) -> Float[np.ndarray, " n_resamplings"]:
    """Draw the airspeeds at which models within the errors become unstable first. [m/s]

    Infinite where a model is stable over the band; slowly unstable flight is no instability.

    Parameters
    ----------
    band
        Lowest and highest airspeed. [m/s]

    Notes
    -----
    Unlike the slope of one crossing this holds where roots coalesce, a hump barely reaches the
    axis, or another root becomes unstable before. The first speed of a coarse search at which a
    draw is unstable is refined by bisection. The draws are the same for every model.
    """
    errors = modal_errors.draw(np.random.default_rng(1), _CROSSING_SAMPLES)
    change = uncertain.draw(aircraft.derivatives, _CROSSING_SAMPLES, seed=0)
    change = change - aircraft.derivatives.values
    change[:, uncertain.rows, uncertain.columns] += errors @ modal_errors.gains.T
    slow, n = _list_slow(aircraft), aircraft.modes.omega.size
    of_table = errors * compute_modal_factors(aircraft)

    def is_unstable(draws: Int[np.ndarray, " n"], speeds: Float[np.ndarray, " n"]):
        family = build_state_family(aircraft, speeds, density)
        moved = change[draws][:, :, : family.variable_states.size]
        A = family.A.copy()
        A[:, :, family.variable_states] += family.forced @ (family.scale * moved)
        etadot = np.arange(A.shape[1] - n, A.shape[1])
        A[:, etadot, etadot - n] += of_table[draws, :n]
        A[:, etadot, etadot] += of_table[draws, n:]
        if not slow:
            return np.any(np.real(np.linalg.eigvals(A)) > 0.0, axis=1)
        found = decompose_states(A)
        is_fast = ~np.isin(_find_leading(family, found), slow)
        return np.any((np.real(found.values) > 0.0) & is_fast, axis=1)

    low, high = np.full(_CROSSING_SAMPLES, band[0]), np.full(_CROSSING_SAMPLES, np.inf)
    left = np.arange(_CROSSING_SAMPLES)
    n_speeds = 1 + int(np.ceil(np.log(band[1] / band[0]) / np.log(_CROSSING_STEP)))
    for speed in np.geomspace(*band, n_speeds).tolist():
        if not left.size:
            break
        grows = is_unstable(left, np.full(left.size, speed))
        high[left[grows]] = speed
        left = left[~grows]
        low[left] = speed
    crossing = np.flatnonzero(np.isfinite(high))
    for _ in range(_BISECTIONS):
        middle = 0.5 * (low[crossing] + high[crossing])
        grows = is_unstable(crossing, middle)
        high[crossing[grows]] = middle[grows]
        low[crossing[~grows]] = middle[~grows]
    return high


def compute_crossing_slopes(
    aircraft: Aeroelastic,
    crossing: FlutterCrossing,
    rows: np.ndarray,
    columns: np.ndarray,
    density: float | None = None,
) -> Float[np.ndarray, " n_theta"]:
    """Compute the change of a crossing's airspeed with derivatives. [m/s]

    NaN where a root that diverges has no eigenvector of its own. Rows and columns are the places
    of the derivatives in the table.
    """
    if aircraft.shape is not None:
        there = _place_shaped_roots(aircraft, *_get_axis_root(crossing), density)
        slopes = compute_shaped_slopes(there, aircraft, rows, columns)
        by_theta, by_speed = slopes[0][0], complex(slopes[1][0])
    else:
        family, modal, root, by_speed = _decompose_crossing(aircraft, crossing, density)
        by_theta = compute_eigenvalue_slopes(family, modal, rows, columns)[1, root]
    if not (np.isfinite(by_speed) and np.real(by_speed)):
        return np.full(by_theta.size, np.nan)
    return -np.real(by_theta) / np.real(by_speed)


def compute_damping_slopes(
    aircraft: Aeroelastic, root: complex, rows: np.ndarray, columns: np.ndarray
) -> Float[np.ndarray, " n_theta"]:
    """Compute the change of the damping ratio of a root with derivatives. [1]

    The root [rad/s] is the nearest at the aircraft's own condition; its air forces are
    quasi-steady.
    """
    condition = aircraft.condition
    family = build_state_family(aircraft, np.array([condition.airspeed]), condition.density)
    modal = decompose_states(family.A)
    index = int(np.argmin(np.abs(modal.values[0] - root)))
    slopes = compute_eigenvalue_slopes(family, modal, rows, columns)[0, index]
    return compute_polar_slopes(modal.values[0, index], slopes)[1]


def compute_modal_slopes(
    aircraft: Aeroelastic, crossing: FlutterCrossing, density: float | None = None
) -> tuple[Float[np.ndarray, " n_modes"], Float[np.ndarray, " n_modes"]]:
    """Change of a crossing's airspeed with omega^2 and 2 zeta omega of every mode. [m/s per SI]

    Notes
    -----
    As ``estimate_crossing_error``: dV = -Re(lambda_k) / Re(lambda_V), with k = omega_i^2,
    which enters the state matrix as -k where eta_i accelerates itself; 2 zeta omega does where
    etadot_i, lambda eta_i, does.
    """
    along = 1j * crossing.frequency
    if aircraft.shape is not None:
        there = _place_shaped_roots(aircraft, *_get_axis_root(crossing), density)
        none = np.zeros(0, dtype=int)
        _, speeds, slopes = compute_shaped_slopes(there, aircraft, none, none)
        by_speed, by_stiffness = complex(speeds[0]), slopes[0]
        by_damping = along * by_stiffness
        return -np.real(by_stiffness) / by_speed.real, -np.real(by_damping) / by_speed.real
    _, modal, root, by_speed = _decompose_crossing(aircraft, crossing, density)
    n = len(aircraft.modes.numbers)
    if not np.isfinite(by_speed) or not np.real(by_speed):
        return np.full(n, np.nan), np.full(n, np.nan)
    eta, etadot = modal.right[1, -2 * n :, root][:n], modal.left[1, -2 * n :, root][n:]
    by_stiffness = -etadot.conj() * eta
    by_damping = along * by_stiffness
    return -np.real(by_stiffness) / np.real(by_speed), -np.real(by_damping) / np.real(by_speed)


def _get_axis_root(crossing: FlutterCrossing) -> tuple[np.ndarray, np.ndarray]:
    return np.array([crossing.airspeed]), np.array([1j * crossing.frequency])


def _decompose_crossing(
    aircraft: Aeroelastic, crossing: FlutterCrossing, density: float | None
) -> tuple[StateFamily, Modal, int, complex]:
    """States just below, at and above a crossing, its root, and the root's slope in airspeed."""
    near = crossing.airspeed * (1.0 + _STEP * np.array([-1.0, 0.0, 1.0]))
    family = build_state_family(aircraft, near, density)
    modal = decompose_states(family.A)
    root = int(np.argmin(np.abs(modal.values[1] - 1j * crossing.frequency)))
    left, right = modal.left[1, :, root], modal.right[1, :, root]
    by_speed = left.conj() @ (family.A[2] - family.A[0]) @ right / (near[2] - near[0])
    return family, modal, root, complex(by_speed)


def _compute_deviation(slopes: np.ndarray, covariance: np.ndarray) -> np.ndarray:
    """Standard deviations of values with these slopes (..., n_theta)."""
    return np.asarray(np.sqrt(np.maximum(np.sum((slopes @ covariance) * slopes, axis=-1), 0.0)))


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
    places, size = (uncertain.rows, uncertain.columns), np.ones(own.shape)
    for left, right in ((own, other), (other, own)):
        slopes = compute_eigenvalue_slopes(family, modal, *places, left, right)
        size *= np.hypot(
            _compute_deviation(np.real(slopes), uncertain.covariance),
            _compute_deviation(np.imag(slopes), uncertain.covariance),
        )
    roots, others = (np.take_along_axis(modal.values, k, axis=1) for k in (own, other))
    distance = np.where(own == other, np.inf, np.abs(roots - others))
    return size / np.maximum(distance, 1e-12)
