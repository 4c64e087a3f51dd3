"""Search for the fewest sensor faults that make all sensors agree on one motion."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from flexsid.sysid.compatibility.kinematics import ALTITUDE, FlightRecord
from flexsid.sysid.compatibility.likelihood import (
    FaultCandidate,
    FaultLikelihood,
    SensorFaultKind,
    Values,
    build_likelihood,
)
from flexsid.sysid.model.sensor_models import ACCELEROMETER, AIRSPEED_PROBE, VANE

_LEAST_GAIN = 25.0  # in 2 ln L to enter, 5 sigma: none of thirty candidates by chance
_LEAST_SIGMAS = 4.0  # of the value, with residuals that neighbouring frequencies share
_MOST_FAULTS = 4
_INSEPARABLE = 10.0  # in 2 ln L: one of 150 samples of noise prefers the wrong cause
_NOISE_ROUNDS = 4
_NOISE_CONVERGED = 0.1  # relative change of the noise that ends the rounds
MOST_MISFIT = 3.0
"""Times its noise, above which the faults found do not explain a sensor."""

_LARGEST_RATIO = 4.0  # of a scale factor that is neither a sign nor a unit
_CALIBRATION = 0.005  # airspeed, and gravity by attitude, are known no better
_CLOCK = 0.03  # of the time between samples: clocks are known no better
_PROMISING = 10  # candidates and starts that are fitted
_POOR = 2.0  # half squares per spectrum: sensors disagree by more than a small fault explains
_DELAYS_S = (-0.3, -0.15, -0.06, 0.06, 0.15, 0.3)  # further starts of the search for a lag
UNIT_FACTORS = {
    -1.0: "its sign is reversed",
    180.0 / np.pi: "it is in degrees where radians are declared",
    np.pi / 180.0: "it is in radians where degrees are declared",
    9.80665: "it is in m/s² where g is declared",
    1.0 / 9.80665: "it is in g where m/s² is declared",
}
"""Factors of a wrong sign or unit, and what they mean."""

_ARMS = {
    (VANE.kind, "y"): "x", (VANE.kind, "z"): "x",
    (ACCELEROMETER.kind, "x"): "z", (ACCELEROMETER.kind, "y"): "x", (ACCELEROMETER.kind, "z"): "x",
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class Fault:
    """A fault with its value and standard error: delay [s], ratio, or arm [m].

    ``gain`` is what it adds to 2 ln L. ``inseparable`` are other faults that explain the same
    within ten of 2 ln L.
    """

    candidate: FaultCandidate
    value: float
    std: float
    gain: float
    inseparable: tuple[Fault, ...] = ()


@dataclass(frozen=True, slots=True)
class Compatibility:
    """Faults found, and what each other candidate would be if it were one too.

    ``misfit`` is the residual of each sensor over its noise with the faults removed, ``checked``
    whether other sensors determine what a sensor measures.
    """

    sensors: tuple[str, ...]
    faults: tuple[Fault, ...]
    estimates: tuple[Fault, ...]
    misfit: Float[np.ndarray, " n_y"]
    coherence: Float[np.ndarray, " n_y"]
    checked: Mapping[str, bool]
    band_hz: tuple[float, float]
    n_frequencies: int


@dataclass(frozen=True, slots=True)
class _Tried:
    """A candidate with the value and cost of its fit."""

    candidate: FaultCandidate
    value: float
    cost: float


def check_compatibility(records: Sequence[FlightRecord]) -> Compatibility:
    """Find the fewest faults that make all sensors of one or many maneuvers agree.

    Parameters
    ----------
    records
        Maneuvers with the same sensors; each fault is common to all.

    Raises
    ------
    NotIdentifiable
        If no more sensors than motions were recorded, or nothing moves.

    Notes
    -----
    The motion is projected out at each frequency (variable projection: Golub and Pereyra, SIAM
    Journal on Numerical Analysis 10, 1973, doi:10.1137/0710036), and a constant bias of each
    sensor with it. What is left is the likelihood of the faults, which enter one by one while
    2 ln L grows by more than 25; every candidate is fitted, from several starts, before the best
    is selected. Noise grows to the residual of each sensor, and the search is repeated.
    """
    first = build_likelihood(records)
    candidates = list_candidates(records[0].select(frozenset(first.names)))
    values, turns = _pursue(first, candidates)
    current = first.adjust_noise(values)
    if values and current.noise.max() > MOST_MISFIT:
        # The faults do not explain the residuals: with their noise, other faults may be found.
        current = first.adjust_noise({})
    for _ in range(_NOISE_ROUNDS):
        if np.allclose(current.noise, 1.0, atol=_NOISE_CONVERGED):
            break
        before = current.noise
        values, turns = _pursue(current, candidates)
        current = first.adjust_noise(values)
        if np.max(np.abs(np.log(current.noise / before))) < _NOISE_CONVERGED:
            break
    return _describe(current, candidates, values, turns)


def list_candidates(record: FlightRecord) -> tuple[FaultCandidate, ...]:
    """List the possible faults of the sensors of a record."""
    found: list[FaultCandidate] = []
    for one in record.sensors:
        found.append(FaultCandidate(SensorFaultKind.DELAY, one.name))
        if one.kind != AIRSPEED_PROBE.kind:
            found.append(FaultCandidate(SensorFaultKind.SCALE, one.name))
        if axis := _ARMS.get((one.kind, one.axis)):
            found.append(FaultCandidate(SensorFaultKind.ARM, one.name, axis))
    kinds = {one.kind for one in record.sensors}
    if kinds & {ACCELEROMETER.kind, ALTITUDE}:
        name = "airspeed" if record.airspeed is None else record.airspeed.name
        found.append(FaultCandidate(SensorFaultKind.AIRSPEED, name))
    return tuple(found)


def is_unit_factor(value: float, std: float) -> float | None:
    """Return the factor of a wrong sign or unit that a ratio equals, else None."""
    for factor in UNIT_FACTORS:
        away = abs(value / factor - 1.0)
        if away < max(0.03, 3.0 * std / abs(factor)) and away < 0.3:
            return factor
    return None


def _pursue(
    likelihood: FaultLikelihood, candidates: Sequence[FaultCandidate]
) -> tuple[dict[FaultCandidate, float], list[list[_Tried]]]:
    """Enter faults one by one; return their values, and what was tried at each turn."""
    values: dict[FaultCandidate, float] = {}
    turns: list[list[_Tried]] = []
    cost = likelihood.compute_cost(values)
    while len(turns) < _MOST_FAULTS:
        rest = [one for one in candidates if one not in values]
        tried = [_try(likelihood, *start, values) for start in _start(likelihood, rest, values)]
        if not tried:
            break
        least = min(one.cost for one in tried)
        if not 2.0 * (cost - least) > _LEAST_GAIN:
            break
        near = sorted(
            (one for one in tried if 2.0 * (one.cost - least) < _INSEPARABLE),
            key=lambda one: (_rank(one), one.cost),
        )
        near = list({one.candidate: one for one in reversed(near)}.values())[::-1]
        first = near[0]
        trial, lower = likelihood.fit({**values, first.candidate: first.value}, (
            *values, first.candidate,
        ))  # fmt: skip
        value, std = trial[first.candidate], likelihood.estimate_std(trial)[first.candidate]
        size = abs(np.log(value)) if first.candidate.is_ratio and value > 0.0 else abs(value)
        if not size > _LEAST_SIGMAS * std:
            break
        values, cost = trial, lower
        turns.append(near)
    return values, turns


def _start(
    likelihood: FaultLikelihood, candidates: Sequence[FaultCandidate], known: Values
) -> list[tuple[FaultCandidate, float]]:
    """Select the most promising candidates, each with the best of several starts."""
    cost = likelihood.compute_cost(known)
    is_poor = cost > _POOR * likelihood.n_frequencies * len(likelihood.names)
    starts: list[tuple[float, FaultCandidate, float]] = []
    linear = likelihood.linearize(known, candidates)
    for one, (_, least, _) in zip(candidates, linear, strict=True):
        starts.append((least, one, one.neutral))
        further: Sequence[float] = ()
        if is_poor and one.kind is SensorFaultKind.DELAY:
            further = _DELAYS_S
        elif is_poor and one.kind is SensorFaultKind.SCALE:
            further = tuple(UNIT_FACTORS)
        costs = [likelihood.compute_cost({**known, one: value}) for value in further]
        if costs and min(costs) < cost:
            starts.append((min(costs), one, further[int(np.argmin(costs))]))
    starts.sort(key=lambda start: start[0])
    return [(one, value) for _, one, value in starts[:_PROMISING]]


def _try(likelihood: FaultLikelihood, one: FaultCandidate, start: float, known: Values) -> _Tried:
    """Fit one further fault."""
    found, cost = likelihood.fit({**known, one: start}, (one,))
    if not _is_plausible(one, found[one]):
        return _Tried(one, one.neutral, float("inf"))
    return _Tried(one, found[one], cost)


def _is_plausible(one: FaultCandidate, value: float) -> bool:
    """Whether a ratio is near one, or of a scale factor minus one or that of two units."""
    if not one.is_ratio:
        return True
    if one.kind is SensorFaultKind.SCALE and is_unit_factor(value, 0.1 * abs(value)) is not None:
        return True
    return 1.0 / _LARGEST_RATIO < abs(value) < _LARGEST_RATIO


def _rank(tried: _Tried) -> int:
    """Order of faults that the data do not separate, the most plausible first.

    A vane and an accelerometer with contrary arms are one fault of kinematics: whichever stands
    ahead of its place is named, since booms and noses are where a place is forgotten. The ratio of
    airspeeds that only accelerometers contradict is one of them.
    """
    one, value = tried.candidate, tried.value
    if one.kind is SensorFaultKind.SCALE and is_unit_factor(value, 0.0) is not None:
        return 0
    if one.kind is SensorFaultKind.ARM and value < 0.0:
        return 2
    return 2 if one.kind is SensorFaultKind.AIRSPEED else 1


def _describe(
    likelihood: FaultLikelihood,
    candidates: Sequence[FaultCandidate],
    values: Values,
    turns: Sequence[Sequence[_Tried]],
) -> Compatibility:
    step_s = max(one.record.step_s for one in likelihood.parts)
    std = likelihood.estimate_std(values)
    cost = likelihood.compute_cost(values)
    faults = []
    for turn in turns:
        one = turn[0].candidate
        rest = {k: v for k, v in values.items() if k != one}
        gain = 2.0 * (likelihood.compute_cost(rest) - cost)
        others = []
        for other in turn[1:]:
            if other.candidate in values:
                continue
            found, own = likelihood.fit({**rest, other.candidate: other.value}, (other.candidate,))
            if 2.0 * (own - cost) < _INSEPARABLE:
                error = likelihood.estimate_std(found)[other.candidate]
                lost = gain - 2.0 * (own - cost)
                others.append(
                    _build_fault(other.candidate, found[other.candidate], error, lost, step_s)
                )
        fault = _build_fault(one, values[one], std[one], gain, step_s)
        faults.append(replace(fault, inseparable=tuple(others)))
    estimates = []
    rest = [one for one in candidates if one not in values]
    for one, (step, own, error) in zip(rest, likelihood.linearize(values, rest), strict=True):
        value = one.advance(one.neutral, step)
        estimates.append(_build_fault(one, value, error, 2.0 * (cost - own), step_s))
    leverage = np.concatenate([one.leverage for one in likelihood.project(values)])
    checked = np.min(leverage, axis=0) < 1.0 - 1e-3
    return Compatibility(
        sensors=likelihood.names,
        faults=tuple(faults),
        estimates=tuple(estimates),
        misfit=likelihood.noise,
        coherence=likelihood.compute_coherence(values),
        checked=dict(zip(likelihood.names, checked.tolist(), strict=True)),
        band_hz=likelihood.band_hz,
        n_frequencies=likelihood.n_frequencies,
    )


def _build_fault(
    one: FaultCandidate, value: float, std: float, gain: float, step_s: float
) -> Fault:
    if one.is_ratio:
        std = abs(value) * float(np.hypot(std, _CALIBRATION))
    elif one.kind is SensorFaultKind.DELAY:
        std = float(np.hypot(std, _CLOCK * step_s))
    return Fault(one, value, std, gain)
