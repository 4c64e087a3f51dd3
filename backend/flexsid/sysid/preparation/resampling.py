"""Resampling of channels to one clock, held samples, and symmetric parts of sensors (Eq. 3).

In a symmetric motion both sides heave, surge and twist alike, and move sideways, roll and
yaw with opposite signs. So the symmetric part of a pair is half the sum, but half the
difference for what a mirror turns round: lateral accelerations, roll and yaw
(``SensorModel.mirror_sign``).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from enum import StrEnum
from fractions import Fraction
from typing import Literal

import numpy as np
import scipy
from jaxtyping import Complex, Float, Int

from flexsid.errors import BadInput

# --- Resampling of channels to one clock, with the response of instruments and delays inverted

_LARGEST_GAIN = 3.0  # a larger gain of an inverted filter would amplify noise
_TAPER_SHARE = 0.2  # of the band: width of the cosine taper of the pass band
_ENDS_S = 0.1  # averaged at either end for the straight line between them [s]
_EXTENSION_S = 2.0  # longer than the impulse response of any filter on board [s]
_FINEST = 10_000  # largest denominator of a ratio of rates

Response = Callable[[Float[np.ndarray, " n_omega"]], Complex[np.ndarray, " n_omega"]]


def resample(
    samples: Float[np.ndarray, " n_samples"],
    rate_hz: float,
    start_s: float,
    target_rate_hz: float,
    target_start_s: float,
    count: int,
    response: Response | None = None,
    band_hz: tuple[float, float] | None = None,
) -> Float[np.ndarray, " count"]:
    """Resample a channel at the times of another clock.

    Parameters
    ----------
    samples
        Of one channel. [channel unit]
    rate_hz, start_s
        Its clock. [Hz], [s]
    target_rate_hz, target_start_s, count
        Clock of the result, slower or faster.
    response
        Recorded over true quantity at angular frequencies, delays included; inverted with
        a gain of at most three.
    band_hz
        Pass band of a filter without phase; by default from zero to the Nyquist frequency of
        the slower clock. [Hz]

    Raises
    ------
    BadInput
        If the rates have no simple ratio, or the channel is too short.

    Notes
    -----
    A delay becomes a phase, exp(j omega tau) at every frequency: no sample is shifted.
    The straight line between the ends of the record is subtracted before the transform and
    delayed separately, and the record is extended at its ends, mirrored and fading, against
    ringing.
    """
    x = np.asarray(samples, dtype=float)
    if x.size < 4:
        raise BadInput(f"{x.size} samples cannot be resampled", code="too-short")
    ratio = Fraction(target_rate_hz / rate_hz).limit_denominator(_FINEST)
    if ratio == 0 or abs(float(ratio) * rate_hz - target_rate_hz) * count > 0.1 * target_rate_hz:
        raise BadInput(
            f"{rate_hz:g} Hz cannot be brought to {target_rate_hz:g} Hz exactly; choose a rate of "
            "simple ratio",
            code="bad-rate",
        )
    n_end = max(1, min(x.size // 4, round(_ENDS_S * rate_hz)))
    time = np.arange(x.size) / rate_hz
    low, high = x[:n_end].mean(), x[-n_end:].mean()
    span = time[-1] - time[n_end - 1]
    slope = (high - low) / span if span > 0 else 0.0
    middle = 0.5 * time[n_end - 1]
    ahead = max(1, min(round(_EXTENSION_S * rate_hz), x.size - 1))
    x = _extend(x - (low + slope * (time - middle)), ahead)
    length = scipy.fft.next_fast_len(-(-x.size // ratio.denominator)) * ratio.denominator
    spectrum = scipy.fft.rfft(x, length)
    omega = 2.0 * np.pi * rate_hz * np.arange(spectrum.size) / length
    bottom, top = (0.0, 0.5 * min(rate_hz, target_rate_hz)) if band_hz is None else band_hz
    gain, delay_s = _invert_response(omega, response)
    gain *= _pass_band(omega / (2.0 * np.pi), bottom, top)
    later = target_start_s - start_s
    spectrum *= gain * np.exp(1j * omega * (later + ahead / rate_hz))
    out_length = length * ratio.numerator // ratio.denominator
    out = np.zeros(out_length // 2 + 1, dtype=complex)
    n_common = min(out.size, spectrum.size)
    out[:n_common] = spectrum[:n_common]
    if n_common == out.size and out_length % 2 == 0 and out_length < length:
        out[-1] = np.real(out[-1])
    y = scipy.fft.irfft(out, out_length) * (out_length / length)
    target_time = later + np.arange(count) / target_rate_hz
    inside = y[np.arange(count) % out_length]
    if bottom > 0.0:
        return inside
    return inside + low + slope * (target_time + delay_s - middle)


def _extend(x: Float[np.ndarray, " n_samples"], count: int) -> Float[np.ndarray, " n_longer"]:
    """Extend both ends by so many samples, mirrored and fading."""
    fade = 0.5 * (1.0 + np.cos(np.pi * np.arange(1, count + 1) / count))
    longer = np.pad(x, count, mode="reflect", reflect_type="odd")
    longer[:count] *= fade[::-1]
    longer[-count:] *= fade
    return longer


def _invert_response(
    omega: Float[np.ndarray, " n_omega"], response: Response | None
) -> tuple[Complex[np.ndarray, " n_omega"], float]:
    """Inverse of the response with bounded gain, and its delay at zero frequency."""
    if response is None:
        return np.ones(omega.size, dtype=complex), 0.0
    seen = response(np.maximum(omega, 1e-6))
    size = np.abs(seen)
    gain = seen.conj() / np.maximum(size, 1.0 / _LARGEST_GAIN) / np.maximum(size, 1e-12)
    first = 2.0 * np.pi * 0.01
    delay_s = -float(np.angle(response(np.array([first]))[0])) / first
    gain[0] = 1.0
    return gain, delay_s


def _pass_band(
    frequency_hz: Float[np.ndarray, " n_omega"], bottom_hz: float, top_hz: float
) -> Float[np.ndarray, " n_omega"]:
    """One between the tapers, zero from the top on and up to half the bottom."""
    start = (1.0 - _TAPER_SHARE) * top_hz
    place = np.clip((frequency_hz - start) / (top_hz - start), 0.0, 1.0)
    passed = 0.5 * (1.0 + np.cos(np.pi * place))
    if bottom_hz > 0.0:
        place = np.clip(2.0 * frequency_hz / bottom_hz - 1.0, 0.0, 1.0)
        passed *= 0.5 * (1.0 - np.cos(np.pi * place))
    return passed


# --- Symmetric and antisymmetric parts of left and right sensors (Eq. 3) --------------------------

Part = Literal["symmetric", "antisymmetric"]

_SUFFIX = {"symmetric": "s", "antisymmetric": "a"}


def find_pairs(names: Iterable[str]) -> tuple[tuple[str, str, str], ...]:
    """Left and right names that differ only in the side, and the common name.

    A side is the last letter of a part between underscores: ``az_ofl`` and ``az_ofr`` make
    ``az_of{}``, ``s_ros1l_m45`` and ``s_ros1r_m45`` make ``s_ros1{}_m45``.
    """
    known = list(names)
    found = []
    for name in known:
        parts = name.split("_")
        for index, part in enumerate(parts):
            if len(part) < 2 or not part.endswith("l"):
                continue
            stem = part[:-1]
            other = "_".join([*parts[:index], f"{stem}r", *parts[index + 1 :]])
            if other in known:
                both = "_".join([*parts[:index], f"{stem}{{}}", *parts[index + 1 :]])
                found.append((name, other, both))
    return tuple(found)


def combine_pair(
    left: str, right: str, both: str, sign: float, part: Part
) -> tuple[str, tuple[tuple[str, float], ...]]:
    """Name and weights of one part of a pair; the antisymmetric one is right less left.

    The names are those of ``find_pairs``, the sign is that of ``SensorModel.mirror_sign``.
    """
    name = both.format(_SUFFIX[part])
    if part == "symmetric":
        return name, ((left, 0.5), (right, 0.5 * sign))
    return name, ((left, -0.5 * sign), (right, 0.5))


def parity(weights: Iterable[tuple[float, float]]) -> Part | None:
    """Which part of the motion a combination of two sensors reads; None for any other.

    ``weights`` are those of left and right sensor, each with what a symmetric motion makes of
    it: mirror sign for the right, one for the left.
    """
    seen = [weight * sign for weight, sign in weights]
    if len(seen) != 2 or abs(abs(seen[0]) - abs(seen[1])) > 1e-9 * abs(seen[0]):
        return None
    return "symmetric" if seen[0] * seen[1] > 0 else "antisymmetric"


# --- Channels that repeat each sample until the next one of a slower clock ------------------------


class BetweenSamples(StrEnum):
    """What a signal is between its samples."""

    HELD = "held"  # each until the next, as a surface that moves in steps
    LINEAR = "linear"
    SMOOTH = "smooth"  # a spline


_LEAST_CHANGES = 12  # fewer new samples may be those of a signal that rests
_LEAST_REPEATED = 1.5  # samples between new ones
_LARGEST_SPREAD = 0.6  # samples: two clocks without a common divisor alternate by one
_REGULAR = 0.9  # of the intervals


def find_new_samples(samples: Float[np.ndarray, " n"]) -> Int[np.ndarray, " n_new"] | None:
    """Find the samples with a new value in a held channel; None if it is not held.

    Notes
    -----
    New values at equal intervals of two or more samples are those of a slower clock. A signal that
    rests or is rounded repeats values at irregular intervals; intervals that are multiples of the
    usual one are of a signal that rests for a few of the slower samples.
    """
    x = np.asarray(samples, dtype=float)
    changes = np.flatnonzero(np.diff(x)) + 1
    if changes.size < _LEAST_CHANGES:
        return None
    gaps = np.diff(changes)
    usual = float(np.median(gaps))
    near = gaps[np.abs(gaps - usual) <= 1.0]
    step = float(near.mean())
    if step < _LEAST_REPEATED or near.std() > _LARGEST_SPREAD or gaps.min() < usual - 1.0:
        return None
    whole = np.maximum(np.rint(gaps / step), 1.0)
    if np.mean(np.abs(gaps / whole - step) < 0.5) < _REGULAR:
        return None
    # Where the signal rests, new samples repeat the last value.
    between = [
        int(first) + np.rint(step * np.arange(int(count))).astype(int)
        for first, count in zip(changes[:-1], whole, strict=True)
    ]
    before = changes[0] - np.rint(step * np.arange(int(changes[0] // step), 0, -1)).astype(int)
    after = np.arange(changes[-1], x.size, step).astype(int)
    return np.unique(np.concatenate([before, *between, after]))


def fill_between(
    samples: Float[np.ndarray, " n"], between: BetweenSamples
) -> Float[np.ndarray, " n"]:
    """Replace the repeated samples of a held channel by what the signal was between the new ones.

    A channel that is new at every sample, and one that is held, stay as they are.
    """
    new = None if between is BetweenSamples.HELD else find_new_samples(samples)
    if new is None:
        return samples
    index = np.clip(np.arange(samples.size), new[0], new[-1])
    if between is BetweenSamples.LINEAR:
        return np.interp(index, new, samples[new])
    return scipy.interpolate.make_interp_spline(new, samples[new], k=3)(index)


def respond_between(
    theta: Float[np.ndarray, " n_omega"], between: BetweenSamples | None
) -> Float[np.ndarray, " n_omega"] | Complex[np.ndarray, " n_omega"]:
    """Return the transform of a held or linear signal over the sum of its samples. [1]

    Parameters
    ----------
    theta
        Frequencies times the interval between samples. [rad]
    """
    if between is BetweenSamples.HELD:
        return np.sinc(theta / (2.0 * np.pi)) * np.exp(-0.5j * theta)
    if between is BetweenSamples.LINEAR:
        return np.sinc(theta / (2.0 * np.pi)) ** 2
    return np.ones(theta.size)
