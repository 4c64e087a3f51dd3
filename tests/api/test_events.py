"""What happens to runs is told as it happens, and again to who missed it."""

from __future__ import annotations

import json
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from waiting import PATIENCE_S

Told = tuple[str, int | None, Any]


def _post(url: str, body: dict[str, Any]) -> dict[str, Any]:
    request = urllib.request.Request(
        url, json.dumps(body).encode(), {"Content-Type": "application/json"}
    )
    with urllib.request.urlopen(request, timeout=PATIENCE_S) as answer:
        return json.load(answer)


@contextmanager
def _listen(url: str, **headers: str) -> Iterator[Iterator[Told]]:
    request = urllib.request.Request(url, headers=headers)
    with urllib.request.urlopen(request, timeout=PATIENCE_S) as stream:
        assert stream.headers["Content-Type"].startswith("text/event-stream")
        yield _told(stream)


def _told(stream: Any) -> Iterator[Told]:
    fields: dict[str, str] = {}
    for line in stream:
        name, _, value = line.decode().rstrip("\n").partition(": ")
        if name:
            fields[name] = value
        elif fields.get("data"):
            number = int(fields["id"]) if "id" in fields else None
            yield fields["event"], number, json.loads(fields["data"])
            fields = {}


def _until_over(told: Iterator[Told], run_id: int) -> list[tuple[str, int | None]]:
    kinds = []
    for name, number, data in told:
        if name == "run" and data["run_id"] == run_id:
            kinds.append((data["kind"], number))
            if data["kind"] == "succeeded":
                return kinds
    raise AssertionError(kinds)


def test_a_page_hears_of_runs_and_goes_on_where_it_stopped(live_url: str) -> None:
    api = f"{live_url}/api/v1"
    wanted = {"maneuver_id": 1, "method": "EE", "structure": {"modes": [7]}}
    with _listen(f"{api}/events?after=0") as told:
        first = _until_over(told, 1)
        run = _post(f"{api}/runs", wanted | {"author": "Ada"})["id"]
        heard = _until_over(told, run)
    assert [kind for kind, _ in first] == ["queued", "started", "succeeded"]
    assert [kind for kind, _ in heard] == ["queued", "started", "succeeded"]
    numbers = [number for _, number in heard]
    assert numbers == sorted(numbers)  # type: ignore[type-var]
    with _listen(f"{api}/events", **{"Last-Event-ID": str(numbers[0])}) as told:
        assert _until_over(told, run) == heard[1:]
