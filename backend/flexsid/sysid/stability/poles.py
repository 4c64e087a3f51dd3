"""Poles of the identified model, named by participation, with standard errors."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Complex, Float
from scipy.optimize import linear_sum_assignment

from flexsid.sysid.estimation.parameters import Parameters
from flexsid.sysid.model.aeroelastic import AeroelasticModel

SHORT_PERIOD = "SP"


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

    Parameters
    ----------
    model, parameters
        As fitted.
    theta, covariance
        Estimate.
    mode_names
        Names of the poles dominated by each structural mode.

    Returns
    -------
    tuple
        Rigid-body pole first, then by mode; the integrator of theta is omitted.

    Notes
    -----
    A pole belongs to the motion with the largest participation (left times right
    eigenvector), each motion taken once. Standard errors by the delta method from
    the derivative of a simple eigenvalue, d lambda = w^H dA v / w^H v.
    """
    table = parameters.table(theta)
    values = dict(zip(parameters.names, theta.tolist(), strict=True))
    A = replace(model, modes=model.modes.tuned(values)).state_space(table).A
    dynamic = np.r_[0, 1, 3 : A.shape[0]]  # theta only integrates q unless the path is inclined
    if np.any(A[:, 2]):
        dynamic = np.arange(A.shape[0])
    A = A[np.ix_(dynamic, dynamic)]
    values, right = np.linalg.eig(A.astype(complex))
    left = np.linalg.inv(right).conj().T  # scaled so that left^H right = 1
    upper = np.flatnonzero(np.imag(values) >= 0)
    names = _assign_names(left, right, upper, dynamic, mode_names)
    gradient = _gradients(model, parameters, theta, left[:, upper], right[:, upper], dynamic)
    poles = [
        _pole(name, complex(values[k]), row, covariance)
        for name, k, row in zip(names, upper, gradient, strict=True)
    ]
    order = {name: rank for rank, name in enumerate((SHORT_PERIOD, *mode_names))}
    return tuple(sorted(poles, key=lambda p: (order.get(p.name, len(order)), abs(p.value))))


def _pole(
    name: str,
    value: complex,
    gradient: Complex[np.ndarray, " n_theta"],
    covariance: Float[np.ndarray, "n_theta n_theta"],
) -> NamedPole:
    """Delta method for real and imaginary part, modulus and damping ratio."""
    size = abs(value)
    by_real, by_imag = np.real(gradient), np.imag(gradient)
    change = np.real(np.conj(value) * gradient) / size  # of the modulus
    rows = np.stack(
        [
            by_real,
            by_imag,
            change,
            -by_real / size + value.real * change / size**2,
        ]
    )
    # Parameters without effect on the pole may have no standard error.
    moves = np.any(rows != 0.0, axis=0)
    rows = rows[:, moves]
    variance = np.einsum("ri,ij,rj->r", rows, covariance[np.ix_(moves, moves)], rows)
    # A pole that depends on fixed parameters only is not known exactly: it was not estimated.
    return NamedPole(name, value, *map(float, np.sqrt(np.where(variance > 0.0, variance, np.nan))))


def _assign_names(
    left: Complex[np.ndarray, "n_x n_x"],
    right: Complex[np.ndarray, "n_x n_x"],
    upper: np.ndarray,
    dynamic: np.ndarray,
    mode_names: tuple[str, ...],
) -> list[str]:
    n = len(mode_names)
    participation = np.abs(left * right)[:, upper]
    participation = participation / participation.sum(axis=0)
    groups = [np.isin(dynamic, (0, 1, 2))]
    groups += [np.isin(dynamic, (3 + i, 3 + n + i)) for i in range(n)]
    share = np.stack([participation[group].sum(axis=0) for group in groups])
    rows, columns = linear_sum_assignment(-share)
    names = [""] * upper.size
    for row, column in zip(rows, columns, strict=True):
        names[column] = (SHORT_PERIOD, *mode_names)[row]
    for column, name in enumerate(names):
        if not name:
            names[column] = (SHORT_PERIOD, *mode_names)[int(np.argmax(share[:, column]))]
    return names


def _gradients(
    model: AeroelasticModel,
    parameters: Parameters,
    theta: Float[np.ndarray, " n_theta"],
    left: Complex[np.ndarray, "n_x n_p"],
    right: Complex[np.ndarray, "n_x n_p"],
    dynamic: np.ndarray,
) -> Complex[np.ndarray, "n_p n_theta"]:
    n = len(model.modes.numbers)
    scale = model.row_factors()[parameters.rows] * model.column_factors()[parameters.columns]
    place = {int(state): index for index, state in enumerate(dynamic)}
    force_states = np.r_[0, 1, 3 + n : 3 + 2 * n]
    variable_states = np.r_[0, 1, 3 : 3 + 2 * n]
    gradient = np.zeros((left.shape[1], parameters.start.size), dtype=complex)
    for index, (row, column) in enumerate(zip(parameters.rows, parameters.columns, strict=True)):
        if column < variable_states.size:
            force = place[int(force_states[row])]
            variable = place[int(variable_states[column])]
            gradient[:, index] = left[force].conj() * right[variable] * scale[index]
    _add_structural(gradient, model, parameters, theta, left, right, place)
    return gradient


def _add_structural(
    gradient: Complex[np.ndarray, "n_p n_theta"],
    model: AeroelasticModel,
    parameters: Parameters,
    theta: Float[np.ndarray, " n_theta"],
    left: Complex[np.ndarray, "n_x n_p"],
    right: Complex[np.ndarray, "n_x n_p"],
    place: dict[int, int],
) -> None:
    """Frequency and damping factors enter the structural rows."""
    n = len(model.modes.numbers)
    w, z = model.modes.omega, model.modes.zeta
    found = model.modes.tuned(dict(zip(parameters.names, theta.tolist(), strict=True)))
    for offset, extra in enumerate(parameters.extras):
        if extra.kind not in ("omega", "zeta"):
            continue
        i = extra.mode
        force = left[place[3 + n + i]].conj()
        eta, etadot = right[place[3 + i]], right[place[3 + n + i]]
        index = parameters.rows.size + offset
        if extra.kind == "omega":
            gradient[:, index] = (
                -2.0 * force * w[i] * (found.zeta[i] * etadot + found.omega[i] * eta)
            )
        else:
            gradient[:, index] = -2.0 * force * z[i] * found.omega[i] * etadot


def compute_separation_factor(A: Float[np.ndarray, "n_x n_x"], n_modes: int) -> float | None:
    """Compute the lowest structural over the highest rigid-body frequency of a model.

    Parameters
    ----------
    A
        State matrix in [alpha, q, theta, eta..., etadot...].
    n_modes
        Number of structural modes.

    Returns
    -------
    float or None
        None without structural modes, or where no pole is of rigid or of structural motion.

    Notes
    -----
    A pole is structural when modal states take the larger part in it. References 22 and 23
    of the paper treat the motions as decoupled from a factor of five on.
    """
    if n_modes == 0:
        return None
    dynamic = np.r_[0, 1, 3 : A.shape[0]]
    values, right = np.linalg.eig(A[np.ix_(dynamic, dynamic)].astype(complex))
    part = np.abs(np.linalg.inv(right).T * right)
    rigid = part[:2].sum(axis=0) > 0.5 * part.sum(axis=0)
    size = np.abs(values)
    if not rigid.any() or rigid.all():
        return None
    return float(size[~rigid].min() / size[rigid].max())
