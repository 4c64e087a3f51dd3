"""Flutter prediction by extrapolation: damping, flutter margin, envelope function.

These methods need no model, only the roots of a mode at the speeds flown. Compared with
the model's own prediction they show the benefit of a known structure. Each raises
NotIdentifiable where zero is never reached, or fewer than three airspeeds were flown.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from flexsid.errors import NotIdentifiable

_WINDOW_PERIODS = 20.0  # of the slower root: window of the impulse response


@dataclass(frozen=True, slots=True)
class TestPoint:
    """Two roots that approach each other, as identified at one speed.

    ``critical`` is the one that loses damping, ``partner`` the one it coalesces with. [rad/s]
    """

    airspeed: float
    dynamic_pressure: float
    critical: complex
    partner: complex


def extrapolate_damping(points: Sequence[TestPoint]) -> float:
    """Extrapolate the critical decay rates by a parabola to zero; return the airspeed. [m/s]"""
    V = np.array([point.airspeed for point in points])
    rate = np.array([np.real(point.critical) for point in points])
    return _extrapolate_to_zero(V, rate, "the decay rate")


def extrapolate_flutter_margin(points: Sequence[TestPoint]) -> float:
    """Extrapolate the flutter margin of two roots to zero; return the airspeed. [m/s]

    Notes
    -----
    Source: Zimmerman and Weissenburger, J. Aircraft 1 (1964): Routh's discriminant of the
    quartic of two roots, quadratic in dynamic pressure for quasi-steady aerodynamics.
    """
    q = np.array([point.dynamic_pressure for point in points])
    margin = np.array([_compute_margin(point.critical, point.partner) for point in points])
    at = _extrapolate_to_zero(q, margin, "the flutter margin")
    ratio = points[-1].airspeed / np.sqrt(points[-1].dynamic_pressure)
    return float(np.sqrt(at) * ratio)


def extrapolate_envelope(points: Sequence[TestPoint]) -> float:
    """Extrapolate the decay of the envelope of an impulse response; return the airspeed. [m/s]

    Notes
    -----
    Source: Cooper, Emmett, Wright and Schofield, J. Aircraft 30 (1993). The shape
    parameter is the inverse of the envelope's centroid in time; without decay the
    centroid lies at half the window.
    """
    V = np.array([point.airspeed for point in points])
    if len(points) < 3:
        return _extrapolate_to_zero(V, V, "the shape parameter")
    slowest = min(abs(root) for point in points for root in (point.critical, point.partner))
    window_s = 2.0 * np.pi * _WINDOW_PERIODS / slowest
    time_s = np.linspace(0.0, window_s, 4000)
    shape = []
    for point in points:
        roots = np.array([point.critical, point.partner])
        envelope = np.abs(np.sum(np.exp(roots[:, None] * time_s), axis=0))
        shape.append(float(envelope.sum() / (envelope @ time_s)))
    return _extrapolate_to_zero(V, np.array(shape) - 2.0 / window_s, "the shape parameter")


def _compute_margin(a: complex, b: complex) -> float:
    """Flutter margin F of two roots beta + j omega."""
    b1, w1, b2, w2 = a.real, abs(a.imag), b.real, abs(b.imag)
    half = 0.5 * (w2**2 - w1**2)
    mean = 0.5 * (w2**2 + w1**2)
    total = 0.5 * (b2 + b1)
    first = (half + 0.5 * (b2**2 - b1**2)) ** 2
    second = 4.0 * b1 * b2 * (mean + 2.0 * total**2)
    third = ((b2 - b1) / (b2 + b1) * half + 2.0 * total**2) ** 2
    return first + second - third


def _extrapolate_to_zero(
    x: Float[np.ndarray, " n"], y: Float[np.ndarray, " n"], what: str
) -> float:
    """Where a parabola (a line through fewer than four points) first reaches zero beyond x[0]."""
    n_distinct = np.unique(np.round(x / np.abs(x).max(initial=0.0), 2)).size
    if n_distinct < 3:
        raise NotIdentifiable(
            f"{what} of {x.size} test points at {n_distinct} airspeeds cannot be extrapolated; it"
            " needs three",
            code="too-few-points",
        )
    size = float(np.abs(y).max()) or 1.0
    fit = np.polynomial.Polynomial.fit(x, y / size, 2 if n_distinct > 3 else 1)
    roots = np.asarray(fit.roots(), dtype=complex)
    real = np.real(roots[np.abs(np.imag(roots)) < 1e-9 * float(x.mean() + np.ptp(x))])
    beyond = real[real > x.min()]
    if not beyond.size:
        raise NotIdentifiable(
            f"{what} does not reach zero at any higher speed", code="no-flutter-in-sight"
        )
    return float(beyond.min())
