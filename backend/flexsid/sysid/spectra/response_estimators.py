"""Averaged spectra and frequency responses H1, H2 and Hv, with coherence and standard errors."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import scipy
from jaxtyping import Complex, Float

from flexsid.errors import BadInput

# --- Averaged auto- and cross-spectra of forces and responses over blocks of a record -------------

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
    squared = np.abs(scipy.fft.fft(weights**2)) ** 2
    return AveragedSpectra(
        omega=2.0 * np.pi * scipy.fft.rfftfreq(length, 1.0 / rate_hz)[bins],
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
    return scipy.fft.rfft((samples - samples.mean(axis=0)) * weights[:, None], axis=0)


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


# --- Frequency responses H1, H2 and Hv from averaged spectra, with coherence and standard errors

Estimator = Literal["H1", "H2", "Hv"]

_LEAST_POWER = 1e-10  # of the largest of a force: below is rounding of a frequency not excited
_LEAST_SEPARATION = 1e-6  # eigenvalue of the coherence matrix of the forces: below is rounding


@dataclass(frozen=True, slots=True, eq=False)
class EstimatedResponses:
    """Frequency responses of outputs x to forces f.

    ``std`` is the standard deviation of the complex error: the root of the mean of |error|^2; that
    of the magnitude, and of the phase times the magnitude, is smaller by the root of two.
    ``multiple_coherence`` is of an output with all forces together, ``ordinary_coherence`` with
    one of them.
    """

    omega: Float[np.ndarray, " n_omega"]
    values: Complex[np.ndarray, "n_omega n_x n_f"]
    std: Float[np.ndarray, "n_omega n_x n_f"]
    multiple_coherence: Float[np.ndarray, "n_omega n_x"]
    ordinary_coherence: Float[np.ndarray, "n_omega n_x n_f"]


def estimate_responses(spectra: AveragedSpectra, estimator: Estimator) -> EstimatedResponses:
    """Estimate frequency responses from averaged spectra.

    Parameters
    ----------
    spectra
        Of forces and responses.
    estimator
        ``H1`` assumes that all noise is on the responses, ``H2`` on the force (a single one),
        ``Hv`` on both, with one ratio of noise to rms in all channels.

    Raises
    ------
    BadInput
        If there are too few averages, H2 is requested of several forces, or the forces do not
        excite a frequency, or not independently of each other.

    Notes
    -----
    With S_ff, S_fx and S_xx of ``AveragedSpectra``: H1 = S_ff^-1 S_fx, H2 = S_xx / conj(S_fx), and
    Hv = -a_f / a_x with a the eigenvector of the smallest eigenvalue of the matrix of one response
    and all forces, each divided by its rms over the record (total least squares, which depends on
    the scale of the channels; this one makes the result independent of units). Sources: Bendat and
    Piersol (2010), Random Data, chapters 6, 7 and 9; Rocklin, Crowley and Vold (1985), A
    comparison of H1, H2, and Hv frequency response functions, 3rd IMAC.

    Standard errors, with n independent averages and q forces: of H1 the squared one is
    S_xx (1 - gamma^2) (S_ff^-1)_rr / (n - q), which for one force is |H|^2 (1 - gamma^2) /
    (gamma^2 (n - 1)), also that of H2; the variance of the magnitude in chapter 9 of Bendat and
    Piersol is half of it. Of Hv by the first-order perturbation of the eigenvector by a complex
    Wishart matrix, whose elements have the variance lambda_j lambda_a / n in the basis of its
    eigenvectors (Brillinger 1981, Time Series, Sec. 9.4).
    """
    n_f = spectra.forces.shape[1]
    freedom = spectra.n_independent - n_f
    if freedom < 1.0:
        raise BadInput(
            f"{spectra.n_blocks} averages (statistically {spectra.n_independent:.1f}) cannot "
            f"resolve {n_f} forces; expected at least {n_f + 2}",
            code="too-few-averages",
        )
    if estimator == "H2" and n_f > 1:
        raise BadInput(
            f"H2 is defined for one force, the record has {n_f}; select H1 or Hv",
            code="several-forces",
        )
    band = _find_excited_band(spectra)
    S_ff, S_fx, S_xx = (s[band] for s in (spectra.forces, spectra.cross, spectra.responses))
    first = np.linalg.solve(S_ff, S_fx)
    S_rr = np.real(np.einsum("fii->fi", S_ff))
    explained = np.real(np.einsum("fix,fix->fx", S_fx.conj(), first))
    multiple = np.clip(_divide(explained, S_xx), 0.0, 1.0)
    ordinary = np.clip(_divide(np.abs(S_fx) ** 2, S_rr[:, :, None] * S_xx[:, None, :]), 0.0, 1.0)
    if estimator == "Hv":
        values, variance = _solve_total_least_squares(S_ff, S_fx, S_xx)
    elif estimator == "H2":
        values = _divide(S_xx[:, None], S_fx.conj())
        variance = np.abs(values) ** 2 * _divide(1.0 - ordinary, ordinary)
    else:
        values = first
        inverse = np.real(np.einsum("fii->fi", np.linalg.inv(S_ff)))
        variance = inverse[:, :, None] * (S_xx * (1.0 - multiple))[:, None, :]
    return EstimatedResponses(
        omega=spectra.omega[band],
        values=np.swapaxes(values, 1, 2),
        std=np.swapaxes(np.sqrt(variance / freedom), 1, 2),
        multiple_coherence=multiple,
        ordinary_coherence=np.swapaxes(ordinary, 1, 2),
    )


def _solve_total_least_squares(
    S_ff: Complex[np.ndarray, "n_omega n_f n_f"],
    S_fx: Complex[np.ndarray, "n_omega n_f n_x"],
    S_xx: Float[np.ndarray, "n_omega n_x"],
) -> tuple[Complex[np.ndarray, "n_omega n_f n_x"], Float[np.ndarray, "n_omega n_f n_x"]]:
    """Return Hv, and its variance times the degrees of freedom."""
    n_omega, n_f, n_x = S_fx.shape
    force_rms = np.sqrt(np.mean(np.real(np.einsum("fii->fi", S_ff)), axis=0))
    rms = np.sqrt(np.mean(S_xx, axis=0))
    rms = np.where(rms > 0.0, rms, 1.0)
    values = np.empty(S_fx.shape, dtype=complex)
    variance = np.empty(S_fx.shape)
    matrix = np.empty((n_omega, n_f + 1, n_f + 1), dtype=complex)
    matrix[:, 1:, 1:] = S_ff / np.outer(force_rms, force_rms)
    for output in range(n_x):
        cross = S_fx[:, :, output] / (force_rms * rms[output])
        matrix[:, 0, 0] = S_xx[:, output] / rms[output] ** 2
        matrix[:, 1:, 0], matrix[:, 0, 1:] = cross, cross.conj()
        size, vectors = np.linalg.eigh(matrix)  # in ascending order
        a = vectors[:, :, 0]
        found = -a[:, 1:] / a[:, :1]
        # The change of H with the component of the error of the eigenvector along each other one.
        gain = (vectors[:, 1:, 1:] + found[:, :, None] * vectors[:, :1, 1:]) / a[:, :1, None]
        least, others = np.maximum(size[:, :1], 0.0), size[:, 1:]
        spread = others * least / np.maximum(others - least, np.finfo(float).tiny) ** 2
        scale = rms[output] / force_rms
        values[:, :, output] = found * scale
        variance[:, :, output] = np.einsum("frj,fj->fr", np.abs(gain) ** 2, spread) * scale**2
    return values, variance


def _find_excited_band(spectra: AveragedSpectra) -> slice:
    """Return the band that the forces excite independently of each other."""
    power = np.real(np.einsum("fii->fi", spectra.forces))
    largest = power.max(axis=0)
    excited = (power > _LEAST_POWER * largest).all(axis=1) & (largest > 0.0).all()
    size = np.sqrt(np.where(excited[:, None], power, 1.0))
    unit = spectra.forces / (size[:, :, None] * size[:, None, :])
    separate = excited & (np.linalg.eigvalsh(unit)[:, 0] > _LEAST_SEPARATION)
    if not separate.any() and excited.any():
        raise BadInput(
            "the forces are coherent with each other at every frequency; select a record with "
            "independent forces, or one of the forces",
            code="not-excited",
        )
    # The longest run of usable frequencies: what lies outside of the band is rounding.
    ends = np.flatnonzero(np.diff(np.concatenate([[0], separate.astype(int), [0]])))
    start, stop = max(
        zip(ends[::2], ends[1::2], strict=True), key=lambda e: e[1] - e[0], default=(0, 0)
    )
    if 2 * (stop - start) < separate.sum() or stop == start:
        raise BadInput(
            f"the forces excite {int(separate.sum())} of {separate.size} frequencies, with gaps; "
            "select as many averages as there are periods, so that a block is one period",
            code="not-excited",
        )
    return slice(int(start), int(stop))


def _divide(above: np.ndarray, below: np.ndarray) -> np.ndarray:
    """Quotient; zero of a channel without signal."""
    return np.divide(above, below, out=np.zeros_like(below), where=below != 0.0)


# --- Smoothing of a measured frequency response whose harmonics have unequal power ----------------

LEAST_HARMONICS = 7
"""Harmonics below which a response remains as measured: too few determine its smoothness."""

_PENALTIES = 60  # values compared, evenly spaced in their logarithm
_EXTREME = 100.0  # the largest penalty leaves a straight line to 1 %, the smallest the data


def smooth_response(
    omega: Float[np.ndarray, " n_omega"],
    response: Complex[np.ndarray, "n_omega n_channels"],
    excitation: Float[np.ndarray, " n_omega"],
) -> Complex[np.ndarray, "n_omega n_channels"]:
    """Smooth responses over frequency, every harmonic weighted by the power that excites it.

    Parameters
    ----------
    omega
        In ascending order. [rad/s]
    response
        Output over excitation, measured at every harmonic.
    excitation
        Magnitude of the excitation; the noise of the response is inverse to it. All above zero.

    Notes
    -----
    H minimises sum |e (H - H_measured)|^2 + penalty sum |D H|^2 with D the second divided
    differences, for every channel with the penalty of least generalised cross-validation,
    n |r|^2 / (n - trace)^2. Sources: Whittaker 1923, doi:10.1017/S0013091500077853; Eilers 2003,
    Analytical Chemistry 75, doi:10.1021/ac034173t; Golub, Heath and Wahba 1979, Technometrics 21,
    doi:10.1080/00401706.1979.10489751.
    """
    n = omega.size
    if n < LEAST_HARMONICS:
        return response
    weight = excitation / np.sqrt(np.mean(excitation**2))
    roughness = _build_differences(omega) / weight
    _, size, axes = np.linalg.svd(roughness)  # the last two axes are straight lines
    power = np.concatenate([size**2, np.zeros(2)])
    white = axes @ (weight[:, None] * response)
    penalties = np.geomspace(
        1.0 / (_EXTREME * power[0]), _EXTREME / float(size[-1]) ** 2, _PENALTIES
    )
    passed = 1.0 / (1.0 + penalties[:, None] * power)
    removed = (1.0 - passed) ** 2 @ np.abs(white) ** 2
    score = removed / (np.sum(1.0 - passed, axis=1) ** 2)[:, None]
    best = np.argmin(score, axis=0)
    return (axes.T @ (passed[best].T * white)) / weight[:, None]


def _build_differences(omega: Float[np.ndarray, " n_omega"]) -> np.ndarray:
    """Second divided differences over the band, times the root of their spacing."""
    step = np.diff(omega) / (omega[-1] - omega[0])
    both = step[:-1] + step[1:]
    found = np.zeros((omega.size - 2, omega.size))
    row = np.arange(omega.size - 2)
    found[row, row] = 2.0 / (step[:-1] * both)
    found[row, row + 1] = -2.0 / (step[:-1] * step[1:])
    found[row, row + 2] = 2.0 / (step[1:] * both)
    return found * np.sqrt(0.5 * both)[:, None]
