"""Workers of a Dask cluster, and its key and certificate.

Each task runs in a child process of the Dask worker, as on a single computer: it can be
killed, its memory is limited, and a crash does not end the Dask worker.

Scheduler, workers and servers of one cluster have the same file. Each presents the certificate and
accepts that certificate alone, so that whoever does not have the file can neither connect nor
listen.
"""

from __future__ import annotations

import logging
import time
import uuid
from contextlib import suppress
from dataclasses import asdict, replace
from datetime import datetime, timedelta
from pathlib import Path
from textwrap import indent
from typing import Any

from cryptography import x509
from cryptography.hazmat.primitives import hashes, serialization
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.x509.oid import NameOID

from flexsid.errors import BadInput, FlexsidError
from flexsid.jobs.child import Child, execute_in_child, pickle_task
from flexsid.jobs.local import Workers
from flexsid.jobs.messages import (
    ComputedMessage,
    FailedMessage,
    Key,
    ProgressMessage,
    TaskLostMessage,
    WorkerDiedMessage,
    WorkerMessage,
    describe_error,
)
from flexsid.jobs.worker import LoadKinds
from flexsid.records.run import Progress
from flexsid.storage.files import new_file

# --- Key and certificate of a Dask cluster, as a configuration file of Dask -----------------------

_VALIDITY = timedelta(days=3 * 365)
_CLOCK_SKEW = timedelta(days=1)  # between the computers of a cluster

# A job that ends its worker does so on the next one, too; the queue has its own attempts.
_CONFIGURATION = """\
# Dask cluster of flexsid. Contains a private key: only its computers may read this file.
distributed:
  comm:
    default-scheme: tls
    require-encryption: true
    tls:
      ca-file: &certificate |
{certificate}
      scheduler: &identity
        cert: *certificate
        key: |
{key}
      worker: *identity
      client: *identity
  scheduler:
    allowed-failures: 0
"""


def write_cluster_certificate(file: Path, now: datetime) -> datetime:
    """Write a configuration file with a new key and certificate, and return the end of validity.

    Parameters
    ----------
    file
        A new file, to be named by ``DASK_CONFIG``; readable by its account only.
    now
        Present time, with time zone.

    Raises
    ------
    BadInput
        If the file exists or cannot be written.
    """
    key = ec.generate_private_key(ec.SECP256R1())
    name = x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, "flexsid cluster")])
    end = now + _VALIDITY
    certificate = (
        x509.CertificateBuilder()
        .subject_name(name)
        .issuer_name(name)
        .public_key(key.public_key())
        .serial_number(x509.random_serial_number())
        .not_valid_before(now - _CLOCK_SKEW)
        .not_valid_after(end)
        .add_extension(x509.BasicConstraints(ca=True, path_length=0), critical=True)
        .sign(key, hashes.SHA256())
    )
    private = key.private_bytes(
        serialization.Encoding.PEM,
        serialization.PrivateFormat.PKCS8,
        serialization.NoEncryption(),
    )
    text = _CONFIGURATION.format(
        certificate=_indent(certificate.public_bytes(serialization.Encoding.PEM), 8),
        key=_indent(private, 10),
    )
    try:
        with new_file(file) as partial:
            partial.write_text(text)
    except FileExistsError as error:
        raise BadInput(
            f"{file} exists; a cluster that uses it would not accept a new certificate"
        ) from error
    except OSError as error:
        raise BadInput(f"{file} cannot be written: {error.strerror}") from error
    return end


def find_end_of_validity(certificate: str) -> datetime | None:
    """Return the end of validity of a certificate in PEM form, or of a file with one.

    None where it cannot be read; Dask states the reason when it connects.
    """
    try:
        is_text = certificate.lstrip().startswith("-----BEGIN")
        pem = certificate.encode() if is_text else Path(certificate).read_bytes()
        return x509.load_pem_x509_certificate(pem).not_valid_after_utc
    except (OSError, ValueError):
        return None


def _indent(pem: bytes, width: int) -> str:
    return indent(pem.decode().strip(), " " * width)


# --- Workers of a Dask cluster --------------------------------------------------------------------

_log = logging.getLogger(__name__)

_CONNECT_S = 10.0
_POLL_S = 1.0  # between polls of the number of workers
_NO_WORKER_S = 5.0  # without a worker; a restart by the Dask nanny takes less
_FETCH_S = 30.0
_CLOSE_S = 2.0


class ClusterWorkers(Workers[Any]):
    """Submits tasks to the threads of a Dask cluster, at most one task per thread.

    A running task is its future, or None if it was lost and that is not yet reported.

    Parameters
    ----------
    load_kinds
        Function that returns the kinds of jobs; the workers of the cluster import it.
    address
        Address of the scheduler, e.g. ``tls://127.0.0.1:8786``.

    Raises
    ------
    FlexsidError
        If Dask is not installed, no scheduler responds, or it requires another certificate.
    """

    def __init__(self, load_kinds: LoadKinds, address: str) -> None:
        super().__init__(load_kinds, f"Dask cluster {address}")
        self._address = address
        self._topic = f"flexsid-{uuid.uuid4().hex}"
        self._updated = -_POLL_S
        self._absent_since: float | None = None
        self._client: Any = None
        self._connect()

    @property
    def free_slots(self) -> int:
        """Number of further tasks that can start now; none while the scheduler is unreachable."""
        self._update_count()
        return super().free_slots

    @property
    def absent_s(self) -> float:
        """Time for which the cluster has had no worker. [s]"""
        return 0.0 if self._absent_since is None else time.monotonic() - self._absent_since

    def submit(self, key: Key, kind: str, task: Any, memory_mb: int | None) -> None:
        """Start a task; requires ``free_slots`` above zero."""
        future = self._client.submit(
            execute_on_worker,
            self._load_kinds,
            pickle_task(kind, task, memory_mb),
            (self._topic, key),
            key=f"flexsid-{uuid.uuid4().hex}",
            pure=False,
        )
        self._tasks[key] = future
        future.add_done_callback(lambda done: self.wake())

    def cancel(self, key: Key) -> None:
        """Stop a task; the Dask worker detects the released future."""
        future = self._tasks.pop(key, None)
        if future is not None:
            future.release()

    def wait(self, timeout: float) -> list[tuple[Key, WorkerMessage]]:
        """Return new messages and results of the running tasks; return at once after ``wake``."""
        messages = super().wait(timeout)
        for key, future in list(self._tasks.items()):
            if future is not None and future.done():
                del self._tasks[key]
                messages += [(key, message) for message in _fetch_result(future)]
        return messages

    def close(self) -> None:
        """Release all tasks and close the connection."""
        self._tasks.clear()
        self._disconnect(_CLOSE_S)

    def _connect(self) -> Any:
        try:
            self._client = _start_client(self._address)
            self._client.subscribe_topic(self._topic, self._receive_progress)
            certificate = self._client.security.tls_client_cert
            self.valid_until = None if certificate is None else find_end_of_validity(certificate)
            return self._client
        except TypeError as error:  # of Dask, for a missing key or certificate
            self._client = None
            raise FlexsidError(
                f"the Dask scheduler at {self._address} requires a certificate; let DASK_CONFIG"
                " name the file of the cluster (`flexsid cluster-certificate`)",
                code="no-scheduler",
            ) from error
        except (OSError, RuntimeError, ValueError) as error:
            self._client = None
            raise FlexsidError(
                f"no Dask scheduler responds at {self._address} ({error}); start one with"
                " `dask scheduler --host 127.0.0.1`, or leave FLEXSID_DASK empty",
                code="no-scheduler",
            ) from error

    def _update_count(self) -> None:
        """Update the number of threads; reconnect if the connection was lost."""
        now = time.monotonic()
        if now - self._updated < _POLL_S:
            return
        self._updated = now
        try:
            client = self._client
            if client is None or client.status != "running":
                self._lose_tasks("the connection to the Dask scheduler was lost")
                self._disconnect(0.0)
                client = self._connect()
            self.count = sum(client.nthreads().values())
        except (FlexsidError, OSError) as error:
            _log.warning("the Dask cluster is unreachable: %s", error)
            self.count = 0
        if self.count > 0:
            self._absent_since = None
        elif self._absent_since is None:
            self._absent_since = now
        elif now - self._absent_since >= _NO_WORKER_S:
            # The scheduler would hold them for a worker that may never connect.
            self._lose_tasks("the Dask cluster has no worker")

    def _lose_tasks(self, reason: str) -> None:
        for key, future in self._tasks.items():
            if future is not None:
                self._tasks[key] = None
                self._messages.put((key, TaskLostMessage(reason)))

    def _disconnect(self, timeout: float) -> None:
        """Close the connection, and with it its futures, which must not be used afterwards."""
        if self._client is not None:
            self._client.close(timeout=timeout)
            self._client = None

    def _receive_progress(self, event: Any) -> None:
        """Queue a progress message of a worker, on Dask's event thread."""
        _, (job_id, attempt, progress) = event
        message = ProgressMessage(None if progress is None else Progress(**progress))
        self._messages.put(((job_id, attempt), message))


def _start_client(address: str) -> Any:
    try:
        from distributed import Client
    except ImportError as error:
        raise FlexsidError(
            "a Dask cluster needs the extra `dask`: pip install 'flexsid[dask]'",
            code="missing-extra",
        ) from error

    class ClosedClient(Client):
        """Client that is closed, and its thread ended, at once if it cannot connect.

        Dask leaves the thread, and after some errors the client: the garbage collector then closes
        it, which takes a lock; where that is the start of another client, the process hangs.
        """

        def start(self, **kwargs: Any) -> None:
            try:
                super().start(**kwargs)
            except BaseException:
                with suppress(OSError, TimeoutError):
                    self.close(timeout=_CLOSE_S)
                self._loop_runner.stop()
                raise

    return ClosedClient(address, timeout=_CONNECT_S, set_as_default=False, name="flexsid")


def _fetch_result(future: Any) -> list[WorkerMessage]:
    """Return the last progress and the result of a task, or why it has none."""
    from distributed import KilledWorker
    from distributed.client import FutureCancelledError

    try:
        return future.result(timeout=_FETCH_S)
    except KilledWorker as error:
        return [WorkerDiedMessage(f"on {error.last_worker.address}")]
    except (FutureCancelledError, OSError) as error:
        return [TaskLostMessage(f"the Dask cluster dropped the task ({type(error).__name__})")]
    except Exception as error:
        return [describe_error(error)]


_idle: list[Child] = []


def execute_on_worker(
    load_kinds: LoadKinds, content: bytes, name: tuple[str, Key]
) -> list[WorkerMessage]:
    """Compute one task in a child process of this Dask worker.

    Returns when the task has ended or was cancelled: the last progress and the result.
    """
    from distributed import get_worker

    worker = get_worker()
    own = worker.get_current_task()
    topic, (job_id, attempt) = name
    # Events have a connection of their own, on which the result of a short task overtakes them.
    last: list[WorkerMessage] = []

    def publish(message: ProgressMessage) -> None:
        last[:] = [message]
        progress = None if message.progress is None else asdict(message.progress)
        worker.log_event(topic, (job_id, attempt, progress))

    def is_cancelled() -> bool:
        present = worker.state.tasks.get(own)
        return present is None or present.state != "executing"

    message = execute_in_child(load_kinds, content, _idle, publish, is_cancelled)
    is_end = isinstance(message, ComputedMessage | FailedMessage)
    return [*last, replace(message, worker=worker.address) if is_end else message]
