"""The identified model of a run as a functional mock-up unit (FMU) with its source code."""

from __future__ import annotations

import hashlib
import io
import uuid
import zipfile
from collections.abc import Iterator
from dataclasses import dataclass, replace
from enum import Enum
from importlib import resources
from xml.etree import ElementTree

import numpy as np

from flexsid.errors import BadInput
from flexsid.nomenclature import describe
from flexsid.storage.store import Store
from flexsid.workflow import runs
from flexsid.workflow.runs.identified_models import IdentifiedModel, load_identified_model

_IDENTIFIER = "flexsid_model"
_SOURCES = "fmu_sources"
_EPOCH = (1980, 1, 1, 0, 0, 0)
_AFFINE = 1e-9  # largest deviation from a sum over the derivatives, relative to the entries

_Element = ElementTree.Element


class FmiVersion(Enum):
    """Version of the Functional Mock-up Interface."""

    FMI_2 = "2"
    FMI_3 = "3"


@dataclass(frozen=True, slots=True, eq=False)
class _AffineModel:
    """[x'; y] = (M0 + sum of p_k M_k) [x; u]; ``slopes`` (p, n_rows, n_columns) are M_k."""

    states: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    base: np.ndarray
    derivatives: dict[str, float]
    slopes: np.ndarray


@dataclass(frozen=True, slots=True, kw_only=True)
class _Variable:
    """A variable of the FMU; its value reference is its place in the list, from 1."""

    name: str
    symbol: str
    causality: str
    variability: str = "continuous"
    start: float | None = None
    derivative_of: int | None = None
    unit: str | None = None


def write_fmu(store: Store, run_id: int, version: FmiVersion) -> bytes:
    """Write the identified model of a run as an FMU for Model Exchange.

    Parameters
    ----------
    store
        Database.
    run_id
        A run that succeeded, without a frequency shape of the derivatives.
    version
        Version of FMI.

    Returns
    -------
    bytes
        Archive with the model description and the C sources; importers compile it. Its parameters
        are the derivatives, at their estimates, at the flight condition of the maneuver.

    Raises
    ------
    Conflict
        If the run has no result.
    BadInput
        If the model is not a sum over its derivatives.

    Notes
    -----
    Source: Functional Mock-up Interface 2.0.5 and 3.0.2, https://fmi-standard.org/docs.
    """
    run = store.runs.get(run_id)
    model = _separate_derivatives(load_identified_model(store, run))
    variables = tuple(_list_variables(model))
    digest = hashlib.sha256(repr((version, variables)).encode() + model.base.tobytes())
    token = f"{{{uuid.UUID(bytes=digest.digest()[:16])}}}"
    about = (
        f"{run.method.value} estimation, run {run_id} of flexsid: perturbations about trim at the "
        "condition of its maneuver. Outputs are without delays and instruments."
    )
    main = f"fmi{version.value}.c"
    if version is FmiVersion.FMI_2:
        described = _describe_fmi2(variables, token, about, main)
    else:
        described = _describe_fmi3(variables, token, about)
    folder = resources.files(runs) / _SOURCES
    files = {
        "modelDescription.xml": _encode(described),
        "sources/data.h": _write_data(model, token).encode(),
        "sources/model.h": (folder / "model.h").read_bytes(),
        f"sources/{main}": (folder / main).read_bytes(),
    }
    if version is FmiVersion.FMI_3:
        files["sources/buildDescription.xml"] = _encode(_describe_build(main))
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            archive.writestr(zipfile.ZipInfo(name, _EPOCH), content)
    return packed.getvalue()


def _separate_derivatives(found: IdentifiedModel) -> _AffineModel:
    """Separate the part of the system matrices that each derivative contributes.

    Raises
    ------
    BadInput
        If the matrices are not a sum over the derivatives.
    """
    if found.model.shape is not None:
        raise BadInput(
            "an FMU has derivatives without a frequency shape; estimate a quasi-steady model",
            code="not-with-shape",
        )
    table = found.derivatives
    named = table.named()

    def assemble(values: np.ndarray) -> np.ndarray:
        system = found.model.state_space(replace(table, values=values.reshape(table.values.shape)))
        return np.block([[system.A, system.B], [system.C, system.D]])

    base = assemble(np.zeros(table.values.size))
    slopes = np.array([assemble(unit) - base for unit in np.eye(table.values.size)])
    whole = assemble(table.values)
    rest = np.abs(base + np.tensordot(table.values.ravel(), slopes, axes=1) - whole)
    if np.any(rest > _AFFINE * np.abs(whole).max()):
        raise BadInput(
            "the system matrices are not a sum over the derivatives; export the model for MATLAB",
            code="not-affine",
        )
    used = np.flatnonzero(np.abs(slopes).max(axis=(1, 2)))
    names = [list(named)[k] for k in used]
    system = found.model.state_space(table)
    return _AffineModel(
        states=system.states,
        inputs=system.inputs,
        outputs=system.outputs,
        base=base,
        derivatives={name: named[name] for name in names},
        slopes=slopes[used],
    )


def _list_variables(model: _AffineModel) -> Iterator[_Variable]:
    """List the variables in the order of their value references."""
    for name in model.states:
        yield _Variable(name=f"state.{name}", symbol=name, causality="local", start=0.0)
    for number, name in enumerate(model.states, start=1):
        yield _Variable(
            name=f"der(state.{name})", symbol=name, causality="local", derivative_of=number, unit=""
        )
    for name in model.inputs:
        yield _Variable(name=f"input.{name}", symbol=name, causality="input", start=0.0)
    for name in model.outputs:
        yield _Variable(name=f"output.{name}", symbol=name, causality="output")
    for name, value in model.derivatives.items():
        yield _Variable(
            name=f"derivative.{name}",
            symbol=name,
            causality="parameter",
            variability="tunable",
            start=value,
        )


def _describe(variable: _Variable) -> dict[str, str]:
    """Return the attributes that both versions have."""
    if variable.derivative_of is not None:
        text = f"Rate of state.{variable.symbol}"
    else:
        text = describe(variable.symbol).label
    attributes = {"name": variable.name, "causality": variable.causality, "description": text}
    attributes["variability"] = variable.variability
    if variable.causality in ("local", "output"):
        attributes["initial"] = "calculated" if variable.start is None else "exact"
    return attributes


def _get_unit(variable: _Variable) -> dict[str, str]:
    unit = describe(variable.symbol).unit if variable.unit is None else variable.unit
    return {"unit": unit} if unit else {}


def _find_unknowns(variables: tuple[_Variable, ...]) -> tuple[list[int], list[int]]:
    """Return the value references of outputs and of rates of states."""
    numbered = list(enumerate(variables, start=1))
    outputs = [number for number, one in numbered if one.causality == "output"]
    return outputs, [number for number, one in numbered if one.derivative_of is not None]


def _begin(version: str, about: str, **attributes: str) -> _Element:
    return _Element(
        "fmiModelDescription",
        {
            "fmiVersion": version,
            "modelName": _IDENTIFIER,
            "description": about,
            "generationTool": "flexsid",
            "variableNamingConvention": "structured",
            **attributes,
        },
    )


def _add_units(root: _Element, variables: tuple[_Variable, ...]) -> None:
    names = {unit for one in variables for unit in _get_unit(one).values()}
    if names:
        units = ElementTree.SubElement(root, "UnitDefinitions")
        for name in sorted(names):
            ElementTree.SubElement(units, "Unit", name=name)


def _describe_fmi2(variables: tuple[_Variable, ...], token: str, about: str, main: str) -> _Element:
    root = _begin("2.0", about, guid=token, numberOfEventIndicators="0")
    exchange = ElementTree.SubElement(
        root,
        "ModelExchange",
        modelIdentifier=_IDENTIFIER,
        canGetAndSetFMUstate="true",
        canSerializeFMUstate="true",
        providesDirectionalDerivative="true",
    )
    ElementTree.SubElement(ElementTree.SubElement(exchange, "SourceFiles"), "File", name=main)
    _add_units(root, variables)
    listed = ElementTree.SubElement(root, "ModelVariables")
    for number, one in enumerate(variables, start=1):
        scalar = ElementTree.SubElement(
            listed, "ScalarVariable", {**_describe(one), "valueReference": str(number)}
        )
        real = ElementTree.SubElement(scalar, "Real", _get_unit(one))
        if one.start is not None:
            real.set("start", repr(float(one.start)))
        if one.derivative_of is not None:
            real.set("derivative", str(one.derivative_of))
    outputs, rates = _find_unknowns(variables)
    structure = ElementTree.SubElement(root, "ModelStructure")
    for tag, numbers in (
        ("Outputs", outputs),
        ("Derivatives", rates),
        ("InitialUnknowns", [*rates, *outputs]),
    ):
        group = ElementTree.SubElement(structure, tag)
        for number in sorted(numbers):
            ElementTree.SubElement(group, "Unknown", index=str(number))
    return root


def _describe_fmi3(variables: tuple[_Variable, ...], token: str, about: str) -> _Element:
    root = _begin("3.0", about, instantiationToken=token)
    ElementTree.SubElement(
        root,
        "ModelExchange",
        modelIdentifier=_IDENTIFIER,
        canGetAndSetFMUState="true",
        canSerializeFMUState="true",
        providesDirectionalDerivatives="true",
    )
    _add_units(root, variables)
    listed = ElementTree.SubElement(root, "ModelVariables")
    time = {"name": "time", "valueReference": "0", "causality": "independent"}
    ElementTree.SubElement(listed, "Float64", {**time, "variability": "continuous"})
    for number, one in enumerate(variables, start=1):
        attributes = {**_describe(one), "valueReference": str(number), **_get_unit(one)}
        if one.start is not None:
            attributes["start"] = repr(float(one.start))
        if one.derivative_of is not None:
            attributes["derivative"] = str(one.derivative_of)
        ElementTree.SubElement(listed, "Float64", attributes)
    outputs, rates = _find_unknowns(variables)
    structure = ElementTree.SubElement(root, "ModelStructure")
    for tag, numbers in (
        ("Output", outputs),
        ("ContinuousStateDerivative", rates),
        ("InitialUnknown", [*outputs, *rates]),
    ):
        for number in numbers:
            ElementTree.SubElement(structure, tag, valueReference=str(number))
    return root


def _describe_build(main: str) -> _Element:
    root = _Element("fmiBuildDescription", fmiVersion="3.0")
    build = ElementTree.SubElement(root, "BuildConfiguration", modelIdentifier=_IDENTIFIER)
    sources = ElementTree.SubElement(build, "SourceFileSet", language="C99")
    ElementTree.SubElement(sources, "SourceFile", name=main)
    return root


def _encode(root: _Element) -> bytes:
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="utf-8", xml_declaration=True)


def _write_data(model: _AffineModel, token: str) -> str:
    """Write the numbers of a model as C; ``repr`` of a number is exact."""
    slopes = [
        f"{{{k}, {entry}, {float(model.slopes[k].flat[entry])!r}}}"
        for k in range(len(model.slopes))
        for entry in np.flatnonzero(model.slopes[k])
    ]
    sizes = {
        "N_STATES": len(model.states),
        "N_INPUTS": len(model.inputs),
        "N_OUTPUTS": len(model.outputs),
        "N_PARAMETERS": len(model.derivatives),
        "N_SLOPES": len(slopes),
    }
    arrays = {
        "double BASE": [repr(value) for value in model.base.ravel().tolist()],
        "double START": [repr(float(value)) for value in model.derivatives.values()],
        "Slope SLOPES": slopes,
    }
    lines = ["/* Generated by flexsid. */", f'#define TOKEN "{token}"']
    lines += [f"#define {name} {size}" for name, size in sizes.items()]
    for name, values in arrays.items():
        lines += [f"static const {name}[] = {{", *(f"    {value}," for value in values), "};"]
    return "\n".join(lines) + "\n"
