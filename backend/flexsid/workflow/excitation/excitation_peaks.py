"""Peaks of an excitation in flight: deflection and rate of the surfaces, and load factor."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from flexsid.sysid.estimation.fisher_information import LOAD_FACTOR, FisherInformation


@dataclass(frozen=True, slots=True, kw_only=True)
class ExcitationPeaks:
    """Peaks or limits of deflection [rad], rate [rad/s] and load factor [1].

    The first two are those of the surface that uses most.
    """

    deflection: float
    rate: float
    load_factor: float

    def override(
        self, deflection: float | None, rate: float | None, load_factor: float | None
    ) -> ExcitationPeaks:
        """Return those that are given, else these."""
        return ExcitationPeaks(
            deflection=deflection or self.deflection,
            rate=rate or self.rate,
            load_factor=load_factor or self.load_factor,
        )

    def find_scale(self, peaks: ExcitationPeaks) -> float:
        """Largest factor on an excitation with these peaks."""
        return min(self._compute_factors(peaks).values())

    def find_active(self, peaks: ExcitationPeaks) -> str:
        """Name of the limit that an excitation with these peaks reaches first."""
        factors = self._compute_factors(peaks)
        return min(factors, key=lambda name: factors[name])

    def _compute_factors(self, peaks: ExcitationPeaks) -> dict[str, float]:
        return {
            one.name: float(getattr(self, one.name) / getattr(peaks, one.name))
            for one in fields(self)
        }


def find_peaks(information: FisherInformation, period_s: float) -> ExcitationPeaks:
    """Find the peaks of deflections, their rates, and the load factor over one period."""
    waves = information.waves.sum(axis=0)
    moving = [k for k, name in enumerate(information.limited) if name != LOAD_FACTOR]
    omega = 2.0 * np.pi * np.fft.rfftfreq(len(waves), period_s / len(waves))
    rates = np.fft.irfft(1j * omega[:, None] * np.fft.rfft(waves[:, moving], axis=0), len(waves), 0)
    load = waves[:, information.limited.index(LOAD_FACTOR)]
    return ExcitationPeaks(
        deflection=float(np.abs(waves[:, moving]).max()),
        rate=float(np.abs(rates).max()),
        load_factor=float(np.abs(load).max()),
    )
