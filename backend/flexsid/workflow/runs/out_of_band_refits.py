"""Refits of a run with out-of-band modes at predicted values, or with one mode fewer."""

from __future__ import annotations

from dataclasses import dataclass, replace

from flexsid.errors import FlexsidError
from flexsid.records.prediction import DerivativePrediction
from flexsid.records.run import EstimationRun, Method, Start
from flexsid.storage.store import Store
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.derivatives import list_derivative_names
from flexsid.workflow.aircraft.derivative_predictions import (
    interpolate_prediction,
    list_predicted_modes,
    select_prediction,
)
from flexsid.workflow.modal_data.aligned_modes import AircraftModes
from flexsid.workflow.model_structures.run_results import get_result
from flexsid.workflow.runs.computation import ComputedRun, compute_run
from flexsid.workflow.runs.estimation import prepare
from flexsid.workflow.runs.identified_models import IdentifiedModel

_OF_MODES = ("omega_", "zeta_", "shape_")  # parameters of one mode that are no derivatives


@dataclass(frozen=True, slots=True)
class ExtendedRun:
    """Request that includes ``modes`` with the derivatives of a prediction."""

    run: EstimationRun
    modes: tuple[int, ...]
    source: str


def extend_with_predicted_modes(
    store: Store, run: EstimationRun, model: IdentifiedModel, modes: AircraftModes
) -> ExtendedRun | None:
    """Add the further symmetric modes that a prediction covers, held at predicted values.

    The estimated parameters stay free and start at their estimates. None where no
    prediction covers further modes with these inputs, and for equation error, whose
    reconstruction includes out-of-band modes already.
    """
    if run.method is Method.EE:
        return None
    own, inputs = model.model.modes.numbers, model.model.inputs
    maneuver = store.maneuvers.get(run.maneuver_id)
    known = list_derivative_names(own, inputs)
    prediction = _select_widest_prediction(store, run, maneuver.aircraft_id, modes, own, inputs)
    if prediction is None:
        return None
    fuel = maneuver.condition.fuel_fraction
    predicted = {
        n: value for n, (value, _) in interpolate_prediction(store, prediction, fuel).items()
    }
    further_modes = _list_further_modes(prediction, modes, own)
    further = [n for n in list_derivative_names((*own, *further_modes), inputs) if n not in known]
    if not further_modes or not set(further) <= set(predicted):
        return None
    result = get_result(run)
    structure = replace(
        run.structure,
        modes=(*own, *further_modes),
        inputs=inputs,
        free=tuple(p.name for p in result.parameters if p.name in known),
        fixed=result.held | {name: predicted[name] for name in further},
        fixed_to={},
        absent=(),
    )
    settings = replace(run.settings, start=Start.RUN, start_run_id=run.id)
    extended = replace(run, structure=structure, settings=settings, prediction_id=prediction.id)
    return ExtendedRun(extended, further_modes, prediction.source)


def remove_highest_mode(run: EstimationRun) -> EstimationRun | None:
    """Remove the highest mode from a run; None where no mode remains."""
    *remaining, dropped = sorted(run.structure.modes) or [0]
    if not remaining:
        return None
    affixes = (f"CQ{dropped}_", f"_eta{dropped}", f"_etadot{dropped}")

    def is_retained(name: str) -> bool:
        return not (name.startswith(affixes[0]) or name.endswith(affixes[1:]))

    old = run.structure
    structure = replace(
        old,
        modes=tuple(number for number in old.modes if number != dropped),
        free=None if old.free is None else tuple(filter(is_retained, old.free)),
        fixed={name: value for name, value in old.fixed.items() if is_retained(name)},
        fixed_to={name: source for name, source in old.fixed_to.items() if is_retained(name)},
        absent=tuple(filter(is_retained, old.absent)),
        extra_parameters=tuple(
            name
            for name in old.extra_parameters
            if not (name.startswith(_OF_MODES) and name.endswith(f"_{dropped}"))
        ),
    )
    priors = {name: prior for name, prior in run.settings.priors.items() if is_retained(name)}
    settings = replace(run.settings, start=Start.BEST, start_run_id=None, priors=priors)
    return replace(run, structure=structure, settings=settings)


def refit(store: Store, run: EstimationRun) -> tuple[AeroelasticModel, ComputedRun] | None:
    """Fit a run again; model and result, or None where the fit fails."""
    try:
        task = prepare(store, run)
        return task.model, compute_run(task, lambda progress: None)
    except FlexsidError:
        return None


def find_omitted_modes(
    store: Store, run: EstimationRun, modes: AircraftModes, own: tuple[int, ...]
) -> tuple[int, ...]:
    """Find symmetric modes that a prediction covers and a model of ``own`` modes omits."""
    aircraft_id = store.maneuvers.get(run.maneuver_id).aircraft_id
    covered = (
        _list_further_modes(p, modes, own) for p in store.predictions.find(aircraft_id=aircraft_id)
    )
    return max(covered, key=len, default=())


def _select_widest_prediction(
    store: Store,
    run: EstimationRun,
    aircraft_id: int,
    modes: AircraftModes,
    own: tuple[int, ...],
    inputs: tuple[str, ...],
) -> DerivativePrediction | None:
    """Select the prediction of the run if it covers further modes, else that with most modes."""
    used = run.prediction_id or get_result(run).prediction_id
    first = select_prediction(store, aircraft_id, used, own, inputs)
    if first is not None and _list_further_modes(first, modes, own):
        return first
    known = store.predictions.find(aircraft_id=aircraft_id)
    return max(known, key=lambda p: len(_list_further_modes(p, modes, own)), default=None)


def _list_further_modes(
    prediction: DerivativePrediction, modes: AircraftModes, own: tuple[int, ...]
) -> tuple[int, ...]:
    covered = list_predicted_modes(prediction, modes.table.numbers)
    return tuple(n for n in covered if n not in own and modes.symmetric[n])
