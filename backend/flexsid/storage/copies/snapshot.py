"""Snapshot: the records that a computation needs, as a small database for a worker.

A worker has no database. Whatever workflow reads, from modal tables to samples, it reads from
the snapshot by the same functions, so that a job is a pure function of what it is sent.
"""

from __future__ import annotations

import hashlib
import re
import sqlite3
from collections.abc import Iterator, Sequence
from contextlib import closing
from typing import Any

import sqlalchemy as sa
from sqlalchemy.engine import Connection

from flexsid.storage import tables
from flexsid.storage.database import Database, make_memory_engine
from flexsid.storage.store import Store
from flexsid.storage.tables import metadata

_NAME = re.compile(r"\b[0-9a-f]{64}\b")
_AT_ONCE = 500  # names in one query
_OF_AIRCRAFT = (
    *(tables.modal_tables, tables.predictions, tables.controllers),
    tables.write_backs,
)
_OF_MANEUVERS = (tables.channels, tables.conditioning_steps)
_OF_MODAL_TABLES = (tables.modal_shapes, tables.mode_corrections)
_BY_ID = (
    *(tables.aircraft, tables.flights, tables.maneuvers, tables.designs, tables.jobs),
    tables.runs,
)
_EMPTY = (tables.job_events, tables.run_summaries)  # of runs that a worker adds
_TABLES = (*_BY_ID, *_EMPTY, *_OF_AIRCRAFT, *_OF_MANEUVERS, *_OF_MODAL_TABLES, tables.arrays)


def take_snapshot(
    store: Store,
    maneuver_ids: Sequence[int] = (),
    run_ids: Sequence[int] = (),
    design_ids: Sequence[int] = (),
) -> bytes:
    """Copy runs, maneuvers with samples, all that belongs to their aircraft, and designs.

    Parameters
    ----------
    store
        Store of the records.
    maneuver_ids
        Maneuvers, in addition to those of the runs.
    run_ids
        Runs.
    design_ids
        Excitation designs.

    Returns
    -------
    bytes
        An SQLite database, for ``open_snapshot``.

    Raises
    ------
    UnknownRecord
        If a run, maneuver or design does not exist.
    """
    requested = [store.runs.get(number) for number in run_ids]
    flown = {number for run in requested for number in run.settings.additional_maneuver_ids}
    flown |= {run.maneuver_id for run in requested} | set(maneuver_ids)
    maneuvers = [store.maneuvers.get(number) for number in sorted(flown)]
    ids: dict[str, list[int]] = {
        "aircraft": sorted({maneuver.aircraft_id for maneuver in maneuvers}),
        "flights": sorted({maneuver.flight_id for maneuver in maneuvers}),
        "maneuvers": sorted(flown),
        "designs": [store.designs.get(number).id or 0 for number in design_ids],
        "jobs": sorted(set(run_ids)),
        "runs": sorted(set(run_ids)),
    }
    with closing(sqlite3.connect(":memory:", check_same_thread=False)) as content:
        engine = make_memory_engine(content)
        with store.database.reading() as source, engine.begin() as target:
            metadata.create_all(target, tables=list(_TABLES))
            arrays: set[str] = set()
            for table, rows in _read_rows(source, ids):
                arrays.update(_NAME.findall(repr(rows)))
                if rows:
                    target.execute(sa.insert(table), rows)
            names = sorted(arrays)
            for first in range(0, len(names), _AT_ONCE):
                some = tables.arrays.c.hash.in_(names[first : first + _AT_ONCE])
                rows = _fetch(source, sa.select(tables.arrays).where(some))
                if rows:
                    target.execute(sa.insert(tables.arrays), rows)
        return content.serialize()


def open_snapshot(content: bytes) -> Store:
    """Return a store of the records of a snapshot, in memory; its address is of its content."""
    name = hashlib.sha256(content).hexdigest()
    connection = sqlite3.connect(":memory:", check_same_thread=False)
    connection.deserialize(content)
    return Store(Database(f"sqlite:///snapshot-{name}", make_memory_engine(connection)))


def _read_rows(
    source: Connection, ids: dict[str, list[int]]
) -> Iterator[tuple[sa.Table, list[dict[str, Any]]]]:
    modal_tables: list[int] = []
    for table in _BY_ID:
        yield table, _fetch(source, sa.select(table).where(table.c.id.in_(ids[table.name])))
    for table in _OF_AIRCRAFT:
        rows = _fetch(source, sa.select(table).where(table.c.aircraft_id.in_(ids["aircraft"])))
        if table is tables.modal_tables:
            modal_tables = [row["id"] for row in rows]
        yield table, rows
    for table in _OF_MANEUVERS:
        yield (
            table,
            _fetch(source, sa.select(table).where(table.c.maneuver_id.in_(ids["maneuvers"]))),
        )
    for table in _OF_MODAL_TABLES:
        yield (
            table,
            _fetch(source, sa.select(table).where(table.c.modal_table_id.in_(modal_tables))),
        )


def _fetch(source: Connection, query: sa.Select[Any]) -> list[dict[str, Any]]:
    return [dict(row) for row in source.execute(query).mappings()]
