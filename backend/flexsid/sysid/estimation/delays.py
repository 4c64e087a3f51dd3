"""Starting values for sensor delays that are too large to be found jointly at once.

Relative delays follow from the redundancy of the sensors alone: whatever the motion
is, all sensors must see the same one. The delay common to all is then scanned with
the residual of equation error, which needs no iteration.
"""

from __future__ import annotations

import numpy as np
from jaxtyping import Complex, Float

from flexsid.errors import NotIdentifiable
from flexsid.sysid.estimation.equation_error import aerodynamic_coefficients, regressors
from flexsid.sysid.estimation.limits import LONGEST_DELAY_S
from flexsid.sysid.estimation.reconstruction import ReconstructedMotion, reconstruct_motion
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.signals import FrequencyData, check_signal

_ITERATIONS = 40
_LARGEST_STEP_RAD = 0.3  # at the highest line: beyond that a delay may slip by a whole turn
_STEP_S = 0.002
_USUAL_S = (-0.02, 0.08)  # where a delay common to all sensors is scanned for first
_ENOUGH_LINES = 100
_RIDGE = 1e-12  # of a regressor's power: keeps collinear regressors solvable


def find_delays(
    model: AeroelasticModel,
    inputs: FrequencyData,
    outputs: FrequencyData,
    instruments: Complex[np.ndarray, "n_omega n_y"],
) -> Float[np.ndarray, " n_y"]:
    """Delay of every output beyond its instrument's. [s]

    Parameters
    ----------
    model, inputs, outputs, instruments
        As for equation error.

    Raises
    ------
    BadInput
        If a channel carries no signal, or a spectrum is not finite.
    NotIdentifiable
        If the sensors cannot tell the motions apart, or no common delay within the limits
        fits best.

    Notes
    -----
    Departure: the paper converges the derivatives first and restarts with delays;
    that fails where delays reach a large part of a period of the highest mode. A
    delay common to all sensors turns the reconstructed motion and nothing else, so
    that the scan costs one small regression for each delay tried. Some hundred lines
    are enough for a start. Where the best is at an end of the scan, all that a recorder
    can have is scanned.
    """
    some = slice(None, None, max(1, outputs.omega.size // _ENOUGH_LINES))
    omega = outputs.omega[some]
    check_signal(outputs.pick(model.outputs).values, model.outputs)
    check_signal(inputs.pick(model.inputs).values, model.inputs)
    z = FrequencyData(omega, outputs.pick(model.outputs).values[some], model.outputs)
    u = FrequencyData(omega, inputs.values[some], inputs.names)
    relative = relative_delays(model, z, instruments[some])
    shifted = instruments[some] * np.exp(-1j * np.outer(omega, relative))
    motion = reconstruct_motion(model, z, shifted, noise=_level(z))
    for low, high in (_USUAL_S, (-LONGEST_DELAY_S, LONGEST_DELAY_S)):
        common = np.arange(low, high + 0.5 * _STEP_S, _STEP_S)
        costs = _unexplained(model, motion, u, common)
        if 0 < np.argmin(costs) < common.size - 1:
            return relative + _parabola_minimum(common, costs)
    raise NotIdentifiable(
        f"no delay common to all sensors within ±{LONGEST_DELAY_S:g} s fits best; look at the "
        "timing of the inputs, or hold the delays"
    )


def _unexplained(
    model: AeroelasticModel,
    motion: ReconstructedMotion,
    inputs: FrequencyData,
    common: Float[np.ndarray, " n_delays"],
) -> Float[np.ndarray, " n_delays"]:
    """Log of what the regressions leave of all coefficients, for every common delay.

    A delay turns motion and coefficients alike, so that among their products only those
    with the inputs change: every delay costs one row of a matrix product and small solves.
    """
    n_u = len(model.inputs)
    X, C = regressors(model, motion, inputs), aerodynamic_coefficients(model, motion)
    both = np.concatenate([X[:, :-n_u], C, X[:, -n_u:]], axis=1)
    both = both / np.linalg.norm(both, axis=0)
    n_turned = both.shape[1] - n_u
    turned, still = both[:, :n_turned], both[:, n_turned:]
    products = np.tile(np.real(both.conj().T @ both), (common.size, 1, 1))
    turns = np.exp(-1j * np.outer(common, motion.omega))
    mixed = (turned.conj()[:, :, None] * still[:, None, :]).reshape(len(turned), -1)
    cross = np.real(turns @ mixed).reshape(-1, n_turned, n_u)
    products[:, :n_turned, n_turned:] = cross
    products[:, n_turned:, :n_turned] = cross.transpose(0, 2, 1)
    given = np.r_[: X.shape[1] - n_u, n_turned : both.shape[1]]
    sought = np.arange(X.shape[1] - n_u, n_turned)
    normal = products[:, given[:, None], given] + _RIDGE * np.eye(given.size)
    right = products[:, given[:, None], sought]
    explained = np.sum(right * np.linalg.solve(normal, right), axis=1)
    return np.sum(np.log(np.maximum(1.0 - explained, 1e-12)), axis=1)


def relative_delays(
    model: AeroelasticModel,
    outputs: FrequencyData,
    instruments: Complex[np.ndarray, "n_omega n_y"],
) -> Float[np.ndarray, " n_y"]:
    """Delays of the outputs against each other, of zero mean, by variable projection. [s]"""
    z = outputs.values / _level(outputs)
    omega = outputs.omega
    rows = instruments[:, :, None] * model.sensors.response(omega) / _level(outputs)[:, None]
    rows = rows / np.linalg.norm(rows, axis=1)[:, None, :]
    tau = np.zeros(z.shape[1])
    damping = 1e-3
    cost, normal, gradient = _projected(rows, z, omega, tau)
    for _ in range(_ITERATIONS):
        diagonal = np.diag(normal) + 1e-12 * np.trace(normal)
        step = np.linalg.solve(normal + damping * np.diag(diagonal), -gradient)
        step -= step.mean()
        step *= min(1.0, _LARGEST_STEP_RAD / (omega[-1] * max(np.max(np.abs(step)), 1e-12)))
        trial = _projected(rows, z, omega, tau + step)
        if trial[0] < cost:
            tau = tau + step
            cost, normal, gradient = trial
            damping = max(damping / 10.0, 1e-9)
            if np.max(np.abs(step)) < 1e-6:
                break
        else:
            damping *= 10.0
            if damping > 1e6:
                break
    return tau - tau.mean()


def _level(outputs: FrequencyData) -> Float[np.ndarray, " n_y"]:
    return np.sqrt(np.mean(np.abs(outputs.values) ** 2, axis=0))


def _projected(
    rows: Complex[np.ndarray, "n_omega n_y n_r"],
    z: Complex[np.ndarray, "n_omega n_y"],
    omega: Float[np.ndarray, " n_omega"],
    tau: Float[np.ndarray, " n_y"],
) -> tuple[float, Float[np.ndarray, "n_y n_y"], Float[np.ndarray, " n_y"]]:
    """What no motion explains, with Kaufman's normal matrix and gradient in tau."""
    shifted = rows * np.exp(-1j * omega[:, None] * tau)[:, :, None]
    q, _ = np.linalg.qr(shifted)
    seen = np.matmul(q, np.matmul(q.conj().transpose(0, 2, 1), z[:, :, None]))[:, :, 0]
    residual = z - seen
    slope = 1j * omega[:, None] * seen
    along = (q.conj() * slope[:, :, None]).transpose(0, 2, 1).reshape(-1, z.shape[1])
    normal = np.diag(np.sum(np.abs(slope) ** 2, axis=0)) - np.real(along.T @ along.conj())
    gradient = np.sum((slope.conj() * residual).real, axis=0)
    return float(np.sum(np.abs(residual) ** 2)), normal, gradient


def _parabola_minimum(x: Float[np.ndarray, " n"], y: Float[np.ndarray, " n"]) -> float:
    k = int(np.clip(np.argmin(y), 1, x.size - 2))
    left, middle, right = y[k - 1], y[k], y[k + 1]
    bend = left - 2.0 * middle + right
    offset = 0.5 * (left - right) / bend if bend > 0 else 0.0
    return float(x[k] + np.clip(offset, -1.0, 1.0) * (x[1] - x[0]))
