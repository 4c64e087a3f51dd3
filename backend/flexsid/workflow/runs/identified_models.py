"""The model that a run identified, put together again from what was kept."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from flexsid.records.run import EstimationRun
from flexsid.storage.store import Store
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.signals import FrequencyResponse
from flexsid.workflow.model_structures.run_results import result_of
from flexsid.workflow.runs.estimation import prepare


@dataclass(frozen=True, slots=True)
class IdentifiedModel:
    """A model with its derivatives; ``delays`` [s] and ``scales`` belong to the outputs.

    Its modes have the frequencies and dampings that were estimated.
    """

    model: AeroelasticModel
    derivatives: DerivativeTable
    delays: np.ndarray
    scales: np.ndarray

    def response(self, omega: np.ndarray) -> FrequencyResponse:
        """Frequency responses, estimated delays and scale factors included."""
        values = self.model.response(self.derivatives, omega)
        sensed = self.scales * np.exp(-1j * np.outer(omega, self.delays))
        return FrequencyResponse(
            omega, values * sensed[:, :, None], self.model.outputs, self.model.inputs
        )


def identified(store: Store, run: EstimationRun, maneuver_id: int | None = None) -> IdentifiedModel:
    """The estimate of a run at the condition of its maneuver, or of another one.

    Raises
    ------
    Conflict
        If the run has no result.
    """
    result_of(run)
    alone = replace(run.settings, together_with=())
    there = run.maneuver_id if maneuver_id is None else maneuver_id
    task = prepare(store, replace(run, maneuver_id=there, settings=alone))
    return identified_with(task.model, run)


def identified_with(model: AeroelasticModel, run: EstimationRun) -> IdentifiedModel:
    """The estimate of a run that succeeded, with the model that its task prepared."""
    result = result_of(run)
    values = run.structure.fixed | result.held
    values |= {parameter.name: parameter.value for parameter in result.parameters}
    return IdentifiedModel(
        model=replace(model, modes=model.modes.tuned(values)),
        derivatives=DerivativeTable.from_names(model.modes.numbers, model.inputs, values),
        delays=np.array([values.get(f"delay_{name}", 0.0) for name in model.outputs]),
        scales=np.array([values.get(f"scale_{name}", 1.0) for name in model.outputs]),
    )
