"""Versions of model structures, and detection of conflicting edits."""

from __future__ import annotations

from typing import Any

import pytest
from fastapi.testclient import TestClient
from waiting import ended

# The storage of versions is tested on both databases in test_decision_records.
pytestmark = pytest.mark.parametrize("backend", ["sqlite"])

STRUCTURES = "/api/v1/model-structures"
SP: dict[str, Any] = {"modes": [7], "outputs": ["q", "alpha", "az_egi", "az_cf", "az_ca"]}


def _named(name: str) -> dict[str, str]:
    return {"X-Flexsid-Analyst": name}


@pytest.fixture
def stored(client: TestClient) -> dict[str, Any]:
    payload = {"aircraft_id": 1, "name": "SP + SW1B at work", "structure": SP}
    return client.post(STRUCTURES, json=payload, headers=_named("Ann")).json()


def _edit(
    client: TestClient, stored: dict[str, Any], structure: dict[str, Any], **more: Any
) -> Any:
    body = {"name": stored["name"], "structure": structure, "version": stored["version"]} | more
    return client.put(f"{STRUCTURES}/{stored['id']}", json=body, headers=_named("Bo"))


def test_every_version_is_readable(client: TestClient, stored: dict[str, Any]) -> None:
    edited = _edit(client, stored, SP | {"absent": ["CZ_q"]}, note="CZ_q is never significant")
    assert edited.status_code == 200, edited.text
    assert (edited.json()["version"], edited.json()["author"]) == (2, "Bo")
    assert edited.headers["ETag"] == '"2"'
    address = f"{STRUCTURES}/{stored['id']}"
    assert client.get(address).json() == edited.json()
    first, second = client.get(f"{address}/versions").json()["items"]
    assert (first["author"], first["structure"]) == ("Ann", stored["structure"])
    assert (second["note"], second["structure"]["absent"]) == (
        "CZ_q is never significant",
        ["CZ_q"],
    )
    assert client.get(f"{address}/versions/1").json() == first


def test_two_structures_do_not_share_a_name(client: TestClient, stored: dict[str, Any]) -> None:
    payload = {"aircraft_id": 1, "name": stored["name"], "structure": SP}
    again = client.post(STRUCTURES, json=payload)
    assert (again.status_code, again.json()["code"]) == (409, "name-taken")
    other = client.post(STRUCTURES, json=payload | {"name": "SP alone"}).json()
    renamed = _edit(client, other, SP, name=stored["name"])
    assert (renamed.status_code, renamed.json()["code"]) == (409, "name-taken")
    assert _edit(client, stored, SP, note="the same name, a new version").status_code == 200


def test_stale_edit_returns_both_versions(client: TestClient, stored: dict[str, Any]) -> None:
    _edit(client, stored, SP | {"absent": ["CZ_q"]})
    late = _edit(client, stored, SP | {"absent": ["Cm_q"]}, name="mine")
    assert late.status_code == 409
    problem = late.json()
    assert problem["code"] == "stale-edit"
    assert [problem[which]["version"] for which in ("base", "current", "sent")] == [1, 2, 1]
    assert problem["current"]["structure"]["absent"] == ["CZ_q"]
    assert problem["sent"]["structure"]["absent"] == ["Cm_q"]
    assert problem["sent"]["name"] == "mine"
    resolved = _edit(client, problem["current"] | {"id": stored["id"]}, SP | {"absent": ["Cm_q"]})
    assert (resolved.status_code, resolved.json()["version"]) == (200, 3)


def test_version_is_read_from_header(client: TestClient, stored: dict[str, Any]) -> None:
    body = {"name": "x", "structure": SP}
    address = f"{STRUCTURES}/{stored['id']}"
    assert client.put(address, json=body, headers={"If-Match": '"1"'}).json()["version"] == 2
    assert client.put(address, json=body, headers={"If-Match": '"1"'}).status_code == 409
    for headers in ({}, {"If-Match": "*"}, {"If-Match": "newest"}):
        refused = client.put(address, json=body, headers=headers)
        assert (refused.status_code, refused.json()["code"]) == (422, "bad-version")
    both = client.put(address, json=body | {"version": 1}, headers={"If-Match": "2"})
    assert both.json()["code"] == "bad-version"
    never = client.put(address, json=body, headers={"If-Match": "7"})
    assert (never.status_code, never.json()["code"]) == (409, "unknown-version")


@pytest.mark.parametrize(
    ("change", "code"),
    [
        ({"modes": [99]}, "unknown-mode"),
        ({"modes": [7, 7]}, "unknown-mode"),
        ({"inputs": ["nothing"]}, "unknown-input"),
        ({"outputs": ["nothing"]}, "unknown-output"),
        ({"free": ["Cm_eta9"]}, "unknown-derivative"),
        ({"absent": ["Cm_nothing"]}, "unknown-derivative"),
        ({"absent": ["CZ_q"], "free": ["CZ_q"]}, "two-states"),
        ({"absent": ["CZ_q"], "fixed": {"CZ_q": 1.0}}, "two-states"),
        ({"fixed_to": {"CZ_q": {"source": "prediction", "id": 99}}}, "unknown-record"),
        ({"fixed_to": {"CZ_q": {"source": "run", "id": 99}}}, "unknown-record"),
        ({"fixed_to": {"CZ_q": {"source": "rumour", "id": 1}}}, "invalid-request"),
        ({"delays": {"nothing": 0.01}}, "unknown-channel"),
        ({"delays": {"q": 5.0}}, "invalid-request"),
        ({"instruments": {"q": "nothing"}}, "unknown-instrument"),
    ],
)
def test_invalid_structure_is_refused(
    client: TestClient, stored: dict[str, Any], change: dict[str, Any], code: str
) -> None:
    refused = _edit(client, stored, SP | change)
    assert refused.json()["code"] == code, refused.text
    assert refused.status_code == (404 if code == "unknown-record" else 422)
    assert client.get(f"{STRUCTURES}/{stored['id']}").json() == stored


def test_run_uses_requested_version(client: TestClient, stored: dict[str, Any]) -> None:
    held = {
        "absent": ["CZ_q"],
        "fixed": {"Cm_q": -3.25},
        "fixed_to": {
            "CZ_alpha": {"source": "prediction", "id": 1},
            "Cm_alpha": {"source": "run", "id": 1},
        },
    }
    edited = _edit(client, stored, SP | held).json()
    _edit(client, edited, SP)
    payload = {
        "maneuver_id": 1,
        "method": "EE",
        "structure_id": stored["id"],
        "structure_version": 2,
    }
    asked = client.post("/api/v1/runs", json=payload, headers=_named("Ann"))
    assert asked.status_code == 202, asked.text
    run = asked.json()
    assert (run["structure_id"], run["structure_version"], run["author"]) == (
        stored["id"],
        2,
        "Ann",
    )
    assert run["structure"] == edited["structure"]
    result = _ended(client, run["id"])["run"]["result"]
    estimated = {p["name"] for p in result["parameters"]}
    assert not estimated & {"CZ_q", "Cm_q", "CZ_alpha", "Cm_alpha"}
    assert (result["held"]["CZ_q"], result["held"]["Cm_q"]) == (0.0, -3.25)
    before = {p["name"]: p["value"] for p in client.get("/api/v1/runs/1").json()["parameters"]}
    assert result["held"]["Cm_alpha"] == before["Cm_alpha"]
    fuel = client.get("/api/v1/maneuvers/1").json()["condition"]["fuel_fraction"]
    predicted = client.get(f"/api/v1/predictions/1?fuel={fuel}").json()["derivatives"]
    assert result["held"]["CZ_alpha"] == pytest.approx(
        next(d["value"] for d in predicted if d["name"] == "CZ_alpha")
    )
    of_structure = client.get(f"/api/v1/runs?structure_id={stored['id']}").json()["items"]
    assert [(one["id"], one["structure_version"]) for one in of_structure] == [(run["id"], 2)]
    newest = client.post("/api/v1/runs", json=payload | {"structure_version": None})
    assert newest.json()["structure_version"] == 3
    other = client.post("/api/v1/runs", json=payload | {"structure": SP})
    assert (other.status_code, other.json()["code"]) == (422, "other-structure")
    unknown = client.post("/api/v1/runs", json=payload | {"structure_version": 9})
    assert unknown.status_code == 404
    nothing = client.post("/api/v1/runs", json={"maneuver_id": 1, "method": "EE"})
    assert nothing.json()["repeated"]


def test_known_delay_reduces_estimated_delay(client: TestClient) -> None:
    """Delaying the model of a sensor by 20 ms moves its estimated delay back by as much."""
    structure = SP | {"extra_parameters": ["delay_q"]}
    payload = {"maneuver_id": 1, "method": "OE", "settings": {"out_of_band_modes": "omitted"}}
    found = []
    for delays in ({}, {"q": 0.02}):
        asked = client.post(
            "/api/v1/runs", json=payload | {"structure": structure | {"delays": delays}}
        )
        result = _ended(client, asked.json()["id"])["run"]["result"]
        found.append(next(p["value"] for p in result["parameters"] if p["name"] == "delay_q"))
    assert found[0] - found[1] == pytest.approx(0.02, abs=1e-4)


@pytest.mark.parametrize("name", ["%FF", "x" * 101, "a%00b"])
def test_invalid_analyst_name_is_refused(client: TestClient, name: str) -> None:
    payload = {"aircraft_id": 1, "name": "SP", "structure": SP}
    refused = client.post(STRUCTURES, json=payload, headers=_named(name))
    assert (refused.status_code, refused.json()["code"]) == (422, "bad-analyst")


def _ended(client: TestClient, run_id: int) -> dict[str, Any]:
    ended(client, f"/api/v1/jobs/{run_id}")
    return client.get(f"/api/v1/runs/{run_id}/export").json()


def test_run_without_structure_uses_proposal(client: TestClient) -> None:
    proposed = client.get("/api/v1/maneuvers/1/run-proposal").json()
    assert proposed["structure"]["modes"] == [7, 9]
    asked = client.post("/api/v1/runs", json={"maneuver_id": 1, "method": "OE"})
    assert asked.status_code == 202, asked.text
    run = asked.json()
    assert run["structure"]["modes"] == [7, 9]
    assert run["proposal"] == proposed["basis"]
    narrow = {"band_hz": [0.25, 5.4]}
    result = client.post(
        "/api/v1/runs", json={"maneuver_id": 1, "method": "OE", "settings": narrow}
    ).json()
    assert result["structure"]["modes"] == [7]
    half = client.get("/api/v1/maneuvers/1/run-proposal?low_hz=1.0")
    assert (half.status_code, half.json()["code"]) == (422, "bad-band")
