"""Searching: a search for structure from request to result, and its candidates as runs."""

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
from flexsid.workflow.measurements.recording import trim_removed
from flexsid.workflow.measurements.transforms import load_channels
from flexsid.workflow.model_structures.model_structures import check_structure
from flexsid.workflow.runs.computation import EstimationTask, versions
from flexsid.workflow.runs.estimation import prepare as prepare_run
from flexsid.workflow.runs.run_identity import identified
from flexsid.workflow.structure_determination.computation import search
from flexsid.workflow.structure_determination.task import (
    SearchTask,
    check_same_candidates,
    thresholds_of,
)

__all__ = ["candidate_of", "open_as_run", "prepare_search", "search"]

ENDED = (RunState.SUCCEEDED, RunState.FAILED, RunState.CANCELLED)
_END_S = 0.5
_STILL_MOVING = 0.02  # of the largest motion


def prepare_search(store: Store, wanted: StructureSearch) -> SearchTask:
    """Read all that a search needs.

    Raises
    ------
    BadInput
        If there is no maneuver, one is named twice, they do not share candidates, or the
        structure does not fit one of them.
    """
    ids, unseen = wanted.maneuver_ids, wanted.settings.validate_on
    if not ids:
        raise BadInput("a search needs at least one maneuver", code="no-maneuver")
    if len(set(ids)) < len(ids):
        raise BadInput("a maneuver is named twice", code="twice")
    both = sorted(set(ids) & set(unseen))
    if both:
        raise BadInput(
            f"maneuver {both[0]} is searched and kept out for validation; choose one of the two",
            code="not-unseen",
            maneuver_id=both[0],
        )
    aircraft = store.aircraft.get(store.maneuvers.get(ids[0]).aircraft_id)
    check_structure(store, aircraft, wanted.structure)
    tasks = tuple(_task(store, wanted, number) for number in ids)
    others = tuple(_task(store, wanted, number) for number in unseen)
    check_same_candidates((*tasks, *others))
    thresholds_of(wanted.settings)
    return SearchTask(
        method=wanted.method,
        settings=wanted.settings,
        structure=wanted.structure,
        maneuvers=tasks,
        unseen=others,
        warnings=(
            *dict.fromkeys(warning for task in tasks for warning in task.warnings),
            *_still_moving(store, wanted, tasks),
        ),
    )


def add_search(store: Store, wanted: StructureSearch) -> StructureSearch:
    """Keep a request, refused at once if it cannot be carried out.

    Raises
    ------
    BadInput
        As ``prepare_search``.
    Conflict
        If a maneuver was deleted.
    """
    refuse_deleted(store, (*wanted.maneuver_ids, *wanted.settings.validate_on))
    prepare_search(store, wanted)
    return store.searches.add(replace(wanted, state=RunState.QUEUED))


def carry_out_search(
    store: Store, search_id: int, compute: Callable[[SearchTask], SearchResult]
) -> StructureSearch:
    """Carry out a search that waits, and keep what came out; one that has ended stays so.

    What is wrong with it, or with the software, ends it as failed; what ``compute`` raises
    otherwise (``Cancelled``, an interrupt) is passed on.
    """
    wanted = _passed(store, search_id, state=RunState.RUNNING, progress=None)
    if wanted.state is not RunState.RUNNING:
        return wanted
    try:
        result = compute(prepare_search(store, wanted))
    except (Cancelled, KeyboardInterrupt):
        _passed(store, search_id, state=RunState.CANCELLED, finished_at=datetime.now(UTC))
        raise
    except FlexsidError as error:
        return fail_search(store, search_id, error.code, error.message)
    return _passed(
        store,
        search_id,
        state=RunState.SUCCEEDED,
        result=result,
        versions=versions(),
        finished_at=datetime.now(UTC),
    )


def fail_search(store: Store, search_id: int, code: str, message: str) -> StructureSearch:
    """End a search with the reason why."""
    error = {"code": code, "message": message}
    now = datetime.now(UTC)
    return _passed(store, search_id, state=RunState.FAILED, error=error, finished_at=now)


def cancel_search(store: Store, search_id: int) -> StructureSearch:
    """Stop a search that has not ended.

    Raises
    ------
    Conflict
        If it has.
    """
    before = store.searches.get(search_id)
    if before.state in ENDED:
        raise Conflict(
            f"search {search_id} has {before.state.value} already; there is nothing to cancel",
            code="search-ended",
        )
    return _passed(store, search_id, state=RunState.CANCELLED, finished_at=datetime.now(UTC))


def note_progress(store: Store, search_id: int, progress: Progress) -> bool:
    """Write how far a search is; False where it has ended, e.g. by being cancelled."""
    return _passed(store, search_id, progress=progress).state is RunState.RUNNING


def _passed(store: Store, search_id: int, **changes: Any) -> StructureSearch:
    """Change a search that has not ended, in one transaction."""
    with store.transaction():
        found = store.searches.get(search_id)
        if found.state in ENDED:
            return found
        return store.searches.replace(replace(found, **changes))


def group_of(store: Store, search_id: int, name: str | None) -> TermGroup:
    """Terms that a finished search looked at together, by name; the first by default.

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
            f"search {search_id} is {found.state.value} and has found nothing yet",
            code="search-without-result",
        )
    for group in found.result.groups:
        if name in (None, group.name):
            return group
    names = ", ".join(group.name for group in found.result.groups)
    raise UnknownRecord(f"search {search_id} has no '{name}'; it has {names}")


def candidate_of(wanted: StructureSearch, number: int) -> SearchCandidate:
    """One candidate of a finished search, by its place.

    Raises
    ------
    Conflict
        If the search has no result.
    UnknownRecord
        If it has no such candidate.
    """
    if wanted.result is None:
        raise Conflict(
            f"search {wanted.id} is {wanted.state.value} and has no candidates yet",
            code="search-without-result",
        )
    if not 0 <= number < len(wanted.result.candidates):
        raise UnknownRecord(f"search {wanted.id} has no candidate {number}")
    return wanted.result.candidates[number]


def open_as_run(store: Store, search_id: int, number: int, author: str) -> EstimationRun:
    """The run of a candidate; it is asked for when first opened."""
    with store.transaction():
        found = store.searches.get(search_id)
        candidate = candidate_of(found, number)
        if candidate.run_id is not None:
            return store.runs.get(candidate.run_id)
        asked = found.settings
        run, _ = batches.add_once(
            store,
            identified(
                store,
                EstimationRun(
                    maneuver_id=found.maneuver_ids[0],
                    method=found.method,
                    structure=candidate.structure,
                    settings=RunSettings(
                        band_hz=asked.band_hz,
                        max_iterations=asked.max_iterations,
                        noise=asked.noise,
                        together_with=found.maneuver_ids[1:],
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


def _task(store: Store, wanted: StructureSearch, maneuver_id: int) -> EstimationTask:
    asked = wanted.settings
    return prepare_run(
        store,
        EstimationRun(
            maneuver_id=maneuver_id,
            method=wanted.method,
            structure=wanted.structure,
            settings=RunSettings(
                band_hz=asked.band_hz, max_iterations=asked.max_iterations, noise=asked.noise
            ),
            modal_table_id=wanted.modal_table_id,
            damping_table_id=wanted.damping_table_id,
            prediction_id=wanted.prediction_id,
        ),
    )


def _still_moving(
    store: Store, wanted: StructureSearch, tasks: tuple[EstimationTask, ...]
) -> tuple[str, ...]:
    """Warn of records that end before the motion has died away; OE takes that into account."""
    said = []
    if wanted.method is Method.OE:
        return ()
    for maneuver_id, task in zip(wanted.maneuver_ids, tasks, strict=True):
        maneuver = store.maneuvers.get(maneuver_id)
        excitation = maneuver.excitation
        recorded = {channel.name for channel in store.channels.find(maneuver_id=maneuver_id)}
        names = [name for name in task.model.outputs if name in recorded]
        if excitation is None or excitation.n_periods > 1 or not names:
            continue
        left = []
        for channel, samples in load_channels(store, maneuver_id, names):
            values = trim_removed(samples[:, None], channel.rate_hz, channel.start_s, maneuver)
            begin = round((excitation.start_s - channel.start_s) * channel.rate_hz)
            last = values[-max(2, round(_END_S * channel.rate_hz)) :]
            noise = np.var(values[:begin]) if begin > 2 else 0.0
            moving = max(float(np.mean(last**2) - noise), 0.0)
            left.append(np.sqrt(moving) / max(float(np.abs(values).max()), 1e-300))
        share = float(np.median(left))
        if share > _STILL_MOVING:
            said.append(
                f"{maneuver.label} ends while the aircraft still moves ({share:.0%} of its largest "
                "motion): what lies behind the end may pass for terms that are not there."
            )
    return tuple(said)
