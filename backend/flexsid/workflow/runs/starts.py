"""Start tables and priors of an estimation, with the out-of-band modes that it retains."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.aircraft import Aircraft, DerivativePrediction
from flexsid.records.maneuver import Maneuver
from flexsid.records.run import AdequacyState, EstimationRun, RunSettings, Start
from flexsid.storage.store import Store
from flexsid.sysid.estimation.experiment import is_shape_error
from flexsid.sysid.estimation.nuisance import NuisancePrior, build_nuisance_prior
from flexsid.sysid.estimation.priors import JointCovariance
from flexsid.sysid.model.derivatives import DerivativeTable, list_derivative_names
from flexsid.sysid.model.longitudinal import LONGITUDINAL
from flexsid.sysid.model.reduction import residualize
from flexsid.sysid.model.rigid_body import RigidBody
from flexsid.workflow.aircraft.aircraft_models import build_flight_condition
from flexsid.workflow.aircraft.derivative_predictions import (
    interpolate_prediction,
    interpolate_values,
    list_default_predictions,
    list_predicted_modes,
    select_prediction,
)
from flexsid.workflow.aircraft.written_back import list_maneuvers, read_written_versions
from flexsid.workflow.fits.estimation_task import WrittenPrior
from flexsid.workflow.modal_data.modal_tables import AircraftModes
from flexsid.workflow.model_structures.model_structures import refuse_altered

# --- Start tables of an iterative estimation, and its priors --------------------------------------

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


# --- Out-of-band modes that a run retains, and the prior of their derivatives ---------------------

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
        *(store, run.prediction_id, maneuver.aircraft_id, modes, modes_of_model, inputs, body),
        list_candidates(store, run, maneuver.aircraft_id),
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
    candidates: Sequence[DerivativePrediction] | None = None,
) -> DerivativePrediction | None:
    """Select the prediction of a run if it covers further modes, else that with most modes.

    ``candidates`` are those that it may have by default, the first of equal ones first.
    """
    known = list_default_predictions(store, aircraft_id) if candidates is None else candidates
    first = select_prediction(
        store, aircraft_id, prediction_id, modes_of_model, inputs, body, known
    )
    if first is not None and list_further_modes(first, modes, modes_of_model, body):
        return first
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


# --- Versions that a run may have, and posteriors that were written back as its priors ------------


def list_candidates(
    store: Store, run: EstimationRun, aircraft_id: int
) -> list[DerivativePrediction]:
    """List the predictions that a run may have; with a result, those that it was computed from."""
    if run.result is not None and run.rests_on is not None:
        known = store.predictions.find(aircraft_id=aircraft_id)
        return [one for one in known if f"prediction {one.id}" in run.rests_on]
    ids = (run.maneuver_id, *run.settings.additional_maneuver_ids)
    return list_default_predictions(store, aircraft_id, ids)


def refuse_double_count(store: Store, run: EstimationRun) -> None:
    """Refuse a run that names a version with the data of its own records.

    Its posterior is no independent prior of them: the data would count twice.

    Raises
    ------
    BadInput
        Naming the write-back, the maneuvers and the former version.
    """
    ids = (run.maneuver_id, *run.settings.additional_maneuver_ids)
    aircraft_id = store.maneuvers.get(run.maneuver_id).aircraft_id
    written = read_written_versions(store, aircraft_id, ids)
    for one in (
        written.find(prediction_id=run.prediction_id),
        written.find(modal_table_id=run.modal_table_id),
    ):
        if one is not None and (twice := written.maneuver_ids.intersection(one.maneuver_ids)):
            raise BadInput(
                f"write-back {one.id} contains the data of {list_maneuvers(twice)}, which this "
                "run would count twice; name the version before it (prediction "
                f"{one.former_prediction_id}, modal table {one.former_modal_table_id}), or none",
                code="counted-twice",
                write_back_id=one.id,
            )


def build_written_prior(
    store: Store,
    prediction: DerivativePrediction | None,
    maneuver: Maneuver,
    modal_table_id: int | None,
    numbers: Sequence[int],
    held_std: Mapping[str, float],
) -> WrittenPrior | None:
    """Build the prior of a prediction that was written back; None of another one.

    Parameters
    ----------
    store, prediction, maneuver
        The prediction of the run, which is read at the fuel of its maneuver.
    modal_table_id, numbers
        Modal table and modes of the model. The posterior of mode shapes is of the table that was
        written with it, and of the same modes, to whose largest shape the errors are relative;
        otherwise it is marginalised.
    held_std
        Standard deviations of derivatives due to the modal table at the condition of the run.

    Notes
    -----
    To the covariance of the earlier record are added, as independent errors, what it does not hold:
    the errors that the stored standard errors have beyond it (the modal table, mass and condition
    of the earlier run, the predicted change over fuel), and the error of the modal table at the
    condition of this run.
    """
    if prediction is None:
        return None
    aircraft_id = prediction.aircraft_id
    found = read_written_versions(store, aircraft_id).find(prediction_id=prediction.id)
    if found is None:
        return None
    at_fuel = interpolate_prediction(store, prediction, maneuver.condition.fuel_fraction)
    is_same = modal_table_id == found.modal_table_id and set(numbers) == set(found.modes)
    means = {
        name: at_fuel[name][0] if name in at_fuel else value
        for name, value in zip(found.names, found.values, strict=True)
        if name in at_fuel or (is_same and is_shape_error(name))
    }
    whole = JointCovariance(found.names, np.asarray(store.arrays.get(found.covariance)))
    joint = whole.select(means)
    beyond = np.zeros(len(joint.names))
    for k, name in enumerate(joint.names):
        own = at_fuel[name][1] if name in at_fuel else None
        stated = 0.0 if own is None else own**2 - joint.covariance[k, k]
        beyond[k] = max(stated, 0.0) + held_std.get(name, 0.0) ** 2
    joint = JointCovariance(joint.names, joint.covariance + np.diag(beyond))
    return WrittenPrior(means, joint, frozenset(found.names))


def describe_write_backs(
    store: Store, run: EstimationRun, aircraft_id: int, prediction: DerivativePrediction | None
) -> tuple[str, ...]:
    """State which write-back the priors of a run are of, and which one it may not use."""
    ids = (run.maneuver_id, *run.settings.additional_maneuver_ids)
    written = read_written_versions(store, aircraft_id, ids)
    sentences = []
    used = None if prediction is None else written.find(prediction_id=prediction.id)
    if used is not None:
        where = "all derivatives" if run.settings.prior_spread else "retained modes and shapes"
        sentences.append(
            f"The priors of {where} are the posterior of run {used.run_id} (write-back {used.id}), "
            f"with the data of {list_maneuvers(used.maneuver_ids)}: fused with estimates from "
            "these, they would count twice."
        )
        if used.adequacy is AdequacyState.SUSPECT:
            sentences.append(
                f"The tests of run {used.run_id}, whose posterior is the prior, reject its model: "
                "standard errors that rest on it may be too small."
            )
    sentences += [
        f"Write-back {one.id} has the data of this record and is not a prior of it: they would "
        "count twice."
        for one in written.list_passed_over()
    ]
    return tuple(sentences)
