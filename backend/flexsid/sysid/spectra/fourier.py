"""Finite Fourier transform of sampled channels at arbitrary frequencies."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from jaxtyping import Complex, Float
from scipy import fft

from flexsid.errors import BadInput
from flexsid.sysid.spectra.quadrature import END_SAMPLES, compute_cut_weights, correct_ends

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
        transform = fft.rfft(samples, n=length, axis=0)[bins] / rate_hz
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
    length = fft.next_fast_len(n + m - 1)
    kernel = np.zeros(length, dtype=complex)
    kernel[:m] = chirp[:m].conj()
    kernel[length - n + 1 :] = chirp[1:n][::-1].conj()
    start = chirp[:n] * np.exp(-1j * omega[0] / rate_hz * place[:n])
    spread = fft.fft(samples * start[:, None], length, axis=0)
    joined = fft.ifft(spread * fft.fft(kernel)[:, None], axis=0)[:m]
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
