"""Recording: samples of a maneuver and their spectra, without a database."""

from __future__ import annotations

from collections.abc import Container, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.aircraft import Aircraft
from flexsid.records.maneuver import Channel, Correction, Maneuver, StepKind
from flexsid.sysid.model.aeroelastic import StateSpace
from flexsid.sysid.preparation.resampling import (
    BetweenSamples,
    fill_between,
    resample,
    respond_between,
)
from flexsid.sysid.preparation.spikes_and_dropouts import repair_samples
from flexsid.sysid.signals import FrequencyData
from flexsid.sysid.spectra.fourier import (
    compute_harmonic_frequencies,
    finite_fourier_transform,
    integrate_between,
    integrate_steps,
    transform_with_levels,
)
from flexsid.sysid.spectra.measured_spectra import (
    ExcitationData,
    MeasuredSpectra,
    compute_resolution_overlap,
)
from flexsid.sysid.spectra.steps import (
    N_TERMS,
    integrate_held,
    sum_step_errors,
    transform_integrals,
)
from flexsid.units import to_si
from flexsid.workflow.aircraft.aircraft_models import (
    OutputDefinition,
    compute_input_corrections,
    get_output_instrument,
)

COMMAND_SUFFIX = "_command"  # of the channel with the excitation of an input
SHORTEST_TRIM_S = 0.25  # shortest interval before the excitation that counts as trim [s]
_SAME_HARMONIC = 1e-6  # distance from a harmonic, in units of the fundamental frequency
_SMOOTHING = 1e-3  # of a signal, by an instrument that not only delays
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


def find_assigned_inputs(maneuver: Maneuver, frequency_hz: np.ndarray) -> tuple[str, ...]:
    """Find the input that excites each frequency (M,), empty where none does. [Hz]"""
    excitation = maneuver.excitation
    if excitation is None:
        return ("",) * frequency_hz.size
    assigned = {n: name for name, own in excitation.harmonics.items() for n in own}
    order = frequency_hz * excitation.period_s
    return tuple(
        assigned.get(round(n), "") if abs(n - round(n)) < _SAME_HARMONIC else "" for n in order
    )


def select_frequencies(
    maneuver: Maneuver,
    band_hz: tuple[float, float] | None = None,
    duration_s: float | None = None,
) -> SpectrumFrequencies:
    """Select the excited harmonics, or all multiples of 1/duration where none are known.

    The duration is that of the maneuver by default. [s]

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
        duration_s = maneuver.duration_s if duration_s is None else duration_s
        first = max(1, int(np.ceil(band_hz[0] * duration_s - 1e-9)))
        last = int(np.floor(band_hz[1] * duration_s + 1e-9))
        omega = compute_harmonic_frequencies(np.arange(first, last + 1), duration_s)
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
    """All active corrections of one channel, and what it is between its samples if known."""

    delay_s: float = 0.0
    scale: float = 1.0
    bias: float = 0.0
    stretches: tuple[tuple[int, int], ...] = ()
    between: BetweenSamples | None = None

    def add(self, one: Correction) -> Conditioning:
        """Return all corrections with a further one."""
        match one.kind:
            case StepKind.DELAY:
                return replace(self, delay_s=self.delay_s + one.delay_s)
            case StepKind.CALIBRATION:
                bias = self.bias + self.scale * one.bias
                return replace(self, scale=self.scale * one.scale, bias=bias)
            case StepKind.REPAIR:
                return replace(self, stretches=(*self.stretches, *one.stretches))
            case StepKind.INTERPOLATION:
                return replace(self, between=one.between_samples)

    def correct(self, values: np.ndarray, rate_hz: float) -> np.ndarray:
        """Fill between samples, repair and calibrate; the delay is applied to the spectra."""
        if self.between is not None:
            values = fill_between(values, self.between)
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
    active corrections by channel. With ``window_s``, the common window of the motion, channels are
    integrated over it and nothing is assumed of the motion outside; ``lags_s`` are the times by
    which instruments record later.
    """

    maneuver: Maneuver
    channels: tuple[tuple[Channel, np.ndarray], ...]
    parts: dict[str, tuple[tuple[str, float], ...]]
    attitudes: frozenset[str]
    conditioning: dict[str, Conditioning]
    window_s: tuple[float, float] | None = None
    lags_s: Mapping[str, float] = field(default_factory=dict[str, float])

    def with_common_window(self, lags_s: Mapping[str, float]) -> Recording:
        """Return the recording with the window of the motion that every channel covers.

        Raises
        ------
        BadInput
            If there is none.
        """
        recording = replace(self, lags_s=lags_s)
        late = [(channel, recording.get_lag(channel.name)) for channel, _ in self.channels]
        start_s = max(channel.start_s - lag for channel, lag in late)
        last_s = min(channel.get_time(channel.n_samples - 1) - lag for channel, lag in late)
        if not last_s > start_s:
            raise BadInput(
                "the channels of this maneuver have no time in common; exclude some of them",
                code="no-common-time",
            )
        return replace(recording, window_s=(start_s, last_s))

    def compute_duration_s(self) -> float:
        """Return the duration of the common window. [s]"""
        assert self.window_s is not None
        return self.window_s[1] - self.window_s[0]

    def get_lag(self, name: str) -> float:
        """Return the time by which a channel records later, by correction and instrument. [s]"""
        corrected = self.conditioning.get(name)
        return self.lags_s.get(name, 0.0) + (0.0 if corrected is None else corrected.delay_s)

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
        omega = frequencies.omega
        needed = {part for name in names for part, _ in self.parts[name]}
        by_clock: dict[
            tuple[float, float, int, float, BetweenSamples | None], dict[str, np.ndarray]
        ] = {}
        for channel, samples in self.channels:
            if channel.name in needed:
                values = self._convert_to_si(channel, samples)
                lag_s = 0.0 if self.window_s is None else self.get_lag(channel.name)
                between = self.conditioning.get(channel.name, Conditioning()).between
                by_clock.setdefault((*channel.clock, lag_s, between), {})[channel.name] = values
        spectra: dict[str, np.ndarray] = {}
        for (rate_hz, start_s, _, lag_s, between), group in by_clock.items():
            samples = np.stack(list(group.values()), axis=1)
            if self.window_s is None:
                is_attitude = np.array([name in self.attitudes for name in group])
                transform = _transform(samples, rate_hz, start_s, self.maneuver, omega, is_attitude)
                transform *= respond_between(omega / rate_hz, between)[:, None]
            else:
                begin_s, last_s = self.window_s
                window = begin_s + lag_s, last_s + lag_s
                moved = remove_trim(samples, rate_hz, start_s, self.maneuver)
                if between in (BetweenSamples.HELD, BetweenSamples.LINEAR):
                    linear = between is BetweenSamples.LINEAR
                    transform = integrate_steps(
                        moved, rate_hz, omega, start_s, window, linear=linear
                    )
                else:
                    transform = integrate_between(moved, rate_hz, omega, start_s, window)
            spectra.update(zip(group, transform.T, strict=True))
        for name, one in self.conditioning.items():
            if one.delay_s and name in spectra:
                spectra[name] = spectra[name] * np.exp(1j * omega * one.delay_s)
        columns = [sum(w * spectra[part] for part, w in self.parts[name]) for name in names]
        values = np.reshape(np.array(columns, dtype=complex), (len(names), omega.size)).T
        return FrequencyData(omega, values, names)

    def has_steps(self, inputs: Iterable[str]) -> bool:
        """Whether inputs are held, of a record that is integrated over a window."""
        parts = [part for name in inputs for part, _ in self.parts[name]]
        return self.window_s is not None and any(self._is_held(part) for part in parts)

    def compute_step_errors(
        self, inputs: tuple[str, ...], outputs: tuple[str, ...], omega: np.ndarray
    ) -> np.ndarray:
        """Compute what the transforms of outputs lack while held inputs step.

        Returns
        -------
        array
            Transforms of each input and its integrals less those of their samples at the times of
            each output, of the true motion, (n_terms, n_omega, n_y, n_u). [rad s^(n + 1)]
        """
        assert self.window_s is not None
        window_s, channels = self.window_s, {c.name: (c, x) for c, x in self.channels}
        errors = np.zeros((N_TERMS, omega.size, len(outputs), len(inputs)), dtype=complex)
        for column, name in enumerate(inputs):
            for part, weight in self.parts[name]:
                if not self._is_held(part):
                    continue
                channel, samples = channels[part]
                moved = self._convert_to_si(channel, samples)
                moved = weight * (moved - moved[0])
                clock = channel.rate_hz, channel.start_s - self.get_lag(part)
                whole = integrate_steps(moved[:, None], clock[0], omega, clock[1], window_s)
                ends = integrate_held(moved, *clock, np.array(window_s))
                exact = np.stack(list(transform_integrals(whole[:, 0], omega, window_s, ends)))
                for row, output in enumerate(outputs):
                    sensor, recorded = channels[self.parts[output][0][0]]
                    start_s = sensor.start_s - self.get_lag(sensor.name)
                    time_s = start_s + np.arange(len(recorded)) / sensor.rate_hz
                    seen = integrate_held(moved, *clock, time_s).T
                    sampled = integrate_between(seen, sensor.rate_hz, omega, start_s, window_s)
                    errors[:, :, row, column] += exact - sampled.T
        return errors

    def _is_held(self, name: str) -> bool:
        corrected = self.conditioning.get(name)
        return corrected is not None and corrected.between is BetweenSamples.HELD

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
    omega: np.ndarray,
    is_attitude: np.ndarray,
) -> np.ndarray:
    """Transform a record of one period, or the periods after the first of several."""
    excitation = maneuver.excitation
    samples = remove_trim(samples, rate_hz, start_s, maneuver)
    if excitation is not None and excitation.n_periods > 1:
        period = excitation.period_s
        first = round((excitation.start_s + period - start_s) * rate_hz)
        last = first + round(maneuver.transformed_s * rate_hz)
        if last <= samples.shape[0] + 1:
            first_s = start_s + first / rate_hz
            return finite_fourier_transform(samples[first:last], rate_hz, omega, first_s)
    # A multisine starts and ends at trim; other records start and end in motion.
    return transform_with_levels(
        samples, rate_hz, omega, start_s, is_attitude, integrated=excitation is None
    )


def remove_trim(
    samples: np.ndarray, rate_hz: float, start_s: float, maneuver: Maneuver
) -> np.ndarray:
    """Remove the mean before the excitation, or of the record where that is too short."""
    excitation = maneuver.excitation
    begin = maneuver.start_s if excitation is None else excitation.start_s
    trim = round((begin - start_s) * rate_hz)
    # Relative to the first sample, so that a constant channel is exactly zero.
    moved = samples - samples[:1]
    steady = moved[:trim] if trim >= SHORTEST_TRIM_S * rate_hz else moved
    return moved - steady.mean(axis=0)


@dataclass(frozen=True, slots=True)
class ManeuverMeasurement:
    """Samples of a maneuver and the settings of their transform to ``MeasuredSpectra``.

    ``frequencies`` are the frequencies assigned to the inputs, ``excited`` are the same frequencies
    assigned to all excited inputs.
    """

    recording: Recording
    aircraft: Aircraft
    inputs: tuple[str, ...]
    outputs: tuple[OutputDefinition, ...]
    frequencies: SpectrumFrequencies
    excited: SpectrumFrequencies
    has_commands: bool

    @property
    def max_omega(self) -> float:
        """Highest frequency. [rad/s]"""
        return float(self.frequencies.omega[-1])

    def with_corrections(self, corrections: Iterable[Correction]) -> ManeuverMeasurement:
        """Return the measurement with further corrections of its channels."""
        recording = self.recording
        conditioning = dict(recording.conditioning)
        for one in corrections:
            conditioning[one.channel] = conditioning.get(one.channel, Conditioning()).add(one)
        recording = replace(recording, conditioning=conditioning)
        if recording.window_s is None:
            return replace(self, recording=recording)
        corrected = recording.with_common_window(recording.lags_s)
        # Frequencies remain multiples of 1/T of the window.
        ratio = recording.compute_duration_s() / corrected.compute_duration_s()
        frequencies, excited = (
            replace(one, omega=ratio * one.omega) for one in (self.frequencies, self.excited)
        )
        return replace(self, recording=corrected, frequencies=frequencies, excited=excited)

    def transform(self) -> MeasuredSpectra:
        """Transform inputs, outputs and recorded excitation."""
        inputs, every, frequencies = self.inputs, self.excited.inputs, self.frequencies
        omega, aircraft = frequencies.omega, self.aircraft
        recorded = self.recording.spectra(every, frequencies)
        factors = compute_input_corrections(aircraft, every, omega)
        deflections = FrequencyData(omega, recorded.values * factors, every)
        shape = (len(self.outputs), omega.size)
        responses = [get_output_instrument(aircraft, o).response(omega) for o in self.outputs]
        channels = {c.name: c for c, _ in self.recording.channels}
        slowest = min(channel.rate_hz for channel in channels.values())
        sources = [channels[self.recording.parts[name][0][0]] for name in inputs]
        duration_s = max(channel.n_samples / channel.rate_hz for channel in sources)
        window_s = self.recording.window_s
        if window_s is not None:
            duration_s = self.recording.compute_duration_s()
        first = [o.terms[0][0].name for o in self.outputs]
        output_rates = np.array([channels[n].rate_hz if n in channels else slowest for n in first])
        levels = {s.name: s.noise_std_rad for s in aircraft.surfaces}
        noise = None
        if all(levels.get(name) is not None for name in inputs):
            # The transform of white samples has variance sigma^2 T / rate.
            variance = [
                (levels[name] or 0.0) ** 2 * duration_s / channel.rate_hz
                for name, channel in zip(inputs, sources, strict=True)
            ]
            noise = np.array(variance) * np.abs(factors[:, : len(inputs)]) ** 2
        commands = None
        if self.has_commands:
            data = self.recording.spectra(list_command_names(every), frequencies)
            commands = FrequencyData(omega, data.values, every)
        return MeasuredSpectra(
            assigned_input=frequencies.assigned_input,
            inputs=deflections.pick(inputs),
            excited=ExcitationData(deflections, commands, self.excited.assigned_input),
            outputs=self.recording.spectra(tuple(o.name for o in self.outputs), frequencies),
            instruments=np.reshape(np.array(responses, dtype=complex), shape).T,
            commands=None if commands is None else commands.pick(inputs),
            input_noise=noise,
            output_noise=compute_spectral_noise(self.outputs, output_rates, duration_s),
            resolution_overlap=compute_resolution_overlap(omega, duration_s),
            record_ends_s=self._find_record_ends(),
            window_s=self._find_window() if window_s is None else window_s,
            free_ends=window_s is not None,
        )

    @property
    def has_steps(self) -> bool:
        """Whether outputs were sampled while inputs moved in steps."""
        return self.recording.has_steps(self.inputs)

    def compute_step_errors(self, system: StateSpace, measured: MeasuredSpectra) -> np.ndarray:
        """Compute what the transforms of the outputs lack while inputs step, by a model.

        An instrument that does more than delay smooths the steps: its output lacks nothing.

        Returns
        -------
        array
            To be added to the outputs as recorded, (n_omega, n_y). [output unit * s]
        """
        names = tuple(output.name for output in self.outputs)
        errors = self.recording.compute_step_errors(self.inputs, names, measured.omega)
        only_delays = np.abs(np.abs(measured.instruments) - 1.0).max(axis=0) < _SMOOTHING
        return sum_step_errors(system, errors) * measured.instruments * only_delays

    def _find_window(self) -> tuple[float, float] | None:
        """Return begin and end of the transformed outputs; None for whole periods."""
        excitation = self.recording.maneuver.excitation
        if excitation is not None and excitation.n_periods > 1:
            return None
        names = {part for one in self.outputs for part, _ in self.recording.parts[one.name]}
        recorded = [c for c, _ in self.recording.channels if c.name in names]
        if not recorded:
            return None
        longest = max(recorded, key=lambda c: c.n_samples / c.rate_hz)
        return longest.start_s, longest.stop_s

    def _find_record_ends(self) -> tuple[float, ...]:
        """Return the times at which the record may begin or end in motion.

        Whole periods have none; a multisine begins at trim. At multiples of 1/T of a window the
        states at both ends have equal phases: the one at the end stands for their difference.
        """
        if self.recording.window_s is not None:
            return self.recording.window_s[1:]
        excitation = self.recording.maneuver.excitation
        sources = {part for name in self.inputs for part, _ in self.recording.parts[name]}
        recorded = [c for c, _ in self.recording.channels if c.name in sources]
        end_s = max(c.stop_s for c in recorded)
        if excitation is None:
            return min(c.start_s for c in recorded), end_s
        return () if excitation.n_periods > 1 else (end_s,)


def compute_spectral_noise(
    outputs: tuple[OutputDefinition, ...], rate_hz: float | np.ndarray, duration_s: float
) -> np.ndarray:
    """Compute the standard deviation of outputs' spectra due to sensor noise.

    NaN where the aircraft record has no noise of a sensor. [output unit * s]

    Notes
    -----
    The transform of white samples of variance sigma^2 has variance sigma^2 T / rate.
    """
    variance = [
        sum((weight * (sensor.noise_std or np.nan)) ** 2 for sensor, weight in output.terms)
        for output in outputs
    ]
    return np.sqrt(np.array(variance, dtype=float) * duration_s / rate_hz)


def list_command_names(inputs: Sequence[str]) -> tuple[str, ...]:
    """Return the names of the channels with the recorded excitation of inputs."""
    return tuple(name + COMMAND_SUFFIX for name in inputs)


def list_excitation_names(inputs: Iterable[str], recorded: Container[str]) -> list[str]:
    """Return the channel with the excitation of each input: its command, else the input."""
    return [n + COMMAND_SUFFIX if n + COMMAND_SUFFIX in recorded else n for n in inputs]
