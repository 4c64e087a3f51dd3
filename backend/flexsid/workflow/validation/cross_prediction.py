"""Matrix of cross-predictions: every maneuver predicted by the model of every run."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from flexsid.allowed import Allowed, Id, RunIds
from flexsid.errors import BadInput, FlexsidError
from flexsid.records.run import EstimationRun, Progress, ReportProgress
from flexsid.records.validation import CrossPrediction, CrossPredictionMatrix, ValidatedSource
from flexsid.storage.store import Store
from flexsid.workflow.model_structures.run_results import get_result
from flexsid.workflow.runs.run_identity import list_run_contents
from flexsid.workflow.validation.predicted_maneuver import measure_outputs, predict_maneuver

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
