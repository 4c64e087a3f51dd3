"""Rigid and modal motion from redundant sensors, line by line (Sec. VIII.C).

Every output is a known combination P(s) r of the motion r = [alpha, q, eta], so r
follows by weighted least squares at each line. Because P reads forces from the
accelerations they cause, the kinematic relation between normal acceleration,
alpha and q holds exactly; that is what keeps equation error free of the bias that
noise in its regressors would bring.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Complex, Float, Int

from flexsid.errors import NotIdentifiable
from flexsid.sysid.estimation.noise import smoothed_density
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.signals import FrequencyData, check_signal

_WORST_CONDITION = 1e8
_ITERATIONS = 20
_LEAST_FREEDOM = 0.05  # of a sensor, below which its own noise is not known
_CHECKED = 0.15  # of a sensor, below which others do not tell its noise from motion
_BEST_SENSOR = 1e-3  # of its signal: keeps a few sensors from being fitted exactly


@dataclass(frozen=True, slots=True)
class Motion:
    """Motion r = [alpha, q, eta_1..n] at every line, with the covariance of its errors.

    Where the sensors' noise was estimated, ``colour`` is how much larger its variance is at
    each line than on average, ``doubt`` the relative standard deviation of all variances, and
    ``taken_as_exact`` names sensors whose noise cannot be told from motion that they alone see.
    """

    omega: Float[np.ndarray, " n_omega"]
    values: Complex[np.ndarray, "n_omega n_r"]
    covariance: Complex[np.ndarray, "n_omega n_r n_r"]
    noise: Float[np.ndarray, " n_y"]
    colour: Float[np.ndarray, " n_omega"] | None = None
    doubt: float = 0.0
    taken_as_exact: tuple[str, ...] = ()

    def first(self, n_modes: int) -> Motion:
        """The rigid motion and the first modes only."""
        n_r = 2 + n_modes
        covariance = self.covariance[:, :n_r, :n_r]
        return replace(self, values=self.values[:, :n_r], covariance=covariance)

    def coloured(self) -> Motion:
        """The same with errors as large at each line as the sensors disagree there."""
        if self.colour is None:
            return self
        return replace(self, covariance=self.covariance * self.colour[:, None, None], colour=None)


def reconstruct_motion(
    model: AeroelasticModel,
    outputs: FrequencyData,
    instruments: Complex[np.ndarray, "n_omega n_y"],
    noise: Float[np.ndarray, " n_y"] | None = None,
    guess: Float[np.ndarray, " n_y"] | None = None,
) -> Motion:
    """Separate rigid and elastic motion at every line.

    Parameters
    ----------
    model
        Gives the sensor rows.
    outputs
        Spectra as recorded. [output unit * s]
    instruments
        Recorded over true response. [1]
    noise
        Standard deviation of each output's spectral noise; estimated from the
        redundancy of the sensors when not known. [output unit * s]
    guess
        What the noise may be, to begin with where it is estimated. [output unit * s]

    Raises
    ------
    BadInput
        If the noise is not known and an output carries no signal.
    NotIdentifiable
        If the sensors cannot tell the modes apart.

    Notes
    -----
    Departure: the paper reconstructs in the time domain and fuses with a Kalman
    filter; at the lines of a transform, etadot = s eta makes that unnecessary.
    """
    z = outputs.pick(model.outputs).values
    P = instruments[:, :, None] * model.sensors.response(outputs.omega)
    n_y, n_r = P.shape[1:]
    if noise is None:
        check_signal(z, model.outputs)  # a sensor without any would seem to have no noise either
    if n_y < n_r:
        raise NotIdentifiable(
            f"{n_y} outputs cannot give {n_r} motions (alpha, q and "
            f"{n_r - 2} modes); use more sensors or fewer modes",
            outputs=n_y,
            motions=n_r,
        )
    first = guess if noise is None else noise
    sigma = _relative_level(z) if first is None else np.asarray(first, dtype=float)
    sensors = _Sensors(model, P, z, sigma)
    if noise is not None or n_y == n_r:
        return Motion(outputs.omega, *sensors.solve(sigma), sigma)
    colour = np.ones(outputs.omega.size)
    for _ in range(_ITERATIONS):
        update, colour = sensors.noise_from_redundancy(sigma, colour)
        change = np.max(np.abs(np.log(update / sigma)))
        sigma = update
        if change < 0.01:
            break
    exact = np.flatnonzero(sensors.freedom(sigma) < _CHECKED)
    return Motion(
        outputs.omega,
        *sensors.solve(sigma),
        sigma,
        colour,
        doubt=float(np.sqrt(n_y / (outputs.omega.size * (n_y - n_r)))),
        taken_as_exact=tuple(model.outputs[k] for k in exact),
    )


def observability(
    model: AeroelasticModel,
    omega: Float[np.ndarray, " n_omega"],
    instruments: Complex[np.ndarray, "n_omega n_y"],
    noise: Float[np.ndarray, " n_y"],
) -> tuple[Int[np.ndarray, " n_omega"], Float[np.ndarray, " n_omega"]]:
    """How many motions the sensors tell apart at each line, and how well.

    Parameters
    ----------
    model
        Gives the sensor rows.
    omega
        Lines. [rad/s]
    instruments
        Recorded over true response. [1]
    noise
        Standard deviation of each output's spectral noise. [output unit * s]

    Returns
    -------
    rank, condition
        Of the sensor rows over their noise, every motion scaled to what the sensors see of
        it; a motion that takes another's combination away counts where its own part is more
        than a millionth.
    """
    rows = instruments[:, :, None] * model.sensors.response(omega) / noise[:, None]
    size = np.linalg.norm(rows, axis=1)
    values = np.linalg.svd(rows / np.where(size > 0, size, 1.0)[:, None, :], compute_uv=False)
    rank = np.sum(values > 1e-6 * values[:, :1], axis=1)
    smallest = np.maximum(values[:, -1], np.finfo(float).tiny)
    return rank, np.where(rank == rows.shape[2], values[:, 0] / smallest, np.inf)


def _relative_level(z: Complex[np.ndarray, "n_omega n_y"]) -> Float[np.ndarray, " n_y"]:
    """First guess: every sensor has the same signal-to-noise ratio."""
    return 0.05 * np.sqrt(np.mean(np.abs(z) ** 2, axis=0))


class _Sensors:
    """Sensor rows of all lines, orthogonalised once for a first guess of the noise.

    In the orthonormal columns the normal equations of any other weighting stay well
    conditioned, so that trying one costs a small solve per line.
    """

    def __init__(
        self,
        model: AeroelasticModel,
        P: Complex[np.ndarray, "n_omega n_y n_r"],
        z: Complex[np.ndarray, "n_omega n_y"],
        sigma: Float[np.ndarray, " n_y"],
    ) -> None:
        names = _motion_names(model)
        rows = P / sigma[:, None]
        size = np.linalg.norm(rows, axis=1)  # (n_omega, n_r): columns differ by 1e3
        blind = np.flatnonzero((size == 0).any(axis=0))
        if blind.size:
            raise NotIdentifiable(
                f"no sensor in use sees {names[blind[0]]}; add one that does",
                code="unobservable",
                motion=names[blind[0]],
            )
        self.q, r = np.linalg.qr(rows / size[:, None, :])
        pivots = np.abs(np.einsum("kii->ki", r))
        if not pivots.all() or _condition(r) > _WORST_CONDITION:
            raise NotIdentifiable(
                f"the sensors in use cannot tell the motions {', '.join(names)} apart; use more "
                "sensors or fewer modes",
                code="unobservable",
            )
        self.back = np.linalg.inv(r) / size[:, :, None]
        self.sigma = sigma
        self.z = z / sigma
        self.level = np.sqrt(np.mean(np.abs(z) ** 2, axis=0))

    def solve(
        self, sigma: Float[np.ndarray, " n_y"]
    ) -> tuple[Complex[np.ndarray, "n_omega n_r"], Complex[np.ndarray, "n_omega n_r n_r"]]:
        """Motion and its covariance for these noise levels."""
        inverse, x, _ = self._weighted(sigma)
        motion = np.matmul(self.back, x)[:, :, 0]
        return motion, self.back @ inverse @ self.back.conj().transpose(0, 2, 1)

    def noise_from_redundancy(
        self, sigma: Float[np.ndarray, " n_y"], colour: Float[np.ndarray, " n_omega"]
    ) -> tuple[Float[np.ndarray, " n_y"], Float[np.ndarray, " n_omega"]]:
        """Noise level of every sensor, and how much larger its variance is at each line.

        Both from what the sensors disagree on, their own pull on the solution removed.
        """
        inverse, x, weight = self._weighted(sigma)
        residual = self.z - np.matmul(self.q, x)[:, :, 0]
        power = np.real(residual) ** 2 + np.imag(residual) ** 2
        n_omega, n_y, n_r = self.q.shape
        freedom = np.maximum(self._freedom(inverse, weight), _LEAST_FREEDOM)
        expected = (1.0 / colour) @ power / (n_omega * freedom)
        level = np.maximum(self.sigma * np.sqrt(expected), _BEST_SENSOR * self.level)
        together = np.sqrt(power @ (self.sigma / level) ** 2 / (n_y - n_r))
        one_group = np.zeros(n_omega, dtype=int)
        smooth = smoothed_density(together[:, None].astype(complex), one_group, 1)
        colour = np.real(smooth.blocks[smooth.block, 0, 0])
        return level, colour / colour.mean()

    def freedom(self, sigma: Float[np.ndarray, " n_y"]) -> Float[np.ndarray, " n_y"]:
        """Share of every sensor that the others check; the rest is its pull on the solution."""
        inverse, _, weight = self._weighted(sigma)
        return self._freedom(inverse, weight)

    def _freedom(
        self, inverse: Complex[np.ndarray, "n_omega n_r n_r"], weight: Float[np.ndarray, " n_y"]
    ) -> Float[np.ndarray, " n_y"]:
        seen = np.real(np.sum(np.matmul(self.q, inverse) * self.q.conj(), axis=(0, 2)))
        return 1.0 - weight * seen / len(self.q)

    def _weighted(
        self, sigma: Float[np.ndarray, " n_y"]
    ) -> tuple[np.ndarray, np.ndarray, Float[np.ndarray, " n_y"]]:
        """Inverse normal matrix and solution in the orthonormal columns, and the weights."""
        weight = (self.sigma / sigma) ** 2
        left = (self.q.conj() * weight[:, None]).transpose(0, 2, 1)
        inverse = np.linalg.inv(np.matmul(left, self.q))
        return inverse, np.matmul(inverse, np.matmul(left, self.z[:, :, None])), weight


def _condition(r: Complex[np.ndarray, "n_omega n_r n_r"]) -> float:
    """Largest condition number of any line, a little overestimated."""
    size = np.linalg.norm(r, axis=(1, 2)) * np.linalg.norm(np.linalg.inv(r), axis=(1, 2))
    return float(size.max())


def _motion_names(model: AeroelasticModel) -> tuple[str, ...]:
    return ("alpha", "q", *(f"eta{number}" for number in model.modes.numbers))
