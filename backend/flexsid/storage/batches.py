"""Batches: runs that were asked for together, each kept once however often it is asked for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from datetime import datetime
from typing import Any

import sqlalchemy as sa

from flexsid.records.batch import Batch
from flexsid.records.run import EstimationRun, RunState
from flexsid.storage import queue
from flexsid.storage.job_list import count_states
from flexsid.storage.paging import Page, read_cursor
from flexsid.storage.store import Store
from flexsid.storage.tables import batch_runs, batches, runs

_AT_ONCE = 500  # values in one query
_SAME = (RunState.QUEUED.value, RunState.RUNNING.value, RunState.SUCCEEDED.value)


@dataclass(frozen=True, slots=True, kw_only=True)
class BatchProgress:
    """How far a batch is."""

    batch: Batch
    states: dict[RunState, int]
    started_at: datetime | None
    finished_at: datetime | None


def add_once(store: Store, wanted: EstimationRun) -> tuple[EstimationRun, bool]:
    """Queue a run, or return the one that was asked for before; and whether it is new."""
    with store.database.transaction() as connection:
        store.database.alone(connection)
        known = _known(store, [wanted])
        if wanted.input_hash in known:
            return store.runs.get(known[wanted.input_hash]), False
        return queue.add(store, wanted), True


def add(
    store: Store, batch: Batch, wanted: Sequence[tuple[EstimationRun, int | None]]
) -> tuple[Batch, int]:
    """Queue the runs of a batch, and return it with how many of them are new.

    Parameters
    ----------
    store
        Where they are kept.
    batch
        Not kept yet.
    wanted
        Runs, each with the place in this list of the one that it starts from.
        That one stands before it.
    """
    with store.database.transaction() as connection:
        store.database.alone(connection)
        kept = store.batches.add(batch)
        known = _known(store, [run for run, _ in wanted])
        ids: list[int] = []
        new = 0
        for run, first in wanted:
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
        rows = [{"batch_id": kept.id, "run_id": number} for number in dict.fromkeys(ids)]
        connection.execute(sa.insert(batch_runs), rows)
        return kept, new


def progress(store: Store, batch_id: int) -> BatchProgress:
    """Return how far a batch is."""
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


def page(store: Store, *, limit: int = 100, after: str | None = None) -> Page[BatchProgress]:
    """Return batches, newest first."""
    query = sa.select(batches.c.id).order_by(batches.c.id.desc()).limit(limit + 1)
    if after is not None:
        query = query.where(batches.c.id < read_cursor(after))
    with store.database.reading() as connection:
        found = list(connection.scalars(query))
    shown = [progress(store, number) for number in found[:limit]]
    return Page(items=shown, next=str(found[limit - 1]) if len(found) > limit else None)


def cancel(store: Store, batch_id: int) -> BatchProgress:
    """Cancel what has not ended of a batch, but for runs that another batch also wants."""
    others = sa.select(batch_runs.c.run_id).where(batch_runs.c.batch_id != batch_id)
    with store.transaction():
        store.batches.get(batch_id)
        queue.cancel(
            store, _members(store, _of(batch_id).where(batch_runs.c.run_id.not_in(others)))
        )
        return progress(store, batch_id)


def retry(store: Store, batch_id: int) -> BatchProgress:
    """Queue again what failed or was cancelled of a batch."""
    with store.transaction():
        store.batches.get(batch_id)
        queue.retry(store, _members(store, _of(batch_id)))
        return progress(store, batch_id)


def _of(batch_id: int) -> sa.Select[tuple[int]]:
    return sa.select(batch_runs.c.run_id).where(batch_runs.c.batch_id == batch_id)


def _members(store: Store, query: sa.Select[Any]) -> list[int]:
    with store.database.reading() as connection:
        return list(connection.execute(query).scalars())


def _known(store: Store, wanted: Sequence[EstimationRun]) -> dict[str | None, int]:
    """Ids of runs with the inputs of these that did not fail, nor were cancelled or deleted."""
    hashes = [run.input_hash for run in wanted if run.input_hash is not None]
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
