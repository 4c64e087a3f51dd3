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
    rate
        Recorded angular rate. [rad/s]
    attitude
        Angle that integrates it, on the same clock; None where none was recorded. [rad]
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
    turn, time_s = _compute_turn(attitude, edge, rate_hz)
    value = float(_average_rate(rate, edge)) - scale * turn / time_s
    parts = [
        float(_average_rate(r, edge))
        - scale * _compute_turn(a, edge, rate_hz)[0] / _compute_turn(a, edge, rate_hz)[1]
        for r, a in zip(np.array_split(rate, _PARTS), np.array_split(attitude, _PARTS), strict=True)
        if r.size > 2 * edge
    ]
    spread = _estimate_std(parts)
    std = float(np.hypot(spread, scale_std * turn / time_s))
    return Bias(value=value, std=std, basis="the mean rate is the change of attitude")


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
    """Flight path angle from recorded altitude.

    Parameters
    ----------
    altitude
        Of the whole record. [m]
    rate_hz
        Samples per second. [Hz]
    airspeed
        True airspeed. [m/s]
    """
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


def _compute_turn(attitude: np.ndarray, edge: int, rate_hz: float) -> tuple[float, float]:
    """Change from the middle of the first edge to the middle of the last, and its time. [s]"""
    change = float(attitude[-edge:].mean() - attitude[:edge].mean())
    return change, (attitude.size - edge) / rate_hz


def _average_rate(rate: np.ndarray, edge: int) -> np.floating:
    """Mean of a rate weighted like the difference of averaged ends: a trapezoid."""
    weight = np.convolve(np.ones(rate.size - edge), np.ones(edge))
    return np.sum(weight * 0.5 * (rate[:-1] + rate[1:])) / np.sum(weight)


def _estimate_std(parts: Sequence[float]) -> float:
    """Standard error of the mean of a few parts, widened to the variance of Student's t."""
    count = len(parts)
    if count < 4:
        return float("nan")
    widened = np.sqrt((count - 1) / (count - 3))
    return float(widened * np.std(parts, ddof=1) / np.sqrt(count))


def _fit_slope(values: np.ndarray) -> float:
    """Least-squares slope per sample."""
    place = np.arange(values.size) - 0.5 * (values.size - 1)
    return float(place @ values / (place @ place))
