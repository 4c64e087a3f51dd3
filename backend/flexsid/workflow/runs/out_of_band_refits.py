"""A run fitted again: around modes it left out, carried as predicted, or with one mode fewer."""

from __future__ import annotations

from dataclasses import dataclass, replace

from flexsid.errors import FlexsidError
from flexsid.records.prediction import DerivativePrediction
from flexsid.records.run import EstimationRun, Method, Start
from flexsid.storage.store import Store
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.derivatives import derivative_names
from flexsid.workflow.aircraft.derivative_predictions import (
    best_prediction,
    predicted_modes,
    prediction_at,
)
from flexsid.workflow.modal_data.aligned_modes import AircraftModes
from flexsid.workflow.model_structures.run_results import result_of
from flexsid.workflow.runs.computation import ComputedRun, compute
from flexsid.workflow.runs.estimation import prepare
from flexsid.workflow.runs.identified_models import IdentifiedModel

_OF_MODES = ("omega_", "zeta_", "shape_")  # what may be free beyond derivatives, of one mode


@dataclass(frozen=True, slots=True)
class Wider:
    """What to ask for so that a run carries ``modes`` as a prediction has them."""

    run: EstimationRun
    modes: tuple[int, ...]
    source: str


def carrying(
    store: Store, run: EstimationRun, model: IdentifiedModel, modes: AircraftModes
) -> Wider | None:
    """The run with the further symmetric modes that a prediction covers, held as predicted.

    What the run estimated stays free and starts where the run ended; None where no
    prediction knows further modes of these inputs, and of equation error, whose
    reconstruction sees further modes already.
    """
    if run.method is Method.EE:
        return None
    own, inputs = model.model.modes.numbers, model.model.inputs
    maneuver = store.maneuvers.get(run.maneuver_id)
    known = derivative_names(own, inputs)
    prediction = _widest(store, run, maneuver.aircraft_id, modes, own, inputs)
    if prediction is None:
        return None
    fuel = maneuver.condition.fuel_fraction
    predicted = {n: value for n, (value, _) in prediction_at(store, prediction, fuel).items()}
    others = _others(prediction, modes, own)
    further = [n for n in derivative_names((*own, *others), inputs) if n not in known]
    if not others or not set(further) <= set(predicted):
        return None
    result = result_of(run)
    structure = replace(
        run.structure,
        modes=(*own, *others),
        inputs=inputs,
        free=tuple(p.name for p in result.parameters if p.name in known),
        fixed=result.held | {name: predicted[name] for name in further},
        fixed_to={},
        absent=(),
    )
    settings = replace(run.settings, start=Start.RUN, start_run_id=run.id)
    wider = replace(run, structure=structure, settings=settings, prediction_id=prediction.id)
    return Wider(wider, others, prediction.source)


def with_one_mode_fewer(run: EstimationRun) -> EstimationRun | None:
    """The run without its highest mode; None where that leaves no mode."""
    *kept, dropped = sorted(run.structure.modes) or [0]
    if not kept:
        return None
    gone = (f"CQ{dropped}_", f"_eta{dropped}", f"_etadot{dropped}")

    def stays(name: str) -> bool:
        return not (name.startswith(gone[0]) or name.endswith(gone[1:]))

    old = run.structure
    structure = replace(
        old,
        modes=tuple(number for number in old.modes if number != dropped),
        free=None if old.free is None else tuple(filter(stays, old.free)),
        fixed={name: value for name, value in old.fixed.items() if stays(name)},
        fixed_to={name: source for name, source in old.fixed_to.items() if stays(name)},
        absent=tuple(filter(stays, old.absent)),
        also_free=tuple(
            name
            for name in old.also_free
            if not (name.startswith(_OF_MODES) and name.endswith(f"_{dropped}"))
        ),
    )
    priors = {name: prior for name, prior in run.settings.priors.items() if stays(name)}
    settings = replace(run.settings, start=Start.BEST, start_run_id=None, priors=priors)
    return replace(run, structure=structure, settings=settings)


def fit_again(store: Store, run: EstimationRun) -> tuple[AeroelasticModel, ComputedRun] | None:
    """Fit what was asked for, with the model fitted; None where that cannot be done."""
    try:
        task = prepare(store, run)
        return task.model, compute(task, lambda progress: None)
    except FlexsidError:
        return None


def left_out(
    store: Store, run: EstimationRun, modes: AircraftModes, own: tuple[int, ...]
) -> tuple[int, ...]:
    """Symmetric modes that some prediction knows and a model of ``own`` modes has not."""
    aircraft_id = store.maneuvers.get(run.maneuver_id).aircraft_id
    covered = (_others(p, modes, own) for p in store.predictions.find(aircraft_id=aircraft_id))
    return max(covered, key=len, default=())


def _widest(
    store: Store,
    run: EstimationRun,
    aircraft_id: int,
    modes: AircraftModes,
    own: tuple[int, ...],
    inputs: tuple[str, ...],
) -> DerivativePrediction | None:
    """The prediction of the run where it knows further modes, else that which knows most."""
    used = run.prediction_id or result_of(run).prediction_id
    first = best_prediction(store, aircraft_id, used, own, inputs)
    if first is not None and _others(first, modes, own):
        return first
    known = store.predictions.find(aircraft_id=aircraft_id)
    return max(known, key=lambda p: len(_others(p, modes, own)), default=None)


def _others(
    prediction: DerivativePrediction, modes: AircraftModes, own: tuple[int, ...]
) -> tuple[int, ...]:
    covered = predicted_modes(prediction, modes.table.numbers)
    return tuple(n for n in covered if n not in own and modes.symmetric[n])
