"""Leadership: of several servers on one database, one dispatches jobs."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable
from typing import Any

from flexsid.jobs.process_id import get_process_id, is_gone
from flexsid.storage import leases, queue
from flexsid.storage.leases import Lease
from flexsid.storage.store import Store

_log = logging.getLogger(__name__)

LEASE_TIMEOUT_S = 8.0
"""Time without renewal after which a holder loses the lease. [s]"""


class Leadership:
    """Acquires and renews the lease, and detects its loss.

    Parameters
    ----------
    store
        Store with the lease.
    status
        Returns the status of the holder, which every renewal stores.
    timeout_s
        Time without renewal after which a holder loses the lease, by the local clock. [s]
    """

    def __init__(
        self, store: Store, status: Callable[[], dict[str, Any]], timeout_s: float = LEASE_TIMEOUT_S
    ) -> None:
        self.process_id = get_process_id()
        self._store = store
        self._status = status
        self._timeout_s = timeout_s
        self._lease: Lease | None = None
        self._seen: Lease | None = None
        self._observed_at = 0.0

    @property
    def epoch(self) -> int | None:
        """Epoch of the held lease, None without a lease."""
        return None if self._lease is None else self._lease.epoch

    def hold(self) -> bool:
        """Renew or acquire the lease; return False while another server holds it."""
        now = time.monotonic()
        if self._lease is None:
            return self._acquire(now)
        if now - self._observed_at >= self._timeout_s / 4:
            self._lease = leases.renew(self._store, self._lease, self._status())
            self._observed_at = now
            if self._lease is None:
                _log.warning(
                    "another server took over the queue because this one did not renew its lease"
                )
        return self._lease is not None

    def release(self) -> None:
        """Release the lease."""
        if self._lease is not None:
            leases.release(self._store, self._lease)
            self._lease = None

    def _acquire(self, now: float) -> bool:
        lease = leases.read(self._store)
        if lease != self._seen:
            self._seen, self._observed_at = lease, now
        if not (is_gone(lease.holder) or now - self._observed_at >= self._timeout_s):
            return False
        with self._store.transaction():
            self._lease = leases.take(self._store, lease, self.process_id)
            if self._lease is None:
                return False
            left = queue.requeue_orphans(
                self._store, lambda holder: holder == lease.holder or is_gone(holder)
            )
        self._observed_at = now
        if left:
            _log.info("%d jobs of a stopped server are restarted", left)
        return True
