"""A stream is started, read, acknowledged and stopped over the interface."""

from __future__ import annotations

from dataclasses import replace
from itertools import islice
from typing import Any

from fastapi.testclient import TestClient
from waiting import wait_until

from flexsid.storage.live_history import find_newest_state
from flexsid.storage.store import Store
from flexsid.workflow.live.frame_assembler import encode_frame, read_replay
from flexsid.workflow.live.live_fit import prepare_live_task

LIVE = "/api/v1/live"
ANN = {"X-Flexsid-Analyst": "Ann"}
PUSHED = {"run_id": 1, "title": "Flight 2", "receiver": {"name": "push"}}


def read_packets(store: Store, count: int) -> bytes:
    header = prepare_live_task(store, store.runs.get(1)).header
    return b"".join(encode_frame(f) for f in islice(read_replay(store, 1, header).frames(), count))


def start(client: TestClient, **more: Any) -> str:
    response = client.post(f"{LIVE}/streams", json=PUSHED | more, headers=ANN)
    assert response.status_code == 201, response.text
    return f"{LIVE}/streams/{response.json()['id']}"


def test_a_stream_is_read_while_it_runs(client: TestClient) -> None:
    store: Store = client.app.state.context.store  # type: ignore[attr-defined]
    stream = start(client, limits={"q": [-1.0, -0.9]})
    detail = client.get(stream).json()
    packets = read_packets(store, 30)
    assert len(packets) == 30 * detail["packet_bytes"]
    binary = {"Content-Type": "application/octet-stream"}
    pushed = client.post(f"{stream}/frames", content=packets, headers=binary)
    assert pushed.json() == {"frames": 30}
    state = wait_until(lambda: (client.get(stream).json()["snapshot"] or {}).get("state"))
    (alarm,) = state["alarms"]
    assert (alarm["kind"], alarm["subject"]) == ("limit", "q")
    wait_until(lambda: client.get(stream).json()["snapshot"]["newest_s"] > 1.49)
    chart = client.get(f"{stream}/samples", params={"channels": "q,bfs", "columns": 10}).json()
    assert chart["names"] == ["q", "bfs"]
    assert len(chart["low"][0]) == len(chart["time_s"]) == 10
    assert all(a <= b for a, b in zip(chart["low"][0], chart["high"][0], strict=True))

    assert detail["outputs"][0] == "alpha"
    number = stream.rpartition("/")[2]
    pair = {"stream_id": number, "output": "alpha", "input": detail["inputs"][0]}
    drawn = client.get("/api/v1/figures/live-bode", params=pair)
    assert drawn.status_code == 200
    assert "No estimate yet" in drawn.text
    assert (
        client.get("/api/v1/figures/live-bode", params=pair | {"stream_id": 99}).status_code == 404
    )

    named = {key: alarm[key] for key in ("kind", "subject", "time_s")}
    nobody = client.post(f"{stream}/acknowledgements", json=named)
    assert nobody.json()["code"] == "invalid-request"
    done = client.post(f"{stream}/acknowledgements", json=named, headers=ANN)
    assert done.json()["author"] == "Ann"
    again = client.post(f"{stream}/acknowledgements", json=named, headers=ANN)
    assert again.status_code == 409
    assert client.get(stream).json()["acknowledgements"] == [done.json()]
    history = wait_until(lambda: client.get(f"{stream}/history").json()["states"])
    assert history[0]["state"]["alarms"] == [alarm]
    assert client.get(stream).json()["alarms"] == [alarm]

    short = client.post(f"{stream}/frames", content=packets[:-3], headers=binary)
    assert short.json()["code"] == "bad-packet"
    assert client.delete(stream).json()["code"] == "stream-running"
    assert client.post(f"{stream}/stop").json()["status"] == "stopped"
    # The next maneuver has states of its own; the alarm remains.
    known = find_newest_state(store, int(stream.rpartition("/")[2]))
    assert known is not None
    quiet = replace(known.state, alarms=())
    store.live_states.add(replace(known, id=None, time_s=known.time_s + 60.0, state=quiet))
    assert client.get(stream).json()["alarms"] == [alarm]
    late = client.post(f"{stream}/frames", content=packets, headers=binary)
    assert late.json()["code"] == "not-running"
    report = client.get(f"/api/v1/reports/sortie/{number}")
    assert f"flexsid-sortie-{number}.html" in report.headers["content-disposition"]
    assert alarm["evidence"] in report.text
    assert "Ann" in report.text
    assert client.delete(stream).status_code == 204
    assert client.get(stream).status_code == 404


def test_invalid_requests_of_streams_name_the_field(client: TestClient) -> None:
    for change, code in (
        ({"receiver": {"name": "morse"}}, "unknown-receiver"),
        ({"receiver": {"name": "udp", "options": {"port": 80}}}, "bad-receiver-option"),
        ({"receiver": {"name": "udp", "options": {"port": True}}}, "bad-receiver-option"),
        ({"limits": {"flux": [0.0, 1.0]}}, "unknown-channel"),
        ({"limits": {"q": [1.0, 0.0]}}, "bad-limits"),
        ({"run_id": 99}, "unknown-record"),
        ({"flight_id": 99}, "unknown-record"),
    ):
        response = client.post(f"{LIVE}/streams", json=PUSHED | change)
        assert response.json()["code"] == code
    names = {one["name"] for one in client.get(f"{LIVE}/receivers").json()["items"]}
    assert {"replay", "push", "udp", "tcp"} <= names
    assert client.get(f"{LIVE}/streams").json() == {"items": []}
