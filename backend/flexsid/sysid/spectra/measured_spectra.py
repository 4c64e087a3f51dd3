"""Spectra of a maneuver: inputs, outputs as recorded, commands, and the noise of their sensors."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Complex, Float, Int

from flexsid.errors import BadInput
from flexsid.sysid.signals import FrequencyData, FrequencyResponse
from flexsid.sysid.spectra.response import estimate_bare_airframe_responses


@dataclass(frozen=True, slots=True)
class ExcitationData:
    """Spectra of all excited inputs, inputs of the model or not.

    ``assigned_input`` is the index of the input that each harmonic is assigned to, -1 for none.
    """

    inputs: FrequencyData
    commands: FrequencyData | None
    assigned_input: Int[np.ndarray, " n_omega"]


@dataclass(frozen=True)
class MeasuredSpectra:
    """Spectra at the frequencies of a maneuver.

    ``inputs`` are true deflections; ``outputs`` are as recorded and contain the instrument
    responses ``instruments``. ``assigned_input`` is the index of the input that
    each harmonic is assigned to, -1 for none; ``excited`` has all excited inputs.
    ``input_noise`` is the variance of the inputs' spectra where the noise of
    their sensors is known; ``output_noise`` is the standard deviation of the outputs'
    spectra, NaN where the noise of their sensors is not known. ``resolution_overlap`` is the
    number of frequencies per resolution 1/T of the record, at least one. ``record_ends_s`` are
    the times at which the record may begin or end in motion, ``window_s`` the limits of the
    transformed interval. With ``free_ends`` nothing was assumed of the motion at its ends; else
    attitudes keep their last level.
    """

    assigned_input: Int[np.ndarray, " n_omega"]
    inputs: FrequencyData
    excited: ExcitationData
    outputs: FrequencyData
    instruments: Complex[np.ndarray, "n_omega n_y"]
    commands: FrequencyData | None
    input_noise: Float[np.ndarray, "n_omega n_u"] | None
    output_noise: Float[np.ndarray, " n_y"]
    resolution_overlap: float
    record_ends_s: tuple[float, ...] = ()
    window_s: tuple[float, float] | None = None
    free_ends: bool = False

    @property
    def omega(self) -> Float[np.ndarray, " n_omega"]:
        """Frequencies of the spectra. [rad/s]"""
        return self.outputs.omega

    def select(
        self, some: Bool[np.ndarray, " n_omega"] | Int[np.ndarray, " n_some"]
    ) -> MeasuredSpectra:
        """Select some of the frequencies."""

        def pick(data: FrequencyData) -> FrequencyData:
            return FrequencyData(data.omega[some], data.values[some], data.names)

        excited, noise = self.excited, self.input_noise
        return replace(
            self,
            assigned_input=self.assigned_input[some],
            inputs=pick(self.inputs),
            excited=ExcitationData(
                pick(excited.inputs),
                None if excited.commands is None else pick(excited.commands),
                excited.assigned_input[some],
            ),
            outputs=pick(self.outputs),
            instruments=self.instruments[some],
            commands=None if self.commands is None else pick(self.commands),
            input_noise=None if noise is None else noise[some],
        )

    def true_outputs(self) -> FrequencyData:
        """Return the output spectra with the instrument responses removed."""
        return FrequencyData(self.omega, self.outputs.values / self.instruments, self.outputs.names)

    @cached_property
    def responses(self) -> dict[str, FrequencyResponse]:
        """Bare-airframe responses of every input at its harmonics, estimated once.

        Raises
        ------
        BadInput
            If the assignment of harmonics to inputs is not known.
        """
        return self.estimate_responses(self.true_outputs())

    def estimate_responses(self, outputs: FrequencyData) -> dict[str, FrequencyResponse]:
        """Estimate bare-airframe responses of outputs, instruments removed, in place of its own.

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
            excited.inputs, outputs, commands, excited.assigned_input
        )
        return {name: found[name] for name in self.inputs.names}


def compute_resolution_overlap(omega: Float[np.ndarray, " n_omega"], duration_s: float) -> float:
    """Compute the number of frequencies per resolution 1/T of a record, at least one. [1]"""
    if omega.size < 2:
        return 1.0
    spacing_hz = float(np.median(np.diff(np.unique(omega)))) / (2.0 * np.pi)
    return max(1.0, 1.0 / (spacing_hz * duration_s))
