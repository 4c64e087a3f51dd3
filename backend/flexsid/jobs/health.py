"""Health: whether what is queued will be computed, as far as this server can see."""

from __future__ import annotations

import time
from dataclasses import dataclass
from enum import StrEnum

from flexsid.jobs.leadership import PATIENCE_S
from flexsid.storage import leases
from flexsid.storage.leases import Lease
from flexsid.storage.store import Store

_GRACE_S = 20.0  # more than servers and workers take to start, or to be replaced
_STILL_S = 2.0 * PATIENCE_S  # by then another server would have taken the lease


class PartState(StrEnum):
    """How a part of the workbench is."""

    OK = "ok"
    STARTING = "starting"
    DEGRADED = "degraded"


@dataclass(frozen=True, slots=True, kw_only=True)
class PartHealth:
    """One part of the workbench, how it is, and where it is not well what to do."""

    name: str
    state: PartState
    text: str


class QueueHealth:
    """Watches the lease from one question to the next; no clocks are compared."""

    def __init__(self, store: Store) -> None:
        self._store = store
        self._seen: Lease | None = None
        self._moved = self._led = time.monotonic()

    def look(self) -> tuple[PartHealth, PartHealth]:
        """Tell how the dispatcher and the workers are."""
        now = time.monotonic()
        lease, status = leases.read(self._store), leases.status(self._store)
        if lease != self._seen:
            self._seen, self._moved = lease, now
        if lease.holder is not None:
            self._led = now
        dispatcher = self._dispatcher(lease, now)
        if dispatcher.state is not PartState.OK or status is None:
            text = "Unknown, as no dispatcher reports them."
            return dispatcher, _part("workers", dispatcher.state, text)
        return dispatcher, _workers(status)

    def _dispatcher(self, lease: Lease, now: float) -> PartHealth:
        if lease.holder is None:
            text = (
                "No server hands out work: runs wait in the queue. Look into the log of the"
                " server, and start it again."
            )
            late = now - self._led >= _GRACE_S
        elif now - self._moved >= _STILL_S:
            text = (
                f"The dispatcher has stood still for {now - self._moved:.0f} s: runs wait. Look"
                " into the log of the server, and start it again."
            )
            late = True
        else:
            return _part("dispatcher", PartState.OK, "Hands out work.")
        return _part("dispatcher", PartState.DEGRADED if late else PartState.STARTING, text)


def _workers(status: dict[str, object]) -> PartHealth:
    count, place = status["workers"], status["place"]
    if count != 0:
        return _part("workers", PartState.OK, f"{count} on {place}.")
    away_s = status.get("without_workers_s", 0.0)
    assert isinstance(away_s, float | int)
    text = (
        f"No worker has been there for {away_s:.0f} s ({place}): runs wait in the queue. Start"
        " the scheduler if it is away, and at least one dask worker."
    )
    return _part("workers", PartState.DEGRADED if away_s >= _GRACE_S else PartState.STARTING, text)


def _part(name: str, state: PartState, text: str) -> PartHealth:
    return PartHealth(name=name, state=state, text=text)
