"""Model structure searches from request to result, and runs of their candidates."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from flexsid.errors import BadInput, Conflict, UnknownRecord
from flexsid.records.decision import Structure
from flexsid.records.job import NEW_JOB, Job
from flexsid.records.run import (
    AdequacyState,
    EstimationRun,
    Method,
    ParameterEstimate,
    RunSettings,
    RunState,
)
from flexsid.records.search import SearchResult, StructureSearch, TermGroup
from flexsid.storage.access import storing_in_campaign
from flexsid.storage.bulk import refuse_deleted
from flexsid.storage.jobs import batches, queue
from flexsid.storage.store import Store
from flexsid.sysid.structure_determination.selection import Thresholds
from flexsid.sysid.structure_determination.term_search import HELD_SIGMAS
from flexsid.workflow.fits.estimation_task import EstimationTask, read_versions
from flexsid.workflow.measurements.maneuver_spectra import load_channels
from flexsid.workflow.measurements.recording import remove_trim
from flexsid.workflow.model_structures.model_structures import check_structure
from flexsid.workflow.runs.estimation import prepare as prepare_run
from flexsid.workflow.runs.run_identity import add_hashes
from flexsid.workflow.runs.run_proposal import complete_request
from flexsid.workflow.structure_determination.computation import compute_search
from flexsid.workflow.structure_determination.term_search import HoldingRun, SearchTask

__all__ = ["compute_search", "create_candidate_run", "get_result", "prepare_search"]

_END_S = 0.5
_UNDECAYED = 0.02  # of the largest motion


@dataclass(frozen=True, slots=True, kw_only=True)
class StructureSearchRequest:
    """The search, which is stored with its result."""

    search_id: int


def prepare_search(store: Store, request: StructureSearch) -> SearchTask:
    """Read everything that a search needs.

    Raises
    ------
    BadInput
        If there is no maneuver, one is named twice, they do not share candidates, or the
        model structure does not fit one of them.
    """
    ids, unseen = request.maneuver_ids, request.settings.validate_on
    if not ids:
        raise BadInput("a search needs at least one maneuver", code="no-maneuver")
    if len(set(ids)) < len(ids):
        raise BadInput("a maneuver is named twice", code="twice")
    both = sorted(set(ids) & set(unseen))
    if both:
        raise BadInput(
            f"maneuver {both[0]} is used for the search and for validation; use it for one of them",
            code="not-unseen",
            maneuver_id=both[0],
        )
    aircraft = store.aircraft.get(store.maneuvers.get(ids[0]).aircraft_id)
    check_structure(store, aircraft, request.structure)
    tasks, others = (
        tuple(
            prepare_run(store, _build_run(request, request.structure, (number,)))
            for number in numbers
        )
        for numbers in (ids, unseen)
    )
    if request.method is Method.EE:
        # The errors that equation error gives shapes are too careful to select terms by.
        tasks, others = (
            tuple(replace(one, shape_errors={}, assumed=frozenset()) for one in some)
            for some in (tasks, others)
        )
    _check_same_candidates((*tasks, *others))
    settings = request.settings
    return SearchTask(
        method=request.method,
        settings=settings,
        thresholds=Thresholds(
            f_in=settings.f_in, f_out=settings.f_out, pse_noise=settings.pse_noise
        ),
        structure=request.structure,
        maneuvers=tasks,
        unseen=others,
        held=_find_held_terms(store, request, tasks[0].structure.modes),
        warnings=(
            *dict.fromkeys(warning for task in tasks for warning in task.warnings),
            *_warn_of_undecayed_motion(store, request, tasks),
        ),
    )


def add_search(store: Store, request: StructureSearch) -> StructureSearch:
    """Store a search request and queue its job; an invalid one is refused.

    Raises
    ------
    BadInput
        As ``prepare_search``.
    Conflict
        If a maneuver was deleted.
    """
    refuse_deleted(store, (*request.maneuver_ids, *request.settings.validate_on))
    request = _complete_request(store, request)
    prepare_search(store, request)
    with store.transaction(), storing_in_campaign(request.aircraft_id):
        stored = store.searches.add(replace(request, state=RunState.QUEUED))
        job = queue.add_job(
            store,
            replace(
                NEW_JOB,
                kind=queue.SEARCH,
                title=f"{request.method.value} search",
                author=request.author,
                request={"search_id": stored.id},
            ),
        )
        return store.searches.replace(replace(stored, job_id=job.id))


def store_search_result(
    store: Store, job: Job, request: StructureSearchRequest, result: SearchResult
) -> None:
    """Store the result of a search."""
    found = store.searches.get(request.search_id)
    store.searches.replace(replace(found, result=result, versions=read_versions()))


def get_group(store: Store, search_id: int, name: str | None) -> TermGroup:
    """Return a group of terms of a finished search by name; the first by default.

    Raises
    ------
    Conflict
        If the search has no result.
    UnknownRecord
        If it has no such group.
    """
    groups = get_result(store.searches.get(search_id)).groups
    for group in groups:
        if name in (None, group.name):
            return group
    names = ", ".join(group.name for group in groups)
    raise UnknownRecord(f"search {search_id} has no '{name}'; it has {names}")


def get_result(search: StructureSearch) -> SearchResult:
    """Return the result of a finished search.

    Raises
    ------
    Conflict
        If the search has none.
    """
    if search.result is None:
        raise Conflict(
            f"search {search.id} is {search.state.value} and has no result yet",
            code="search-without-result",
        )
    return search.result


def create_candidate_run(store: Store, search_id: int, number: int, author: str) -> EstimationRun:
    """Return the run of a candidate, by its index; it is created at the first call.

    Raises
    ------
    Conflict
        If the search has no result.
    UnknownRecord
        If it has no such candidate.
    """
    with store.transaction():
        found = store.searches.get(search_id)
        result = get_result(found)
        candidates = list(result.candidates)
        if not 0 <= number < len(candidates):
            raise UnknownRecord(f"search {search_id} has no candidate {number}")
        candidate = candidates[number]
        if candidate.run_id is not None:
            return store.runs.get(candidate.run_id)
        request = _build_run(found, candidate.structure, found.maneuver_ids)
        run, _ = batches.add_once(store, add_hashes(store, replace(request, author=author)))
        candidates[number] = replace(candidate, run_id=run.id)
        store.searches.replace(replace(found, result=replace(result, candidates=tuple(candidates))))
    return run


def _find_held_terms(
    store: Store, request: StructureSearch, modes: tuple[int, ...]
) -> dict[str, HoldingRun]:
    """Find the terms that a stored run of a maneuver holds, with the run that holds each most.

    Runs with other modes, and those that their tests reject, hold nothing.
    """
    held: dict[str, HoldingRun] = {}
    for maneuver_id in request.maneuver_ids:
        for run in store.runs.find(
            maneuver_id=maneuver_id, state=RunState.SUCCEEDED, deleted_at=None
        ):
            structure, result = run.structure, run.result
            if (
                run.id is None
                or result is None
                or run.altered
                or structure.axis != request.structure.axis
                or set(structure.modes) != set(modes)
                or result.adequacy.state is AdequacyState.SUSPECT
            ):
                continue
            for row in result.parameters:
                sigmas = _compute_sigmas(row)
                if sigmas > max(HELD_SIGMAS, held[row.name].sigmas if row.name in held else 0.0):
                    held[row.name] = HoldingRun(run.id, sigmas)
    return held


def _compute_sigmas(row: ParameterEstimate) -> float:
    """Compute a value over its standard error without what its covariance holds; 0 without one."""
    variance = (row.std_error or 0.0) ** 2 - row.held_std**2
    return abs(row.value) / variance**0.5 if variance > 0.0 else 0.0


def _complete_request(store: Store, request: StructureSearch) -> StructureSearch:
    """Return a search with the band and inputs that a run of all its maneuvers has by default."""
    ids = (*request.maneuver_ids, *request.settings.validate_on)
    if not ids:
        return request
    run = complete_request(store, _build_run(request, request.structure, ids))
    settings = replace(request.settings, band_hz=run.settings.band_hz)
    return replace(request, structure=run.structure, settings=settings)


def _build_run(
    search: StructureSearch, structure: Structure, maneuver_ids: tuple[int, ...]
) -> EstimationRun:
    """Build the request of a run of a model structure with the settings of a search."""
    return EstimationRun(
        maneuver_id=maneuver_ids[0],
        method=search.method,
        structure=structure,
        settings=RunSettings(
            band_hz=search.settings.band_hz,
            max_iterations=search.settings.max_iterations,
            noise=search.settings.noise,
            additional_maneuver_ids=maneuver_ids[1:],
        ),
        modal_table_id=search.modal_table_id,
        damping_table_id=search.damping_table_id,
        prediction_id=search.prediction_id,
    )


def _warn_of_undecayed_motion(
    store: Store, request: StructureSearch, tasks: tuple[EstimationTask, ...]
) -> tuple[str, ...]:
    """Warn of records that end before the motion has decayed; OE models that."""
    warnings = []
    if request.method is Method.OE:
        return ()
    for maneuver_id, task in zip(request.maneuver_ids, tasks, strict=True):
        maneuver = store.maneuvers.get(maneuver_id)
        excitation = maneuver.excitation
        recorded = {channel.name for channel in store.channels.find(maneuver_id=maneuver_id)}
        names = [name for name in task.model.outputs if name in recorded]
        if excitation is None or excitation.n_periods > 1 or not names:
            continue
        left = []
        for channel, samples in load_channels(store, maneuver_id, names):
            values = remove_trim(samples[:, None], channel.rate_hz, channel.start_s, maneuver)
            begin = round((excitation.start_s - channel.start_s) * channel.rate_hz)
            last = values[-max(2, round(_END_S * channel.rate_hz)) :]
            noise = np.var(values[:begin]) if begin > 2 else 0.0
            moving = max(float(np.mean(last**2) - noise), 0.0)
            left.append(np.sqrt(moving) / max(float(np.abs(values).max()), 1e-300))
        share = float(np.median(left))
        if share > _UNDECAYED:
            warnings.append(
                f"{maneuver.label} ends before the motion has decayed ({share:.0%} of its largest "
                "value): leakage may support terms that are not in the system."
            )
    return tuple(warnings)


def _check_same_candidates(tasks: tuple[EstimationTask, ...]) -> None:
    """Refuse maneuvers that cannot share one model structure: their inputs or modes differ."""
    first = tasks[0].model
    for task in tasks[1:]:
        other = task.model
        if other.inputs != first.inputs or other.modes.numbers != first.modes.numbers:
            raise BadInput(
                f"{task.maneuvers[0].label} has inputs {', '.join(other.inputs)}, "
                f"{tasks[0].maneuvers[0].label} has {', '.join(first.inputs)}; name the inputs "
                "of the model structure, or search over maneuvers with the same ones",
                code="other-candidates",
            )
