"""What analysts wait while the server computes: ``python backend/benchmarks/load.py``.

Thirty analysts read lists, a batch of 120 runs computes, and a hundred event streams are open.
``thirty_analysts_p99_vs_idle`` is the 99th percentile of their responses over that of a single
user of the idle server, printed as a JSON line; any error fails the benchmark.

``--database URL`` is an empty database; by default a file.
"""

from __future__ import annotations

import argparse
import selectors
import socket
import statistics
import sys
import tempfile
import threading
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass

import jobs

ANALYSTS, STREAMS, BATCH = 30, 100, 120
IDLE_REQUESTS = 400
PATHS = (
    "/api/v1/maneuvers?limit=50",
    "/api/v1/runs?limit=50",
    "/api/v1/jobs?limit=100",
    "/api/v1/jobs/status",
    "/api/v1/maneuvers/1",
)
STREAM = b"GET /api/v1/events HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n"


def main() -> None:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--database", help="an empty database; by default a file")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        url = arguments.database or f"sqlite:///{folder}/flexsid.db"
        ids = jobs.fill(url, BATCH)
        with jobs.server(url, None, jobs.default_count()) as port:
            sys.exit(read_under_load(port, ids))


def read_under_load(port: int, ids: list[int]) -> int:
    """Compare responses under load with those of the idle server; return the exit status."""
    client = jobs.Client(port)
    idle = [jobs.time_request(client, PATHS[k % len(PATHS)]) for k in range(IDLE_REQUESTS)]
    stop = threading.Event()
    with open_streams(port) as streams, ThreadPoolExecutor(ANALYSTS) as analysts:
        batch = client.post("/api/v1/batches", jobs.make_batch(ids, ["OE"]))
        phases = [k / ANALYSTS for k in range(ANALYSTS)]
        readings = [analysts.submit(jobs.browse, port, PATHS, stop, phase) for phase in phases]
        done = jobs.wait_for_batch(client, batch["id"])
        stop.set()
        found = [reading.result() for reading in readings]
    times = [one for times, _ in found for one in times]
    errors = sum(errors for _, errors in found)
    lost = STREAMS - sum(one.is_open for one in streams)
    silent = sum(one.received == 0 for one in streams)
    jobs.report_result(
        "thirty_analysts_p99_vs_idle",
        jobs.percentile(times, 0.99) / jobs.percentile(idle, 0.99),
        bar=5.0,
        baseline="p99 of the same requests of one user of the idle server",
        p99_ms=1e3 * jobs.percentile(times, 0.99),
        median_ms=1e3 * statistics.median(times),
        idle_p99_ms=1e3 * jobs.percentile(idle, 0.99),
        idle_median_ms=1e3 * statistics.median(idle),
        requests=len(times),
        errors=errors,
        streams=STREAMS,
        lost_streams=lost,
        silent_streams=silent,
        states=done["states"],
    )
    return 1 if errors or lost or silent else 0


@dataclass
class Stream:
    """One open event stream, and the bytes that it has received."""

    connection: socket.socket
    received: int = 0
    is_open: bool = True


@contextmanager
def open_streams(port: int) -> Iterator[list[Stream]]:
    """Hold event streams open and read them, as pages that show jobs do."""
    with ExitStack() as stack, selectors.DefaultSelector() as selector:
        streams: list[Stream] = []
        for _ in range(STREAMS):
            connection = stack.enter_context(socket.create_connection(("127.0.0.1", port)))
            connection.sendall(STREAM)
            stream = Stream(connection)
            selector.register(connection, selectors.EVENT_READ, stream)
            streams.append(stream)
        stop = threading.Event()
        reader = threading.Thread(target=_read_streams, args=(selector, stop))
        reader.start()
        try:
            yield streams
        finally:
            stop.set()
            reader.join()


def _read_streams(selector: selectors.BaseSelector, stop: threading.Event) -> None:
    while not stop.is_set():
        for key, _ in selector.select(0.1):
            stream: Stream = key.data
            size = len(stream.connection.recv(65536))
            stream.received += size
            if size == 0:
                stream.is_open = False
                selector.unregister(stream.connection)


if __name__ == "__main__":
    main()
