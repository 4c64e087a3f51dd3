"""Biases of gyro and vane from kinematics: attitude integrates pitch rate, alpha is theta - gamma.

Scale factors come from the redundancy of all sensors (``redundancy``); a bias
follows from averages, which do not depend on the dynamics.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

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
