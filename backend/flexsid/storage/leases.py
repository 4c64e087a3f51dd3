"""The lease: which of several servers on one database hands out work.

No clocks are compared. Whoever holds the lease counts its ``beats`` up; who
wants it watches that number, and takes the lease when it has stood still for
long enough. ``epoch`` counts the holders, so that one who was asleep finds out.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import sqlalchemy as sa

from flexsid.storage.store import Store
from flexsid.storage.tables import leases

_DISPATCHER = leases.c.name == "dispatcher"


@dataclass(frozen=True, slots=True)
class Lease:
    """Who holds it (None: nobody), for the how manieth time it was taken, and its beats."""

    holder: str | None
    epoch: int
    beats: int


def read(store: Store) -> Lease:
    """Return the lease as it stands."""
    query = sa.select(leases.c.holder, leases.c.epoch, leases.c.beats).where(_DISPATCHER)
    with store.database.reading() as connection:
        return Lease(*connection.execute(query).one())


def take(store: Store, seen: Lease, holder: str) -> Lease | None:
    """Take the lease, unless it has changed since it was seen."""
    taken = Lease(holder, seen.epoch + 1, 0)
    return taken if _change(store, seen, holder=holder, epoch=taken.epoch, beats=0) else None


def renew(store: Store, lease: Lease, status: dict[str, Any]) -> Lease | None:
    """Count one beat and tell what the holder is doing; None where another has taken over."""
    if not _change(store, lease, lax=True, beats=lease.beats + 1, status=status):
        return None
    return Lease(lease.holder, lease.epoch, lease.beats + 1)


def release(store: Store, lease: Lease) -> None:
    """Give the lease back, so that the next holder need not wait."""
    _change(store, lease, holder=None, status=None)


def holds(epoch: int) -> sa.ColumnElement[bool]:
    """Condition that a statement changes something only for the holder."""
    return sa.exists().where(_DISPATCHER, leases.c.epoch == epoch)


def status(store: Store) -> dict[str, Any] | None:
    """Return what the holder last told of itself; None where nobody holds the lease."""
    query = sa.select(leases.c.status).where(_DISPATCHER, leases.c.holder.is_not(None))
    with store.database.reading() as connection:
        return connection.scalar(query)


def _change(store: Store, seen: Lease, *, lax: bool = False, **values: Any) -> bool:
    same = sa.and_(_DISPATCHER, leases.c.epoch == seen.epoch, leases.c.beats == seen.beats)
    with store.database.transaction(lax=lax) as connection:
        return connection.execute(sa.update(leases).where(same).values(values)).rowcount == 1
