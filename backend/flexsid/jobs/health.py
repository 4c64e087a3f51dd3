"""Health of the job queue, and which of several servers dispatches."""

from __future__ import annotations

import logging
import os
import socket
import time
from collections.abc import Callable
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from enum import StrEnum
from pathlib import Path
from typing import Any

from flexsid.errors import FlexsidError
from flexsid.importers import jail
from flexsid.storage.jobs import leases, queue
from flexsid.storage.jobs.leases import Lease
from flexsid.storage.store import Store

# --- Process identifiers that are unique across hosts, containers and restarts --------------------


def get_process_id() -> str:
    """Return host, PID namespace, PID and start time of this process."""
    return " ".join((*_get_namespace(), str(os.getpid()), _read_start_time(os.getpid())))


def is_gone(process_id: str | None) -> bool:
    """Return whether a process is known to have ended; False if that is unknown."""
    if process_id is None:
        return True
    *namespace, number, started = process_id.split(" ")
    if tuple(namespace) != _get_namespace():
        return False
    return _read_start_time(int(number)) != started


def shorten_process_id(process_id: str) -> str:
    """Return host and PID of a process, for display."""
    host, _, number, _ = process_id.split(" ")
    return f"{host}/{number}"


def _get_namespace() -> tuple[str, str]:
    try:
        pid_namespace = os.readlink("/proc/self/ns/pid")
    except OSError:
        pid_namespace = "-"
    return socket.gethostname().replace(" ", "-"), pid_namespace


def _read_start_time(process: int) -> str:
    """Return the start time of a process, since PIDs are reused; empty if it has ended."""
    try:
        # The name of the program, in parentheses, may contain any character.
        fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    except OSError:
        return _check_process(process)
    return "" if fields[0] in "ZX" else fields[19]


def _check_process(process: int) -> str:
    try:
        os.kill(process, 0)
    except (OSError, OverflowError):
        return ""
    return "-" if not Path("/proc/self/stat").exists() else ""


# --- Leadership: of several servers on one database, one dispatches jobs --------------------------

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


# --- Health of the job queue: whether queued jobs will be computed --------------------------------

_GRACE_S = 20.0  # longer than the replacement of servers and workers
_START_S = 120.0  # longer than the start of a dispatcher on a loaded computer
_STALLED_S = 2.0 * LEASE_TIMEOUT_S  # by then another server would have taken the lease
_EARLY = timedelta(days=30)  # before the end of a certificate


class PartState(StrEnum):
    """State of a part of the workbench."""

    OK = "ok"
    STARTING = "starting"
    DEGRADED = "degraded"


@dataclass(frozen=True, slots=True)
class PartHealth:
    """State of one part of the workbench, with advice if it is degraded."""

    name: str
    state: PartState
    text: str


class NotReady(FlexsidError):
    """Requests cannot be processed completely."""

    code = "not-ready"


class QueueHealth:
    """Monitor of the lease between calls; clocks of servers are not compared.

    Parameters
    ----------
    store
        Store with the lease.
    is_starting
        Returns whether the dispatcher of this server could not yet take the lease.
    """

    def __init__(self, store: Store, is_starting: Callable[[], bool] = lambda: False) -> None:
        self._store = store
        self._is_starting = is_starting
        self._lease: Lease | None = None
        self._begun_at = self._changed_at = time.monotonic()

    def check(self) -> tuple[PartHealth, PartHealth]:
        """Return the state of the dispatcher and of the workers."""
        now = time.monotonic()
        lease, status = leases.read(self._store), leases.status(self._store)
        is_starting = now - self._begun_at < _START_S and self._is_starting()
        if lease != self._lease or is_starting:
            self._lease, self._changed_at = lease, now
        dispatcher = _describe_dispatcher(lease, now - self._changed_at)
        if dispatcher.state is not PartState.OK or status is None:
            text = "Unknown: no dispatcher reports the workers."
            return dispatcher, PartHealth("workers", dispatcher.state, text)
        return dispatcher, _describe_workers(status)

    def check_certificate(self) -> PartHealth | None:
        """Return the state of the cluster's certificate; None where workers need none."""
        end = (leases.status(self._store) or {}).get("valid_until")
        if end is None:
            return None
        text, state = f"Valid until {end[:10]}.", PartState.OK
        if datetime.fromisoformat(end) - datetime.now(UTC) < _EARLY:
            text = (
                f"Valid until {end[:10]} only, then no job is computed: write a new one by"
                " `flexsid cluster-certificate` and restart scheduler, workers and servers with it."
            )
            state = PartState.DEGRADED
        return PartHealth("certificate", state, text)

    def check_notifications(self) -> PartHealth | None:
        """Return whether messages could be sent; None where none are sent."""
        unsent = (leases.status(self._store) or {}).get("unsent")
        if unsent is None:
            return None
        if not unsent:
            return PartHealth("notifications", PartState.OK, "No message was refused.")
        text = f"Not sent {unsent}. The log of the server has more; check FLEXSID_NOTIFICATIONS."
        return PartHealth("notifications", PartState.DEGRADED, text)


def check_readers(is_shared: bool) -> PartHealth:
    """Return whether the processes that read uploaded files are confined, on a shared server."""
    missing = jail.list_missing()
    if not missing:
        return PartHealth("readers", PartState.OK, "Open nothing but the uploaded files.")
    state = PartState.DEGRADED if is_shared else PartState.OK  # otherwise the files are one's own
    text = f"An uploaded file that attacks its reader could {'; and '.join(missing)}."
    return PartHealth("readers", state, text)


def _describe_dispatcher(lease: Lease, unchanged_s: float) -> PartHealth:
    """Describe the dispatcher by the time since the lease was last taken, renewed or released."""
    text, state = "Dispatches jobs.", PartState.OK
    if lease.holder is None and unchanged_s < _GRACE_S:
        text, state = "Starting: jobs wait in the queue meanwhile.", PartState.STARTING
    elif lease.holder is None:
        text, state = "No server dispatches jobs: they wait in the queue.", PartState.DEGRADED
    elif unchanged_s >= _STALLED_S:
        text = f"The dispatcher has not responded for {unchanged_s:.0f} s: jobs wait."
        state = PartState.DEGRADED
    if state is PartState.DEGRADED:
        text += " Read the log of the server and restart it."
    return PartHealth("dispatcher", state, text)


def _describe_workers(status: dict[str, Any]) -> PartHealth:
    count, location = status["workers"], status["location"]
    away_s = status.get("without_workers_s", 0.0)  # not reported by earlier versions
    if count != 0:
        return PartHealth("workers", PartState.OK, f"{count} on {location}.")
    text = (
        f"No worker has been available for {away_s:.0f} s ({location}): jobs wait in the queue."
        " Start the scheduler if it is not running, and at least one dask worker."
    )
    state = PartState.DEGRADED if away_s >= _GRACE_S else PartState.STARTING
    return PartHealth("workers", state, text)
