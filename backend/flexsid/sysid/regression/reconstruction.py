"""Rigid and modal motion from redundant sensors, frequency by frequency (Sec. VIII.C).

Every output is a known combination P(s) r of the motion r of rigid body and modes, so r
follows by weighted least squares at each frequency. Because P contains the forces as
accelerations, the kinematic relation between normal acceleration, alpha and q (lateral
acceleration, beta, p, r and phi) holds exactly; equation error is then free of the bias due to
noise of its regressors.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Complex, Float, Int

from flexsid.errors import NotIdentifiable
from flexsid.sysid.estimation.noise import smooth_density
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.regression.least_squares import estimate_excess_variance
from flexsid.sysid.signals import FrequencyData, check_finite, check_signal
from flexsid.sysid.spectra.residual_spectrum import estimate_scatter

_LARGEST_CONDITION = 1e8  # of the scaled sensor rows: motions are not observable above
_ITERATIONS = 40
_CONVERGED = 0.02  # largest change of a log variance
_LARGEST_STEP = 1.5  # of a log variance
_PRIOR_WEIGHT = 0.05  # information of the prior on log variances, per frequency of data
_PRIOR_STD = 1.5  # standard deviation of a log variance known from the prior only: factor 2
_RESOLVED = 0.5  # share of a sensor's log variance from the data; assumed below
_ENOUGH_FREQUENCIES = 64  # for the information on the noise
_UNOBSERVED = 1e-6  # of the largest eigenvalue: directions of scale factors without residuals
_USUAL_LEVEL = 0.05  # noise over signal where nothing else is known
_RANK_TOLERANCE = 1e-6  # of the largest singular value of the scaled sensor rows


@dataclass(frozen=True, slots=True)
class ReconstructedMotion:
    """Motion r of rigid body and modes at every frequency, with the covariance of its errors.

    Where the sensors' noise was estimated, ``colour`` is its variance at each frequency over
    the mean, ``relative_std`` the relative standard deviation of all variances, and
    ``assumed`` names the sensors whose noise is not identifiable: its ratio to that of the
    others is the given or usual one. ``disagreement`` is the change of the motion by one
    standard deviation ``scale_std`` of each sensor's scale factor.
    """

    omega: Float[np.ndarray, " n_omega"]
    values: Complex[np.ndarray, "n_omega n_r"]
    covariance: Complex[np.ndarray, "n_omega n_r n_r"]
    noise: Float[np.ndarray, " n_y"]
    colour: Float[np.ndarray, " n_omega"] | None = None
    relative_std: float = 0.0
    assumed: tuple[str, ...] = ()
    disagreement: Complex[np.ndarray, "n_omega n_y n_r"] | None = None
    scale_std: float = 0.0

    def select_motions(self, n_r: int) -> ReconstructedMotion:
        """Return the first motions only: those of the rigid body, and of the first modes."""
        return replace(
            self,
            values=self.values[:, :n_r],
            covariance=self.covariance[:, :n_r, :n_r],
            disagreement=None if self.disagreement is None else self.disagreement[:, :, :n_r],
        )

    def with_coloured_errors(self) -> ReconstructedMotion:
        """Return the same with the error covariance scaled by ``colour`` at each frequency."""
        if self.colour is None:
            return self
        return replace(self, covariance=self.covariance * self.colour[:, None, None], colour=None)


def reconstruct_motion(
    model: AeroelasticModel,
    outputs: FrequencyData,
    instruments: Complex[np.ndarray, "n_omega n_y"],
    noise: Float[np.ndarray, " n_y"] | None = None,
    guess: Float[np.ndarray, " n_y"] | None = None,
    inputs: FrequencyData | None = None,
) -> ReconstructedMotion:
    """Estimate rigid and modal motion at every frequency.

    Parameters
    ----------
    model
        Model with the sensor rows.
    outputs
        Spectra as recorded. [output unit * s]
    instruments
        Recorded over true response. [1]
    noise
        Standard deviation of each output's spectral noise; estimated from the
        redundancy of the sensors when not known. [output unit * s]
    guess
        Prior of the noise up to a common factor, and its starting value; NaN where it is
        unknown. [output unit * s]
    inputs
        Deflections, to complete the guess; see ``complete_noise_guess``. [rad s]

    Raises
    ------
    BadInput
        If the noise is not known and an output has no signal, or the inputs are not finite.
    NotIdentifiable
        If the motions are not observable with these sensors.

    Notes
    -----
    Departure: the paper reconstructs in the time domain and fuses with a Kalman
    filter; in the frequency domain, etadot = s eta makes that unnecessary.

    The log variances of the sensors' noise maximise the restricted likelihood of the
    redundancy residuals (Patterson and Thompson, Biometrika 58, 1971), with a normal prior
    on their difference from the guess, as much information as one frequency in twenty.
    Without it the estimate for few sensors is degenerate: one sensor without noise, another
    with nothing but noise.
    """
    z = outputs.pick(model.outputs).values
    if noise is None:
        check_signal(z, model.outputs)  # a sensor without signal would also seem to have no noise
        if inputs is not None:
            check_finite(inputs.values, inputs.names)
        sigma = complete_noise_guess(z, guess, None if inputs is None else inputs.values)
    else:
        sigma = np.asarray(noise, dtype=float)
    rows = SensorEquations(
        outputs.omega,
        instruments[:, :, None] * model.sensors.response(outputs.omega),
        z,
        model.outputs,
        model.motions,
    )
    return solve_sensor_equations(rows, sigma, is_known=noise is not None)


@dataclass(frozen=True, slots=True)
class SensorEquations:
    """Equations z = P r of the sensors, with the names of outputs and motions."""

    omega: Float[np.ndarray, " n_omega"]
    P: Complex[np.ndarray, "n_omega n_y n_r"]
    z: Complex[np.ndarray, "n_omega n_y"]
    outputs: tuple[str, ...]
    motions: tuple[str, ...]


def solve_sensor_equations(
    equations: SensorEquations, sigma: Float[np.ndarray, " n_y"], *, is_known: bool = False
) -> ReconstructedMotion:
    """Solve for the motion with known noise, or the prior of it; see ``reconstruct_motion``."""
    omega, P, z = equations.omega, equations.P, equations.z
    n_y, n_r = P.shape[1:]
    if n_y < n_r:
        raise NotIdentifiable(
            f"{n_y} outputs cannot resolve {n_r} motions ({', '.join(equations.motions)}); use "
            "more sensors or fewer modes",
            outputs=n_y,
            motions=n_r,
        )
    sensors = _Sensors(equations.motions, P, z, sigma)
    if is_known:
        return ReconstructedMotion(omega, *sensors.solve(sigma), sigma)
    if n_y == n_r:
        motion = ReconstructedMotion(omega, *sensors.solve(sigma), sigma)
        return replace(motion, relative_std=_PRIOR_STD, assumed=equations.outputs)
    usual = 2.0 * np.log(sigma)
    log_variance = usual
    colour = np.ones(omega.size)
    for _ in range(_ITERATIONS):
        step, colour = sensors.compute_variance_step(log_variance, usual, colour)
        log_variance = log_variance + step
        if np.max(np.abs(step)) < _CONVERGED:
            break
    sigma = np.exp(0.5 * log_variance)
    information, contrast = sensors.compute_information(sigma), np.eye(n_y) - 1.0 / n_y
    share = np.diag(np.linalg.solve(information + _PRIOR_WEIGHT * contrast, information))
    covariance = np.linalg.inv(omega.size * information + contrast / _PRIOR_STD**2)
    scale_std = sensors.estimate_scale_std(sigma, colour)
    return ReconstructedMotion(
        omega,
        *sensors.solve(sigma),
        sigma,
        colour,
        relative_std=float(np.sqrt(np.mean(np.diag(covariance)))),
        assumed=tuple(equations.outputs[k] for k in np.flatnonzero(share < _RESOLVED)),
        disagreement=scale_std * sensors.compute_scale_sensitivity(sigma)
        if scale_std > 0.0
        else None,
        scale_std=scale_std,
    )


def compute_observability(
    model: AeroelasticModel,
    omega: Float[np.ndarray, " n_omega"],
    instruments: Complex[np.ndarray, "n_omega n_y"],
    noise: Float[np.ndarray, " n_y"],
) -> tuple[Int[np.ndarray, " n_omega"], Float[np.ndarray, " n_omega"]]:
    """Compute the number of observable motions at each frequency, and the condition number.

    Parameters
    ----------
    model
        Model with the sensor rows.
    omega
        Frequencies. [rad/s]
    instruments
        Recorded over true response. [1]
    noise
        Standard deviation of each output's spectral noise. [output unit * s]

    Returns
    -------
    rank, condition
        Of the sensor rows over their noise, with columns of unit length; singular values
        below a millionth of the largest do not count.
    """
    rows = instruments[:, :, None] * model.sensors.response(omega) / noise[:, None]
    size = np.linalg.norm(rows, axis=1)
    values = np.linalg.svd(rows / np.where(size > 0, size, 1.0)[:, None, :], compute_uv=False)
    rank = np.sum(values > _RANK_TOLERANCE * values[:, :1], axis=1)
    smallest = np.maximum(values[:, -1], np.finfo(float).tiny)
    return rank, np.where(rank == rows.shape[2], values[:, 0] / smallest, np.inf)


def complete_noise_guess(
    z: Complex[np.ndarray, "n_omega n_y"],
    guess: Float[np.ndarray, " n_y"] | None = None,
    inputs: Complex[np.ndarray, "n_omega n_u"] | None = None,
) -> Float[np.ndarray, " n_y"]:
    """Complete the guess of the standard deviations of the outputs' spectral noise.

    Parameters
    ----------
    z
        Spectra as recorded. [output unit * s]
    guess
        NaN where it is unknown. [output unit * s]
    inputs
        Deflections. Noise is in the ratio of the scatter of the outputs about smooth responses
        to them; without inputs, or where these share their frequencies, it is the same share of
        every output's signal. [rad s]
    """
    level = None if inputs is None else estimate_scatter(inputs, z)
    if level is None or not level.all():
        level = _USUAL_LEVEL * np.sqrt(np.mean(np.abs(z) ** 2, axis=0))
    if guess is None:
        return level
    known = np.isfinite(guess) & (guess > 0.0)
    factor = np.median(guess[known] / level[known]) if known.any() else 1.0
    return np.where(known, guess, factor * level)


class _Sensors:
    """Sensor rows of all frequencies, orthogonalised once for a first guess of the noise.

    In the orthonormal columns the normal equations of any other weighting are well
    conditioned and cost one small solve per frequency.
    """

    def __init__(
        self,
        names: tuple[str, ...],
        P: Complex[np.ndarray, "n_omega n_y n_r"],
        z: Complex[np.ndarray, "n_omega n_y"],
        sigma: Float[np.ndarray, " n_y"],
    ) -> None:
        rows = P / sigma[:, None]
        size = np.linalg.norm(rows, axis=1)  # (n_omega, n_r): columns differ by 1e3
        blind = np.flatnonzero((size == 0).any(axis=0))
        if blind.size:
            raise NotIdentifiable(
                f"no sensor in use measures {names[blind[0]]}; add one that does",
                code="unobservable",
                motion=names[blind[0]],
            )
        self.q, r = np.linalg.qr(rows / size[:, None, :])
        pivots = np.abs(np.einsum("kii->ki", r))
        if not pivots.all() or _bound_condition(r) > _LARGEST_CONDITION:
            raise NotIdentifiable(
                f"the motions {', '.join(names)} are not observable with the sensors in use; use "
                "more sensors or fewer modes",
                code="unobservable",
            )
        self.back = np.linalg.inv(r) / size[:, :, None]
        self.sigma = sigma
        self.z = z / sigma

    def solve(
        self, sigma: Float[np.ndarray, " n_y"]
    ) -> tuple[Complex[np.ndarray, "n_omega n_r"], Complex[np.ndarray, "n_omega n_r n_r"]]:
        """Solve for the motion and its covariance at these noise levels."""
        inverse, x, _ = self._solve_weighted(sigma)
        motion = np.matmul(self.back, x)[:, :, 0]
        return motion, self.back @ inverse @ self.back.conj().transpose(0, 2, 1)

    def compute_variance_step(
        self,
        log_variance: Float[np.ndarray, " n_y"],
        usual: Float[np.ndarray, " n_y"],
        colour: Float[np.ndarray, " n_omega"],
    ) -> tuple[Float[np.ndarray, " n_y"], Float[np.ndarray, " n_omega"]]:
        """Compute a scoring step of the log variances, and the colour of the noise."""
        sigma = np.exp(0.5 * log_variance)
        inverse, x, weight = self._solve_weighted(sigma)
        residual = self.z - np.matmul(self.q, x)[:, :, 0]
        power = (np.real(residual) ** 2 + np.imag(residual) ** 2) * weight
        n_omega, n_y, n_r = self.q.shape
        level = np.sqrt(power.sum(axis=1) / (n_y - n_r))
        one_group = np.zeros(n_omega, dtype=int)
        smooth = smooth_density(level[:, None].astype(complex), one_group, 1)
        colour = np.real(smooth.blocks[smooth.block, 0, 0])
        colour = np.maximum(colour / colour.mean(), np.finfo(float).tiny)
        score = (1.0 / colour) @ power / n_omega - self._compute_freedom(inverse, weight)
        prior = _PRIOR_WEIGHT * (np.eye(n_y) - 1.0 / n_y)
        curvature = self.compute_information(sigma) + np.diag(np.maximum(score, 0.0)) + prior
        step = np.linalg.solve(curvature, score - prior @ (log_variance - usual))
        return np.clip(step, -_LARGEST_STEP, _LARGEST_STEP), colour

    def compute_information(self, sigma: Float[np.ndarray, " n_y"]) -> Float[np.ndarray, "n_y n_y"]:
        """Compute the mean information of a frequency on the sensors' log variances."""
        some = slice(None, None, max(1, len(self.q) // _ENOUGH_FREQUENCIES))
        q, _ = np.linalg.qr(self.q[some] * (self.sigma / sigma)[:, None])
        rest = np.eye(sigma.size) - q @ q.conj().transpose(0, 2, 1)
        return np.mean(np.real(rest) ** 2 + np.imag(rest) ** 2, axis=0)

    def compute_scale_sensitivity(
        self, sigma: Float[np.ndarray, " n_y"]
    ) -> Complex[np.ndarray, "n_omega n_y n_r"]:
        """Compute the change of the motion per unit change of each sensor's scale factor."""
        inverse, _, weight = self._solve_weighted(sigma)
        gain = self.back @ inverse @ (self.q.conj() * weight[:, None]).transpose(0, 2, 1)
        return (gain * self.z[:, None, :]).transpose(0, 2, 1)

    def estimate_scale_std(
        self, sigma: Float[np.ndarray, " n_y"], colour: Float[np.ndarray, " n_omega"]
    ) -> float:
        """Estimate the standard deviation of the sensors' scale factors from the residuals.

        Notes
        -----
        A scale factor 1 + e of a sensor leaves e times its own signal in the residuals, less
        the part that is explained as motion; a factor common to all sensors leaves none. All
        factors have the same standard deviation. The variance in excess of noise is that of
        Mandel and Paule (1970), increased by one standard deviation of a chi-square variable
        with as many degrees of freedom as directions. The variance of noise is at least the
        sample variance over the frequencies, which is larger for errors other than scale.
        """
        inverse, x, weight = self._solve_weighted(sigma)
        shape = np.sqrt(weight / colour[:, None])
        fitted = np.matmul(self.q, x)[:, :, 0]
        residual = (self.z - fitted) * shape
        seen = self.q @ inverse @ (self.q.conj() * weight[:, None]).transpose(0, 2, 1)
        left = (np.eye(sigma.size) - seen) * (fitted[:, None, :] * shape[:, :, None])
        score = np.real(np.sum(left.conj() * residual[:, :, None], axis=1))
        left = left.reshape(-1, sigma.size)
        normal = np.real(left.conj().T @ left)
        information, axes = np.linalg.eigh(normal)
        some = information > _UNOBSERVED * information[-1]
        each = (score @ axes)[:, some] / information[some]
        count = float(np.count_nonzero(some))
        variance = np.maximum(0.5 / information[some], np.sum(each**2, axis=0))
        excess = estimate_excess_variance(variance, each.sum(axis=0) ** 2, count)
        return float(np.sqrt(excess * (1.0 + np.sqrt(2.0 / count))))

    def _compute_freedom(
        self, inverse: Complex[np.ndarray, "n_omega n_r n_r"], weight: Float[np.ndarray, " n_y"]
    ) -> Float[np.ndarray, " n_y"]:
        seen = np.real(np.sum(np.matmul(self.q, inverse) * self.q.conj(), axis=(0, 2)))
        return 1.0 - weight * seen / len(self.q)

    def _solve_weighted(
        self, sigma: Float[np.ndarray, " n_y"]
    ) -> tuple[np.ndarray, np.ndarray, Float[np.ndarray, " n_y"]]:
        """Compute inverse normal matrix, solution in the orthonormal columns, and weights."""
        weight = (self.sigma / sigma) ** 2
        left = (self.q.conj() * weight[:, None]).transpose(0, 2, 1)
        inverse = np.linalg.inv(np.matmul(left, self.q))
        return inverse, np.matmul(inverse, np.matmul(left, self.z[:, :, None])), weight


def _bound_condition(r: Complex[np.ndarray, "n_omega n_r n_r"]) -> float:
    """Compute an upper bound of the condition number over all frequencies."""
    size = np.linalg.norm(r, axis=(1, 2)) * np.linalg.norm(np.linalg.inv(r), axis=(1, 2))
    return float(size.max())
