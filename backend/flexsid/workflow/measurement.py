"""Measurement: what every analysis of a maneuver starts from, without a database."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.aircraft import Aircraft
from flexsid.sysid.signals import FrequencyData, FrequencyResponse
from flexsid.sysid.spectra.response import bare_airframe_responses
from flexsid.workflow.models import OutputDefinition, input_correction, output_instrument
from flexsid.workflow.recording import Lines, Recording


@dataclass(frozen=True, slots=True)
class MeasuredLines:
    """Spectra at the lines of a maneuver.

    ``inputs`` are true deflections; ``outputs`` are as recorded, ``instruments``
    (n_omega, n_y) lies between. ``owner`` is the input that owns each line, -1 for
    none. ``input_noise`` (n_omega, n_u) is the variance of the inputs' spectra where
    their sensors' noise is known. ``crowding`` is how many lines share the resolution
    of the record, at least one. ``edges_s`` are the times at which the record may begin
    or end in motion.
    """

    owner: np.ndarray
    inputs: FrequencyData
    outputs: FrequencyData
    instruments: np.ndarray
    commands: FrequencyData | None
    input_noise: np.ndarray | None
    crowding: float
    edges_s: tuple[float, ...] = ()

    @property
    def omega(self) -> np.ndarray:
        """Frequencies of the lines. [rad/s]"""
        return self.outputs.omega

    def true_outputs(self) -> FrequencyData:
        """Output spectra with the instruments taken out."""
        return FrequencyData(self.omega, self.outputs.values / self.instruments, self.outputs.names)

    def responses(self) -> dict[str, FrequencyResponse]:
        """Bare-airframe responses of every input at its own lines.

        Raises
        ------
        BadInput
            If it is not known which input owns which line.
        """
        if (self.owner >= 0).any() and (self.owner < 0).any():
            raise BadInput(
                f"some lines belong to none of {', '.join(self.inputs.names)}: frequency "
                "responses need every input that was excited; add the others, or leave out "
                "their band",
                code="inputs-left-out",
            )
        if (self.owner < 0).any():
            raise BadInput(
                "frequency responses need to know which harmonics each input was given; import "
                "the maneuver with its [excitation], or use OE or EE",
                code="no-excitation",
            )
        commands = self.inputs if self.commands is None else self.commands
        return bare_airframe_responses(self.inputs, self.true_outputs(), commands, self.owner)


@dataclass(frozen=True, slots=True)
class Measurement:
    """What ``MeasuredLines`` are made of: samples as read, and how to transform them."""

    recording: Recording
    aircraft: Aircraft
    inputs: tuple[str, ...]
    outputs: tuple[OutputDefinition, ...]
    lines: Lines
    has_commands: bool

    @property
    def highest(self) -> float:
        """Highest line. [rad/s]"""
        return float(self.lines.omega[-1])

    def measured(self) -> MeasuredLines:
        """Transform inputs, outputs and recorded excitation; needs no database."""
        inputs, lines = self.inputs, self.lines
        recorded = self.recording.spectra(inputs, lines)
        factors = np.stack(
            [input_correction(self.aircraft, n, lines.omega) for n in inputs], axis=1
        )
        shape = (len(self.outputs), lines.omega.size)
        responses = [
            output_instrument(self.aircraft, o).response(lines.omega) for o in self.outputs
        ]
        clocks = {c.name: (c.n_samples, c.rate_hz) for c, _ in self.recording.channels}
        duration_s = max(clocks[n][0] / clocks[n][1] for n in inputs)
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
            noise = density * np.abs(factors) ** 2
        commands = None
        if self.has_commands:
            data = self.recording.spectra(command_names(inputs), lines)
            commands = FrequencyData(lines.omega, data.values, inputs)
        return MeasuredLines(
            owner=lines.owner,
            inputs=FrequencyData(lines.omega, recorded.values * factors, inputs),
            outputs=self.recording.spectra(tuple(o.name for o in self.outputs), lines),
            instruments=np.reshape(np.array(responses, dtype=complex), shape).T,
            commands=commands,
            input_noise=noise,
            crowding=_crowding(lines.omega, duration_s),
            edges_s=self._edges(),
        )

    def _edges(self) -> tuple[float, ...]:
        """Begin and end of the record; whole periods have neither, a multisine begins at trim."""
        excitation = self.recording.maneuver.excitation
        recorded = [c for c, _ in self.recording.channels if c.name in self.inputs]
        end_s = max(c.start_s + c.n_samples / c.rate_hz for c in recorded)
        if excitation is None:
            return min(c.start_s for c in recorded), end_s
        return () if excitation.n_periods > 1 else (end_s,)


def command_names(inputs: tuple[str, ...]) -> tuple[str, ...]:
    """Names of the channels that hold the recorded excitation of inputs."""
    return tuple(f"{name}_command" for name in inputs)


def _crowding(omega: np.ndarray, duration_s: float) -> float:
    if omega.size < 2:
        return 1.0
    spacing_hz = float(np.median(np.diff(np.unique(omega)))) / (2.0 * np.pi)
    return max(1.0, 1.0 / (spacing_hz * duration_s))
