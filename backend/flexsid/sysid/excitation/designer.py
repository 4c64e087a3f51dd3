"""Multisine designer: phases from a specification, and the recipe that reproduces them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from jaxtyping import Float

from flexsid.allowed import Allowed, Name, Number, Positive
from flexsid.errors import BadInput
from flexsid.sysid.excitation.extrema import evaluate_peak_factor
from flexsid.sysid.excitation.harmonic_assignment import check_harmonics
from flexsid.sysid.excitation.multisine import Multisine, Tones
from flexsid.sysid.excitation.norms import HarmonicSpectrum
from flexsid.sysid.excitation.peak_factor import start_at_zero, starts_at_zero
from flexsid.sysid.excitation.phase_search import (
    PATIENT,
    QUICK,
    THOROUGH,
    Effort,
    FoundPhases,
    search_phases,
)

EFFORTS: dict[str, Effort] = {"quick": QUICK, "thorough": THOROUGH, "patient": PATIENT}

_MOST_SAMPLES = 100_000  # in a period: what export and figures write within a second
_MOST_VALUES = 1_100_000  # of all inputs in a period, for the same reason
_SEARCH_S = {"quick": 1.0, "thorough": 15.0, "patient": 60.0}
"""Effort over that of ``quick``. Measured on one core of 2.5 GHz, as are the next three."""
_PER_PAIR_S, _PER_TONE_S, _PER_HARMONIC_S = 2e-6, 1e-4, 9e-6
_LEAST_POINTS = 64  # of the grid on which the largest deflection is found
_MOST_PERIODS = 200_000
"""Highest harmonics of all inputs: a grid of 64 times as many points takes .3 s.

Rows of Table 1 with a phugoid and elastic modes of both axes as targets have 186,000 (FLEX-28).
"""


Harmonic = Annotated[int, Allowed(ge=1, le=20_000)]


@dataclass(frozen=True, slots=True, kw_only=True)
class InputSpecification:
    """One input: its harmonics, its peak relative to the design's, and the power of each harmonic.

    ``power`` is relative; the spectrum is flat by default.
    """

    name: Name
    harmonics: Annotated[tuple[Harmonic, ...], Allowed(max_length=500)]
    relative_peak: Positive = 1.0
    power: Annotated[tuple[Number, ...] | None, Allowed(max_length=500)] = None


@dataclass(frozen=True, slots=True, kw_only=True)
class DesignSpecification:
    """Specification of a design; with the phases it is the complete recipe.

    ``peaks`` are the largest deflections of an input with relative peak 1 at the
    three amplitudes, low to high, in the unit of the command.
    """

    duration_s: float
    rate_hz: float
    inputs: tuple[InputSpecification, ...]
    peaks: tuple[float, float, float]
    effort: str = "thorough"
    seed: int = 0


def design(
    specification: DesignSpecification,
    report: Callable[[str, float, float], None] | None = None,
) -> Multisine:
    """Search the phases of every input and scale to the low amplitude.

    ``report`` is called with the input, its best relative peak factor so far, and the fraction
    of the whole that is done; it may raise to stop.

    Raises
    ------
    BadInput
        If the specification cannot be fulfilled; the message has the numbers.
    """
    check_specification(specification)
    spectra = [_build_spectrum(own) for own in specification.inputs]
    ends = np.cumsum([spectrum.harmonics.size for spectrum in spectra])
    phases = {}
    for place, (own, spectrum) in enumerate(zip(specification.inputs, spectra, strict=True)):

        def report_input(best: FoundPhases, fraction: float, place: int = place) -> None:
            if report is not None:
                done = ends[place] - (1.0 - fraction) * spectra[place].harmonics.size
                report(specification.inputs[place].name, best.peak_factor, float(done / ends[-1]))

        effort, seed = EFFORTS[specification.effort], specification.seed + place
        found = search_phases(spectrum, effort, seed, report_input).phases
        phases[own.name] = start_at_zero(spectrum.harmonics, spectrum.amplitudes, found)
    return build_multisine(specification, phases)


def build_multisine(
    specification: DesignSpecification,
    phases: dict[str, Float[np.ndarray, " n_tones"]],
    level: int = 0,
) -> Multisine:
    """Build the multisine of a recipe at one of its three amplitudes, starting at zero.

    Phases of a recipe start at zero; others are shifted in time.
    """
    tones = {}
    for own in specification.inputs:
        spectrum = _build_spectrum(own)
        harmonics, amplitudes = spectrum.harmonics, spectrum.amplitudes
        shifted = np.asarray(phases[own.name])
        if not starts_at_zero(amplitudes, shifted):
            shifted = start_at_zero(harmonics, amplitudes, shifted)
        wave = spectrum.on_grid(shifted[None], spectrum.grid_size(_LEAST_POINTS))
        peak = specification.peaks[level] * own.relative_peak
        size = peak / float(np.abs(wave).max())
        tones[own.name] = Tones(harmonics, amplitudes * size, shifted)
    return Multisine(specification.duration_s, tones)


def estimate_search_time_s(specification: DesignSpecification) -> float:
    """Estimate the processor time of the phase search. [s]

    Notes
    -----
    An iteration solves for all phases of an input (pairs of tones) on a grid of its highest
    harmonic; the effort counts the iterations.
    """
    total = 0.0
    for own in specification.inputs:
        n, highest = len(own.harmonics), max(own.harmonics, default=0)
        total += _PER_PAIR_S * n**2 + _PER_TONE_S * n + _PER_HARMONIC_S * highest
    return _SEARCH_S[specification.effort] * total


def check_period(duration_s: float, rate_hz: float, n_inputs: int) -> None:
    """Raise BadInput for a period with too many samples, before anything is computed.

    Raises
    ------
    BadInput
        If duration or rate are not positive, or the samples are too many.
    """
    if not (0.0 < duration_s < 1e5 and 0.0 < rate_hz <= 1e5):
        raise BadInput(f"{duration_s:g} s at {rate_hz:g} Hz is no design; both must be positive")
    samples = duration_s * rate_hz
    most = min(_MOST_SAMPLES, _MOST_VALUES // max(1, n_inputs))
    if samples > most:
        raise BadInput(
            f"{duration_s:g} s at {rate_hz:g} Hz are {samples:.3g} samples; a design has at"
            f" most {most} in the period of {n_inputs} inputs; take a shorter period, a lower rate"
            " or fewer inputs",
            code="too-many-samples",
        )


def check_specification(specification: DesignSpecification) -> None:
    """Raise BadInput for a specification that cannot be fulfilled."""
    if specification.effort not in EFFORTS:
        raise BadInput(f"effort {specification.effort!r} is not one of {', '.join(EFFORTS)}")
    check_period(specification.duration_s, specification.rate_hz, len(specification.inputs))
    if not 0.0 < specification.peaks[0] <= specification.peaks[1] <= specification.peaks[2]:
        raise BadInput(
            f"amplitudes {specification.peaks} must be positive and rise from low to high"
        )
    names = [own.name for own in specification.inputs]
    if len(set(names)) != len(names):
        raise BadInput(f"inputs {', '.join(names)} must all have different names")
    check_harmonics(
        {own.name: own.harmonics for own in specification.inputs},
        specification.duration_s,
        specification.rate_hz,
    )
    together = sum(max(own.harmonics) for own in specification.inputs)
    if together > _MOST_PERIODS:
        raise BadInput(
            f"the highest harmonics of all inputs are {together} together; a design has at most"
            f" {_MOST_PERIODS}; take a shorter period, a lower band or fewer inputs",
            code="harmonics-too-high",
        )
    for own in specification.inputs:
        if own.relative_peak <= 0.0:
            raise BadInput(f"relative peak {own.relative_peak:g} of {own.name} must be positive")
        if own.power is None:
            continue
        if len(own.power) != len(own.harmonics):
            raise BadInput(
                f"{own.name} has {len(own.harmonics)} harmonics but {len(own.power)} powers"
            )
        if min(own.power) <= 0.0:
            raise BadInput(f"a power of {own.name} is {min(own.power):g}; each must be positive")


def compute_peak_factors(multisine: Multisine) -> dict[str, float]:
    """Relative peak factor of every input, peaks interpolated between samples. [1]"""
    return {
        name: evaluate_peak_factor(
            HarmonicSpectrum(tones.harmonics, tones.amplitudes), tones.phases
        )
        for name, tones in multisine.tones.items()
    }


def _build_spectrum(own: InputSpecification) -> HarmonicSpectrum:
    harmonics = np.array(own.harmonics)
    power = np.ones(harmonics.size) if own.power is None else np.array(own.power, dtype=float)
    return HarmonicSpectrum(harmonics, np.sqrt(2.0 * power / power.sum()))
