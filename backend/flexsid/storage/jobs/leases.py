"""The lease: determines which of several servers on one database dispatches runs.

No clocks are compared. The holder increments ``beats``; other servers observe
the number, and take the lease when it has not changed for the lease timeout.
``epoch`` counts the holders, so that a former holder detects the change.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import sqlalchemy as sa
from sqlalchemy.engine import Connection

from flexsid.storage.store import Store
from flexsid.storage.tables import leases

_DISPATCHER = leases.c.name == "dispatcher"


@dataclass(frozen=True, slots=True)
class Lease:
    """Holder (None if free), number of times that it was taken, and beats."""

    holder: str | None
    epoch: int
    beats: int


def read(store: Store) -> Lease:
    """Return the present lease."""
    query = sa.select(leases.c.holder, leases.c.epoch, leases.c.beats).where(_DISPATCHER)
    with store.database.reading() as connection:
        return Lease(*connection.execute(query).one())


def announce(store: Store, url: str) -> None:
    """Store the address of a server in a browser, before it dispatches."""
    with store.database.transaction() as connection:
        known = connection.scalar(sa.select(leases.c.status).where(_DISPATCHER))
        status = {**(known or {}), "url": url}
        connection.execute(sa.update(leases).where(_DISPATCHER).values(status=status))


def take(store: Store, seen: Lease, holder: str) -> Lease | None:
    """Take the lease, unless it has changed since it was seen."""
    taken = Lease(holder, seen.epoch + 1, 0)
    return taken if _change(store, seen, holder=holder, epoch=taken.epoch, beats=0) else None


def renew(store: Store, lease: Lease, status: dict[str, Any]) -> Lease | None:
    """Count one beat and store the status of the holder; None if another server has the lease."""
    if not _change(store, lease, lax=True, beats=lease.beats + 1, status=status):
        return None
    return Lease(lease.holder, lease.epoch, lease.beats + 1)


def release(store: Store, lease: Lease) -> None:
    """Release the lease, so that the next holder need not wait; the address remains known."""
    _change(store, lease, holder=None, status={"url": find_address(store)})


def lock(connection: Connection) -> None:
    """Block a change of the lease until the transaction ends, as the one writer of SQLite does.

    Otherwise a new holder would not find a job that the former one starts at the same time.
    """
    connection.execute(sa.select(leases.c.epoch).where(_DISPATCHER).with_for_update(read=True))


def is_held(epoch: int) -> sa.ColumnElement[bool]:
    """Return the SQL condition that the lease has this epoch."""
    return sa.exists().where(_DISPATCHER, leases.c.epoch == epoch)


def status(store: Store) -> dict[str, Any] | None:
    """Return the last status of the holder; None if the lease is free, or before its first beat."""
    query = sa.select(leases.c.status).where(_DISPATCHER, leases.c.holder.is_not(None))
    with store.database.reading() as connection:
        found = connection.scalar(query)
    return found if found and "workers" in found else None


def find_address(store: Store) -> str | None:
    """Return the address in a browser of the server that started last, if one is known."""
    with store.database.reading() as connection:
        found = connection.scalar(sa.select(leases.c.status).where(_DISPATCHER))
    return (found or {}).get("url")


def _change(store: Store, seen: Lease, *, lax: bool = False, **values: Any) -> bool:
    same = sa.and_(_DISPATCHER, leases.c.epoch == seen.epoch, leases.c.beats == seen.beats)
    with store.database.transaction(lax=lax) as connection:
        return connection.execute(sa.update(leases).where(same).values(values)).rowcount == 1
