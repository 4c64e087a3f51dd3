"""Prediction of the measured outputs of a maneuver by the identified model of a run."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.maneuver import Maneuver
from flexsid.records.model_structure import Structure
from flexsid.records.run import EstimationRun, Method, Start
from flexsid.records.validation import PredictedOutput
from flexsid.storage.store import Store
from flexsid.sysid.estimation.diagnostics import compute_output_fit
from flexsid.sysid.estimation.estimate import FittedSpectra
from flexsid.sysid.estimation.experiment import Experiment
from flexsid.sysid.estimation.parameters import Parameters
from flexsid.sysid.estimation.validation import predict_outputs
from flexsid.workflow.aircraft.aircraft_models import define_outputs
from flexsid.workflow.fits.estimation_task import EstimationTask, select_free_parameters
from flexsid.workflow.fits.experiments import build_experiments
from flexsid.workflow.model_structures.model_structures import resolve_structure
from flexsid.workflow.model_structures.run_results import get_result
from flexsid.workflow.runs.default_band import set_default_band
from flexsid.workflow.runs.estimation import prepare, select_inputs_and_outputs
from flexsid.workflow.runs.identified_models import collect_values


@dataclass(frozen=True, slots=True)
class PredictedManeuver:
    """Measured and predicted outputs of a maneuver, with the measured inputs (n_omega, n_u)."""

    spectra: FittedSpectra
    inputs: np.ndarray
    input_names: tuple[str, ...]


def predict_maneuver(store: Store, run: EstimationRun, maneuver_id: int) -> PredictedManeuver:
    """Predict the outputs of a maneuver in the band of a run, from the measured inputs.

    The model has the derivatives, delays and retained modes of the run, at the condition of the
    maneuver. Outputs that the maneuver does not have are omitted.

    Raises
    ------
    BadInput
        If the maneuver is of another aircraft, lacks an input of the model, or has none of its
        outputs or no frequency in the band.
    Conflict
        If the run has no result.
    """
    task = prepare(store, set_default_band(store, _move_run(store, run, maneuver_id)))
    (experiment,) = build_output_experiments(task)
    parameters = build_identified_parameters(task, collect_values(run))
    spectra = predict_outputs(experiment, parameters, parameters.start)
    return PredictedManeuver(spectra, experiment.inputs, experiment.model.inputs)


def build_output_experiments(task: EstimationTask) -> list[Experiment]:
    """Build the output-error experiments of a task of any method."""
    return build_experiments(task, Method.OE)


def build_identified_parameters(task: EstimationTask, values: dict[str, float]) -> Parameters:
    """Build the free parameters of a task that start at the values of a run.

    Derivatives that are not free are held at these values, too.
    """
    parameters = select_free_parameters(task, task.model.fill_table(values), task.extras)
    pairs = zip(parameters.names, parameters.start.tolist(), strict=True)
    return replace(parameters, start=np.array([values.get(name, start) for name, start in pairs]))


def measure_outputs(spectra: FittedSpectra) -> tuple[PredictedOutput, ...]:
    """Compute R2 and Theil's inequality coefficient of every output."""
    return tuple(
        PredictedOutput(output=one.output, r_squared=one.r_squared, theil=one.theil)
        for one in compute_output_fit(spectra)
    )


def hold_values(run: EstimationRun) -> Structure:
    """Return the model structure of a run with all that is not free fixed at its values.

    Predictions and earlier runs that it was fixed to are then not needed. Runs of earlier
    releases did not store these values.
    """
    result = get_result(run)
    if not result.held:
        return run.structure
    return replace(run.structure, fixed=result.held, fixed_to={}, absent=())


def _move_run(store: Store, run: EstimationRun, maneuver_id: int) -> EstimationRun:
    """Return the run at another maneuver, with all that is not free at its values."""
    own, maneuver = store.maneuvers.get(run.maneuver_id), store.maneuvers.get(maneuver_id)
    if maneuver.aircraft_id != own.aircraft_id:
        raise BadInput(
            f"maneuver {maneuver_id} belongs to another aircraft than run {run.id}",
            code="wrong-aircraft",
        )
    aircraft = store.aircraft.get(own.aircraft_id)
    structure, aircraft = resolve_structure(store, hold_values(run), aircraft, own)
    inputs, definitions = select_inputs_and_outputs(store, own, aircraft, structure)
    recorded = _list_recorded(store, maneuver)
    outputs = tuple(
        one.name
        for one in define_outputs(aircraft, [definition.name for definition in definitions])
        if one.name in recorded or all(sensor.name in recorded for sensor, _ in one.terms)
    )
    if not outputs:
        raise BadInput(
            f"maneuver {maneuver_id} has no output of run {run.id}", code="unknown-output"
        )
    missing = "|".join(re.escape(one.name) for one in definitions if one.name not in outputs)
    of_missing = re.compile(rf"(?:delay|scale)_(?:{missing})|shape_(?:{missing})_\d+")
    return replace(
        run,
        maneuver_id=maneuver_id,
        structure=replace(
            structure,
            inputs=inputs,
            outputs=outputs,
            fixed_to={},
            absent=(),
            extra_parameters=tuple(
                name for name in run.structure.extra_parameters if not of_missing.fullmatch(name)
            ),
        ),
        settings=replace(
            run.settings,
            additional_maneuver_ids=(),
            start=Start.EQUATION_ERROR,
            start_run_id=None,
            priors={},
            prior_spread=None,
        ),
    )


def _list_recorded(store: Store, maneuver: Maneuver) -> set[str]:
    return {channel.name for channel in store.channels.find(maneuver_id=maneuver.id)}
