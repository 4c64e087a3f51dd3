"""Versions of global models: stored under a number, sliced, and used as predictions."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from flexsid.errors import BadInput, Conflict
from flexsid.records.aircraft import DerivativePrediction
from flexsid.records.decision import Decision, LimitedQuantity
from flexsid.records.global_model import (
    DerivativeChange,
    DerivativeSlice,
    EnvelopeCoverage,
    GlobalModelResult,
    GlobalModelVersion,
    SlicePoint,
    VersionDifferences,
    VersionedRun,
)
from flexsid.records.run import EstimationRun
from flexsid.storage.encoding import decode, encode
from flexsid.storage.store import Store
from flexsid.sysid.model.derivatives import list_derivative_names
from flexsid.workflow.aircraft.axes import find_body, list_axis_surfaces
from flexsid.workflow.global_model.computation import predict_before_flight, predict_derivatives
from flexsid.workflow.model_structures.baselines import (
    find_approved_global_model,
    read_quantities,
)
from flexsid.workflow.model_structures.model_structures import describe_derivative_state, hash_run

# --- Versions of global models: stored under a number, compared, and used where approved ----------


def add_version(
    store: Store,
    result: GlobalModelResult,
    *,
    prediction_id: int | None,
    label: str,
    note: str,
    author: str,
) -> GlobalModelVersion:
    """Store a global model under the next number of its aircraft and axis.

    Raises
    ------
    Conflict
        If the newest version is of the same result.
    """
    summary = result.summary
    content = np.frombuffer(json.dumps(encode(result), sort_keys=True).encode(), dtype=np.uint8)
    with store.transaction():
        store.aircraft.get(summary.aircraft_id)  # locked: numbers are given once
        runs = [store.runs.get(run.run_id) for run in summary.runs]
        axis = runs[0].structure.axis
        known = store.global_model_versions.find(aircraft_id=summary.aircraft_id, axis=axis)
        stored = store.arrays.put(content)
        newest = max(known, key=lambda one: one.version, default=None)
        if newest is not None and newest.result == stored:
            raise Conflict(
                f"this global model is version {newest.version}, '{newest.label}', already",
                code="already-exists",
                global_model_id=newest.id,
            )
        return store.global_model_versions.add(
            GlobalModelVersion(
                aircraft_id=summary.aircraft_id,
                axis=axis,
                version=1 if newest is None else newest.version + 1,
                label=label,
                note=note,
                author=author,
                sentence=summary.sentence,
                variables=tuple(one.quantity for one in summary.variables),
                prediction_id=prediction_id,
                runs=tuple(
                    VersionedRun(run_id=one.run_id, hash=hash_run(run), is_outlying=one.is_outlying)
                    for one, run in zip(summary.runs, runs, strict=True)
                ),
                result=stored,
            )
        )


def find_decision(store: Store, version: GlobalModelVersion) -> Decision | None:
    """Return the newest decision about a version; None if it was not proposed."""
    known = store.decisions.find(aircraft_id=version.aircraft_id)
    found = [one for one in known if one.proposal.global_model_id == version.id]
    return found[-1] if found else None


def load_result(store: Store, version: GlobalModelVersion) -> GlobalModelResult:
    """Load the global model of a version."""
    content = json.loads(store.arrays.get(version.result).tobytes())
    return decode(GlobalModelResult, content)


def compare_versions(
    store: Store, before: GlobalModelVersion, after: GlobalModelVersion
) -> VersionDifferences:
    """Compare the runs of two versions, and their derivatives at the centre of the later one.

    Derivatives are NaN-free: one that a version lacks, or whose condition it did not fly, is
    None. Runs with another hash were estimated again under the same number.

    Raises
    ------
    BadInput
        If the versions are of different aircraft or axes.
    """
    if (before.aircraft_id, before.axis) != (after.aircraft_id, after.axis):
        raise BadInput(
            f"versions {before.id} and {after.id} are of different aircraft or axes; compare "
            "versions of one aircraft and axis",
            code="different-aircraft",
        )
    was = {run.run_id: run for run in before.runs}
    now = {run.run_id: run for run in after.runs}
    both = [number for number in now if number in was]
    results = load_result(store, before), load_result(store, after)
    condition = dict(zip(after.variables, results[1].summary.centre, strict=True))
    found = [_predict_at(one, condition) for one in results]
    return VersionDifferences(
        before_id=before.id or 0,
        after_id=after.id or 0,
        variables_before=before.variables,
        variables_after=after.variables,
        added_run_ids=tuple(number for number in now if number not in was),
        removed_run_ids=tuple(number for number in was if number not in now),
        changed_run_ids=tuple(n for n in both if now[n].hash != was[n].hash),
        outlying_before=tuple(n for n in was if was[n].is_outlying),
        outlying_after=tuple(n for n in now if now[n].is_outlying),
        derivatives=tuple(
            DerivativeChange(
                name=name,
                before=found[0].get(name, (None, None))[0],
                before_std=found[0].get(name, (None, None))[1],
                after=found[1].get(name, (None, None))[0],
                after_std=found[1].get(name, (None, None))[1],
            )
            for name in dict.fromkeys((*found[1], *found[0]))
        ),
    )


def add_default_priors(store: Store, run: EstimationRun) -> EstimationRun:
    """Add the priors of the approved global model to a run that names no prediction for them.

    Parameters
    ----------
    store
        Database.
    run
        Requests priors (``prior_spread``) without a prediction.

    Returns
    -------
    EstimationRun
        With mean and standard deviation of its free derivatives at the condition of its maneuver;
        the deviation is that of a further run without noise: the standard error of the global
        model with the run-to-run scatter. Unchanged where no global model is approved, it has
        other modes (derivatives include the static response of omitted modes), or it did not fly
        the condition. Priors that the run names remain.
    """
    structure, settings = run.structure, run.settings
    if settings.prior_spread is None or run.prediction_id is not None:
        return run
    maneuver = store.maneuvers.get(run.maneuver_id)
    version = find_approved_global_model(store, maneuver.aircraft_id, structure.axis)
    if version is None:
        return run
    result = load_result(store, version)
    if result.summary.modes != structure.modes:
        return run
    quantities = read_quantities(maneuver)
    at = _predict_at(result, {one: v for one, v in quantities.items() if v is not None})
    scatter = dict(zip(result.model.names, result.model.scatter.tolist(), strict=True))
    body = find_body(structure.axis)
    inputs = structure.inputs or list_axis_surfaces(store.aircraft.get(maneuver.aircraft_id), body)
    priors = {
        name: (at[name][0], float(np.hypot(at[name][1], scatter[name])))
        for name in list_derivative_names(structure.modes, inputs, body)
        if name in at and describe_derivative_state(structure, name) == "free"
    }
    return replace(run, settings=replace(settings, priors=priors | settings.priors))


def _predict_at(
    result: GlobalModelResult, condition: dict[LimitedQuantity, float]
) -> dict[str, tuple[float, float]]:
    """Predict values and standard errors at a condition; empty where it was not flown."""
    variables = [one.quantity for one in result.summary.variables]
    if any(one not in condition for one in variables):
        return {}
    point = np.array([[condition[one] for one in variables]])
    if result.model.basis.is_extrapolated(point)[0]:
        return {}
    values, covariance = predict_derivatives(result, point)
    std = np.sqrt(np.diag(covariance[0]) + result.modal_std**2)
    return {
        name: (float(value), float(error))
        for name, value, error in zip(result.model.names, values[0], std, strict=True)
    }


# --- Slices and coverage of a global model, for its figures and tables ----------------------------

_POINTS = 81  # of a slice
_MARGIN = 0.1  # of the flown range, drawn on either side as extrapolation
_CELLS = 41  # of the coverage, in each variable


def slice_derivative(
    result: GlobalModelResult,
    name: str,
    along: LimitedQuantity | None = None,
    condition: Sequence[float] = (),
) -> DerivativeSlice:
    """Compute one derivative along one variable, with the estimates of the runs.

    Parameters
    ----------
    result
        The global model.
    name
        Derivative, e.g. ``Cm_alpha``.
    along
        Variable; the first one by default.
    condition
        Value of every variable where the others are held, in SI; the centre by default.

    Notes
    -----
    Estimates were made at other values of the other variables: each is moved by the difference
    of the model between its condition and that of the slice (partial residuals).

    Raises
    ------
    BadInput
        If the model does not have the derivative or the variable, or not so many variables.
    """
    model, summary = result.model, result.summary
    variables = tuple(one.quantity for one in summary.variables)
    if name not in model.names:
        raise BadInput(
            f"the global model does not have '{name}'; it has {', '.join(model.names)}",
            code="unknown-derivative",
            derivative=name,
        )
    along = variables[0] if along is None else along
    if along not in variables:
        raise BadInput(
            f"{along.value} is not a variable of the global model; select one of "
            f"{', '.join(variables)}",
            code="unknown-variable",
        )
    if condition and len(condition) != len(variables):
        raise BadInput(
            f"{len(condition)} values are given; expected one for each of {', '.join(variables)}",
            code="bad-condition",
        )
    k, axis = model.names.index(name), variables.index(along)
    held = np.array(condition or summary.centre)
    low, high = model.basis.lowest[axis], model.basis.highest[axis]
    margin = _MARGIN * (high - low)
    conditions = np.tile(held, (_POINTS, 1))
    conditions[:, axis] = np.linspace(low - margin, high + margin, _POINTS)
    if along is LimitedQuantity.FUEL:
        conditions[:, axis] = np.linspace(max(0.0, low - margin), min(1.0, high + margin), _POINTS)
    values, covariance = predict_derivatives(result, conditions)
    std = np.sqrt(covariance[:, k, k] + result.modal_std[k] ** 2)
    predicted = None
    if result.prediction is not None:
        own = predict_before_flight(result, conditions)[:, k]
        predicted = own if np.isfinite(own).all() else None
    return DerivativeSlice(
        name=name,
        along=along,
        variables=variables,
        condition=tuple(held.tolist()),
        x=conditions[:, axis],
        values=values[:, k],
        std_errors=std,
        scatter_std=np.hypot(std, model.scatter[k]),
        is_extrapolated=model.basis.is_extrapolated(conditions),
        predicted=predicted,
        prediction_source=None if result.prediction is None else result.prediction.source,
        points=_move_estimates(result, k, axis, held),
    )


def compute_coverage(result: GlobalModelResult) -> EnvelopeCoverage:
    """Compute the standard error over the envelope relative to its smallest."""
    basis, summary = result.model.basis, result.summary
    held = np.array(summary.centre)
    shown = range(min(2, held.size))
    axes = [np.linspace(basis.lowest[k], basis.highest[k], _CELLS) for k in shown]
    if len(axes) == 1:
        axes.append(np.zeros(1))
    x, y = np.meshgrid(*axes)
    conditions = np.tile(held, (x.size, 1))
    for k, values in zip(shown, (x, y), strict=False):
        conditions[:, k] = values.ravel()
    _, covariance = result.model.predict(conditions)
    variance = np.diagonal(covariance, axis1=1, axis2=2)
    relative = np.sqrt((variance / variance.min(axis=0)).mean(axis=1))
    ratio = np.where(basis.is_extrapolated(conditions), np.nan, relative)
    return EnvelopeCoverage(
        variables=tuple(one.quantity for one in summary.variables),
        x=axes[0],
        y=axes[1],
        ratio=ratio.reshape(x.shape),
        runs=summary.runs,
        next_condition=summary.next_condition,
    )


def _move_estimates(
    result: GlobalModelResult, k: int, axis: int, held: np.ndarray
) -> tuple[SlicePoint, ...]:
    """Move the estimates of one derivative along the model to a slice."""
    runs = result.summary.runs
    flown = np.array([run.condition for run in runs])
    moved = np.tile(held, (len(runs), 1))
    moved[:, axis] = flown[:, axis]
    change = (
        predict_derivatives(result, moved)[0][:, k] - predict_derivatives(result, flown)[0][:, k]
    )
    return tuple(
        SlicePoint(
            run_id=run.run_id,
            maneuver_id=run.maneuver_id,
            label=f"{run.method} {run.run_id}, {run.label}",
            kind=run.method,
            x=float(moved[number, axis]),
            value=float(result.values[number, k] + change[number]),
            std_error=float(result.std_errors[number, k]),
            is_outlying=run.is_outlying,
        )
        for number, run in enumerate(runs)
        if np.isfinite(result.values[number, k])
    )


# --- A global model at one condition as a prediction: priors, pre-flight simulation, comparison

_KIND = "flight"
_FUELS = 9  # of the table; polynomials of the third degree need four


def store_global_prediction(
    store: Store, result: GlobalModelResult, source: str, condition: Sequence[float] = ()
) -> DerivativePrediction:
    """Store the derivatives of a global model as a prediction over the flown fuel weights.

    Parameters
    ----------
    store
        Database.
    result
        The global model.
    source
        Name of the prediction.
    condition
        Value of every variable, in SI; that of fuel is not used. The mean condition of the
        runs by default.

    Raises
    ------
    BadInput
        If there are not so many variables, or the condition was not flown.
    Conflict
        If the aircraft has a prediction of that name.
    """
    summary, basis = result.summary, result.model.basis
    variables = [one.quantity for one in summary.variables]
    if condition and len(condition) != len(variables):
        raise BadInput(
            f"{len(condition)} values are given; expected one for each of {', '.join(variables)}",
            code="bad-condition",
        )
    if store.predictions.find(aircraft_id=summary.aircraft_id, source=source):
        raise Conflict(
            f"Prediction '{source}' is there already; give this one another name.",
            code="already-exists",
        )
    conditions = np.array([condition or summary.centre], dtype=float)
    fuel = np.array([result.fuel])
    if LimitedQuantity.FUEL in variables:
        axis = variables.index(LimitedQuantity.FUEL)
        fuel = np.linspace(basis.lowest[axis], basis.highest[axis], _FUELS)
        conditions = np.repeat(conditions, _FUELS, axis=0)
        conditions[:, axis] = fuel
    is_flown = ~basis.is_extrapolated(conditions)
    held = [one for one in variables if one is not LimitedQuantity.FUEL]
    at = ", ".join(f"{one.value} = {conditions[0, variables.index(one)]:.6g}" for one in held)
    if not is_flown.any():
        raise BadInput(
            f"the condition {at} lies outside the flown ones; select one inside",
            code="not-flown",
        )
    fuel, conditions = fuel[is_flown], conditions[is_flown]
    values, covariance = predict_derivatives(result, conditions)
    std = np.sqrt(np.diagonal(covariance, axis1=1, axis2=2) + result.modal_std**2)
    runs = ", ".join(str(run.run_id) for run in summary.runs if not run.is_outlying)
    return store.predictions.add(
        DerivativePrediction(
            aircraft_id=summary.aircraft_id,
            source=source,
            kind=_KIND,
            fuel=tuple(fuel.tolist()),
            names=result.model.names,
            values=store.arrays.put(values),
            std_errors=store.arrays.put(std),
            note=f"global model{' at ' + at if at else ''} of runs {runs}",
        )
    )
