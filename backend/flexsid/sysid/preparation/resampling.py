"""Bring channels to one clock, with what instruments and delays did to their phase undone."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

import numpy as np
from jaxtyping import Complex, Float
from scipy import fft

from flexsid.errors import BadInput

_MOST_AMPLIFIED = 3.0  # beyond, undoing a filter would bring up its noise
_TAPER = 0.2  # of the band: the edge of the pass band is no step
_ENDS_S = 0.1
_EXTENSION_S = 2.0  # longer than any filter on board rings
_FINEST = 10_000  # largest denominator of a ratio of rates

Response = Callable[[Float[np.ndarray, " n_omega"]], Complex[np.ndarray, " n_omega"]]


def resample(
    samples: Float[np.ndarray, " n_samples"],
    rate_hz: float,
    start_s: float,
    wanted_hz: float,
    wanted_start_s: float,
    count: int,
    response: Response | None = None,
    band_hz: tuple[float, float] | None = None,
) -> Float[np.ndarray, " count"]:
    """Give samples of a channel at the times of another clock.

    Parameters
    ----------
    samples
        Of one channel. [channel unit]
    rate_hz, start_s
        Its clock. [Hz], [s]
    wanted_hz, wanted_start_s, count
        The clock of the answer; it may be slower or faster.
    response
        Recorded over true quantity at angular frequencies, delays included; undone where
        that amplifies by no more than three.
    band_hz
        What lies outside is filtered out without phase; by default nothing below, and above
        what the slower of the two clocks does not hold. [Hz]

    Raises
    ------
    BadInput
        If the rates have no simple ratio, or the channel is too short.

    Notes
    -----
    A delay becomes a phase, exp(j omega tau) at every frequency: no sample is shifted.
    The straight line between the ends of the record is set aside before the transform and
    delayed apart, and the record goes on beyond its ends mirrored and fading, so that it does
    not ring there.
    """
    x = np.asarray(samples, dtype=float)
    if x.size < 4:
        raise BadInput(f"{x.size} samples cannot be resampled", code="too-short")
    ratio = Fraction(wanted_hz / rate_hz).limit_denominator(_FINEST)
    if ratio == 0 or abs(float(ratio) * rate_hz - wanted_hz) * count > 0.1 * wanted_hz:
        raise BadInput(
            f"{rate_hz:g} Hz cannot be brought to {wanted_hz:g} Hz exactly; choose a rate of "
            "simple ratio",
            code="bad-rate",
        )
    n_end = max(1, min(x.size // 4, round(_ENDS_S * rate_hz)))
    time = np.arange(x.size) / rate_hz
    low, high = x[:n_end].mean(), x[-n_end:].mean()
    span = time[-1] - time[n_end - 1]
    slope = (high - low) / span if span > 0 else 0.0
    middle = 0.5 * time[n_end - 1]
    x = x - (low + slope * (time - middle))
    x, ahead = _extended(x, round(_EXTENSION_S * rate_hz))
    length = fft.next_fast_len(-(-x.size // ratio.denominator)) * ratio.denominator
    spectrum = fft.rfft(x, length)
    omega = 2.0 * np.pi * rate_hz * np.arange(spectrum.size) / length
    bottom, top = (0.0, 0.5 * min(rate_hz, wanted_hz)) if band_hz is None else band_hz
    gain, delay_s = _undo(omega, response)
    gain *= _pass_band(omega / (2.0 * np.pi), bottom, top)
    later = wanted_start_s - start_s
    spectrum *= gain * np.exp(1j * omega * (later + ahead / rate_hz))
    out_length = length * ratio.numerator // ratio.denominator
    out = np.zeros(out_length // 2 + 1, dtype=complex)
    keep = min(out.size, spectrum.size)
    out[:keep] = spectrum[:keep]
    if keep == out.size and out_length % 2 == 0 and out_length < length:
        out[-1] = np.real(out[-1])
    y = fft.irfft(out, out_length) * (out_length / length)
    wanted = later + np.arange(count) / wanted_hz
    inside = y[np.arange(count) % out_length]
    if bottom > 0.0:
        return inside
    return inside + low + slope * (wanted + delay_s - middle)


def _extended(
    x: Float[np.ndarray, " n_samples"], most: int
) -> tuple[Float[np.ndarray, " n_longer"], int]:
    """Go on beyond both ends, mirrored about them and fading; and how many samples in front."""
    count = max(1, min(most, x.size - 1))
    fade = 0.5 * (1.0 + np.cos(np.pi * np.arange(1, count + 1) / count))
    front = (2.0 * x[0] - x[1 : count + 1]) * fade
    back = (2.0 * x[-1] - x[-2 : -count - 2 : -1]) * fade
    return np.concatenate([front[::-1], x, back]), count


def _undo(
    omega: Float[np.ndarray, " n_omega"], response: Response | None
) -> tuple[Complex[np.ndarray, " n_omega"], float]:
    """One over the response while that is bounded, phase alone beyond; and its delay at rest."""
    if response is None:
        return np.ones(omega.size, dtype=complex), 0.0
    seen = response(np.maximum(omega, 1e-6))
    size = np.abs(seen)
    gain = seen.conj() / np.maximum(size, 1.0 / _MOST_AMPLIFIED) / np.maximum(size, 1e-12)
    first = 2.0 * np.pi * 0.01
    delay_s = -float(np.angle(response(np.array([first]))[0])) / first
    gain[0] = 1.0
    return gain, delay_s


def _pass_band(
    frequency_hz: Float[np.ndarray, " n_omega"], bottom_hz: float, top_hz: float
) -> Float[np.ndarray, " n_omega"]:
    """One between the tapers, zero from the top on and up to half the bottom."""
    start = (1.0 - _TAPER) * top_hz
    place = np.clip((frequency_hz - start) / (top_hz - start), 0.0, 1.0)
    passed = 0.5 * (1.0 + np.cos(np.pi * place))
    if bottom_hz > 0.0:
        place = np.clip(2.0 * frequency_hz / bottom_hz - 1.0, 0.0, 1.0)
        passed *= 0.5 * (1.0 - np.cos(np.pi * place))
    return passed
