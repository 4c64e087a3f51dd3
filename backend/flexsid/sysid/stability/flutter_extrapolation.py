"""Instabilities seen in flight, and flutter by extrapolation of damping and flutter margin.

These methods need no model, only the roots of a mode at the speeds flown. Compared with
the model's own prediction they show the benefit of a known structure. Each raises
NotIdentifiable where zero is never reached, or fewer than three airspeeds were flown.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from jaxtyping import Complex, Float

from flexsid.errors import NotIdentifiable
from flexsid.sysid.stability.poles import Aeroelastic
from flexsid.sysid.stability.root_tracking import RootLocus

# --- Flutter prediction by extrapolation: damping, flutter margin, envelope function --------------

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


# --- Comparison of predicted instabilities with the roots identified in flight --------------------

_SIGMAS = 2.0  # standard errors from zero at which the sign of a growth rate is determined
_LEAST_PARTICIPATION = 0.25  # of the unstable root, to determine its stability
_BAND_MARGIN = 0.1  # of the band: a mode in vacuo this far outside is still excited


@dataclass(frozen=True, slots=True)
class FlownPoint:
    """Open-loop roots identified by a run, at its airspeed. [m/s]

    ``roots`` are those above and on the real axis, ``growth_std`` the standard errors of their
    real parts, NaN where unknown; ``band`` is that of the data [rad/s]. A run is not
    ``comparable`` where its loading differs too much from the model's.
    """

    airspeed: float
    roots: Complex[np.ndarray, " n"]
    growth_std: Float[np.ndarray, " n"]
    band: tuple[float, float]
    name: str
    comparable: bool = True


class Standing(StrEnum):
    """Status of a predicted instability with respect to flight."""

    AHEAD = "ahead"
    FLOWN = "flown"
    PASSED = "passed"
    CONTRADICTED = "contradicted"
    UNDETERMINED = "undetermined"


@dataclass(frozen=True, slots=True)
class FlownInstability:
    """Speeds between which one root of a model is unstable [m/s], and its participation."""

    words: str
    low: float
    high: float
    branch: int
    participation: Mapping[str, float]


def compare_with_flight(
    instability: FlownInstability,
    locus: RootLocus,
    aircraft: Aeroelastic,
    estimated: frozenset[str],
    flown: Sequence[FlownPoint],
    names: Mapping[str, str],
) -> tuple[Standing, str]:
    """Compare an instability of a model with the flights; return its status and a sentence.

    Parameters
    ----------
    instability, locus, aircraft
        Where a root of the model is unstable, its roots over airspeed, and the model.
    estimated
        Motions whose derivatives were estimated; the others are predicted.
    flown
        Runs that the model is made from.
    names
        Labels of motions.

    Notes
    -----
    A maneuver flown in closed loop may lie beyond open-loop flutter, so that a speed that was
    merely flown contradicts nothing. It is compared with the same root as identified by the run
    there (the nearest one): stable by two standard errors contradicts the model, unstable by as
    much agrees with it, and a root in between, or faster than the data, is undetermined. A root
    with participation of a mode whose frequency was not excited is not identifiable, whatever
    its standard error.
    """
    if not flown:
        return Standing.AHEAD, ""
    blind = _find_unexcited(instability, aircraft, estimated, flown)
    if blind:
        low, high = (edge / (2.0 * np.pi) for edge in _band(flown))
        modes = ", ".join(
            f"{names[name]} ({_omega(aircraft, name) / (2.0 * np.pi):.3g} Hz in vacuo)"
            for name in blind
        )
        return Standing.UNDETERMINED, (
            f"{instability.words} is not determined by these runs: {modes} lies outside the band"
            f" of their data, {low:.2g} to {high:.3g} Hz, so that its derivatives are not"
            " identifiable. Remove the mode from the model, or fly a wider band."
        )
    alike = [point for point in flown if point.comparable]
    fastest = max(alike or flown, key=lambda point: point.airspeed)
    if not alike and instability.low < fastest.airspeed:
        return Standing.AHEAD, (
            f"{fastest.name} was flown at {fastest.airspeed:.1f} m/s with another fuel weight, so"
            " that its roots are not compared."
        )
    if instability.low >= fastest.airspeed:
        return Standing.AHEAD, ""
    within = [point for point in alike if instability.low < point.airspeed < instability.high]
    if not within:
        return Standing.PASSED, (
            f"{instability.words}, stable again from {instability.high:.1f} m/s, lies below"
            f" {fastest.airspeed:.1f} m/s, the speed of {fastest.name}; it was passed and is"
            " not the flutter speed ahead."
        )
    leading = name_leading(instability.participation, names, "and")
    found = [(point, *_find_nearest_root(instability, locus, point)) for point in within]
    agreeing = [one for one in found if one[1] > _SIGMAS * one[2]]
    against = [one for one in found if one[1] < -_SIGMAS * one[2]]
    if agreeing:
        point, growth, std = max(agreeing, key=lambda one: one[1] / max(one[2], 1e-12))
        return Standing.FLOWN, (
            f"It lies below {point.airspeed:.1f} m/s, where {point.name} was flown and identifies"
            f" this open-loop root as unstable, {growth:+.2f} ± {2.0 * std:.2f} rad/s: a control"
            " loop held it."
        )
    if against:
        point, growth, std = min(against, key=lambda one: one[1] / max(one[2], 1e-12))
        return Standing.CONTRADICTED, (
            f"{instability.words} is contradicted by flight: {point.name} was flown at"
            f" {point.airspeed:.1f} m/s and identifies this root as stable there,"
            f" {growth:+.2f} ± {2.0 * std:.2f} rad/s. The derivatives that couple"
            f" {leading} do not hold over these speeds."
        )
    point, growth, std = min(found, key=lambda one: one[2] if np.isfinite(one[2]) else np.inf)
    error = f" ± {2.0 * std:.2f}" if np.isfinite(std) else " with unknown error, in"
    return Standing.UNDETERMINED, (
        f"{instability.words} lies below {point.airspeed:.1f} m/s, which {point.name} was flown at,"
        f" and is not determined: that run identifies the root at {growth:+.2f}{error} rad/s, which"
        f" may be stable. The derivatives that couple {leading} are not"
        " identifiable from these data."
    )


def _find_unexcited(
    instability: FlownInstability,
    aircraft: Aeroelastic,
    estimated: frozenset[str],
    flown: Sequence[FlownPoint],
) -> list[str]:
    """Estimated modes with a large share of the root and outside the band of all data."""
    low, high = _band(flown)
    low, high = low * (1.0 - _BAND_MARGIN), high * (1.0 + _BAND_MARGIN)
    return [
        name
        for name, share in instability.participation.items()
        if share >= _LEAST_PARTICIPATION
        and name in estimated
        and name not in aircraft.derivatives.body.poles
        and not low <= _omega(aircraft, name) <= high
    ]


def _band(flown: Sequence[FlownPoint]) -> tuple[float, float]:
    return min(point.band[0] for point in flown), max(point.band[1] for point in flown)


def _omega(aircraft: Aeroelastic, name: str) -> float:
    return float(aircraft.modes.omega[aircraft.modes.numbers.index(int(name))])


def _find_nearest_root(
    instability: FlownInstability, locus: RootLocus, point: FlownPoint
) -> tuple[float, float]:
    """Growth rate of the identified root next to the model's, and its standard error.

    The model's root is that of the nearest speed of its locus. The error is NaN where the
    root is faster than the data.
    """
    if not point.roots.size:
        return 0.0, float("nan")
    near = int(np.argmin(np.abs(locus.airspeed - point.airspeed)))
    index = int(np.argmin(np.abs(point.roots - locus.roots[near, instability.branch])))
    is_seen = abs(point.roots[index]) <= point.band[1] * (1.0 + _BAND_MARGIN)
    std = float(point.growth_std[index]) if is_seen else float("nan")
    return float(point.roots[index].real), std


def name_leading(shares: Mapping[str, float], names: Mapping[str, str], word: str) -> str:
    """Name the two motions of the largest participation, joined by a word."""
    leading = sorted(shares, key=shares.__getitem__)[::-1][:2]
    return f" {word} ".join(names[name] for name in leading)
