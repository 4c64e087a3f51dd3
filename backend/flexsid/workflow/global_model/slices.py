"""Slices and coverage of a global model, for its figures and tables."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.decision import LimitedQuantity
from flexsid.records.global_model import (
    DerivativeSlice,
    EnvelopeCoverage,
    GlobalModelResult,
    SlicePoint,
)
from flexsid.workflow.global_model.computation import predict_before_flight, predict_derivatives

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
