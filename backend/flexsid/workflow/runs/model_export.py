"""Export of an identified model: matrices with names, units and provenance."""

from __future__ import annotations

import io
from dataclasses import dataclass
from typing import Any

import numpy as np

from flexsid.nomenclature import describe
from flexsid.records.run import Method
from flexsid.storage.store import Store
from flexsid.workflow.runs.identified_models import load_identified_model


@dataclass(frozen=True, slots=True, kw_only=True)
class ModelExport:
    """The model of a run at the condition of its maneuver, in SI units and radians.

    x' = A x + B u, y = C x + D u; a sensor measures ``scales`` times y with a
    delay of ``delays_s``. ``units`` names the unit of every state, input and output. Instruments
    are not part of the model.
    """

    run_id: int
    maneuver_id: int
    method: Method
    airspeed_m_s: float
    dynamic_pressure_pa: float
    fuel_fraction: float
    modes: tuple[int, ...]
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    units: dict[str, str]
    A: list[list[float]]
    B: list[list[float]]
    C: list[list[float]]
    D: list[list[float]]
    delays_s: list[float]
    scales: list[float]
    derivatives: dict[str, float]
    versions: dict[str, str] | None


def export_model(store: Store, run_id: int) -> ModelExport:
    """Export the identified model of a run.

    Raises
    ------
    Conflict
        If the run has no result.
    """
    run = store.runs.get(run_id)
    found = load_identified_model(store, run)
    system = found.model.state_space(found.derivatives)
    condition = found.model.condition
    names = (*system.states, *system.inputs, *system.outputs)
    return ModelExport(
        run_id=run_id,
        maneuver_id=run.maneuver_id,
        method=run.method,
        airspeed_m_s=condition.airspeed,
        dynamic_pressure_pa=condition.dynamic_pressure,
        fuel_fraction=store.maneuvers.get(run.maneuver_id).condition.fuel_fraction,
        modes=found.model.modes.numbers,
        states=system.states,
        inputs=system.inputs,
        outputs=system.outputs,
        units={name: describe(name).unit for name in names},
        A=system.A.tolist(),
        B=system.B.tolist(),
        C=system.C.tolist(),
        D=system.D.tolist(),
        delays_s=found.delays.tolist(),
        scales=found.scales.tolist(),
        derivatives=found.derivatives.named(),
        versions=run.versions,
    )


def write_matlab_model(model: ModelExport) -> bytes:
    """Write a MATLAB 5 file with the arguments of ``ss`` of the Control System Toolbox.

    Notes
    -----
    In MATLAB: ``sys = ss(A, B, C, D, 'StateName', states, 'InputName', inputs,
    'OutputName', outputs, 'OutputDelay', delays_s)``.
    """
    from scipy import io as files  # imported for this format only

    content: dict[str, Any] = {
        name: np.array(getattr(model, name), dtype=float)
        for name in ("A", "B", "C", "D", "delays_s", "scales", "modes")
    }
    for name in ("states", "inputs", "outputs"):
        names = getattr(model, name)
        content[name] = np.array(names, dtype=object)
        content[f"{name[:-1]}_units"] = np.array([model.units[n] for n in names], dtype=object)
    for name in ("run_id", "airspeed_m_s", "dynamic_pressure_pa", "fuel_fraction"):
        content[name] = float(getattr(model, name))
    content["derivatives"] = np.array(list(model.derivatives), dtype=object)
    content["values"] = np.array(list(model.derivatives.values()))
    content["method"] = str(model.method)
    out: Any = io.BytesIO()  # the stubs of savemat accept no buffer
    files.savemat(out, content, oned_as="column")
    return out.getvalue()
