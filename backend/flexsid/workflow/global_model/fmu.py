"""A global model as a functional mock-up unit (FMU): derivatives over the flight condition."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from flexsid.records.decision import LimitedQuantity
from flexsid.records.global_model import GlobalModelResult
from flexsid.sysid.exchange.fmu import (
    FmiVersion,
    FmuModel,
    FmuVariable,
    format_numbers,
    pack_fmu,
)
from flexsid.workflow.global_model.computation import predict_before_flight

_FUEL = LimitedQuantity.FUEL
_UNITS = {
    LimitedQuantity.DYNAMIC_PRESSURE: "Pa",
    _FUEL: "1",
    LimitedQuantity.AIRSPEED: "m/s",
    LimitedQuantity.AIRSPEED_RATIO: "1",
    LimitedQuantity.ALPHA: "rad",
}


def write_global_fmu(result: GlobalModelResult, version: FmiVersion) -> bytes:
    """Write a global model as an FMU for Model Exchange without states.

    Parameters
    ----------
    result
        The global model.
    version
        Version of FMI.

    Returns
    -------
    bytes
        Archive with C sources. Inputs are the conditions, with the flown limits; outputs are the
        derivatives and their standard errors.

    Notes
    -----
    The numbers are those of the DAVE-ML export: monomials of the scaled conditions, the quadratic
    form of each variance, and the prediction over fuel where it is the mean of the model.
    """
    summary, basis = result.summary, result.model.basis
    p, k = result.model.coefficients.shape
    coefficients = result.model.coefficients @ basis.mixing.T
    covariance = result.model.covariance.reshape(p, k, p, k)
    quadratic = np.array([basis.mixing @ covariance[n, :, n] @ basis.mixing.T for n in range(p)])
    quadratic[:, 0, 0] += result.modal_std**2
    fuels, predicted = _tabulate_mean(result)
    variables = [one.quantity for one in summary.variables]
    numbers = {
        "N_INPUTS": len(variables),
        "N_TERMS": k,
        "N_DERIVATIVES": p,
        "N_FUELS": len(fuels),
        "FUEL_INPUT": variables.index(_FUEL) if _FUEL in variables else -1,
        "double CENTRE": format_numbers(basis.centre.tolist()),
        "double SPAN": format_numbers(basis.span.tolist()),
        "double START": format_numbers(summary.centre),
        "int POWERS": [str(power) for power in basis.powers.ravel().tolist()],
        "double COEFFICIENTS": format_numbers(coefficients.ravel().tolist()),
        "double QUADRATIC": format_numbers(quadratic.ravel().tolist()),
        "double FUELS": format_numbers(fuels.tolist()),
        "double PREDICTED": format_numbers(predicted.ravel().tolist()),
    }
    about = f"Nondimensional derivatives per radian. {summary.sentence}"
    listed = tuple(_list_variables(result))
    return pack_fmu(listed, FmuModel.POLYNOMIALS, numbers, about, version)


def _tabulate_mean(result: GlobalModelResult) -> tuple[np.ndarray, np.ndarray]:
    """Tabulate the mean of the model over fuel (n_fuels, p); zero without a prediction."""
    variables = [one.quantity for one in result.summary.variables]
    if not result.summary.uses_prediction or result.prediction is None:
        return np.zeros(1), np.zeros((1, len(result.model.names)))
    if _FUEL in variables:
        return result.prediction.fuel, np.nan_to_num(result.prediction.values)
    centre = np.array([result.summary.centre])
    return np.zeros(1), np.nan_to_num(predict_before_flight(result, centre))


def _list_variables(result: GlobalModelResult) -> Iterator[FmuVariable]:
    """List the variables in the order of their value references."""
    summary = result.summary
    for one, start in zip(summary.variables, summary.centre, strict=True):
        yield FmuVariable(
            name=f"input.{one.quantity.value}",
            symbol=one.quantity.value,
            causality="input",
            start=start,
            unit=_UNITS[one.quantity],
            text=f"{one.quantity.value}, in the range that was flown",
            limits=(one.lowest, one.highest),
        )
    for name in result.model.names:
        yield FmuVariable(name=f"derivative.{name}", symbol=name, causality="output")
    for name in result.model.names:
        text = f"Standard error of derivative.{name}"
        yield FmuVariable(name=f"std_error.{name}", symbol=name, causality="output", text=text)
