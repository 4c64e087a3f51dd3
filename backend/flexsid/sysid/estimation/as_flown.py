"""What one flown maneuver tells of the next: how surfaces follow commands, how outputs scatter."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float

from flexsid.sysid.estimation.noise import smoothed_density
from flexsid.sysid.signals import FrequencyData
from flexsid.sysid.spectra.scatter import local_scatter

_CLEAR = 0.6  # share of noise in the residuals above which model error is not clear of it

Response = Callable[[Float[np.ndarray, " n_omega"]], np.ndarray]


@dataclass(frozen=True, slots=True)
class TabulatedResponse:
    """Values over frequency, linear between and held beyond what is known."""

    omega: Float[np.ndarray, " n_known"]
    values: np.ndarray

    def at(self, omega: Float[np.ndarray, " n_omega"]) -> np.ndarray:
        """Values at other frequencies, first axis frequency."""
        if self.omega.size == 1:
            return np.repeat(self.values, omega.size, axis=0)
        place = np.clip(np.searchsorted(self.omega, omega), 1, self.omega.size - 1)
        low, high = self.omega[place - 1], self.omega[place]
        share = np.clip((omega - low) / (high - low), 0.0, 1.0)
        share = share.reshape(-1, *[1] * (self.values.ndim - 1))
        return (1.0 - share) * self.values[place - 1] + share * self.values[place]


@dataclass(frozen=True, slots=True)
class AsFlown:
    """Circumstances in which a design would be flown.

    ``follow`` gives the deflections (n_omega, n_u) of all surfaces per command of one,
    by its name: actuators and feedback are in it. ``noise`` is the spectral density
    (n_omega, n_y, n_y) of the outputs per hertz. ``instruments`` (n_omega, n_y) lies
    between true and recorded outputs. ``margin_s`` is recorded beside the excitation.
    ``missed`` is what the model leaves of the outputs (n_omega, n_y) per command of an
    input, by its name; it grows with amplitude as the response does.
    """

    follow: Mapping[str, Response]
    noise: Response
    missed: Mapping[str, Response]
    instruments: Response
    margin_s: float


def surfaces_follow(
    deflections: FrequencyData, commands: FrequencyData, owner: np.ndarray
) -> dict[str, Response]:
    """How all surfaces answer to each command that owns lines, as flown.

    Parameters
    ----------
    deflections
        True deflections at all lines. [rad s]
    commands
        Recorded excitation of every input. [rad s]
    owner
        Index of the input that owns each line.
    """
    answers: dict[str, Response] = {}
    for index, name in enumerate(commands.names):
        own = np.flatnonzero((owner == index) & (commands.values[:, index] != 0.0))
        if own.size:
            ratio = deflections.values[own] / commands.values[own, index][:, None]
            answers[name] = TabulatedResponse(deflections.omega[own], ratio).at
    return answers


@dataclass(frozen=True, slots=True)
class RecordResiduals:
    """What a fit left over at the lines of one maneuver.

    ``values`` are spectra; ``command`` is the spectrum of the command that owns each
    line, None where it is not known. [output unit * s], [rad s]
    """

    omega: Float[np.ndarray, " n_omega"]
    values: Complex[np.ndarray, "n_omega n_y"]
    record_s: float
    owner: np.ndarray
    command: Complex[np.ndarray, " n_omega"] | None


def split_residuals(
    maneuvers: Sequence[RecordResiduals], inputs: tuple[str, ...], n_theta: int
) -> tuple[Response, dict[str, Response]]:
    """Density of the noise, and what the model misses per command of each input.

    Parameters
    ----------
    maneuvers
        Of one fit.
    inputs
        Names of the owners.
    n_theta
        Parameters that were fitted; where noise cannot be told from model error, what
        they took off the scatter is put back.

    Notes
    -----
    A model error is a smooth function of frequency times the command that excites it;
    noise is what departs from smoothness along the lines of one command. Where commands
    are unknown or own too few lines, all counts as noise.
    """
    omega, samples = [], []
    for one in maneuvers:
        scale = 1.0 / np.sqrt(one.record_s)
        for index in range(len(inputs)):
            own = np.flatnonzero(one.owner == index)
            rough = None
            if one.command is not None:
                rough = local_scatter(one.values[own] / one.command[own, None])
            if one.command is None or rough is None:
                return noise_spectrum(maneuvers, n_theta), {}
            lines = own[rough.lines]
            omega.append(one.omega[lines])
            samples.append(scale * rough.values * one.command[lines, None])
    noise = _smooth(np.concatenate(omega), np.concatenate(samples))
    every = _smooth(
        np.concatenate([one.omega for one in maneuvers]),
        np.concatenate([one.values / np.sqrt(one.record_s) for one in maneuvers]),
    )
    share = _clear_share(noise, every)
    first = maneuvers[0]
    assert first.command is not None
    missed: dict[str, Response] = {}
    for index, name in enumerate(inputs):
        own = np.flatnonzero(first.owner == index)
        at = first.omega[own]
        kept = np.sqrt(1.0 - share(at))
        missed[name] = TabulatedResponse(at, kept * first.values[own] / first.command[own, None]).at

    def what_is_noise(omega: Float[np.ndarray, " n_omega"]) -> np.ndarray:
        density = noise(omega)
        target = share(omega) * np.real(_diagonal(every(omega)))
        size = np.sqrt(target / np.maximum(np.real(_diagonal(density)), 1e-300))
        return density * size[:, :, None] * size[:, None, :]

    return what_is_noise, missed


def _clear_share(noise: Response, every: Response) -> Response:
    """Share of the residuals' power that is noise: all, unless model error clearly exceeds it."""

    def share(omega: Float[np.ndarray, " n_omega"]) -> np.ndarray:
        whole = np.maximum(np.real(_diagonal(every(omega))), 1e-300)
        rough = np.real(_diagonal(noise(omega))) / whole
        return np.where(rough > _CLEAR, 1.0, rough)

    return share


def noise_spectrum(maneuvers: Sequence[RecordResiduals], n_theta: int) -> Response:
    """Density of all that a fit left over, from neighbouring lines."""
    n_data = 2 * sum(one.values.size for one in maneuvers)
    inflation = np.sqrt(n_data / max(n_data - n_theta, 1))
    return _smooth(
        np.concatenate([one.omega for one in maneuvers]),
        np.concatenate([inflation * one.values / np.sqrt(one.record_s) for one in maneuvers]),
    )


def _smooth(
    omega: Float[np.ndarray, " n_omega"], values: Complex[np.ndarray, "n_omega n_y"]
) -> Response:
    order = np.argsort(omega, kind="stable")
    smooth = smoothed_density(values[order], np.zeros(omega.size, dtype=int), 1)
    centres = np.array([omega[order][lines].mean() for lines in smooth.block_lines()])
    return TabulatedResponse(centres, smooth.blocks).at


def _diagonal(matrices: np.ndarray) -> np.ndarray:
    return np.diagonal(matrices, axis1=1, axis2=2)


def actuators_only(
    response: Mapping[str, Response], inputs: tuple[str, ...]
) -> dict[str, Response]:
    """Surfaces that follow their own command through their actuator, without feedback."""

    def follow(name: str) -> Response:
        own = np.eye(len(inputs))[inputs.index(name)]
        return lambda omega: response[name](omega)[:, None] * own

    return {name: follow(name) for name in inputs}
