"""Fit of a global model: outlying runs, selection, drift, and the next condition."""

from __future__ import annotations

from dataclasses import asdict, replace

import numpy as np

from flexsid.nomenclature import describe
from flexsid.records.decision import LimitedQuantity
from flexsid.records.global_model import (
    AverageSlope,
    CandidateScore,
    EnvelopeRange,
    FittedRun,
    GlobalDerivative,
    GlobalModelResult,
    GlobalModelSummary,
    NextCondition,
    Outlier,
    RunLabel,
)
from flexsid.records.run import Progress, ReportProgress
from flexsid.sysid.global_model.drift import estimate_drift
from flexsid.sysid.global_model.fit import RunEstimates
from flexsid.sysid.global_model.selection import (
    OutlyingRun,
    ScaleFactor,
    SelectedModel,
    find_next_condition,
    find_outlying_runs,
    select_global_model,
)
from flexsid.workflow.global_model.estimates import GlobalModelTask, interpolate_table

_SEARCH_SHARE = 0.5  # of the progress, for outlying runs


def compute_global_model(
    task: GlobalModelTask, report: ReportProgress = lambda progress: None
) -> GlobalModelResult:
    """Fit the derivatives of all runs over the envelope.

    Outlying runs are found first, and excluded; then the polynomials, and whether the
    prediction is their mean, are selected by the prediction of flights.

    Raises
    ------
    NotIdentifiable
        If the covariance of a run is singular.
    """
    report(Progress(message="Outlying runs"))
    found = find_outlying_runs(task.estimates)
    included = np.ones(len(task.runs), dtype=bool)
    included[[one.index for one in found]] = False
    candidates = [one.select(included) for one in _list_candidates(task)]
    selected = select_global_model(
        candidates,
        lambda share: report(
            Progress(
                fraction=_SEARCH_SHARE + (1.0 - _SEARCH_SHARE) * share,
                message="Prediction of flights",
            )
        ),
    )
    uses_prediction = selected.candidate == 1
    centre = selected.runs.conditions.mean(axis=0)
    fuel = float(task.fuel[included].mean())
    variables = task.query.variables
    result = GlobalModelResult(
        summary=GlobalModelSummary(
            sentence="",
            aircraft_id=task.aircraft_id,
            modes=task.modes,
            variables=_describe_ranges(variables, selected),
            centre=tuple(centre.tolist()),
            n_maneuvers=task.n_maneuvers,
            n_flights=task.n_flights,
            prediction_id=task.query.prediction_id,
            uses_prediction=uses_prediction,
            derivatives=(),
            scores=tuple(
                CandidateScore(
                    **asdict(score),
                    uses_prediction=candidate == 1,
                    is_selected=score is selected.score,
                )
                for candidate, scores in enumerate(selected.scores)
                for score in scores
            ),
            outliers=tuple(_describe_outlier(one, task.runs[one.index]) for one in found),
            runs=tuple(
                FittedRun(
                    **asdict(run),
                    condition=tuple(condition.tolist()),
                    is_outlying=not inside,
                )
                for run, condition, inside in zip(
                    task.runs, task.estimates.conditions, included, strict=True
                )
            ),
            next_condition=_describe_next_condition(selected),
            omitted=task.omitted,
        ),
        model=selected.model,
        modal_std=task.modal_std,
        values=task.estimates.values,
        std_errors=np.where(
            task.estimates.is_estimated,
            np.sqrt(np.diagonal(task.estimates.covariances, axis1=1, axis2=2)),
            np.nan,
        ),
        fuel=fuel,
        prediction=task.prediction,
    )
    derivatives = _describe_derivatives(result, selected, centre)
    summary = replace(result.summary, derivatives=derivatives)
    return replace(result, summary=replace(summary, sentence=_describe(summary)))


def predict_derivatives(
    result: GlobalModelResult, conditions: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Predict all derivatives (n, p) and their covariance (n, p, p) at conditions (n, n_v).

    The covariance is without the error of the modal table, which all runs share.
    """
    values, covariance = result.model.predict(conditions)
    if result.summary.uses_prediction:
        values = values + np.nan_to_num(predict_before_flight(result, conditions))
    return values, covariance


def predict_before_flight(result: GlobalModelResult, conditions: np.ndarray) -> np.ndarray:
    """Interpolate the prediction (n, p) at conditions; NaN where a derivative has none."""
    assert result.prediction is not None
    quantities = [one.quantity for one in result.summary.variables]
    fuel = np.full(len(conditions), result.fuel)
    if LimitedQuantity.FUEL in quantities:
        fuel = conditions[:, quantities.index(LimitedQuantity.FUEL)]
    return interpolate_table(result.prediction, fuel)


def _list_candidates(task: GlobalModelTask) -> list[RunEstimates]:
    """List the estimates without a mean, and with the prediction as mean."""
    if task.prediction is None:
        return [task.estimates]
    mean = np.nan_to_num(interpolate_table(task.prediction, task.fuel))
    return [task.estimates, replace(task.estimates, mean=mean)]


def _describe_ranges(
    variables: tuple[LimitedQuantity, ...], selected: SelectedModel
) -> tuple[EnvelopeRange, ...]:
    basis = selected.model.basis
    return tuple(
        EnvelopeRange(quantity=quantity, lowest=float(low), highest=float(high))
        for quantity, low, high in zip(variables, basis.lowest, basis.highest, strict=True)
    )


def _describe_derivatives(
    result: GlobalModelResult, selected: SelectedModel, centre: np.ndarray
) -> tuple[GlobalDerivative, ...]:
    model, runs = selected.model, selected.runs
    values, covariance = predict_derivatives(result, centre[None])
    std = np.sqrt(np.diag(covariance[0]) + result.modal_std**2)
    variables = [one.quantity for one in result.summary.variables]
    drift = estimate_drift(model, runs.conditions)
    counts = runs.is_estimated.sum(axis=0)
    return tuple(
        GlobalDerivative(
            name=name,
            label=describe(name).label,
            unit=describe(name).unit or "1",
            n_runs=int(counts[k]),
            value=float(values[0, k]),
            std_error=float(std[k]),
            scatter=float(model.scatter[k]),
            modal_std=float(result.modal_std[k]),
            slopes=tuple(
                AverageSlope(
                    quantity=quantity,
                    slope=float(drift.slopes[v, k]),
                    std_error=float(drift.std_errors[v, k]),
                    probability=float(drift.probability[v, k]),
                    is_drift=bool(drift.is_significant[v, k]),
                )
                for v, quantity in enumerate(variables)
            ),
        )
        for k, name in enumerate(model.names)
    )


def _describe_next_condition(selected: SelectedModel) -> NextCondition | None:
    found = find_next_condition(selected)
    if found is None:
        return None
    return NextCondition(condition=tuple(found[0].tolist()), reduction=found[1])


def _describe_outlier(found: OutlyingRun, run: RunLabel) -> Outlier:
    worst = ", ".join(f"{name} {sigma:+.1f}σ" for name, sigma in found.worst)
    sentence = (
        f"{run.method} run {run.run_id} ({run.label}) differs from the prediction by all other "
        f"runs: {worst}."
    )
    if found.cause is not None:
        sentence += f" {_describe_cause(found.cause)}"
    return Outlier(
        run_id=run.run_id,
        label=run.label,
        sentence=sentence,
        chi_square=found.chi_square,
        n_derivatives=found.n_derivatives,
        probability=found.probability,
        factor=None if found.cause is None else found.cause.factor,
        factor_std=None if found.cause is None else found.cause.std,
    )


def _describe_cause(cause: ScaleFactor) -> str:
    factor = f"{cause.factor:.2f} ± {2.0 * cause.std:.2f}"
    share = f"{100.0 * cause.explained:.0f} % of the deviation"
    if cause.variable is not None:
        hint = "sign" if cause.factor < 0.0 else "sign, unit or scale factor"
        return (
            f"A factor of {factor} on all derivatives of {cause.variable} explains {share}: check "
            f"the {hint} of {cause.variable}."
        )
    if cause.coefficient is not None:
        return (
            f"A factor of {factor} on all derivatives of {cause.coefficient} explains {share}: "
            "check the mass and moments of inertia."
        )
    return f"A factor of {factor} on all derivatives explains {share}: check airspeed and density."


def _describe(summary: GlobalModelSummary) -> str:
    included = sum(not run.is_outlying for run in summary.runs)
    best = next(score for score in summary.scores if score.is_selected)
    drifting = [
        one.name for one in summary.derivatives if any(slope.is_drift for slope in one.slopes)
    ]
    mean = ", with the prediction as mean" if summary.uses_prediction else ""
    sentence = (
        f"{len(summary.derivatives)} derivatives from {included} runs of {summary.n_flights} "
        f"flights{mean}. Predicted by the other flights, {100.0 * best.share_inside:.0f} % of the "
        f"estimates are within 2σ (rms {best.rms:.2f})."
    )
    if summary.outliers:
        ids = ", ".join(str(one.run_id) for one in summary.outliers)
        sentence += f" Excluded as outlying: run{'s' if len(summary.outliers) > 1 else ''} {ids}."
    if drifting:
        sentence += f" {len(drifting)} derivatives vary over the envelope."
    else:
        sentence += " No derivative varies significantly over the envelope."
    return sentence
