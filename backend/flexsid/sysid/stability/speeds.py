"""One aircraft at many airspeeds: trim, state matrices, and their slopes in the derivatives."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float

from flexsid.errors import BadInput, NotIdentifiable
from flexsid.sysid.model.condition import GRAVITY, FlightCondition
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.modes.shapes import StructuralModes


@dataclass(frozen=True, slots=True)
class Aeroelastic:
    """Derivatives, structure and loading of an aircraft at any speed.

    ``condition`` is one trimmed condition; others follow from it by constant weight.
    """

    condition: FlightCondition
    modes: StructuralModes
    derivatives: DerivativeTable

    @property
    def motions(self) -> tuple[str, ...]:
        """Motions: the short period and each mode by number."""
        return ("SP", *(str(number) for number in self.modes.numbers))


@dataclass(frozen=True, slots=True)
class StateFamily:
    """State matrices at many speeds, and where each derivative enters them.

    The states are alpha, q, eta..., etadot...: attitude only integrates q in level flight.
    """

    A: Float[np.ndarray, "n_v n_x n_x"]
    scale: Float[np.ndarray, "n_v n_rows n_columns"]
    force_states: np.ndarray
    variable_states: np.ndarray


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
    airspeed
        True airspeeds. [m/s]
    density
        Of the air; that of the known condition by default. [kg/m3]

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
    rows = np.empty((V.size, 2 + n))
    rows[:, 0] = force / (c.mass * V)
    rows[:, 1] = force * c.chord / c.pitch_inertia
    rows[:, 2:] = (force * c.chord)[:, None] / modes.mass
    columns = np.ones((V.size, 2 + 2 * n))
    columns[:, [1, *range(2 + n, 2 + 2 * n)]] = (c.chord / (2.0 * V))[:, None]
    scale = rows[:, :, None] * columns[:, None, :]
    force_states = np.r_[0, 1, 2 + n : 2 + 2 * n]
    A = np.zeros((V.size, 2 + 2 * n, 2 + 2 * n))
    A[:, force_states] = scale * aircraft.derivatives.values[:, : 2 + 2 * n]
    A[:, 0, 0] += GRAVITY * np.sin(c.gamma) / V - thrust * np.cos(alpha) / (c.mass * V)
    A[:, 0, 1] += 1.0
    eta, etadot = np.arange(2, 2 + n), np.arange(2 + n, 2 + 2 * n)
    A[:, eta, etadot] = 1.0
    A[:, etadot, eta] -= modes.omega**2
    A[:, etadot, etadot] -= 2.0 * modes.zeta * modes.omega
    return StateFamily(A, scale, force_states, np.arange(2 + 2 * n))


@dataclass(frozen=True, slots=True)
class Modal:
    """Eigenvalues with left and right vectors, scaled so that left^H right = 1."""

    values: Complex[np.ndarray, "n_v n_x"]
    left: Complex[np.ndarray, "n_v n_x n_x"]
    right: Complex[np.ndarray, "n_v n_x n_x"]


def decompose_states(family: StateFamily) -> Modal:
    """Compute eigenvalues and vectors at every speed."""
    values, right = (part.astype(complex) for part in np.linalg.eig(family.A))
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
    family, modal
        State matrices, their eigenvalues and vectors.
    rows, columns
        Of the derivatives.
    left_of, right_of
        Eigenvalues at every speed (n_v, n_roots) whose left and right vectors to take; all
        by default. For two different ones it is their coupling.

    Notes
    -----
    d lambda = w^H dA v for vectors with w^H v = 1. Derivatives of the inputs change nothing.
    """
    n_x = family.A.shape[1]
    acts = columns < n_x
    at = np.where(acts, columns, 0)
    pull = _vectors(modal.left, left_of, family.force_states[rows]).conj()
    moved = _vectors(modal.right, right_of, family.variable_states[at])
    weight = np.where(acts, family.scale[:, rows, at], 0.0)
    return pull * moved * weight[:, None, :]


def _vectors(
    vectors: Complex[np.ndarray, "n_v n_x n_x"], roots: np.ndarray | None, states: np.ndarray
) -> Complex[np.ndarray, "n_v n_roots n_theta"]:
    """Entries of eigenvectors, one of every parameter."""
    beside = vectors if roots is None else np.take_along_axis(vectors, roots[:, None, :], axis=2)
    return beside.transpose(0, 2, 1)[:, :, states]
