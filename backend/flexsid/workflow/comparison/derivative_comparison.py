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
from flexsid.storage.content import find_changes
from flexsid.storage.store import Store
from flexsid.workflow.aircraft.derivative_predictions import interpolate_prediction
from flexsid.workflow.comparison.agreement import (
    average_estimates,
    compare_pairs,
    compare_setups,
    count_prediction_agreement,
    count_run_agreement,
    find_largest_difference,
    is_consistent,
)
from flexsid.workflow.model_structures.run_results import get_result


@dataclass(frozen=True, slots=True)
class _Column:
    source: ComparedSource
    values: dict[str, SourceValue]


def compare(store: Store, run_ids: Sequence[int], prediction_ids: Sequence[int]) -> Comparison:
    """Compare runs and predictions, derivative by derivative.

    Parameters
    ----------
    store
        Database.
    run_ids
        Runs that succeeded; at least one, which defines the condition.
    prediction_ids
        Predictions, taken at the fuel of the first run's maneuver. The
        residualised form stored with a run is a separate source.

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
        raise BadInput("a comparison needs at least one run; select one", code="no-run")
    runs = [store.runs.get(number) for number in dict.fromkeys(run_ids)]
    finished = [(run, get_result(run, "no result to compare")) for run in runs]
    changed = find_changes(store.database, [run.rests_on for run in runs])
    maneuvers = {run.maneuver_id: store.maneuvers.get(run.maneuver_id) for run, _ in finished}
    columns = [
        _build_run_column(run, result, maneuvers, since)
        for (run, result), since in zip(finished, changed, strict=True)
    ]
    fuel = next(iter(maneuvers.values())).condition.fuel_fraction
    predictions = [store.predictions.get(number) for number in dict.fromkeys(prediction_ids)]
    columns += [_build_prediction_column(store, prediction, fuel) for prediction in predictions]
    columns += _build_residualized_columns(finished, predictions)
    names = _sort_names(parameter.name for _, result in finished for parameter in result.parameters)
    sources = tuple(column.source for column in columns)
    rows = tuple(_build_row(name, columns) for name in names)
    return Comparison(
        maneuver_ids=tuple(maneuvers),
        sources=sources,
        rows=rows,
        pairs=compare_pairs(sources, rows),
        setup=compare_setups(sources, {run.id: run for run, _ in finished if run.id is not None}),
        runs_verdict=count_run_agreement(rows),
        prediction_verdicts=count_prediction_agreement(sources, rows),
    )


def list_coefficients(comparison: Comparison) -> tuple[str, ...]:
    """List the coefficients whose derivatives are compared, e.g. ``Cm``."""
    return tuple(dict.fromkeys(row.name.partition("_")[0] for row in comparison.rows))


def select_coefficient(comparison: Comparison, coefficient: str | None) -> Comparison:
    """Select the derivatives of one coefficient, e.g. ``Cm``; all with None.

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
            f"{', '.join(list_coefficients(comparison))}",
            code="unknown-coefficient",
            coefficient=coefficient,
        )
    return replace(
        comparison,
        rows=rows,
        runs_verdict=count_run_agreement(rows),
        prediction_verdicts=count_prediction_agreement(comparison.sources, rows),
    )


def _build_run_column(
    run: EstimationRun,
    result: RunResult,
    maneuvers: dict[int, Maneuver],
    changed: tuple[str, ...],
) -> _Column:
    key = f"run-{run.id}"
    # the maneuver is named only where there are several
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


def _build_prediction_column(
    store: Store, prediction: DerivativePrediction, fuel: float
) -> _Column:
    key = f"prediction-{prediction.id}"
    return _Column(
        ComparedSource(
            key=key, label=prediction.source, kind=PREDICTED, prediction_id=prediction.id
        ),
        {
            name: SourceValue(key=key, value=value, std_error=error)
            for name, (value, error) in interpolate_prediction(store, prediction, fuel).items()
        },
    )


def _build_residualized_columns(
    finished: list[tuple[EstimationRun, RunResult]], predictions: list[DerivativePrediction]
) -> list[_Column]:
    """List residualised predictions stored with runs, each once."""
    labels = {prediction.id: prediction.source for prediction in predictions}
    columns: list[_Column] = []
    shown: list[dict[str, float]] = []
    for run, result in finished:
        values = result.residualized_prediction
        if values is None or result.prediction_id not in labels or values in shown:
            continue
        shown.append(values)
        key = f"residualized-{result.prediction_id}-{run.id}"
        # the run is named only where there are several conditions
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


def _build_row(name: str, columns: list[_Column]) -> Row:
    estimates = [column.values.get(name) for column in columns if not column.source.is_prediction]
    largest = find_largest_difference(combinations(estimates, 2))
    return Row(
        name=name,
        label=describe(name).label,
        values=tuple(
            _add_difference(column.values.get(name), estimates)
            if column.source.is_prediction
            else column.values.get(name)
            for column in columns
        ),
        consistent=is_consistent(largest),
        max_difference_sigma=largest,
        **average_estimates(estimates),
    )


def _add_difference(
    predicted: SourceValue | None, estimates: Sequence[SourceValue | None]
) -> SourceValue | None:
    """Add to a predicted value its largest difference from the estimates."""
    if predicted is None:
        return None
    largest = find_largest_difference((predicted, estimate) for estimate in estimates)
    return replace(predicted, difference_sigma=largest, consistent=is_consistent(largest))


_VARIABLES = ("alpha", "q", "eta", "etadot")


def _sort_names(names: Iterable[str]) -> list[str]:
    """Sort names as in a table of derivatives; delays last."""
    unique = list(dict.fromkeys(names))
    position = {name: number for number, name in enumerate(unique)}

    def rank(name: str) -> tuple[int, int, int, int, int]:
        coefficient, _, variable = name.partition("_")
        row = {"CZ": 0, "Cm": 1}.get(coefficient, 2 if coefficient.startswith("CQ") else 3)
        kind, mode = _split_mode(variable)
        column = _VARIABLES.index(kind) if kind in _VARIABLES else len(_VARIABLES)
        inputs_stay = position[name] if column == len(_VARIABLES) else 0
        return row, _split_mode(coefficient)[1], column, mode, inputs_stay

    return sorted(unique, key=rank)


def _split_mode(text: str) -> tuple[str, int]:
    letters = text.rstrip("0123456789")
    digits = text[len(letters) :]
    return letters, int(digits) if digits else -1
