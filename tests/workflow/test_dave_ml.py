"""DAVE-ML of a global model: an independent evaluator agrees with its check cases."""

from __future__ import annotations

from collections.abc import Callable
from functools import reduce
from operator import mul, sub, truediv
from xml.etree import ElementTree

import numpy as np
import pytest
from simulated_campaign import NAMES, VALUES, Truth, fly, store_runs

from flexsid.records.aircraft import DerivativePrediction
from flexsid.workflow.global_model.computation import compute_global_model
from flexsid.workflow.global_model.estimates import GlobalModelQuery, prepare_global_model
from flexsid.workflow.global_model.exports import write_dave_ml

D, M = "{http://daveml.org/2010/DAVEML}", "{http://www.w3.org/1998/Math/MathML}"
OPERATORS: dict[str, Callable[[list[float]], float]] = {
    "plus": sum,
    "times": lambda values: reduce(mul, values, 1.0),
    "minus": lambda values: sub(*values),
    "divide": lambda values: truediv(*values),
    "root": lambda values: values[0] ** 0.5,
}


def get(node: ElementTree.Element, name: str) -> str:
    return node.get(name) or ""


def read_points(function: ElementTree.Element, tag: str) -> tuple[str, np.ndarray]:
    (points,) = function.findall(f"{D}{tag}")
    return get(points, "varID"), np.array((points.text or "").split(","), dtype=float)


def evaluate(root: ElementTree.Element, inputs: dict[str, float]) -> dict[str, float]:
    """Evaluate all functions and calculations of a document, in their order, by name."""
    values: dict[str, float] = {}
    names: dict[str, str] = {}
    for function in root.iter(f"{D}function"):
        given, x = read_points(function, "independentVarPts")
        found, y = read_points(function, "dependentVarPts")
        values[found] = float(np.interp(inputs[given], x, y))

    def compute(node: ElementTree.Element) -> float:
        text = node.text or ""
        if node.tag == f"{M}cn":
            return float(text)
        if node.tag == f"{M}ci":
            return values[text]
        operator, *operands = node
        return OPERATORS[operator.tag.removeprefix(M)]([compute(one) for one in operands])

    for variable in root.iter(f"{D}variableDef"):
        identity = get(variable, "varID")
        names[get(variable, "name")] = identity
        if variable.find(f"{D}isInput") is not None:
            values[identity] = inputs[identity]
        elif (math := variable.find(f"{D}calculation/{M}math")) is not None:
            values[identity] = compute(math[0])
    return {name: values[identity] for name, identity in names.items()}


def read_signals(parent: ElementTree.Element) -> dict[str, tuple[float, float]]:
    return {
        one.findtext(f"{D}signalName", ""): (
            float(one.findtext(f"{D}signalValue", "")),
            float(one.findtext(f"{D}tol", "0")),
        )
        for one in parent
    }


@pytest.mark.parametrize("has_mean", [False, True])
def test_check_cases_pass_in_an_independent_evaluation(store, has_mean: bool):
    rng = np.random.default_rng(23)
    truth = Truth.draw(rng, 0.5)
    run_ids = store_runs(store, fly(rng, truth, 16, 4))
    prediction_id = None
    if has_mean:
        fuel = np.linspace(0.0, 1.0, 4)
        values = 1.02 * truth.at(np.stack([np.full(4, 500.0), fuel], axis=1))
        prediction_id = store.predictions.add(
            DerivativePrediction(
                aircraft_id=store.aircraft.find()[0].id,
                source="close to flight",
                kind="panel code",
                fuel=tuple(fuel.tolist()),
                names=NAMES,
                values=store.arrays.put(values),
            )
        ).id
    query = GlobalModelQuery(run_ids=run_ids, prediction_id=prediction_id)
    result = compute_global_model(prepare_global_model(store, query))
    assert result.summary.uses_prediction == has_mean
    root = ElementTree.fromstring(write_dave_ml(result))

    tags = [one.tag.removeprefix(D) for one in root]
    order = ["fileHeader", "variableDef", "function", "checkData"]
    assert tags == sorted(tags, key=order.index)
    identities = [one.get("varID") for one in root.iter(f"{D}variableDef")]
    assert len(set(identities)) == len(identities)
    assert {one.get("varID") for one in root.iter(f"{D}variableRef")} <= set(identities)
    assert len(root.findall(f".//{D}uncertainty/{D}normalPDF/{D}bounds/{D}variableRef")) == len(
        NAMES
    )
    shots = root.findall(f".//{D}staticShot")
    assert len(shots) == 10
    for shot in shots:
        inputs = {name: value for name, (value, _) in read_signals(shot[0]).items()}
        found = evaluate(root, inputs)
        for name, (value, tolerance) in read_signals(shot[1]).items():
            assert abs(found[name] - value) <= tolerance, name
        assert abs(found["CZ_alpha"] / VALUES[0] - 1.0) < 0.6
