"""Data and model of a maneuver in a fit, and its output error and frequency-response error."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from jaxtyping import Complex

from flexsid.sysid.estimation.experiment import Experiment
from flexsid.sysid.estimation.flight_noise import (
    AssignedCommands,
    estimate_joint_noise,
    has_input_noise,
)
from flexsid.sysid.estimation.frequency_response_error import frequency_response_error
from flexsid.sysid.estimation.noise import NoiseSpectrum
from flexsid.sysid.estimation.output_error import output_error
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.signals import FrequencyData
from flexsid.sysid.spectra.measured_spectra import MeasuredSpectra


@dataclass(frozen=True, slots=True, kw_only=True)
class ManeuverModel:
    """A maneuver and the models of its condition.

    ``extended_model`` has the out-of-band modes that the sensors also measure;
    equation error reconstructs them too, so that their static response does not
    bias the motion of the modes it estimates. ``pairs`` are the inputs of the other axis with the
    same surfaces, by input. ``wrong_models`` are the model with one assumed quantity larger by its
    standard deviation, by cause.
    """

    label: str
    model: AeroelasticModel
    extended_model: AeroelasticModel
    pairs: Mapping[str, str] = field(default_factory=dict[str, str])
    wrong_models: Mapping[str, AeroelasticModel] = field(
        default_factory=dict[str, AeroelasticModel]
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class ManeuverData(ManeuverModel):
    """Data and model of one maneuver in a fit.

    ``opposed`` is the other axis of a combined maneuver, for tests of symmetry.
    """

    measured: MeasuredSpectra
    opposed: ManeuverData | None = None

    def subtract_outputs(self, outputs: Complex[np.ndarray, "n_omega n_y"]) -> ManeuverData:
        """Return the data without a known motion of the outputs; the rest ends at rest."""
        spectra = self.measured
        rest = replace(spectra.outputs, values=spectra.outputs.values - outputs)
        return replace(
            self, measured=replace(spectra, outputs=rest, free_ends=False, record_ends_s=())
        )

    def add_to_outputs(self, outputs: Complex[np.ndarray, "n_omega n_y"]) -> ManeuverData:
        """Return the data with spectra added to those of the outputs."""
        spectra = self.measured
        added = replace(spectra.outputs, values=spectra.outputs.values + outputs)
        return replace(self, measured=replace(spectra, outputs=added))

    def replace_spectra(self, experiment: Experiment) -> ManeuverData:
        """Return the data with the inputs and outputs of an output error of them."""
        spectra, model = self.measured, experiment.model
        inputs = FrequencyData(spectra.omega, experiment.inputs, model.inputs)
        outputs = FrequencyData(spectra.omega, experiment.measured, model.outputs)
        excited = spectra.excited
        measured = replace(
            spectra,
            inputs=_replace_values(spectra.inputs, inputs),
            outputs=_replace_values(spectra.outputs, outputs),
            excited=replace(excited, inputs=_replace_values(excited.inputs, inputs)),
        )
        return replace(self, measured=measured)

    def assign_commands(self) -> AssignedCommands | None:
        """Return the command of every harmonic; None where some are not recorded."""
        excited = self.measured.excited
        if excited.commands is None or (excited.assigned_input < 0).any():
            return None
        own = np.take_along_axis(excited.commands.values, excited.assigned_input[:, None], axis=1)
        return AssignedCommands(excited.assigned_input, own[:, 0])


def build_output_error(data: ManeuverData, name: str = "OE") -> Experiment:
    """Build the output error of a maneuver."""
    spectra = data.measured
    return output_error(
        data.model,
        spectra.inputs,
        spectra.outputs,
        spectra.instruments,
        name,
        spectra.record_ends_s,
        spectra.window_s,
        free_ends=spectra.free_ends,
    )


def build_frequency_response_error(data: ManeuverData, name: str = "FRE") -> Experiment:
    """Build the frequency-response error of a maneuver, instruments removed.

    Raises
    ------
    BadInput
        If the assignment of harmonics to inputs is not known.
    """
    spectra = data.measured
    source = output_error(
        data.model,
        spectra.inputs,
        spectra.true_outputs(),
        np.ones_like(spectra.instruments),
        name,
        window_s=spectra.window_s,
    )
    return frequency_response_error(data.model, spectra.responses, name, source)


def estimate_maneuver_noise(
    maneuvers: Sequence[ManeuverData], experiments: Sequence[Experiment]
) -> list[NoiseSpectrum] | None:
    """Estimate the joint noise spectrum of outputs and inputs of each maneuver.

    Parameters
    ----------
    maneuvers
        Data with the recorded commands.
    experiments
        Output error of the maneuvers.

    Returns
    -------
    list of NoiseSpectrum or None
        None where commands are not recorded, or the inputs have too little noise for an effect.
    """
    commands = [data.assign_commands() for data in maneuvers]
    known = [own for own in commands if own is not None]
    is_fine = any(data.measured.resolution_overlap > 1.0 for data in maneuvers)
    if len(known) < len(commands) or is_fine:
        return None
    pairs = list(zip(experiments, known, strict=True))
    if not any(has_input_noise(one.inputs, own) for one, own in pairs):
        return None
    joint = [
        estimate_joint_noise(one.omega, np.concatenate([one.measured, one.inputs], axis=1), own)
        for one, own in pairs
    ]
    noise = [own for own in joint if own is not None]
    return noise if len(noise) == len(joint) else None


def _replace_values(data: FrequencyData, new: FrequencyData) -> FrequencyData:
    """Replace the values of the signals that are in both."""
    values = data.values.copy()
    for number, name in enumerate(data.names):
        if name in new.names:
            values[:, number] = new.values[:, new.names.index(name)]
    return FrequencyData(data.omega, values, data.names)
