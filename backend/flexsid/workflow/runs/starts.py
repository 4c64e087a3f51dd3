"""Start tables of an iterative estimation, and its priors."""

from __future__ import annotations

from flexsid.errors import BadInput
from flexsid.records.aircraft import Aircraft, DerivativePrediction
from flexsid.records.maneuver import Maneuver
from flexsid.records.run import EstimationRun, RunSettings, Start
from flexsid.storage.store import Store
from flexsid.sysid.estimation.nuisance import build_nuisance_prior
from flexsid.sysid.model.derivatives import DerivativeTable, list_derivative_names
from flexsid.sysid.model.longitudinal import LONGITUDINAL
from flexsid.sysid.model.reduction import residualize
from flexsid.sysid.model.rigid_body import RigidBody
from flexsid.workflow.aircraft.aircraft_models import build_flight_condition
from flexsid.workflow.aircraft.derivative_predictions import (
    interpolate_values,
    list_predicted_modes,
)
from flexsid.workflow.modal_data.modal_tables import AircraftModes
from flexsid.workflow.model_structures.run_results import refuse_altered

RESIDUALIZED = "residualized"  # suffix of a start table with residualised modes
_SPREADS = (1e-100, 1e100)  # of priors: their squares are finite


def is_residualized(name: str) -> bool:
    """Whether a start table contains residualised modes."""
    return name.endswith(RESIDUALIZED)


def select_starting_tables(
    store: Store,
    run: EstimationRun,
    predicted: dict[str, DerivativeTable],
    inputs: tuple[str, ...],
    body: RigidBody = LONGITUDINAL,
) -> dict[str, DerivativeTable]:
    """Select the start tables of the requested kind; they also supply held derivatives."""
    start = run.settings.start
    if start is Start.RUN:
        name = f"run {run.settings.start_run_id}"
        return {name: _read_start_of_run(store, run, run.structure.modes, inputs, body)}
    residualized = {n: t for n, t in predicted.items() if is_residualized(n)}
    if start is Start.RESIDUALIZED_PREDICTION:
        return residualized
    if start is Start.PREDICTION:
        return {n: t for n, t in predicted.items() if not is_residualized(n)}
    first = dict(list(predicted.items())[:1])  # the residualised one, where there is one
    if start is Start.EQUATION_ERROR:
        return first if run.structure.free is not None else {}
    return first


def _read_start_of_run(
    store: Store,
    run: EstimationRun,
    numbers: tuple[int, ...],
    inputs: tuple[str, ...],
    body: RigidBody,
) -> DerivativeTable:
    number = run.settings.start_run_id
    if number is None:
        raise BadInput("to start from a run, name it in start_run_id", code="no-start")
    other = store.runs.get(number)
    refuse_altered(other)
    if other.result is None:
        raise BadInput(
            f"run {number} is {other.state.value} and has no values to start from",
            code="no-start",
            run_id=number,
        )
    values = other.structure.fixed | other.result.held
    values |= {p.name: p.value for p in other.result.parameters}
    return DerivativeTable.from_names(numbers, inputs, values, body)


def build_predicted_tables(
    store: Store,
    prediction: DerivativePrediction | None,
    run: EstimationRun,
    maneuver: Maneuver,
    aircraft: Aircraft,
    modes: AircraftModes,
    inputs: tuple[str, ...],
    body: RigidBody = LONGITUDINAL,
) -> dict[str, DerivativeTable]:
    """Build tables of a prediction: residualised where it covers the model, and unchanged."""
    numbers = run.structure.modes
    if prediction is None:
        return {}
    fuel = maneuver.condition.fuel_fraction
    values = interpolate_values(store, prediction, fuel)
    covered = list_predicted_modes(prediction, modes.table.numbers, body)
    plain = DerivativeTable.from_names(numbers, inputs, values, body)
    if not set(list_derivative_names(numbers, inputs, body)) <= set(values):
        return {prediction.source: plain} if set(numbers) <= set(covered) else {}
    full = DerivativeTable.from_names(covered, inputs, values, body)
    condition = build_flight_condition(aircraft, maneuver.condition)
    reduced = residualize(full, modes.table.at(fuel), condition, numbers)
    return {f"{prediction.source}, {RESIDUALIZED}": reduced, prediction.source: plain}


def collect_priors(
    predicted: dict[str, DerivativeTable], free: tuple[str, ...], settings: RunSettings
) -> dict[str, tuple[float, float]]:
    """Collect the priors given by name, and those of the prediction if a spread is requested.

    Raises
    ------
    BadInput
        If a prior has no usable standard deviation.
    """
    priors = _collect_priors(predicted, free, settings)
    for name, (_, spread) in priors.items():
        if not _SPREADS[0] < spread < _SPREADS[1]:
            raise BadInput(
                f"the prior of '{name}' has a standard deviation of {spread:g}; give "
                "the uncertainty of the parameter",
                code="bad-prior",
                name=name,
            )
    return priors


def _collect_priors(
    predicted: dict[str, DerivativeTable], free: tuple[str, ...], settings: RunSettings
) -> dict[str, tuple[float, float]]:
    spread = settings.prior_spread
    if spread is None:
        return dict(settings.priors)
    if not spread > 0.0:
        raise BadInput(
            f"a prior spread of {spread:g} is no fraction of a derivative; give one above zero",
            code="bad-prior",
        )
    if not predicted:
        raise BadInput(
            "a prior spread needs a prediction that covers these modes and inputs; import one or "
            "give priors by name",
            code="no-prediction",
        )
    table = next(iter(predicted.values()))
    values = table.named()
    prior = build_nuisance_prior(table.modes, table.inputs, values, table.body)
    of_prediction = prior.list_priors(tuple(name for name in free if name in values), spread)
    return of_prediction | dict(settings.priors)
