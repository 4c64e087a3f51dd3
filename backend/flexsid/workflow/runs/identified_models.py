"""The identified model of a run, rebuilt from its stored result."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from flexsid.records.run import EstimationRun, RunResult
from flexsid.storage.reading import read_once
from flexsid.storage.store import Store
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.model.sensors import SensorRows
from flexsid.sysid.signals import FrequencyResponse
from flexsid.workflow.model_structures.run_results import get_result
from flexsid.workflow.runs.estimation import prepare


@dataclass(frozen=True, slots=True)
class IdentifiedModel:
    """A model with its derivatives; ``delays`` [s] and ``scales`` belong to the outputs.

    Its modes have the frequencies and dampings that were estimated. ``priors`` are mean and
    standard deviation of the parameters for which the analyst gave them.
    """

    model: AeroelasticModel
    derivatives: DerivativeTable
    delays: np.ndarray
    scales: np.ndarray
    priors: Mapping[str, tuple[float, float]] = field(
        default_factory=dict[str, tuple[float, float]]
    )

    def select_outputs(self, names: Sequence[str]) -> IdentifiedModel:
        """Return the same model with these of its outputs."""
        places = [self.model.outputs.index(name) for name in names]
        rows = SensorRows(tuple(names), self.model.sensors.polynomial[:, places])
        return replace(
            self,
            model=replace(self.model, sensors=rows),
            delays=self.delays[places],
            scales=self.scales[places],
        )

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
    asked = replace(run, maneuver_id=number, settings=alone)
    # Runs of several methods often have the same model.
    tables = (run.modal_table_id, run.damping_table_id, run.prediction_id)
    key = ("identified model", number, repr(run.structure), repr(alone), tables)
    task = read_once(key, lambda: prepare(store, asked))
    return replace(build_identified_model(task.model, run), priors=task.priors)


def build_identified_model(model: AeroelasticModel, run: EstimationRun) -> IdentifiedModel:
    """Build the identified model of a run that succeeded from its prepared model."""
    values = collect_values(run)
    return IdentifiedModel(
        model=replace(model, modes=model.modes.tuned(values)),
        derivatives=model.fill_table(values),
        delays=np.array([values.get(f"delay_{name}", 0.0) for name in model.outputs]),
        scales=np.array([values.get(f"scale_{name}", 1.0) for name in model.outputs]),
    )


def collect_values(run: EstimationRun) -> dict[str, float]:
    """Collect all derivatives and other parameters of a run that succeeded, by name."""
    result = get_result(run)
    values = run.structure.fixed | result.held
    values |= {parameter.name: parameter.value for parameter in result.parameters}
    if result.retained is not None:
        values |= {parameter.name: parameter.value for parameter in result.retained.parameters}
    return values


def read_covariance(store: Store, result: RunResult) -> tuple[tuple[str, ...], np.ndarray]:
    """Read the names and the covariance of all parameters, the nuisance parameters included."""
    names = tuple(parameter.name for parameter in result.parameters)
    if result.retained is None:
        return names, np.asarray(store.arrays.get(result.covariance))
    names += tuple(parameter.name for parameter in result.retained.parameters)
    return names, np.asarray(store.arrays.get(result.retained.covariance))
