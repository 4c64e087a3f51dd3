"""Compare derivatives of runs and predictions (Fig. 17), with joint errors."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from enum import Enum
from itertools import combinations
from typing import Any

import numpy as np
from jaxtyping import Float
from scipy import special

from flexsid.errors import BadInput
from flexsid.nomenclature import describe
from flexsid.records.aircraft import DerivativePrediction
from flexsid.records.maneuver import Maneuver
from flexsid.records.run import EstimationRun, RunResult
from flexsid.records.validation import (
    PREDICTED,
    AgreementCount,
    ComparedSource,
    Comparison,
    Pair,
    Row,
    Setup,
    SourceValue,
)
from flexsid.storage.content import find_changes
from flexsid.storage.repository import read_once
from flexsid.storage.store import Store
from flexsid.sysid.estimation.agreement import (
    compute_difference_variance,
    compute_joint_covariance,
    compute_limit,
)
from flexsid.sysid.model.derivatives import RIGID_BODIES
from flexsid.workflow.aircraft.derivative_predictions import interpolate_prediction
from flexsid.workflow.comparison.error_causes import load_components
from flexsid.workflow.model_structures.model_structures import get_result

# --- Joint errors of runs: the covariance between their estimates of every derivative -------------


def compute_covariances(
    store: Store, finished: Sequence[tuple[EstimationRun, RunResult]], names: Sequence[str]
) -> Mapping[str, Float[np.ndarray, "n_runs n_runs"]]:
    """Compute the covariance between runs by derivative; NaN without a standard error.

    Runs of one maneuver share its noise, those with the same prior means their errors, and all
    runs the errors of modal table, mass, airspeed and density. Runs of earlier releases share the
    latter only.
    """
    place = {name: k for k, name in enumerate(names)}
    held = np.zeros((len(names), len(finished)))
    std_errors, components, maneuvers = [], [], []
    for number, (_, result) in enumerate(finished):
        at = [place[parameter.name] for parameter in result.parameters]
        total = np.full(len(names), np.nan)
        total[at] = [p.std_error or np.nan for p in result.parameters]
        held[at, number] = [p.held_std for p in result.parameters]
        std_errors.append(np.sqrt(np.maximum(total**2 - held[:, number] ** 2, 0.0)))
        found = load_components(store, result)
        if found is not None:
            from_names = np.zeros((len(names), len(at)))
            from_names[at, np.arange(len(at))] = 1.0
            found = found.transform(from_names)
        components.append(found)
        causes = result.error_causes
        maneuvers.append(() if causes is None else causes.maneuver_ids)
    covariance = compute_joint_covariance(std_errors, components, maneuvers)
    covariance += held[:, :, None] * held[:, None, :]
    return dict(zip(names, covariance, strict=True))


# --- Compare derivatives of runs and predictions (Fig. 17) ----------------------------------------

_SINGULAR = 1e-8  # of the largest singular value: estimates that are numerically the same
_COEFFICIENTS = [name for body in RIGID_BODIES.values() for name in body.coefficients]
_VARIABLES = [*(m for body in RIGID_BODIES.values() for m in body.motions), "eta", "etadot"]


@dataclass(frozen=True, slots=True)
class _Column:
    source: ComparedSource
    values: dict[str, SourceValue]


@dataclass(frozen=True, slots=True)
class _JointRow:
    """Values of one derivative by all sources, and their covariance; NaN: no standard error."""

    values: tuple[SourceValue | None, ...]
    covariance: Float[np.ndarray, "n_sources n_sources"]

    def is_judged(self, i: int) -> bool:
        """Whether the source has a value with a standard error."""
        return self.values[i] is not None and bool(self.covariance[i, i] > 0.0)

    def normalise_difference(self, i: int, j: int) -> float | None:
        """Divide a difference by its standard error."""
        a, b = self.values[i], self.values[j]
        if a is None or b is None or not (self.is_judged(i) and self.is_judged(j)):
            return None
        return (a.value - b.value) / compute_difference_variance(self.covariance, (i, j)) ** 0.5

    def find_largest_difference(
        self, couples: Iterable[tuple[int, int]]
    ) -> tuple[float | None, float | None]:
        """Find the largest difference of any couple, and the limit for correct estimates."""
        differences = {
            pair: abs(found)
            for pair in couples
            if (found := self.normalise_difference(*pair)) is not None
        }
        if not differences:
            return None, None
        index = sorted({i for pair in differences for i in pair})
        pairs = [(index.index(i), index.index(j)) for i, j in differences]
        limit = compute_limit(self.covariance[np.ix_(index, index)], pairs)
        return max(differences.values()), limit


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
    Two estimates a and b are judged by |a - b| / sqrt(var(a - b)). Runs of one maneuver share its
    noise, runs with the same prior its error, and all runs the errors of the modal table: their
    covariance is part of var(a - b). Two agree within 2 standard errors of the difference. Of more
    runs the largest difference has the limit that correct estimates exceed as often, 4.6 %. Runs
    are judged among each other, and each prediction against the runs: what was predicted does not
    change how the runs agree. A source without standard errors is shown, not judged.
    """
    key = ("comparison", tuple(run_ids), tuple(prediction_ids))
    return read_once(key, lambda: _compare(store, run_ids, prediction_ids))


def _compare(store: Store, run_ids: Sequence[int], prediction_ids: Sequence[int]) -> Comparison:
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
    names = sort_names(parameter.name for _, result in finished for parameter in result.parameters)
    sources = tuple(column.source for column in columns)
    joint = _join_rows(store, finished, columns, names)
    rows = tuple(_build_row(name, columns, one) for name, one in zip(names, joint, strict=True))
    comparison = Comparison(
        maneuver_ids=tuple(maneuvers),
        sources=sources,
        rows=rows,
        pairs=_compare_pairs(sources, names, joint),
        setup=_compare_setups(sources, {run.id: run for run in runs if run.id is not None}),
    )
    return _select_rows(comparison, rows)


def list_coefficients(comparison: Comparison) -> tuple[str, ...]:
    """List the coefficients whose derivatives are compared, e.g. ``Cm``."""
    return tuple(dict.fromkeys(row.name.partition("_")[0] for row in comparison.rows))


def select_coefficient(comparison: Comparison, coefficient: str | None) -> Comparison:
    """Select the derivatives of one coefficient, e.g. ``Cm``, or the ``first``; all with None.

    Raises
    ------
    BadInput
        If there are none.
    """
    if coefficient is None:
        return comparison
    if coefficient == "first":
        coefficient = next(iter(list_coefficients(comparison)), coefficient)
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
                condition_std=parameter.condition_std,
                repeatability=parameter.repeatability,
                rests_on=parameter.rests_on,
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


def _join_rows(
    store: Store,
    finished: Sequence[tuple[EstimationRun, RunResult]],
    columns: Sequence[_Column],
    names: Sequence[str],
) -> list[_JointRow]:
    """Collect values and covariance of every derivative; predictions are independent."""
    of_runs = compute_covariances(store, finished, names)
    n_runs = len(finished)
    joint = []
    for name in names:
        values = tuple(column.values.get(name) for column in columns)
        errors = [np.nan if v is None or v.std_error is None else v.std_error for v in values]
        covariance = np.diag(np.square(errors))
        covariance[:n_runs, :n_runs] = of_runs[name]
        joint.append(_JointRow(values, covariance))
    return joint


def _build_row(name: str, columns: Sequence[_Column], joint: _JointRow) -> Row:
    runs = [k for k, column in enumerate(columns) if not column.source.is_prediction]
    largest, limit = joint.find_largest_difference(combinations(runs, 2))
    return Row(
        name=name,
        label=describe(name).label,
        values=tuple(
            _add_difference(value, *joint.find_largest_difference((k, run) for run in runs))
            if column.source.is_prediction
            else value
            for k, (column, value) in enumerate(zip(columns, joint.values, strict=True))
        ),
        consistent=None if largest is None or limit is None else largest <= limit,
        max_difference_sigma=largest,
        limit_sigma=limit,
        **_average_estimates(joint, runs),
    )


def _add_difference(
    predicted: SourceValue | None, largest: float | None, limit: float | None
) -> SourceValue | None:
    """Add to a predicted value its largest difference from the estimates."""
    if predicted is None or largest is None or limit is None:
        return predicted
    return replace(predicted, difference_sigma=largest, consistent=largest <= limit)


def sort_names(names: Iterable[str]) -> list[str]:
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


def _average_estimates(joint: _JointRow, runs: Sequence[int]) -> dict[str, float | None]:
    """Compute the mean of estimates, weighted by their variances, and their scatter.

    Notes
    -----
    The scatter is d^T Cov(d)^-1 d of the differences d of the others from the first estimate.
    """
    judged = [k for k in runs if joint.is_judged(k)]
    if len(judged) < 2:
        return {}
    found = np.array([value.value for k in judged if (value := joint.values[k]) is not None])
    covariance = joint.covariance[np.ix_(judged, judged)]
    weights = 1.0 / np.diag(covariance)
    weights /= weights.sum()
    contrasts = np.eye(len(judged))[1:] - np.eye(len(judged))[0]
    of_differences = contrasts @ covariance @ contrasts.T
    of_differences[np.diag_indices_from(of_differences)] = [
        compute_difference_variance(covariance, (0, k)) for k in range(1, len(judged))
    ]
    difference = contrasts @ found
    solved = np.linalg.lstsq(of_differences, difference, rcond=_SINGULAR)[0]
    chi_square = float(difference @ solved)
    return {
        "mean": float(weights @ found),
        "mean_std_error": float(np.sqrt(weights @ covariance @ weights)),
        "chi_square": chi_square,
        "probability": float(special.chdtrc(len(judged) - 1, chi_square)),
    }


def _compare_pairs(
    sources: Sequence[ComparedSource], names: Sequence[str], joint: Sequence[_JointRow]
) -> tuple[Pair, ...]:
    """Compare every pair of sources by all derivatives with standard errors.

    Notes
    -----
    Normalised differences are taken as independent of each other. Estimates of one
    run are correlated, so the probability is a guide, not a test.
    """
    found: list[Pair] = []
    for (i, first), (j, second) in combinations(enumerate(sources), 2):
        differences = {
            name: difference
            for name, one in zip(names, joint, strict=True)
            if (difference := one.normalise_difference(i, j)) is not None
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
