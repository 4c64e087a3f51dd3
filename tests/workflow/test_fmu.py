"""FMUs: the sources compile, and frequency responses and derivatives are those of the models."""

from __future__ import annotations

import ctypes
import importlib.util
import io
import shutil
import subprocess
import zipfile
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from lagging_flight import estimate_with_shape
from simulated_campaign import Truth, fly, store_runs

from flexsid.records.global_model import PredictionTable
from flexsid.records.run import Method
from flexsid.storage.store import Store
from flexsid.sysid.exchange.fmu import FmiVersion
from flexsid.workflow.global_model.computation import compute_global_model, predict_derivatives
from flexsid.workflow.global_model.estimates import GlobalModelQuery, prepare_global_model
from flexsid.workflow.global_model.exports import write_global_fmu
from flexsid.workflow.runs.exports import export_model, write_fmu

pytestmark = [
    pytest.mark.parametrize("backend", ["sqlite"]),
    pytest.mark.skipif(shutil.which("cc") is None, reason="no C compiler here"),
]
_OMEGA = 2.0 * np.pi * np.geomspace(0.05, 30.0, 60)


@pytest.fixture
def flown(flown_url: str):
    store = Store.open(flown_url)
    yield store
    store.close()


def compile_fmu(content: bytes, folder: Path) -> tuple[ctypes.CDLL, ElementTree.Element]:
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        archive.extractall(folder)
    description = ElementTree.parse(folder / "modelDescription.xml").getroot()
    (source,) = (folder / "sources").glob("*.c")
    library = folder / "model.so"
    strict = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-O2"]
    made = ["-o", library, "-lm"]
    subprocess.run(["cc", "-shared", "-fPIC", *strict, source, *made], check=True)
    return ctypes.CDLL(str(library)), description


class Fmu:
    """Calls of an FMU that both versions name differently."""

    def __init__(self, content: bytes, version: FmiVersion, folder: Path) -> None:
        self.library, self.description = compile_fmu(content, folder)
        self.is_old = version is FmiVersion.FMI_2
        self.prefix = f"fmi{version.value}"
        if self.is_old:
            token = self.description.attrib["guid"].encode()
            create = self.library.fmi2Instantiate
            given = (b"a", 0, token, None, None, 0, 0)
        else:
            token = self.description.attrib["instantiationToken"].encode()
            create = self.library.fmi3InstantiateModelExchange
            given = (b"a", token, None, False, False, None, None)
        create.restype = ctypes.c_void_p
        self.instance = ctypes.c_void_p(create(*given))
        assert self.instance.value, "it is instantiated"
        wrong = list(given)
        wrong[2 if self.is_old else 1] = b"{other}"
        assert create(*wrong) is None, "another token is refused"
        found = self.description.iter("ScalarVariable" if self.is_old else "Float64")
        self.references = {one.attrib["name"]: int(one.attrib["valueReference"]) for one in found}

    def list_references(self, kind: str) -> list[int]:
        return [number for name, number in self.references.items() if name.startswith(kind)]

    def set(self, name: str, value: float) -> int:
        call = getattr(self.library, f"{self.prefix}Set{'Real' if self.is_old else 'Float64'}")
        size = ctypes.c_size_t(1)
        reference, number = (
            (ctypes.c_uint32 * 1)(self.references[name]),
            (ctypes.c_double * 1)(value),
        )
        return call(self.instance, reference, size, number, *(() if self.is_old else (size,)))

    def get(self, name: str) -> float:
        call = getattr(self.library, f"{self.prefix}Get{'Real' if self.is_old else 'Float64'}")
        size, number = ctypes.c_size_t(1), (ctypes.c_double * 1)()
        reference = (ctypes.c_uint32 * 1)(self.references[name])
        done = call(self.instance, reference, size, number, *(() if self.is_old else (size,)))
        assert done == 0
        return number[0]

    def differentiate(self, unknowns: list[int], knowns: list[int]) -> np.ndarray:
        call = getattr(self.library, f"{self.prefix}GetDirectionalDerivative")
        n = len(unknowns)
        found = np.zeros((n, len(knowns)))
        for k, known in enumerate(knowns):
            rows, seed = (ctypes.c_double * n)(), (ctypes.c_double * 1)(1.0)
            one, many = ctypes.c_size_t(1), ctypes.c_size_t(n)
            ends = ((seed,), (rows,)) if self.is_old else ((seed, one), (rows, many))
            unknown, column = (ctypes.c_uint32 * n)(*unknowns), (ctypes.c_uint32 * 1)(known)
            assert call(self.instance, unknown, many, column, one, *ends[0], *ends[1]) == 0
            found[:, k] = rows
        return found


def validate(content: bytes, folder: Path) -> None:
    """Validate against schema and rules by FMPy, where it is installed."""
    if importlib.util.find_spec("fmpy") is None:
        return
    validation = importlib.import_module("fmpy.validation")  # not a dependency: installs CMake
    file = folder / "model.fmu"
    file.write_bytes(content)
    assert validation.validate_fmu(str(file)) == []


def respond(A: np.ndarray, B: np.ndarray, C: np.ndarray, D: np.ndarray) -> np.ndarray:
    eye = np.eye(len(A))
    return np.array([C @ np.linalg.solve(1j * w * eye - A, B) + D for w in _OMEGA])


def test_a_frequency_shape_is_represented_by_states(store: Store, tmp_path: Path):
    run = estimate_with_shape(store, 0.8, Method.EE)
    model = export_model(store, run.id or 0)
    A, B, C, D = (np.array(getattr(model, name)) for name in "ABCD")
    assert len(A) > 7
    content = write_fmu(store, run.id or 0, FmiVersion.FMI_3)
    validate(content, tmp_path)
    fmu = Fmu(content, FmiVersion.FMI_3, tmp_path)
    states, rates = fmu.list_references("state."), fmu.list_references("der(")
    inputs, outputs = fmu.list_references("input."), fmu.list_references("output.")
    found = fmu.differentiate([*rates, *outputs], [*states, *inputs])
    n = len(states)
    expected = respond(A, B, C, D)
    parts = found[:n, :n], found[:n, n:], found[n:, :n], found[n:, n:]
    assert np.allclose(respond(*parts), expected, rtol=0.0, atol=1e-6 * np.abs(expected).max())


@pytest.mark.parametrize("version", FmiVersion)
def test_the_frequency_response_is_that_of_the_model(
    flown: Store, version: FmiVersion, tmp_path: Path
):
    model = export_model(flown, 1)
    A, B, C, D = (np.array(getattr(model, name)) for name in "ABCD")
    content = write_fmu(flown, 1, version)
    validate(content, tmp_path)
    fmu = Fmu(content, version, tmp_path)
    states, rates = fmu.list_references("state."), fmu.list_references("der(")
    inputs, outputs = fmu.list_references("input."), fmu.list_references("output.")
    found = fmu.differentiate([*rates, *outputs], [*states, *inputs])
    n = len(states)
    expected = respond(A, B, C, D)
    response = respond(found[:n, :n], found[:n, n:], found[n:, :n], found[n:, n:])
    assert np.abs(response - expected).max() <= 1e-6 * np.abs(expected).max()
    assert response == pytest.approx(expected, rel=1e-6, abs=1e-9 * np.abs(expected).max())

    # Values as of an integrator, and another derivative.
    assert fmu.set("state.alpha", 0.02) == 0
    assert fmu.set(f"input.{model.inputs[0]}", -0.01) == 0
    x, u = np.zeros(n), np.zeros(len(inputs))
    x[model.states.index("alpha")], u[0] = 0.02, -0.01
    rate = fmu.get("der(state.alpha)")
    assert rate == pytest.approx((A @ x + B @ u)[model.states.index("alpha")], rel=1e-9)
    assert fmu.get("derivative.Cm_alpha") == model.derivatives["Cm_alpha"]
    before = fmu.get("der(state.q)")
    assert fmu.set("derivative.Cm_alpha", 2.0 * model.derivatives["Cm_alpha"]) == 0
    assert fmu.get("der(state.q)") < before, "twice as stable"
    assert fmu.set("der(state.q)", 1.0) != 0, "a rate is not set"


@pytest.mark.parametrize("version", FmiVersion)
@pytest.mark.parametrize("uses_prediction", [False, True])
def test_derivatives_over_the_envelope_are_those_of_the_global_model(
    store: Store, version: FmiVersion, uses_prediction: bool, tmp_path: Path
):
    rng = np.random.default_rng(21)
    run_ids = store_runs(store, fly(rng, Truth.draw(rng, 0.3), 14, 4))
    task = prepare_global_model(store, GlobalModelQuery(run_ids=run_ids))
    result = compute_global_model(task)
    if uses_prediction:
        values = np.outer([1.0, 1.1, 1.3], np.arange(1.0, 1.0 + len(result.model.names)))
        result = replace(
            result,
            summary=replace(result.summary, uses_prediction=True),
            prediction=PredictionTable(source="p", fuel=np.array([0.0, 0.4, 1.0]), values=values),
        )
    content = write_global_fmu(result, version)
    validate(content, tmp_path)
    fmu = Fmu(content, version, tmp_path)
    names = [f"input.{one.quantity.value}" for one in result.summary.variables]
    assert [fmu.get(name) for name in names] == list(result.summary.centre)
    conditions = np.array([run.condition for run in result.summary.runs[:5]])
    expected, covariance = predict_derivatives(result, conditions)
    std = np.sqrt(np.diagonal(covariance, axis1=1, axis2=2) + result.modal_std**2)
    for condition, values, errors in zip(conditions, expected, std, strict=True):
        for name, value in zip(names, condition, strict=True):
            assert fmu.set(name, value) == 0
        found = [fmu.get(f"derivative.{name}") for name in result.model.names]
        assert found == pytest.approx(values, rel=1e-6, abs=1e-9)
        found = [fmu.get(f"std_error.{name}") for name in result.model.names]
        assert found == pytest.approx(errors, rel=1e-6)
    assert fmu.set("derivative.Cm_alpha", 1.0) != 0
