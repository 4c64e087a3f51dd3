"""Poles of the identified model and their participation, and one aircraft at many airspeeds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy
from jaxtyping import Complex, Float

from flexsid.errors import BadInput, NotIdentifiable
from flexsid.sysid.estimation.experiment import Parameters
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.condition import GRAVITY, FlightCondition, Trim
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.model.frequency_shape import FrequencyShape, build_lagged_forces
from flexsid.sysid.modes.shapes import StructuralModes

# --- One aircraft at many airspeeds: trim, state matrices, and their slopes in the derivatives


@dataclass(frozen=True, slots=True)
class Aeroelastic:
    """Derivatives, structure and loading of an aircraft at any speed.

    ``condition`` is one trimmed condition; others follow from it by constant weight. Without a
    ``shape`` the air forces are quasi-steady.
    """

    condition: FlightCondition
    modes: StructuralModes
    derivatives: DerivativeTable
    shape: FrequencyShape | None = None

    @property
    def motions(self) -> tuple[str, ...]:
        """Names of roots: those of the rigid body, and each mode by number."""
        return (*self.derivatives.body.poles, *(str(number) for number in self.modes.numbers))


@dataclass(frozen=True, slots=True)
class StateFamily:
    """State matrices at many speeds, and where each derivative enters them.

    The states are the motions of the rigid body, the attitude if gravity acts by it, eta...,
    etadot...: the pitch angle only integrates q in level flight. ``forced`` is the effect of
    each row of the derivatives on the rates of the states, ``membership`` assigns states to
    the motions that name roots.
    """

    A: Float[np.ndarray, "n_v n_x n_x"]
    scale: Float[np.ndarray, "n_v n_rows n_columns"]
    forced: Float[np.ndarray, "n_x n_rows"]
    variable_states: np.ndarray
    membership: Float[np.ndarray, "n_motions n_x"]


def build_state_family(
    aircraft: Aeroelastic,
    airspeed: Float[np.ndarray, " n_v"],
    density: float | None = None,
) -> StateFamily:
    """Build A at every airspeed, trimmed in level flight.

    Parameters
    ----------
    aircraft
        Derivatives, structure, and the condition they are known from.
    airspeed, density
        True airspeeds [m/s], and the air's density, that of the condition by default. [kg/m3]

    Raises
    ------
    BadInput
        If an airspeed, the density or a generalised mass is not positive.
    NotIdentifiable
        If a derivative is no number.

    Notes
    -----
    Source: Eqs 5-14. Weight fixes the lift, so that alpha grows with 1/dynamic pressure;
    thrust balances the drag, whose zero-lift part is that of the known condition.
    """
    V = np.asarray(airspeed, dtype=float)
    if V.size == 0 or not (np.isfinite(V) & (V > 0.0)).all():
        raise BadInput("airspeeds must be positive", code="bad-airspeed")
    c, modes = aircraft.condition, aircraft.modes
    air = c.density if density is None else density
    if not 0.0 < air < np.inf:
        raise BadInput(f"an air density of {air:g} kg/m3 is not positive", code="bad-density")
    for number, mass in zip(modes.numbers, modes.mass.tolist(), strict=True):
        if not 0.0 < mass < np.inf:
            raise BadInput(
                f"mode {number} has a generalised mass of {mass:g}; the modal table must give a"
                " positive one",
                code="bad-mass",
                mode=number,
            )
    if not np.isfinite(aircraft.derivatives.values).all():
        raise NotIdentifiable("the model has a derivative that is not finite; select other runs")
    n = len(modes.numbers)
    force = 0.5 * air * V**2 * c.area
    weight = c.mass * GRAVITY * np.cos(c.gamma)
    known = c.dynamic_pressure * c.area
    clean = (c.thrust - c.induced_drag * weight**2 / known) / known
    alpha = c.alpha * known / force
    thrust = force * clean + c.induced_drag * weight**2 / force
    body = aircraft.derivatives.body
    trim = Trim(V, 0.5 * air * V**2, alpha, thrust)
    columns = body.column_factors(c, n, 0, trim)
    scale = body.row_factors(c, modes.mass, trim)[:, :, None] * columns[:, None, :]
    known = body.kinematics(c, trim)
    first = body.size
    n_rigid = first + body.acts_by_gravity
    eta, etadot = np.arange(n_rigid, n_rigid + n), np.arange(n_rigid + n, n_rigid + 2 * n)
    variable_states = np.r_[:first, eta, etadot]
    inverse = np.linalg.inv(known.inertia)
    forced = np.zeros((n_rigid + 2 * n, first + n))
    forced[:first, :first] = inverse
    forced[etadot, first:] = np.eye(n)
    A = np.zeros((V.size, n_rigid + 2 * n, n_rigid + 2 * n))
    A[:, :, variable_states] = forced @ (
        scale * aircraft.derivatives.values[:, : variable_states.size]
    )
    A[:, :first, :first] += inverse @ known.coupling
    if body.acts_by_gravity:
        A[:, :first, first] += known.gravity @ inverse.T
        A[:, first, :first] = known.attitude_rate
    A[:, eta, etadot] = 1.0
    A[:, etadot, eta] -= modes.omega**2
    A[:, etadot, etadot] -= 2.0 * modes.zeta * modes.omega
    membership = body.compute_membership(n_rigid, n)
    return StateFamily(A, scale, forced, variable_states, membership)


@dataclass(frozen=True, slots=True)
class Modal:
    """Eigenvalues with left and right vectors, scaled so that left^H right = 1."""

    values: Complex[np.ndarray, "n_v n_roots"]
    left: Complex[np.ndarray, "n_v n_x n_roots"]
    right: Complex[np.ndarray, "n_v n_x n_roots"]


def decompose_states(A: Float[np.ndarray, "n_v n_x n_x"]) -> Modal:
    """Compute eigenvalues and vectors of the state matrices of every speed."""
    values, right = (part.astype(complex) for part in np.linalg.eig(A))
    left = np.linalg.inv(right).conj().transpose(0, 2, 1)
    return Modal(values, left, right)


def compute_eigenvalue_slopes(
    family: StateFamily,
    modal: Modal,
    rows: np.ndarray,
    columns: np.ndarray,
    left_of: np.ndarray | None = None,
    right_of: np.ndarray | None = None,
) -> Complex[np.ndarray, "n_v n_roots n_theta"]:
    """Compute the change of every eigenvalue with the derivatives at (rows, columns).

    Parameters
    ----------
    left_of, right_of
        Eigenvalues at every speed (n_v, n_roots) whose left and right vectors to take; all
        by default. For two different ones it is their coupling.

    Notes
    -----
    d lambda = w^H dA v for vectors with w^H v = 1. Derivatives of the inputs change nothing.
    """
    acts = columns < family.variable_states.size
    at = np.where(acts, columns, 0)
    pull = (_select_roots(modal.left, left_of) @ family.forced)[:, :, rows].conj()
    moved = _select_roots(modal.right, right_of)[:, :, family.variable_states[at]]
    weight = np.where(acts, family.scale[:, rows, at], 0.0)
    return pull * moved * weight[:, None, :]


def _select_roots(
    vectors: Complex[np.ndarray, "n_v n_x n_x"], roots: np.ndarray | None
) -> Complex[np.ndarray, "n_v n_roots n_x"]:
    """Eigenvectors of the roots, one in each row."""
    beside = vectors if roots is None else np.take_along_axis(vectors, roots[:, None, :], axis=2)
    return beside.transpose(0, 2, 1)


def compute_polar_slopes(
    roots: Complex[np.ndarray, "*roots"], slopes: Complex[np.ndarray, "*roots n_theta"]
) -> tuple[Float[np.ndarray, "*roots n_theta"], Float[np.ndarray, "*roots n_theta"]]:
    """Compute the change of the modulus of roots [rad/s] and of their damping ratio [1]."""
    size = np.maximum(np.abs(roots), 1e-12)[..., None]
    modulus = np.real(np.conj(roots)[..., None] * slopes) / size
    return modulus, -np.real(slopes) / size + np.real(roots)[..., None] / size**2 * modulus


def compute_participation(
    modal: Modal, at: int, membership: Float[np.ndarray, "n_motions n_x"]
) -> Float[np.ndarray, "n_motions n_roots"]:
    """Compute the share of every motion in every root.

    Left times right eigenvector, summed over the states of a motion.
    """
    share = membership @ np.abs(modal.left[at] * modal.right[at])
    return share / share.sum(axis=0)


def name_roots(
    participation: Float[np.ndarray, "n_motions n_roots"], motions: tuple[str, ...]
) -> tuple[str, ...]:
    """Name roots by their motion of largest participation, each motion taken once if possible."""
    leading = np.argmax(participation, axis=0)
    motion, root = scipy.optimize.linear_sum_assignment(-participation)
    leading[root] = motion
    return tuple(motions[k] for k in leading)


def compute_named_roots(aircraft: Aeroelastic) -> dict[str, complex]:
    """Compute the roots of an aircraft at its own condition by motion. [rad/s]

    Of a pair it is the root above the real axis. A motion that leads several roots has the one
    that oscillates fastest.
    """
    condition = aircraft.condition
    family = build_state_family(aircraft, np.array([condition.airspeed]), condition.density)
    modal = decompose_states(family.A)
    upper = np.flatnonzero(np.imag(modal.values[0]) >= 0.0)
    participation = compute_participation(modal, 0, family.membership)[:, upper]
    names = name_roots(participation, aircraft.motions)
    found = zip(names, modal.values[0, upper].tolist(), strict=True)
    return dict(sorted(found, key=lambda pair: pair[1].imag))


# --- Poles of the identified model, named by participation, with standard errors ------------------

_FASTEST_ROOT = 2.0  # of the highest k of a frequency shape: poles of motion with lags are slower


@dataclass(frozen=True, slots=True)
class NamedPole:
    """One pole (of a pair, the one above the real axis). [rad/s]

    ``frequency`` [rad/s] is its modulus, ``damping`` its damping ratio.
    """

    name: str
    value: complex
    real_std: float
    imag_std: float
    frequency_std: float
    damping_std: float

    @property
    def frequency(self) -> float:
        """Undamped natural frequency. [rad/s]"""
        return abs(self.value)

    @property
    def damping(self) -> float:
        """Damping ratio; negative where unstable."""
        return -self.value.real / abs(self.value)


def compute_named_poles(
    model: AeroelasticModel,
    parameters: Parameters,
    theta: Float[np.ndarray, " n_theta"],
    covariance: Float[np.ndarray, "n_theta n_theta"],
    mode_names: tuple[str, ...],
) -> tuple[NamedPole, ...]:
    """Compute eigenvalues of A with first-order standard errors.

    ``mode_names`` are those of the poles dominated by each structural mode. Rigid-body
    poles come first, then those by mode; the integrator of theta is omitted.

    Notes
    -----
    A pole belongs to the motion with the largest participation (left times right
    eigenvector), each motion taken once. Standard errors by the delta method from
    the derivative of a simple eigenvalue, d lambda = w^H dA v / w^H v.
    """
    values = dict(zip(parameters.names, theta.tolist(), strict=True))
    tuned = replace(model, modes=model.modes.tuned(values))
    if model.shape is None:
        family = _build_state_family(tuned, parameters.table(theta))
        modal = decompose_states(family.A)
        membership = family.membership
        upper = np.flatnonzero(np.imag(modal.values[0]) >= 0)
        by_derivative = compute_eigenvalue_slopes(
            family, modal, parameters.rows, parameters.columns
        )[0]
    else:
        modal, membership, by_derivative = _decompose_lagged(tuned, parameters, theta)
        upper = np.arange(modal.values.shape[1])
    roots = modal.values[0, upper]
    n_fixed, motions = parameters.rows.size, (*model.body.poles, *mode_names)
    slopes = np.zeros((upper.size, theta.size), dtype=complex)
    slopes[:, :n_fixed] = by_derivative[upper]
    for index, extra in enumerate(parameters.extras, start=n_fixed):
        if extra.kind in ("omega", "zeta"):
            own = _compute_structural_slopes(model, tuned, modal, extra.kind, extra.mode)
            slopes[:, index] = own[upper]
    rows = [np.real(slopes), np.imag(slopes), *compute_polar_slopes(roots, slopes)]
    named = name_roots(compute_participation(modal, 0, membership)[:, upper], motions)
    poles = [
        NamedPole(name, complex(root), *_estimate_std(own, covariance))
        for name, root, own in zip(named, roots, np.stack(rows, axis=1), strict=True)
    ]
    return tuple(sorted(poles, key=lambda pole: (motions.index(pole.name), abs(pole.value))))


def _build_state_family(model: AeroelasticModel, table: DerivativeTable) -> StateFamily:
    A = model.state_space(table).A
    dynamic = _select_dynamic_states(A, model.n_rigid)
    variables = np.searchsorted(dynamic, model.variable_states())
    scale = model.row_factors()[:, None] * model.column_factors()[: variables.size]
    n = len(model.modes.numbers)
    return StateFamily(
        A[np.ix_(dynamic, dynamic)][None],
        scale[None],
        model.force_matrix()[dynamic],
        variables,
        model.body.compute_membership(dynamic.size - 2 * n, n),
    )


def _select_dynamic_states(A: Float[np.ndarray, "n_x n_x"], attitude: int) -> np.ndarray:
    """Select all states but an attitude that only integrates: theta in level flight."""
    states = np.arange(len(A))
    return states if np.any(A[:, attitude]) else np.delete(states, attitude)


def _decompose_lagged(
    model: AeroelasticModel, parameters: Parameters, theta: Float[np.ndarray, " n_theta"]
) -> tuple[Modal, Float[np.ndarray, "n_motions n_x"], Complex[np.ndarray, "n_roots n_theta"]]:
    """Decompose a model with lag states: roots of motion, with vectors on the motion alone.

    Also the membership of its states and the slopes of the roots. Roots of motion have the largest
    share outside the lags: above the real axis one of the rigid body and one of each mode, on it
    the other poles of the rigid body. Roots far beyond the highest k are of fast lags.
    """
    assert model.shape is not None
    fastest = _FASTEST_ROOT * model.shape.k[-1] / model.condition.rate_factor
    n, first = len(model.modes.numbers), model.n_rigid
    A = model.state_space(parameters.table(theta)).A
    dynamic = _select_dynamic_states(A, first)
    forced = model.force_matrix()
    n_motion = dynamic.size - (len(A) - len(forced))
    modal = decompose_states(A[np.ix_(dynamic, dynamic)][None])
    values, left, right = modal.values[0], modal.left[0], modal.right[0]
    share = np.abs(left * right)
    outside = share[:n_motion].sum(axis=0) / share.sum(axis=0)
    slow = np.abs(values) < fastest
    above, real = (np.flatnonzero(slow & at) for at in (np.imag(values) > 0.0, np.isreal(values)))
    most = [
        own[np.argsort(-outside[own])][:count]
        for own, count in ((above, n + 1), (real, len(model.body.poles) - 1))
    ]
    upper = np.sort(np.concatenate(most))
    loads = build_lagged_forces(model.shape, model.condition).loads[:, :, dynamic]
    rows, columns = parameters.rows, parameters.columns
    effect = forced[dynamic[:n_motion]] * model.row_factors()
    pull = (left[:n_motion].conj().T @ effect).T
    slopes = pull[rows] * (loads[rows, columns] @ right)
    motion = Modal(
        modal.values[:, upper], modal.left[:, :n_motion, upper], modal.right[:, :n_motion, upper]
    )
    membership = model.body.compute_membership(n_motion - 2 * n, n)
    return motion, membership, slopes.T[upper]


def _compute_structural_slopes(
    model: AeroelasticModel, tuned: AeroelasticModel, modal: Modal, kind: str, mode: int
) -> Complex[np.ndarray, " n_x"]:
    """Change of every root with the factor on a mode's frequency or damping in its row."""
    n = len(model.modes.numbers)
    etadot = modal.left.shape[1] - n + mode
    force = modal.left[0, etadot].conj()
    displacement, rate = modal.right[0, etadot - n], modal.right[0, etadot]
    found = tuned.modes
    if kind == "zeta":
        return -2.0 * force * model.modes.zeta[mode] * found.omega[mode] * rate
    moved = found.zeta[mode] * rate + found.omega[mode] * displacement
    return -2.0 * force * model.modes.omega[mode] * moved


def _estimate_std(
    rows: Float[np.ndarray, "4 n_theta"], covariance: Float[np.ndarray, "n_theta n_theta"]
) -> list[float]:
    """Standard errors by the delta method, NaN for what depends on fixed parameters only.

    Such a value is not known exactly: it was not estimated.
    """
    # Parameters without effect on the pole may have no standard error.
    moves = np.any(rows != 0.0, axis=0)
    part = rows[:, moves]
    variance = np.einsum("ri,ij,rj->r", part, covariance[np.ix_(moves, moves)], part)
    return np.sqrt(np.where(variance > 0.0, variance, np.nan)).tolist()


def compute_separation_factor(model: AeroelasticModel, table: DerivativeTable) -> float | None:
    """Compute the lowest structural over the highest rigid-body frequency of a model.

    None without structural modes, or where no pole is of rigid or of structural motion.

    Notes
    -----
    A pole is structural when modal states take the larger part in it. References 22 and 23
    of the paper treat the motions as decoupled from a factor of five on.
    """
    if not model.modes.numbers:
        return None
    family = _build_state_family(model, table)
    modal = decompose_states(family.A)
    shares = compute_participation(modal, 0, family.membership)[: len(model.body.poles)]
    rigid = shares.sum(axis=0) > 0.5
    size = np.abs(modal.values[0])
    if not rigid.any() or rigid.all():
        return None
    return float(size[~rigid].min() / size[rigid].max())


# --- Poles that a fit moved into the band ---------------------------------------------------------

_MOVED = 0.6  # of the frequency in vacuo: lower than at any airspeed of the data


def find_moved_poles(
    poles: Sequence[NamedPole],
    out_of_band: Sequence[tuple[str, float]],
    max_omega: float,
) -> tuple[NamedPole, ...]:
    """Find poles of out-of-band modes that a fit moved into the band.

    Parameters
    ----------
    poles
        Poles of the identified model.
    out_of_band
        Name and frequency in vacuo of the modes above the highest frequency. [rad/s]
    max_omega
        Highest frequency of the fit. [rad/s]
    """
    limits = {name: min(max_omega, _MOVED * omega) for name, omega in out_of_band}
    return tuple(p for p in poles if p.frequency < limits.get(p.name, 0.0))
