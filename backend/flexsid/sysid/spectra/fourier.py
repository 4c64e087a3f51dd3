"""Finite Fourier transform of sampled channels at arbitrary frequencies, with end correction."""

from __future__ import annotations

from functools import cache, lru_cache

import numpy as np
import scipy
from jaxtyping import Bool, Complex, Float

from flexsid.errors import BadInput

# --- End correction: from a sum of samples to the Fourier integral over the record ----------------

_DEGREE = 5  # of the polynomials through the samples at either end
END_SAMPLES = _DEGREE + 2
"""Samples from a cut on that the integral of a record depends on besides their sum."""

_TERMS = 80  # of a series that shrinks like (theta / 2 pi)^r
_QUADRATURE_ROUNDING = 1e-9  # of a sample: a cut this close to one is at it
_NODES = 8  # of the Gauss rule over less than one sample: exact up to the Nyquist frequency


def correct_ends(
    transform: Complex[np.ndarray, "n_omega n_channels"],
    samples: Float[np.ndarray, "n_samples n_channels"],
    rate_hz: float,
    omega: Float[np.ndarray, " n_omega"],
) -> Complex[np.ndarray, "n_omega n_channels"]:
    """Turn the plain sum over samples into the finite Fourier integral.

    Parameters
    ----------
    transform
        Sum of x exp(-j omega t) / rate, time counted from the first sample.
    samples
        The summed samples; at least twelve.
    rate_hz
        Samples per second. [Hz]
    omega
        Frequencies of the transform, none above half the rate. [rad/s]

    Raises
    ------
    BadInput
        If there are fewer than twelve samples.

    Notes
    -----
    The integral runs from the first sample to the last. Between, the sum is exact for
    any signal below half the rate, so that only the cut ends need weights; with the
    exponential integrated exactly and the samples there continued by a polynomial they
    follow from sum n^k z^n - integral t^k z^t = sum_r zeta(-k-r) (-j theta)^r / r!.
    Departure: the cubic rule of Press et al., Numerical Recipes, Sec. 13.9, also
    attenuates the sum, which is off by 11/720 theta^4 for a signal at the line itself.
    """
    count = _DEGREE + 1
    if samples.shape[0] < 2 * count:
        raise BadInput(
            f"a record of {samples.shape[0]} samples is too short to integrate; it needs at "
            f"least {2 * count}",
            code="record-too-short",
        )
    # Weights of the first samples at theta = omega / rate.
    weights = _compute_end_weights(omega / rate_hz)
    turn = np.exp(-1j * omega * (samples.shape[0] - 1) / rate_hz)
    ends = weights @ samples[:count]
    ends += turn[:, None] * (weights.conj() @ samples[: -count - 1 : -1])
    return transform + ends / rate_hz


def compute_cut_weights(
    theta: Float[np.ndarray, " n_omega"], cut: float, count: int
) -> Complex[np.ndarray, "n_omega n_count"]:
    """Compute weights of the first samples that turn their sum into an integral from a cut on.

    Parameters
    ----------
    theta
        Frequency over sampling rate, at most pi. [rad]
    cut
        Begin of the integral, in samples after the first; need not be an integer.
    count
        Number of weights, at least ``cut`` plus ``END_SAMPLES``.

    Raises
    ------
    BadInput
        If the cut lies before the first sample or beyond the reach of the weights.

    Notes
    -----
    Samples before the cut are subtracted, the first one after it is an end as in
    ``correct_ends``, and the part of a sample between them is the integral of the polynomial
    through the samples around it. For the end of a record: the conjugate, of samples counted
    backwards.
    """
    first = int(np.ceil(cut - _QUADRATURE_ROUNDING))
    if cut < -_QUADRATURE_ROUNDING or first + _DEGREE >= count:
        raise BadInput(
            f"a record can be cut from its first sample to {count - END_SAMPLES} samples after it, "
            f"not at {cut:g}",
            code="record-too-short",
        )
    weights = np.zeros((theta.size, count), dtype=complex)
    weights[:, :first] -= np.exp(-1j * np.outer(theta, np.arange(first)))
    end = np.exp(-1j * theta * first)[:, None] * _compute_end_weights(theta)
    weights[:, first : first + _DEGREE + 1] += end
    if first - cut > _QUADRATURE_ROUNDING:
        near = max(0, first - (_DEGREE + 1) // 2) + np.arange(_DEGREE + 1)
        node, share = np.polynomial.legendre.leggauss(_NODES)
        t = 0.5 * (cut + first) + 0.5 * (first - cut) * node
        # Lagrange polynomials of the samples around the cut, at the nodes.
        apart = near[:, None] - near + np.eye(near.size)
        factor = (t[:, None, None] - near) / apart
        factor[:, np.arange(near.size), np.arange(near.size)] = 1.0
        lagrange = factor.prod(axis=2)
        moved = np.exp(-1j * np.outer(theta, t)) * (0.5 * (first - cut) * share)
        weights[:, near] += moved @ lagrange
    return weights


def _compute_end_weights(theta: Float[np.ndarray, " n_omega"]) -> np.ndarray:
    """Weights of the samples at the begin of a sum; their conjugate at its end."""
    return (-1j * theta[:, None]) ** np.arange(_TERMS) @ _series()


@cache
def _series() -> Float[np.ndarray, "n_terms n_end"]:
    """Coefficients of the weights' power series in -j theta."""
    order = np.arange(_DEGREE + 1 + _TERMS)
    # Zeta of 0, -1, -2 ..., with the sample at n = 0 counted in the first.
    zeta = -scipy.special.bernoulli(order.size)[1:] / (order + 1.0)
    moments = np.array([-zeta[k : k + _TERMS] for k in range(_DEGREE + 1)])
    places = np.vander(np.arange(_DEGREE + 1.0), increasing=True).T
    return np.linalg.solve(places, moments).T / scipy.special.factorial(np.arange(_TERMS))[:, None]


# --- Finite Fourier transform of sampled channels at arbitrary frequencies ------------------------

_MANY_FREQUENCIES = 128  # from here on a chirp-z transform is cheaper than a matrix
_ROUNDING = 1e-6  # of a sample: a time this close to one is its own
_LARGEST_MATRIX = 2_000_000  # elements; 32 MB for sine and cosine


def finite_fourier_transform(
    samples: Float[np.ndarray, "n_samples n_channels"],
    rate_hz: float,
    omega: Float[np.ndarray, " n_omega"],
    start_s: float = 0.0,
    *,
    end_corrected: bool = False,
) -> Complex[np.ndarray, "n_omega n_channels"]:
    """Transform sampled channels at arbitrary frequencies.

    Parameters
    ----------
    samples
        One column per channel, uniformly sampled, trim value removed. [channel unit]
    rate_hz
        Samples per second. [Hz]
    omega
        Angular frequencies, any spacing, from 0 to the Nyquist frequency. [rad/s]
    start_s
        Time of the first sample, which preserves the phase relation of channels
        of different clocks. [s]
    end_corrected
        For records that start or end away from trim: integrate from the
        first sample to the last instead of summing them.

    Returns
    -------
    array
        Integral of x exp(-j omega t) over the record. [channel unit * s]

    Raises
    ------
    ValueError
        If a frequency is negative or lies beyond the Nyquist frequency.

    Notes
    -----
    The Euler sum is exact for a band-limited transient that starts and ends at
    trim, which a whole recorded maneuver is. Frequencies on a grid of
    n/(m period) are read from a zero-padded fast transform; many at equal
    spacing come from a chirp-z transform; others cost one product with a cached
    trigonometric matrix.
    """
    omega = np.asarray(omega, dtype=float)
    if samples.shape[0] == 0:
        raise ValueError("a record without samples has no transform")
    if omega.size and (omega.min() < 0 or omega.max() > np.pi * rate_hz * (1 + 1e-12)):
        raise ValueError(
            f"frequencies must lie between 0 and the Nyquist frequency "
            f"{0.5 * rate_hz:g} Hz; got {omega.min() / 2 / np.pi:g} to "
            f"{omega.max() / 2 / np.pi:g} Hz"
        )
    samples = np.asarray(samples, dtype=float)
    grid = _grid_of(omega, samples.shape[0], rate_hz)
    if grid is not None:
        length, bins = grid
        transform = scipy.fft.rfft(samples, n=length, axis=0)[bins] / rate_hz
    elif _is_dense(omega):
        transform = _by_chirp(samples, rate_hz, omega)
    else:
        transform = _by_matrix(samples, rate_hz, omega)
    if end_corrected:
        transform = correct_ends(transform, samples, rate_hz, omega)
    if start_s:
        transform *= np.exp(-1j * omega * start_s)[:, None]
    return transform


def integrate_between(
    samples: Float[np.ndarray, "n_samples n_channels"],
    rate_hz: float,
    omega: Float[np.ndarray, " n_omega"],
    start_s: float,
    window_s: tuple[float, float],
) -> Complex[np.ndarray, "n_omega n_channels"]:
    """Integrate sampled channels between two times, which need not be those of samples.

    Parameters
    ----------
    samples, rate_hz, omega, start_s
        As of ``finite_fourier_transform``.
    window_s
        Begin and end, from the first sample to the last. [s]

    Returns
    -------
    array
        Integral of x exp(-j omega t) over the window. [channel unit * s]

    Raises
    ------
    BadInput
        If the window has too few samples.
    """
    begin, end = ((time_s - start_s) * rate_hz for time_s in window_s)
    first, last = int(np.floor(begin + _ROUNDING)), int(np.ceil(end - _ROUNDING))
    part = samples[first : last + 1]
    count = END_SAMPLES + 1
    if len(part) < 2 * count:
        raise BadInput(
            f"a record of {len(part)} samples is too short to integrate; it needs at least "
            f"{2 * count}",
            code="record-too-short",
        )
    theta = omega / rate_hz
    transform = finite_fourier_transform(part, rate_hz, omega)
    head = compute_cut_weights(theta, max(begin - first, 0.0), count)
    tail = compute_cut_weights(theta, max(last - end, 0.0), count).conj()
    turn = np.exp(-1j * theta * (len(part) - 1))
    transform += (head @ part[:count] + turn[:, None] * (tail @ part[: -count - 1 : -1])) / rate_hz
    return transform * np.exp(-1j * omega * (start_s + first / rate_hz))[:, None]


def integrate_steps(
    samples: Float[np.ndarray, "n_samples n_channels"],
    rate_hz: float,
    omega: Float[np.ndarray, " n_omega"],
    start_s: float,
    window_s: tuple[float, float],
    *,
    linear: bool = False,
) -> Complex[np.ndarray, "n_omega n_channels"]:
    """Integrate channels that are held between their samples, or are straight lines there.

    Parameters and result are those of ``integrate_between``; no frequency is zero.

    Notes
    -----
    By parts, x exp(-j omega t) leaves the ends and the integral of the derivative: steps at the
    samples of a held signal, a held signal itself of one that is linear.
    """
    begin, end = ((time_s - start_s) * rate_hz for time_s in window_s)
    first, last = int(np.floor(begin + _ROUNDING)), int(np.ceil(end - _ROUNDING)) - 1
    low, high = samples[first], samples[last]
    if linear:
        slopes = rate_hz * np.diff(samples, axis=0, append=samples[-1:])
        low = low + (begin - first) / rate_hz * slopes[first]
        high = high + (end - last) / rate_hz * slopes[last]
        inside = integrate_steps(slopes, rate_hz, omega, start_s, window_s)
    else:
        steps = np.diff(samples[first : last + 1], axis=0)
        next_s = start_s + (first + 1) / rate_hz
        inside = rate_hz * finite_fourier_transform(steps, rate_hz, omega, next_s)
    left, right = (np.exp(-1j * omega * time_s)[:, None] for time_s in window_s)
    return (low * left - high * right + inside) / (1j * omega)[:, None]


def compute_harmonic_frequencies(
    harmonics: np.ndarray, period_s: float
) -> Float[np.ndarray, " n_omega"]:
    """Angular frequencies of harmonics of 1/period. [rad/s]"""
    return 2.0 * np.pi * np.asarray(harmonics, dtype=float) / period_s


def _grid_of(
    omega: Float[np.ndarray, " n_omega"], n_samples: int, rate_hz: float
) -> tuple[int, np.ndarray] | None:
    """Length of a zero-padded transform that has bins at all frequencies, and these bins."""
    hertz = omega / (2.0 * np.pi)
    spacing = np.diff(hertz)
    if hertz.size < 8 or spacing.min() <= 0:
        return None
    period = round(rate_hz / float(spacing.min()))
    length = period * -(-n_samples // period)
    bins = hertz * length / rate_hz
    near = np.rint(bins)
    if length > 8 * n_samples or np.max(np.abs(bins - near)) > 1e-6:
        return None
    return length, near.astype(int)


def _is_dense(omega: Float[np.ndarray, " n_omega"]) -> bool:
    if omega.size < _MANY_FREQUENCIES:
        return False
    spacing = (omega[-1] - omega[0]) / (omega.size - 1)
    even = omega[0] + spacing * np.arange(omega.size)
    return bool(spacing > 0 and np.max(np.abs(omega - even)) < 1e-9 * omega[-1])


def _by_chirp(
    samples: Float[np.ndarray, "n_samples n_channels"],
    rate_hz: float,
    omega: Float[np.ndarray, " n_omega"],
) -> Complex[np.ndarray, "n_omega n_channels"]:
    """Chirp-z transform: with nk = (n^2 + k^2 - (k - n)^2) / 2 the sum is a convolution."""
    n, m = samples.shape[0], omega.size
    step = (omega[-1] - omega[0]) / (m - 1) / rate_hz
    place = np.arange(max(n, m))
    chirp = np.exp(-0.5j * step * place**2)
    length = scipy.fft.next_fast_len(n + m - 1)
    kernel = np.zeros(length, dtype=complex)
    kernel[:m] = chirp[:m].conj()
    kernel[length - n + 1 :] = chirp[1:n][::-1].conj()
    start = chirp[:n] * np.exp(-1j * omega[0] / rate_hz * place[:n])
    spread = scipy.fft.fft(samples * start[:, None], length, axis=0)
    joined = scipy.fft.ifft(spread * scipy.fft.fft(kernel)[:, None], axis=0)[:m]
    return joined * chirp[:m, None] / rate_hz


def _by_matrix(
    samples: Float[np.ndarray, "n_samples n_channels"],
    rate_hz: float,
    omega: Float[np.ndarray, " n_omega"],
) -> Complex[np.ndarray, "n_omega n_channels"]:
    at_once = max(1, _LARGEST_MATRIX // samples.shape[0])
    parts = []
    for first in range(0, omega.size, at_once):
        part = omega[first : first + at_once]
        cosine, sine = _trigonometric_matrix(part.tobytes(), samples.shape[0], float(rate_hz))
        parts.append((cosine @ samples - 1j * (sine @ samples)) / rate_hz)
    return np.concatenate(parts) if parts else np.zeros((0, samples.shape[1]), dtype=complex)


@lru_cache(maxsize=8)
def _trigonometric_matrix(
    omega_bytes: bytes, n_samples: int, rate_hz: float
) -> tuple[np.ndarray, np.ndarray]:
    omega = np.frombuffer(omega_bytes)
    block = max(1, round(n_samples**0.5))
    fine = np.exp(1j * np.outer(omega / rate_hz, np.arange(block)))
    coarse = np.exp(1j * np.outer(omega / rate_hz, block * np.arange(-(-n_samples // block))))
    rotation = (coarse[:, :, None] * fine[:, None, :]).reshape(omega.size, -1)[:, :n_samples]
    return np.ascontiguousarray(np.real(rotation)), np.ascontiguousarray(np.imag(rotation))


# --- Attitudes, which need not return to trim -----------------------------------------------------

_LEVEL_S = 0.5  # at either end of a record, that define the level there


def transform_with_levels(
    samples: Float[np.ndarray, "n_samples n_channels"],
    rate_hz: float,
    omega: Float[np.ndarray, " n_omega"],
    start_s: float,
    is_attitude: Bool[np.ndarray, " n_channels"],
    *,
    integrated: bool,
) -> Complex[np.ndarray, "n_omega n_channels"]:
    """Transform channels of which attitudes keep their last level after the record.

    Parameters
    ----------
    samples
        One column per channel, trim value removed. [channel unit]
    rate_hz
        Samples per second. [Hz]
    omega
        Angular frequencies. [rad/s]
    start_s
        Time of the first sample. [s]
    is_attitude
        The channels that need not return to trim.
    integrated
        Whether the record starts and ends in motion: channels are integrated from the first
        sample to the last, and attitudes have their first level before it.

    Returns
    -------
    array
        Integral of x exp(-j omega t). [channel unit * s]

    Notes
    -----
    An attitude integrates its rate; a truncated record would contain a step back to trim. The
    level l after the last time t contributes l exp(-j omega t) / (j omega) to an integral, and
    l exp(-j omega t) dt / (1 - exp(-j omega dt)) to a sum.
    """
    n_level = max(1, round(_LEVEL_S * rate_hz))
    if integrated and is_attitude.any():
        samples = samples - np.where(is_attitude, samples[:n_level].mean(axis=0), 0.0)
    transform = finite_fourier_transform(samples, rate_hz, omega, start_s, end_corrected=integrated)
    if is_attitude.any():
        if integrated:
            last_s = start_s + (samples.shape[0] - 1) / rate_hz
            step = np.exp(-1j * omega * last_s) / (1j * omega)
        else:
            next_s = start_s + samples.shape[0] / rate_hz
            step = np.exp(-1j * omega * next_s) / rate_hz / (1.0 - np.exp(-1j * omega / rate_hz))
        transform[:, is_attitude] += step[:, None] * samples[-n_level:, is_attitude].mean(axis=0)
    return transform
