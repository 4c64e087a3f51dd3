"""Prediction of measured outputs by identified models, and its numbers."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Annotated

import numpy as np
from jaxtyping import Float

from flexsid.allowed import Allowed, Id, RunIds
from flexsid.errors import BadInput, FlexsidError
from flexsid.nomenclature import describe
from flexsid.records.decision import Structure
from flexsid.records.maneuver import Maneuver
from flexsid.records.run import EstimationRun, Method, Progress, ReportProgress, Start
from flexsid.records.validation import (
    CorrelationCurve,
    CrossPrediction,
    CrossPredictionMatrix,
    CrossValidation,
    HeldOutSpectra,
    PredictedOutput,
    ResidualCorrelations,
    ValidatedSource,
)
from flexsid.records.views import FitPlot, FitTrace, Residuals
from flexsid.storage.store import Store
from flexsid.sysid.adequacy.validation import (
    ResidualCorrelation,
    autocorrelate_residual,
    cross_correlate_residual,
    predict_outputs,
)
from flexsid.sysid.estimation.estimate import FittedSpectra, compute_output_fit
from flexsid.sysid.estimation.experiment import Experiment, Parameters
from flexsid.sysid.stability.derivative_fusion import IdentifiedModes
from flexsid.sysid.stability.flutter_prediction import FlutterPrediction, predict_flutter
from flexsid.sysid.stability.poles import Aeroelastic
from flexsid.sysid.stability.root_errors import UncertainDerivatives
from flexsid.workflow.aircraft.aircraft_models import define_outputs
from flexsid.workflow.fits.estimation_task import (
    EstimationTask,
    build_experiments,
    select_free_parameters,
)
from flexsid.workflow.measurements.recording import find_assigned_inputs
from flexsid.workflow.model_structures.model_structures import get_result, resolve_structure
from flexsid.workflow.runs.estimation import prepare, select_inputs_and_outputs
from flexsid.workflow.runs.exports import collect_values
from flexsid.workflow.runs.run_identity import list_run_contents
from flexsid.workflow.runs.run_proposal import set_default_band

# --- Prediction of the measured outputs of a maneuver by the identified model of a run ------------


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


# --- Matrix of cross-predictions: every maneuver predicted by the model of every run --------------

_MOST_PREDICTIONS = 1000  # a prediction takes about 0.1 s


@dataclass(frozen=True, slots=True, kw_only=True)
class CrossPredictionQuery:
    """Runs and maneuvers of a matrix, sorted by id; without maneuvers, those of the runs."""

    run_ids: RunIds
    maneuver_ids: Annotated[
        tuple[Id, ...], Allowed(text="Ids of maneuvers; by default those of the runs.")
    ] = ()

    def __post_init__(self) -> None:
        """Sort the ids: the same set is the same request."""
        object.__setattr__(self, "run_ids", tuple(sorted(set(self.run_ids))))
        object.__setattr__(self, "maneuver_ids", tuple(sorted(set(self.maneuver_ids))))


def identify_cross_prediction(store: Store, query: CrossPredictionQuery) -> tuple[object, ...]:
    """Check a query, and return all records on which its result depends.

    Raises
    ------
    BadInput
        If no run is selected, there are too many predictions, or aircraft differ.
    UnknownRecord
        If a run or maneuver does not exist.
    Conflict
        If a run has no result, or it was altered.
    """
    if not query.run_ids:
        raise BadInput("no run is selected; select at least one run that succeeded", code="no-run")
    if len(query.run_ids) > _MOST_PREDICTIONS:
        raise BadInput(
            f"{len(query.run_ids)} runs; expected at most {_MOST_PREDICTIONS} predictions,"
            " select fewer",
            code="too-many-predictions",
        )
    runs, maneuvers = _list_runs(store, query), list_maneuver_ids(store, query)
    if len(runs) * len(maneuvers) > _MOST_PREDICTIONS:
        raise BadInput(
            f"{len(runs)} runs and {len(maneuvers)} maneuvers; expected at most "
            f"{_MOST_PREDICTIONS} predictions, select fewer",
            code="too-many-predictions",
        )
    for run in runs:
        get_result(run)
    aircraft = {store.maneuvers.get(number).aircraft_id for number in maneuvers}
    aircraft |= {store.maneuvers.get(run.maneuver_id).aircraft_id for run in runs}
    if len(aircraft) > 1:
        raise BadInput(
            "runs and maneuvers are of several aircraft; select those of one",
            code="wrong-aircraft",
        )
    return list_run_contents(store, query.run_ids, maneuvers)


def list_maneuver_ids(store: Store, query: CrossPredictionQuery) -> tuple[int, ...]:
    """List the maneuvers of a query, each once."""
    own = (
        number
        for run in _list_runs(store, query)
        for number in (run.maneuver_id, *run.settings.additional_maneuver_ids)
    )
    return tuple(dict.fromkeys(query.maneuver_ids or own))


def compute_cross_predictions(
    store: Store, query: CrossPredictionQuery, report: ReportProgress
) -> CrossPredictionMatrix:
    """Predict every maneuver by the model of every run."""
    runs, maneuver_ids = _list_runs(store, query), list_maneuver_ids(store, query)
    maneuvers = [store.maneuvers.get(number) for number in maneuver_ids]
    labels = {m.id: m.label for m in map(store.maneuvers.get, {run.maneuver_id for run in runs})}
    found = []
    for run in runs:
        for number in maneuver_ids:
            done = len(found) / (len(runs) * len(maneuver_ids))
            report(Progress(fraction=done, message=f"Predicting maneuver {number} by run {run.id}"))
            found.append(_predict(store, run, number))
    return CrossPredictionMatrix(
        runs=tuple(
            ValidatedSource(
                id=run.id or 0, label=f"{run.method.value} {run.id}, {labels[run.maneuver_id]}"
            )
            for run in runs
        ),
        maneuvers=tuple(ValidatedSource(id=m.id or 0, label=m.label) for m in maneuvers),
        predictions=tuple(found),
    )


def _list_runs(store: Store, query: CrossPredictionQuery) -> list[EstimationRun]:
    return [store.runs.get(number) for number in query.run_ids]


def _predict(store: Store, run: EstimationRun, maneuver_id: int) -> CrossPrediction:
    assert run.id is not None
    fitted = (run.maneuver_id, *run.settings.additional_maneuver_ids)
    error, outputs, n_frequencies = None, (), 0
    try:
        predicted = predict_maneuver(store, run, maneuver_id)
        outputs = measure_outputs(predicted.spectra)
        n_frequencies = predicted.spectra.omega.size
    except FlexsidError as refused:
        error = refused.message
    except np.linalg.LinAlgError as failed:
        error = f"the outputs cannot be predicted ({failed})"
    return CrossPrediction(
        run_id=run.id,
        maneuver_id=maneuver_id,
        is_fitted=maneuver_id in fitted,
        r_squared=float(np.mean([one.r_squared for one in outputs])) if outputs else None,
        theil=float(np.mean([one.theil for one in outputs])) if outputs else None,
        outputs=outputs,
        n_frequencies=n_frequencies,
        error=error,
    )


# --- Flutter prediction of a fit from its parameters and their covariance, without a database -----

_BAND = (0.35, 2.0)  # of the airspeed flown: range of the flutter search


def predict_flutter_of_fit(
    task: EstimationTask,
    parameters: Parameters,
    theta: Float[np.ndarray, " n_theta"],
    covariance: Float[np.ndarray, "n_theta n_theta"],
) -> FlutterPrediction:
    """Predict flutter at the density of the first maneuver by the model with these parameters."""
    model, table = task.model, parameters.table(theta)
    names = list(model.derivative_names)
    own = [k for k, name in enumerate(parameters.names) if name in names]
    places = np.array([names.index(parameters.names[k]) for k in own], dtype=int)
    rows, columns = np.divmod(places, len(model.variables))
    modes = model.modes.tuned(dict(zip(parameters.names, theta.tolist(), strict=True)))
    found = IdentifiedModes(
        Aeroelastic(model.condition, modes, table, model.shape),
        UncertainDerivatives(rows, columns, covariance[np.ix_(own, own)]),
    )
    airspeed = model.condition.airspeed
    labels = dict(zip(map(str, model.modes.numbers), task.mode_names, strict=True))
    return predict_flutter(found, (_BAND[0] * airspeed, _BAND[1] * airspeed), called=labels)


# --- Numbers of the figures of a validation: spectra, residuals and their correlation -------------

_SHOWN_FIRST = 2  # outputs drawn by default


def read_prediction(
    store: Store, run_id: int, maneuver_id: int | None = None, outputs: Sequence[str] = ()
) -> FitPlot:
    """Predict outputs of a maneuver, by default that of the run; the first outputs by default."""
    number = _get_maneuver_id(store, run_id, maneuver_id)
    spectra = _predict_maneuver(store, run_id, maneuver_id).spectra
    return _plot(store, run_id, number, spectra, outputs)


def compute_prediction_residuals(
    store: Store, run_id: int, maneuver_id: int | None = None
) -> Residuals:
    """Compute the residuals of the predicted outputs of a maneuver, relative to their rms."""
    return _compute_residuals(run_id, _predict_maneuver(store, run_id, maneuver_id).spectra)


def correlate_residuals(
    store: Store, run_id: int, maneuver_id: int | None = None, outputs: Sequence[str] = ()
) -> ResidualCorrelations:
    """Correlate the residuals of outputs with themselves, the inputs, and each other.

    Residuals are those of the outputs predicted from measured inputs, by default for the
    maneuver of the run and its first output.

    Raises
    ------
    BadInput
        If the model has no such output.
    """
    predicted = _predict_maneuver(store, run_id, maneuver_id)
    spectra = predicted.spectra
    names = tuple(dict.fromkeys(outputs)) or spectra.outputs[:1]
    omega, correlation = spectra.omega, spectra.correlation
    residuals = {
        name: (spectra.measured - spectra.fitted)[:, _get_column(spectra, name)] for name in names
    }
    curves = []
    for name, residual in residuals.items():
        own = autocorrelate_residual(omega, residual, correlation)
        curves.append(_describe_curve(name, name, own))
        for k, channel in enumerate(predicted.input_names):
            found = cross_correlate_residual(omega, residual, predicted.inputs[:, k], correlation)
            curves.append(_describe_curve(name, channel, found))
    for first, second in combinations(names, 2):
        found = cross_correlate_residual(omega, residuals[first], residuals[second], correlation)
        curves.append(_describe_curve(first, second, found))
    outside = [np.abs(curve.values) > curve.bound for curve in curves]
    return ResidualCorrelations(
        run_id=run_id,
        maneuver_id=_get_maneuver_id(store, run_id, maneuver_id),
        curves=tuple(curves),
        share_outside=float(np.mean(np.concatenate(outside))),
    )


def read_held_out_fit(
    store: Store,
    found: CrossValidation,
    maneuver_id: int | None = None,
    outputs: Sequence[str] = (),
) -> FitPlot:
    """Read measured and predicted outputs at the frequencies held out."""
    run_id = found.summary.run_id
    spectra = _get_spectra(found, maneuver_id)
    number = _get_maneuver_id(store, run_id, maneuver_id)
    return _plot(store, run_id, number, spectra, outputs)


def compute_held_out_residuals(found: CrossValidation, maneuver_id: int | None = None) -> Residuals:
    """Compute the residuals at the frequencies held out, relative to their rms."""
    return _compute_residuals(found.summary.run_id, _get_spectra(found, maneuver_id))


def _predict_maneuver(store: Store, run_id: int, maneuver_id: int | None) -> PredictedManeuver:
    number = _get_maneuver_id(store, run_id, maneuver_id)
    return predict_maneuver(store, store.runs.get(run_id), number)


def _get_maneuver_id(store: Store, run_id: int, maneuver_id: int | None) -> int:
    return store.runs.get(run_id).maneuver_id if maneuver_id is None else maneuver_id


def _get_spectra(found: CrossValidation, maneuver_id: int | None) -> FittedSpectra:
    def convert(one: HeldOutSpectra) -> FittedSpectra:
        return FittedSpectra("held out", one.outputs, one.omega, one.measured, one.predicted)

    for one in found.spectra:
        if maneuver_id in (None, one.maneuver_id):
            return convert(one)
    raise BadInput(
        f"run {found.summary.run_id} was not fitted to maneuver {maneuver_id}",
        code="unknown-maneuver",
    )


def _get_column(spectra: FittedSpectra, output: str) -> int:
    if output not in spectra.outputs:
        raise BadInput(
            f"the model has no output '{output}'; it has {', '.join(spectra.outputs)}",
            code="unknown-output",
            output=output,
        )
    return spectra.outputs.index(output)


def _plot(
    store: Store, run_id: int, maneuver_id: int, spectra: FittedSpectra, outputs: Sequence[str]
) -> FitPlot:
    maneuver = store.maneuvers.get(maneuver_id)
    frequency_hz = spectra.omega / (2.0 * np.pi)
    r_squared = spectra.r_squared()
    traces = []
    for name in dict.fromkeys(outputs or spectra.outputs[:_SHOWN_FIRST]):
        column = _get_column(spectra, name)
        z, y = spectra.measured[:, column], spectra.fitted[:, column]
        phase = np.angle(z)
        traces.append(
            FitTrace(
                output=name,
                unit=describe(name).unit,
                input=None,
                measured_magnitude=np.abs(z),
                measured_phase_rad=phase,
                fitted_magnitude=np.abs(y),
                fitted_phase_rad=phase + np.angle(y * z.conj()),
                r_squared=float(r_squared[column]),
            )
        )
    return FitPlot(
        run_id=run_id,
        method=Method.OE,  # whatever the method of the run: outputs from measured inputs
        block=spectra.name,
        frequency_hz=frequency_hz,
        traces=tuple(traces),
        curve="predicted",
        inputs=() if maneuver.excitation is None else tuple(maneuver.excitation.harmonics),
        assigned_inputs=find_assigned_inputs(maneuver, frequency_hz),
    )


def _compute_residuals(run_id: int, spectra: FittedSpectra) -> Residuals:
    size = np.abs(spectra.measured - spectra.fitted)
    rms = np.sqrt(np.mean(size**2, axis=0))
    return Residuals(
        run_id=run_id,
        method=Method.OE,
        block=spectra.name,
        frequency_hz=spectra.omega / (2.0 * np.pi),
        outputs=spectra.outputs,
        relative=np.divide(size, rms, out=np.zeros_like(size), where=rms > 0),
    )


def _describe_curve(output: str, other: str, found: ResidualCorrelation) -> CorrelationCurve:
    return CorrelationCurve(
        output=output, other=other, lags_s=found.lags_s, values=found.values, bound=found.bound
    )
