"""Refits of a run: out-of-band modes at predicted values, one mode fewer, or a coarser mesh."""

from __future__ import annotations

from dataclasses import dataclass, replace

from flexsid.records.run import Aerodynamics, EstimationRun, Method, OutOfBandModes, Start
from flexsid.storage.store import Store
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.derivatives import list_derivative_names
from flexsid.workflow.aircraft.derivative_predictions import interpolate_values
from flexsid.workflow.modal_data.modal_tables import AircraftModes
from flexsid.workflow.model_structures.run_results import get_result
from flexsid.workflow.runs.identified_models import IdentifiedModel
from flexsid.workflow.runs.retained_modes import list_further_modes, select_widest_prediction

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
    """Add the further modes of the axis that a prediction covers, held at predicted values.

    The estimated parameters stay free and start at their estimates. None where no
    prediction covers further modes with these inputs, and for equation error, whose
    reconstruction includes out-of-band modes already.
    """
    if run.method is Method.EE:
        return None
    own, inputs = model.model.modes.numbers, model.model.inputs
    maneuver = store.maneuvers.get(run.maneuver_id)
    body = model.model.body
    known = list_derivative_names(own, inputs, body)
    used = run.prediction_id or get_result(run).prediction_id
    prediction = select_widest_prediction(
        store, used, maneuver.aircraft_id, modes, own, inputs, body
    )
    if prediction is None:
        return None
    fuel = maneuver.condition.fuel_fraction
    predicted = interpolate_values(store, prediction, fuel)
    further_modes = list_further_modes(prediction, modes, own, body)
    every = list_derivative_names((*own, *further_modes), inputs, body)
    further = [n for n in every if n not in known]
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
    settings = replace(
        run.settings,
        start=Start.BEST,
        start_run_id=None,
        priors=priors,
        out_of_band_modes=OutOfBandModes.OMITTED,
    )
    return replace(run, structure=structure, settings=settings)


def coarsen_mesh(store: Store, run: EstimationRun, fitted: EstimationRun) -> EstimationRun | None:
    """Give a run, or a refit of it, the frequency shape of the coarser mesh of its prediction.

    None for quasi-steady derivatives, and where the prediction has no coarser mesh.
    """
    used = get_result(fitted).prediction_id
    if used is None or fitted.settings.aerodynamics is not Aerodynamics.SHAPED:
        return None
    unsteady = store.predictions.get(used).unsteady
    if unsteady is None or unsteady.coarse_coefficients is None:
        return None
    settings = replace(
        fitted.settings,
        aerodynamics=Aerodynamics.SHAPED_COARSE_MESH,
        start=Start.BEST if fitted.method is Method.EE else Start.RUN,
        start_run_id=None if fitted.method is Method.EE else run.id,
    )
    return replace(fitted, settings=settings, prediction_id=used)


def find_omitted_modes(
    store: Store, run: EstimationRun, modes: AircraftModes, model: AeroelasticModel
) -> tuple[int, ...]:
    """Find modes of a model's axis that a prediction covers and the model omits."""
    aircraft_id = store.maneuvers.get(run.maneuver_id).aircraft_id
    covered = (
        list_further_modes(p, modes, model.modes.numbers, model.body)
        for p in store.predictions.find(aircraft_id=aircraft_id)
    )
    return max(covered, key=len, default=())
