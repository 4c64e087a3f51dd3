"""Frequency responses H1, H2 and Hv from averaged spectra, with coherence and standard errors."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import Complex, Float

from flexsid.errors import BadInput
from flexsid.sysid.spectra.averaged_spectra import AveragedSpectra

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
