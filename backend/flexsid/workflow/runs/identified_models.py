"""The identified model of a run, rebuilt from its stored result."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from flexsid.records.run import EstimationRun
from flexsid.storage.store import Store
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.signals import FrequencyResponse
from flexsid.workflow.model_structures.run_results import get_result
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
        """Compute frequency responses with the estimated delays and scale factors."""
        values = self.model.response(self.derivatives, omega)
        sensed = self.scales * np.exp(-1j * np.outer(omega, self.delays))
        return FrequencyResponse(
            omega, values * sensed[:, :, None], self.model.outputs, self.model.inputs
        )


def load_identified_model(
    store: Store, run: EstimationRun, maneuver_id: int | None = None
) -> IdentifiedModel:
    """Build the identified model of a run at the condition of its maneuver or of another one.

    Raises
    ------
    Conflict
        If the run has no result.
    """
    get_result(run)
    alone = replace(run.settings, additional_maneuver_ids=())
    number = run.maneuver_id if maneuver_id is None else maneuver_id
    task = prepare(store, replace(run, maneuver_id=number, settings=alone))
    return build_identified_model(task.model, run)


def build_identified_model(model: AeroelasticModel, run: EstimationRun) -> IdentifiedModel:
    """Build the identified model of a run that succeeded from its prepared model."""
    result = get_result(run)
    values = run.structure.fixed | result.held
    values |= {parameter.name: parameter.value for parameter in result.parameters}
    return IdentifiedModel(
        model=replace(model, modes=model.modes.tuned(values)),
        derivatives=DerivativeTable.from_names(model.modes.numbers, model.inputs, values),
        delays=np.array([values.get(f"delay_{name}", 0.0) for name in model.outputs]),
        scales=np.array([values.get(f"scale_{name}", 1.0) for name in model.outputs]),
    )
