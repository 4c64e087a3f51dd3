"""Which few sensors are at fault, by what all sensors agree on.

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
    Candidates,
    Faults,
    RedundantLines,
    strong_lines,
)
from flexsid.sysid.signals import FrequencyData

OTHERS = "the other sensors"
"""What the delay of a single sensor is counted from."""

_ENTERS = (
    25.0  # twice the gain in log likelihood, 5 sigma: of some thirty candidates none by chance
)
_RESOLVED = 1e-6  # of a candidate's information that no motion takes up
_LEAST_OWN = 0.02  # of a candidate's information that the faults found leave it
_LARGEST_STEP_RAD = 0.3  # at the highest line: beyond that a delay may slip by a whole turn
_LARGEST_GAIN_STEP = 0.3
_STEPS = 20
_NOISE_ROUNDS = 3
_SMALL = 0.05  # of a standard error: steps below change nothing
_LEAST_FREEDOM = 0.05  # of a sensor, below which its own noise is not known
_TURNED = 0.1  # of the misfit is left where one sign was wrong
_TELLS = 4.0  # times the misfit of the best sign that any other leaves, else it is ambiguous
_MODEL_ERROR = 0.01  # of a sensor's level: calibration and shapes are not known better
_KNOWN_S = 0.05  # a larger standard error says that a delay is not known at all
_KNOWN_GAIN = 0.5
_NEIGHBOURS = 8  # lines whose residuals a missing mode makes alike
_LEAST_SHARE = 0.1  # of signal in what resolves a delay: below, it may be none


@dataclass(frozen=True, slots=True)
class Detection:
    """Faults of single sensors.

    Of a sensor in ``found`` the delay or scale factor was estimated with those of all others
    found; of any other sensor ``faults`` has what it would be if it were at fault too.
    ``signs`` is -1 for a sensor that is turned round, ``rival`` another sensor that would
    explain this as well. ``misfit`` is the disagreement of each sensor that is left, over what
    was expected; ``criterion`` compares models of other modes, the smallest is best.
    """

    faults: Faults
    signs: Float[np.ndarray, " n_y"]
    found: tuple[str, ...]
    misfit: Float[np.ndarray, " n_y"]
    criterion: float
    rival: str | None = None


def detect_faults(
    model: AeroelasticModel,
    outputs: FrequencyData,
    instruments: Complex[np.ndarray, "n_omega n_y"],
    scaled: tuple[str, ...] = (),
    noise: Float[np.ndarray, " n_y"] | None = None,
) -> Detection:
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
    The motion is projected out at each line (variable projection: Golub and Pereyra, SIAM Journal
    on Numerical Analysis 10, 1973), which leaves the likelihood of delays and log scale factors
    alone.
    They enter one after the other by the score test while twice the gain in log likelihood
    exceeds 25 (orthogonal matching pursuit: Pati et al., Asilomar 1993), relinearised until
    nothing changes. Noise grows to what is left of each sensor, so that a sensor with another
    fault loses its weight. The criterion is Akaike's, with two real parameters at each line for
    every motion. Standard errors are the larger of two: white residuals, and residuals that
    neighbouring lines share (Newey and West, Econometrica 55, 1987).
    """
    names = model.outputs
    z = outputs.pick(names).values
    some = strong_lines(z)
    omega, z = outputs.omega[some], z[some]
    rows = instruments[some][:, :, None] * model.sensors.response(omega)
    n_y, n_r = rows.shape[1:]
    level = np.sqrt(np.mean(np.abs(z) ** 2, axis=0))
    if not level.all():
        silent = names[int(np.argmin(level))]
        raise NotIdentifiable(
            f"'{silent}' never moves; leave it out", code="silent-channel", channel=silent
        )
    if n_y <= n_r:
        raise NotIdentifiable(
            f"{n_y} outputs see {n_r} motions; a check needs more sensors than motions",
            code="no-redundancy",
        )
    floor = _MODEL_ERROR * level
    if noise is not None:
        floor = np.hypot(floor, np.where(np.isfinite(noise), noise, 0.0))
    candidates = Candidates(
        np.arange(n_y), np.array([names.index(name) for name in scaled], dtype=int)
    )
    lines = RedundantLines(omega, z, rows)
    signs, rival = _turned(lines, candidates, floor)
    lines = replace(lines, z=z * signs)
    sigma, value = floor, np.zeros(candidates.count)
    support: list[int] = []
    for _ in range(_NOISE_ROUNDS):
        value, support = _pursue(lines, candidates, value, sigma)
        update = _noise(lines, candidates, value, sigma, floor)
        settled = np.max(np.abs(np.log(update / sigma))) < 0.05
        sigma = update
        if settled:
            break
    residual, slope, q = lines.project(candidates, value, sigma)
    estimate, std = _conditional(lines, candidates, value, support, (residual, slope, q))
    n_delays = candidates.delays.size
    unknown = std > np.where(np.arange(std.size) < n_delays, _KNOWN_S, _KNOWN_GAIN)
    estimate, std = np.where(unknown, 0.0, estimate), np.where(unknown, np.inf, std)
    delay, gain = candidates.spread(estimate, n_y)
    delay_std, gain_std = candidates.spread(std, n_y)
    misfit = sigma / floor
    criterion = 2.0 * float(np.sum(np.abs(residual) ** 2))
    criterion += 4.0 * omega.size * float(np.sum(np.log(misfit))) + 4.0 * omega.size * n_r
    criterion += _ENTERS * (len(support) + int(np.sum(signs < 0)))
    faults = Faults(
        names=names,
        reference=OTHERS,
        delay_s=delay,
        delay_std=delay_std,
        scale=signs * np.exp(gain),
        scale_std=np.exp(gain) * gain_std,
        noise=sigma,
        band_hz=(float(omega[0] / 2.0 / np.pi), float(omega[-1] / 2.0 / np.pi)),
    )
    found = tuple(dict.fromkeys(names[candidates.channels[k]] for k in support))
    return Detection(
        faults, signs, found, misfit, criterion, None if rival is None else names[rival]
    )


def _turned(
    lines: RedundantLines, candidates: Candidates, sigma: Float[np.ndarray, " n_y"]
) -> tuple[Float[np.ndarray, " n_y"], int | None]:
    """Signs of all sensors, at most one of them wrong; and whether another would do as well."""
    n_y = sigma.size
    value = np.zeros(candidates.count)
    residual, _, _ = lines.project(candidates, value, sigma)
    cost = float(np.sum(np.abs(residual) ** 2))
    signs = np.ones(n_y)
    if cost < _ENTERS * residual.size:
        return signs, None
    tried = np.empty(n_y)
    for k in range(n_y):
        turned = np.where(np.arange(n_y) == k, -1.0, 1.0)
        left, _, _ = replace(lines, z=lines.z * turned).project(candidates, value, sigma)
        tried[k] = np.sum(np.abs(left) ** 2)
    best, second = np.argsort(tried)[:2]
    if not tried[best] < _TURNED * cost:
        return signs, None
    signs[best] = -1.0
    return signs, int(second) if tried[second] < _TELLS * tried[best] else None


def _pursue(
    lines: RedundantLines,
    candidates: Candidates,
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
        target, support = _select(normal, normal @ value - gradient, _resolved(normal, slope))
        step = np.clip(target - value, -largest, largest)
        value = value + step
        if np.max(np.abs(step) * np.sqrt(np.maximum(np.diag(normal), 0.0))) < _SMALL:
            break
    return value, support


def _resolved(
    normal: Float[np.ndarray, "n_free n_free"], slope: Complex[np.ndarray, "n_omega n_free"]
) -> Bool[np.ndarray, " n_free"]:
    """Candidates that no motion explains wholly."""
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
        if not 2.0 * gain[best] > _ENTERS:
            break
        support.append(best)
        block = normal[np.ix_(support, support)]
        value = np.zeros(n)
        value[support] = linalg.solve(block, right[support], assume_a="sym")
    return value, support


def _noise(
    lines: RedundantLines,
    candidates: Candidates,
    value: Float[np.ndarray, " n_free"],
    sigma: Float[np.ndarray, " n_y"],
    floor: Float[np.ndarray, " n_y"],
    rounds: int = 5,
) -> Float[np.ndarray, " n_y"]:
    """What is left of each sensor, its own pull on the motion removed; never below the floor."""
    for _ in range(rounds):
        residual, _, q = lines.project(candidates, value, sigma)
        freedom = np.sum(1.0 - np.sum(np.abs(q) ** 2, axis=2), axis=0)
        freedom = np.maximum(freedom, _LEAST_FREEDOM * lines.omega.size)
        sigma = np.maximum(sigma * np.sqrt(np.sum(np.abs(residual) ** 2, axis=0) / freedom), floor)
    return sigma


def _conditional(
    lines: RedundantLines,
    candidates: Candidates,
    value: Float[np.ndarray, " n_free"],
    support: list[int],
    at: tuple[np.ndarray, np.ndarray, np.ndarray],
) -> tuple[Float[np.ndarray, " n_free"], Float[np.ndarray, " n_free"]]:
    """Every candidate with those found, and its standard error; infinite where none is known."""
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
    for k in np.flatnonzero(_resolved(normal, slope)):
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
