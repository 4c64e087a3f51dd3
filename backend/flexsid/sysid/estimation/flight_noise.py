"""Flight noise: command-to-surface responses, joint noise of outputs and inputs, process noise.

The commands are known and independent of turbulence and sensor noise, which feedback brings to
the inputs; no model is needed to separate them.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Complex, Float

from flexsid.sysid.estimation.noise import (
    SEGMENT,
    NoiseSpectrum,
    SpectralMatrix,
    estimate_noise_spectrum,
    smooth_density,
)
from flexsid.sysid.signals import FrequencyData
from flexsid.sysid.spectra.residual_spectrum import compute_local_residuals
from flexsid.sysid.spectra.response_estimators import smooth_response

# --- Flight noise model: command-to-surface responses and output noise of a recorded maneuver -----

_ALL_NOISE = 0.6  # share of noise in the residual power above which all of it counts as noise

Response = Callable[[Float[np.ndarray, " n_omega"]], np.ndarray]


@dataclass(frozen=True, slots=True)
class TabulatedResponse:
    """Values over frequency, linear between the known ones and constant outside."""

    omega: Float[np.ndarray, " n_known"]
    values: np.ndarray

    def at(self, omega: Float[np.ndarray, " n_omega"]) -> np.ndarray:
        """Values at other frequencies, first axis frequency."""
        if self.omega.size == 1:
            return np.repeat(self.values, omega.size, axis=0)
        upper = np.clip(np.searchsorted(self.omega, omega), 1, self.omega.size - 1)
        low, high = self.omega[upper - 1], self.omega[upper]
        share = np.clip((omega - low) / (high - low), 0.0, 1.0)
        share = share.reshape(-1, *[1] * (self.values.ndim - 1))
        return (1.0 - share) * self.values[upper - 1] + share * self.values[upper]


@dataclass(frozen=True, slots=True)
class FlightNoiseModel:
    """Responses and noise that are expected in flight.

    ``command_responses`` are the deflections (n_omega, n_u) of all surfaces per command of
    one input, by its name, actuators and feedback included. ``noise`` is the spectral
    density (n_omega, n_y, n_y) of the outputs per hertz. ``instruments`` (n_omega, n_y) are
    recorded over true outputs. ``margin_s`` is recorded in addition to the excitation.
    ``unmodelled_responses`` are the outputs (n_omega, n_y) per command of an input, by its
    name, that the model does not explain; they are proportional to the amplitude.
    ``variance_ratio`` is the variance of estimates over their Cramer-Rao bound.
    """

    command_responses: Mapping[str, Response]
    noise: Response
    unmodelled_responses: Mapping[str, Response]
    instruments: Response
    margin_s: float
    variance_ratio: float = 1.0


def compute_command_responses(
    deflections: FrequencyData, commands: FrequencyData, assigned_input: np.ndarray
) -> dict[str, Response]:
    """Compute the response of all surfaces to each command that has harmonics of its own.

    Parameters
    ----------
    deflections
        True deflections at all harmonics. [rad s]
    commands
        Recorded excitation of every input. [rad s]
    assigned_input
        Index of the input that each harmonic is assigned to.

    Notes
    -----
    They are smooth over frequency. The noise of measured deflections differs from harmonic to
    harmonic; over the small commands of an optimal design it would pass for independent motion of
    all surfaces, and thus for information.
    """
    responses: dict[str, Response] = {}
    for index, name in enumerate(commands.names):
        own = np.flatnonzero((assigned_input == index) & (commands.values[:, index] != 0.0))
        if own.size:
            ratio = deflections.values[own] / commands.values[own, index][:, None]
            omega, size = deflections.omega[own], np.abs(commands.values[own, index])
            responses[name] = TabulatedResponse(omega, smooth_response(omega, ratio, size)).at
    return responses


@dataclass(frozen=True, slots=True)
class RecordResiduals:
    """Residuals of a fit at the harmonics of one maneuver.

    ``values`` are spectra; ``command`` is the spectrum of the command that each harmonic is
    assigned to, None where it is not known. [output unit * s], [rad s]
    """

    omega: Float[np.ndarray, " n_omega"]
    values: Complex[np.ndarray, "n_omega n_y"]
    record_s: float
    assigned_input: np.ndarray
    command: Complex[np.ndarray, " n_omega"] | None


def split_residuals(
    maneuvers: Sequence[RecordResiduals],
    inputs: tuple[str, ...],
    n_theta: int,
    *,
    all_noise: bool = False,
) -> tuple[Response, dict[str, Response]]:
    """Separate residuals into the density of the noise and the unmodelled response by input.

    Parameters
    ----------
    maneuvers
        Residuals of one fit, by maneuver.
    inputs
        Names of the inputs, in the order of ``assigned_input``.
    n_theta
        Number of fitted parameters; where noise and model error cannot be separated, the
        density is corrected for the variance that they explain.
    all_noise
        Whether all residuals count as noise, as for fits that retain out-of-band modes, or for
        which no test finds model error: the response that is left is smaller than the noise.

    Notes
    -----
    A model error is a smooth function of frequency times the command that excites it; noise
    is the deviation from smoothness over the harmonics of one command. Where commands are
    unknown or have too few harmonics, all residuals count as noise.
    """
    omega, samples = [], []
    if all_noise:
        return _estimate_residual_density(maneuvers, n_theta), {}
    for one in maneuvers:
        scale = 1.0 / np.sqrt(one.record_s)
        for index in range(len(inputs)):
            own = np.flatnonzero(one.assigned_input == index)
            residuals = None
            if one.command is not None:
                residuals = compute_local_residuals(one.values[own] / one.command[own, None])
            if one.command is None or residuals is None:
                return _estimate_residual_density(maneuvers, n_theta), {}
            picked = own[residuals.indices]
            omega.append(one.omega[picked])
            samples.append(scale * residuals.values * one.command[picked, None])
    noise = _estimate_density(np.concatenate(omega), np.concatenate(samples))
    every = smooth_spectrum(
        np.concatenate([one.omega for one in maneuvers]),
        np.concatenate([one.values / np.sqrt(one.record_s) for one in maneuvers]),
    )
    share = _compute_noise_share(noise, every)
    first = maneuvers[0]
    assert first.command is not None
    unmodelled: dict[str, Response] = {}
    for index, name in enumerate(inputs):
        own = np.flatnonzero(first.assigned_input == index)
        at = first.omega[own]
        factor = np.sqrt(1.0 - share(at))
        ratio = factor * first.values[own] / first.command[own, None]
        unmodelled[name] = TabulatedResponse(at, ratio).at

    def noise_density(omega: Float[np.ndarray, " n_omega"]) -> np.ndarray:
        density = noise(omega)
        target = share(omega) * np.real(_diagonal(every(omega)))
        size = np.sqrt(target / np.maximum(np.real(_diagonal(density)), 1e-300))
        return density * size[:, :, None] * size[:, None, :]

    return noise_density, unmodelled


def _compute_noise_share(noise: Response, every: Response) -> Response:
    """Compute the share of noise in the residual power: 1 above ``_ALL_NOISE``."""

    def share(omega: Float[np.ndarray, " n_omega"]) -> np.ndarray:
        whole = np.maximum(np.real(_diagonal(every(omega))), 1e-300)
        rough = np.real(_diagonal(noise(omega))) / whole
        return np.where(rough > _ALL_NOISE, 1.0, rough)

    return share


def _estimate_residual_density(maneuvers: Sequence[RecordResiduals], n_theta: int) -> Response:
    """Estimate the density of all residuals from neighbouring frequencies."""
    n_data = 2 * sum(one.values.size for one in maneuvers)
    inflation = np.sqrt(n_data / max(n_data - n_theta, 1))
    return _estimate_density(
        np.concatenate([one.omega for one in maneuvers]),
        np.concatenate([inflation * one.values / np.sqrt(one.record_s) for one in maneuvers]),
    )


def _estimate_density(
    omega: Float[np.ndarray, " n_omega"], values: Complex[np.ndarray, "n_omega n_y"]
) -> Response:
    """Estimate the density of values as estimators do for their weights.

    Independent noise and a few directions of common noise, such as turbulence; one variance per
    output where there are too few frequencies.
    """
    order = np.argsort(omega, kind="stable")
    found = estimate_noise_spectrum(values[order])
    if found is None:
        mean = np.diag(np.mean(np.abs(values) ** 2, axis=0)).astype(complex)
        return TabulatedResponse(omega[:1], mean[None]).at
    segment = found.density.block
    centres = np.bincount(segment, omega[order]) / np.bincount(segment)
    return TabulatedResponse(centres, found.density.blocks).at


def smooth_spectrum(
    omega: Float[np.ndarray, " n_omega"], values: Complex[np.ndarray, "n_omega n_y"]
) -> Response:
    """Smooth the density of values over frequency, to be evaluated at any frequency."""
    order = np.argsort(omega, kind="stable")
    smooth = smooth_density(values[order], np.zeros(omega.size, dtype=int), 1)
    centres = np.array([omega[order][block].mean() for block in smooth.block_slices()])
    return TabulatedResponse(centres, smooth.blocks).at


def average_density(
    omega: Float[np.ndarray, " n_omega"],
    density: Complex[np.ndarray, "n_omega n_y n_y"],
    width: int,
) -> Response:
    """Average a density over ``width`` neighbouring frequencies, as estimators do for its estimate.

    Frequencies are in order; the windows at both ends are the outermost full ones.
    """
    width = min(width, omega.size)
    first = np.clip(np.arange(omega.size) - width // 2, 0, omega.size - width)
    sums = np.concatenate([np.zeros_like(density[:1]), np.cumsum(density, axis=0)])
    return TabulatedResponse(omega, (sums[first + width] - sums[first]) / width).at


def _diagonal(matrices: np.ndarray) -> np.ndarray:
    return np.diagonal(matrices, axis1=1, axis2=2)


def build_actuator_responses(
    response: Mapping[str, Response], inputs: tuple[str, ...]
) -> dict[str, Response]:
    """Build command-to-surface responses of actuators alone, without feedback."""

    def respond(name: str) -> Response:
        own = np.eye(len(inputs))[inputs.index(name)]
        return lambda omega: response[name](omega)[:, None] * own

    return {name: respond(name) for name in inputs}


# --- Motion and inputs that no command excites, such as those by turbulence -----------------------

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


# --- Joint noise of outputs and inputs: what deviates from a smooth response to the commands ------

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
