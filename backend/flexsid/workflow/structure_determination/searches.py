"""Model structure searches from request to result, and runs of their candidates."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from datetime import UTC, datetime
from typing import Any

import numpy as np

from flexsid.errors import BadInput, Cancelled, Conflict, FlexsidError, UnknownRecord
from flexsid.records.run import EstimationRun, Method, Progress, RunSettings, RunState
from flexsid.records.search import SearchCandidate, SearchResult, StructureSearch, TermGroup
from flexsid.storage import batches
from flexsid.storage.bulk import refuse_deleted
from flexsid.storage.store import Store
from flexsid.workflow.measurements.maneuver_spectra import load_channels
from flexsid.workflow.measurements.recording import remove_trim
from flexsid.workflow.model_structures.model_structures import check_structure
from flexsid.workflow.runs.computation import EstimationTask, read_versions
from flexsid.workflow.runs.estimation import prepare as prepare_run
from flexsid.workflow.runs.run_identity import add_hashes
from flexsid.workflow.structure_determination.computation import compute_search
from flexsid.workflow.structure_determination.task import (
    SearchTask,
    build_thresholds,
    check_same_candidates,
)

__all__ = ["compute_search", "create_candidate_run", "get_candidate", "prepare_search"]

ENDED = (RunState.SUCCEEDED, RunState.FAILED, RunState.CANCELLED)
_END_S = 0.5
_UNDECAYED = 0.02  # of the largest motion


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
    tasks = tuple(_prepare_maneuver(store, request, number) for number in ids)
    others = tuple(_prepare_maneuver(store, request, number) for number in unseen)
    check_same_candidates((*tasks, *others))
    build_thresholds(request.settings)
    return SearchTask(
        method=request.method,
        settings=request.settings,
        structure=request.structure,
        maneuvers=tasks,
        unseen=others,
        warnings=(
            *dict.fromkeys(warning for task in tasks for warning in task.warnings),
            *_warn_of_undecayed_motion(store, request, tasks),
        ),
    )


def add_search(store: Store, request: StructureSearch) -> StructureSearch:
    """Store a search request; an invalid one is refused.

    Raises
    ------
    BadInput
        As ``prepare_search``.
    Conflict
        If a maneuver was deleted.
    """
    refuse_deleted(store, (*request.maneuver_ids, *request.settings.validate_on))
    prepare_search(store, request)
    return store.searches.add(replace(request, state=RunState.QUEUED))


def run_search(
    store: Store, search_id: int, compute: Callable[[SearchTask], SearchResult]
) -> StructureSearch:
    """Run a queued search and store its result; one that has ended is returned unchanged.

    An error of the request or the software ends it as failed; other exceptions of ``compute``
    (``Cancelled``, an interrupt) are raised.
    """
    request = _update_search(store, search_id, state=RunState.RUNNING, progress=None)
    if request.state is not RunState.RUNNING:
        return request
    try:
        result = compute(prepare_search(store, request))
    except (Cancelled, KeyboardInterrupt):
        _update_search(store, search_id, state=RunState.CANCELLED, finished_at=datetime.now(UTC))
        raise
    except FlexsidError as error:
        return fail_search(store, search_id, error.code, error.message)
    return _update_search(
        store,
        search_id,
        state=RunState.SUCCEEDED,
        result=result,
        versions=read_versions(),
        finished_at=datetime.now(UTC),
    )


def fail_search(store: Store, search_id: int, code: str, message: str) -> StructureSearch:
    """End a search as failed with an error."""
    error = {"code": code, "message": message}
    now = datetime.now(UTC)
    return _update_search(store, search_id, state=RunState.FAILED, error=error, finished_at=now)


def cancel_search(store: Store, search_id: int) -> StructureSearch:
    """Cancel a search that has not ended.

    Raises
    ------
    Conflict
        If it has ended.
    """
    before = store.searches.get(search_id)
    if before.state in ENDED:
        raise Conflict(
            f"search {search_id} has {before.state.value} already; there is nothing to cancel",
            code="search-ended",
        )
    return _update_search(store, search_id, state=RunState.CANCELLED, finished_at=datetime.now(UTC))


def store_progress(store: Store, search_id: int, progress: Progress) -> bool:
    """Store the progress of a search; False if it has ended, e.g. by cancellation."""
    return _update_search(store, search_id, progress=progress).state is RunState.RUNNING


def _update_search(store: Store, search_id: int, **changes: Any) -> StructureSearch:
    """Update a search that has not ended, in one transaction."""
    with store.transaction():
        found = store.searches.get(search_id)
        if found.state in ENDED:
            return found
        return store.searches.replace(replace(found, **changes))


def get_group(store: Store, search_id: int, name: str | None) -> TermGroup:
    """Return a group of terms of a finished search by name; the first by default.

    Raises
    ------
    Conflict
        If the search has no result.
    UnknownRecord
        If it has no such group.
    """
    found = store.searches.get(search_id)
    if found.result is None:
        raise Conflict(
            f"search {search_id} is {found.state.value} and has no result yet",
            code="search-without-result",
        )
    for group in found.result.groups:
        if name in (None, group.name):
            return group
    names = ", ".join(group.name for group in found.result.groups)
    raise UnknownRecord(f"search {search_id} has no '{name}'; it has {names}")


def get_candidate(request: StructureSearch, number: int) -> SearchCandidate:
    """Return a candidate of a finished search by its index.

    Raises
    ------
    Conflict
        If the search has no result.
    UnknownRecord
        If it has no such candidate.
    """
    if request.result is None:
        raise Conflict(
            f"search {request.id} is {request.state.value} and has no candidates yet",
            code="search-without-result",
        )
    if not 0 <= number < len(request.result.candidates):
        raise UnknownRecord(f"search {request.id} has no candidate {number}")
    return request.result.candidates[number]


def create_candidate_run(store: Store, search_id: int, number: int, author: str) -> EstimationRun:
    """Return the run of a candidate; it is created at the first call."""
    with store.transaction():
        found = store.searches.get(search_id)
        candidate = get_candidate(found, number)
        if candidate.run_id is not None:
            return store.runs.get(candidate.run_id)
        settings = found.settings
        run, _ = batches.add_once(
            store,
            add_hashes(
                store,
                EstimationRun(
                    maneuver_id=found.maneuver_ids[0],
                    method=found.method,
                    structure=candidate.structure,
                    settings=RunSettings(
                        band_hz=settings.band_hz,
                        max_iterations=settings.max_iterations,
                        noise=settings.noise,
                        additional_maneuver_ids=found.maneuver_ids[1:],
                    ),
                    modal_table_id=found.modal_table_id,
                    damping_table_id=found.damping_table_id,
                    prediction_id=found.prediction_id,
                    author=author,
                ),
            ),
        )
        assert isinstance(found.result, SearchResult)
        candidates = list(found.result.candidates)
        candidates[number] = replace(candidate, run_id=run.id)
        store.searches.replace(
            replace(found, result=replace(found.result, candidates=tuple(candidates)))
        )
    return run


def _prepare_maneuver(store: Store, request: StructureSearch, maneuver_id: int) -> EstimationTask:
    settings = request.settings
    return prepare_run(
        store,
        EstimationRun(
            maneuver_id=maneuver_id,
            method=request.method,
            structure=request.structure,
            settings=RunSettings(
                band_hz=settings.band_hz,
                max_iterations=settings.max_iterations,
                noise=settings.noise,
            ),
            modal_table_id=request.modal_table_id,
            damping_table_id=request.damping_table_id,
            prediction_id=request.prediction_id,
        ),
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
