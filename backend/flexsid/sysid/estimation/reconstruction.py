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
from flexsid.sysid.estimation.regression import excess_variance
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.signals import FrequencyData, check_signal

_WORST_CONDITION = 1e8
_ITERATIONS = 40
_STILL = 0.02  # change of a log variance that is worth no further round
_LARGEST_STEP = 1.5  # of a log variance
_TIED = 0.05  # lines of information per line on how sensors' log variances differ from the usual
_UNSURE = 1.5  # standard deviation of a log variance that only the usual ratio tells: a factor 2
_TOLD = 0.5  # of a sensor's log variance that the data must tell, else it counts as assumed
_ENOUGH_LINES = 64  # for the information on the noise
_UNUSUAL = 1e-6  # of the strongest: directions of scale factors that no residual shows


@dataclass(frozen=True, slots=True)
class ReconstructedMotion:
    """Motion r = [alpha, q, eta_1..n] at every line, with the covariance of its errors.

    Where the sensors' noise was estimated, ``colour`` is how much larger its variance is at
    each line than on average, ``doubt`` the relative standard deviation of all variances, and
    ``assumed`` names the sensors whose noise the others do not tell: relative to the others it
    is what was given or usual. ``disagreement`` is what one standard deviation of each
    sensor's scale factor does to the motion, ``scale_std`` being how much they disagree.
    """

    omega: Float[np.ndarray, " n_omega"]
    values: Complex[np.ndarray, "n_omega n_r"]
    covariance: Complex[np.ndarray, "n_omega n_r n_r"]
    noise: Float[np.ndarray, " n_y"]
    colour: Float[np.ndarray, " n_omega"] | None = None
    doubt: float = 0.0
    assumed: tuple[str, ...] = ()
    disagreement: Complex[np.ndarray, "n_omega n_y n_r"] | None = None
    scale_std: float = 0.0

    def first(self, n_modes: int) -> ReconstructedMotion:
        """The rigid motion and the first modes only."""
        n_r = 2 + n_modes
        return replace(
            self,
            values=self.values[:, :n_r],
            covariance=self.covariance[:, :n_r, :n_r],
            disagreement=None if self.disagreement is None else self.disagreement[:, :, :n_r],
        )

    def coloured(self) -> ReconstructedMotion:
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
) -> ReconstructedMotion:
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
        What the noise may be up to a common factor, to begin with and for what the sensors
        do not tell of it; NaN where nothing is known, by default the same share of every
        sensor's signal. [output unit * s]

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

    The log variances of the sensors' noise are those of the restricted likelihood of what the
    sensors disagree on (Patterson and Thompson, Biometrika 58, 1971), with a normal prior
    on how they differ from the guess, as much information as one line in twenty. Without
    it a few sensors end in a corner: one is believed to be exact, and another to be noise.
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
    sigma = _usual_noise(z, guess) if noise is None else np.asarray(noise, dtype=float)
    sensors = _Sensors(model, P, z, sigma)
    if noise is not None:
        return ReconstructedMotion(outputs.omega, *sensors.solve(sigma), sigma)
    if n_y == n_r:
        motion = ReconstructedMotion(outputs.omega, *sensors.solve(sigma), sigma)
        return replace(motion, doubt=_UNSURE, assumed=model.outputs)
    usual = 2.0 * np.log(sigma)
    log_variance = usual
    colour = np.ones(outputs.omega.size)
    for _ in range(_ITERATIONS):
        step, colour = sensors.towards_redundancy(log_variance, usual, colour)
        log_variance = log_variance + step
        if np.max(np.abs(step)) < _STILL:
            break
    sigma = np.exp(0.5 * log_variance)
    told, apart = sensors.information(sigma), np.eye(n_y) - 1.0 / n_y
    share = np.diag(np.linalg.solve(told + _TIED * apart, told))
    unsure = np.linalg.inv(outputs.omega.size * told + apart / _UNSURE**2)
    scale_std = sensors.scale_disagreement(sigma, colour)
    return ReconstructedMotion(
        outputs.omega,
        *sensors.solve(sigma),
        sigma,
        colour,
        doubt=float(np.sqrt(np.mean(np.diag(unsure)))),
        assumed=tuple(model.outputs[k] for k in np.flatnonzero(share < _TOLD)),
        disagreement=scale_std * sensors.of_scale(sigma) if scale_std > 0.0 else None,
        scale_std=scale_std,
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


def _usual_noise(
    z: Complex[np.ndarray, "n_omega n_y"], guess: Float[np.ndarray, " n_y"] | None
) -> Float[np.ndarray, " n_y"]:
    """The guess; where there is none, the share of its signal that noise is of others'."""
    level = 0.05 * np.sqrt(np.mean(np.abs(z) ** 2, axis=0))
    if guess is None:
        return level
    known = np.isfinite(guess) & (guess > 0.0)
    factor = np.median(guess[known] / level[known]) if known.any() else 1.0
    return np.where(known, guess, factor * level)


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

    def solve(
        self, sigma: Float[np.ndarray, " n_y"]
    ) -> tuple[Complex[np.ndarray, "n_omega n_r"], Complex[np.ndarray, "n_omega n_r n_r"]]:
        """Motion and its covariance for these noise levels."""
        inverse, x, _ = self._weighted(sigma)
        motion = np.matmul(self.back, x)[:, :, 0]
        return motion, self.back @ inverse @ self.back.conj().transpose(0, 2, 1)

    def towards_redundancy(
        self,
        log_variance: Float[np.ndarray, " n_y"],
        usual: Float[np.ndarray, " n_y"],
        colour: Float[np.ndarray, " n_omega"],
    ) -> tuple[Float[np.ndarray, " n_y"], Float[np.ndarray, " n_omega"]]:
        """Step of the sensors' log variances, and how much larger they are at each line."""
        sigma = np.exp(0.5 * log_variance)
        inverse, x, weight = self._weighted(sigma)
        residual = self.z - np.matmul(self.q, x)[:, :, 0]
        power = (np.real(residual) ** 2 + np.imag(residual) ** 2) * weight
        n_omega, n_y, n_r = self.q.shape
        together = np.sqrt(power.sum(axis=1) / (n_y - n_r))
        one_group = np.zeros(n_omega, dtype=int)
        smooth = smoothed_density(together[:, None].astype(complex), one_group, 1)
        colour = np.real(smooth.blocks[smooth.block, 0, 0])
        colour = np.maximum(colour / colour.mean(), np.finfo(float).tiny)
        score = (1.0 / colour) @ power / n_omega - self._freedom(inverse, weight)
        tie = _TIED * (np.eye(n_y) - 1.0 / n_y)
        curvature = self.information(sigma) + np.diag(np.maximum(score, 0.0)) + tie
        step = np.linalg.solve(curvature, score - tie @ (log_variance - usual))
        return np.clip(step, -_LARGEST_STEP, _LARGEST_STEP), colour

    def information(self, sigma: Float[np.ndarray, " n_y"]) -> Float[np.ndarray, "n_y n_y"]:
        """What a line tells of the sensors' log variances, on average over the lines."""
        some = slice(None, None, max(1, len(self.q) // _ENOUGH_LINES))
        q, _ = np.linalg.qr(self.q[some] * (self.sigma / sigma)[:, None])
        rest = np.eye(sigma.size) - q @ q.conj().transpose(0, 2, 1)
        return np.mean(np.real(rest) ** 2 + np.imag(rest) ** 2, axis=0)

    def of_scale(self, sigma: Float[np.ndarray, " n_y"]) -> Complex[np.ndarray, "n_omega n_y n_r"]:
        """What a sensor that reads twice too much does to the motion, per unit of scale."""
        inverse, _, weight = self._weighted(sigma)
        gain = self.back @ inverse @ (self.q.conj() * weight[:, None]).transpose(0, 2, 1)
        return (gain * self.z[:, None, :]).transpose(0, 2, 1)

    def scale_disagreement(
        self, sigma: Float[np.ndarray, " n_y"], colour: Float[np.ndarray, " n_omega"]
    ) -> float:
        """Standard deviation of the sensors' scale factors that their residuals ask for.

        Notes
        -----
        A scale factor 1 + e of a sensor leaves e times its own signal, less what passes for
        motion; one common to all sensors leaves nothing. All are taken as equally uncertain;
        the variance beyond that of noise is that of Mandel and Paule (1970), and one standard
        deviation of a chi-square of as many directions above it, since few tell it. The
        variance of noise is at least how the lines scatter, which differ where something
        else than a scale factor is wrong.
        """
        inverse, x, weight = self._weighted(sigma)
        shape = np.sqrt(weight / colour[:, None])
        fitted = np.matmul(self.q, x)[:, :, 0]
        residual = (self.z - fitted) * shape
        seen = self.q @ inverse @ (self.q.conj() * weight[:, None]).transpose(0, 2, 1)
        left = (np.eye(sigma.size) - seen) * (fitted[:, None, :] * shape[:, :, None])
        score = np.real(np.sum(left.conj() * residual[:, :, None], axis=1))
        left = left.reshape(-1, sigma.size)
        normal = np.real(left.conj().T @ left)
        told, axes = np.linalg.eigh(normal)
        some = told > _UNUSUAL * told[-1]
        each = (score @ axes)[:, some] / told[some]
        count = float(np.count_nonzero(some))
        variance = np.maximum(0.5 / told[some], np.sum(each**2, axis=0))
        excess = excess_variance(variance, each.sum(axis=0) ** 2, count)
        return float(np.sqrt(excess * (1.0 + np.sqrt(2.0 / count))))

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
