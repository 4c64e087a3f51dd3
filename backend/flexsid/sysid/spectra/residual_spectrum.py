"""Residual spectrum of a smooth response, and correlation of the noise of one record."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy
from jaxtyping import Complex, Float

# --- Residual spectrum of a smooth response: noise from the scatter of neighbouring data points

_WINDOW = 7  # data points in a local fit
_DEGREE = 5  # of the polynomial of a local fit
_NEIGHBOURS = 24  # residuals on either side that share one noise level
_STRIDE = 4  # data points from one level to the next
_LEAST_WINDOWS = 8  # local fits whose median is a noise level
_PARABOLA = 2  # degree of local fits of a record in motion
_EXCESS = 3  # frequencies of such a fit beyond its unknowns
_FITS = 3  # without common frequencies, whose median is a noise level
_DEPENDENT = 1e-6  # relative size of a regressor that the others explain
_ASSIGNED = 0.7  # least share of one input in the excitation of a frequency that it is assigned to


@dataclass(frozen=True, slots=True)
class LocalResiduals:
    """Residuals of local fits at ``indices``, scaled to the variance of a data point."""

    indices: np.ndarray
    values: Complex[np.ndarray, "n_frequencies n_channels"]


def compute_local_residuals(
    values: Complex[np.ndarray, "n_own n_channels"],
) -> LocalResiduals | None:
    """Residual of each point from a quintic through its neighbours; None with too few points.

    Notes
    -----
    A quintic over seven equally spaced points gives the middle one a residual of
    variance 1 - h times that of the noise, h being its own weight in the fit.
    """
    n = values.shape[0]
    if n < _WINDOW:
        return None
    half = _WINDOW // 2
    windows = np.lib.stride_tricks.sliding_window_view(values, _WINDOW, axis=0)
    return LocalResiduals(np.arange(half, n - half), windows @ compute_local_weights())


def compute_local_weights() -> Float[np.ndarray, " n_window"]:
    """Compute the weights of neighbouring points in the residual of the middle one; norm 1."""
    half = _WINDOW // 2
    basis = np.vander(np.arange(-half, half + 1, dtype=float), _DEGREE + 1)
    hat = basis @ np.linalg.solve(basis.T @ basis, basis.T)
    weights = -hat[half]
    weights[half] += 1.0
    return weights / np.sqrt(1.0 - hat[half, half])


def build_local_fits(
    inputs: Complex[np.ndarray, "n_omega n_u"],
) -> tuple[Complex[np.ndarray, "n_windows n_omega"], np.ndarray]:
    """Build the local residuals of responses as rows of unit norm, and their frequencies.

    Each frequency belongs to the input that excites it, if there is one.
    """
    size = np.sqrt(np.mean(np.abs(inputs) ** 2, axis=0))
    power = np.abs(inputs / np.where(size > 0.0, size, 1.0)) ** 2
    assigned = power.argmax(axis=1)
    share = power.max(axis=1) / np.maximum(power.sum(axis=1), np.finfo(float).tiny)
    weights = compute_local_weights()
    rows, centre = [np.zeros((0, len(inputs)), dtype=complex)], []
    for number in range(inputs.shape[1]):
        own = np.flatnonzero((assigned == number) & (share > _ASSIGNED))
        for first in range(own.size - weights.size + 1):
            at = own[first : first + weights.size]
            row = np.zeros((1, len(inputs)), dtype=complex)
            row[0, at] = weights / inputs[at, number]
            rows.append(row / np.linalg.norm(row))
            centre.append(at[weights.size // 2])
    return np.concatenate(rows), np.array(centre, dtype=int)


def estimate_scatter(
    inputs: Complex[np.ndarray, "n_omega n_u"], values: Complex[np.ndarray, "n_omega n_channels"]
) -> Float[np.ndarray, " n_channels"] | None:
    """Estimate the standard deviation of spectra about smooth responses to the inputs.

    None where no input excites enough frequencies alone. The median, as in
    ``estimate_noise_level``, since a quintic does not fit a sharp resonance.
    """
    fits, _ = build_local_fits(inputs)
    if len(fits) < _LEAST_WINDOWS:
        return None
    return np.sqrt(np.median(np.abs(fits @ values) ** 2, axis=0) / np.log(2.0))


def count_frequencies(n_regressors: int) -> int:
    """Return the frequencies from which ``estimate_noise_in_motion`` has enough local fits."""
    return _FITS * _compute_width(n_regressors)


def _compute_width(n_regressors: int) -> int:
    return (_PARABOLA + 1) * n_regressors + _EXCESS


def estimate_noise_in_motion(
    omega: Float[np.ndarray, " n_omega"],
    inputs: Complex[np.ndarray, "n_omega n_u"],
    values: Complex[np.ndarray, "n_omega n_channels"],
    ends: Complex[np.ndarray, "n_omega n_ends"],
    targets: Float[np.ndarray, " n_target"],
) -> Float[np.ndarray, "n_target n_channels"] | None:
    """Estimate the noise of spectra of a record that begins or ends in motion.

    Parameters
    ----------
    omega
        Neighbouring multiples of 1/T. [rad/s]
    inputs, values
        Spectra of inputs and channels.
    ends
        Spectra of unit impulses at the ends in motion.
    targets
        Frequencies at which the noise is wanted. [rad/s]

    Returns
    -------
    array or None
        Standard deviations; None with fewer frequencies than a local fit has.

    Notes
    -----
    Responses to the inputs and to the impulses at the ends are parabolas over neighbouring
    frequencies (local polynomial method); levels are those of ``estimate_noise_level``. Source:
    Pintelon and Schoukens, System Identification, 2nd ed., 2012, sec. 7.2.
    """
    regressors = np.concatenate([inputs, ends], axis=1)
    width = _compute_width(regressors.shape[1])
    if len(values) < width:
        return None
    x = np.linspace(-1.0, 1.0, width)[:, None] ** np.arange(_PARABOLA + 1)
    near = np.lib.stride_tricks.sliding_window_view(regressors, width, axis=0).transpose(0, 2, 1)
    near = near / np.maximum(np.linalg.norm(near, axis=1, keepdims=True), np.finfo(float).tiny)
    columns = (near[:, :, :, None] * x[:, None, :]).reshape(len(near), width, -1)
    basis, size, _ = np.linalg.svd(columns, full_matrices=False)
    used = size > _DEPENDENT * size[:, :1]
    basis = basis * used[:, None, :]
    windows = np.lib.stride_tricks.sliding_window_view(values, width, axis=0).transpose(0, 2, 1)
    rest = windows - basis @ (basis.conj().transpose(0, 2, 1) @ windows)
    # The sum of so many exponential variables, with the median of one of their mean.
    freedom = width - np.count_nonzero(used, axis=1)
    median = scipy.special.gammaincinv(freedom, 0.5)
    power = np.sum(np.abs(rest) ** 2, axis=1) * (np.log(2.0) / median)[:, None]
    half = width // 2
    centres = omega[half : half + len(power)]
    return np.sqrt(estimate_noise_level([centres], [power], [targets])[0])


def estimate_noise_level(
    places: list[np.ndarray], powers: list[np.ndarray], targets: list[np.ndarray]
) -> list[np.ndarray]:
    """Estimate the noise level around each target frequency.

    Frequencies (n_frequencies,) and squared residuals (n_frequencies, n_y) of each input's data
    give the level (n_target, n_y) at the target frequencies of each input.

    Notes
    -----
    The level is the median of the neighbours' powers, so that the few points on a sharp
    resonance, where a quintic does not fit, do not count as noise. The median of an
    exponential variable is ln 2 times its mean.
    """
    omega = np.concatenate(places)
    order = np.argsort(omega)
    omega, power = omega[order], np.concatenate(powers)[order]
    count = min(2 * _NEIGHBOURS, omega.size)
    last = omega.size - count
    starts = np.append(np.arange(0, last, _STRIDE), last)
    windows = np.lib.stride_tricks.sliding_window_view(power, count, axis=0)[starts]
    levels = np.median(windows, axis=2) / np.log(2.0)
    result = []
    for at in targets:
        first = np.clip(np.searchsorted(omega, at) - count // 2, 0, last)
        result.append(levels[np.minimum((first + _STRIDE // 2) // _STRIDE, starts.size - 1)])
    return result


def estimate_noise_about_responses(
    omega: Float[np.ndarray, " n_omega"],
    assigned_input: np.ndarray,
    values: Complex[np.ndarray, "n_omega n_channels"],
    command: Complex[np.ndarray, " n_omega"],
) -> Float[np.ndarray, "n_omega n_channels"] | None:
    """Estimate the noise of spectra at every frequency; None if all inputs have too few harmonics.

    ``command`` is the excitation of the assigned input of each harmonic, by its index. Spectra
    are NaN where a channel has no number.
    """
    places, powers = [], []
    for index in np.unique(assigned_input):
        own = np.flatnonzero(assigned_input == index)
        residuals = compute_local_residuals(values[own] / command[own][:, None])
        if residuals is not None:
            residual = residuals.values * command[own][residuals.indices][:, None]
            places.append(omega[own][residuals.indices])
            powers.append(np.abs(residual) ** 2)
    if not places:
        return None
    return np.sqrt(estimate_noise_level(places, powers, [omega])[0])


# --- Correlation of the noise of neighbouring frequencies of one record ---------------------------


def compute_noise_correlation(
    omega: Float[np.ndarray, " n_omega"], start_s: float, end_s: float
) -> Complex[np.ndarray, "n_omega n_omega"]:
    """Correlation of the finite Fourier transforms of white noise at some frequencies.

    Parameters
    ----------
    omega
        Frequencies, of any spacing. [rad/s]
    start_s, end_s
        Of the record that is transformed. [s]

    Notes
    -----
    For X(w) = integral of x exp(-j w t) over T = t1 - t0 and white x,
    E[X(w) X(v)*] = integral of exp(-j (w - v) t), which over T is
    sinc((w - v) T / 2 pi) exp(-j (w - v) (t0 + t1) / 2). Multiples of 1/T are
    independent; where the record is longer than the period of the excitation, neighbours
    are not: a record 1.2 periods long gives 0.16.
    Source: Brillinger, Time Series (1981), section 4.3.
    """
    apart = omega[:, None] - omega
    middle = 0.5 * (start_s + end_s)
    return np.sinc(apart * (end_s - start_s) / (2.0 * np.pi)) * np.exp(-1j * apart * middle)
