"""End states: the motion at the ends of a record, as unknowns of a fit.

The transform of a record from t_0 to t_1 obeys
s X = A X + B U + x(t_0) e^{-s t_0} - x(t_1) e^{-s t_1}. With the states at its ends as parameters
the model is exact for any part of a maneuver, and the standard errors of the other parameters
include their uncertainty. ``leakage`` subtracts the same terms after a fit, for whole maneuvers
that end almost at rest.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Complex, Float, Int

from flexsid.errors import BadInput
from flexsid.sysid.estimation.experiment import SHAPE_ERRORS, Experiment, Extra, Parameters
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.model.rigid_body import ACCELERATION, RATE

STATE = "state"
"""Kind of these parameters: ``output`` is the number of the end, ``mode`` that of the state."""

_BESIDE = ("delay", "scale", *SHAPE_ERRORS)  # kinds of parameters that change outputs only
_QUASI_STATIC = 1.2  # of the highest frequency: modes above follow the forces without free motion


@dataclass(frozen=True, slots=True)
class FreeMotion:
    """Free motion from end states, as the response to forces at each end.

    A rigid-body motion or etadot begins as after an impulse. An attitude or eta acts on the rates
    of these states alone: from X (s - A) = 1 its column of X = (s - A)^-1 is
    (e_k + X A[:, k]) / s. Rates have the transform s x less the initial value, which outputs of
    accelerations therefore lack.

    Attributes
    ----------
    s
        Complex frequencies. [rad/s]
    unit_motion, unit_outputs
        Motion and recorded outputs under a unit force in each row.
    instruments
        Recorded over true response of every output. [1]
    impulse
        Forces of a unit of each state with inertia.
    coupling, direct
        Rates of these states, and outputs, per unit of an attitude or eta.
    initial
        Outputs per unit of the rate of a state with inertia.
    phase
        Of the time of each end state.
    place
        State of each end state: those with inertia, the attitude, eta.
    """

    s: Complex[np.ndarray, " n_omega"]
    unit_motion: Complex[np.ndarray, "n_omega n_r n_r"]
    unit_outputs: Complex[np.ndarray, "n_omega n_y n_r"]
    instruments: Complex[np.ndarray, "n_omega n_y"]
    impulse: Float[np.ndarray, "n_r n_r"]
    coupling: Float[np.ndarray, "n_r n_integrated"]
    direct: Float[np.ndarray, "n_y n_integrated"]
    initial: Float[np.ndarray, "n_y n_r"]
    phase: Complex[np.ndarray, "n_omega n_ends"]
    place: Int[np.ndarray, " n_ends"]

    def sum(
        self, values: Float[np.ndarray, " n_ends"]
    ) -> tuple[
        Complex[np.ndarray, "n_omega n_y"],
        Complex[np.ndarray, "n_omega n_x"],
        Complex[np.ndarray, "n_omega n_modes"],
    ]:
        """Compute outputs, variables of the forces and modal accelerations for the end states."""
        n_r, n = len(self.impulse), self.direct.shape[1] - 1
        of_state = np.zeros((values.size, n_r + 1 + n))
        of_state[np.arange(values.size), self.place] = values
        first, later = np.split(self.phase @ of_state, [n_r], axis=1)
        later = later / self.s[:, None]
        begun = first + later @ self.coupling.T
        forces = (begun @ self.impulse.T)[:, :, None]
        motion = (self.unit_motion @ forces)[:, :, 0]
        rates = self.s[:, None] * motion[:, n_r - n :]
        motion[:, n_r - n :] += later[:, 1:]
        outputs = (self.unit_outputs @ forces)[:, :, 0]
        outputs += self.instruments * (later @ self.direct.T - begun @ self.initial.T)
        accelerations = self.s[:, None] * rates - first[:, n_r - n :]
        return outputs, np.concatenate([motion, rates], axis=1), accelerations

    def expand_outputs(self) -> Complex[np.ndarray, "n_omega n_y n_ends"]:
        """Compute the outputs per unit of each end state."""
        n_omega, n_y, n_r = self.unit_outputs.shape
        flat = self.unit_outputs.reshape(-1, n_r)
        to_states = self.impulse @ np.hstack([np.eye(n_r), self.coupling])
        of_states = (flat @ to_states).reshape(n_omega, n_y, -1)
        constant = np.hstack([-self.initial, self.direct - self.initial @ self.coupling])
        of_states += self.instruments[:, :, None] * constant
        slow = np.where(self.place < n_r, 1.0, 1.0 / self.s[:, None])
        outputs = np.take(of_states, self.place, axis=2)
        outputs *= (self.phase * slow)[:, None, :]
        return outputs


def add_end_states(parameters: Parameters, experiments: Sequence[Experiment]) -> Parameters:
    """Add the states at the ends of records to the parameters of their fit.

    Parameters
    ----------
    parameters
        Derivatives of the model; delays and scale factors of outputs.
    experiments
        Records with the times at which they begin or end in motion, numbered by ``number_ends``.

    Raises
    ------
    BadInput
        If another parameter is free, or the derivatives have a frequency shape.
    """
    if not has_end_states(parameters, experiments):
        raise BadInput(
            "a record that begins or ends in motion is fitted with quasi-steady derivatives only; "
            "structural parameters need a whole maneuver",
            code="not-in-method",
        )
    found: list[tuple[str, int, int]] = []
    for one in experiments:
        names = one.model.state_space(parameters.base).states
        states = list_end_states(one.model, float(one.omega.max()))
        ends = range(one.first_end, one.first_end + len(one.edges_s))
        found += [(f"{names[k]}_at_end_{end}", end, k) for end in ends for k in states]
    return replace(
        parameters,
        names=(*parameters.names, *(name for name, _, _ in found)),
        start=np.concatenate([parameters.start, np.zeros(len(found))]),
        extras=(*parameters.extras, *(Extra(STATE, end, k) for _, end, k in found)),
    )


def list_end_state_names(parameters: Parameters) -> tuple[str, ...]:
    """List the names of the states at the ends of records among the parameters."""
    extras = zip(parameters.names[parameters.rows.size :], parameters.extras, strict=True)
    return tuple(name for name, extra in extras if extra.kind == STATE)


def drop_end_states(parameters: Parameters) -> Parameters:
    """Return the parameters without states at the ends of records."""
    extras = tuple(extra for extra in parameters.extras if extra.kind != STATE)
    count = parameters.rows.size + len(extras)
    names, start = parameters.names[:count], parameters.start[:count]
    return replace(parameters, names=names, start=start, extras=extras)


def has_end_states(parameters: Parameters, experiments: Sequence[Experiment]) -> bool:
    """Whether the states at the ends of records can be parameters beside the free ones."""
    quasi_steady = all(one.model.shape is None for one in experiments)
    return quasi_steady and all(extra.kind in _BESIDE for extra in parameters.extras)


def number_ends(experiments: Sequence[Experiment]) -> list[Experiment]:
    """Number the ends of the records of a joint fit."""
    firsts = np.cumsum([0, *(len(one.edges_s) for one in experiments)]).tolist()
    pairs = zip(experiments, firsts, strict=False)
    return [replace(one, first_end=first) for one, first in pairs]


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
    edges_s: Mapping[int, float],
    extras: Sequence[Extra],
    unit_motion: Complex[np.ndarray, "n_omega n_r n_r"],
    unit_outputs: Complex[np.ndarray, "n_omega n_y n_r"],
    instruments: Complex[np.ndarray, "n_omega n_y"],
) -> FreeMotion:
    """Compute the spectra of the free motion from a unit of each end state.

    Parameters
    ----------
    model, derivatives
        The aircraft.
    omega
        Frequencies. [rad/s]
    edges_s
        Times of the ends of the record by number. [s]
    extras
        End states, of ``add_end_states``; those of other records have no effect.
    unit_motion, unit_outputs
        Motion and recorded outputs under a unit force in each row.
    instruments
        Recorded over true response of every output. [1]
    """
    system = model.state_space(derivatives)
    first, n_r, n_x = model.n_rigid, len(model.motions), system.A.shape[0]
    inert, integrated = np.r_[:first, n_x - n_r + first : n_x], np.r_[first : n_x - n_r + first]
    P = model.sensors.polynomial
    impulse = np.eye(n_r)
    impulse[:first, :first] = np.linalg.inv(model.force_matrix()[:first, :first])
    at = np.array([edges_s.get(extra.output, 0.0) for extra in extras])
    own = np.array([float(extra.output in edges_s) for extra in extras])
    place = np.argsort(np.concatenate([inert, integrated]))
    return FreeMotion(
        s=1j * omega,
        unit_motion=unit_motion,
        unit_outputs=unit_outputs,
        instruments=instruments,
        impulse=impulse,
        coupling=system.A[np.ix_(inert, integrated)],
        direct=system.C[:, integrated],
        initial=np.concatenate([P[RATE, :, :first], P[ACCELERATION, :, first:]], axis=1),
        phase=own * np.exp(-1j * np.outer(omega, at)),
        place=place[[extra.mode for extra in extras]],
    )
