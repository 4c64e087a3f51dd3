"""Averaged auto- and cross-spectra of forces and responses over blocks of a record."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import Complex, Float
from scipy import fft

from flexsid.errors import BadInput

Window = Literal["hann", "rectangular"]
MOST_OVERLAP = 0.95
"""Above, blocks add nothing but computing time."""

_LEAST_SAMPLES = 8  # of a block
_SCIPY_NAMES: dict[Window, str] = {"hann": "hann", "rectangular": "boxcar"}


@dataclass(frozen=True, slots=True, eq=False)
class AveragedSpectra:
    """Spectra averaged over blocks, at all frequencies but zero and the Nyquist frequency.

    ``forces`` [i, j] is the mean of conj(f_i) f_j, ``cross`` [i, o] that of conj(f_i) x_o and
    ``responses`` [o] that of |x_o|^2, in squared units of the channels and of any common scale.
    ``n_blocks`` blocks have the statistical errors of ``n_independent`` that do not overlap. The
    noise of a frequency is correlated with that of its neighbours: ``line_correlation`` is the sum
    of the squared correlations, one if there are none.
    """

    omega: Float[np.ndarray, " n_omega"]
    forces: Complex[np.ndarray, "n_omega n_f n_f"]
    cross: Complex[np.ndarray, "n_omega n_f n_x"]
    responses: Float[np.ndarray, "n_omega n_x"]
    n_blocks: int
    n_independent: float
    line_correlation: float


def find_block_length(tests: Sequence[Sequence[int]], averages: int, overlap: float) -> int:
    """Return the largest block length with which each test has the number of blocks.

    Parameters
    ----------
    tests
        Samples of the records that are averaged together, of each test.
    averages, overlap
        As of ``average_spectra``.

    Raises
    ------
    BadInput
        If the blocks would have fewer than eight samples, or the overlap is out of range.
    """
    if not (0.0 <= overlap <= MOST_OVERLAP and averages > 0):
        raise BadInput(
            f"{averages} averages with an overlap of {overlap:g} cannot be formed; expected at "
            f"least one, and an overlap from 0 to {MOST_OVERLAP:g}",
            code="bad-averages",
        )

    def count(length: int) -> int:
        step = _compute_step(length, overlap)
        return min(sum(max(0, size - length + step) // step for size in sizes) for sizes in tests)

    # block lengths with too few and with enough blocks
    few, many = max(size for sizes in tests for size in sizes) + 1, 0
    while few - many > 1:
        middle = (few + many) // 2
        few, many = (few, middle) if count(middle) >= averages else (middle, many)
    if many < _LEAST_SAMPLES:
        raise BadInput(
            f"{averages} averages of {min(map(sum, tests))} samples leave blocks of {many} samples;"
            " select fewer averages",
            code="too-many-averages",
        )
    return many


def average_spectra(
    records: Sequence[
        tuple[Float[np.ndarray, "n_samples n_f"], Float[np.ndarray, "n_samples n_x"]]
    ],
    rate_hz: float,
    window: Window,
    length: int,
    averages: int,
    overlap: float,
) -> AveragedSpectra:
    """Average the spectra of forces and responses over blocks of equal length.

    Parameters
    ----------
    records
        Forces and responses on one clock, of each record. [channel units]
    rate_hz
        Samples per second.
    length
        Samples of a block, as of ``find_block_length``.
    averages
        Largest number of blocks of all records together.
    overlap
        Share of a block that the next one repeats, at most ``MOST_OVERLAP``.

    Notes
    -----
    The mean of each block is removed. Overlapping blocks are correlated: of n blocks
    n / (1 + 2 sum_j (1 - j/n) rho_j^2) are independent, with rho_j the correlation of the window
    with itself j steps later. Source: Welch (1967), IEEE Trans. Audio Electroacoustics 15,
    doi:10.1109/TAU.1967.1161901. Over frequency the correlation of white noise is the transform of
    the squared window.
    """
    step = _compute_step(length, overlap)
    from scipy import signal  # takes a second to import, of the start of a server

    weights = np.asarray(signal.get_window(_SCIPY_NAMES[window], length))
    bins = slice(1, (length + 1) // 2)
    n_f, n_x = records[0][0].shape[1], records[0][1].shape[1]
    n_omega = bins.stop - bins.start
    forces = np.zeros((n_omega, n_f, n_f), dtype=complex)
    cross = np.zeros((n_omega, n_f, n_x), dtype=complex)
    power = np.zeros((n_omega, n_x))
    n_blocks, n_independent = 0, 0.0
    for force, response in records:
        starts = range(0, force.shape[0] - length + 1, step)[: averages - n_blocks]
        for start in starts:
            block = slice(start, start + length)
            f = transform_block(force[block], weights)[bins]
            x = transform_block(response[block], weights)[bins]
            forces += f.conj()[:, :, None] * f[:, None, :]
            cross += f.conj()[:, :, None] * x[:, None, :]
            power += np.abs(x) ** 2
        n_blocks += len(starts)
        n_independent += _count_independent(len(starts), weights, step)
    squared = np.abs(fft.fft(weights**2)) ** 2
    return AveragedSpectra(
        omega=2.0 * np.pi * fft.rfftfreq(length, 1.0 / rate_hz)[bins],
        forces=forces / n_blocks,
        cross=cross / n_blocks,
        responses=power / n_blocks,
        n_blocks=n_blocks,
        n_independent=n_independent,
        line_correlation=float(np.sum(squared) / squared[0]),
    )


def transform_block(
    samples: Float[np.ndarray, "n_samples n"], weights: Float[np.ndarray, " n_samples"]
) -> Complex[np.ndarray, "n_omega n"]:
    """Fourier transform of a windowed block without its mean, by channel."""
    return fft.rfft((samples - samples.mean(axis=0)) * weights[:, None], axis=0)


def _compute_step(length: int, overlap: float) -> int:
    return max(1, round(length * (1.0 - overlap)))


def _count_independent(n: int, weights: Float[np.ndarray, " n_samples"], step: int) -> float:
    """Number of independent blocks with the statistical errors of n overlapping ones."""
    if n == 0:
        return 0.0
    total = float(np.sum(weights**2))
    later = range(step, weights.size, step)[: n - 1]
    squares = [float(np.sum(weights[at:] * weights[:-at]) / total) ** 2 for at in later]
    return n / (1.0 + 2.0 * sum((1.0 - j / n) * s for j, s in enumerate(squares, start=1)))
