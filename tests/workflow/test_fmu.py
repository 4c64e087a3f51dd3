"""FMUs of runs: the sources compile, and the frequency response is that of the model."""

from __future__ import annotations

import ctypes
import io
import shutil
import subprocess
import zipfile
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from flexsid.storage.store import Store
from flexsid.workflow.runs.fmu import FmiVersion, write_fmu
from flexsid.workflow.runs.model_export import export_model

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
    subprocess.run(["cc", "-shared", "-fPIC", *strict, source, "-o", library], check=True)
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


def respond(A: np.ndarray, B: np.ndarray, C: np.ndarray, D: np.ndarray) -> np.ndarray:
    eye = np.eye(len(A))
    return np.array([C @ np.linalg.solve(1j * w * eye - A, B) + D for w in _OMEGA])


@pytest.mark.parametrize("version", FmiVersion)
def test_the_frequency_response_is_that_of_the_model(
    flown: Store, version: FmiVersion, tmp_path: Path
):
    model = export_model(flown, 1)
    A, B, C, D = (np.array(getattr(model, name)) for name in "ABCD")
    fmu = Fmu(write_fmu(flown, 1, version), version, tmp_path)
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
def test_the_description_is_valid(flown: Store, version: FmiVersion, tmp_path: Path):
    fmpy = pytest.importorskip("fmpy", reason="FMPy is not installed")
    file = tmp_path / "model.fmu"
    file.write_bytes(write_fmu(flown, 1, version))
    found = fmpy.read_model_description(str(file), validate=True)
    assert len(found.modelVariables) > 20
    assert fmpy.validation.validate_fmu(str(file)) == []
