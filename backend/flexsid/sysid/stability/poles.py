"""Poles of the identified model, named by participation, with standard errors."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Complex, Float

from flexsid.sysid.estimation.parameters import Parameters
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.model.rational_functions import build_lagged_forces
from flexsid.sysid.stability.state_family import (
    Modal,
    StateFamily,
    compute_eigenvalue_slopes,
    compute_participation,
    compute_polar_slopes,
    decompose_states,
    name_roots,
)

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
