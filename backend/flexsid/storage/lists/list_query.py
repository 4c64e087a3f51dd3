"""Lists that are filtered, sorted, paged and counted, described as data, and their tags."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import Enum
from typing import Any, Generic, TypeVar

import sqlalchemy as sa
from sqlalchemy.engine import Connection

from flexsid.errors import BadInput

# --- Lists: all items, or a page of them with the cursor of the next page -------------------------

T = TypeVar("T")


@dataclass(frozen=True, slots=True, kw_only=True)
class Items(Generic[T]):
    """All items of a list."""

    items: list[T]


@dataclass(frozen=True, slots=True, kw_only=True)
class Page(Items[T]):
    """Some items of a list; ``next`` is None at its end."""

    next: str | None = None


def read_cursor(after: str) -> int:
    """Return the position of a cursor, ``next`` of the previous page."""
    if not (after.isascii() and after.isdigit() and len(after) <= 18):
        raise BadInput(
            f"after={after!r} is not a cursor; use `next` of the previous page",
            code="bad-cursor",
        )
    return int(after)


# --- Tags: short labels that an analyst assigns to maneuvers and runs -----------------------------


def read_tags(connection: Connection, table: sa.Table, ids: Iterable[int]) -> dict[int, list[str]]:
    """Return the tags of some records, in alphabetical order.

    Parameters
    ----------
    connection
        A transaction to read in.
    table
        ``maneuver_tags`` or ``run_tags``.
    ids
        Records on the page.
    """
    key = key_column(table)
    requested = list(ids)
    found: dict[int, list[str]] = {identity: [] for identity in requested}
    query = sa.select(key, table.c.tag).where(key.in_(requested)).order_by(table.c.tag)
    for identity, tag in connection.execute(query):
        found[identity].append(tag)
    return found


def add_tag(connection: Connection, table: sa.Table, ids: Iterable[int], tag: str) -> list[int]:
    """Add a tag to records; returns those that did not have it."""
    requested = list(ids)
    had = _find_tagged(connection, table, requested, tag)
    new = [identity for identity in requested if identity not in had]
    if new:
        name = key_column(table).name
        rows = [{name: identity, "tag": tag} for identity in new]
        connection.execute(sa.insert(table), rows)
    return new


def remove_tag(connection: Connection, table: sa.Table, ids: Iterable[int], tag: str) -> list[int]:
    """Remove a tag from records; returns those that had it."""
    requested = list(ids)
    had = _find_tagged(connection, table, requested, tag)
    connection.execute(sa.delete(table).where(key_column(table).in_(had), table.c.tag == tag))
    return [identity for identity in requested if identity in had]


def _find_tagged(connection: Connection, table: sa.Table, ids: list[int], tag: str) -> set[int]:
    query = sa.select(key_column(table)).where(key_column(table).in_(ids), table.c.tag == tag)
    return set(connection.scalars(query))


def key_column(table: sa.Table) -> sa.Column[int]:
    """Return the column of the tagged records."""
    return next(column for column in table.c if column.name != "tag")


# --- List query: a list that is filtered, sorted, paged and counted, described as data ------------

MOST_CHOICES = 500
"""Largest number of choices counted per filter."""

Conditions = list[sa.ColumnElement[bool]]


@dataclass(frozen=True, slots=True, kw_only=True)
class Facet:
    """A filter whose choices are counted.

    ``label`` is a column of the table to which ``column`` refers; without one the values are
    their own labels.
    """

    column: sa.ColumnElement[Any]
    label: sa.Column[Any] | None = None

    def read_labels(self, connection: Connection) -> dict[Any, Any] | None:
        """Return the label of each value, apart from the items, of which there are many more."""
        if self.label is None:
            return None
        (key,) = self.label.table.primary_key.columns
        return {row[0]: row[1] for row in connection.execute(sa.select(key, self.label))}


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


@dataclass(frozen=True, slots=True, kw_only=True)
class ListQuery:
    """One list of the database.

    Parameters
    ----------
    source
        Joined tables.
    key
        Id of an item; items of equal value are in the order of their ids.
    filters
        Condition of a given value, by name of the filter; None is no filter.
    switches
        Conditions if a filter is true, and otherwise.
    combined
        Conditions of several filters together.
    sortable
        Columns by name of the sort field.
    ties
        Columns that sort items of equal value before their ids do.
    facets
        Filters whose choices are counted.
    tags
        Table of the tags of the items, which the filter ``tag`` selects.
    """

    source: sa.FromClause
    key: sa.Column[int]
    filters: Mapping[str, Callable[[Any], sa.ColumnElement[bool]]]
    switches: Mapping[str, tuple[sa.ColumnElement[bool], sa.ColumnElement[bool]]]
    combined: Callable[[Mapping[str, Any]], Conditions] = lambda filters: []
    sortable: Mapping[str, sa.ColumnElement[Any]]
    ties: tuple[sa.ColumnElement[Any], ...] = ()
    facets: Mapping[str, Facet] = field(default_factory=dict)
    tags: sa.Table | None = None

    @property
    def sort_fields(self) -> tuple[str, ...]:
        """Names of the sort fields."""
        return tuple(sorted(self.sortable))

    def where(self, filters: Mapping[str, Any]) -> Conditions:
        """Return the conditions of some filters."""
        given = {
            name: value.value if isinstance(value, Enum) else value
            for name, value in filters.items()
            if value is not None
        }
        conditions = [
            condition(given[name]) for name, condition in self.filters.items() if name in given
        ]
        if self.tags is not None and "tag" in given:
            key = key_column(self.tags)
            conditions.append(self.key.in_(sa.select(key).where(self.tags.c.tag == given["tag"])))
        conditions += [
            on if given.get(name) else otherwise for name, (on, otherwise) in self.switches.items()
        ]
        return conditions + self.combined(given)

    def read_page(
        self,
        connection: Connection,
        columns: tuple[sa.ColumnElement[Any], ...],
        filters: Mapping[str, Any],
        sort: str,
        limit: int | None,
        after: str | None,
    ) -> Page[sa.RowMapping]:
        """Read one page of the list.

        Parameters
        ----------
        connection
            A transaction to read in.
        columns
            Columns of an item.
        filters
            Filters of the list.
        sort
            A sort field, with ``-`` in front for falling order; items that lack the value come
            last.
        limit
            Most items to return; None for all.
        after
            ``next`` of the page before.

        Raises
        ------
        BadInput
            If the list has no such sort field, or the cursor is not one.
        """
        offset = 0 if after is None else read_cursor(after)
        query = sa.select(*columns).select_from(self.source).where(*self.where(filters))
        query = query.order_by(*self._order(sort)).offset(offset)
        if limit is not None:
            query = query.limit(limit + 1)  # one more item shows that there is a next page
        rows = list(connection.execute(query).mappings())
        more = limit is not None and len(rows) > limit
        return Page(items=rows[:limit], next=str(offset + len(rows) - 1) if more else None)

    def count(self, connection: Connection, filters: Mapping[str, Any]) -> Facets:
        """Return the number of items, and that of each choice of a filter.

        The choices of a filter are counted without its own selection, with those of the others.
        """
        others = self.where({**filters, **dict.fromkeys(self.facets)})
        found = _count(connection, self.source, others, self.facets, filters)
        if self.tags is None:
            return found
        tagged = self.source.join(self.tags, key_column(self.tags) == self.key)
        facet = {"tag": Facet(column=self.tags.c.tag)}
        tags = _count(connection, tagged, self.where({**filters, "tag": None}), facet, {})
        return Facets(total=found.total, choices={**found.choices, **tags.choices})

    def _order(self, sort: str) -> Sequence[sa.ColumnElement[Any]]:
        name = sort.removeprefix("-")
        if name not in self.sortable:
            raise BadInput(
                f"the list cannot be sorted by {name!r}; expected one of"
                f" {', '.join(self.sort_fields)}",
                code="bad-sort",
            )
        falling = sort.startswith("-")
        column = self.sortable[name]
        directed = [one.desc() if falling else one.asc() for one in (column, self.key)]
        if column is self.key:
            return directed[:1]
        return [column.is_(None), directed[0], *self.ties, directed[1]]


def _count(
    connection: Connection,
    source: sa.FromClause,
    conditions: Conditions,
    facets: Mapping[str, Facet],
    selected: Mapping[str, Any],
) -> Facets:
    """Count by all facets at once, and sum the few hundred combinations that occur."""
    columns = [facet.column for facet in facets.values()]
    query = (
        sa.select(*columns, sa.func.count())
        .select_from(source)
        .where(*conditions)
        .group_by(*columns)
    )
    restricted = {name: selected[name] for name in facets if selected.get(name) is not None}
    counts: dict[str, Counter[Any]] = {name: Counter() for name in facets}
    total = 0
    for *row, count in connection.execute(query):
        values = dict(zip(facets, row, strict=True))
        unmatched = [name for name, value in restricted.items() if values[name] != value]
        total += 0 if unmatched else count
        for name, value in values.items():
            if value is not None and unmatched in ([], [name]):
                counts[name][value] += count
    return Facets(
        total=total,
        choices={
            name: _label(found, facets[name].read_labels(connection))
            for name, found in counts.items()
        },
    )


def _label(counts: Counter[Any], labels: Mapping[Any, Any] | None) -> list[Choice]:
    labelled = sorted(
        (value if labels is None else labels[value], value, count)
        for value, count in counts.items()
    )
    return [
        Choice(value=str(value), label=str(label), count=count)
        for label, value, count in labelled[:MOST_CHOICES]
    ]
