"""End states: the motion at the ends of a record, as unknowns of a fit.

The transform of a record from t_0 to t_1 obeys
s X = A X + B U + x(t_0) e^{-s t_0} - x(t_1) e^{-s t_1}. With the states at its ends as parameters
the model is exact for any part of a maneuver, and the standard errors of the other parameters
include their uncertainty. ``leakage`` subtracts the same terms after a fit, for whole maneuvers
that end almost at rest.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Complex, Float

from flexsid.errors import BadInput
from flexsid.sysid.estimation.experiment import Experiment
from flexsid.sysid.estimation.parameters import Extra, Parameters
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.derivatives import DerivativeTable

STATE = "state"
"""Kind of these parameters: ``output`` is the number of the end, ``mode`` that of the state."""

_QUASI_STATIC = 1.2  # of the highest frequency: modes above follow the forces without free motion


@dataclass(frozen=True, slots=True)
class FreeMotion:
    """Free motion from a unit of each state at each end: outputs, and variables of the forces."""

    outputs: Complex[np.ndarray, "n_omega n_y n_states"]
    variables: Complex[np.ndarray, "n_omega n_x n_states"]


def add_end_states(parameters: Parameters, experiment: Experiment) -> Parameters:
    """Add the states at the ends of a record to the parameters of its fit.

    Parameters
    ----------
    parameters
        Derivatives of the model.
    experiment
        Record with the times at which it begins or ends in motion.

    Raises
    ------
    BadInput
        If a parameter is no derivative, or the derivatives have a frequency shape.
    """
    model = experiment.model
    if parameters.extras or model.shape is not None:
        raise BadInput(
            "a record that begins or ends in motion is fitted with quasi-steady derivatives only; "
            "delays, scale factors and structural parameters need a whole maneuver",
            code="not-in-method",
        )
    states = list_end_states(model, float(experiment.omega.max()))
    names = model.state_space(parameters.base).states
    ends = range(len(experiment.edges_s))
    found = [(f"{names[k]}_at_end_{end}", end, k) for end in ends for k in states]
    return replace(
        parameters,
        names=(*parameters.names, *(name for name, _, _ in found)),
        start=np.concatenate([parameters.start, np.zeros(len(found))]),
        extras=tuple(Extra(STATE, end, k) for _, end, k in found),
    )


def list_end_states(model: AeroelasticModel, max_omega: float) -> list[int]:
    """List the states of ``state_space`` at an end that the outputs depend on.

    Excluded are an attitude that neither acts nor is measured, and the modes far above the
    highest frequency [rad/s]: their free motion is a constant there, which no data separate.
    """
    n, first = len(model.modes.numbers), model.n_rigid
    system = model.state_space(model.fill_table({}))
    measured = model.body.acts_by_gravity or bool(np.any(system.C[:, first]))
    rigid = [k for k in range(first + 1) if k != first or measured]
    slow = np.flatnonzero(model.modes.omega < _QUASI_STATIC * max_omega) + first + 1
    return [*rigid, *slow.tolist(), *(slow + n).tolist()]


def compute_free_motion(
    model: AeroelasticModel,
    derivatives: DerivativeTable,
    omega: Float[np.ndarray, " n_omega"],
    edges_s: Sequence[float],
    extras: Sequence[Extra],
) -> FreeMotion:
    """Compute the spectra of the free motion from a unit of each end state.

    Parameters
    ----------
    model, derivatives
        The aircraft.
    omega
        Frequencies. [rad/s]
    edges_s
        Times of the ends. [s]
    extras
        End states, of ``add_end_states``.
    """
    system = model.state_space(derivatives)
    n = system.A.shape[0]
    s = 1j * omega
    # All ends share the response of a state; they differ in their time only.
    picked, place = np.unique([extra.mode for extra in extras], return_inverse=True)
    unit = np.broadcast_to(np.eye(n, dtype=complex)[:, picked], (s.size, n, picked.size))
    states = np.linalg.solve(s[:, None, None] * np.eye(n) - system.A, unit)
    at = np.array([edges_s[extra.output] for extra in extras])
    phase = np.exp(-np.outer(s, at))[:, None, :]
    outputs, variables = system.C @ states, states[:, model.variable_states()]
    return FreeMotion(outputs[:, :, place] * phase, variables[:, :, place] * phase)


def remove_free_motion(experiment: Experiment, parameters: Parameters) -> Experiment:
    """Subtract the free motion from the end states: the response to the inputs alone remains.

    Parameters
    ----------
    experiment
        Record that begins or ends in motion.
    parameters
        Derivatives and end states; their starting values are used.
    """
    n = parameters.rows.size
    free = compute_free_motion(
        experiment.model,
        parameters.table(parameters.start),
        experiment.omega,
        experiment.edges_s,
        parameters.extras,
    )
    moved = experiment.instruments * (free.outputs @ parameters.start[n:])
    return replace(experiment, measured=experiment.measured - moved, edges_s=())
