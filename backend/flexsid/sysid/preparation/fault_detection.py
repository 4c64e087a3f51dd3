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

from flexsid.errors import NotIdentifiable
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.preparation.redundancy import (
    FaultParameters,
    RedundantSensors,
    SensorFaults,
    select_strong_frequencies,
)
from flexsid.sysid.signals import FrequencyData

OTHER_SENSORS = "the other sensors"
"""Reference of the delay of a single sensor."""

_LEAST_GAIN = 25.0  # in 2 ln L to enter, 5 sigma: none of thirty candidates by chance
_RESOLVED = 1e-6  # of a candidate's information, least part outside the span of the motion
_LEAST_OWN = 0.02  # of a candidate's information, least part outside the faults found
_LARGEST_STEP_RAD = 0.3  # at the highest frequency: beyond that a delay may slip by a whole turn
_LARGEST_GAIN_STEP = 0.3  # of the log scale factor, per step
_STEPS = 20
_NOISE_ROUNDS = 3
_NOISE_CONVERGED = 0.05  # relative change of the noise that ends the rounds
_STEP_TOLERANCE = 0.05  # of a standard error: smaller steps end the iteration
_LEAST_FREEDOM = 0.05  # of a sensor, below which its own noise is not known
_SIGN_MISFIT = 0.1  # largest misfit after a sign is corrected, over that before
_AMBIGUITY_RATIO = 4.0  # least misfit of any other sign over the best one
_MODEL_ERROR = 0.01  # of a sensor's level: calibration and shapes are not known better
_KNOWN_S = 0.05  # with a larger standard error a delay is not identifiable [s]
_KNOWN_GAIN = 0.5  # with a larger standard error a log scale factor is not identifiable
_NEIGHBOURS = 8  # frequencies whose residuals are correlated by an unmodelled mode
_LEAST_SHARE = 0.1  # of signal in the information on a delay: a lower share is not significant


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
    model
        Gives the sensor rows.
    outputs
        Spectra as recorded. [output unit * s]
    instruments
        Recorded over true response, of the delays that are known. [1]
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
    Journal on Numerical Analysis 10, 1973), which leaves the likelihood of delays and log scale
    factors alone. They enter one after the other by the score test while twice the gain in log
    likelihood exceeds 25 (orthogonal matching pursuit: Pati et al., Asilomar 1993),
    relinearised until nothing changes. Noise grows to the residual of each sensor, so that a
    sensor with another fault loses its weight. The criterion is Akaike's, with two real
    parameters per frequency for every motion. Standard errors are the larger of two: white
    residuals, and residuals that neighbouring frequencies share (Newey and West, Econometrica
    55, 1987).
    """
    names = model.outputs
    z = outputs.pick(names).values
    some = select_strong_frequencies(z)
    omega, z = outputs.omega[some], z[some]
    rows = instruments[some][:, :, None] * model.sensors.response(omega)
    n_y, n_r = rows.shape[1:]
    level = np.sqrt(np.mean(np.abs(z) ** 2, axis=0))
    if not level.all():
        silent = names[int(np.argmin(level))]
        raise NotIdentifiable(
            f"'{silent}' never moves; exclude it", code="silent-channel", channel=silent
        )
    if n_y <= n_r:
        raise NotIdentifiable(
            f"{n_y} outputs measure {n_r} motions; a check needs more sensors than motions",
            code="no-redundancy",
        )
    floor = _MODEL_ERROR * level
    if noise is not None:
        floor = np.hypot(floor, np.where(np.isfinite(noise), noise, 0.0))
    candidates = FaultParameters(
        np.arange(n_y), np.array([names.index(name) for name in scaled], dtype=int)
    )
    lines = RedundantSensors(omega, z, rows)
    signs, rival = _find_sign_errors(lines, candidates, floor)
    lines = replace(lines, z=z * signs)
    sigma, value = floor, np.zeros(candidates.count)
    support: list[int] = []
    for _ in range(_NOISE_ROUNDS):
        value, support = _pursue(lines, candidates, value, sigma)
        update = _estimate_noise(lines, candidates, value, sigma, floor)
        settled = np.max(np.abs(np.log(update / sigma))) < _NOISE_CONVERGED
        sigma = update
        if settled:
            break
    residual, slope, q = lines.project(candidates, value, sigma)
    estimate, std = _estimate_conditional(lines, candidates, value, support, (residual, slope, q))
    n_delays = candidates.delays.size
    unknown = std > np.where(np.arange(std.size) < n_delays, _KNOWN_S, _KNOWN_GAIN)
    estimate, std = np.where(unknown, 0.0, estimate), np.where(unknown, np.inf, std)
    delay, gain = candidates.spread(estimate, n_y)
    delay_std, gain_std = candidates.spread(std, n_y)
    misfit = sigma / floor
    criterion = 2.0 * float(np.sum(np.abs(residual) ** 2))
    criterion += 4.0 * omega.size * float(np.sum(np.log(misfit))) + 4.0 * omega.size * n_r
    criterion += _LEAST_GAIN * (len(support) + int(np.sum(signs < 0)))
    faults = SensorFaults(
        names=names,
        reference=OTHER_SENSORS,
        delay_s=delay,
        delay_std=delay_std,
        scale=signs * np.exp(gain),
        scale_std=np.exp(gain) * gain_std,
        noise=sigma,
        band_hz=(float(omega[0] / 2.0 / np.pi), float(omega[-1] / 2.0 / np.pi)),
    )
    found = tuple(dict.fromkeys(names[candidates.channels[k]] for k in support))
    return FaultDetection(
        faults, signs, found, misfit, criterion, None if rival is None else names[rival]
    )


def _find_sign_errors(
    lines: RedundantSensors, candidates: FaultParameters, sigma: Float[np.ndarray, " n_y"]
) -> tuple[Float[np.ndarray, " n_y"], int | None]:
    """Signs of all sensors, at most one of them wrong; and whether another would do as well."""
    n_y = sigma.size
    value = np.zeros(candidates.count)
    residual, _, _ = lines.project(candidates, value, sigma)
    cost = float(np.sum(np.abs(residual) ** 2))
    signs = np.ones(n_y)
    if cost < _LEAST_GAIN * residual.size:
        return signs, None
    tried = np.empty(n_y)
    for k in range(n_y):
        turned = np.where(np.arange(n_y) == k, -1.0, 1.0)
        left, _, _ = replace(lines, z=lines.z * turned).project(candidates, value, sigma)
        tried[k] = np.sum(np.abs(left) ** 2)
    best, second = np.argsort(tried)[:2]
    if not tried[best] < _SIGN_MISFIT * cost:
        return signs, None
    signs[best] = -1.0
    return signs, int(second) if tried[second] < _AMBIGUITY_RATIO * tried[best] else None


def _pursue(
    lines: RedundantSensors,
    candidates: FaultParameters,
    start: Float[np.ndarray, " n_free"],
    sigma: Float[np.ndarray, " n_y"],
) -> tuple[Float[np.ndarray, " n_free"], list[int]]:
    """The fewest delays and log gains, and which they are."""
    largest = np.full(candidates.count, _LARGEST_GAIN_STEP)
    largest[: candidates.delays.size] = _LARGEST_STEP_RAD / lines.omega[-1]
    value, support = start, list[int]()
    for _ in range(_STEPS):
        residual, slope, q = lines.project(candidates, value, sigma)
        normal, gradient = lines.normal(candidates, slope, q, residual)
        target, support = _select(normal, normal @ value - gradient, _find_resolved(normal, slope))
        step = np.clip(target - value, -largest, largest)
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
    lines: RedundantSensors,
    candidates: FaultParameters,
    value: Float[np.ndarray, " n_free"],
    sigma: Float[np.ndarray, " n_y"],
    floor: Float[np.ndarray, " n_y"],
    rounds: int = 5,
) -> Float[np.ndarray, " n_y"]:
    """Residual of each sensor, corrected for its own leverage; never below the floor."""
    for _ in range(rounds):
        residual, _, q = lines.project(candidates, value, sigma)
        freedom = np.sum(1.0 - np.sum(np.abs(q) ** 2, axis=2), axis=0)
        freedom = np.maximum(freedom, _LEAST_FREEDOM * lines.omega.size)
        sigma = np.maximum(sigma * np.sqrt(np.sum(np.abs(residual) ** 2, axis=0) / freedom), floor)
    return sigma


def _estimate_conditional(
    lines: RedundantSensors,
    candidates: FaultParameters,
    value: Float[np.ndarray, " n_free"],
    support: list[int],
    at: tuple[np.ndarray, np.ndarray, np.ndarray],
) -> tuple[Float[np.ndarray, " n_free"], Float[np.ndarray, " n_free"]]:
    """Every candidate estimated with those found, and its standard error (inf if unresolved)."""
    residual, slope, q = at
    normal, gradient = lines.normal(candidates, slope, q, residual)
    signal = normal - lines.of_noise(candidates, q)
    right = normal @ value - gradient
    score = np.real(slope.conj() * residual[:, candidates.channels])
    meat = score.T @ score
    for lag in range(1, min(_NEIGHBOURS, score.shape[0] - 1) + 1):
        shared = (1.0 - lag / (_NEIGHBOURS + 1.0)) * (score[lag:].T @ score[:-lag])
        meat += shared + shared.T
    estimate, std = np.zeros(candidates.count), np.full(candidates.count, np.inf)
    for k in np.flatnonzero(_find_resolved(normal, slope)):
        own = [*(s for s in support if s != k), k]
        block = normal[np.ix_(own, own)]
        size = np.sqrt(np.maximum(np.diag(block), 0.0))
        scaled = block / np.outer(size, size)
        if np.linalg.cond(scaled) > 1.0 / _LEAST_OWN**2:
            continue
        estimate[k] = value[k] if k in support else np.linalg.solve(block, right[own])[-1]
        share, axes = linalg.eigh(signal[np.ix_(own, own)] / np.outer(size, size), scaled)
        weighted = axes / np.maximum(share, _LEAST_SHARE) / size[:, None]
        bread = weighted @ (axes / size[:, None]).T
        white = 0.5 * np.sum(weighted[-1] ** 2)
        coloured = (bread @ meat[np.ix_(own, own)] @ bread)[-1, -1]
        std[k] = np.sqrt(max(white, coloured))
    return estimate, std
