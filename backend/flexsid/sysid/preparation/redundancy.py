"""Time skews, scale factors and biases from redundancy, kinematics and the surfaces' effect.

All sensors measure the same motion through known rows P(s): gyro and attitude by
kinematics, accelerometers and strain gauges by the mode shapes. Residuals outside the span
of the motion are therefore faults of single channels, among them a delay
exp(-j omega tau) and a scale factor. Both follow by variable projection.

Scale factors come from the redundancy of all sensors (``redundancy``); a bias
follows from averages, which do not depend on the dynamics.

Sensors have redundancy; surfaces have none. But the coefficients of the reconstructed motion
are sums over motion and surfaces with real derivatives (Eq. 23). A surface that was recorded
late by tau gives its rate a derivative of tau times its own, with one tau for all coefficients.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy
from jaxtyping import Complex, Float, Int

from flexsid.errors import NotIdentifiable
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.regression.equation_error import (
    MotionNoise,
    build_regressors,
    compute_aerodynamic_coefficients,
)
from flexsid.sysid.regression.least_squares import ErrorsInVariables, regress
from flexsid.sysid.regression.reconstruction import ReconstructedMotion, reconstruct_motion
from flexsid.sysid.signals import FrequencyData

# --- Time skews and scale factors from the redundancy of the sensors ------------------------------

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
    Source: methods of separable least squares (Kaufman, BIT 15, 1975, doi:10.1007/BF01932995).
    """
    names = model.outputs
    fixed = names[0] if reference is None else reference
    timed = [name for name in names if name != fixed]
    sensors, some = select_sensors(model, outputs, instruments, timed, scaled)
    sigma, value = _START_NOISE * sensors.level, np.zeros(sensors.channels.size)
    if near is not None:
        sigma = near.noise
        value = np.concatenate([near.delay_s[sensors.delays], np.log(near.scale[sensors.gains])])
    data = FrequencyData(sensors.omega, sensors.z, names)
    for _ in range(_ROUNDS):
        value = _converge(sensors, value, sigma, _ROUGH_TOLERANCE)
        delay, gain = sensors.spread(value)
        seen = instruments[some] * np.exp(-1j * sensors.omega[:, None] * delay + gain)
        update = reconstruct_motion(model, data, seen, guess=sigma).noise
        if least is not None:
            update = np.maximum(update, least)
        if np.max(np.abs(np.log(update / sigma))) < _WEIGHTS_CONVERGED:
            break
        sigma = update
    value = _converge(sensors, value, sigma, _STEP_TOLERANCE)
    std = np.sqrt(_estimate_variance(sensors, value, sigma))
    return sensors.describe(value, std, sigma, fixed)


def select_sensors(
    model: AeroelasticModel,
    outputs: FrequencyData,
    instruments: Complex[np.ndarray, "n_omega n_y"],
    timed: Sequence[str],
    scaled: Sequence[str],
) -> tuple[RedundantSensors, Int[np.ndarray, " n_some"]]:
    """Select spectra and rows of all sensors at the strong frequencies, whose indices are returned.

    The delays of the ``timed`` outputs and the scale factors of the ``scaled`` ones are free.

    Raises
    ------
    NotIdentifiable
        If there are no more sensors than motions, or one never moves.
    """
    names = model.outputs
    z = outputs.pick(names).values
    some = select_strong_frequencies(z)
    omega = outputs.omega[some]
    rows = instruments[some][:, :, None] * model.sensors.response(omega)
    n_y, n_r = rows.shape[1:]
    if n_y <= n_r:
        raise NotIdentifiable(
            f"{n_y} outputs measure {n_r} motions; skews need more sensors than motions",
            code="no-redundancy",
        )
    delays, gains = (
        np.array([names.index(name) for name in own], dtype=int) for own in (timed, scaled)
    )
    sensors = RedundantSensors(names, omega, z[some], rows, delays, gains)
    if not sensors.level.all():
        silent = names[int(np.argmin(sensors.level))]
        raise NotIdentifiable(
            f"'{silent}' never moves; exclude it", code="silent-channel", channel=silent
        )
    return sensors, some


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
class RedundantSensors:
    """Recorded spectra, sensor rows with their instruments, and the faults that are free.

    ``delays`` and ``gains`` are the channels of free delays [s] and log scale factors; values
    of both together have the delays first.
    """

    names: tuple[str, ...]
    omega: Float[np.ndarray, " n_omega"]
    z: Complex[np.ndarray, "n_omega n_y"]
    rows: Complex[np.ndarray, "n_omega n_y n_r"]
    delays: Int[np.ndarray, " n_delays"]
    gains: Int[np.ndarray, " n_gains"]

    @property
    def level(self) -> Float[np.ndarray, " n_y"]:
        """Root mean square of every output's spectrum."""
        return np.sqrt(np.mean(np.abs(self.z) ** 2, axis=0))

    @property
    def channels(self) -> Int[np.ndarray, " n_free"]:
        """Channel of every free delay and log gain."""
        return np.concatenate([self.delays, self.gains])

    @property
    def factor(self) -> Complex[np.ndarray, "n_omega n_free"]:
        """Derivative of the row of each channel over itself."""
        factor = np.ones((self.omega.size, self.channels.size), dtype=complex)
        factor[:, : self.delays.size] = -1j * self.omega[:, None]
        return factor

    def clip(self, step: np.ndarray) -> np.ndarray:
        """Limit a step one by one, so that a poorly known channel does not limit the others."""
        largest = np.full(step.size, _LARGEST_STEP_RAD)
        largest[: self.delays.size] /= self.omega[-1]
        return np.clip(step, -largest, largest)

    def spread(self, value: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Delays and log gains of all channels, zero where they are not free."""
        delay, gain = np.zeros((2, len(self.names)))
        delay[self.delays] = value[: self.delays.size]
        gain[self.gains] = value[self.delays.size :]
        return delay, gain

    def project(
        self, value: np.ndarray, sigma: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Residual (n_omega, n_y), its slopes (n_omega, n_free) and the basis of all motions."""
        delay, gain = self.spread(value)
        turned = self.rows * np.exp(-1j * self.omega[:, None] * delay + gain)[:, :, None]
        weighted = turned / sigma[:, None]
        size = np.linalg.norm(weighted, axis=1)
        q, _ = np.linalg.qr(weighted / np.where(size > 0, size, 1.0)[:, None, :])
        z = self.z / sigma
        seen = np.matmul(q, np.matmul(q.conj().transpose(0, 2, 1), z[:, :, None]))[:, :, 0]
        return z - seen, self.factor * seen[:, self.channels], q

    def compute_normal_equations(
        self, residual: np.ndarray, slope: np.ndarray, q: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Normal matrix and gradient of half the squares, motions projected out (Kaufman)."""
        n, own = slope.shape[1], self.channels
        inside = (q[:, own].conj() * slope[:, :, None]).transpose(0, 2, 1).reshape(-1, n)
        same = own[:, None] == own
        normal = np.real(slope.conj().T @ slope) * same - np.real(inside.conj().T @ inside)
        return normal, -np.sum(np.real(slope.conj() * residual[:, own]), axis=0)

    def compute_noise_information(self, q: np.ndarray) -> Float[np.ndarray, "n_free n_free"]:
        """Mean contribution of unit noise of all sensors to the normal matrix."""
        own = self.channels
        shared = np.matmul(q[:, own], q[:, own].conj().transpose(0, 2, 1))
        power = shared.transpose(0, 2, 1) * ((own[:, None] == own) - shared)
        return np.real(np.einsum("kp,kpr,kr->pr", self.factor.conj(), power, self.factor))

    def describe(
        self, value: np.ndarray, std: np.ndarray, noise: np.ndarray, reference: str
    ) -> SensorFaults:
        """Faults of all outputs from delays and log gains with their standard errors."""
        delay, gain = self.spread(value)
        delay_std, gain_std = self.spread(std)
        low, high = (self.omega[[0, -1]] / (2.0 * np.pi)).tolist()
        scale = np.exp(gain)
        return SensorFaults(
            self.names, reference, delay, delay_std, scale, scale * gain_std, noise, (low, high)
        )


def _converge(
    sensors: RedundantSensors, start: np.ndarray, sigma: np.ndarray, small: float
) -> Float[np.ndarray, " n_free"]:
    """Levenberg-Marquardt in delays and log gains alone."""
    value, damping = start, 1e-3
    at = sensors.project(value, sigma)
    cost = float(np.sum(np.abs(at[0]) ** 2))
    normal, gradient = sensors.compute_normal_equations(*at)
    for _ in range(_STEPS):
        diagonal = np.diag(normal) + 1e-12 * np.trace(normal)
        step = sensors.clip(np.linalg.solve(normal + damping * np.diag(diagonal), -gradient))
        trial = sensors.project(value + step, sigma)
        lower = float(np.sum(np.abs(trial[0]) ** 2))
        if lower < cost:
            value, cost = value + step, lower
            normal, gradient = sensors.compute_normal_equations(*trial)
            damping = max(damping / 10.0, 1e-12)
            if np.max(np.abs(step) * np.sqrt(np.maximum(diagonal, 0.0))) < small:
                break
        else:
            damping *= 10.0
            if damping > 1e6:
                break
    return value


def _estimate_variance(
    sensors: RedundantSensors, value: np.ndarray, sigma: np.ndarray
) -> Float[np.ndarray, " n_free"]:
    """Variance of each delay and log gain."""
    residual, slope, q = sensors.project(value, sigma)
    normal, _ = sensors.compute_normal_equations(residual, slope, q)
    size = np.sqrt(np.maximum(np.diag(normal), 0.0))
    if not size.all() or np.linalg.cond(normal / np.outer(size, size)) > _LARGEST_CONDITION:
        weak = sensors.names[sensors.channels[int(np.argmin(size))]]
        raise NotIdentifiable(
            f"the delay or scale factor of '{weak}' is not identifiable from the other sensors",
            code="no-redundancy",
            channel=weak,
        )
    scatter = compute_score_scatter(slope, residual[:, sensors.channels])
    return compute_fault_variance(normal, normal - sensors.compute_noise_information(q), scatter)


def compute_score_scatter(
    slope: Complex[np.ndarray, "n_omega n_free"], residual: Complex[np.ndarray, "n_omega n_free"]
) -> Float[np.ndarray, "n_free n_free"]:
    """Compute the scatter of the gradient for residuals that neighbouring frequencies share.

    Notes
    -----
    Source: Newey and West, Econometrica 55, 1987, doi:10.2307/1913610.
    """
    score = np.real(slope.conj() * residual)
    scatter = score.T @ score
    for lag in range(1, min(_NEIGHBOURS, score.shape[0] - 1) + 1):
        shared = (1.0 - lag / (_NEIGHBOURS + 1.0)) * (score[lag:].T @ score[:-lag])
        scatter += shared + shared.T
    return scatter


def compute_fault_variance(
    normal: Float[np.ndarray, "n_free n_free"],
    signal: Float[np.ndarray, "n_free n_free"],
    scatter: Float[np.ndarray, "n_free n_free"],
) -> Float[np.ndarray, " n_free"]:
    """Compute variances of delays and log gains, the larger of white and shared residuals.

    The motion is reconstructed from noisy sensors, and their noise turned by a delay appears
    as information. ``signal`` is the information without it; the scatter retains it. The
    whitened residuals have unit variance at each frequency by the choice of the noise.
    """
    size = np.sqrt(np.maximum(np.diag(normal), 0.0))
    share, axes = scipy.linalg.eigh(signal / np.outer(size, size), normal / np.outer(size, size))
    weighted = axes / np.maximum(share, _LEAST_SHARE) / size[:, None]
    bread = weighted @ (axes / size[:, None]).T
    return np.maximum(0.5 * np.sum(weighted**2, axis=1), np.diag(bread @ scatter @ bread))


def widen_standard_errors(faults: SensorFaults, others: Sequence[SensorFaults]) -> SensorFaults:
    """Widen standard errors by the differences to estimates with other sets of modes.

    The part of a difference within their own larger errors is not counted again.
    """
    delay_std, scale_std = faults.delay_std, faults.scale_std
    for other in others:
        delay_std = np.maximum(
            delay_std,
            _widen(faults.delay_s, faults.delay_std, other.delay_s, other.delay_std),
        )
        scale_std = np.maximum(
            scale_std, _widen(faults.scale, faults.scale_std, other.scale, other.scale_std)
        )
    return replace(faults, delay_std=delay_std, scale_std=scale_std)


def _widen(
    one: np.ndarray, std: np.ndarray, other: np.ndarray, other_std: np.ndarray
) -> np.ndarray:
    """Standard error that includes the difference of two estimates beyond that of their errors."""
    known = np.isfinite(std) & np.isfinite(other_std)
    more = np.where(known, other_std, 0.0) ** 2 - np.where(known, std, 0.0) ** 2
    excess = np.maximum((other - one) ** 2 - np.maximum(more, 0.0), 0.0)
    return np.sqrt(std**2 + np.where(known, excess, 0.0))


def compute_sensor_coherence(
    model: AeroelasticModel,
    outputs: FrequencyData,
    instruments: Complex[np.ndarray, "n_omega n_y"],
    noise: Float[np.ndarray, " n_y"],
) -> Float[np.ndarray, " n_y"]:
    """Compute the coherence of each sensor with its prediction from all others.

    From 0 to 1; NaN where a sensor dominates its own reconstruction, so that the others do not
    check it. Spectra and instruments are those of ``estimate_sensor_faults``, ``noise`` is the
    standard deviation of each output's spectral noise. [output unit * s]
    """
    z = outputs.pick(model.outputs).values
    rows = instruments[:, :, None] * model.sensors.response(outputs.omega)
    nothing = np.empty(0, dtype=int)
    sensors = RedundantSensors(model.outputs, outputs.omega, z, rows, nothing, nothing)
    residual, _, q = sensors.project(np.empty(0), noise)
    z = z / noise
    own = np.sum(np.abs(q) ** 2, axis=2)
    others = z - residual / np.maximum(1.0 - own, 1e-9)
    checked = own < _LARGEST_LEVERAGE
    cross = np.abs(np.sum(np.where(checked, z.conj() * others, 0.0), axis=0)) ** 2
    power = np.sum(np.where(checked, np.abs(z) ** 2, 0.0), axis=0)
    power = power * np.sum(np.where(checked, np.abs(others) ** 2, 0.0), axis=0)
    return np.where(power > 0, cross / np.where(power > 0, power, 1.0), np.nan)


# --- Biases of gyro and vane from kinematics: attitude integrates pitch rate, alpha is theta - gamm

_PARTS = 8  # batches of a record, for standard errors of means
_EDGE_S = 0.5  # at either end of a record: averaged, for one sample is noisy


@dataclass(frozen=True, slots=True, kw_only=True)
class Bias:
    """Bias of a channel with its standard error; ``basis`` states the assumption."""

    value: float
    std: float
    basis: str


def estimate_gyro_bias(
    rate: Float[np.ndarray, " n_samples"],
    attitude: Float[np.ndarray, " n_samples"] | None,
    rate_hz: float,
    trim: slice,
    scale: float = 1.0,
    scale_std: float = 0.0,
) -> Bias:
    """Bias of a rate gyro.

    Parameters
    ----------
    rate, attitude
        Recorded angular rate [rad/s], and the angle that integrates it on the same clock; None
        where none was recorded. [rad]
    rate_hz
        Samples per second. [Hz]
    trim
        Samples before the excitation, where the aircraft does not turn: used when there
        is no attitude.
    scale, scale_std
        Recorded over true rate.

    Notes
    -----
    The mean rate over a record is the turn from its beginning to its end; errors follow
    from estimates of parts of the record.
    """
    if attitude is None:
        value, std = estimate_mean(rate[trim])
        return Bias(value=value, std=std, basis="no turn in trim before the excitation")
    edge = max(1, min(rate.size // 8, round(_EDGE_S * rate_hz)))
    parts = [
        _average_rate(r, edge) - scale * _average_turn(a, edge, rate_hz)
        for r, a in zip(np.array_split(rate, _PARTS), np.array_split(attitude, _PARTS), strict=True)
        if r.size > 2 * edge
    ]
    turn = _average_turn(attitude, edge, rate_hz)
    return Bias(
        value=_average_rate(rate, edge) - scale * turn,
        std=float(np.hypot(_estimate_std(parts), scale_std * turn)),
        basis="the mean rate is the change of attitude",
    )


def estimate_vane_bias(
    vane: Float[np.ndarray, " n_samples"],
    attitude: Float[np.ndarray, " n_samples"],
    climb: Bias,
    trim: slice,
    scale: float = 1.0,
    scale_std: float = 0.0,
) -> Bias:
    """Bias of an angle-of-attack vane against attitude in trim.

    Parameters
    ----------
    vane, attitude
        Recorded angles on one clock. [rad]
    climb
        Flight path angle and its standard error. [rad]
    trim
        Samples of steady flight.
    scale, scale_std
        Recorded over true angle of attack.
    """
    value, std = estimate_mean(vane[trim] - scale * attitude[trim])
    alpha = float(np.mean(attitude[trim])) - climb.value
    return Bias(
        value=value + scale * climb.value,
        std=float(np.sqrt(std**2 + (scale * climb.std) ** 2 + (scale_std * alpha) ** 2)),
        basis=f"in trim alpha is theta - gamma, {climb.basis}",
    )


def estimate_climb_angle(
    altitude: Float[np.ndarray, " n_samples"], rate_hz: float, airspeed: float
) -> Bias:
    """Flight path angle [rad] from the altitude [m] of a whole record at true airspeed. [m/s]"""
    slopes = [_fit_slope(part) * rate_hz for part in np.array_split(altitude, _PARTS)]
    value = _fit_slope(altitude) * rate_hz / airspeed
    std = _estimate_std(slopes) / airspeed
    return Bias(value=value, std=std, basis="gamma from altitude")


def estimate_mean(values: Float[np.ndarray, " n_samples"]) -> tuple[float, float]:
    """Mean, and its standard error from batch means, which are robust to correlated samples."""
    if values.size < 2 * _PARTS:
        return float(np.mean(values)), float(np.std(values, ddof=min(1, values.size - 1)))
    means = [part.mean() for part in np.array_split(values, _PARTS)]
    return float(np.mean(values)), _estimate_std(means)


def _average_turn(attitude: np.ndarray, edge: int, rate_hz: float) -> float:
    """Mean rate of an angle from the middle of the first edge to the middle of the last."""
    change = float(attitude[-edge:].mean() - attitude[:edge].mean())
    return change * rate_hz / (attitude.size - edge)


def _average_rate(rate: np.ndarray, edge: int) -> float:
    """Mean of a rate weighted like the difference of averaged ends: a trapezoid."""
    weight = np.convolve(np.ones(rate.size - edge), np.ones(edge))
    return float(np.average(0.5 * (rate[:-1] + rate[1:]), weights=weight))


def _estimate_std(parts: Sequence[float]) -> float:
    """Standard error of the mean of a few parts, widened to the variance of Student's t."""
    count = len(parts)
    if count < 4:
        return float("nan")
    widened = np.sqrt((count - 1) / (count - 3))
    return float(widened * np.std(parts, ddof=1) / np.sqrt(count))


def _fit_slope(values: np.ndarray) -> float:
    """Least-squares slope per sample."""
    return float(np.polyfit(np.arange(values.size), values, 1)[0])


# --- Time skews of the measured surfaces against the motion that they cause -----------------------

_INPUT_STEPS = 8  # at most
_SMALL_S = 2e-6  # smaller steps of a delay end the iteration [s]
_LARGEST_INPUT_CONDITION = 1e10  # of the scaled information: above it, delays are not identifiable
_IN_BAND = 1.3  # of the highest frequency: modes further above respond by their stiffness only


@dataclass(frozen=True, slots=True)
class InputSkews:
    """Delay of every input beyond the reference of the motion, with standard errors. [s]"""

    names: tuple[str, ...]
    delay_s: Float[np.ndarray, " n_u"]
    delay_std: Float[np.ndarray, " n_u"]


def estimate_input_skews(
    model: AeroelasticModel,
    motion: ReconstructedMotion,
    inputs: FrequencyData,
    noise: Float[np.ndarray, "n_omega n_u"] | None = None,
    near: InputSkews | None = None,
) -> InputSkews:
    """Estimate the delays on which the derivatives of all coefficients agree.

    Parameters
    ----------
    motion
        Reconstructed from sensors whose delays are undone.
    inputs, noise
        Surface deflections, known instruments undone [rad s], and the variance of their
        spectra, none by default. [rad2 s2]
    near
        Skews to begin with; none by default.

    Raises
    ------
    NotIdentifiable
        If there are fewer frequencies than derivatives, or a surface has no effect.

    Notes
    -----
    Errors of the motion are taken out of each regression as in equation error. Standard
    errors grow where the coefficients disagree (Birge, Phys. Rev. 40, 1932,
    doi:10.1103/PhysRev.40.207).
    """
    u = inputs.pick(model.inputs).values
    n_u = u.shape[1]
    if n_u == 0:
        raise NotIdentifiable("no surface was recorded", code="no-input")
    some = select_strong_frequencies(u)
    seen = ReconstructedMotion(
        motion.omega[some], motion.values[some], motion.covariance[some], motion.noise
    )
    top = _IN_BAND * seen.omega[-1]
    first = model.n_rigid
    rows = [*range(first), *(first + k for k, own in enumerate(model.modes.omega) if own < top)]
    errors = _gather_errors(model, seen, rows, None if noise is None else noise[some])
    coefficients = compute_aerodynamic_coefficients(model, seen)[:, rows]
    delay = np.zeros(n_u) if near is None else near.delay_s
    information, excess = np.eye(n_u), 1.0
    for _ in range(_INPUT_STEPS):
        turned = u[some] * np.exp(1j * seen.omega[:, None] * delay)
        X = build_regressors(model, seen, FrequencyData(seen.omega, turned, model.inputs))
        X = np.concatenate([X, 1j * seen.omega[:, None] * turned], axis=1)
        step, information, excess = _solve_step(X, coefficients, errors, n_u)
        delay = delay + step
        if np.max(np.abs(step)) < _SMALL_S:
            break
    variance = np.diag(np.linalg.inv(information))
    return InputSkews(model.inputs, delay, np.sqrt(max(1.0, excess) * variance))


def _gather_errors(
    model: AeroelasticModel,
    motion: ReconstructedMotion,
    rows: Sequence[int],
    noise: Float[np.ndarray, "n_omega n_u"] | None,
) -> list[ErrorsInVariables]:
    """Errors of the regressors of every row: motion, inputs, and rates of the inputs."""
    motion_noise, n_u = MotionNoise(model, motion), len(model.inputs)
    p = len(model.variables)
    of_inputs = np.zeros((motion.omega.size, p + n_u))
    if noise is not None:
        of_inputs[:, p - n_u : p] = noise
        of_inputs[:, p:] = noise * motion.omega[:, None] ** 2
    errors = []
    for row in rows:
        known = motion_noise.compute_row_errors(row, np.zeros(p), np.arange(p))
        spread = of_inputs[:, :, None] * np.eye(p + n_u)
        spread[:, :p, :p] += known.regressors
        cross = np.zeros((motion.omega.size, p + n_u))
        cross[:, :p] = known.cross
        errors.append(ErrorsInVariables(spread, cross, known.dependent))
    return errors


def _solve_step(
    X: Complex[np.ndarray, "n_omega p"],
    C: Complex[np.ndarray, "n_omega n_rows"],
    errors: Sequence[ErrorsInVariables],
    n_u: int,
) -> tuple[np.ndarray, np.ndarray, float]:
    """Further delay, its information, and the scatter of the rows over their errors."""
    labels = tuple(f"regressor {k + 1}" for k in range(X.shape[1]))
    found = [regress(X, z, labels, error) for z, error in zip(C.T, errors, strict=True)]
    theta = np.array([one.values[-2 * n_u : -n_u] for one in found])
    rate = np.array([one.values[-n_u:] for one in found])
    weight = np.array([np.linalg.inv(one.covariance[-n_u:, -n_u:]) for one in found])
    information = np.einsum("ru,ruv,rv->uv", theta, weight, theta)
    size = np.sqrt(np.diag(information))
    if (
        not np.all(size > 0)
        or np.linalg.cond(information / np.outer(size, size)) > _LARGEST_INPUT_CONDITION
    ):
        raise NotIdentifiable(
            "the delays of the surfaces are not identifiable from the coefficients",
            code="no-redundancy",
        )
    step = np.linalg.solve(information, np.einsum("ru,ruv,rv->u", theta, weight, rate))
    apart = rate - theta * step
    chi_square = float(np.einsum("ru,ruv,rv->", apart, weight, apart))
    return step, information, chi_square / ((len(found) - 1) * n_u)
