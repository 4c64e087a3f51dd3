"""Events of jobs and streams are sent, and those of jobs repeated after a reconnection."""

from __future__ import annotations

import json
import struct
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from waiting import PATIENCE_S

Event = tuple[str, int | None, Any]


def _post(url: str, body: dict[str, Any]) -> dict[str, Any]:
    request = urllib.request.Request(
        url, json.dumps(body).encode(), {"Content-Type": "application/json"}
    )
    with urllib.request.urlopen(request, timeout=PATIENCE_S) as response:
        return json.load(response)


@contextmanager
def _listen(url: str, **headers: str) -> Iterator[Iterator[Event]]:
    request = urllib.request.Request(url, headers=headers)
    with urllib.request.urlopen(request, timeout=PATIENCE_S) as stream:
        assert stream.headers["Content-Type"].startswith("text/event-stream")
        yield _read_events(stream)


def _read_events(stream: Any) -> Iterator[Event]:
    fields: dict[str, str] = {}
    for line in stream:
        name, _, value = line.decode().rstrip("\n").partition(": ")
        if name:
            fields[name] = value
        elif fields.get("data"):
            number = int(fields["id"]) if "id" in fields else None
            yield fields["event"], number, json.loads(fields["data"])
            fields = {}


def _read_until_end(events: Iterator[Event], run_id: int) -> list[tuple[str, int]]:
    kinds: list[tuple[str, int]] = []
    for name, number, data in events:
        # A run that takes longer than a second on a loaded machine logs its progress too.
        if name == "job" and data["job_id"] == run_id and data["kind"] != "logged":
            assert number is not None
            kinds.append((data["kind"], number))
            if data["kind"] == "succeeded":
                return kinds
    raise AssertionError(kinds)


def test_event_stream_resumes_after_last_event(live_url: str) -> None:
    api = f"{live_url}/api/v1"
    payload = {"maneuver_id": 1, "method": "EE", "structure": {"modes": [7]}}
    with _listen(f"{api}/events?after=0") as events:
        first = _read_until_end(events, 1)
        run = _post(f"{api}/runs", payload | {"author": "Ada"})["id"]
        seen = _read_until_end(events, run)
    assert [kind for kind, _ in first] == ["queued", "started", "succeeded"]
    assert [kind for kind, _ in seen] == ["queued", "started", "succeeded"]
    numbers = [number for _, number in seen]
    assert numbers == sorted(numbers)
    with _listen(f"{api}/events", **{"Last-Event-ID": str(numbers[0])}) as events:
        assert _read_until_end(events, run) == seen[1:]


def test_samples_and_states_of_a_stream_are_events(live_url: str) -> None:
    live = f"{live_url}/api/v1/live/streams"
    stream = _post(live, {"run_id": 1, "title": "Flight 2", "receiver": {"name": "push"}})["id"]
    with urllib.request.urlopen(f"{live}/{stream}", timeout=PATIENCE_S) as response:
        size = json.load(response)["packet_bytes"]

    def push(number: int) -> None:
        start = struct.pack("<4sId", b"FXS1", number, number * 0.05)
        request = urllib.request.Request(
            f"{live}/{stream}/frames",
            start + bytes(size - len(start)),
            {"Content-Type": "application/octet-stream"},
        )
        urllib.request.urlopen(request, timeout=PATIENCE_S).close()

    seen: dict[str, Any] = {}
    number = 0
    with _listen(f"{live_url}/api/v1/events?stream_id={stream}&channels=q,bfs") as events:
        for number in range(40):
            push(number)
        for name, _, data in events:
            if name == "live" and data["state"] is not None:
                seen[name] = data
            if name == "samples":
                seen[name] = data
            if name in ("live", "samples"):
                number += 1
                push(number)
            if len(seen) == 2:
                break
    assert seen["live"]["stream_id"] == stream
    assert seen["live"]["state"]["phase"] == "trim"
    assert seen["samples"]["names"] == ["q", "bfs"]
    assert set(seen["samples"]["low"][0]) == {0.0}
    _post(f"{live}/{stream}/stop", {})


def test_a_note_of_another_analyst_is_an_event(live_url: str) -> None:
    note = {"subject": "maneuver", "key": "1", "text": "Repeat at 30 m/s"}
    request = urllib.request.Request(
        f"{live_url}/api/v1/notes",
        json.dumps(note).encode(),
        {"Content-Type": "application/json", "X-Flexsid-Analyst": "Ada"},
    )
    with _listen(f"{live_url}/api/v1/events") as events:
        assert next(events)[0]  # what was before has been read
        urllib.request.urlopen(request, timeout=PATIENCE_S).close()
        assert any(name == "changed" and "notes" in data["records"] for name, _, data in events)
