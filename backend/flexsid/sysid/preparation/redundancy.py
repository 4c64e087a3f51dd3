"""Time skews and scale factors from the redundancy of the sensors.

All sensors measure the same motion through known rows P(s): gyro and attitude by
kinematics, accelerometers and strain gauges by the mode shapes. Residuals outside the span
of the motion are therefore faults of single channels, among them a delay
exp(-j omega tau) and a scale factor. Both follow by variable projection.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Complex, Float, Int
from scipy import linalg

from flexsid.errors import NotIdentifiable
from flexsid.sysid.estimation.reconstruction import reconstruct_motion
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.signals import FrequencyData

_ROUNDS = 4  # of new weights
_START_NOISE = 0.05  # of the rms of each output, before its noise is estimated
_WEIGHTS_CONVERGED = 0.05  # relative change of the noise that ends the rounds
_LARGEST_CONDITION = 1e12  # of the scaled normal matrix: above it, delays are not identifiable
_STEPS = 40  # of Levenberg-Marquardt, at most
_STEP_TOLERANCE = 1e-3  # of a standard error: smaller steps end the iteration
_ROUGH_TOLERANCE = 0.1  # of a standard error, until the weights have converged
_LARGEST_STEP_RAD = 0.3  # at the highest frequency: beyond that a delay may slip by a whole turn
_NEIGHBOURS = 8  # frequencies whose residuals are correlated by an unmodelled mode
_MOST_FREQUENCIES = 160  # enough to resolve delays of all sensors
_LEAST_SHARE = 0.1  # of signal in the information on a delay: a lower share is not significant
_LARGEST_LEVERAGE = 0.5  # of a sensor in its own reconstruction, to be checked by others


@dataclass(frozen=True, slots=True)
class SensorFaults:
    """Delay of every output beyond its instrument's [s], and scale factors [1].

    ``delay_s`` counts from the reference output, whose own is zero: a delay common to all
    turns the motion and is not identifiable. ``scale`` is recorded over true, exactly one with no
    standard error where it was taken as known. ``noise`` is the standard deviation of each
    output's spectral noise [output unit * s].
    """

    names: tuple[str, ...]
    reference: str
    delay_s: Float[np.ndarray, " n_y"]
    delay_std: Float[np.ndarray, " n_y"]
    scale: Float[np.ndarray, " n_y"]
    scale_std: Float[np.ndarray, " n_y"]
    noise: Float[np.ndarray, " n_y"]
    band_hz: tuple[float, float]


def estimate_sensor_faults(
    model: AeroelasticModel,
    outputs: FrequencyData,
    instruments: Complex[np.ndarray, "n_omega n_y"],
    reference: str | None = None,
    scaled: Sequence[str] = (),
    least: Float[np.ndarray, " n_y"] | None = None,
    near: SensorFaults | None = None,
) -> SensorFaults:
    """Estimate delays and scale factors on which all sensors agree about the motion.

    Parameters
    ----------
    model
        Gives the sensor rows; with more modes the band may reach higher.
    outputs
        Spectra as recorded, at frequencies well above the noise. [output unit * s]
    instruments
        Recorded over true response, of the delays that are known. [1]
    reference
        Output that the others are timed against; the first by default.
    scaled
        Outputs whose scale factors are free; the others define the scale.
    least
        Noise that every output has at least; without it a sensor may be fitted exactly.
        [output unit * s]
    near
        Initial faults, of the same outputs; none by default.

    Raises
    ------
    NotIdentifiable
        If there are no more sensors than motions, or a delay or a scale factor is not
        identifiable.

    Notes
    -----
    Standard errors are the larger of two: for white residuals, and for residuals that are
    correlated between neighbouring frequencies, as those of an unmodelled mode.
    Source: methods of separable least squares (Kaufman, BIT 15, 1975).
    """
    names = model.outputs
    if len(names) <= 2 + len(model.modes.numbers):
        raise NotIdentifiable(
            f"{len(names)} outputs measure {2 + len(model.modes.numbers)} motions; skews need more "
            "sensors than motions",
            code="no-redundancy",
        )
    z = outputs.pick(names).values
    some = select_strong_frequencies(z)
    omega, z = outputs.omega[some], z[some]
    fixed = names.index(names[0] if reference is None else reference)
    free = FaultParameters(
        np.array([k for k in range(len(names)) if k != fixed]),
        np.array([names.index(name) for name in scaled], dtype=int),
    )
    problem = RedundantSensors(
        omega, z, instruments[some][:, :, None] * model.sensors.response(omega)
    )
    level = np.sqrt(np.mean(np.abs(z) ** 2, axis=0))
    if not level.all():
        silent = names[int(np.argmin(level))]
        raise NotIdentifiable(
            f"'{silent}' never moves; exclude it", code="silent-channel", channel=silent
        )
    sigma = _START_NOISE * level if near is None else near.noise
    value = np.zeros(free.count) if near is None else free.gather(near.delay_s, near.scale)
    for _ in range(_ROUNDS):
        value = _converge(problem, free, value, sigma, _ROUGH_TOLERANCE)
        delay, gain = free.spread(value, len(names))
        seen = instruments[some] * np.exp(-1j * omega[:, None] * delay + gain)
        data = FrequencyData(omega, z, names)
        update = reconstruct_motion(model, data, seen, guess=sigma).noise
        if least is not None:
            update = np.maximum(update, least)
        if np.max(np.abs(np.log(update / sigma))) < _WEIGHTS_CONVERGED:
            break
        sigma = update
    value = _converge(problem, free, value, sigma)
    std = np.sqrt(_variance(problem, free, value, sigma, names))
    delay, gain = free.spread(value, len(names))
    delay_std, gain_std = free.spread(std, len(names))
    return SensorFaults(
        names=names,
        reference=names[fixed],
        delay_s=delay,
        delay_std=delay_std,
        scale=np.exp(gain),
        scale_std=np.exp(gain) * gain_std,
        noise=sigma,
        band_hz=(float(omega[0] / 2.0 / np.pi), float(omega[-1] / 2.0 / np.pi)),
    )


def select_strong_frequencies(
    values: Complex[np.ndarray, "n_omega n_channels"],
) -> Int[np.ndarray, " n_some"]:
    """Select frequencies over the whole band, of neighbours the one with the largest power.

    Without a known excitation, most frequencies of a record are noise.
    """
    power = np.abs(values) ** 2
    total = np.sum(power / np.maximum(power.mean(axis=0), 1e-300), axis=1)
    blocks = np.array_split(np.arange(total.size), min(total.size, _MOST_FREQUENCIES))
    return np.array([block[np.argmax(total[block])] for block in blocks])


@dataclass(frozen=True, slots=True)
class FaultParameters:
    """Free parameters: channels of delays, then channels of log scale factors."""

    delays: np.ndarray
    gains: np.ndarray

    @property
    def count(self) -> int:
        """Number of delays and log gains."""
        return self.delays.size + self.gains.size

    @property
    def channels(self) -> np.ndarray:
        """Channel of each."""
        return np.concatenate([self.delays, self.gains])

    def factor(self, omega: np.ndarray) -> np.ndarray:
        """Derivative of each row over itself, (n_omega, n_free)."""
        factor = np.ones((omega.size, self.count), dtype=complex)
        factor[:, : self.delays.size] = -1j * omega[:, None]
        return factor

    def gather(self, delay: np.ndarray, scale: np.ndarray) -> np.ndarray:
        """The other way round from ``spread``, of scale factors."""
        return np.concatenate([delay[self.delays], np.log(scale[self.gains])])

    def spread(self, value: np.ndarray, n_y: int) -> tuple[np.ndarray, np.ndarray]:
        """Delays and log gains of all channels, zero where they are not free."""
        delay, gain = np.zeros(n_y), np.zeros(n_y)
        delay[self.delays] = value[: self.delays.size]
        gain[self.gains] = value[self.delays.size :]
        return delay, gain


@dataclass(frozen=True, slots=True)
class RedundantSensors:
    """Frequencies, recorded spectra and sensor rows with their instruments."""

    omega: Float[np.ndarray, " n_omega"]
    z: Complex[np.ndarray, "n_omega n_y"]
    rows: Complex[np.ndarray, "n_omega n_y n_r"]

    def project(
        self, free: FaultParameters, value: np.ndarray, sigma: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Residual (n_omega, n_y), its slopes (n_omega, n_free) and the basis of all motions."""
        delay, gain = free.spread(value, sigma.size)
        turned = self.rows * np.exp(-1j * self.omega[:, None] * delay + gain)[:, :, None]
        weighted = turned / sigma[:, None]
        size = np.linalg.norm(weighted, axis=1)
        q, _ = np.linalg.qr(weighted / np.where(size > 0, size, 1.0)[:, None, :])
        z = self.z / sigma
        seen = np.matmul(q, np.matmul(q.conj().transpose(0, 2, 1), z[:, :, None]))[:, :, 0]
        return z - seen, free.factor(self.omega) * seen[:, free.channels], q

    def normal(
        self, free: FaultParameters, slope: np.ndarray, q: np.ndarray, residual: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Normal matrix and gradient of half the squares, motions projected out (Kaufman)."""
        n = slope.shape[1]
        inside = (q[:, free.channels].conj() * slope[:, :, None]).transpose(0, 2, 1).reshape(-1, n)
        same = free.channels[:, None] == free.channels
        normal = np.real(slope.conj().T @ slope) * same - np.real(inside.conj().T @ inside)
        return normal, -np.sum(np.real(slope.conj() * residual[:, free.channels]), axis=0)

    def of_noise(self, free: FaultParameters, q: np.ndarray) -> Float[np.ndarray, "n_free n_free"]:
        """Mean contribution of unit noise of all sensors to the normal matrix."""
        rows = q[:, free.channels]
        shared = np.matmul(rows, rows.conj().transpose(0, 2, 1))
        same = free.channels[:, None] == free.channels
        power = shared.transpose(0, 2, 1) * (same - shared)
        factor = free.factor(self.omega)
        return np.real(np.einsum("kp,kpr,kr->pr", factor.conj(), power, factor))


def _converge(
    problem: RedundantSensors,
    free: FaultParameters,
    start: np.ndarray,
    sigma: np.ndarray,
    small: float = _STEP_TOLERANCE,
) -> Float[np.ndarray, " n_free"]:
    """Levenberg-Marquardt in delays and log gains alone."""
    value, damping = start, 1e-3
    largest = np.full(free.count, _LARGEST_STEP_RAD)
    largest[: free.delays.size] /= problem.omega[-1]
    residual, slope, q = problem.project(free, value, sigma)
    cost = float(np.sum(np.abs(residual) ** 2))
    normal, gradient = problem.normal(free, slope, q, residual)
    for _ in range(_STEPS):
        diagonal = np.diag(normal) + 1e-12 * np.trace(normal)
        step = np.linalg.solve(normal + damping * np.diag(diagonal), -gradient)
        # Clipped one by one, so that a channel of little information does not limit the others.
        step = np.clip(step, -largest, largest)
        trial = problem.project(free, value + step, sigma)
        lower = float(np.sum(np.abs(trial[0]) ** 2))
        if lower < cost:
            value, cost = value + step, lower
            normal, gradient = problem.normal(free, *trial[1:], trial[0])
            damping = max(damping / 10.0, 1e-12)
            if np.max(np.abs(step) * np.sqrt(np.maximum(diagonal, 0.0))) < small:
                break
        else:
            damping *= 10.0
            if damping > 1e6:
                break
    return value


def _variance(
    problem: RedundantSensors,
    free: FaultParameters,
    value: np.ndarray,
    sigma: np.ndarray,
    names: tuple[str, ...],
) -> Float[np.ndarray, " n_free"]:
    """Variance of each delay and log gain.

    The motion is reconstructed from noisy sensors, and their noise turned by a delay appears
    as information. It is subtracted from the information on the delays, and retained in
    their scatter.
    """
    residual, slope, q = problem.project(free, value, sigma)
    normal, _ = problem.normal(free, slope, q, residual)
    size = np.sqrt(np.maximum(np.diag(normal), 0.0))
    if not size.all() or np.linalg.cond(normal / np.outer(size, size)) > _LARGEST_CONDITION:
        weak = names[free.channels[int(np.argmin(size))]]
        raise NotIdentifiable(
            f"the delay or scale factor of '{weak}' is not identifiable from the other sensors",
            code="no-redundancy",
            channel=weak,
        )
    signal = normal - problem.of_noise(free, q)
    share, axes = linalg.eigh(signal / np.outer(size, size), normal / np.outer(size, size))
    weighted = axes / np.maximum(share, _LEAST_SHARE) / size[:, None]
    bread = weighted @ (axes / size[:, None]).T
    score = np.real(slope.conj() * residual[:, free.channels])
    meat = score.T @ score
    for lag in range(1, min(_NEIGHBOURS, score.shape[0] - 1) + 1):
        shared = (1.0 - lag / (_NEIGHBOURS + 1.0)) * (score[lag:].T @ score[:-lag])
        meat += shared + shared.T
    # The whitened residuals have unit variance at each frequency by the choice of sigma.
    return np.maximum(0.5 * np.sum(weighted**2, axis=1), np.diag(bread @ meat @ bread))


def widen_standard_errors(faults: SensorFaults, others: Sequence[SensorFaults]) -> SensorFaults:
    """Widen standard errors by the differences to estimates with other sets of modes.

    The part of a difference within their own larger errors is not counted again.
    """
    delay, scale = faults.delay_std**2, faults.scale_std**2
    if others:
        delay = delay + np.max(
            [_excess_difference(faults.delay_s, delay, o.delay_s, o.delay_std**2) for o in others],
            axis=0,
        )
        scale = scale + np.max(
            [_excess_difference(faults.scale, scale, o.scale, o.scale_std**2) for o in others],
            axis=0,
        )
    return replace(faults, delay_std=np.sqrt(delay), scale_std=np.sqrt(scale))


def _excess_difference(
    one: np.ndarray, variance: np.ndarray, other: np.ndarray, its: np.ndarray
) -> np.ndarray:
    """Squared difference of two estimates in excess of the difference of their variances."""
    known = np.isfinite(its) & np.isfinite(variance)
    more = np.where(known, its, 0.0) - np.where(known, variance, 0.0)
    return np.where(known, np.maximum((other - one) ** 2 - np.maximum(more, 0.0), 0.0), 0.0)


def compute_sensor_coherence(
    model: AeroelasticModel,
    outputs: FrequencyData,
    instruments: Complex[np.ndarray, "n_omega n_y"],
    noise: Float[np.ndarray, " n_y"],
) -> Float[np.ndarray, " n_y"]:
    """Compute the coherence of each sensor with its prediction from all others.

    Parameters
    ----------
    model, outputs, instruments
        As for ``estimate_sensor_faults``.
    noise
        Standard deviation of each output's spectral noise. [output unit * s]

    Returns
    -------
    array
        From 0 to 1; NaN where a sensor dominates its own reconstruction, so that the others
        do not check it.
    """
    z = outputs.pick(model.outputs).values / noise
    rows = instruments[:, :, None] * model.sensors.response(outputs.omega) / noise[:, None]
    size = np.linalg.norm(rows, axis=1)
    q, _ = np.linalg.qr(rows / np.where(size > 0, size, 1.0)[:, None, :])
    seen = np.matmul(q, np.matmul(q.conj().transpose(0, 2, 1), z[:, :, None]))[:, :, 0]
    own = np.sum(np.abs(q) ** 2, axis=2)
    others = z - (z - seen) / np.maximum(1.0 - own, 1e-9)
    checked = own < _LARGEST_LEVERAGE
    cross = np.abs(np.sum(np.where(checked, z.conj() * others, 0.0), axis=0)) ** 2
    power = np.sum(np.where(checked, np.abs(z) ** 2, 0.0), axis=0)
    power = power * np.sum(np.where(checked, np.abs(others) ** 2, 0.0), axis=0)
    return np.where(power > 0, cross / np.where(power > 0, power, 1.0), np.nan)
