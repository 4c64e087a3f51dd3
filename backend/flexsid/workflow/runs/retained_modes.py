"""Out-of-band modes that a run retains, and the prior of their derivatives."""

from __future__ import annotations

from flexsid.records.aircraft import DerivativePrediction
from flexsid.records.maneuver import Maneuver
from flexsid.records.run import EstimationRun
from flexsid.storage.store import Store
from flexsid.sysid.estimation.nuisance import NuisancePrior, build_nuisance_prior
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.model.longitudinal import LONGITUDINAL
from flexsid.sysid.model.rigid_body import RigidBody
from flexsid.workflow.aircraft.derivative_predictions import (
    interpolate_values,
    list_predicted_modes,
    select_prediction,
)
from flexsid.workflow.modal_data.modal_tables import AircraftModes

_FEWEST_MODES = 8
"""Modes without prediction are retained, lowest first, up to this number of modes in all: more
of them change standard errors little, and computing time grows with their square."""


def select_nuisance(
    store: Store,
    run: EstimationRun,
    maneuver: Maneuver,
    modes_of_model: tuple[int, ...],
    modes: AircraftModes,
    inputs: tuple[str, ...],
    body: RigidBody = LONGITUDINAL,
) -> NuisancePrior | None:
    """Select the modes that a run retains, with the prior of all derivatives.

    Modes of the axis outside the model structure that a prediction covers, and the lowest of those
    without prediction. A run that has a result retains its modes.

    Parameters
    ----------
    store, run, maneuver
        The run and its first maneuver.
    modes_of_model
        Modes of the model structure.
    modes
        Modal data of the aircraft.
    inputs, body
        Of the model.

    Returns
    -------
    NuisancePrior or None
        None where no prediction gives the derivatives a size, or no further mode is known.
    """
    fuel = maneuver.condition.fuel_fraction
    prediction = select_widest_prediction(
        store, run.prediction_id, maneuver.aircraft_id, modes, modes_of_model, inputs, body
    )
    if prediction is None:
        return None
    if run.result is not None and run.result.retained is not None:
        further = run.result.retained.modes
    else:
        covered = list_further_modes(prediction, modes, modes_of_model, body)
        omega = dict(zip(modes.table.numbers, modes.table.at(fuel).omega.tolist(), strict=True))
        known = [
            number
            for number in sorted(omega, key=lambda number: omega[number])
            if modes.belongs_to(number, body) and number not in modes_of_model
        ]
        room = _FEWEST_MODES - len(modes_of_model) - len(covered)
        unpredicted = [number for number in known if number not in covered][: max(room, 0)]
        further = tuple(n for n in known if n in covered or n in unpredicted)
    if not further:
        return None
    values = interpolate_values(store, prediction, fuel)
    prior = build_nuisance_prior((*modes_of_model, *further), inputs, values, body)
    return prior if prior.covered.any() else None


def extend_table(table: DerivativeTable, mean: DerivativeTable) -> DerivativeTable:
    """Add the derivatives of retained modes at the mean of their prior to a table."""
    values = mean.named() | table.named()
    return DerivativeTable.from_names(mean.modes, mean.inputs, values, mean.body)


def select_widest_prediction(
    store: Store,
    prediction_id: int | None,
    aircraft_id: int,
    modes: AircraftModes,
    modes_of_model: tuple[int, ...],
    inputs: tuple[str, ...],
    body: RigidBody = LONGITUDINAL,
) -> DerivativePrediction | None:
    """Select the prediction of a run if it covers further modes, else that with most modes."""
    first = select_prediction(store, aircraft_id, prediction_id, modes_of_model, inputs, body)
    if first is not None and list_further_modes(first, modes, modes_of_model, body):
        return first
    known = store.predictions.find(aircraft_id=aircraft_id)
    widest = max(
        known, key=lambda p: len(list_further_modes(p, modes, modes_of_model, body)), default=None
    )
    return first if widest is None else widest


def list_further_modes(
    prediction: DerivativePrediction,
    modes: AircraftModes,
    modes_of_model: tuple[int, ...],
    body: RigidBody = LONGITUDINAL,
) -> tuple[int, ...]:
    """List the modes of an axis that a prediction covers and a model lacks."""
    covered = list_predicted_modes(prediction, modes.table.numbers, body)
    return tuple(n for n in covered if n not in modes_of_model and modes.belongs_to(n, body))
