"""Access: which campaigns a request may read and change, in every statement, and quotas.

A request of a server with accounts runs with an ``Access``. Every SELECT then has the condition
that its records belong to a campaign of the account, so that other records do not exist for it;
every INSERT, UPDATE and DELETE is refused outside the campaigns that the account may change.
Without an ``Access`` (personal mode, dispatcher, command line) statements are unchanged.

Tables name their campaign by ``aircraft_id``, or by a reference to a record that does.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from typing import Any

import sqlalchemy as sa
from sqlalchemy import event
from sqlalchemy.engine import Connection, Engine
from sqlalchemy.exc import DontWrapMixin
from sqlalchemy.sql import visitors

from flexsid.errors import BadInput, Conflict, FlexsidError, UnknownRecord
from flexsid.records.run import RunState
from flexsid.storage.tables import (
    arrays,
    channels,
    flight_channels,
    flights,
    jobs,
    maneuvers,
    metadata,
)

# --- Access: which campaigns a request may read and change, enforced in every statement -----------

Campaigns = frozenset[int] | None
"""Ids of aircraft; None for every campaign."""


class Forbidden(FlexsidError, DontWrapMixin):
    """The role of the account in a campaign does not permit the change."""

    code = "forbidden"


class NoCampaign(BadInput, DontWrapMixin):
    """A record without an aircraft needs a campaign, and the request names none."""

    code = "no-campaign"


class _Unknown(UnknownRecord, DontWrapMixin):
    """A new record refers to one that does not exist for the account."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Access:
    """Who acts, from where, and in which campaigns.

    Records without an aircraft of their own, such as designs, are stored in ``campaign``.
    """

    account_id: int | None
    author: str
    address: str = ""
    request_id: str = ""
    operation: str = ""
    readable: Campaigns = None
    writable: Campaigns = None
    campaign: int | None = None

    @property
    def is_restricted(self) -> bool:
        """Whether statements need conditions."""
        return self.readable is not None or self.writable is not None


_AT_ONCE = 500  # values in one query
_current: ContextVar[Access | None] = ContextVar("access", default=None)
_campaign: ContextVar[int | None] = ContextVar("campaign", default=None)


def get_access() -> Access | None:
    """Return the access of the present request; None without accounts."""
    return _current.get()


def set_access(access: Access | None) -> None:
    """Set the access of the present request, until its task ends."""
    _current.set(access)


@contextmanager
def using_access(access: Access | None) -> Iterator[None]:
    """Execute a block with this access."""
    token = _current.set(access)
    try:
        yield
    finally:
        _current.reset(token)


@contextmanager
def storing_in_campaign(aircraft_id: int | None) -> Iterator[None]:
    """Store records without an aircraft of their own in this campaign."""
    token = _campaign.set(aircraft_id)
    try:
        yield
    finally:
        _campaign.reset(token)


# The column by which a table belongs to a campaign, and the table that it refers to.
_BY_COLUMN: dict[str, tuple[str, str]] = {
    "aircraft": ("id", "aircraft"),
    **{
        name: ("aircraft_id", "aircraft")
        for name in (
            *("flights", "maneuvers", "mappings", "modal_tables", "flutter_summaries"),
            *("measured_responses", "predictions", "model_structures", "designs", "controllers"),
            *("saved_views", "review_rules", "decisions", "frozen_figures", "jobs", "batches"),
            *("searches", "audit_events", "live_streams", "global_model_versions", "notes"),
            *("run_templates", "write_backs"),
        )
    },
    **dict.fromkeys(
        ("channels", "conditioning_steps", "maneuver_quality", "maneuver_tags", "runs"),
        ("maneuver_id", "maneuvers"),
    ),
    "flight_channels": ("flight_id", "flights"),
    "modal_shapes": ("modal_table_id", "modal_tables"),
    "mode_corrections": ("modal_table_id", "modal_tables"),
    "structure_versions": ("structure_id", "model_structures"),
    "preflight_simulations": ("maneuver_id", "maneuvers"),
    "decision_events": ("decision_id", "decisions"),
    "job_events": ("job_id", "jobs"),
    "run_tags": ("run_id", "runs"),
    "run_summaries": ("run_id", "runs"),
    **dict.fromkeys(
        ("live_states", "live_test_points", "live_acknowledgements"), ("stream_id", "live_streams")
    ),
    "batch_runs": ("run_id", "runs"),
}

WITHOUT_CAMPAIGN = frozenset(
    {
        *("arrays", "leases", "looks"),  # named by content; of the dispatcher; by analyst
        "row_seals",  # written by triggers
        "upload_files",  # of accounts
        *("accounts", "memberships", "login_sessions", "api_tokens"),
        *("login_places", "login_failures"),
    }
)

OPTIONAL = frozenset(
    name
    for name, table in metadata.tables.items()
    if name in _BY_COLUMN and table.c[_BY_COLUMN[name][0]].nullable
)
"""Tables whose rows may belong to no campaign; without accounts they do not."""


def add_access_control(engine: Engine) -> None:
    """Enforce the present access in every statement of an engine."""

    @event.listens_for(engine, "before_execute", retval=True)
    def _restrict(
        connection: Connection,
        statement: Any,
        many: Sequence[Mapping[str, Any]],
        parameters: Mapping[str, Any],
        _options: Mapping[str, Any],
    ) -> tuple[Any, Any, Any]:
        access = _current.get()
        if isinstance(statement, sa.Insert):
            campaign = _campaign.get()
            if campaign is None and access is not None:
                campaign = access.campaign
            statement, many, parameters = _insert_campaign(statement, many, parameters, campaign)
        if access is None or not access.is_restricted:
            return statement, many, parameters
        if isinstance(statement, sa.Insert):
            with using_access(None):
                _check_insert(connection, statement, list(many) or [parameters], access)
        elif isinstance(statement, sa.Update | sa.Delete):
            with using_access(None):
                _check_change(connection, statement, access)
            statement = _restrict_change(statement, access.readable)
        elif isinstance(statement, sa.SelectBase):
            statement = restrict_select(statement, access.readable)
        return statement, many, parameters


def belongs_to(table: Any, name: str, campaigns: Campaigns) -> sa.ColumnElement[bool] | None:
    """Return the condition that a row belongs to one of the campaigns; None for every one.

    ``table`` is the table of this name, or an alias of it.
    """
    if campaigns is None or name not in _BY_COLUMN:
        return None
    column, of = _BY_COLUMN[name]
    if of == "aircraft":
        return table.c[column].in_(sorted(campaigns))
    # An alias, so that the subquery is not correlated with the same table of the statement.
    parent = metadata.tables[of].alias()
    condition = belongs_to(parent, of, campaigns)
    assert condition is not None
    return table.c[column].in_(sa.select(parent.c.id).where(condition))


def find_campaigns(
    connection: Connection, name: str, ids: Collection[int], campaigns: Campaigns
) -> dict[int, int | None]:
    """Return the campaign of each of these records of a table that belongs to the campaigns."""
    table = metadata.tables[name]
    column, of = _BY_COLUMN[name]
    source, campaign = table, table.c[column]
    if of != "aircraft":
        parent = metadata.tables[of]
        source, campaign = table.join(parent, parent.c.id == table.c[column]), parent.c.aircraft_id
    found: dict[int, int | None] = {}
    ordered = sorted(ids)
    for first in range(0, len(ordered), _AT_ONCE):
        some = table.c.id.in_(ordered[first : first + _AT_ONCE])
        query = sa.select(table.c.id, campaign).select_from(source).where(some)
        if campaigns is not None:
            query = query.where(campaign.in_(sorted(campaigns)))
        found.update((number, one) for number, one in connection.execute(query))
    return found


def restrict_select(statement: Any, campaigns: Campaigns) -> Any:
    """Return a statement that reads records of these campaigns only, in every subquery too.

    Rows on the right of an outer join are not restricted: they belong to the row on its left.
    """

    def visit(select: sa.Select[Any]) -> None:
        for found in select.get_final_froms():
            for table, name in _list_tables(found):
                condition = belongs_to(table, name, campaigns)
                if condition is not None:
                    # The statement is a copy, whose conditions may be extended in place.
                    select._where_criteria += (condition,)

    return visitors.cloned_traverse(statement, {}, {"select": visit})


def _list_tables(source: Any) -> Iterator[tuple[Any, str]]:
    if isinstance(source, sa.Join):
        yield from _list_tables(source.left)
        if not source.isouter:
            yield from _list_tables(source.right)
    elif isinstance(source, sa.Table):
        yield source, source.name
    elif isinstance(source, sa.Alias) and isinstance(source.element, sa.Table):
        yield source, source.element.name


def _restrict_change(statement: Any, campaigns: Campaigns) -> Any:
    condition = belongs_to(statement.table, statement.table.name, campaigns)
    return statement if condition is None else statement.where(condition)


def _check_change(connection: Connection, statement: Any, access: Access) -> None:
    """Refuse to change rows that the account may read, but not change."""
    name = statement.table.name
    writable = belongs_to(statement.table, name, access.writable)
    if writable is None:
        return
    readable = belongs_to(statement.table, name, access.readable)
    conditions = [*statement._where_criteria, ~writable]
    if readable is not None:
        conditions.append(readable)
    query = sa.select(sa.literal(1)).select_from(statement.table).where(*conditions).limit(1)
    if connection.scalar(query) is not None:
        raise Forbidden("your role in this campaign does not permit this change")


def _insert_campaign(
    statement: Any,
    many: Sequence[Mapping[str, Any]],
    parameters: Mapping[str, Any],
    campaign: int | None,
) -> tuple[Any, Any, Any]:
    """Add the campaign to new rows whose records do not name it."""
    if campaign is None or statement.table.name not in OPTIONAL:
        return statement, many, parameters
    if statement._values is not None:
        if "aircraft_id" not in _read_values(statement):
            statement = statement.values(aircraft_id=campaign)
        return statement, many, parameters
    added = [{"aircraft_id": campaign, **row} for row in (many or [parameters])]
    return statement, added, {}


def _check_insert(
    connection: Connection, statement: Any, rows: Sequence[Mapping[str, Any]], access: Access
) -> None:
    """Refuse new rows outside the campaigns, or that refer to records outside of them."""
    table = statement.table
    name = table.name
    if statement._values is not None:
        rows = [{**_read_values(statement), **row} for row in rows]
    if name == "aircraft":
        if access.writable is not None:
            raise Forbidden("new aircraft are added by administrators of all campaigns")
        return
    own_column = _BY_COLUMN[name][0] if name in _BY_COLUMN else None
    for key in table.foreign_keys:
        parent = key.column.table
        if parent.name not in _BY_COLUMN:
            continue
        column = key.parent.key
        campaigns = access.writable if column == own_column else access.readable
        given = {row.get(column) for row in rows}
        values: set[int] = {value for value in given if value is not None}
        if None in given and column == own_column and access.writable is not None:
            raise NoCampaign(
                f"a new record of {name.replace('_', ' ')} needs a campaign: name it by the "
                "header X-Flexsid-Campaign, the id of its aircraft"
            )
        for condition, error in (
            (belongs_to(parent, parent.name, access.readable), _Unknown),
            (belongs_to(parent, parent.name, campaigns), Forbidden),
        ):
            if condition is None or not values:
                continue
            query = sa.select(parent.c.id).where(parent.c.id.in_(sorted(values)), condition)
            for missing in sorted(values - set(connection.scalars(query))):
                if error is Forbidden:
                    raise Forbidden("your role in this campaign does not permit this change")
                raise _Unknown(f"there is no {parent.name.replace('_', ' ')} {missing}")


def _read_values(statement: Any) -> dict[str, Any]:
    return {
        getattr(column, "key", column): getattr(value, "value", value)
        for column, value in statement._values.items()
    }


# --- Quotas of a shared server: jobs of an analyst, recordings of a campaign, uploads -------------

GIGABYTE = 10**9
_SAMPLE_BYTES = 8  # of float64, the largest type of a recorded sample
_UNFINISHED = jobs.c.state.in_((RunState.QUEUED.value, RunState.RUNNING.value))


@dataclass(frozen=True, slots=True, kw_only=True)
class Quotas:
    """Most that is accepted from requests; None without a limit.

    ``unfinished_jobs`` of an analyst wait or run; the samples of the flights and maneuvers of a
    campaign have ``recorded_bytes``. The content of uploaded files is at most ``expansion`` times
    as large as they are; uploads that are not imported take ``account_upload_bytes`` of an account,
    and ``upload_bytes`` in all. Jobs and streams store their results beyond: a quota never
    loses what was flown or computed.
    """

    unfinished_jobs: int | None = None
    recorded_bytes: int | None = None
    expansion: int | None = None
    account_upload_bytes: int | None = None
    upload_bytes: int | None = None


class QueueFull(Conflict):
    """The analyst has as many unfinished jobs as the server accepts."""

    code = "queue-full"


class CampaignFull(Conflict):
    """The recordings of a campaign would take more than its quota."""

    code = "campaign-full"


class AccountUploadsFull(BadInput):
    """The uploads of an account would take more than its quota."""

    code = "uploads-full"


def check_unfinished_jobs(connection: Connection, author: str, quotas: Quotas) -> None:
    """Refuse a further job of an analyst beyond the quota.

    Raises
    ------
    QueueFull
        If the analyst has as many unfinished jobs.
    """
    most = quotas.unfinished_jobs
    if most is None:
        return
    query = sa.select(sa.func.count()).select_from(jobs).where(jobs.c.author == author, _UNFINISHED)
    with using_access(None):  # those of all campaigns
        count = connection.execute(query).scalar_one()
    if count >= most:
        raise QueueFull(
            f"{count} jobs of {author or 'analysts without a name'} have not ended, and with this"
            f" request there would be more than {most}; wait until some have ended, cancel some, or"
            " ask for fewer runs at once"
        )


def check_recorded_bytes(
    connection: Connection, aircraft_id: int | None, added: int, quotas: Quotas
) -> None:
    """Refuse recordings beyond the quota of a campaign, given by its aircraft.

    Raises
    ------
    CampaignFull
        If there would be more.
    """
    most = quotas.recorded_bytes
    if most is None:
        return
    present = 0 if aircraft_id is None else count_recorded_bytes(connection, aircraft_id)
    if present + added > most:
        raise CampaignFull(
            f"the recordings of this campaign take {present / GIGABYTE:.3g} GB, these"
            f" {added / GIGABYTE:.3g} GB more, and its quota is {most / GIGABYTE:.3g} GB; delete"
            " recordings, or ask who operates this server"
        )


def count_recorded_bytes(connection: Connection, aircraft_id: int) -> int:
    """Return the size of all samples of the flights and maneuvers of an aircraft."""
    names = sa.union(
        sa.select(flight_channels.c.array)
        .join(flights, flights.c.id == flight_channels.c.flight_id)
        .where(flights.c.aircraft_id == aircraft_id),
        sa.select(channels.c.array)
        .join(maneuvers, maneuvers.c.id == channels.c.maneuver_id)
        .where(maneuvers.c.aircraft_id == aircraft_id),
    )
    total = sa.select(sa.func.sum(arrays.c.n_bytes)).where(arrays.c.hash.in_(names))
    in_chunks = (
        sa.select(sa.func.sum(flight_channels.c.n_samples))
        .join(flights, flights.c.id == flight_channels.c.flight_id)
        .where(flights.c.aircraft_id == aircraft_id)
        .where(flight_channels.c.samples_per_chunk.is_not(None))
    )
    n_samples = int(connection.execute(in_chunks).scalar_one() or 0)
    return (connection.execute(total).scalar_one() or 0) + _SAMPLE_BYTES * n_samples
