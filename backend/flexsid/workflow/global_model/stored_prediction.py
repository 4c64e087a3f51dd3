"""A global model at one condition as a prediction: priors, pre-flight simulation, comparison."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flexsid.errors import BadInput, Conflict
from flexsid.records.aircraft import DerivativePrediction
from flexsid.records.decision import LimitedQuantity
from flexsid.records.global_model import GlobalModelResult
from flexsid.storage.store import Store
from flexsid.workflow.global_model.computation import predict_derivatives

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
