"""Bulk actions on maneuvers and runs, and their reversal.

Deleted records are hidden from the lists and can be restored.
"""

from __future__ import annotations

from collections.abc import Sequence
from datetime import UTC, datetime
from enum import StrEnum

import sqlalchemy as sa
from sqlalchemy.engine import Connection

from flexsid.errors import BadInput, Conflict, UnknownRecord
from flexsid.records.run import RunState
from flexsid.storage.lists.campaign_rows import refuse_evidence
from flexsid.storage.lists.list_query import add_tag, remove_tag
from flexsid.storage.store import Store
from flexsid.storage.tables import maneuver_tags, maneuvers, run_tags, runs

_ACTIVE = (RunState.QUEUED.value, RunState.RUNNING.value)


class Action(StrEnum):
    """Bulk actions; each has an inverse."""

    DELETE = "delete"
    RESTORE = "restore"
    TAG = "tag"
    UNTAG = "untag"


def change_maneuvers(
    store: Store, ids: Sequence[int], action: Action, tag: str | None = None
) -> tuple[int, ...]:
    """Delete, restore, tag or untag maneuvers; the runs of a deleted maneuver are hidden too.

    Returns
    -------
    tuple of int
        Ids that were changed.

    Raises
    ------
    UnknownRecord
        If one of them does not exist; nothing is changed.
    Conflict
        If one to be deleted has a queued or running run, or is evidence of a
        decision in force.
    """
    active = sa.select(runs.c.maneuver_id).where(
        runs.c.maneuver_id.in_(ids), runs.c.state.in_(_ACTIVE), runs.c.deleted_at.is_(None)
    )
    return _change(store, maneuvers, maneuver_tags, ids, action, tag, "maneuver", active)


def refuse_deleted(store: Store, maneuver_ids: Sequence[int]) -> None:
    """Reject deleted maneuvers.

    Raises
    ------
    Conflict
        If one of them was deleted.
    """
    gone = maneuvers.c.deleted_at.is_not(None)
    with store.database.reading() as connection:
        deleted = set(connection.scalars(sa.select(maneuvers.c.id).where(gone)))
    for number in maneuver_ids:
        if number in deleted:
            raise Conflict(
                f"maneuver {number} was deleted; restore it first", code="deleted", id=number
            )


def change_runs(
    store: Store, ids: Sequence[int], action: Action, tag: str | None = None
) -> tuple[int, ...]:
    """Delete, restore, tag or untag runs; see ``change_maneuvers``."""
    active = sa.select(runs.c.id).where(runs.c.id.in_(ids), runs.c.state.in_(_ACTIVE))
    return _change(store, runs, run_tags, ids, action, tag, "run", active)


def _change(
    store: Store,
    table: sa.Table,
    tags: sa.Table,
    ids: Sequence[int],
    action: Action,
    tag: str | None,
    noun: str,
    active: sa.Select[tuple[int]],
) -> tuple[int, ...]:
    requested = list(dict.fromkeys(ids))
    with store.database.transaction() as connection:
        known = set(connection.scalars(sa.select(table.c.id).where(table.c.id.in_(requested))))
        for identity in requested:
            if identity not in known:
                raise UnknownRecord(f"there is no {noun} {identity}")
        if action in (Action.TAG, Action.UNTAG):
            if tag is None:
                raise BadInput(f"{action.value} needs a tag; enter one", code="no-tag")
            act = add_tag if action is Action.TAG else remove_tag
            return tuple(act(connection, tags, requested, tag))
        if action is Action.DELETE:
            still = connection.scalar(active.limit(1))
            if still is not None:
                what = f"run {still} is" if noun == "run" else f"maneuver {still} has a run that is"
                raise Conflict(
                    f"{what} queued or running; cancel it first", code="run-active", id=still
                )
            refuse_evidence(connection, noun, requested)
        return _hide(connection, table, requested, hide=action is Action.DELETE)


def _hide(
    connection: Connection, table: sa.Table, ids: list[int], *, hide: bool
) -> tuple[int, ...]:
    hidden = table.c.deleted_at.is_not(None)
    query = sa.select(table.c.id).where(table.c.id.in_(ids), ~hidden if hide else hidden)
    changed = tuple(connection.scalars(query.order_by(table.c.id)))
    moment = datetime.now(UTC) if hide else None
    connection.execute(sa.update(table).where(table.c.id.in_(changed)).values(deleted_at=moment))
    return changed
