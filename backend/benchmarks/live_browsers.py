"""Latency of a live stream with many browsers: ``python backend/benchmarks/live_browsers.py [n]``.

A simulated maneuver of FLEX-28 is pushed to a server in real time, frame by frame, while 20
browsers (event streams with 12 channels) look on and estimates are computed. Prints one JSON line
with one browser and one with all: from the push of a frame to the arrival of its columns at a
browser, 95th percentile over all frames and browsers; events that a browser did not receive; and
the memory of the server and its processes after the first and the last maneuver.
"""

from __future__ import annotations

import os

for _name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[_name] = "1"

import json
import sys
import tempfile
import threading
import time
from dataclasses import replace
from http.client import HTTPConnection
from typing import Any

import jobs
import live
import numpy as np
from endurance import is_server, list_processes, measure

from flexsid.records.live import Frame
from flexsid.workflow.live.frame_assembler import encode_frame, pace, read_replay
from flexsid.workflow.live.live_fit import FRAME_S, prepare_live_task

BROWSERS, CHANNELS = 20, 12


class Browser(threading.Thread):
    """Reads the events of a stream, and when columns of samples arrive."""

    def __init__(self, port: int, stream_id: int, channels: str) -> None:
        super().__init__(daemon=True)
        self._connection = HTTPConnection("127.0.0.1", port, timeout=120)
        self._address = f"/api/v1/events?stream_id={stream_id}&channels={channels}"
        self.arrived: list[tuple[float, float]] = []  # newest time of the recorder, and clock
        self.snapshot: dict[str, Any] = {}
        self.is_over = False

    def run(self) -> None:
        """Read until the benchmark is over."""
        self._connection.request("GET", self._address, headers={"Accept": "text/event-stream"})
        response = self._connection.getresponse()
        kind = b""
        while not self.is_over:
            line = response.readline()
            if line.startswith(b"event:"):
                kind = line[6:].strip()
            elif line.startswith(b"data:") and kind == b"live":
                self.snapshot = json.loads(line[5:])
            elif line.startswith(b"data:") and kind == b"samples":
                found = json.loads(line[5:])
                if found["time_s"]:
                    newest = found["time_s"][-1] + found["column_s"]
                    self.arrived.append((newest, time.monotonic()))

    def find_delays(self, sent: dict[float, float]) -> list[float]:
        """Return the delay of each frame, from the first event that has its end. [ms]"""
        newest = np.array([own for own, _ in self.arrived])
        delays = []
        for end_s, at in sent.items():
            place = int(np.searchsorted(newest, end_s - 1e-3))
            if place < newest.size:
                delays.append(1e3 * (self.arrived[place][1] - at))
        return delays


class Feed:
    """Frames of one stream, numbered on."""

    def __init__(self, port: int, stream_id: int, browsers: list[Browser]) -> None:
        self._connection = HTTPConnection("127.0.0.1", port, timeout=120)
        self._address = f"/api/v1/live/streams/{stream_id}/frames"
        self._browsers = browsers
        self._next = 0

    def wait_for_browsers(self, frames: list[Frame]) -> None:
        """Push until the process of the stream takes frames."""
        while not self._browsers[0].snapshot.get("state"):
            self.push(frames)
            time.sleep(1.0)

    @property
    def flown_s(self) -> float:
        """End of the newest frame."""
        return self._next * FRAME_S

    def push(self, frames: list[Frame]) -> None:
        """Push frames at once."""
        numbers = range(self._next, self._next + len(frames))
        self._next += len(frames)
        body = b"".join(
            encode_frame(replace(frame, number=k, time_s=k * FRAME_S))
            for k, frame in zip(numbers, frames, strict=True)
        )
        header = {"Content-Type": "application/octet-stream"}
        self._connection.request("POST", self._address, body, header)
        response = self._connection.getresponse()
        response.read()
        assert response.status == 200, response.status

    def push_slowly(self, frames: list[Frame]) -> list[list[float]]:
        """Push in real time; return the delays at each browser. [ms]"""
        sent: dict[float, float] = {}
        for frame in pace(frames, FRAME_S, 1.0):
            sent[self.flown_s + FRAME_S] = time.monotonic()
            self.push([frame])
        time.sleep(2.0)
        return [browser.find_delays(sent) for browser in self._browsers]


def fly(port: int, run_id: int, frames: list[Frame], names: list[str], browsers: int) -> None:
    """Push a maneuver in real time, and print what browsers saw."""
    client = jobs.Client(port)
    body = {"run_id": run_id, "title": "benchmark", "receiver": {"name": "push"}}
    stream_id = client.post("/api/v1/live/streams", body)["id"]
    every = [Browser(port, stream_id, ",".join(names)) for _ in range(browsers)]
    for browser in every:
        browser.start()
    feed = Feed(port, stream_id, every)
    feed.wait_for_browsers(frames[:1])
    delays = feed.push_slowly(frames)
    for browser in every:
        browser.is_over = True
    client.post(f"/api/v1/live/streams/{stream_id}/stop", None)
    (root,) = (own for own in list_processes(os.getpid()) if is_server(own))
    live.report(
        f"live_browsers_{browsers}_p95_ms",
        float(np.percentile(np.concatenate(delays), 95)),
        worst_ms=float(max(map(max, delays))),
        frames=len(frames),
        missing=sum(len(frames) - len(own) for own in delays),
        memory_mb=measure(root)[0],
    )


def main(browsers: int) -> None:
    """Measure with one browser, then twice with all."""
    with tempfile.TemporaryDirectory() as folder:
        store, stream = live.simulate_stream(folder)
        task = prepare_live_task(store, store.runs.get(stream.run_id))
        frames = list(read_replay(store, 1, task.header).frames())
        names = [c.name for group in task.header.groups for c in group][:CHANNELS]
        store.close()
        with jobs.serve(f"sqlite:///{folder}/flexsid.db", None, 1) as port:
            for count in (1, browsers, browsers):
                fly(port, stream.run_id, frames, names, count)


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else BROWSERS)
