"""Motion and inputs that no command excites, such as those by turbulence."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float

from flexsid.sysid.estimation.flight_noise import smooth_spectrum
from flexsid.sysid.spectra.residual_spectrum import compute_local_residuals

_LEAST_RATIO = 3.0
"""Power of the unexcited motion over the variance of its reconstruction from which turbulence is
assumed: 1.0 to 1.2 in still air at .65 to .95 V_f, 129 in turbulence of .3 m/s."""

_INDEPENDENT = 7  # data points of a local fit, with one degree of freedom of the noise


@dataclass(frozen=True, slots=True)
class AssignedCommands:
    """Index of the input that each harmonic is assigned to, and the spectrum of its command."""

    assigned_input: np.ndarray
    values: Complex[np.ndarray, " n_omega"]


@dataclass(frozen=True, slots=True)
class ProcessNoise:
    """Covariance of spectra about the response to commands, and its relative std. deviation."""

    covariance: Complex[np.ndarray, "n_omega n n"]
    relative_std: float


def estimate_process_noise(
    omega: Float[np.ndarray, " n_omega"],
    motion: Complex[np.ndarray, "n_omega n_r"],
    motion_covariance: Complex[np.ndarray, "n_omega n_r n_r"],
    inputs: Complex[np.ndarray, "n_omega n_u"],
    commands: AssignedCommands,
) -> ProcessNoise | None:
    """Estimate the covariance of motion and inputs about their response to the commands.

    None without process noise, if the motion is as accurate as its reconstruction, and where an
    input has too few harmonics.

    Notes
    -----
    Turbulence moves the aircraft by forces that no regressor contains, and the controller moves
    the surfaces with it. The response to the commands alone obeys the equations of motion; what
    deviates from it, noise of the sensors included, is an error in variables. Its spectrum is that
    of the deviations from a smooth response over the harmonics of each command.
    Source: Pintelon and Schoukens, System Identification, 2nd ed., 2012, ch. 9 and 12.
    """
    values = np.concatenate([motion, inputs], axis=1)
    places, samples = [], []
    for index in np.unique(commands.assigned_input):
        own = np.flatnonzero(commands.assigned_input == index)
        own = own[np.argsort(omega[own], kind="stable")]
        command = commands.values[own]
        if index < 0 or not command.all():
            return None
        residuals = compute_local_residuals(values[own] / command[:, None])
        if residuals is None:
            return None
        places.append(omega[own][residuals.indices])
        samples.append(residuals.values * command[residuals.indices][:, None])
    covariance = smooth_spectrum(np.concatenate(places), np.concatenate(samples))(omega)
    n_r = motion.shape[1]
    ratio = np.linalg.solve(motion_covariance, covariance[:, :n_r, :n_r])
    mean = np.real(np.trace(ratio, axis1=1, axis2=2)) / n_r
    if not np.median(mean) > _LEAST_RATIO:
        return None
    return ProcessNoise(covariance, float(np.sqrt(_INDEPENDENT / omega.size)))
