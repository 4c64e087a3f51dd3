"""Recording: samples of a maneuver and their spectra, without a database."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.maneuver import Channel, Maneuver
from flexsid.sysid.preparation.resampling import resample
from flexsid.sysid.preparation.spikes_and_dropouts import repair_samples
from flexsid.sysid.signals import FrequencyData
from flexsid.sysid.spectra.fourier import compute_harmonic_frequencies, finite_fourier_transform
from flexsid.units import to_si

_TRIM_S = 0.25  # shortest interval before the excitation that counts as trim [s]
_NO_TAPER = 0.625  # of the sampling rate: a pass band above the Nyquist frequency


@dataclass(frozen=True, slots=True)
class SpectrumFrequencies:
    """Frequencies of an analysis and the index of the input that each is assigned to.

    ``assigned_input`` is -1 where the frequency is a harmonic of no input.
    """

    omega: np.ndarray
    assigned_input: np.ndarray
    inputs: tuple[str, ...]

    def within(self, band_hz: tuple[float, float] | None) -> SpectrumFrequencies:
        """Select the frequencies inside a band."""
        if band_hz is None:
            return self
        hz = self.omega / (2.0 * np.pi)
        inside = (hz >= band_hz[0] - 1e-9) & (hz <= band_hz[1] + 1e-9)
        if not inside.any():
            raise BadInput(
                f"no frequency of the maneuver lies between {band_hz[0]:g} and {band_hz[1]:g} Hz; "
                f"its frequencies span {hz.min():.3g} to {hz.max():.3g} Hz",
                code="empty-band",
                band_hz=list(band_hz),
            )
        return SpectrumFrequencies(self.omega[inside], self.assigned_input[inside], self.inputs)


def select_frequencies(
    maneuver: Maneuver, band_hz: tuple[float, float] | None = None
) -> SpectrumFrequencies:
    """Select the excited harmonics, or all multiples of 1/duration where none are known.

    Raises
    ------
    BadInput
        If the band contains no frequency, or a maneuver without known harmonics is
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
        omega = compute_harmonic_frequencies(np.arange(first, last + 1), maneuver.duration_s)
        frequencies = SpectrumFrequencies(omega, np.full(omega.size, -1), ())
        return frequencies.within(band_hz)
    inputs = tuple(excitation.harmonics)
    pairs = sorted(
        (harmonic, index)
        for index, name in enumerate(inputs)
        for harmonic in excitation.harmonics[name]
    )
    harmonics = np.array([h for h, _ in pairs])
    assigned_input = np.array([i for _, i in pairs])
    return SpectrumFrequencies(
        compute_harmonic_frequencies(harmonics, excitation.period_s), assigned_input, inputs
    ).within(band_hz)


@dataclass(frozen=True, slots=True)
class Conditioning:
    """All active corrections of one channel."""

    delay_s: float = 0.0
    scale: float = 1.0
    bias: float = 0.0
    stretches: tuple[tuple[int, int], ...] = ()

    def correct(self, values: np.ndarray, rate_hz: float) -> np.ndarray:
        """Apply repairs and calibration; the delay is applied to the spectra."""
        if self.stretches:
            values = repair_samples(values, self.stretches, rate_hz)
        if self.scale != 1.0 or self.bias != 0.0:
            values = (values - self.bias) / self.scale
        return values

    def align(self, values: np.ndarray, rate_hz: float) -> np.ndarray:
        """Apply repairs and calibration and remove the delay at every frequency."""
        values = self.correct(values, rate_hz)
        if self.delay_s == 0.0:
            return values
        band = (0.0, _NO_TAPER * rate_hz)
        return resample(values, rate_hz, 0.0, rate_hz, self.delay_s, values.size, None, band)


@dataclass(frozen=True, slots=True)
class Recording:
    """Channels of a maneuver with their samples, read but not yet transformed.

    ``parts`` are the recorded channels behind each name, with their weights;
    ``attitudes`` the channels that need not return to trim; ``conditioning`` the
    active corrections by channel.
    """

    maneuver: Maneuver
    channels: tuple[tuple[Channel, np.ndarray], ...]
    parts: dict[str, tuple[tuple[str, float], ...]]
    attitudes: frozenset[str]
    conditioning: dict[str, Conditioning]

    def check(self, frequencies: SpectrumFrequencies) -> None:
        """Refuse frequencies above the Nyquist frequency of a channel.

        Raises
        ------
        BadInput
            If there are such frequencies.
        """
        highest = frequencies.omega[-1]
        for channel, _ in self.channels:
            if highest > np.pi * channel.rate_hz:
                raise BadInput(
                    f"frequencies reach {highest / 2 / np.pi:.4g} Hz but a channel was sampled at "
                    f"{channel.rate_hz:g} Hz; choose a band below {channel.rate_hz / 2:g} Hz",
                    code="beyond-nyquist",
                )

    def spectra(self, names: tuple[str, ...], frequencies: SpectrumFrequencies) -> FrequencyData:
        """Transform channels and combinations to spectra in SI units."""
        self.check(frequencies)
        needed = {part for name in names for part, _ in self.parts[name]}
        by_clock: dict[tuple[float, float, int], list[tuple[Channel, np.ndarray]]] = {}
        for channel, samples in self.channels:
            if channel.name in needed:
                clock = (channel.rate_hz, channel.start_s, channel.n_samples)
                by_clock.setdefault(clock, []).append(
                    (channel, self._convert_to_si(channel, samples))
                )
        spectra: dict[str, np.ndarray] = {}
        for (rate_hz, start_s, _), group in by_clock.items():
            samples = np.stack([values for _, values in group], axis=1)
            is_attitude = np.array([channel.name in self.attitudes for channel, _ in group])
            transform = _transform(
                samples, rate_hz, start_s, self.maneuver, frequencies, is_attitude
            )
            spectra.update({c.name: transform[:, k] for k, (c, _) in enumerate(group)})
        for name, one in self.conditioning.items():
            if one.delay_s and name in spectra:
                spectra[name] = spectra[name] * np.exp(1j * frequencies.omega * one.delay_s)
        columns = [sum(w * spectra[part] for part, w in self.parts[name]) for name in names]
        values = np.reshape(
            np.array(columns, dtype=complex), (len(names), frequencies.omega.size)
        ).T
        return FrequencyData(frequencies.omega, values, names)

    def _convert_to_si(self, channel: Channel, samples: np.ndarray) -> np.ndarray:
        values = to_si(samples, channel.unit)
        if channel.name not in self.conditioning:
            return values
        one = self.conditioning[channel.name]
        return one.correct(np.asarray(values, dtype=float), channel.rate_hz)


def _transform(
    samples: np.ndarray,
    rate_hz: float,
    start_s: float,
    maneuver: Maneuver,
    frequencies: SpectrumFrequencies,
    is_attitude: np.ndarray,
) -> np.ndarray:
    """Transform a record of one period, or the periods after the first of several."""
    excitation = maneuver.excitation
    samples = remove_trim(samples, rate_hz, start_s, maneuver)
    if excitation is not None and excitation.n_periods > 1:
        period = excitation.period_s
        first = round((excitation.start_s + period - start_s) * rate_hz)
        last = first + round((excitation.n_periods - 1) * period * rate_hz)
        if last <= samples.shape[0] + 1:
            window = samples[first:last]
            return finite_fourier_transform(
                window, rate_hz, frequencies.omega, start_s + first / rate_hz
            )
    if excitation is None and is_attitude.any():
        # An attitude has its first level before the record and its last level after it.
        first = samples[: _count_level_samples(rate_hz)].mean(axis=0)
        samples = samples - np.where(is_attitude, first, 0.0)
    # A multisine starts and ends at trim; other records start and end in motion.
    transform = finite_fourier_transform(
        samples, rate_hz, frequencies.omega, start_s, end_corrected=excitation is None
    )
    if is_attitude.any():
        transform[:, is_attitude] += _transform_held_level(
            samples[:, is_attitude], rate_hz, frequencies.omega, start_s
        )
    return transform


def remove_trim(
    samples: np.ndarray, rate_hz: float, start_s: float, maneuver: Maneuver
) -> np.ndarray:
    """Remove the mean before the excitation, or of the record where that is too short."""
    excitation = maneuver.excitation
    begin = maneuver.start_s if excitation is None else excitation.start_s
    trim = round((begin - start_s) * rate_hz)
    # Relative to the first sample, so that a constant channel is exactly zero.
    moved = samples - samples[:1]
    steady = moved[:trim] if trim >= _TRIM_S * rate_hz else moved
    return moved - steady.mean(axis=0)


def _count_level_samples(rate_hz: float) -> int:
    """Return the number of samples that define the level at either end."""
    return max(1, round(0.5 * rate_hz))


def _transform_held_level(
    samples: np.ndarray, rate_hz: float, omega: np.ndarray, start_s: float
) -> np.ndarray:
    """Compute the transform of the final attitude level after the end of the record.

    Attitude integrates pitch rate and need not return to trim; a truncated record would
    contain a step back to trim.
    """
    level = samples[-_count_level_samples(rate_hz) :].mean(axis=0)
    end_s = start_s + samples.shape[0] / rate_hz
    step = np.exp(-1j * omega * end_s) / (1j * omega)
    return step[:, None] * level
