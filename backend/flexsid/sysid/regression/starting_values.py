"""Starting values: regression of parts of maneuvers, and delays too large for a joint estimate.

The transform of a rate over a part is s X + x(t_1) e^{-s t_1} - x(t_0) e^{-s t_0}, and at multiples
of 1/T of the part one real number for each motion stands for both ends. These numbers are
estimated from the redundancy of the sensors and by a column of their own in each regression.

Relative delays are estimated from the redundancy of the sensors alone, which measure the
same motion. The delay common to all is then scanned with the residual of equation error,
which needs no iteration.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from jaxtyping import Complex, Float

from flexsid.errors import NotIdentifiable
from flexsid.sysid.estimation.experiment import LONGEST_DELAY_S, Experiment, Parameters
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.model.rigid_body import ACCELERATION, INTEGRAL, RATE
from flexsid.sysid.regression.equation_error import (
    build_regressors,
    compute_aerodynamic_coefficients,
)
from flexsid.sysid.regression.reconstruction import (
    ReconstructedMotion,
    complete_noise_guess,
    reconstruct_motion,
)
from flexsid.sysid.signals import FrequencyData, check_signal

# --- Regression of parts of maneuvers: starting values from records that begin or end in motion


def regress_parts(
    experiments: Sequence[Experiment], parameters: Parameters
) -> Float[np.ndarray, " n_theta"]:
    """Estimate derivatives by one linear regression per coefficient, joint for all records.

    Parameters
    ----------
    experiments
        Output error of quasi-steady models, of windows of the motion at multiples of their 1/T.
    parameters
        Derivatives, fixed ones with their values.

    Returns
    -------
    array
        Values without standard errors: the noise of the motion is not compensated.

    Raises
    ------
    NotIdentifiable
        If the motion is not observable with the sensors, or a derivative has too few data.
    """
    values = parameters.start.copy()
    prepared = [_prepare(one) for one in experiments]
    held = parameters.base.values.copy()
    held[parameters.rows, parameters.columns] = 0.0
    for row in np.unique(parameters.rows).tolist():
        own = np.flatnonzero(parameters.rows == row)
        left, right = [], []
        for number, (one, (X, z)) in enumerate(zip(experiments, prepared, strict=True)):
            ends = _build_force_columns(one, row)
            columns = np.zeros((*ends.shape[:1], ends.shape[1] * len(experiments)), dtype=complex)
            columns[:, ends.shape[1] * number : ends.shape[1] * (number + 1)] = ends
            left.append(np.concatenate([X[:, parameters.columns[own]], columns], axis=1))
            right.append(z[:, row] - X @ held[row])
        A, b = np.concatenate(left), np.concatenate(right)
        A, b = (np.concatenate([np.real(part), np.imag(part)]) for part in (A, b))
        size = np.linalg.norm(A, axis=0)
        if not size.all() or A.shape[0] <= A.shape[1]:
            raise NotIdentifiable(
                f"the derivatives of {parameters.names[own[0]].split('_')[0]} have too few data in "
                "this record; hold some of them fixed"
            )
        values[own] = (np.linalg.lstsq(A / size, b, rcond=None)[0] / size)[: own.size]
    return values


def _prepare(
    experiment: Experiment,
) -> tuple[Complex[np.ndarray, "n_omega n_w"], Complex[np.ndarray, "n_omega n_rows"]]:
    """Compute regressors and coefficients from the motion without the ends of the sensors."""
    model, omega = experiment.model, experiment.omega
    inputs = FrequencyData(omega, experiment.inputs, model.inputs)
    z = experiment.measured
    sigma = complete_noise_guess(z, None, experiment.inputs)
    P = experiment.instruments[:, :, None] * model.sensors.response(omega)
    L = experiment.instruments[:, :, None] * _build_sensor_columns(experiment)
    seen = np.any(L != 0.0, axis=(0, 1))
    if seen.any() and P.shape[1] > P.shape[2]:
        q, _ = np.linalg.qr(P / sigma[:, None])
        columns = np.concatenate([L[:, :, seen], z[:, :, None]], axis=2) / sigma[:, None]
        columns = columns - q @ (q.conj().transpose(0, 2, 1) @ columns)
        flat = columns.reshape(-1, columns.shape[2])
        flat = np.concatenate([flat.real, flat.imag])
        ends = np.linalg.lstsq(flat[:, :-1], flat[:, -1], rcond=None)[0]
        z = z - L[:, :, seen] @ ends
    motion = reconstruct_motion(
        model, FrequencyData(omega, z, model.outputs), experiment.instruments, sigma
    )
    return build_regressors(model, motion, inputs), compute_aerodynamic_coefficients(model, motion)


def _build_sensor_columns(experiment: Experiment) -> Complex[np.ndarray, "n_omega n_y n_ends"]:
    """Build the outputs per unit of the end of each motion, of its rate and of its integral."""
    P = experiment.model.sensors.polynomial
    s = 1j * experiment.omega[:, None, None]
    motions = P[RATE] + s * P[ACCELERATION]
    rates, integrals = np.broadcast_to(P[ACCELERATION], motions.shape), P[INTEGRAL] / s
    return np.concatenate([motions, rates, integrals], axis=2) * _compute_phase(experiment)


def _build_force_columns(
    experiment: Experiment, row: int
) -> Complex[np.ndarray, "n_omega n_columns"]:
    """Build the columns of the ends in the equation of a force, a moment or a mode."""
    model: AeroelasticModel = experiment.model
    phase = _compute_phase(experiment)[:, :, 0]
    if row < model.n_rigid:
        return phase
    return np.concatenate([phase, 1j * experiment.omega[:, None] * phase], axis=1)


def _compute_phase(experiment: Experiment) -> Complex[np.ndarray, "n_omega 1 1"]:
    (end_s,) = experiment.edges_s
    return np.exp(-1j * experiment.omega * end_s)[:, None, None]


# --- Starting values of sensor delays that are too large for a joint estimate ---------------------

_ITERATIONS = 40
_LARGEST_STEP_RAD = 0.3  # at the highest frequency: larger steps may slip by a whole turn
_STEP_S = 0.002  # of the scan
_USUAL_S = (-0.02, 0.08)  # first scan of the delay common to all sensors
_ENOUGH_FREQUENCIES = 100  # for a starting value
_RIDGE = 1e-12  # of a regressor's power: collinear regressors stay solvable


def estimate_delays(
    model: AeroelasticModel,
    inputs: FrequencyData,
    outputs: FrequencyData,
    instruments: Complex[np.ndarray, "n_omega n_y"],
) -> Float[np.ndarray, " n_y"]:
    """Estimate the delay of every output in addition to its instrument's. [s]

    Parameters
    ----------
    model, inputs, outputs, instruments
        As for equation error.

    Raises
    ------
    BadInput
        If a channel has no signal, or a spectrum is not finite.
    NotIdentifiable
        If the motions are not observable with the sensors, or the residual has no minimum
        at a common delay within the limits.

    Notes
    -----
    Departure: the paper converges the derivatives first and restarts with delays;
    that fails for delays of a large part of a period of the highest mode. A delay
    common to all sensors only rotates the phase of the reconstructed motion, so that
    the scan costs one small regression per delay. About a hundred frequencies are
    enough for a start. If the minimum is at an end of the scan, the range is extended
    to the limits of a recorder.
    """
    some = slice(None, None, max(1, outputs.omega.size // _ENOUGH_FREQUENCIES))
    omega = outputs.omega[some]
    check_signal(outputs.pick(model.outputs).values, model.outputs)
    check_signal(inputs.pick(model.inputs).values, model.inputs)
    z = FrequencyData(omega, outputs.pick(model.outputs).values[some], model.outputs)
    u = FrequencyData(omega, inputs.values[some], inputs.names)
    relative = estimate_relative_delays(model, z, instruments[some])
    shifted = instruments[some] * np.exp(-1j * np.outer(omega, relative))
    motion = reconstruct_motion(model, z, shifted, noise=_compute_level(z))
    for low, high in (_USUAL_S, (-LONGEST_DELAY_S, LONGEST_DELAY_S)):
        common = np.arange(low, high + 0.5 * _STEP_S, _STEP_S)
        costs = _scan_residual(model, motion, u, common)
        if 0 < np.argmin(costs) < common.size - 1:
            return relative + _interpolate_minimum(common, costs)
    raise NotIdentifiable(
        f"the residual has no minimum for a common delay within ±{LONGEST_DELAY_S:g} s; check "
        "the timing of the inputs, or hold the delays"
    )


def _scan_residual(
    model: AeroelasticModel,
    motion: ReconstructedMotion,
    inputs: FrequencyData,
    common: Float[np.ndarray, " n_delays"],
) -> Float[np.ndarray, " n_delays"]:
    """Compute the log of the unexplained power of all coefficients for every common delay.

    A delay rotates motion and coefficients equally, so that of their products only those
    with the inputs change: every delay costs one row of a matrix product and small solves.
    """
    n_u = len(model.inputs)
    X, C = build_regressors(model, motion, inputs), compute_aerodynamic_coefficients(model, motion)
    both = np.concatenate([X[:, :-n_u], C, X[:, -n_u:]], axis=1)
    both = both / np.linalg.norm(both, axis=0)
    n_rotated = both.shape[1] - n_u
    rotated, fixed = both[:, :n_rotated], both[:, n_rotated:]
    products = np.tile(np.real(both.conj().T @ both), (common.size, 1, 1))
    rotations = np.exp(-1j * np.outer(common, motion.omega))
    mixed = (rotated.conj()[:, :, None] * fixed[:, None, :]).reshape(len(rotated), -1)
    cross = np.real(rotations @ mixed).reshape(-1, n_rotated, n_u)
    products[:, :n_rotated, n_rotated:] = cross
    products[:, n_rotated:, :n_rotated] = cross.transpose(0, 2, 1)
    given = np.r_[: X.shape[1] - n_u, n_rotated : both.shape[1]]
    sought = np.arange(X.shape[1] - n_u, n_rotated)
    normal = products[:, given[:, None], given] + _RIDGE * np.eye(given.size)
    right = products[:, given[:, None], sought]
    explained = np.sum(right * np.linalg.solve(normal, right), axis=1)
    return np.sum(np.log(np.maximum(1.0 - explained, 1e-12)), axis=1)


def estimate_relative_delays(
    model: AeroelasticModel,
    outputs: FrequencyData,
    instruments: Complex[np.ndarray, "n_omega n_y"],
) -> Float[np.ndarray, " n_y"]:
    """Estimate delays between the outputs, of zero mean, by variable projection. [s]"""
    z = outputs.values / _compute_level(outputs)
    omega = outputs.omega
    rows = (
        instruments[:, :, None] * model.sensors.response(omega) / _compute_level(outputs)[:, None]
    )
    rows = rows / np.linalg.norm(rows, axis=1)[:, None, :]
    tau = np.zeros(z.shape[1])
    damping = 1e-3
    cost, normal, gradient = _project(rows, z, omega, tau)
    for _ in range(_ITERATIONS):
        diagonal = np.diag(normal) + 1e-12 * np.trace(normal)
        step = np.linalg.solve(normal + damping * np.diag(diagonal), -gradient)
        step -= step.mean()
        step *= min(1.0, _LARGEST_STEP_RAD / (omega[-1] * max(np.max(np.abs(step)), 1e-12)))
        trial = _project(rows, z, omega, tau + step)
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


def _compute_level(outputs: FrequencyData) -> Float[np.ndarray, " n_y"]:
    return np.sqrt(np.mean(np.abs(outputs.values) ** 2, axis=0))


def _project(
    rows: Complex[np.ndarray, "n_omega n_y n_r"],
    z: Complex[np.ndarray, "n_omega n_y"],
    omega: Float[np.ndarray, " n_omega"],
    tau: Float[np.ndarray, " n_y"],
) -> tuple[float, Float[np.ndarray, "n_y n_y"], Float[np.ndarray, " n_y"]]:
    """Compute the power that no motion explains, and Kaufman's normal matrix and gradient."""
    shifted = rows * np.exp(-1j * omega[:, None] * tau)[:, :, None]
    q, _ = np.linalg.qr(shifted)
    seen = np.matmul(q, np.matmul(q.conj().transpose(0, 2, 1), z[:, :, None]))[:, :, 0]
    residual = z - seen
    slope = 1j * omega[:, None] * seen
    along = (q.conj() * slope[:, :, None]).transpose(0, 2, 1).reshape(-1, z.shape[1])
    normal = np.diag(np.sum(np.abs(slope) ** 2, axis=0)) - np.real(along.T @ along.conj())
    gradient = np.sum((slope.conj() * residual).real, axis=0)
    return float(np.sum(np.abs(residual) ** 2)), normal, gradient


def _interpolate_minimum(x: Float[np.ndarray, " n"], y: Float[np.ndarray, " n"]) -> float:
    """Interpolate the minimum by a parabola through three points."""
    k = int(np.clip(np.argmin(y), 1, x.size - 2))
    left, middle, right = y[k - 1], y[k], y[k + 1]
    curvature = left - 2.0 * middle + right
    offset = 0.5 * (left - right) / curvature if curvature > 0 else 0.0
    return float(x[k] + np.clip(offset, -1.0, 1.0) * (x[1] - x[0]))


# --- Out-of-band modes ----------------------------------------------------------------------------


def regularise_start(
    parameters: Parameters,
    values: Float[np.ndarray, " n_theta"],
    out_of_band: Sequence[int],
    predicted: DerivativeTable | None,
) -> DerivativeTable:
    """Replace the derivatives of out-of-band modes by predicted or in-vacuo values.

    Parameters
    ----------
    parameters
        Derivatives only.
    values
        Their values from equation error.
    out_of_band
        Indices of the modes above the highest frequency.
    predicted
        Source of their derivatives; without it the modes have their frequency and damping
        in vacuo.

    Notes
    -----
    The data contain little more of such a mode than its quasi-static response. Equation error
    gives values that are mostly noise, and a fit that starts there may move the mode into the
    band, where it fits noise common to all sensors: a higher likelihood, and a biased model.
    """
    n, first = len(parameters.base.modes), parameters.base.body.size
    rows, columns = parameters.rows, parameters.columns
    index = np.asarray(out_of_band, dtype=int)
    own = np.isin(rows, first + index)
    moved = np.isin(columns, np.r_[first + index, first + n + index])
    elastic = (columns >= first) & (columns < first + 2 * n)
    if predicted is None:
        table = np.where(moved | (own & elastic), 0.0, values)
    else:
        table = np.where(own | moved, predicted.values[rows, columns], values)
    return parameters.table(table)
