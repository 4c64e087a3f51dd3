"""Derived runs: refits of a run on which a prediction rests.

A worker fits them in its snapshot; the job that asked for them stores them with its result.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Generic, TypeVar

from flexsid.errors import Cancelled, FlexsidError
from flexsid.records.job import Job
from flexsid.records.run import (
    Aerodynamics,
    Derivation,
    DerivedRun,
    EstimationRun,
    Method,
    OutOfBandModes,
    Progress,
    ReportProgress,
    Start,
)
from flexsid.storage.jobs import queue
from flexsid.storage.jobs.batches import find_equal_run
from flexsid.storage.store import Store
from flexsid.sysid.estimation.estimate import Outcome
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.derivatives import list_derivative_names
from flexsid.workflow.aircraft.derivative_predictions import (
    interpolate_values,
    list_default_predictions,
)
from flexsid.workflow.fits.computation import ComputedRun, compute_run
from flexsid.workflow.modal_data.modal_tables import AircraftModes
from flexsid.workflow.model_structures.model_structures import get_result
from flexsid.workflow.runs.estimation import prepare, store_result
from flexsid.workflow.runs.exports import IdentifiedModel
from flexsid.workflow.runs.run_identity import add_hashes
from flexsid.workflow.runs.starts import list_further_modes, select_widest_prediction

# --- Derived runs: refits of a run on which a prediction rests, stored as ordinary runs -----------

Result = TypeVar("Result")


@dataclass(frozen=True, slots=True)
class DerivedFit:
    """A refit as computed: its request, its result or error, and its id in the snapshot."""

    requested: EstimationRun
    outcome: ComputedRun | FlexsidError
    id: int = 0


@dataclass(frozen=True, slots=True)
class DerivedResult(Generic[Result]):
    """A result that rests on refits, and those of them that are not stored yet."""

    result: Result
    fits: tuple[DerivedFit, ...]


class DerivedRuns:
    """Refits of the runs of one prediction.

    ``used`` lists all of them, ``computed`` those that were not stored yet.
    """

    def __init__(self, store: Store, report: ReportProgress) -> None:
        self._store = store
        self._report = report
        self.used: list[DerivedRun] = []
        self.computed: list[DerivedFit] = []

    def fit(
        self, run: EstimationRun, requested: EstimationRun, purpose: str, at: Progress
    ) -> EstimationRun | None:
        """Return the stored refit of a run, or compute and store it; None if it failed.

        Parameters
        ----------
        run
            The run that is refitted.
        requested
            The same with another model structure and settings.
        purpose
            What the refit is for, to complete "to ...".
        at
            Progress of the prediction, with which iterations are reported.
        """
        found = self._find_or_fit(
            EstimationRun(
                maneuver_id=requested.maneuver_id,
                method=requested.method,
                structure=requested.structure,
                settings=requested.settings,
                modal_table_id=requested.modal_table_id,
                damping_table_id=requested.damping_table_id,
                prediction_id=requested.prediction_id,
                author=run.author,
                derived_from_run_id=run.id,
                derivation=Derivation(purpose=purpose),
            ),
            at,
        )
        failure = _describe_failure(found)
        self.used.append(
            DerivedRun(
                run_id=run.id or 0, derived_run_id=found.id or 0, purpose=purpose, failure=failure
            )
        )
        return found if failure is None else None

    def _find_or_fit(self, requested: EstimationRun, at: Progress) -> EstimationRun:
        requested = add_hashes(self._store, requested)
        known = find_equal_run(self._store, requested.input_hash)
        if known is not None:
            return known

        def report(own: Progress) -> None:
            purpose = requested.derivation and requested.derivation.purpose
            message = f"{at.message}, to {purpose}: {own.message}"
            self._report(replace(own, fraction=at.fraction, message=message))

        try:
            fit = DerivedFit(requested, compute_run(prepare(self._store, requested), report))
        except Cancelled:
            raise
        except FlexsidError as error:
            fit = DerivedFit(requested, error)
        stored = _store_fit(self._store, fit)
        self.computed.append(replace(fit, id=stored.id or 0))
        return stored


def store_derived_fits(store: Store, fits: Sequence[DerivedFit], job: Job) -> dict[int, int]:
    """Store refits as runs derived for a job; return their ids by those in the snapshot.

    A refit that another job stored meanwhile is not stored again.
    """
    ids: dict[int, int] = {}
    for fit in fits:
        requested = fit.requested
        known = find_equal_run(store, requested.input_hash)
        if known is None:
            derivation = requested.derivation and replace(
                requested.derivation, job_kind=job.kind, job_id=job.id
            )
            requested = replace(requested, author=job.author, derivation=derivation)
            known = _store_fit(store, replace(fit, requested=requested), job.worker or "")
        ids[fit.id] = known.id or 0
    return ids


def renumber(derived_runs: Sequence[DerivedRun], ids: dict[int, int]) -> tuple[DerivedRun, ...]:
    """Replace the ids of refits in the snapshot by those that they are stored under."""
    return tuple(
        replace(one, derived_run_id=ids.get(one.derived_run_id, one.derived_run_id))
        for one in derived_runs
    )


def _store_fit(store: Store, fit: DerivedFit, worker: str = "") -> EstimationRun:
    """Store a refit as a run that has ended; no worker can start it."""
    with store.transaction():
        number = queue.add(store, fit.requested).id or 0
        claimed = queue.claim(store, number)
        assert claimed is not None
        if isinstance(fit.outcome, FlexsidError):
            code, message = fit.outcome.code, fit.outcome.message
            queue.fail(store, number, claimed.attempt, code, message, worker)
        else:
            store_result(store, number, claimed.attempt, fit.outcome, worker)
        return store.runs.get(number)


def _describe_failure(run: EstimationRun) -> str | None:
    """Describe why a refit has no optimum; None if it has one."""
    if run.error is not None:
        return run.error["message"]
    outcome = Outcome(get_result(run).fit.outcome)
    return None if outcome.is_optimum else f"the fit ended with {outcome}"


# --- Refits of a run: out-of-band modes at predicted values, one mode fewer, or a coarser mesh

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
    ids = (run.maneuver_id, *run.settings.additional_maneuver_ids)
    candidates = list_default_predictions(store, maneuver.aircraft_id, ids)
    prediction = select_widest_prediction(
        store, used, maneuver.aircraft_id, modes, own, inputs, body, candidates
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
