"""Flight noise model: command-to-surface responses and output noise of a recorded maneuver."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float

from flexsid.sysid.estimation.noise import smooth_density
from flexsid.sysid.estimation.noise_spectrum import estimate_noise_spectrum
from flexsid.sysid.signals import FrequencyData
from flexsid.sysid.spectra.residual_spectrum import compute_local_residuals
from flexsid.sysid.spectra.response_smoothing import smooth_response

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
