"""What a team changes, as numbers that differ after every change of a campaign."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import sqlalchemy as sa

from flexsid.storage.store import Store
from flexsid.storage.tables import (
    decisions,
    live_acknowledgements,
    live_streams,
    live_test_points,
    model_structures,
    notes,
    review_rules,
)

Totals = Mapping[tuple[str, int], object]
"""Numbers of a sort of records in a campaign, given by its aircraft."""

_Query = sa.Select[*tuple[Any, ...]]


def _of_stream(table: sa.Table, column: sa.ColumnElement[object]) -> _Query:
    campaign = live_streams.c.aircraft_id
    joined = sa.select(campaign, column, sa.func.count()).join_from(table, live_streams)
    return joined.group_by(campaign, column).order_by(campaign, column)


def _of_campaign(column: sa.Column[int], number: sa.ColumnElement[int]) -> _Query:
    return sa.select(column, number, sa.func.count()).group_by(column)


# Versions and ids only grow; streams and their test points change their status.
_QUERIES = {
    "decisions": (_of_campaign(decisions.c.aircraft_id, sa.func.sum(decisions.c.version)),),
    "model_structures": (
        _of_campaign(model_structures.c.aircraft_id, sa.func.sum(model_structures.c.version)),
    ),
    "notes": (_of_campaign(notes.c.aircraft_id, sa.func.max(notes.c.id)),),
    "review_rules": (_of_campaign(review_rules.c.aircraft_id, sa.func.max(review_rules.c.id)),),
    "live_streams": (
        _of_campaign(live_streams.c.aircraft_id, sa.func.count(live_streams.c.stopped_at)),
        _of_stream(live_test_points, live_test_points.c.status),
        _of_stream(live_acknowledgements, live_acknowledgements.c.kind),
    ),
}


def read_totals(store: Store) -> Totals:
    """Return the numbers of every sort of records in every campaign."""
    totals: dict[tuple[str, int], list[object]] = {}
    with store.database.reading() as connection:
        for name, queries in _QUERIES.items():
            for number, query in enumerate(queries):
                for campaign, *counts in connection.execute(query):
                    totals.setdefault((name, campaign), []).append((number, *counts))
    return totals


def find_changed(before: Totals, now: Totals) -> frozenset[tuple[str, int]]:
    """Return the sorts of records, with their campaigns, whose numbers differ."""
    keys = before.keys() | now.keys()
    return frozenset(key for key in keys if before.get(key) != now.get(key))
