"""Flown against commanded: servo of a surface, motion without command, and its rate limit.

A surface moves as delta = A (c + K y) + e: its servo A on the recorded excitation c, what the
controller feeds back from the motion y, and e, which nobody commanded. A and A K are smooth in
frequency, a lightly damped mode in y is not; so both are estimated in a window about every
frequency from the other frequencies of the window, and e is what this does not predict.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float
from scipy import optimize

_HALF_WINDOW = 20  # frequencies to each side: A and A K change little over 41 of them
_MIN_OWN = 6  # harmonics of the surface in a window, for value and slope of A
_LEVEL_WINDOW = 30  # frequencies to each side whose median is the level of e
_MAX_FED_BACK = 3  # outputs: rates, attitudes and load factor in the laws that are flown
_LEAST_GAIN = 1.7  # by which one more output must lower the mean square of e
_RANK = 1e-9  # of the largest singular value: smaller ones are rounding
_STUCK = 0.1  # of the commanded deflection
_LOST = 0.2  # of the servo's response: a harmonic below never reached the surface
_LARGEST_SERVO_ERROR = 0.5  # rms of A about the servo, relative: above, it is none of 2nd order
_DELAYS_S = tuple(np.arange(-0.05, 0.2501, 0.005))  # tried as starts [s]
_MOTION_RATIO = 30.0  # power over the level: exceeded by noise at one of 1e13 frequencies
_RATE_QUANTILES = (0.75, 0.8, 0.85, 0.9, 0.93, 0.95, 0.97, 0.98, 0.99, 0.995)
_RATE_SIGMAS = 6.0  # of the effect of a rate limit: noise alone exceeds it once in 1e8 surfaces


@dataclass(frozen=True, slots=True)
class Servo:
    """Servo of second order with delay, A = g exp(-j w d) wn^2 / (wn^2 - w^2 + 2 j z wn w).

    ``gain`` is negative where the surface moves against its command. ``misfit`` is the rms of
    the response about it, relative to its median size. [1], [s], [rad/s], [1], [1]
    """

    gain: float
    delay_s: float
    natural_frequency: float
    damping: float
    misfit: float

    def compute_response(
        self, omega: Float[np.ndarray, " n_omega"]
    ) -> Complex[np.ndarray, " n_omega"]:
        """Compute the response of the deflection to the command. [1]"""
        return _respond(
            np.array([self.gain, self.delay_s, self.natural_frequency, self.damping]), omega
        )


@dataclass(frozen=True, slots=True)
class RateLimit:
    """A rate that a surface reaches and does not exceed [rad/s], and its share of the time."""

    rate: float
    share: float


@dataclass(frozen=True, slots=True)
class Oscillation:
    """A single oscillation: amplitude [rad], frequency [Hz], and power over its neighbours'."""

    amplitude: float
    frequency_hz: float
    ratio: float


@dataclass(frozen=True, slots=True)
class SurfaceCheck:
    """A surface compared with its command.

    ``response`` is the median size of A at the surface's harmonics, ``servo`` None where the
    surface is stuck or where no servo of second order describes it. ``fed_back`` are the outputs
    that the controller moves it with, ``uncommanded`` the largest oscillation that neither
    explains, ``lost`` the harmonics that were commanded and not flown.
    """

    name: str
    response: float
    servo: Servo | None
    fed_back: tuple[str, ...]
    uncommanded: Oscillation | None
    rate_limit: RateLimit | None
    lost: tuple[int, ...]

    @property
    def stuck(self) -> bool:
        """Whether the surface does not follow its command."""
        return self.response < _STUCK


def check_surface(
    name: str,
    harmonics: Sequence[int],
    highest: int,
    period_s: float,
    command: Complex[np.ndarray, " n_omega"],
    deflection: Complex[np.ndarray, " n_omega"],
    outputs: Complex[np.ndarray, "n_omega n_y"],
    output_names: Sequence[str],
) -> SurfaceCheck:
    """Compare the deflection of a surface with its command.

    Parameters
    ----------
    name
        Name of the surface.
    harmonics, highest, period_s
        Harmonics of the surface in its multisine, the highest of any surface, and the period.
        [1], [1], [s]
    command, deflection, outputs
        Transforms over the whole record from rest to rest at the frequencies k 2 pi / T with
        k = 1, 2, ..., n_omega, times 2 / T: amplitudes. [rad], [unit of the output]
    output_names
        Outputs that a controller may feed back.

    Notes
    -----
    In each window of 41 frequencies delta is fitted by least squares with c and y as regressors,
    each with a coefficient that is linear in frequency; the residual at its centre is e / (1 - h)
    with the leverage h of the centre, the residual of a fit without it. Outputs are selected
    forward while the mean square of e falls by more than 1.7.
    """
    k = np.arange(1, command.size + 1)
    own = np.isin(k, harmonics)
    omega = 2.0 * np.pi * k / period_s
    first, last = min(harmonics) - 1, command.size
    half = max(_HALF_WINDOW, _MIN_OWN * int(np.max(np.diff(sorted(harmonics)), initial=1)) // 2)
    band = slice(first, last)
    excited = slice(first, highest)
    found = _select_fed_back(command[excited], deflection[excited], outputs[excited], half)
    # Above it, where nothing is commanded, outputs would explain the motion that causes them.
    moved = np.where((k <= highest)[:, None], outputs[:, found], 0.0)
    columns = np.column_stack([command, moved])[band]
    residual, servo_response = _fit_locally(deflection[band], columns, half)
    own, omega = own[band], omega[band]
    typical = float(np.median(np.abs(servo_response[own])))
    servo = None if typical < _STUCK else fit_servo(omega[own], servo_response[own])
    lost = ()
    if servo is not None:
        # With the servo in the regressors their coefficients hardly change with frequency.
        response = servo.compute_response(omega)
        residual, ratio = _fit_locally(deflection[band], response[:, None] * columns, half)
        servo = fit_servo(omega[own], ratio[own] * response[own])
        expected = ratio[own] * response[own]
        flown = residual[own] / command[band][own] + expected  # without what is fed back
        lost = tuple(int(n) for n in k[band][own][np.abs(flown) < _LOST * np.abs(expected)])
    power = np.abs(residual) ** 2 / _compute_level(residual)
    apart = np.where((power > _MOTION_RATIO) & ~np.isin(k[band], lost), np.abs(residual), 0.0)
    at = int(np.argmax(apart))
    oscillation = Oscillation(float(apart[at]), float(k[band][at] / period_s), float(power[at]))
    return SurfaceCheck(
        name=name,
        response=typical,
        servo=servo,
        fed_back=tuple(output_names[i] for i in found),
        uncommanded=oscillation if apart[at] > 0.0 else None,
        rate_limit=None
        if servo is None
        else _find_rate_limit(servo, omega, period_s, deflection[band], residual),
        lost=lost,
    )


def fit_servo(
    omega: Float[np.ndarray, " n_omega"], response: Complex[np.ndarray, " n_omega"]
) -> Servo | None:
    """Fit a servo of second order with delay to the response of a deflection to its command.

    Parameters
    ----------
    omega, response
        Frequencies and response at them. [rad/s], [1]

    Returns
    -------
    Servo or None
        None where no such servo describes the response.

    Notes
    -----
    Least squares in gain, delay, natural frequency and damping ratio. Start: with the delay
    given, 1/A is linear in the other three, and the delay is the best of a grid.
    """
    size = float(np.median(np.abs(response)))
    weighted = np.abs(response)[:, None]
    powers = np.column_stack([np.ones(omega.size), 1j * omega, -(omega**2)])

    def solve(delay: float) -> tuple[float, Float[np.ndarray, " 3"]]:
        # exp(-j w d) / A is a real polynomial in j w; weighted by |A|, its errors are relative.
        target = weighted[:, 0] * np.exp(-1j * omega * delay) / response
        design = weighted * powers / size
        stacked = np.concatenate([design.real, design.imag])
        scale = np.linalg.norm(stacked, axis=0)
        found, *_ = np.linalg.lstsq(
            stacked / scale, np.concatenate([target.real, target.imag]) / size, rcond=_RANK
        )
        found = found / scale
        error = np.abs(design @ found - target / size)
        return float(error @ error), found

    def misfit(theta: np.ndarray) -> np.ndarray:
        error = (_respond(theta, omega) - response) / size
        return np.concatenate([error.real, error.imag])

    delay = min(_DELAYS_S, key=lambda one: solve(one)[0])
    constant, slope, square = solve(delay)[1]
    # Above the band the servo is not seen: its natural frequency may come out imaginary.
    natural = float(np.sqrt(max(constant / square, omega[-1] ** 2)))
    first = (1.0 / constant, delay, natural, max(0.5 * slope / constant * natural, 0.1))
    best = optimize.least_squares(misfit, first, method="lm", x_scale=(size, 0.01, natural, 0.5))
    rms = float(np.sqrt(2.0 * best.cost / omega.size))
    if rms > _LARGEST_SERVO_ERROR:
        return None
    gain, delay, natural_frequency, damping = (float(value) for value in best.x)
    return Servo(gain, delay, natural_frequency, damping, rms)


def _respond(
    theta: Float[np.ndarray, " 4"], omega: Float[np.ndarray, " n_omega"]
) -> Complex[np.ndarray, " n_omega"]:
    gain, delay, natural, damping = theta
    servo = natural**2 / (natural**2 - omega**2 + 2j * damping * natural * omega)
    return gain * np.exp(-1j * omega * delay) * servo


def _select_fed_back(
    command: Complex[np.ndarray, " n_omega"],
    deflection: Complex[np.ndarray, " n_omega"],
    outputs: Complex[np.ndarray, "n_omega n_y"],
    half: int,
) -> list[int]:
    """Select the outputs that explain the deflection beside the command."""

    def compute_misfit(selected: list[int]) -> float:
        """Compute the mean square that the windows, one beside the other, leave unexplained."""
        columns = np.column_stack([command, outputs[:, selected]])
        fit = _decompose(deflection, columns, half, 2 * half + 1)
        left = np.sum(np.abs(deflection[fit.at]) ** 2, axis=1) - np.sum(
            np.abs(fit.inner) ** 2, axis=1
        )
        free = fit.at.shape[1] - np.sum(fit.retained, axis=1)
        return float(np.sum(np.maximum(left, 0.0) / np.maximum(free, 1)))

    selected: list[int] = []
    least = compute_misfit(selected)
    while len(selected) < min(_MAX_FED_BACK, outputs.shape[1]):
        rest = [i for i in range(outputs.shape[1]) if i not in selected]
        trials = [compute_misfit([*selected, i]) for i in rest]
        best = int(np.argmin(trials))
        if trials[best] * _LEAST_GAIN > least:
            break
        least = trials[best]
        selected.append(rest[best])
    return selected


@dataclass(frozen=True, slots=True)
class _Windows:
    """Singular value decompositions of the regressors in windows, scaled by column.

    ``at`` (n_windows, width) are their frequencies, ``centre`` the place of the centre in each.
    """

    at: np.ndarray
    centre: np.ndarray
    u: np.ndarray
    s: np.ndarray
    vh: np.ndarray
    size: np.ndarray
    retained: np.ndarray
    inner: np.ndarray


def _decompose(
    target: Complex[np.ndarray, " n_omega"],
    regressors: Complex[np.ndarray, "n_omega n_r"],
    half: int,
    step: int = 1,
) -> _Windows:
    """Decompose windows about every ``step``-th frequency; coefficients linear in frequency."""
    n = target.size
    width = min(2 * half + 1, n)
    middle = np.arange(half if step > 1 and n > half else 0, n, step)
    first = np.clip(middle - half, 0, n - width)
    at = first[:, None] + np.arange(width)
    shift = (at - middle[:, None]) / half
    design = np.concatenate([regressors[at], regressors[at] * shift[:, :, None]], axis=2)
    size = np.linalg.norm(design, axis=1)
    size[size == 0.0] = 1.0
    u, s, vh = np.linalg.svd(design / size[:, None, :], full_matrices=False)
    retained = s > _RANK * s[:, :1]
    u = np.where(retained[:, None, :], u, 0.0)
    inner = np.einsum("cwk,cw->ck", u.conj(), target[at])
    return _Windows(at, middle - first, u, s, vh, size, retained, inner)


def _fit_locally(
    target: Complex[np.ndarray, " n_omega"],
    regressors: Complex[np.ndarray, "n_omega n_r"],
    half: int,
) -> tuple[Complex[np.ndarray, " n_omega"], Complex[np.ndarray, " n_omega"]]:
    """Fit in a window about every frequency.

    Returns the residual at the centre of a fit without it, and the first regressor's coefficient.
    """
    fit = _decompose(target, regressors, half)
    u = np.take_along_axis(fit.u, fit.centre[:, None, None], axis=1)[:, 0]
    leverage = np.sum(np.abs(u) ** 2, axis=1)
    residual = target - np.sum(u * fit.inner, axis=1)
    scaled = np.where(fit.retained, fit.inner / np.where(fit.retained, fit.s, 1.0), 0.0)
    coefficient = np.sum(fit.vh[:, :, 0].conj() * scaled, axis=1) / fit.size[:, 0]
    return residual / np.maximum(1.0 - leverage, 1.0 / fit.at.shape[1]), coefficient


def _compute_level(residual: Complex[np.ndarray, " n_omega"]) -> Float[np.ndarray, " n_omega"]:
    """Compute the mean of |e|^2 about every frequency from the median of its neighbours."""
    n = residual.size
    width = min(2 * _LEVEL_WINDOW + 1, n)
    first = np.clip(np.arange(n) - _LEVEL_WINDOW, 0, n - width)
    power = np.abs(residual) ** 2
    level = np.median(power[first[:, None] + np.arange(width)], axis=1) / np.log(2.0)
    return np.maximum(level, np.finfo(float).tiny)


def _find_rate_limit(
    servo: Servo,
    omega: Float[np.ndarray, " n_omega"],
    period_s: float,
    deflection: Complex[np.ndarray, " n_omega"],
    residual: Complex[np.ndarray, " n_omega"],
) -> RateLimit | None:
    """Find the rate limit whose effect on the predicted rate is what the residual holds.

    A rate clipped by p = clip(r) - r moves the deflection by
    p (s + 2 z wn) / (s^2 + 2 z wn s + wn^2): the velocity is held while it is clipped, and the
    servo returns from there.
    """
    k = np.rint(omega * period_s / (2.0 * np.pi)).astype(int)
    n = 8 * int(k[-1] + 1)
    spectrum = np.zeros(n // 2 + 1, dtype=complex)
    spectrum[k] = 1j * omega * (deflection - residual) * n / 2.0
    rate = np.fft.irfft(spectrum, n)
    s, wn = 1j * omega, servo.natural_frequency
    effect = (s + 2.0 * servo.damping * wn) / (s**2 + 2.0 * servo.damping * wn * s + wn**2)
    weight = 1.0 / _compute_level(residual)
    best, found = 0.0, None
    for quantile in _RATE_QUANTILES:
        limit = float(np.quantile(np.abs(rate), quantile))
        clipped = np.clip(rate, -limit, limit) - rate
        expected = effect * np.fft.rfft(clipped)[k] * 2.0 / n
        information = 2.0 * float(np.sum(np.abs(expected) ** 2 * weight))
        if information <= 0.0:
            continue
        score = 2.0 * float(np.sum((expected.conj() * residual).real * weight))
        gain = 2.0 * score - information
        if gain > best and score > _RATE_SIGMAS * np.sqrt(information):
            best, found = gain, RateLimit(limit, 1.0 - quantile)
    return found
