"""Detection of a few faulty sensors by the agreement of all sensors.

With 8 to 16 sensors, of which left and right pairs read the same, the delays of all sensors
cannot be estimated together: hardly more sensors are independent than motions. That one or
two sensors are late can be detected all the same, since the others need no correction then.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Complex, Float
from scipy import linalg

from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.preparation.redundancy import (
    RedundantSensors,
    SensorFaults,
    compute_fault_variance,
    compute_score_scatter,
    select_sensors,
)
from flexsid.sysid.signals import FrequencyData

OTHER_SENSORS = "the other sensors"
"""Reference of the delay of a single sensor."""

_LEAST_GAIN = 25.0  # in 2 ln L to enter, 5 sigma: none of thirty candidates by chance
_RESOLVED = 1e-6  # of a candidate's information, least part outside the span of the motion
_LEAST_OWN = 0.02  # of a candidate's information, least part outside the faults found
_STEPS = 20  # of the search, at most
_NOISE_ROUNDS = 3  # of new noise levels and a new search
_NOISE_STEPS = 5  # of the fixed-point iteration for the noise levels
_NOISE_CONVERGED = 0.05  # relative change of the noise that ends the rounds
_STEP_TOLERANCE = 0.05  # of a standard error: smaller steps end the iteration
_LEAST_FREEDOM = 0.05  # of a sensor, below which its own noise is not known
_SIGN_MISFIT = 0.1  # largest misfit after a sign is corrected, over that before
_AMBIGUITY_RATIO = 4.0  # least misfit of any other sign over the best one
_MODEL_ERROR = 0.01  # of a sensor's level: calibration and shapes are not known better
_KNOWN_S = 0.05  # with a larger standard error a delay is not identifiable [s]
_KNOWN_GAIN = 0.5  # with a larger standard error a log scale factor is not identifiable


@dataclass(frozen=True, slots=True)
class FaultDetection:
    """Faults of single sensors.

    Of a sensor in ``found`` the delay or scale factor was estimated with those of all others
    found; of any other sensor ``faults`` has what it would be if it were at fault too.
    ``signs`` is -1 for a sensor that is turned round, ``rival`` another sensor that would
    explain this as well. ``misfit`` is the disagreement of each sensor after the fit, over the
    expected one; ``criterion`` compares models of other modes, the smallest is best.
    """

    faults: SensorFaults
    signs: Float[np.ndarray, " n_y"]
    found: tuple[str, ...]
    misfit: Float[np.ndarray, " n_y"]
    criterion: float
    rival: str | None = None


def detect_sensor_faults(
    model: AeroelasticModel,
    outputs: FrequencyData,
    instruments: Complex[np.ndarray, "n_omega n_y"],
    scaled: tuple[str, ...] = (),
    noise: Float[np.ndarray, " n_y"] | None = None,
) -> FaultDetection:
    """Find the fewest delays and scale factors that make all sensors agree on the motion.

    Parameters
    ----------
    outputs, instruments
        As for ``estimate_sensor_faults``.
    scaled
        Outputs whose scale factors may be wrong.
    noise
        Standard deviation of each output's spectral noise, NaN where it is not known.
        [output unit * s]

    Raises
    ------
    NotIdentifiable
        If there are no more independent sensors than motions.

    Notes
    -----
    The motion is projected out at each frequency (variable projection: Golub and Pereyra, SIAM
    Journal on Numerical Analysis 10, 1973, doi:10.1137/0710036), which leaves the likelihood of
    delays and log scale factors alone. They enter one after the other by the score test while twice
    the gain in log likelihood exceeds 25 (orthogonal matching pursuit: Pati et al., Asilomar 1993,
    doi:10.1109/ACSSC.1993.342465), relinearised until nothing changes. Noise grows to the residual
    of each sensor, so that a sensor with another fault loses its weight. The criterion is Akaike's,
    with two real parameters per frequency for every motion. Standard errors are the larger of two:
    white residuals, and residuals that neighbouring frequencies share (Newey and West, Econometrica
    55, 1987, doi:10.2307/1913610).
    """
    names = model.outputs
    sensors, _ = select_sensors(model, outputs, instruments, names, scaled)
    n_omega, _, n_r = sensors.rows.shape
    floor = _MODEL_ERROR * sensors.level
    if noise is not None:
        floor = np.hypot(floor, np.where(np.isfinite(noise), noise, 0.0))
    signs, rival = _find_sign_errors(sensors, floor)
    sensors = replace(sensors, z=sensors.z * signs)
    sigma, value = floor, np.zeros(sensors.channels.size)
    support: list[int] = []
    for _ in range(_NOISE_ROUNDS):
        value, support = _pursue(sensors, value, sigma)
        before, sigma = sigma, _estimate_noise(sensors, value, sigma, floor)
        if np.max(np.abs(np.log(sigma / before))) < _NOISE_CONVERGED:
            break
    at = sensors.project(value, sigma)
    estimate, std = _estimate_conditional(sensors, value, support, *at)
    n_delays = sensors.delays.size
    unknown = std > np.where(np.arange(std.size) < n_delays, _KNOWN_S, _KNOWN_GAIN)
    estimate, std = np.where(unknown, 0.0, estimate), np.where(unknown, np.inf, std)
    misfit = sigma / floor
    criterion = 2.0 * float(np.sum(np.abs(at[0]) ** 2))
    criterion += 4.0 * n_omega * float(np.sum(np.log(misfit))) + 4.0 * n_omega * n_r
    criterion += _LEAST_GAIN * (len(support) + int(np.sum(signs < 0)))
    faults = sensors.describe(estimate, std, sigma, OTHER_SENSORS)
    return FaultDetection(
        faults=replace(faults, scale=signs * faults.scale),
        signs=signs,
        found=tuple(dict.fromkeys(names[sensors.channels[k]] for k in support)),
        misfit=misfit,
        criterion=criterion,
        rival=None if rival is None else names[rival],
    )


def _find_sign_errors(
    sensors: RedundantSensors, sigma: Float[np.ndarray, " n_y"]
) -> tuple[Float[np.ndarray, " n_y"], int | None]:
    """Signs of all sensors, at most one of them wrong; and whether another would do as well."""
    n_y, value = sigma.size, np.zeros(sensors.channels.size)
    residual, _, _ = sensors.project(value, sigma)
    cost = float(np.sum(np.abs(residual) ** 2))
    signs = np.ones(n_y)
    if cost < _LEAST_GAIN * residual.size:
        return signs, None
    tried = np.empty(n_y)
    for k in range(n_y):
        turned = np.where(np.arange(n_y) == k, -1.0, 1.0)
        left, _, _ = replace(sensors, z=sensors.z * turned).project(value, sigma)
        tried[k] = np.sum(np.abs(left) ** 2)
    best, second = np.argsort(tried)[:2]
    if not tried[best] < _SIGN_MISFIT * cost:
        return signs, None
    signs[best] = -1.0
    return signs, int(second) if tried[second] < _AMBIGUITY_RATIO * tried[best] else None


def _pursue(
    sensors: RedundantSensors,
    start: Float[np.ndarray, " n_free"],
    sigma: Float[np.ndarray, " n_y"],
) -> tuple[Float[np.ndarray, " n_free"], list[int]]:
    """The fewest delays and log gains, and which they are."""
    value, support = start, list[int]()
    for _ in range(_STEPS):
        at = sensors.project(value, sigma)
        normal, gradient = sensors.compute_normal_equations(*at)
        target, support = _select(normal, normal @ value - gradient, _find_resolved(normal, at[1]))
        step = sensors.clip(target - value)
        value = value + step
        if np.max(np.abs(step) * np.sqrt(np.maximum(np.diag(normal), 0.0))) < _STEP_TOLERANCE:
            break
    return value, support


def _find_resolved(
    normal: Float[np.ndarray, "n_free n_free"], slope: Complex[np.ndarray, "n_omega n_free"]
) -> Bool[np.ndarray, " n_free"]:
    """Candidates outside the span of the motion."""
    return np.diag(normal) > _RESOLVED * np.sum(np.abs(slope) ** 2, axis=0)


def _select(
    normal: Float[np.ndarray, "n_free n_free"],
    right: Float[np.ndarray, " n_free"],
    resolved: Bool[np.ndarray, " n_free"],
) -> tuple[Float[np.ndarray, " n_free"], list[int]]:
    """Enter candidates one by one while each gains enough."""
    n = right.size
    own = np.maximum(np.diag(normal), np.finfo(float).tiny)
    value, support = np.zeros(n), list[int]()
    while len(support) < n - 1:
        left = own.copy()
        if support:
            block = normal[np.ix_(support, support)]
            cross = normal[support]
            left = own - np.sum(cross * linalg.solve(block, cross, assume_a="sym"), axis=0)
        score = right - normal[:, support] @ value[support]
        gain = np.where(
            resolved & (left > _LEAST_OWN * own), score**2 / np.maximum(left, 1e-300), 0.0
        )
        gain[support] = 0.0
        best = int(np.argmax(gain))
        if not 2.0 * gain[best] > _LEAST_GAIN:
            break
        support.append(best)
        block = normal[np.ix_(support, support)]
        value = np.zeros(n)
        value[support] = linalg.solve(block, right[support], assume_a="sym")
    return value, support


def _estimate_noise(
    sensors: RedundantSensors,
    value: Float[np.ndarray, " n_free"],
    sigma: Float[np.ndarray, " n_y"],
    floor: Float[np.ndarray, " n_y"],
) -> Float[np.ndarray, " n_y"]:
    """Residual of each sensor, corrected for its own leverage; never below the floor."""
    for _ in range(_NOISE_STEPS):
        residual, _, q = sensors.project(value, sigma)
        freedom = np.sum(1.0 - np.sum(np.abs(q) ** 2, axis=2), axis=0)
        freedom = np.maximum(freedom, _LEAST_FREEDOM * sensors.omega.size)
        sigma = np.maximum(sigma * np.sqrt(np.sum(np.abs(residual) ** 2, axis=0) / freedom), floor)
    return sigma


def _estimate_conditional(
    sensors: RedundantSensors,
    value: Float[np.ndarray, " n_free"],
    support: list[int],
    residual: Complex[np.ndarray, "n_omega n_y"],
    slope: Complex[np.ndarray, "n_omega n_free"],
    q: Complex[np.ndarray, "n_omega n_y n_r"],
) -> tuple[Float[np.ndarray, " n_free"], Float[np.ndarray, " n_free"]]:
    """Every candidate estimated with those found, and its standard error (inf if unresolved)."""
    normal, gradient = sensors.compute_normal_equations(residual, slope, q)
    signal = normal - sensors.compute_noise_information(q)
    right = normal @ value - gradient
    scatter = compute_score_scatter(slope, residual[:, sensors.channels])
    estimate, std = np.zeros(value.size), np.full(value.size, np.inf)
    for k in np.flatnonzero(_find_resolved(normal, slope)):
        own = [*(s for s in support if s != k), int(k)]
        block = normal[np.ix_(own, own)]
        size = np.sqrt(np.maximum(np.diag(block), 0.0))
        if np.linalg.cond(block / np.outer(size, size)) > 1.0 / _LEAST_OWN**2:
            continue
        estimate[k] = value[k] if k in support else np.linalg.solve(block, right[own])[-1]
        variance = compute_fault_variance(
            block, signal[np.ix_(own, own)], scatter[np.ix_(own, own)]
        )
        std[k] = np.sqrt(variance[-1])
    return estimate, std
