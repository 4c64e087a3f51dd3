"""Compare derivatives of runs and predictions (Fig. 17)."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

from flexsid.errors import BadInput
from flexsid.nomenclature import describe
from flexsid.records.comparison import PREDICTED, ComparedSource, Comparison, Row, SourceValue
from flexsid.records.maneuver import Maneuver
from flexsid.records.prediction import DerivativePrediction
from flexsid.records.run import EstimationRun, RunResult
from flexsid.storage.content import changed_since
from flexsid.storage.store import Store
from flexsid.workflow.aircraft.derivative_predictions import prediction_at
from flexsid.workflow.comparison.agreement import (
    consistent,
    largest_difference,
    pairs,
    prediction_verdicts,
    runs_verdict,
    scatter,
    setup,
)
from flexsid.workflow.model_structures.run_results import result_of


@dataclass(frozen=True, slots=True)
class _Column:
    source: ComparedSource
    values: dict[str, SourceValue]


def compare(store: Store, run_ids: Sequence[int], prediction_ids: Sequence[int]) -> Comparison:
    """Put runs and predictions side by side, derivative by derivative.

    Parameters
    ----------
    store
        Where they are kept.
    run_ids
        Runs that succeeded; at least one, for it tells the condition.
    prediction_ids
        Predictions, taken at the fuel of the first run's maneuver. Where a run keeps
        the residualised form of one of them, that is a source of its own.

    Raises
    ------
    BadInput
        If no run is given.
    Conflict
        If a run has no result.

    Notes
    -----
    Two estimates a and b are judged by |a - b| / sqrt(sigma_a^2 + sigma_b^2), as if
    independent. Runs of one maneuver share its noise, so the measure is lenient for
    them. Runs are judged among each other, and each prediction against the runs: what was
    predicted does not change how the runs agree. A source without standard errors is
    shown, not judged.
    """
    if not run_ids:
        raise BadInput("a comparison takes at least one run; choose one", code="no-run")
    runs = [store.runs.get(number) for number in dict.fromkeys(run_ids)]
    finished = [(run, result_of(run, "no result to compare")) for run in runs]
    changed = changed_since(store.database, [run.rests_on for run in runs])
    maneuvers = {run.maneuver_id: store.maneuvers.get(run.maneuver_id) for run, _ in finished}
    columns = [
        _of_run(run, result, maneuvers, since)
        for (run, result), since in zip(finished, changed, strict=True)
    ]
    fuel = next(iter(maneuvers.values())).condition.fuel_fraction
    predictions = [store.predictions.get(number) for number in dict.fromkeys(prediction_ids)]
    columns += [_of_prediction(store, prediction, fuel) for prediction in predictions]
    columns += _residualized(finished, predictions)
    names = _in_order(parameter.name for _, result in finished for parameter in result.parameters)
    sources = tuple(column.source for column in columns)
    rows = tuple(_row(name, columns) for name in names)
    return Comparison(
        maneuver_ids=tuple(maneuvers),
        sources=sources,
        rows=rows,
        pairs=pairs(sources, rows),
        setup=setup(sources, {run.id: run for run, _ in finished if run.id is not None}),
        runs_verdict=runs_verdict(rows),
        prediction_verdicts=prediction_verdicts(sources, rows),
    )


def coefficients(comparison: Comparison) -> tuple[str, ...]:
    """Names of the coefficients whose derivatives are compared, e.g. ``Cm``."""
    return tuple(dict.fromkeys(row.name.partition("_")[0] for row in comparison.rows))


def of_coefficient(comparison: Comparison, coefficient: str | None) -> Comparison:
    """Keep the derivatives of one coefficient, e.g. ``Cm``; None keeps all.

    Raises
    ------
    BadInput
        If there are none.
    """
    if coefficient is None:
        return comparison
    rows = tuple(row for row in comparison.rows if row.name.partition("_")[0] == coefficient)
    if not rows:
        raise BadInput(
            f"no derivative of '{coefficient}' was estimated; there are "
            f"{', '.join(coefficients(comparison))}",
            code="unknown-coefficient",
            coefficient=coefficient,
        )
    return replace(
        comparison,
        rows=rows,
        runs_verdict=runs_verdict(rows),
        prediction_verdicts=prediction_verdicts(comparison.sources, rows),
    )


def _of_run(
    run: EstimationRun,
    result: RunResult,
    maneuvers: dict[int, Maneuver],
    changed: tuple[str, ...],
) -> _Column:
    key = f"run-{run.id}"
    # the maneuver is told only where there is more than one to tell apart
    where = f", {maneuvers[run.maneuver_id].label}" if len(maneuvers) > 1 else ""
    return _Column(
        ComparedSource(
            key=key,
            label=f"{run.method.value} {run.id}{where}",
            kind=run.method.value,
            run_id=run.id,
            changed_since=changed,
        ),
        {
            parameter.name: SourceValue(
                key=key, value=parameter.value, std_error=parameter.std_error
            )
            for parameter in result.parameters
        },
    )


def _of_prediction(store: Store, prediction: DerivativePrediction, fuel: float) -> _Column:
    key = f"prediction-{prediction.id}"
    return _Column(
        ComparedSource(
            key=key, label=prediction.source, kind=PREDICTED, prediction_id=prediction.id
        ),
        {
            name: SourceValue(key=key, value=value, std_error=error)
            for name, (value, error) in prediction_at(store, prediction, fuel).items()
        },
    )


def _residualized(
    finished: list[tuple[EstimationRun, RunResult]], predictions: list[DerivativePrediction]
) -> list[_Column]:
    """Residualised predictions that the runs kept; runs that share one show it once."""
    labels = {prediction.id: prediction.source for prediction in predictions}
    columns: list[_Column] = []
    shown: list[dict[str, float]] = []
    for run, result in finished:
        values = result.residualized_prediction
        if values is None or result.prediction_id not in labels or values in shown:
            continue
        shown.append(values)
        key = f"residualized-{result.prediction_id}-{run.id}"
        # the run is told only where there is more than one condition to tell apart
        of_run = f" for run {run.id}" if len(shown) > 1 else ""
        columns.append(
            _Column(
                ComparedSource(
                    key=key,
                    label=f"{labels[result.prediction_id]}, residualized{of_run}",
                    kind=PREDICTED,
                    run_id=run.id,
                    prediction_id=result.prediction_id,
                ),
                {name: SourceValue(key=key, value=value) for name, value in values.items()},
            )
        )
    return columns


def _row(name: str, columns: list[_Column]) -> Row:
    estimates = [column.values.get(name) for column in columns if not column.source.is_prediction]
    largest = largest_difference(combinations(estimates, 2))
    return Row(
        name=name,
        label=describe(name).label,
        values=tuple(
            _against(column.values.get(name), estimates)
            if column.source.is_prediction
            else column.values.get(name)
            for column in columns
        ),
        consistent=consistent(largest),
        max_difference_sigma=largest,
        **scatter(estimates),
    )


def _against(
    predicted: SourceValue | None, estimates: Sequence[SourceValue | None]
) -> SourceValue | None:
    """A predicted value with its largest difference from the estimates of the runs."""
    if predicted is None:
        return None
    largest = largest_difference((predicted, estimate) for estimate in estimates)
    return replace(predicted, difference_sigma=largest, consistent=consistent(largest))


_VARIABLES = ("alpha", "q", "eta", "etadot")


def _in_order(names: Iterable[str]) -> list[str]:
    """Order as in a table of derivatives, whatever run a name came from; delays last."""
    unique = list(dict.fromkeys(names))
    place = {name: number for number, name in enumerate(unique)}

    def rank(name: str) -> tuple[int, int, int, int, int]:
        coefficient, _, variable = name.partition("_")
        row = {"CZ": 0, "Cm": 1}.get(coefficient, 2 if coefficient.startswith("CQ") else 3)
        kind, mode = _split_mode(variable)
        column = _VARIABLES.index(kind) if kind in _VARIABLES else len(_VARIABLES)
        inputs_stay = place[name] if column == len(_VARIABLES) else 0
        return row, _split_mode(coefficient)[1], column, mode, inputs_stay

    return sorted(unique, key=rank)


def _split_mode(text: str) -> tuple[str, int]:
    letters = text.rstrip("0123456789")
    digits = text[len(letters) :]
    return letters, int(digits) if digits else -1
