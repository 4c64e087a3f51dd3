"""Cross-validation of a run: prediction of its held-out data by fits to the others."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np

from flexsid.allowed import Allowed, Id
from flexsid.errors import BadInput, NotIdentifiable
from flexsid.records.run import EstimationRun, Method, Progress, ReportProgress, Start
from flexsid.records.validation import (
    CrossValidation,
    CrossValidationSummary,
    HeldOutSpectra,
    Partition,
    PredictedOutput,
    Refit,
    ValidatedOutput,
)
from flexsid.storage.store import Store
from flexsid.sysid.adequacy.validation import assign_folds, predict_outputs
from flexsid.sysid.estimation.estimate import FittedSpectra
from flexsid.sysid.estimation.experiment import Experiment
from flexsid.workflow.fits.computation import ComputedRun, compute_run
from flexsid.workflow.fits.estimation_task import EstimationTask, ManeuverTask
from flexsid.workflow.measurements.recording import SpectrumFrequencies
from flexsid.workflow.model_structures.model_structures import get_result
from flexsid.workflow.runs.estimation import prepare
from flexsid.workflow.runs.exports import collect_values
from flexsid.workflow.runs.run_identity import list_run_contents
from flexsid.workflow.validation.cross_prediction import (
    build_identified_parameters,
    build_output_experiments,
    hold_values,
    measure_outputs,
)

_FEWEST_PERIODS = 3  # the first is dropped, one is fitted, one held out


@dataclass(frozen=True, slots=True, kw_only=True)
class CrossValidationQuery:
    """A run and the partition of its data; of periods, one share in ``folds`` is held out."""

    run_id: Id
    partition: Annotated[
        Partition,
        Allowed(text="All folds of the frequencies, the first fold, or the last periods."),
    ] = Partition.FOLDS
    folds: Annotated[
        int,
        Allowed(ge=2, le=20, text="Number of folds; of periods, one share in so many is held out."),
    ] = 5


@dataclass(frozen=True, slots=True)
class _Split:
    """Data that a refit is fitted to, and data with the frequencies it predicts, by maneuver."""

    name: str
    fitted: tuple[ManeuverTask, ...]
    predicted: tuple[ManeuverTask, ...]
    held_out: tuple[np.ndarray, ...]


def identify_cross_validation(store: Store, query: CrossValidationQuery) -> tuple[object, ...]:
    """Check a query, and return all records on which its result depends.

    Raises
    ------
    UnknownRecord
        If the run does not exist.
    Conflict
        If the run has no result, or it was altered.
    """
    get_result(store.runs.get(query.run_id))
    return list_run_contents(store, (query.run_id,))


def cross_validate(
    store: Store, query: CrossValidationQuery, report: ReportProgress
) -> CrossValidation:
    """Fit a run again without some of its data, and predict these.

    A refit has the method, model structure, settings, priors and retained modes of the run, and
    starts from its values. Outputs are predicted from measured inputs, also for
    frequency-response and equation error.

    Raises
    ------
    BadInput
        If an input has fewer frequencies than folds, or a multisine too few periods.
    NotIdentifiable
        If a refit fails.
    """
    run = store.runs.get(query.run_id)
    values = collect_values(run)
    task = prepare_refit(store, run, values)
    splits = _split(task, query)
    predicted: list[list[FittedSpectra]] = [[] for _ in task.maneuver_tasks]
    fitted: list[list[FittedSpectra]] = [[] for _ in task.maneuver_tasks]
    refits = []
    for number, split in enumerate(splits):

        def report_refit(progress: Progress, name: str = split.name, done: int = number) -> None:
            share = (done + progress.fraction) / len(splits)
            report(replace(progress, fraction=share, message=f"{name}: {progress.message}"))

        report_refit(Progress(message="Fitting"))
        computed = _refit(replace(task, maneuver_tasks=split.fitted), split.name, report_refit)
        whole = replace(task, maneuver_tasks=split.predicted)
        experiments = build_output_experiments(whole)
        parts = _predict(whole, experiments, values | _collect_values(computed), split.held_out)
        own = _predict(whole, experiments, values, split.held_out)
        for k in range(len(experiments)):
            predicted[k].append(parts[k])
            fitted[k].append(own[k])
        refits.append(
            Refit(
                name=split.name,
                outcome=computed.estimate.outcome.value,
                n_frequencies=sum(m.measurement.frequencies.omega.size for m in split.fitted),
                n_held_out=sum(part.omega.size for part in parts),
                r_squared=_average([m for part in parts for m in measure_outputs(part)]).r_squared,
            )
        )
    ids = (run.maneuver_id, *run.settings.additional_maneuver_ids)
    return _summarise(query, tuple(dict.fromkeys(ids)), refits, predicted, fitted)


def prepare_refit(store: Store, run: EstimationRun, values: dict[str, float]) -> EstimationTask:
    """Prepare a run again, to start from its own values alone."""
    settings = run.settings
    if settings.start is Start.RUN:  # another run, which is not needed
        settings = replace(settings, start=Start.EQUATION_ERROR, start_run_id=None)
    task = prepare(store, replace(run, structure=hold_values(run), settings=settings))
    start = task.model.fill_table(values)
    return replace(task, starts={f"run {run.id}": start}, try_equation_error=False)


def _split(task: EstimationTask, query: CrossValidationQuery) -> list[_Split]:
    if query.partition is Partition.PERIODS:
        return [_hold_out_periods(task, query.folds)]
    folds = [
        assign_folds(one.measurement.excited.assigned_input, query.folds)
        for one in task.maneuver_tasks
    ]
    count = query.folds if query.partition is Partition.FOLDS else 1
    return [
        _Split(
            name=f"Fold {number + 1} of {query.folds}",
            fitted=tuple(
                select_frequencies(one, fold != number)
                for one, fold in zip(task.maneuver_tasks, folds, strict=True)
            ),
            predicted=task.maneuver_tasks,
            held_out=tuple(fold == number for fold in folds),
        )
        for number in range(count)
    ]


def select_frequencies(task: ManeuverTask, selected: np.ndarray) -> ManeuverTask:
    """Select some of the frequencies of a maneuver (n_omega,)."""

    def select(whole: SpectrumFrequencies) -> SpectrumFrequencies:
        return replace(
            whole, omega=whole.omega[selected], assigned_input=whole.assigned_input[selected]
        )

    measurement = task.measurement
    return replace(
        task,
        measurement=replace(
            measurement,
            frequencies=select(measurement.frequencies),
            excited=select(measurement.excited),
        ),
    )


def _hold_out_periods(task: EstimationTask, folds: int) -> _Split:
    """Hold out the last periods of every maneuver; the first one is dropped, as in the run."""
    fitted, predicted, held_out = [], [], []
    for one in task.maneuver_tasks:
        excitation = one.measurement.recording.maneuver.excitation
        if excitation is None or excitation.n_periods < _FEWEST_PERIODS:
            count = 1 if excitation is None else excitation.n_periods
            raise BadInput(
                f"{one.label} has {count} period{'' if count == 1 else 's'} of its multisine; "
                f"expected at least {_FEWEST_PERIODS} to hold out periods, select folds of the "
                "frequencies",
                code="too-few-periods",
            )
        last = max(1, round((excitation.n_periods - 1) / folds))
        first = excitation.n_periods - last
        fitted.append(_select_periods(one, 0, first))
        predicted.append(_select_periods(one, first - 1, last + 1))
        held_out.append(np.ones(one.measurement.frequencies.omega.size, dtype=bool))
    return _Split("Last periods", tuple(fitted), tuple(predicted), tuple(held_out))


def _select_periods(task: ManeuverTask, first: int, count: int) -> ManeuverTask:
    """Select consecutive periods of a maneuver, the first of which is dropped."""
    measurement = task.measurement
    maneuver = measurement.recording.maneuver
    excitation = maneuver.excitation
    assert excitation is not None
    start_s = excitation.start_s + first * excitation.period_s
    own = replace(excitation, start_s=start_s, n_periods=count)
    recording = replace(measurement.recording, maneuver=replace(maneuver, excitation=own))
    return replace(task, measurement=replace(measurement, recording=recording))


def _refit(task: EstimationTask, name: str, report: ReportProgress) -> ComputedRun:
    try:
        return compute_run(task, report)
    except NotIdentifiable as error:
        raise NotIdentifiable(f"{name}: {error.message}") from error


def _collect_values(computed: ComputedRun) -> dict[str, float]:
    found = computed.estimate if computed.retained is None else computed.retained.estimate
    return dict(zip(found.names, found.values.tolist(), strict=True))


def _predict(
    task: EstimationTask,
    experiments: Sequence[Experiment],
    values: dict[str, float],
    held_out: Sequence[np.ndarray],
) -> list[FittedSpectra]:
    """Predict the outputs of every maneuver at the frequencies held out."""
    parameters = build_identified_parameters(replace(task, method=Method.OE), values)
    found = []
    for experiment, selected in zip(experiments, held_out, strict=True):
        spectra = predict_outputs(experiment, parameters, parameters.start)
        found.append(
            replace(
                spectra,
                omega=spectra.omega[selected],
                measured=spectra.measured[selected],
                fitted=spectra.fitted[selected],
                correlation=None,
            )
        )
    return found


def _join(parts: Sequence[FittedSpectra]) -> FittedSpectra:
    """Join the frequencies of all folds in order."""
    omega = np.concatenate([part.omega for part in parts])
    order = np.argsort(omega, kind="stable")
    return replace(
        parts[0],
        omega=omega[order],
        measured=np.concatenate([part.measured for part in parts])[order],
        fitted=np.concatenate([part.fitted for part in parts])[order],
    )


def _average(outputs: Sequence[PredictedOutput]) -> PredictedOutput:
    return PredictedOutput(
        output="mean",
        r_squared=float(np.mean([one.r_squared for one in outputs])),
        theil=float(np.mean([one.theil for one in outputs])),
    )


def _summarise(
    query: CrossValidationQuery,
    maneuver_ids: Sequence[int],
    refits: list[Refit],
    predicted: list[list[FittedSpectra]],
    fitted: list[list[FittedSpectra]],
) -> CrossValidation:
    whole = [_join(parts) for parts in predicted]
    new = [measure_outputs(spectra) for spectra in whole]
    own = [measure_outputs(_join(parts)) for parts in fitted]
    mean, fitted_mean = (_average([one for part in parts for one in part]) for parts in (new, own))
    summary = CrossValidationSummary(
        run_id=query.run_id,
        partition=query.partition,
        sentence=_describe(query, mean, fitted_mean, refits),
        r_squared=mean.r_squared,
        theil=mean.theil,
        fitted_r_squared=fitted_mean.r_squared,
        fitted_theil=fitted_mean.theil,
        refits=tuple(refits),
        outputs=tuple(
            ValidatedOutput(
                maneuver_id=number,
                output=held.output,
                r_squared=held.r_squared,
                theil=held.theil,
                fitted_r_squared=fit.r_squared,
                fitted_theil=fit.theil,
            )
            for number, a, b in zip(maneuver_ids, new, own, strict=True)
            for held, fit in zip(a, b, strict=True)
        ),
    )
    return CrossValidation(
        summary=summary,
        spectra=tuple(
            HeldOutSpectra(
                maneuver_id=number,
                outputs=spectra.outputs,
                omega=spectra.omega,
                measured=spectra.measured,
                predicted=spectra.fitted,
            )
            for number, spectra in zip(maneuver_ids, whole, strict=True)
        ),
    )


def _describe(
    query: CrossValidationQuery,
    mean: PredictedOutput,
    fitted: PredictedOutput,
    refits: Sequence[Refit],
) -> str:
    what = {
        Partition.FOLDS: f"{query.folds}-fold cross-validation over the frequencies",
        Partition.FREQUENCIES: f"Prediction of every {query.folds}th frequency of each input",
        Partition.PERIODS: "Prediction of the last periods",
    }[query.partition]
    sentence = (
        f"{what}: mean R² {mean.r_squared:.3f} of the data held out, {fitted.r_squared:.3f} of "
        f"the run itself at the same data."
    )
    failed = [one.name for one in refits if one.outcome != "converged"]
    if failed:
        sentence += f" Not converged: {', '.join(failed)}."
    return sentence
