"""Orthogonal phase-optimized multisines (Eq. 4): assign harmonics, synthesize, scale."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float, Int

from flexsid.errors import BadInput
from flexsid.sysid.excitation.peak_factor import (
    HarmonicSpectrum,
    lower_peak,
    schroeder_phases,
    start_at_zero,
)


@dataclass(frozen=True, slots=True)
class Tones:
    """The sines of one input: a_k sin(2 pi k t / T + phi_k)."""

    harmonics: Int[np.ndarray, " n_tones"]
    amplitudes: Float[np.ndarray, " n_tones"]
    phases: Float[np.ndarray, " n_tones"]

    def sample(self, cycles: Float[np.ndarray, " n_samples"]) -> Float[np.ndarray, " n_samples"]:
        """Sum the sines at times given in periods. [unit of the amplitudes]"""
        total = np.zeros(cycles.size)
        for harmonic, amplitude, phase in zip(
            self.harmonics, self.amplitudes, self.phases, strict=True
        ):
            total += amplitude * np.sin(2.0 * np.pi * harmonic * cycles + phase)
        return total

    def scaled_to_peak(self, peak: float) -> Tones:
        """Scale so that the largest magnitude over a period is ``peak``."""
        fine = np.arange(64 * int(self.harmonics.max())) / (64 * int(self.harmonics.max()))
        return replace(self, amplitudes=self.amplitudes * peak / np.abs(self.sample(fine)).max())


@dataclass(frozen=True, slots=True)
class Multisine:
    """One design: every input has its own harmonics of 1/period, none is shared."""

    period_s: float
    tones: Mapping[str, Tones]

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names of the inputs, in the order of their columns."""
        return tuple(self.tones)

    @property
    def band_hz(self) -> tuple[float, float]:
        """Lowest and highest frequency of any input. [Hz]"""
        every = np.concatenate([tones.harmonics for tones in self.tones.values()])
        return float(every.min()) / self.period_s, float(every.max()) / self.period_s

    def scale(self, factor: float) -> Multisine:
        """Multiply all amplitudes."""
        return replace(
            self,
            tones={
                name: replace(tones, amplitudes=factor * tones.amplitudes)
                for name, tones in self.tones.items()
            },
        )

    def combine(self, sums: Mapping[str, Mapping[str, float]]) -> Multisine:
        """Combine inputs to weighted sums, which have the harmonics of all their terms.

        Every harmonic has one input, so that it has one term of each sum.
        """
        tones = {}
        for name, weights in sums.items():
            terms = [(self.tones[term], weight) for term, weight in weights.items()]
            harmonics = np.concatenate([one.harmonics for one, _ in terms])
            order = np.argsort(harmonics)
            amplitudes = np.concatenate([abs(weight) * one.amplitudes for one, weight in terms])
            turned = [one.phases + (np.pi if weight < 0.0 else 0.0) for one, weight in terms]
            phases = np.concatenate(turned)
            tones[name] = Tones(harmonics[order], amplitudes[order], phases[order])
        return replace(self, tones=tones)

    def harmonics(self) -> dict[str, tuple[int, ...]]:
        """The sets K_j of Eq. 4 by input."""
        return {name: tuple(map(int, tones.harmonics)) for name, tones in self.tones.items()}

    def sample(
        self, time_s: Float[np.ndarray, " n_samples"]
    ) -> Float[np.ndarray, "n_samples n_inputs"]:
        """Excitation of every input, one column each [rad], at times since its start. [s]

        The design repeats with its period; the caller decides when it ends.
        """
        cycles = np.asarray(time_s, dtype=float) / self.period_s
        return np.stack([tones.sample(cycles) for tones in self.tones.values()], axis=1)

    def sample_period(self, rate_hz: float) -> Float[np.ndarray, "n_samples n_inputs"]:
        """Excitation of every input over one period, by one transform each. [rad]

        The period has a whole number of samples, and the harmonics are below the Nyquist frequency.
        """
        n_samples = round(self.period_s * rate_hz)
        waves = [
            HarmonicSpectrum(own.harmonics, own.amplitudes).on_grid(own.phases[None], n_samples)[0]
            for own in self.tones.values()
        ]
        return np.stack(waves, axis=1)


def assign_harmonics(
    order: Sequence[str], per_input: int, first: int
) -> dict[str, Int[np.ndarray, " n_tones"]]:
    """Assign consecutive harmonics to the inputs in turn, so that each spans the whole band.

    Parameters
    ----------
    order
        Inputs in the order in which they are served; neighbours on the wing
        should not be neighbours here.
    per_input
        Harmonics for each input.
    first
        Lowest harmonic of 1/T used.

    Raises
    ------
    BadInput
        If an input is served twice, or the lowest harmonic is below one.
    """
    if len(set(order)) < len(order) or first < 1:
        raise BadInput(
            f"harmonics from {first} on cannot be assigned to {', '.join(order)}; name every input "
            "once, and begin at one or above",
            code="bad-assignment",
        )
    return {
        name: first + index + len(order) * np.arange(per_input) for index, name in enumerate(order)
    }


def design_multisine(
    harmonics: Mapping[str, Int[np.ndarray, " n_tones"]],
    period_s: float,
    peaks: Mapping[str, float],
) -> Multisine:
    """Design flat-spectrum multisines of low peak factor that start and end at zero.

    Parameters
    ----------
    harmonics
        Harmonics of 1/period of each input; disjoint.
    period_s
        Period T. [s]
    peaks
        Largest deflection of each input. [rad]

    Raises
    ------
    ValueError
        If two inputs share a harmonic: they would not be orthogonal.

    Notes
    -----
    Source: Eq. 4 and Sec. V.B. Departure: phases come from Schroeder's formula
    (doi:10.1109/TIT.1970.1054411) improved by clipping instead of a simplex search.
    """
    shared = np.concatenate(list(harmonics.values()))
    if np.unique(shared).size != shared.size:
        raise ValueError("inputs share a harmonic; assign each harmonic to one input only")
    tones = {}
    for name, own in harmonics.items():
        amplitudes = np.full(own.size, np.sqrt(2.0 / own.size))
        phases = lower_peak(own, amplitudes, schroeder_phases(amplitudes))
        phases = start_at_zero(own, amplitudes, phases)
        tones[name] = Tones(own, amplitudes, phases).scaled_to_peak(peaks[name])
    return Multisine(period_s, tones)
