"""Experiment: what was measured at the lines of one maneuver, and what explains it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float

from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.spectra.line_correlation import line_correlation

_INDEPENDENT = 0.01  # correlation of two lines that changes no test


@dataclass(frozen=True, slots=True)
class Experiment:
    """What was measured at the lines of one maneuver.

    ``instruments`` is each output's measured over true response; inputs have
    theirs removed already. Lines of one ``group`` follow each other and share a noise
    covariance: one group for OE, one per input for FRE. Where lines are computed from
    others, ``source`` holds those, and ``gain`` how the noise of each enters each line here.
    ``edges_s`` are the times at which the record may begin or end in motion, ``window_s`` begin
    and end of what was transformed, None where that is not known. [s]
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

    def noise_correlation(self) -> Complex[np.ndarray, "n_omega n_omega"] | None:
        """Correlation between lines of white noise in the record; None where they have none.

        Notes
        -----
        Lines computed from others as G Z have the covariance G C G^H, of which this is the
        correlation.
        """
        if self.source is not None and self.gain is not None:
            alike = self.source.noise_correlation()
            spread = self.gain if alike is None else self.gain @ alike
            covariance = spread @ self.gain.conj().T
            size = np.sqrt(np.real(np.diag(covariance)))
            return covariance / np.outer(size, size)
        if self.window_s is None:
            return None
        found = line_correlation(self.omega, *self.window_s)
        return None if np.abs(found - np.eye(len(found))).max() < _INDEPENDENT else found
