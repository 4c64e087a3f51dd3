"""Global model as DAVE-ML and as a functional mock-up unit (FMU)."""

from __future__ import annotations

from collections.abc import Iterator
from datetime import UTC, datetime
from xml.etree import ElementTree

import numpy as np

from flexsid.nomenclature import describe
from flexsid.records.decision import LimitedQuantity
from flexsid.records.global_model import GlobalModelResult
from flexsid.sysid.exchange.fmu import (
    FmiVersion,
    FmuModel,
    FmuVariable,
    format_numbers,
    pack_fmu,
)
from flexsid.workflow.global_model.computation import predict_before_flight, predict_derivatives

# --- Global model as DAVE-ML: polynomials, uncertainty, and check cases ---------------------------

_NAMESPACE = "http://daveml.org/2010/DAVEML"
_MATHML = "http://www.w3.org/1998/Math/MathML"
_MOST_CHECKED = 10  # flown conditions
_TOLERANCE = 1e-9  # of a check case, relative
_FUEL = LimitedQuantity.FUEL
_INPUTS = {
    LimitedQuantity.DYNAMIC_PRESSURE: ("dynamicPressure", "Pa"),
    _FUEL: ("fuelFraction", "nd"),
    LimitedQuantity.AIRSPEED: ("trueAirspeed", "m_s"),
    LimitedQuantity.AIRSPEED_RATIO: ("airspeedRatio", "nd"),
    LimitedQuantity.ALPHA: ("angleOfAttack", "rad"),
}

_Element = ElementTree.Element


def write_dave_ml(result: GlobalModelResult, made_at: datetime | None = None) -> bytes:
    """Write a global model as DAVE-ML: derivatives and standard errors over the conditions.

    Notes
    -----
    The monomials of the scaled conditions are variables; each derivative is a sum of them in
    MathML, and its standard error the square root of their quadratic form. Its ``uncertainty``
    refers to the standard error, as one sigma of a normal distribution. Where a prediction is
    the mean of the model, it is added as a function of fuel. Check cases are flown conditions.
    Source: ANSI/AIAA S-119-2011, Flight Dynamics Model Exchange Standard.
    """
    ElementTree.register_namespace("", _NAMESPACE)
    root = _Element("DAVEfunc", xmlns=_NAMESPACE)
    _write_header(root, result, made_at or datetime.now(UTC))
    variables = [one.quantity for one in result.summary.variables]
    is_mean_over_fuel = result.summary.uses_prediction and _FUEL in variables
    for one in result.summary.variables:
        name, unit = _INPUTS[one.quantity]
        limits = {"minValue": repr(one.lowest), "maxValue": repr(one.highest)}
        ElementTree.SubElement(_define(root, name, name, unit, **limits), "isInput")
    _write_monomials(root, result)
    basis = result.model.basis
    constant = np.zeros(len(result.model.names))
    if result.summary.uses_prediction and not is_mean_over_fuel:
        constant = np.nan_to_num(
            predict_before_flight(result, np.array([result.summary.centre]))[0]
        )
    p, k = result.model.coefficients.shape
    covariance = result.model.covariance.reshape(p, k, p, k)
    for number, name in enumerate(result.model.names):
        if is_mean_over_fuel:
            _define(root, f"{name} predicted", f"{name}_predicted", "nd")
        by_monomial = basis.mixing @ result.model.coefficients[number]
        by_monomial[0] += constant[number]
        quadratic = basis.mixing @ covariance[number, :, number] @ basis.mixing.T
        quadratic[0, 0] += result.modal_std[number] ** 2
        _write_std_error(root, name, quadratic)
        _write_derivative(root, name, by_monomial, has_mean=is_mean_over_fuel)
    if is_mean_over_fuel:
        _write_predictions(root, result)
    _write_check_data(root, result)
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="utf-8", xml_declaration=True)


def _write_header(root: _Element, result: GlobalModelResult, made_at: datetime) -> None:
    header = ElementTree.SubElement(root, "fileHeader")
    ElementTree.SubElement(header, "author", name="flexsid", org="flexsid")
    ElementTree.SubElement(header, "fileCreationDate", date=made_at.date().isoformat())
    text = ElementTree.SubElement(header, "description")
    runs = ", ".join(str(run.run_id) for run in result.summary.runs if not run.is_outlying)
    text.text = f"Nondimensional derivatives. {result.summary.sentence} Runs: {runs}."


def _define(
    root: _Element, name: str, identity: str, unit: str = "nd", **attributes: str
) -> _Element:
    known = {"name": name, "varID": identity, "units": unit, **attributes}
    return ElementTree.SubElement(root, "variableDef", known)


def _calculate(variable: _Element) -> _Element:
    calculation = ElementTree.SubElement(variable, "calculation")
    return ElementTree.SubElement(calculation, "math", xmlns=_MATHML)


def _apply(parent: _Element, operator: str) -> _Element:
    apply = ElementTree.SubElement(parent, "apply")
    ElementTree.SubElement(apply, operator)
    return apply


def _add_text(parent: _Element, tag: str, text: str) -> None:
    ElementTree.SubElement(parent, tag).text = text


def _write_monomials(root: _Element, result: GlobalModelResult) -> None:
    """Write the monomials of the scaled conditions; the first one is constant."""
    basis = result.model.basis
    names = [_INPUTS[one.quantity][0] for one in result.summary.variables]
    for name, centre, span in zip(names, basis.centre, basis.span, strict=True):
        quotient = _apply(_calculate(_define(root, f"scaled {name}", f"{name}_scaled")), "divide")
        difference = _apply(quotient, "minus")
        _add_text(difference, "ci", name)
        _add_text(difference, "cn", repr(float(centre)))
        _add_text(quotient, "cn", repr(float(span)))
    for number, powers in enumerate(basis.powers.tolist()):
        term = _calculate(_define(root, f"monomial {number}", f"monomial_{number}"))
        product = _apply(term, "times")
        _add_text(product, "cn", "1.0")
        for name, power in zip(names, powers, strict=True):
            for _ in range(power):
                _add_text(product, "ci", f"{name}_scaled")


def _write_std_error(root: _Element, name: str, quadratic: np.ndarray) -> None:
    variable = _define(root, f"{name} standard error", f"{name}_std")
    total = _apply(_apply(_calculate(variable), "root"), "plus")
    for i in range(len(quadratic)):
        for j in range(i + 1):
            product = _apply(total, "times")
            weight = quadratic[i, j] if i == j else quadratic[i, j] + quadratic[j, i]
            _add_text(product, "cn", repr(float(weight)))
            _add_text(product, "ci", f"monomial_{i}")
            _add_text(product, "ci", f"monomial_{j}")
    ElementTree.SubElement(variable, "isOutput")


def _write_derivative(
    root: _Element, name: str, by_monomial: np.ndarray, *, has_mean: bool
) -> None:
    variable = _define(root, name, name, describe(name).unit or "nd", symbol=describe(name).label)
    total = _apply(_calculate(variable), "plus")
    if has_mean:
        _add_text(total, "ci", f"{name}_predicted")
    for number, coefficient in enumerate(by_monomial.tolist()):
        product = _apply(total, "times")
        _add_text(product, "cn", repr(coefficient))
        _add_text(product, "ci", f"monomial_{number}")
    ElementTree.SubElement(variable, "isOutput")
    normal = ElementTree.SubElement(
        ElementTree.SubElement(variable, "uncertainty", effect="additive"),
        "normalPDF",
        numSigmas="1",
    )
    ElementTree.SubElement(
        ElementTree.SubElement(normal, "bounds"), "variableRef", varID=f"{name}_std"
    )


def _write_predictions(root: _Element, result: GlobalModelResult) -> None:
    """Write the prediction that is the mean of the model as functions of fuel."""
    assert result.prediction is not None
    fuel = result.prediction.fuel
    values = np.nan_to_num(result.prediction.values)
    for number, name in enumerate(result.model.names):
        function = ElementTree.SubElement(root, "function", name=f"{name} predicted")
        for tag, identity, numbers in (
            ("independentVarPts", _INPUTS[_FUEL][0], fuel),
            ("dependentVarPts", f"{name}_predicted", values[:, number]),
        ):
            points = ElementTree.SubElement(function, tag, varID=identity)
            points.text = ", ".join(map(repr, numbers.tolist()))


def _write_check_data(root: _Element, result: GlobalModelResult) -> None:
    """Write the model at flown conditions."""
    flown = np.unique([run.condition for run in result.summary.runs], axis=0)
    places = np.unique(np.linspace(0, len(flown) - 1, _MOST_CHECKED).round().astype(int))
    values, covariance = predict_derivatives(result, flown[places])
    std = np.sqrt(np.diagonal(covariance, axis1=1, axis2=2) + result.modal_std**2)
    check = ElementTree.SubElement(root, "checkData")
    inputs = [_INPUTS[one.quantity] for one in result.summary.variables]
    for number, condition in enumerate(flown[places].tolist(), start=1):
        shot = ElementTree.SubElement(check, "staticShot", name=f"condition {number}")
        given = ElementTree.SubElement(shot, "checkInputs")
        for (name, unit), value in zip(inputs, condition, strict=True):
            _write_signal(given, name, unit, value)
        expected = ElementTree.SubElement(shot, "checkOutputs")
        for k, name in enumerate(result.model.names):
            unit = describe(name).unit or "nd"
            value, error = float(values[number - 1, k]), float(std[number - 1, k])
            _write_signal(expected, name, unit, value, _TOLERANCE * max(abs(value), error))
            _write_signal(expected, f"{name} standard error", "nd", error, _TOLERANCE * error)


def _write_signal(
    parent: _Element, name: str, unit: str, value: float, tolerance: float | None = None
) -> None:
    signal = ElementTree.SubElement(parent, "signal")
    _add_text(signal, "signalName", name)
    _add_text(signal, "signalUnits", unit)
    _add_text(signal, "signalValue", repr(value))
    if tolerance is not None:
        _add_text(signal, "tol", repr(tolerance))


# --- A global model as a functional mock-up unit (FMU): derivatives over the flight condition -----

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
