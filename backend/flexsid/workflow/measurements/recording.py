"""Recording: samples of a maneuver as they were read, and their spectra at its lines.

It needs no database: a worker anywhere transforms what it was sent.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.maneuver import Channel, Maneuver
from flexsid.sysid.preparation.artefacts import repair
from flexsid.sysid.preparation.resampling import resample
from flexsid.sysid.signals import FrequencyData
from flexsid.sysid.spectra.fourier import finite_fourier_transform, unit_lines
from flexsid.units import to_si

_TRIM_S = 0.25  # shortest stretch before the excitation that counts as trim
_NO_TAPER = 0.625  # of the sampling rate: a pass band that ends beyond the Nyquist frequency


@dataclass(frozen=True, slots=True)
class SpectrumFrequencies:
    """Frequencies of an analysis and, for each, the index of the input that owns it.

    ``owner`` is -1 where no input's excitation has the line.
    """

    omega: np.ndarray
    owner: np.ndarray
    inputs: tuple[str, ...]

    def within(self, band_hz: tuple[float, float] | None) -> SpectrumFrequencies:
        """The lines inside a band."""
        if band_hz is None:
            return self
        hz = self.omega / (2.0 * np.pi)
        keep = (hz >= band_hz[0] - 1e-9) & (hz <= band_hz[1] + 1e-9)
        if not keep.any():
            raise BadInput(
                f"no line of the maneuver lies between {band_hz[0]:g} and {band_hz[1]:g} Hz; "
                f"its lines span {hz.min():.3g} to {hz.max():.3g} Hz",
                code="empty-band",
                band_hz=list(band_hz),
            )
        return SpectrumFrequencies(self.omega[keep], self.owner[keep], self.inputs)


def maneuver_lines(
    maneuver: Maneuver, band_hz: tuple[float, float] | None = None
) -> SpectrumFrequencies:
    """The excited harmonics, or all multiples of 1/duration where none are known.

    Raises
    ------
    BadInput
        If the band holds no line, or a maneuver without known harmonics is
        analysed without a band.
    """
    excitation = maneuver.excitation
    if excitation is None:
        if band_hz is None:
            raise BadInput(
                "the excitation of this maneuver is not known; give the band to analyse (band_hz)",
                code="band-needed",
            )
        first = max(1, int(np.ceil(band_hz[0] * maneuver.duration_s - 1e-9)))
        last = int(np.floor(band_hz[1] * maneuver.duration_s + 1e-9))
        omega = unit_lines(np.arange(first, last + 1), maneuver.duration_s)
        lines = SpectrumFrequencies(omega, np.full(omega.size, -1), ())
        return lines.within(band_hz)
    inputs = tuple(excitation.harmonics)
    pairs = sorted(
        (harmonic, index)
        for index, name in enumerate(inputs)
        for harmonic in excitation.harmonics[name]
    )
    harmonics = np.array([h for h, _ in pairs])
    owner = np.array([i for _, i in pairs])
    return SpectrumFrequencies(unit_lines(harmonics, excitation.period_s), owner, inputs).within(
        band_hz
    )


@dataclass(frozen=True, slots=True)
class Conditioning:
    """All corrections of one channel together."""

    delay_s: float = 0.0
    scale: float = 1.0
    bias: float = 0.0
    stretches: tuple[tuple[int, int], ...] = ()

    def corrected(self, values: np.ndarray, rate_hz: float) -> np.ndarray:
        """Samples in SI with repairs and calibration; a delay is left for the spectra."""
        if self.stretches:
            values = repair(values, self.stretches, rate_hz)
        if self.scale != 1.0 or self.bias != 0.0:
            values = (values - self.bias) / self.scale
        return values

    def aligned(self, values: np.ndarray, rate_hz: float) -> np.ndarray:
        """Corrected samples with the delay undone at every frequency."""
        values = self.corrected(values, rate_hz)
        if self.delay_s == 0.0:
            return values
        band = (0.0, _NO_TAPER * rate_hz)
        return resample(values, rate_hz, 0.0, rate_hz, self.delay_s, values.size, None, band)


@dataclass(frozen=True, slots=True)
class Recording:
    """Channels of a maneuver with their samples, read but not yet transformed.

    ``parts`` are the recorded channels that each name stands for, with their weights;
    ``attitudes`` the channels that need not return to trim; ``conditioning`` the
    corrections in force by channel.
    """

    maneuver: Maneuver
    channels: tuple[tuple[Channel, np.ndarray], ...]
    parts: dict[str, tuple[tuple[str, float], ...]]
    attitudes: frozenset[str]
    conditioning: dict[str, Conditioning]

    def check(self, lines: SpectrumFrequencies) -> None:
        """Refuse lines that a channel was sampled too slowly for.

        Raises
        ------
        BadInput
            If there are such lines.
        """
        highest = lines.omega[-1]
        for channel, _ in self.channels:
            if highest > np.pi * channel.rate_hz:
                raise BadInput(
                    f"lines reach {highest / 2 / np.pi:.4g} Hz but a channel was sampled at "
                    f"{channel.rate_hz:g} Hz; choose a band below {channel.rate_hz / 2:g} Hz",
                    code="beyond-nyquist",
                )

    def spectra(self, names: tuple[str, ...], lines: SpectrumFrequencies) -> FrequencyData:
        """Transform channels and combinations, in SI."""
        self.check(lines)
        needed = {part for name in names for part, _ in self.parts[name]}
        by_clock: dict[tuple[float, float, int], list[tuple[Channel, np.ndarray]]] = {}
        for channel, samples in self.channels:
            if channel.name in needed:
                clock = (channel.rate_hz, channel.start_s, channel.n_samples)
                by_clock.setdefault(clock, []).append((channel, self._in_si(channel, samples)))
        spectra: dict[str, np.ndarray] = {}
        for (rate_hz, start_s, _), group in by_clock.items():
            samples = np.stack([values for _, values in group], axis=1)
            settles = np.array([channel.name in self.attitudes for channel, _ in group])
            transform = _transform(samples, rate_hz, start_s, self.maneuver, lines, settles)
            spectra.update({c.name: transform[:, k] for k, (c, _) in enumerate(group)})
        for name, one in self.conditioning.items():
            if one.delay_s and name in spectra:
                spectra[name] = spectra[name] * np.exp(1j * lines.omega * one.delay_s)
        columns = [sum(w * spectra[part] for part, w in self.parts[name]) for name in names]
        values = np.reshape(np.array(columns, dtype=complex), (len(names), lines.omega.size)).T
        return FrequencyData(lines.omega, values, names)

    def _in_si(self, channel: Channel, samples: np.ndarray) -> np.ndarray:
        values = to_si(samples, channel.unit)
        if channel.name not in self.conditioning:
            return values
        one = self.conditioning[channel.name]
        return one.corrected(np.asarray(values, dtype=float), channel.rate_hz)


def _transform(
    samples: np.ndarray,
    rate_hz: float,
    start_s: float,
    maneuver: Maneuver,
    lines: SpectrumFrequencies,
    settles: np.ndarray,
) -> np.ndarray:
    """Whole record of one period, or the whole periods after the first of several."""
    excitation = maneuver.excitation
    samples = trim_removed(samples, rate_hz, start_s, maneuver)
    if excitation is not None and excitation.n_periods > 1:
        period = excitation.period_s
        first = round((excitation.start_s + period - start_s) * rate_hz)
        last = first + round((excitation.n_periods - 1) * period * rate_hz)
        if last <= samples.shape[0] + 1:
            window = samples[first:last]
            return finite_fourier_transform(window, rate_hz, lines.omega, start_s + first / rate_hz)
    if excitation is None and settles.any():
        # An attitude is held after its record where it ended, and before where it began.
        first = samples[: _held(rate_hz)].mean(axis=0)
        samples = samples - np.where(settles, first, 0.0)
    # A multisine starts and ends at trim; other records are cut wherever they were.
    transform = finite_fourier_transform(
        samples, rate_hz, lines.omega, start_s, end_corrected=excitation is None
    )
    if settles.any():
        transform[:, settles] += _held_level(samples[:, settles], rate_hz, lines.omega, start_s)
    return transform


def trim_removed(
    samples: np.ndarray, rate_hz: float, start_s: float, maneuver: Maneuver
) -> np.ndarray:
    """Take off the mean before the excitation, or of all where too little lies before."""
    excitation = maneuver.excitation
    begin = maneuver.start_s if excitation is None else excitation.start_s
    trim = round((begin - start_s) * rate_hz)
    # From the first sample on, so that a channel that never moves is exactly zero.
    moved = samples - samples[:1]
    steady = moved[:trim] if trim >= _TRIM_S * rate_hz else moved
    return moved - steady.mean(axis=0)


def _held(rate_hz: float) -> int:
    """Number of samples at either end that give the level there."""
    return max(1, round(0.5 * rate_hz))


def _held_level(
    samples: np.ndarray, rate_hz: float, omega: np.ndarray, start_s: float
) -> np.ndarray:
    """What an attitude that ends away from trim adds after the record, held there.

    Attitude integrates pitch rate and need not return; cut off, it would look as if
    it had jumped back to trim.
    """
    level = samples[-_held(rate_hz) :].mean(axis=0)
    end_s = start_s + samples.shape[0] / rate_hz
    step = np.exp(-1j * omega * end_s) / (1j * omega)
    return step[:, None] * level
