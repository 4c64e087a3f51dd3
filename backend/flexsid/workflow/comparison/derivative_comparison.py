"""Compare derivatives of runs and predictions (Fig. 17)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from enum import Enum
from itertools import combinations
from typing import Any

import numpy as np
from scipy import special

from flexsid.errors import BadInput
from flexsid.nomenclature import describe
from flexsid.records.aircraft import DerivativePrediction
from flexsid.records.comparison import (
    PREDICTED,
    AgreementCount,
    ComparedSource,
    Comparison,
    Pair,
    Row,
    Setup,
    SourceValue,
)
from flexsid.records.maneuver import Maneuver
from flexsid.records.run import EstimationRun, RunResult
from flexsid.storage.content import find_changes
from flexsid.storage.store import Store
from flexsid.sysid.estimation.trend import fit_trend
from flexsid.sysid.model.axes import RIGID_BODIES
from flexsid.workflow.aircraft.derivative_predictions import interpolate_prediction
from flexsid.workflow.model_structures.run_results import get_result

CONSISTENT_SIGMA = 2.0
"""Two estimates agree when they differ by at most this many combined standard errors."""

_COEFFICIENTS = [name for body in RIGID_BODIES.values() for name in body.coefficients]
_VARIABLES = [*(m for body in RIGID_BODIES.values() for m in body.motions), "eta", "etadot"]


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
    Two estimates a and b are judged by |a - b| / sqrt(sigma_a^2 + sigma_b^2 - 2 t_a t_b), with
    the parts t of their errors that are due to the modal table, which all runs share. Apart from
    them they count as independent. Runs of one maneuver share its noise, so the measure is
    lenient for them. Runs are judged among each other, and each prediction against the runs: what
    was predicted does not change how the runs agree. A source without standard errors is shown,
    not judged.
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
    comparison = Comparison(
        maneuver_ids=tuple(maneuvers),
        sources=sources,
        rows=rows,
        pairs=_compare_pairs(sources, rows),
        setup=_compare_setups(sources, {run.id: run for run in runs if run.id is not None}),
    )
    return _select_rows(comparison, rows)


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
    return _select_rows(comparison, rows)


def _select_rows(comparison: Comparison, rows: tuple[Row, ...]) -> Comparison:
    """Select derivatives, and count how many of them agree."""

    def count(source: str | None, agreements: Iterable[bool | None]) -> AgreementCount:
        judged = [one for one in agreements if one is not None]
        return AgreementCount(source=source, n_judged=len(judged), n_consistent=sum(judged))

    predicted = {
        source.key: [row.values[index] for row in rows]
        for index, source in enumerate(comparison.sources)
        if source.is_prediction
    }
    return replace(
        comparison,
        rows=rows,
        runs_verdict=count(None, [row.consistent for row in rows]),
        prediction_verdicts=tuple(
            count(key, [None if value is None else value.consistent for value in column])
            for key, column in predicted.items()
        ),
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
            adequacy=result.adequacy.state,
        ),
        {
            parameter.name: SourceValue(
                key=key,
                value=parameter.value,
                std_error=parameter.std_error,
                modal_std=parameter.modal_std,
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
    largest, consistent = _find_largest_difference(combinations(estimates, 2))
    return Row(
        name=name,
        label=describe(name).label,
        values=tuple(
            _add_difference(column.values.get(name), estimates)
            if column.source.is_prediction
            else column.values.get(name)
            for column in columns
        ),
        consistent=consistent,
        max_difference_sigma=largest,
        **_average_estimates(estimates),
    )


def _add_difference(
    predicted: SourceValue | None, estimates: Sequence[SourceValue | None]
) -> SourceValue | None:
    """Add to a predicted value its largest difference from the estimates."""
    if predicted is None:
        return None
    largest, consistent = _find_largest_difference((predicted, one) for one in estimates)
    return replace(predicted, difference_sigma=largest, consistent=consistent)


def _sort_names(names: Iterable[str]) -> list[str]:
    """Sort names as in a table of derivatives; delays last."""
    unique = list(dict.fromkeys(names))
    position = {name: number for number, name in enumerate(unique)}

    def rank(name: str) -> tuple[int, int, int, int, int]:
        coefficient, _, variable = name.partition("_")
        last = len(_COEFFICIENTS) + (not coefficient.startswith("CQ"))
        row = _COEFFICIENTS.index(coefficient) if coefficient in _COEFFICIENTS else last
        kind, mode = _split_mode(variable)
        column = _VARIABLES.index(kind) if kind in _VARIABLES else len(_VARIABLES)
        inputs_stay = position[name] if column == len(_VARIABLES) else 0
        return row, _split_mode(coefficient)[1], column, mode, inputs_stay

    return sorted(unique, key=rank)


def _split_mode(text: str) -> tuple[str, int]:
    letters = text.rstrip("0123456789")
    digits = text[len(letters) :]
    return letters, int(digits) if digits else -1


def _find_largest_difference(
    couples: Iterable[tuple[SourceValue | None, SourceValue | None]],
) -> tuple[float | None, bool | None]:
    """Find the largest difference of any couple in combined standard errors, and judge it."""
    differences = [_normalise_difference(a, b) for a, b in couples]
    largest = max((abs(one) for one in differences if one is not None), default=None)
    return largest, None if largest is None else largest <= CONSISTENT_SIGMA


def _average_estimates(values: Sequence[SourceValue | None]) -> dict[str, float | None]:
    """Compute the weighted mean of estimates and the chi-square of their scatter."""
    judged = [(v.value, v.std_error) for v in values if v is not None and v.std_error]
    if len(judged) < 2:
        return {}
    found, errors = (np.array(part, dtype=float) for part in zip(*judged, strict=True))
    mean = fit_trend(np.zeros(found.size), found, errors, 0)
    return {
        "mean": float(mean.coefficients[0]),
        "mean_std_error": float(np.sqrt(mean.covariance[0, 0])),
        "chi_square": mean.chi_square,
        "probability": mean.probability,
    }


def _compare_pairs(sources: Sequence[ComparedSource], rows: Sequence[Row]) -> tuple[Pair, ...]:
    """Compare every pair of sources by all derivatives with standard errors.

    Notes
    -----
    Normalised differences are taken as independent of each other. Estimates of one
    run are correlated, so the probability is a guide, not a test.
    """
    found: list[Pair] = []
    for (i, first), (j, second) in combinations(enumerate(sources), 2):
        differences = {
            row.name: difference
            for row in rows
            if (difference := _normalise_difference(row.values[i], row.values[j])) is not None
        }
        if not differences:
            continue
        squares = float(sum(value**2 for value in differences.values()))
        worst = max(differences, key=lambda name: abs(differences[name]))
        found.append(
            Pair(
                first=first.key,
                second=second.key,
                n=len(differences),
                rms_sigma=float(np.sqrt(squares / len(differences))),
                chi_square=squares,
                probability=float(special.chdtrc(len(differences), squares)),
                worst=worst,
                worst_sigma=differences[worst],
            )
        )
    return tuple(found)


def _normalise_difference(a: SourceValue | None, b: SourceValue | None) -> float | None:
    """Divide a difference by its standard error; errors of the modal table are shared."""
    if a is None or b is None or a.std_error is None or b.std_error is None:
        return None
    shared = 2.0 * (a.modal_std or 0.0) * (b.modal_std or 0.0)
    variance = a.std_error**2 + b.std_error**2 - shared
    return (a.value - b.value) / variance**0.5 if variance > 0.0 else None


def _compare_setups(
    sources: Sequence[ComparedSource], runs: Mapping[int, EstimationRun]
) -> tuple[Setup, ...]:
    """List the settings in which the compared runs differ."""
    columns = [
        None
        if source.run_id is None or source.is_prediction
        else _list_settings(runs[source.run_id])
        for source in sources
    ]
    names = dict.fromkeys(name for column in columns if column is not None for name in column)
    rows: list[Setup] = []
    for name in names:
        values = tuple(None if column is None else column.get(name, "") for column in columns)
        if len({value for value in values if value is not None}) > 1:
            rows.append(Setup(name=name, values=values))
    return tuple(rows)


def _list_settings(run: EstimationRun) -> dict[str, str]:
    fields: dict[str, Any] = {
        "maneuver": run.maneuver_id,
        "method": run.method,
        **asdict(run.structure),
        **asdict(run.settings),
        "modal_table": run.modal_table_id,
        "damping_table": run.damping_table_id,
        "prediction": run.prediction_id,
        **{f"version of {name}": version for name, version in (run.versions or {}).items()},
    }
    return {name.replace("_", " "): _format(value) for name, value in fields.items()}


def _format(value: object) -> str:
    if value is None or value in ((), [], {}):
        return "–"
    if isinstance(value, Enum):
        return str(value.value)
    if isinstance(value, dict):
        return ", ".join(f"{name} {_format(one)}" for name, one in value.items())
    if isinstance(value, list | tuple):
        return ", ".join(map(_format, value))
    return f"{value:.6g}" if isinstance(value, float) else str(value)
