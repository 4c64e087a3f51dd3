"""Estimates of all runs of a global model, with their covariances and flight conditions."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from flexsid.allowed import Allowed, Id, RunIds
from flexsid.errors import BadInput, NotIdentifiable
from flexsid.records.aircraft import DerivativePrediction
from flexsid.records.decision import LimitedQuantity
from flexsid.records.global_model import PredictionTable, RunLabel
from flexsid.records.maneuver import Maneuver
from flexsid.records.run import EstimationRun
from flexsid.storage.store import Store
from flexsid.sysid.global_model.fit import RunEstimates
from flexsid.sysid.global_model.selection import LEAST_RUNS
from flexsid.sysid.model.derivatives import is_derivative
from flexsid.sysid.signals import interpolate
from flexsid.workflow.aircraft.derivative_predictions import select_by_id
from flexsid.workflow.aircraft.written_back import refuse_counted_twice
from flexsid.workflow.model_structures.baselines import read_quantities
from flexsid.workflow.model_structures.model_structures import get_result

_MOST_RUNS = 5000  # minutes, and a request of 30 kB
_LEAST_ESTIMATES = 3  # of a derivative: fewer have no scatter
_LEAST_FLIGHTS = 3  # to leave one out; otherwise each maneuver


@dataclass(frozen=True, slots=True, kw_only=True)
class GlobalModelQuery:
    """Runs, the variables of the envelope, and a prediction that may be the mean of the model."""

    run_ids: RunIds
    variables: Annotated[
        tuple[LimitedQuantity, ...],
        Allowed(
            text="Variables of the envelope: dynamic_pressure_pa, fuel_fraction, airspeed_m_s, "
            "airspeed_ratio or alpha_rad."
        ),
    ] = (LimitedQuantity.DYNAMIC_PRESSURE, LimitedQuantity.FUEL)
    prediction_id: Annotated[
        Id | None,
        Allowed(text="Prediction that is compared, and the mean where that predicts better."),
    ] = None

    def __post_init__(self) -> None:
        """Sort the runs: the same set is the same request."""
        object.__setattr__(self, "run_ids", tuple(sorted(set(self.run_ids))))
        object.__setattr__(self, "variables", tuple(dict.fromkeys(self.variables)))


@dataclass(frozen=True, slots=True, eq=False)
class GlobalModelTask:
    """All that the fit of a global model needs; can be pickled.

    ``modal_std`` (p,) is common to all runs, ``omitted`` are derivatives of too few runs.
    """

    query: GlobalModelQuery
    aircraft_id: int
    modes: tuple[int, ...]
    runs: tuple[RunLabel, ...]
    estimates: RunEstimates
    modal_std: np.ndarray
    fuel: np.ndarray
    n_maneuvers: int
    n_flights: int
    omitted: tuple[str, ...]
    prediction: PredictionTable | None


def identify_global_model(store: Store, query: GlobalModelQuery) -> tuple[object, ...]:
    """Check a query, and return all records on which its result depends.

    Raises
    ------
    BadInput
        If there are too few or too many runs, they are of several aircraft, axes or sets of
        modes, or a condition is unknown.
    UnknownRecord
        If a run does not exist.
    Conflict
        If a run has no result, or it was altered.
    """
    runs, maneuvers, prediction = _read(store, query)
    return runs, maneuvers, prediction


def prepare_global_model(store: Store, query: GlobalModelQuery) -> GlobalModelTask:
    """Collect the estimates of all runs.

    Raises
    ------
    BadInput, UnknownRecord, Conflict
        As ``identify_global_model``.
    NotIdentifiable
        If the covariance of a run is singular, naming the run.
    """
    runs, maneuvers, prediction = _read(store, query)
    found = [_read_estimates(store, run) for run in runs]
    counts = Counter(name for values, _, _ in found for name in values)
    names = tuple(name for name, count in counts.items() if count >= _LEAST_ESTIMATES)
    if not names:
        raise BadInput(
            f"no derivative was estimated by {_LEAST_ESTIMATES} of these runs; select runs of one "
            "model structure",
            code="no-common-derivative",
        )
    place = {name: k for k, name in enumerate(names)}
    p = len(names)
    values, modal = np.full((len(runs), p), np.nan), np.full((len(runs), p), np.nan)
    covariances = np.zeros((len(runs), p, p))
    for number, (own, covariance, modal_std) in enumerate(found):
        selected = [k for k, name in enumerate(own) if name in place]
        at = [place[name] for name in own if name in place]
        values[number, at] = [own[name] for name in own if name in place]
        modal[number, at] = [modal_std[name] for name in own if name in place]
        covariances[number][np.ix_(at, at)] = covariance[np.ix_(selected, selected)]
    used = [{run.maneuver_id, *run.settings.additional_maneuver_ids} for run in runs]
    shares = Counter(number for own in used for number in own)
    by_id = {maneuver.id: maneuver for maneuver in maneuvers}
    own_maneuvers = [by_id[run.maneuver_id] for run in runs]
    flights = np.array([maneuver.flight_id for maneuver in own_maneuvers])
    n_flights = np.unique(flights).size
    if n_flights < _LEAST_FLIGHTS:
        flights = np.array([run.maneuver_id for run in runs])
    fuel = np.array([_average(own, by_id, LimitedQuantity.FUEL) for own in used])
    conditions = np.array([[_average(own, by_id, v) for v in query.variables] for own in used])
    table = None if prediction is None else _tabulate(store, prediction, names)
    return GlobalModelTask(
        query=query,
        aircraft_id=own_maneuvers[0].aircraft_id,
        modes=runs[0].structure.modes,
        runs=tuple(
            RunLabel(
                run_id=run.id or 0,
                maneuver_id=run.maneuver_id,
                method=run.method.value,
                label=maneuver.label,
            )
            for run, maneuver in zip(runs, own_maneuvers, strict=True)
        ),
        estimates=RunEstimates(
            *(names, values, covariances, conditions),
            mean=np.zeros_like(values),
            flights=flights,
            weights=np.array([1.0 / max(shares[number] for number in own) for own in used]),
        ),
        modal_std=np.nanmedian(modal, axis=0),
        fuel=fuel,
        n_maneuvers=len(by_id),
        n_flights=int(n_flights),
        omitted=tuple(name for name in counts if name not in place),
        prediction=table,
    )


def interpolate_table(table: PredictionTable, fuel: np.ndarray) -> np.ndarray:
    """Interpolate a prediction (n, p) over fuel; NaN where a derivative is not predicted."""
    return interpolate(table.fuel, table.values, fuel)


def _read(
    store: Store, query: GlobalModelQuery
) -> tuple[list[EstimationRun], list[Maneuver], DerivativePrediction | None]:
    if not LEAST_RUNS <= len(query.run_ids) <= _MOST_RUNS:
        raise BadInput(
            f"{len(query.run_ids)} runs are selected; expected {LEAST_RUNS} to {_MOST_RUNS}",
            code="bad-number-of-runs",
        )
    if not query.variables:
        raise BadInput(
            "no variable is selected; select at least one, such as dynamic_pressure_pa",
            code="no-variable",
        )
    runs = [store.runs.get(number) for number in query.run_ids]
    for run in runs:
        get_result(run)
    used = {number for run in runs for number in run.settings.additional_maneuver_ids}
    maneuvers = [store.maneuvers.get(n) for n in sorted(used | {r.maneuver_id for r in runs})]
    _refuse_mixture(runs, maneuvers)
    refuse_counted_twice(store, runs)
    for maneuver in maneuvers:
        quantities = read_quantities(maneuver)
        for variable in query.variables:
            if quantities[variable] is None:
                raise BadInput(
                    f"{variable.value} of maneuver {maneuver.id} ({maneuver.label}) is unknown; "
                    "select another variable",
                    code="unknown-condition",
                    maneuver_id=maneuver.id,
                )
    if query.prediction_id is None:
        return runs, maneuvers, None
    known = store.predictions.find(aircraft_id=maneuvers[0].aircraft_id)
    prediction = select_by_id(known, query.prediction_id, "prediction", code="wrong-prediction")
    return runs, maneuvers, prediction


def _refuse_mixture(runs: Sequence[EstimationRun], maneuvers: Sequence[Maneuver]) -> None:
    """Refuse runs whose derivatives have different meanings."""
    if len({maneuver.aircraft_id for maneuver in maneuvers}) > 1:
        raise BadInput(
            "the runs belong to different aircraft; select runs of one aircraft",
            code="different-aircraft",
        )
    first = runs[0]
    for run in runs:
        if run.settings.aerodynamics.is_shaped:
            raise BadInput(
                f"run {run.id} has derivatives with a frequency shape; select quasi-steady runs",
                code="not-with-shape",
                run_id=run.id,
            )
        if run.structure.axis != first.structure.axis:
            raise BadInput(
                f"runs {first.id} and {run.id} are of different axes; select runs of one axis",
                code="mixed-axes",
                run_id=run.id,
            )
        if run.structure.modes != first.structure.modes:
            raise BadInput(
                f"run {run.id} has modes {_join(run.structure.modes)} and run {first.id} has "
                f"{_join(first.structure.modes)}; derivatives include the static response of "
                "omitted modes, so select runs with the same modes",
                code="mixed-modes",
                run_id=run.id,
            )


def _join(numbers: Sequence[int]) -> str:
    return ", ".join(map(str, numbers)) or "none"


def _read_estimates(
    store: Store, run: EstimationRun
) -> tuple[dict[str, float], np.ndarray, dict[str, float]]:
    """Read derivatives with a standard error, their covariance, and the modal part by name."""
    result = get_result(run)
    own = [
        k
        for k, one in enumerate(result.parameters)
        if one.std_error and np.isfinite(one.value) and is_derivative(one.name)
    ]
    covariance = np.asarray(store.arrays.get(result.covariance))[np.ix_(own, own)]
    sigma = np.sqrt(np.diag(covariance))
    try:
        np.linalg.cholesky(covariance / np.outer(sigma, sigma))
    except np.linalg.LinAlgError as error:
        raise NotIdentifiable(
            f"the covariance of run {run.id} is singular; exclude it, or estimate it again with "
            "fewer free derivatives"
        ) from error
    selected = [result.parameters[k] for k in own]
    values = {one.name: one.value for one in selected}
    return values, covariance, {one.name: one.held_std for one in selected}


def _average(
    maneuver_ids: set[int], by_id: dict[int | None, Maneuver], quantity: LimitedQuantity
) -> float:
    """Average a condition over the maneuvers of a run."""
    values = [read_quantities(by_id[number])[quantity] for number in sorted(maneuver_ids)]
    return float(np.mean([value for value in values if value is not None]))


def _tabulate(
    store: Store, prediction: DerivativePrediction, names: Sequence[str]
) -> PredictionTable:
    known = np.asarray(store.arrays.get(prediction.values), dtype=float)
    values = np.full((len(prediction.fuel), len(names)), np.nan)
    for k, name in enumerate(names):
        if name in prediction.names:
            values[:, k] = known[:, prediction.names.index(name)]
    return PredictionTable(
        source=prediction.source, fuel=np.array(prediction.fuel, dtype=float), values=values
    )
