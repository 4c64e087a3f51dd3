"""Measurement: what every analysis of a maneuver starts from, without a database."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.aircraft import Aircraft
from flexsid.sysid.signals import FrequencyData, FrequencyResponse
from flexsid.sysid.spectra.response import bare_airframe_responses
from flexsid.workflow.aircraft.aircraft_models import (
    OutputDefinition,
    input_correction,
    output_instrument,
)
from flexsid.workflow.measurements.recording import Recording, SpectrumFrequencies


@dataclass(frozen=True, slots=True)
class ExcitationData:
    """What excited a maneuver, whether a model has it for an input or not.

    ``owner`` is the input that owns each line, -1 for none of them.
    """

    inputs: FrequencyData
    commands: FrequencyData | None
    owner: np.ndarray


@dataclass(frozen=True, slots=True)
class MeasuredLines:
    """Spectra at the lines of a maneuver.

    ``inputs`` are true deflections; ``outputs`` are as recorded, ``instruments``
    (n_omega, n_y) lies between. ``owner`` is the input that owns each line, -1 for
    none; ``excited`` are the inputs and all others that were excited. ``input_noise``
    (n_omega, n_u) is the variance of the inputs' spectra where their sensors' noise is
    known; ``output_noise`` (n_y) is the standard deviation of the outputs' spectra, NaN where
    their sensors' noise is not known. ``crowding`` is how many lines share the resolution of
    the record, at least one. ``edges_s`` are the times at which the record may begin or end in
    motion, ``window_s`` those between which it was transformed.
    """

    owner: np.ndarray
    inputs: FrequencyData
    excited: ExcitationData
    outputs: FrequencyData
    instruments: np.ndarray
    commands: FrequencyData | None
    input_noise: np.ndarray | None
    output_noise: np.ndarray
    crowding: float
    edges_s: tuple[float, ...] = ()
    window_s: tuple[float, float] | None = None

    @property
    def omega(self) -> np.ndarray:
        """Frequencies of the lines. [rad/s]"""
        return self.outputs.omega

    def true_outputs(self) -> FrequencyData:
        """Output spectra with the instruments taken out."""
        return FrequencyData(self.omega, self.outputs.values / self.instruments, self.outputs.names)

    def responses(self) -> dict[str, FrequencyResponse]:
        """Bare-airframe responses of every input at its own lines.

        Other inputs that were excited take part, for their motion has to be taken out.

        Raises
        ------
        BadInput
            If it is not known which input owns which line.
        """
        excited = self.excited
        names = excited.inputs.names
        if (excited.owner >= 0).any() and (excited.owner < 0).any():
            raise BadInput(
                f"some lines belong to none of {', '.join(names)}: frequency responses need the "
                "deflection of every input that was excited; import the others as inputs, or "
                "leave out their band",
                code="inputs-left-out",
            )
        if (excited.owner < 0).any():
            raise BadInput(
                "frequency responses need to know which harmonics each input was given; import "
                "the maneuver with its [excitation], or use OE or EE",
                code="no-excitation",
            )
        commands = excited.inputs if excited.commands is None else excited.commands
        found = bare_airframe_responses(
            excited.inputs, self.true_outputs(), commands, excited.owner
        )
        return {name: found[name] for name in self.inputs.names}


@dataclass(frozen=True, slots=True)
class ManeuverMeasurement:
    """What ``MeasuredLines`` are made of: samples as read, and how to transform them.

    ``lines`` are owned by the inputs, ``excited`` are the same lines owned by the inputs and
    the others that were excited.
    """

    recording: Recording
    aircraft: Aircraft
    inputs: tuple[str, ...]
    outputs: tuple[OutputDefinition, ...]
    lines: SpectrumFrequencies
    excited: SpectrumFrequencies
    has_commands: bool

    @property
    def highest(self) -> float:
        """Highest line. [rad/s]"""
        return float(self.lines.omega[-1])

    def measured(self) -> MeasuredLines:
        """Transform inputs, outputs and recorded excitation; needs no database."""
        inputs, every, lines = self.inputs, self.excited.inputs, self.lines
        recorded = self.recording.spectra(every, lines)
        factors = np.stack([input_correction(self.aircraft, n, lines.omega) for n in every], axis=1)
        deflections = FrequencyData(lines.omega, recorded.values * factors, every)
        shape = (len(self.outputs), lines.omega.size)
        responses = [
            output_instrument(self.aircraft, o).response(lines.omega) for o in self.outputs
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
            data = self.recording.spectra(command_names(every), lines)
            commands = FrequencyData(lines.omega, data.values, every)
        return MeasuredLines(
            owner=lines.owner,
            inputs=deflections.pick(inputs),
            excited=ExcitationData(deflections, commands, self.excited.owner),
            outputs=self.recording.spectra(tuple(o.name for o in self.outputs), lines),
            instruments=np.reshape(np.array(responses, dtype=complex), shape).T,
            commands=None if commands is None else commands.pick(inputs),
            input_noise=noise,
            output_noise=spectral_noise(self.outputs, rates, duration_s),
            crowding=_crowding(lines.omega, duration_s),
            edges_s=self._edges(),
            window_s=self._window(),
        )

    def _window(self) -> tuple[float, float] | None:
        """Begin and end of the transformed outputs; None for whole periods."""
        excitation = self.recording.maneuver.excitation
        if excitation is not None and excitation.n_periods > 1:
            return None
        names = {part for one in self.outputs for part, _ in self.recording.parts[one.name]}
        recorded = [c for c, _ in self.recording.channels if c.name in names]
        if not recorded:
            return None
        longest = max(recorded, key=lambda c: c.n_samples / c.rate_hz)
        return longest.start_s, longest.start_s + longest.n_samples / longest.rate_hz

    def _edges(self) -> tuple[float, ...]:
        """Begin and end of the record; whole periods have neither, a multisine begins at trim."""
        excitation = self.recording.maneuver.excitation
        recorded = [c for c, _ in self.recording.channels if c.name in self.inputs]
        end_s = max(c.start_s + c.n_samples / c.rate_hz for c in recorded)
        if excitation is None:
            return min(c.start_s for c in recorded), end_s
        return () if excitation.n_periods > 1 else (end_s,)


def spectral_noise(
    outputs: tuple[OutputDefinition, ...], rate_hz: float | np.ndarray, duration_s: float
) -> np.ndarray:
    """Standard deviation of outputs' spectra that the noise of their sensors gives.

    NaN where the aircraft does not say how much noise a sensor has. [output unit * s]

    Notes
    -----
    The transform of white samples of variance sigma^2 has variance sigma^2 T / rate.
    """
    variance = [
        sum((weight * (sensor.noise_std or np.nan)) ** 2 for sensor, weight in output.terms)
        for output in outputs
    ]
    return np.sqrt(np.array(variance, dtype=float) * duration_s / rate_hz)


def command_names(inputs: tuple[str, ...]) -> tuple[str, ...]:
    """Names of the channels that hold the recorded excitation of inputs."""
    return tuple(f"{name}_command" for name in inputs)


def _crowding(omega: np.ndarray, duration_s: float) -> float:
    if omega.size < 2:
        return 1.0
    spacing_hz = float(np.median(np.diff(np.unique(omega)))) / (2.0 * np.pi)
    return max(1.0, 1.0 / (spacing_hz * duration_s))
