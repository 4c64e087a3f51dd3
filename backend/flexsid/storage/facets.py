"""Facets: number of list items that each choice of a filter selects."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import sqlalchemy as sa
from sqlalchemy.engine import Connection

MOST_CHOICES = 500
"""Largest number of choices listed per facet."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Choice:
    """One choice of a filter, and the number of items that it selects with the other filters."""

    value: str
    label: str
    count: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Facets:
    """Number of items that all filters select, and the choices of each filter by its name."""

    total: int
    choices: dict[str, list[Choice]]


@dataclass(frozen=True, slots=True)
class Facet:
    """A filter: its column, its label, and the selected value."""

    value: sa.ColumnElement[Any]
    label: sa.ColumnElement[Any]
    selected: Any = None


def count_facets(
    connection: Connection,
    source: sa.FromClause,
    conditions: Sequence[sa.ColumnElement[bool]],
    facets: Mapping[str, Facet],
) -> Facets:
    """Count a list by all its facets at once.

    Parameters
    ----------
    connection
        A transaction to read in.
    source
        The joined tables of the list.
    conditions
        Filters of the list other than the facets.
    facets
        By name of the filter. The choices of each are counted without its own selection,
        with those of the others.

    Notes
    -----
    The list is read once: items are counted by all facets together, and
    the few hundred combinations that occur are summed here.
    """
    query = (
        sa.select(
            *(facet.value for facet in facets.values()),
            *(sa.func.min(facet.label) for facet in facets.values()),
            sa.func.count(),
        )
        .select_from(source)
        .where(*conditions)
        .group_by(*(facet.value for facet in facets.values()))
    )
    counts: dict[str, Counter[Any]] = {name: Counter() for name in facets}
    labels: dict[str, dict[Any, Any]] = {name: {} for name in facets}
    total = 0
    for row in connection.execute(query):
        values, shown, count = row[: len(facets)], row[len(facets) : -1], row[-1]
        unmatched = [
            name
            for (name, facet), value in zip(facets.items(), values, strict=True)
            if facet.selected is not None and facet.selected != value
        ]
        total += 0 if unmatched else count
        for name, value, label in zip(facets, values, shown, strict=True):
            if value is not None and unmatched in ([], [name]):
                counts[name][value] += count
                labels[name][value] = label
    return Facets(
        total=total, choices={name: _choices(counts[name], labels[name]) for name in facets}
    )


def _choices(counts: Counter[Any], labels: Mapping[Any, Any]) -> list[Choice]:
    found = sorted(counts, key=lambda value: labels[value])[:MOST_CHOICES]
    return [
        Choice(value=str(value), label=str(labels[value]), count=counts[value]) for value in found
    ]
