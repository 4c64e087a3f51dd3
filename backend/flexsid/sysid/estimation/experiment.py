"""Experiment: measured spectra and model of one maneuver."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float

from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.spectra.noise_correlation import compute_noise_correlation

_INDEPENDENT = 0.01  # correlation of two frequencies without effect on a test


@dataclass(frozen=True, slots=True)
class Experiment:
    """Measured spectra of one maneuver.

    ``instruments`` is each output's measured over true response; that of the inputs is
    removed. Frequencies of one ``group`` are contiguous and share a noise covariance: one
    group for OE, one per input for FRE. For data computed from other data points, ``source``
    is the latter, and ``gain`` the factor of their noise in each frequency here. ``edges_s``
    are the times at which the record may begin or end in motion, ``window_s`` begin and end
    of the transformed record, None if unknown. [s] With ``free_ends`` nothing was assumed of the
    motion there; else attitudes keep their last level. ``first_end`` is the number of the first
    of these times among those of all experiments of a fit.
    """

    name: str
    model: AeroelasticModel
    instruments: Complex[np.ndarray, "n_omega n_y"]
    omega: Float[np.ndarray, " n_omega"]
    inputs: Complex[np.ndarray, "n_omega n_u"]
    measured: Complex[np.ndarray, "n_omega n_y"]
    group: np.ndarray
    group_names: tuple[str, ...]
    source: Experiment | None = None
    gain: Complex[np.ndarray, "n_omega n_source"] | None = None
    edges_s: tuple[float, ...] = ()
    window_s: tuple[float, float] | None = None
    free_ends: bool = False
    first_end: int = 0

    def noise_correlation(self) -> Complex[np.ndarray, "n_omega n_omega"] | None:
        """Compute the correlation between frequencies of white noise of the record, if any.

        Notes
        -----
        Data computed from others as G Z have the covariance G C G^H; this is its correlation.
        """
        if self.source is not None and self.gain is not None:
            correlation = self.source.noise_correlation()
            spread = self.gain if correlation is None else self.gain @ correlation
            covariance = spread @ self.gain.conj().T
            size = np.sqrt(np.real(np.diag(covariance)))
            return covariance / np.outer(size, size)
        if self.window_s is None:
            return None
        found = compute_noise_correlation(self.omega, *self.window_s)
        return None if np.abs(found - np.eye(len(found))).max() < _INDEPENDENT else found
