"""Derived runs: refits of other runs on which a prediction rests."""

from __future__ import annotations

from collections.abc import Sequence

import sqlalchemy as sa

from flexsid.records.run import EstimationRun, RunState
from flexsid.storage.store import Store
from flexsid.storage.tables import runs

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
