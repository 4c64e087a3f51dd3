"""Trend of one derivative over flight condition, with a weighted fit per method."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from flexsid.errors import BadInput
from flexsid.nomenclature import describe
from flexsid.records.maneuver import Maneuver
from flexsid.records.run import sort_methods
from flexsid.records.validation import Against, DerivativeTrend, TrendLine, TrendPoint
from flexsid.storage.store import Store
from flexsid.sysid.estimation.agreement import fit_trend
from flexsid.workflow.aircraft.derivative_predictions import interpolate_values
from flexsid.workflow.model_structures.model_structures import get_result

_POINTS = 60

_CONDITION: dict[Against, Callable[[Maneuver], float | None]] = {
    Against.DYNAMIC_PRESSURE: lambda maneuver: maneuver.condition.dynamic_pressure_pa,
    Against.AIRSPEED_RATIO: lambda maneuver: maneuver.airspeed_ratio,
    Against.FUEL: lambda maneuver: maneuver.condition.fuel_fraction,
    Against.FTA: lambda maneuver: None if maneuver.fta is None else float(maneuver.fta),
}


def fit_derivative_trend(
    store: Store,
    run_ids: Sequence[int],
    name: str,
    against: Against,
    prediction_ids: Sequence[int] = (),
    degree: int = 1,
) -> DerivativeTrend:
    """Fit one derivative of several runs over a flight condition.

    Parameters
    ----------
    store, run_ids
        Runs that succeeded; those without this derivative or a known condition are
        excluded.
    name
        Derivative, e.g. ``Cm_alpha``.
    against
        Independent variable. Over FTAs, which have no order, means are drawn, not lines.
    prediction_ids
        Predictions, taken at the fuel of each maneuver.
    degree
        Of the polynomial; lower where too few conditions were flown for it.

    Raises
    ------
    BadInput
        If no run has this derivative.
    """
    get_condition = _CONDITION[against]
    points: list[TrendPoint] = []
    flown: dict[int, tuple[float, Maneuver]] = {}
    known: set[str] = set()
    for run_id in dict.fromkeys(run_ids):
        run = store.runs.get(run_id)
        result = get_result(run)
        maneuver = store.maneuvers.get(run.maneuver_id)
        x = get_condition(maneuver)
        known.update(parameter.name for parameter in result.parameters)
        estimate = next((one for one in result.parameters if one.name == name), None)
        if estimate is None or x is None:
            continue
        flown[run.maneuver_id] = (x, maneuver)
        points.append(
            TrendPoint(
                run_id=run_id,
                maneuver_id=run.maneuver_id,
                label=f"{run.method.value} {run_id}, {maneuver.label}",
                kind=run.method.value,
                x=x,
                value=estimate.value,
                std_error=estimate.std_error,
            )
        )
    if not points:
        raise BadInput(
            f"no run estimated '{name}' where {against.value} is known; "
            f"there are {', '.join(sorted(known)) or 'no estimates'}",
            code="unknown-derivative",
            derivative=name,
        )
    lines = [
        line
        for kind in sort_methods(point.kind for point in points)
        if (line := _fit_line(kind, points, 0 if against is Against.FTA else degree))
    ]
    lines += _build_predicted_lines(store, prediction_ids, name, list(flown.values()))
    return DerivativeTrend(
        name=name,
        label=describe(name).label,
        unit=describe(name).unit or "1",
        against=against,
        points=tuple(points),
        lines=tuple(lines),
    )


def _fit_line(kind: str, points: Sequence[TrendPoint], degree: int) -> TrendLine | None:
    own = [(p.x, p.value, p.std_error) for p in points if p.kind == kind and p.std_error]
    if len(own) < 2:
        return None
    x, values, errors = (np.array(part, dtype=float) for part in zip(*own, strict=True))
    fit = fit_trend(x, values, errors, min(degree, np.unique(x).size - 1))
    grid = np.linspace(float(x.min()), float(x.max()), _POINTS)
    fitted, std = fit.at(grid)
    slope, slope_error = fit.slope
    return TrendLine(
        label=f"{kind}, weighted fit",
        kind=kind,
        x=tuple(grid.tolist()),
        values=tuple(fitted.tolist()),
        std_errors=tuple(std.tolist()),
        slope=slope if fit.coefficients.size > 1 else None,
        slope_std_error=slope_error if fit.coefficients.size > 1 else None,
        chi_square=fit.chi_square,
        freedom=fit.freedom,
        probability=fit.probability,
    )


def _build_predicted_lines(
    store: Store,
    prediction_ids: Sequence[int],
    name: str,
    flown: Sequence[tuple[float, Maneuver]],
) -> list[TrendLine]:
    lines: list[TrendLine] = []
    ordered = sorted(flown, key=lambda one: one[0])
    for number in dict.fromkeys(prediction_ids):
        prediction = store.predictions.get(number)
        found = [
            (x, values[name])
            for x, maneuver in ordered
            if name
            in (values := interpolate_values(store, prediction, maneuver.condition.fuel_fraction))
        ]
        if found:
            lines.append(
                TrendLine(
                    label=prediction.source,
                    kind="prediction",
                    x=tuple(x for x, _ in found),
                    values=tuple(value for _, value in found),
                )
            )
    return lines
