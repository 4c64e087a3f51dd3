"""Batches: runs that are requested together, and refits of other runs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from datetime import datetime
from typing import Any

import sqlalchemy as sa

from flexsid.records.run import Batch, EstimationRun, RunState
from flexsid.storage.jobs import queue
from flexsid.storage.jobs.job_list import count_states
from flexsid.storage.lists.list_query import Page, read_cursor
from flexsid.storage.store import Store
from flexsid.storage.tables import batch_runs, batches, runs

# --- Batches: runs that are requested together; equal runs are stored once ------------------------

_AT_ONCE = 500  # values in one query
_SAME = (RunState.QUEUED.value, RunState.RUNNING.value, RunState.SUCCEEDED.value)


@dataclass(frozen=True, slots=True, kw_only=True)
class BatchProgress:
    """Progress of a batch."""

    batch: Batch
    states: dict[RunState, int]
    started_at: datetime | None
    finished_at: datetime | None


def add_once(store: Store, requested: EstimationRun) -> tuple[EstimationRun, bool]:
    """Queue a run, or return an equal run; and whether it is new."""
    with store.database.transaction() as connection:
        store.database.lock_writers(connection)
        known = _find_equal(store, [requested])
        if requested.input_hash in known:
            return store.runs.get(known[requested.input_hash]), False
        return queue.add(store, requested), True


def add(
    store: Store, batch: Batch, requested: Sequence[tuple[EstimationRun, int | None]]
) -> tuple[Batch, int]:
    """Queue the runs of a batch; return the batch and the number of new runs.

    Parameters
    ----------
    store
        Store of batches and runs.
    batch
        A batch that is not stored yet.
    requested
        Runs, each with the index in this list of the run that it starts from,
        which precedes it.
    """
    with store.database.transaction() as connection:
        store.database.lock_writers(connection)
        stored = store.batches.add(batch)
        known = _find_equal(store, [run for run, _ in requested])
        ids: list[int] = []
        new = 0
        for run, first in requested:
            if first is not None:
                settings = replace(run.settings, start_run_id=ids[first])
                run = replace(run, settings=settings, after_run_id=ids[first])
            number = known.get(run.input_hash)
            if number is None:
                number = queue.add(store, run).id
                assert number is not None
                known[run.input_hash] = number
                new += 1
            ids.append(number)
        rows = [{"batch_id": stored.id, "run_id": number} for number in dict.fromkeys(ids)]
        connection.execute(sa.insert(batch_runs), rows)
        return stored, new


def read_progress(store: Store, batch_id: int) -> BatchProgress:
    """Return the progress of a batch."""
    batch = store.batches.get(batch_id)
    with store.database.reading() as connection:
        query = _of(batch_id)
        counted = connection.execute(
            sa.select(runs.c.state, sa.func.count())
            .where(runs.c.id.in_(query))
            .group_by(runs.c.state)
        ).all()
        first, last = connection.execute(
            sa.select(sa.func.min(runs.c.started_at), sa.func.max(runs.c.finished_at)).where(
                runs.c.id.in_(query)
            )
        ).one()
    states = count_states(counted)
    over = states[RunState.QUEUED] + states[RunState.RUNNING] == 0
    return BatchProgress(
        batch=batch, states=states, started_at=first, finished_at=last if over else None
    )


def read_page(store: Store, *, limit: int = 100, after: str | None = None) -> Page[BatchProgress]:
    """Return batches, newest first."""
    query = sa.select(batches.c.id).order_by(batches.c.id.desc()).limit(limit + 1)
    if after is not None:
        query = query.where(batches.c.id < read_cursor(after))
    with store.database.reading() as connection:
        found = list(connection.scalars(query))
    shown = [read_progress(store, number) for number in found[:limit]]
    return Page(items=shown, next=str(found[limit - 1]) if len(found) > limit else None)


def cancel(store: Store, batch_id: int) -> BatchProgress:
    """Cancel the unfinished runs of a batch, except those of other batches."""
    others = sa.select(batch_runs.c.run_id).where(batch_runs.c.batch_id != batch_id)
    with store.transaction():
        store.batches.get(batch_id)
        queue.cancel(
            store, _members(store, _of(batch_id).where(batch_runs.c.run_id.not_in(others)))
        )
        return read_progress(store, batch_id)


def retry(store: Store, batch_id: int) -> BatchProgress:
    """Queue the failed and cancelled runs of a batch again."""
    with store.transaction():
        store.batches.get(batch_id)
        queue.retry(store, _members(store, _of(batch_id)))
        return read_progress(store, batch_id)


def _of(batch_id: int) -> sa.Select[tuple[int]]:
    return sa.select(batch_runs.c.run_id).where(batch_runs.c.batch_id == batch_id)


def _members(store: Store, query: sa.Select[Any]) -> list[int]:
    with store.database.reading() as connection:
        return list(connection.execute(query).scalars())


def _find_equal(store: Store, requested: Sequence[EstimationRun]) -> dict[str | None, int]:
    """Return ids of equal runs that did not fail and were not cancelled or deleted."""
    hashes = [run.input_hash for run in requested if run.input_hash is not None]
    found: dict[str | None, int] = {}
    with store.database.reading() as connection:
        for first in range(0, len(hashes), _AT_ONCE):
            some = hashes[first : first + _AT_ONCE]
            query = sa.select(runs.c.input_hash, runs.c.id).where(
                runs.c.input_hash.in_(some),
                runs.c.state.in_(_SAME),
                runs.c.deleted_at.is_(None),
            )
            found.update((name, number) for name, number in connection.execute(query))
    return found


# --- Derived runs: refits of other runs on which a prediction rests -------------------------------

_is_active = runs.c.deleted_at.is_(None)


def find_equal_run(store: Store, input_hash: str | None) -> EstimationRun | None:
    """Find a run of equal inputs that has succeeded, or else a derived one that failed.

    A derived run is stored as failed for its data and model only, so that it would fail again.
    """
    succeeded = runs.c.state == RunState.SUCCEEDED.value
    failed = runs.c.derived_from_run_id.is_not(None) & (runs.c.state == RunState.FAILED.value)
    query = (
        sa.select(runs.c.id)
        .where(runs.c.input_hash == input_hash, _is_active, succeeded | failed)
        .order_by(succeeded.desc(), runs.c.id.desc())
        .limit(1)
    )
    with store.database.reading() as connection:
        found = connection.scalar(query)
    return None if found is None else store.runs.get(found)


def find_derived_runs(store: Store, run_ids: Sequence[int]) -> list[int]:
    """Return the ids of the runs that were derived from these, deleted ones excluded."""
    query = sa.select(runs.c.id).where(runs.c.derived_from_run_id.in_(run_ids), _is_active)
    with store.database.reading() as connection:
        return list(connection.scalars(query))
