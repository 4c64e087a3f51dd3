"""Regression of parts of maneuvers: starting values from records that begin or end in motion.

The transform of a rate over a part is s X + x(t_1) e^{-s t_1} - x(t_0) e^{-s t_0}, and at multiples
of 1/T of the part one real number for each motion stands for both ends. These numbers are
estimated from the redundancy of the sensors and by a column of their own in each regression.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from jaxtyping import Complex, Float

from flexsid.errors import NotIdentifiable
from flexsid.sysid.estimation.equation_error import (
    build_regressors,
    compute_aerodynamic_coefficients,
)
from flexsid.sysid.estimation.experiment import Experiment
from flexsid.sysid.estimation.parameters import Parameters
from flexsid.sysid.estimation.reconstruction import complete_noise_guess, reconstruct_motion
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.sensors import ACCELERATION, INTEGRAL, RATE
from flexsid.sysid.signals import FrequencyData


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
