"""Instrument: sensor dynamics, filters and delay between a quantity and its samples."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float


@dataclass(frozen=True, slots=True, kw_only=True)
class SecondOrder:
    """Sensor with unit static gain: wn^2 / (s^2 + 2 zeta wn s + wn^2)."""

    natural_frequency: float
    damping: float

    def polynomials(self) -> tuple[np.ndarray, np.ndarray]:
        """Return numerator and denominator in s, highest power first."""
        wn = self.natural_frequency
        return np.array([wn**2]), np.array([1.0, 2.0 * self.damping * wn, wn**2])


@dataclass(frozen=True, slots=True, kw_only=True)
class FirstOrder:
    """Lag with unit static gain: wc / (s + wc)."""

    corner: float

    def polynomials(self) -> tuple[np.ndarray, np.ndarray]:
        """Return numerator and denominator in s, highest power first."""
        return np.array([self.corner]), np.array([1.0, self.corner])


@dataclass(frozen=True, slots=True, kw_only=True)
class Butterworth:
    """Analog low-pass filter of given order and corner. [rad/s]"""

    order: int
    corner: float

    def polynomials(self) -> tuple[np.ndarray, np.ndarray]:
        """Return numerator and denominator in s, highest power first."""
        # Without scipy.signal, whose import takes seconds.
        angles = np.pi * (2 * np.arange(self.order) + self.order + 1) / (2 * self.order)
        denominator = np.poly(self.corner * np.exp(1j * angles)).real
        return denominator[-1:], denominator


Element = SecondOrder | FirstOrder | Butterworth


@dataclass(frozen=True, slots=True, kw_only=True)
class Instrument:
    """A chain of elements followed by a pure delay. [s]"""

    elements: tuple[Element, ...] = ()
    delay_s: float = 0.0

    def response(self, omega: Float[np.ndarray, " n_omega"]) -> Complex[np.ndarray, " n_omega"]:
        """Compute the response of the whole chain, delay included: measured over true. [1]"""
        s = 1j * np.asarray(omega, dtype=float)
        response = np.exp(-s * self.delay_s)
        for element in self.elements:
            numerator, denominator = element.polynomials()
            response = response * np.polyval(numerator, s) / np.polyval(denominator, s)
        return response
