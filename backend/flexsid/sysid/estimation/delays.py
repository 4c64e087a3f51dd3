"""Starting values for sensor delays that are too large to be found jointly at once.

Relative delays follow from the redundancy of the sensors alone: whatever the motion
is, all sensors must see the same one. The delay common to all is then scanned with
the residual of equation error, which needs no iteration.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from jaxtyping import Complex, Float

from flexsid.sysid.estimation.equation_error import aerodynamic_coefficients, regressors
from flexsid.sysid.estimation.reconstruction import reconstruct_motion
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.signals import FrequencyData

_ITERATIONS = 40
_LARGEST_STEP_RAD = 0.3  # at the highest line: beyond that a delay may slip by a whole turn
_COMMON_S = np.arange(-0.02, 0.0801, 0.002)
_ENOUGH_LINES = 100


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

    Notes
    -----
    Departure: the paper converges the derivatives first and restarts with delays;
    that fails where delays reach a large part of a period of the highest mode. A
    delay common to all sensors turns the reconstructed motion and nothing else, so
    that the scan costs one small regression for each delay tried. Some hundred lines
    are enough for a start.
    """
    some = slice(None, None, max(1, outputs.omega.size // _ENOUGH_LINES))
    omega = outputs.omega[some]
    z = FrequencyData(omega, outputs.pick(model.outputs).values[some], model.outputs)
    u = FrequencyData(omega, inputs.values[some], inputs.names)
    relative = relative_delays(model, z, instruments[some])
    shifted = instruments[some] * np.exp(-1j * np.outer(omega, relative))
    motion = reconstruct_motion(model, z, shifted, noise=_level(z))
    costs = []
    for common in _COMMON_S:
        turned = replace(motion, values=motion.values * np.exp(1j * omega * common)[:, None])
        X = regressors(model, turned, u)
        C = aerodynamic_coefficients(model, turned)
        X, C = X / np.linalg.norm(X, axis=0), C / np.linalg.norm(C, axis=0)
        stacked = np.concatenate([np.real(X), np.imag(X)])
        target = np.concatenate([np.real(C), np.imag(C)])
        q, _ = np.linalg.qr(stacked)
        left = 1.0 - np.sum((q.T @ target) ** 2, axis=0)
        costs.append(float(np.sum(np.log(np.maximum(left, 1e-12)))))
    return relative + _parabola_minimum(_COMMON_S, np.array(costs))


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
    keep = np.eye(z.shape[1]) - np.matmul(q, q.conj().transpose(0, 2, 1))
    normal = np.einsum("ka,kab,kb->ab", slope.conj(), keep, slope).real
    gradient = np.sum((slope.conj() * residual).real, axis=0)
    return float(np.sum(np.abs(residual) ** 2)), normal, gradient


def _parabola_minimum(x: Float[np.ndarray, " n"], y: Float[np.ndarray, " n"]) -> float:
    k = int(np.clip(np.argmin(y), 1, x.size - 2))
    left, middle, right = y[k - 1], y[k], y[k + 1]
    bend = left - 2.0 * middle + right
    offset = 0.5 * (left - right) / bend if bend > 0 else 0.0
    return float(x[k] + np.clip(offset, -1.0, 1.0) * (x[1] - x[0]))
