"""Experiments of output error and frequency-response error of a task, and their settings."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from flexsid.records.run import Method
from flexsid.sysid.estimation.end_states import number_ends
from flexsid.sysid.estimation.experiment import Experiment
from flexsid.sysid.estimation.frequency_response_error import frequency_response_error
from flexsid.sysid.estimation.likelihood import FitSettings
from flexsid.sysid.estimation.output_error import output_error
from flexsid.workflow.fits.estimation_task import EstimationTask


def build_experiments(task: EstimationTask, method: Method | None = None) -> list[Experiment]:
    """Build one OE or FRE experiment for each maneuver, by default of the method of the task."""
    method = task.method if method is None else method
    several = len(task.maneuvers) > 1
    result = []
    for data in task.maneuvers:
        name = data.label if several else method.value
        spectra = data.measured
        if method is Method.OE:
            result.append(
                output_error(
                    data.model,
                    spectra.inputs,
                    spectra.outputs,
                    spectra.instruments,
                    name,
                    spectra.record_ends_s,
                    spectra.window_s,
                    free_ends=spectra.free_ends,
                )
            )
        else:
            through = np.ones_like(spectra.instruments)
            source = output_error(
                data.model,
                spectra.inputs,
                spectra.true_outputs(),
                through,
                name,
                window_s=spectra.window_s,
            )
            experiment = frequency_response_error(data.model, spectra.responses(), name, source)
            if several:
                groups = tuple(f"{name} {group}" for group in experiment.group_names)
                experiment = replace(experiment, group_names=groups)
            result.append(experiment)
    return number_ends(result)


def build_fit_settings(task: EstimationTask, spread: float | None = None) -> FitSettings:
    """Build the settings of the likelihood maximisation of a task, by default with its spread."""
    settings = task.settings
    return FitSettings(
        max_iterations=settings.max_iterations,
        noise=settings.noise,
        priors=task.list_priors(task.spread if spread is None else spread),
    )
