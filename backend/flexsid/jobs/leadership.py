"""Leadership: of several servers on one database, one hands out work."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable
from typing import Any

from flexsid.jobs.place import is_gone, this_process
from flexsid.storage import leases, queue
from flexsid.storage.leases import Lease
from flexsid.storage.store import Store

_log = logging.getLogger(__name__)

PATIENCE_S = 8.0
"""A holder that has not moved for so long has lost the lease."""


class Leadership:
    """Takes the lease when it is free, keeps it, and finds out when it was lost.

    Parameters
    ----------
    store
        Whose lease.
    status
        Returns what the holder tells of itself with every beat.
    patience_s
        How long a holder may stand still; measured on this computer's own clock.
    """

    def __init__(
        self, store: Store, status: Callable[[], dict[str, Any]], patience_s: float = PATIENCE_S
    ) -> None:
        self.me = this_process()
        self._store = store
        self._status = status
        self._patience_s = patience_s
        self._lease: Lease | None = None
        self._seen: Lease | None = None
        self._since = 0.0

    @property
    def epoch(self) -> int | None:
        """Of the lease that is held, None where none is."""
        return None if self._lease is None else self._lease.epoch

    def hold(self) -> bool:
        """Keep the lease, or take it if nobody has it; False while another server leads."""
        now = time.monotonic()
        if self._lease is None:
            return self._try(now)
        if now - self._since >= self._patience_s / 4:
            self._lease = leases.renew(self._store, self._lease, self._status())
            self._since = now
            if self._lease is None:
                _log.warning("another server took over the queue while this one stood still")
        return self._lease is not None

    def release(self) -> None:
        """Let another server lead."""
        if self._lease is not None:
            leases.release(self._store, self._lease)
            self._lease = None

    def _try(self, now: float) -> bool:
        lease = leases.read(self._store)
        if lease != self._seen:
            self._seen, self._since = lease, now
        if not (is_gone(lease.holder) or now - self._since >= self._patience_s):
            return False
        with self._store.transaction():
            self._lease = leases.take(self._store, lease, self.me)
            if self._lease is None:
                return False
            left = queue.take_over(
                self._store, lambda owner: owner == lease.holder or is_gone(owner)
            )
        self._since = now
        if left:
            _log.info("%d runs that were under way when a server stopped start again", left)
        return True
