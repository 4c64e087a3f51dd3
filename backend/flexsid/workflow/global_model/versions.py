"""Versions of global models: stored under a number, compared, and used where approved."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np

from flexsid.errors import BadInput, Conflict
from flexsid.records.decision import Decision, LimitedQuantity
from flexsid.records.global_model import (
    DerivativeChange,
    GlobalModelResult,
    GlobalModelVersion,
    VersionDifferences,
    VersionedRun,
)
from flexsid.records.run import EstimationRun
from flexsid.storage.encoding import decode, encode
from flexsid.storage.store import Store
from flexsid.sysid.model.derivatives import list_derivative_names
from flexsid.workflow.aircraft.axes import find_body, list_axis_surfaces
from flexsid.workflow.global_model.computation import predict_derivatives
from flexsid.workflow.model_structures.baselines import (
    find_approved_global_model,
    read_quantities,
)
from flexsid.workflow.model_structures.model_structures import describe_derivative_state
from flexsid.workflow.model_structures.run_results import hash_run


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
