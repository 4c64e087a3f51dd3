"""Samples and spectra of a maneuver for an analysis, without a database."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.aircraft import Aircraft
from flexsid.sysid.signals import FrequencyData, FrequencyResponse
from flexsid.sysid.spectra.response import estimate_bare_airframe_responses
from flexsid.workflow.aircraft.aircraft_models import (
    OutputDefinition,
    compute_input_correction,
    get_output_instrument,
)
from flexsid.workflow.measurements.recording import Recording, SpectrumFrequencies


@dataclass(frozen=True, slots=True)
class ExcitationData:
    """Spectra of all excited inputs, inputs of the model or not.

    ``assigned_input`` is the index of the input that each harmonic is assigned to, -1 for none.
    """

    inputs: FrequencyData
    commands: FrequencyData | None
    assigned_input: np.ndarray


@dataclass(frozen=True, slots=True)
class MeasuredSpectra:
    """Spectra at the frequencies of a maneuver.

    ``inputs`` are true deflections; ``outputs`` are as recorded and contain the instrument
    responses ``instruments`` (n_omega, n_y). ``assigned_input`` is the index of the input that
    each harmonic is assigned to, -1 for none; ``excited`` has all excited inputs.
    ``input_noise`` (n_omega, n_u) is the variance of the inputs' spectra where the noise of
    their sensors is known; ``output_noise`` (n_y) is the standard deviation of the outputs'
    spectra, NaN where the noise of their sensors is not known. ``resolution_overlap`` is the
    number of frequencies per resolution 1/T of the record, at least one. ``record_ends_s`` are
    the times at which the record may begin or end in motion, ``window_s`` the limits of the
    transformed interval.
    """

    assigned_input: np.ndarray
    inputs: FrequencyData
    excited: ExcitationData
    outputs: FrequencyData
    instruments: np.ndarray
    commands: FrequencyData | None
    input_noise: np.ndarray | None
    output_noise: np.ndarray
    resolution_overlap: float
    record_ends_s: tuple[float, ...] = ()
    window_s: tuple[float, float] | None = None

    @property
    def omega(self) -> np.ndarray:
        """Frequencies of the spectra. [rad/s]"""
        return self.outputs.omega

    def true_outputs(self) -> FrequencyData:
        """Return the output spectra with the instrument responses removed."""
        return FrequencyData(self.omega, self.outputs.values / self.instruments, self.outputs.names)

    def responses(self) -> dict[str, FrequencyResponse]:
        """Estimate bare-airframe responses of every input at its harmonics.

        Excited inputs that are no inputs of the model are included to remove their motion.

        Raises
        ------
        BadInput
            If the assignment of harmonics to inputs is not known.
        """
        excited = self.excited
        names = excited.inputs.names
        if (excited.assigned_input >= 0).any() and (excited.assigned_input < 0).any():
            raise BadInput(
                f"some harmonics are assigned to none of {', '.join(names)}: frequency responses "
                "need the deflection of every excited input; import the other inputs, or exclude "
                "their band",
                code="inputs-excluded",
            )
        if (excited.assigned_input < 0).any():
            raise BadInput(
                "frequency responses need the harmonics assigned to each input; import "
                "the maneuver with its [excitation], or use OE or EE",
                code="no-excitation",
            )
        commands = excited.inputs if excited.commands is None else excited.commands
        found = estimate_bare_airframe_responses(
            excited.inputs, self.true_outputs(), commands, excited.assigned_input
        )
        return {name: found[name] for name in self.inputs.names}


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

    def transform(self) -> MeasuredSpectra:
        """Transform inputs, outputs and recorded excitation."""
        inputs, every, frequencies = self.inputs, self.excited.inputs, self.frequencies
        recorded = self.recording.spectra(every, frequencies)
        factors = np.stack(
            [compute_input_correction(self.aircraft, n, frequencies.omega) for n in every], axis=1
        )
        deflections = FrequencyData(frequencies.omega, recorded.values * factors, every)
        shape = (len(self.outputs), frequencies.omega.size)
        responses = [
            get_output_instrument(self.aircraft, o).response(frequencies.omega)
            for o in self.outputs
        ]
        clocks = {c.name: (c.n_samples, c.rate_hz) for c, _ in self.recording.channels}
        duration_s = max(clocks[n][0] / clocks[n][1] for n in inputs)
        slowest = min(rate for _, rate in clocks.values())
        rates = np.array(
            [clocks.get(o.terms[0][0].name, (0, slowest))[1] for o in self.outputs], dtype=float
        )
        known = {s.name: s.noise_std_rad for s in self.aircraft.surfaces}
        levels = [known.get(name) for name in inputs]
        noise = None
        if all(level is not None for level in levels):
            # The transform of white samples has variance sigma^2 T / rate.
            density = np.array(
                [
                    float(lv or 0.0) ** 2 * duration_s / clocks[n][1]
                    for lv, n in zip(levels, inputs, strict=True)
                ]
            )
            noise = density * np.abs(factors[:, : len(inputs)]) ** 2
        commands = None
        if self.has_commands:
            data = self.recording.spectra(list_command_names(every), frequencies)
            commands = FrequencyData(frequencies.omega, data.values, every)
        return MeasuredSpectra(
            assigned_input=frequencies.assigned_input,
            inputs=deflections.pick(inputs),
            excited=ExcitationData(deflections, commands, self.excited.assigned_input),
            outputs=self.recording.spectra(tuple(o.name for o in self.outputs), frequencies),
            instruments=np.reshape(np.array(responses, dtype=complex), shape).T,
            commands=None if commands is None else commands.pick(inputs),
            input_noise=noise,
            output_noise=compute_spectral_noise(self.outputs, rates, duration_s),
            resolution_overlap=_compute_resolution_overlap(frequencies.omega, duration_s),
            record_ends_s=self._find_record_ends(),
            window_s=self._find_window(),
        )

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
        return longest.start_s, longest.start_s + longest.n_samples / longest.rate_hz

    def _find_record_ends(self) -> tuple[float, ...]:
        """Return the times at which the record may begin or end in motion.

        Whole periods have none; a multisine begins at trim.
        """
        excitation = self.recording.maneuver.excitation
        recorded = [c for c, _ in self.recording.channels if c.name in self.inputs]
        end_s = max(c.start_s + c.n_samples / c.rate_hz for c in recorded)
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


def list_command_names(inputs: tuple[str, ...]) -> tuple[str, ...]:
    """Return the names of the channels with the recorded excitation of inputs."""
    return tuple(f"{name}_command" for name in inputs)


def _compute_resolution_overlap(omega: np.ndarray, duration_s: float) -> float:
    if omega.size < 2:
        return 1.0
    spacing_hz = float(np.median(np.diff(np.unique(omega)))) / (2.0 * np.pi)
    return max(1.0, 1.0 / (spacing_hz * duration_s))
