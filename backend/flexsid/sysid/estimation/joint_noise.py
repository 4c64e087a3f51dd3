"""Joint noise of outputs and inputs: what deviates from a smooth response to the commands.

The commands are known and independent of turbulence and sensor noise, which feedback brings to
the inputs; no model is needed to separate them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from jaxtyping import Complex, Float

from flexsid.sysid.estimation.noise import SEGMENT, SpectralMatrix
from flexsid.sysid.estimation.noise_spectrum import NoiseSpectrum, estimate_noise_spectrum
from flexsid.sysid.estimation.process_noise import AssignedCommands
from flexsid.sysid.spectra.residual_spectrum import compute_local_residuals

_WINDOW = 5  # neighbouring harmonics of one command in a local fit, by a straight line
_NEIGHBOURS = 5  # segments of frequencies on either side that share their noise
SHARED_FREQUENCIES = (2 * _NEIGHBOURS + 1) * SEGMENT
"""Neighbouring frequencies that share one estimate of the joint noise."""

_EXCESS = 6  # frequencies of a local fit of a part of a maneuver beyond its unknowns
_LONG_GAP_S = 0.5  # more than a few lost packets [s]
_DEPENDENT = 1e-3  # relative size of a regressor that the others explain
LEAST_SHARE = 0.08
"""Noise by feedback over the rms of an input, below which the data are not corrected: .14 to .7 in
light and moderate turbulence at .65 V_f and above; .01 in still air, and .05 at 1.2 V_f, where it
is the motion at the end of the record. Smaller noise biases less than the standard errors, or the
change by the weights of the noise spectrum reports it."""


def estimate_joint_noise(
    omega: Float[np.ndarray, " n_omega"],
    values: Complex[np.ndarray, "n_omega n"],
    commands: AssignedCommands,
) -> NoiseSpectrum | None:
    """Estimate the joint noise spectrum of signals about their smooth response to the commands.

    Parameters
    ----------
    omega
        Frequencies, in order. [rad/s]
    values
        Spectra of outputs and inputs.
    commands
        The command that excites each harmonic.

    Returns
    -------
    NoiseSpectrum or None
        At all frequencies; None where harmonics have no command, or are too few.

    Notes
    -----
    The noise at a harmonic is the deviation of its response to the command from a straight line
    through five neighbouring harmonics of that command, of norm one for white noise. A
    response that is not straight over them, as at a sharp resonance, counts as noise, which costs
    precision. The spectral matrix is that of ``estimate_noise_spectrum``.
    Source: Pintelon and Schoukens, System Identification, 2nd ed., 2012, ch. 7 and 12.
    """
    half = _WINDOW // 2
    places, samples = [], []
    for index in np.unique(commands.assigned_input):
        own = np.flatnonzero(commands.assigned_input == index)
        command = commands.values[own]
        if index < 0 or own.size < _WINDOW or not command.all():
            return None
        responses = values[own] / command[:, None]
        windows = np.lib.stride_tricks.sliding_window_view(responses, _WINDOW, axis=0)
        near = np.lib.stride_tricks.sliding_window_view(omega[own], _WINDOW)
        weights = _compute_line_residuals(near - near.mean(axis=1, keepdims=True))
        middle = slice(half, own.size - half)
        places.append(own[middle])
        residuals = np.matmul(windows, weights[:, :, None])[:, :, 0]
        samples.append(residuals * command[middle, None])
    at = np.concatenate(places)
    order = np.argsort(at)
    found = estimate_noise_spectrum(np.concatenate(samples)[order], _NEIGHBOURS)
    if found is None:
        return None
    known = omega[at[order]]
    nearest = np.searchsorted(0.5 * (known[1:] + known[:-1]), omega)
    density = SpectralMatrix(found.density.blocks, found.density.block[nearest])
    return replace(found, density=density)


def estimate_joint_noise_of_part(
    omega: Float[np.ndarray, " n_omega"],
    values: Complex[np.ndarray, "n_omega n"],
    commands: Complex[np.ndarray, "n_omega n_commands"],
    edges_s: Sequence[float],
) -> NoiseSpectrum | None:
    """Estimate the joint noise spectrum of signals of a part of a maneuver.

    Parameters
    ----------
    omega
        Frequencies about 1/T apart, in order. [rad/s]
    values
        Spectra of outputs and inputs.
    commands
        Spectra of all commands, which a part of a period excites at every frequency.
    edges_s
        Times at which the stretches of the record begin and end in motion. [s]

    Returns
    -------
    NoiseSpectrum or None
        None where frequencies are too few.

    Notes
    -----
    The noise at a frequency is the deviation from responses to all commands, and a free motion
    from each end, that are constant over its neighbours, of norm one for white noise (local
    polynomial method of order zero). The free motions from both ends of a short gap nearly cancel;
    what is left counts as noise. What the motion of a short record adds to it, where the
    responses are not constant, obeys the model: it has no part in the residuals at the optimum.
    Source: Pintelon and Schoukens, System Identification, 2nd ed., 2012, sec. 7.2.
    """
    stretches = np.reshape(edges_s, (-1, 2))
    is_long = stretches[1:, 0] - stretches[:-1, 1] > _LONG_GAP_S
    begins = stretches[np.append(True, is_long), 0]
    ends = stretches[np.append(is_long, True), 1]
    free = np.exp(-1j * np.outer(omega, np.append(begins, ends)))
    regressors = np.concatenate([commands / compute_rms(commands), free], axis=1)
    width = 2 * ((regressors.shape[1] + _EXCESS) // 2) + 1
    if omega.size < width:
        return None
    half = width // 2
    near = np.lib.stride_tricks.sliding_window_view(regressors, width, axis=0)
    basis, sizes, _ = np.linalg.svd(near.transpose(0, 2, 1), full_matrices=False)
    basis = basis * (sizes > _DEPENDENT * sizes[:, :1])[:, None, :]
    weights = np.eye(width)[half] - np.einsum("kp,kip->ki", basis[:, half], basis.conj())
    norms = np.linalg.norm(weights, axis=1, keepdims=True)
    windows = np.lib.stride_tricks.sliding_window_view(values, width, axis=0)
    samples = np.matmul(windows, (weights / norms)[:, :, None])[:, :, 0]
    found = estimate_noise_spectrum(samples, _NEIGHBOURS)
    if found is None:
        return None
    segment = np.clip(np.arange(omega.size) - half, 0, len(samples) - 1)
    return replace(
        found, density=SpectralMatrix(found.density.blocks, found.density.block[segment])
    )


def _compute_line_residuals(
    x: Float[np.ndarray, "n_windows n_window"],
) -> Float[np.ndarray, "n_windows n_window"]:
    """Compute the weights of windows in the residuals of their middles from lines; norm one."""
    half = x.shape[1] // 2
    slope = x[:, half, None] * x / np.sum(x**2, axis=1, keepdims=True)
    weights = np.eye(x.shape[1])[half] - 1.0 / x.shape[1] - slope
    return weights / np.linalg.norm(weights, axis=1, keepdims=True)


def has_input_noise(inputs: Complex[np.ndarray, "n_omega n_u"], commands: AssignedCommands) -> bool:
    """Whether an input deviates from a smooth response to the commands by ``LEAST_SHARE``."""
    power = np.zeros(inputs.shape[1])
    for index in np.unique(commands.assigned_input):
        own = np.flatnonzero(commands.assigned_input == index)
        command = commands.values[own]
        if index < 0 or not command.all():
            return False
        found = compute_local_residuals(inputs[own] / command[:, None])
        if found is None:
            return False
        noise = compute_rms(found.values * command[found.indices, None])
        power += own.size / len(inputs) * noise**2
    return bool(np.any(np.sqrt(power) > LEAST_SHARE * compute_rms(inputs)))


def compute_rms(values: Complex[np.ndarray, "n_omega n"]) -> Float[np.ndarray, " n"]:
    """Compute the root mean square of each signal over its frequencies."""
    return np.sqrt(np.mean(np.abs(values) ** 2, axis=0))
