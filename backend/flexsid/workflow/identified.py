"""The model that a run identified, put together again from what was kept."""

from __future__ import annotations

import numpy as np

from flexsid.errors import Conflict
from flexsid.records.run import EstimationRun
from flexsid.storage.store import Store
from flexsid.sysid.model.aeroelastic import StateSpace
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.signals import FrequencyResponse
from flexsid.workflow.estimation import prepare


def identified_model(store: Store, run: EstimationRun) -> StateSpace:
    """A, B, C, D of the estimate, without instruments and delays.

    Raises
    ------
    Conflict
        If the run has no result.
    """
    if run.result is None:
        raise Conflict(
            f"run {run.id} is {run.state.value} and has no model; choose a run that succeeded",
            code="run-without-result",
            run_id=run.id,
        )
    model = prepare(store, run).model
    values = {parameter.name: parameter.value for parameter in run.result.parameters}
    held = run.structure.fixed | run.result.held
    table = DerivativeTable.from_names(model.modes.numbers, model.inputs, held | values)
    return model.state_space(table)


def identified_responses(store: Store, run: EstimationRun, omega: np.ndarray) -> FrequencyResponse:
    """Frequency responses of the identified model, its estimated delays included."""
    system = identified_model(store, run)
    s = 1j * omega
    resolvent = s[:, None, None] * np.eye(system.A.shape[0]) - system.A
    values = (
        system.C
        @ np.linalg.solve(resolvent, np.broadcast_to(system.B, (omega.size, *system.B.shape)))
        + system.D
    )
    assert run.result is not None
    found = {parameter.name: parameter.value for parameter in run.result.parameters}
    delays = np.array([found.get(f"delay_{name}", 0.0) for name in system.outputs])
    return FrequencyResponse(
        omega, values * np.exp(-s[:, None] * delays)[:, :, None], system.outputs, system.inputs
    )
