"""The identified model of a run as a functional mock-up unit (FMU) with its source code."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from flexsid.errors import BadInput
from flexsid.storage.store import Store
from flexsid.sysid.exchange.fmu import (
    FmiVersion,
    FmuModel,
    FmuVariable,
    format_numbers,
    pack_fmu,
)
from flexsid.workflow.runs.identified_models import IdentifiedModel, load_identified_model

_AFFINE = 1e-9  # largest deviation from a sum over the derivatives, relative to the entries


@dataclass(frozen=True, slots=True, eq=False)
class _AffineModel:
    """[x'; y] = (M0 + sum of p_k M_k) [x; u]; ``slopes`` (p, n_rows, n_columns) are M_k."""

    states: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    base: np.ndarray
    derivatives: dict[str, float]
    slopes: np.ndarray


def write_fmu(store: Store, run_id: int, version: FmiVersion) -> bytes:
    """Write the identified model of a run as an FMU for Model Exchange.

    Parameters
    ----------
    store
        Database.
    run_id
        A run that succeeded. A frequency shape of its derivatives is represented by states of
        rational functions.
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
    """
    run = store.runs.get(run_id)
    model = _separate_derivatives(load_identified_model(store, run))
    about = (
        f"{run.method.value} estimation, run {run_id} of flexsid: perturbations about trim at the "
        "condition of its maneuver. Outputs are without delays and instruments."
    )
    variables = tuple(_list_variables(model))
    return pack_fmu(variables, FmuModel.LINEAR, _list_numbers(model), about, version)


def _separate_derivatives(found: IdentifiedModel) -> _AffineModel:
    """Separate the part of the system matrices that each derivative contributes.

    Raises
    ------
    BadInput
        If the matrices are not a sum over the derivatives.
    """
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


def _list_variables(model: _AffineModel) -> Iterator[FmuVariable]:
    """List the variables in the order of their value references."""
    for name in model.states:
        yield FmuVariable(name=f"state.{name}", symbol=name, causality="local", start=0.0)
    for number, name in enumerate(model.states, start=1):
        yield FmuVariable(
            name=f"der(state.{name})", symbol=name, causality="local", derivative_of=number, unit=""
        )
    for name in model.inputs:
        yield FmuVariable(name=f"input.{name}", symbol=name, causality="input", start=0.0)
    for name in model.outputs:
        yield FmuVariable(name=f"output.{name}", symbol=name, causality="output")
    for name, value in model.derivatives.items():
        yield FmuVariable(
            name=f"derivative.{name}",
            symbol=name,
            causality="parameter",
            variability="tunable",
            start=value,
        )


def _list_numbers(model: _AffineModel) -> dict[str, int | Sequence[str]]:
    """List the numbers of a model by their names in C."""
    slopes = [
        f"{{{k}, {entry}, {float(model.slopes[k].flat[entry])!r}}}"
        for k in range(len(model.slopes))
        for entry in np.flatnonzero(model.slopes[k])
    ]
    return {
        "N_STATES": len(model.states),
        "N_INPUTS": len(model.inputs),
        "N_OUTPUTS": len(model.outputs),
        "N_PARAMETERS": len(model.derivatives),
        "N_SLOPES": len(slopes),
        "double BASE": format_numbers(model.base.ravel().tolist()),
        "double START": format_numbers(list(model.derivatives.values())),
        "Slope SLOPES": slopes,
    }
